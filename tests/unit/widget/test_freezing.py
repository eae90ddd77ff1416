"""Common to all widgets: they freeze, and continue with the newest sample."""

from __future__ import annotations

import re

import pytest
import traitlets

from robowidgets.widget.pacer import pacer

from ..pages import Page, synced
from ..senders import turn_of
from .number_widget import NumberWidget, number_in


class TestFreezing:
    def test_python_holds_what_came_last(self, widget: NumberWidget, page: Page) -> None:
        widget.update(1)
        widget.update(2)
        widget.paused = True
        widget.update(3)
        pacer.flush()
        assert page.state["paused"] is True
        assert number_in(page.state["_frozen_frame"]) == 2
        assert number_in(page.state["_frame"]) == 3
        assert page.state["_about"] == {"value": 3}
        assert page.sent("_frozen_frame") == [page.state["_frozen_frame"]]

    def test_what_is_held_is_there_before_the_widget_counts_as_frozen(
        self, widget: NumberWidget, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        held = []

        def notice(change: dict) -> None:
            held.append(number_in(synced(widget, "_frozen_frame")) if widget.paused else None)

        widget.update(2)
        monkeypatch.setattr(widget, "notify_change", notice)
        widget.paused = True
        assert held[-1] == 2

    def test_the_page_gets_the_held_sample_before_the_frozen_flag(self, widget: NumberWidget, page: Page) -> None:
        widget.update(2)
        widget.paused = True
        pacer.flush()
        (state,) = (state for message, state in zip(page.messages, page.history, strict=True) if "paused" in message)
        assert number_in(state["_frozen_frame"]) == 2

    def test_what_is_held_and_that_it_is_frozen_travel_together(self, widget: NumberWidget, page: Page) -> None:
        with turn_of(pacer):
            widget.update(2)
            widget.paused = True
        pacer.flush()
        (told,) = (message for message in page.messages if "paused" in message)
        assert number_in(told["_frozen_frame"]) == 2

    def test_python_releases_it(self, widget: NumberWidget, page: Page) -> None:
        widget.update(2)
        widget.paused = True
        pacer.flush()
        assert number_in(page.state["_frozen_frame"]) == 2
        widget.update(3)
        widget.paused = False
        pacer.flush()
        assert page.state["_frozen_frame"] == b""
        assert page.state["paused"] is False

    def test_frozen_at_once_the_page_still_hears_the_words(self, widget: NumberWidget, page: Page) -> None:
        with turn_of(pacer):
            widget.update(1)
            widget.paused = True
        pacer.flush()
        assert page.state["_about"] == {"value": 1}
        assert number_in(page.state["_frame"]) == number_in(page.state["_frozen_frame"]) == 1

    def test_frozen_again_it_holds_the_new_sample(self, widget: NumberWidget, page: Page) -> None:
        for value in (1, 2, 3):
            widget.update(value)
            widget.paused = True
            pacer.flush()
            assert number_in(page.state["_frozen_frame"]) == value
            widget.paused = False

    def test_the_user_holds_what_was_on_the_page(self, widget: NumberWidget, page: Page) -> None:
        widget.update(1)
        pacer.flush()
        on_the_page = memoryview(page.state["_frame"])
        widget.update(2)
        widget.set_state({"_frozen_frame": on_the_page, "paused": True})
        widget.update(3)
        pacer.flush()
        assert widget.paused is True
        assert number_in(synced(widget, "_frozen_frame")) == 1
        assert page.sent("_frozen_frame") == [], "the page needs no echo of its own message"
        assert number_in(page.state["_frame"]) == 3

    def test_the_user_steps_back_while_frozen(self, widget: NumberWidget, page: Page) -> None:
        frames = []
        for value in (1, 2):
            widget.update(value)
            pacer.flush()
            frames.append(memoryview(page.state["_frame"]))
        widget.set_state({"_frozen_frame": frames[1], "paused": True})
        widget.set_state({"_frozen_frame": frames[0]})
        assert (number_in(synced(widget, "_frozen_frame")), number_in(widget.get_state()["_frozen_frame"])) == (1, 1)

    def test_the_user_releases_a_freeze_of_python(self, widget: NumberWidget) -> None:
        widget.update(1)
        widget.paused = True
        widget.set_state({"_frozen_frame": memoryview(b""), "paused": False})
        assert (widget.paused, synced(widget, "_frozen_frame")) == (False, b"")

    def test_python_releases_a_freeze_of_the_user(self, widget: NumberWidget, page: Page) -> None:
        widget.update(1)
        pacer.flush()
        widget.set_state({"_frozen_frame": memoryview(page.state["_frame"]), "paused": True})
        widget.paused = False
        pacer.flush()
        assert synced(widget, "_frozen_frame") == b""
        assert page.sent("_frozen_frame") == [b""]

    def test_a_new_view_gets_the_held_sample(self, widget: NumberWidget) -> None:
        widget.update(1)
        widget.paused = True
        widget.update(2)
        state = widget.get_state()
        assert (number_in(state["_frozen_frame"]), number_in(state["_frame"]), state["paused"]) == (1, 2, True)

    def test_the_page_gets_the_number_of_seconds_to_keep(self, widget: NumberWidget, page: Page) -> None:
        assert widget.get_state()["history"] == 30.0
        widget.history = 0
        pacer.flush()
        assert page.state["history"] == 0.0
        for seconds in (-1.0, 601.0, float("nan"), float("inf")):
            message = f"history: expected seconds from 0 (none) to 600, got {seconds!r}; the page keeps"
            with pytest.raises(traitlets.TraitError, match=re.escape(message)):
                widget.history = seconds
        assert widget.history == 0.0

    def test_it_may_be_frozen_from_the_start(self) -> None:
        made = NumberWidget(paused=True)
        made.update(1)
        state = made.get_state()
        assert (state["paused"], state["_frozen_frame"], number_in(state["_frame"])) == (True, b"", 1)
        made.close()

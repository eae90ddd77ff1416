"""Common to all widgets: names, the path of a sample to the page, and the texts of errors."""

from __future__ import annotations

import gc
import logging
import os
import threading
import time
from math import isnan
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import traitlets
from IPython.core.formatters import DisplayFormatter
from ipywidgets.embed import dependency_state

from robowidgets import LaserWidget, set_theme
from robowidgets.runtime.log_once import MOST_LOGGED
from robowidgets.widget import base_widget, front_end, paced_widget
from robowidgets.widget.front_end import bundle
from robowidgets.widget.paced_widget import RESYNC_S, RESYNC_TRAITS
from robowidgets.widget.pacer import pacer
from robowidgets.widget.robot_widget import RobotWidget

from ..pages import Page, get_newest, synced
from ..senders import turn_of
from ..waiting import Clock, wait_for
from .number_widget import Number, NumberWidget, head_of, in_a_thread, number_in


class TestTheme:
    """The theme of one widget, and of all later ones."""

    def test_widgets_made_after_set_theme_have_it_and_earlier_ones_keep_theirs(self) -> None:
        before = NumberWidget()
        set_theme("projector")
        try:
            assert NumberWidget().get_state()["theme"] == "projector"
            assert NumberWidget(theme="paper").theme == "paper"
        finally:
            set_theme("auto")
        assert before.theme == NumberWidget().theme == "auto"

    def test_an_unknown_theme_is_refused_with_the_known_ones(self) -> None:
        known = "auto, light, dark, projector, paper"
        with pytest.raises(ValueError, match=rf"expected one of {known}, got 'projektor'; did you mean 'projector'"):
            set_theme("projektor")
        with pytest.raises(ValueError, match=rf"expected one of {known}, got 3$"):
            set_theme(3)  # type: ignore[arg-type]
        with pytest.raises(traitlets.TraitError, match=r"expected any of .*'projector'"):
            NumberWidget(theme="projektor")


class TestNames:
    def test_an_unknown_keyword_is_refused_by_name_with_those_there_are(self) -> None:
        with pytest.raises(TypeError) as refusal:
            NumberWidget(colour="blue")
        assert str(refusal.value) == (
            "NumberWidget() has no keyword 'colour'; did you mean 'color'? "
            "It takes: color, footer, header, history, layout, paused, tabbable, theme, title, tooltip"
        )

    def test_what_has_no_name_is_refused_with_a_way_to_name_it(self) -> None:
        with pytest.raises(TypeError) as refusal:
            NumberWidget("/scan")
        assert str(refusal.value) == "NumberWidget() takes keywords only, like title='/topic'; got '/scan'"

    def test_nothing_near_is_not_guessed(self) -> None:
        with pytest.raises(TypeError, match=r"^NumberWidget\(\) has no keyword 'xyz'\. It takes: color, footer, "):
            NumberWidget(xyz=1)

    @pytest.mark.parametrize("name", ["_frame", "_frozen_frame", "_about", "_esm", "comm", "keys", "log", "update"])
    def test_what_is_inside_is_not_a_keyword(self, name: str) -> None:
        with pytest.raises(TypeError, match=rf"^NumberWidget\(\) has no keyword '{name}'"):
            NumberWidget(**{name: None})

    def test_an_unknown_attribute_is_refused_by_name_with_those_there_are(self, widget: NumberWidget) -> None:
        with pytest.raises(AttributeError) as refusal:
            widget.pausd = True
        assert str(refusal.value) == (
            "NumberWidget has no trait 'pausd'; did you mean 'paused'? "
            "It takes: color, footer, header, history, layout, paused, tabbable, theme, title, tooltip"
        )

    def test_a_comparison_of_numpy_is_a_flag(self) -> None:
        made = NumberWidget(paused=np.float32(0.2) < 0.3)
        assert made.paused is True
        made.paused = np.array([0.4, 0.5]).min() < 0.3
        assert made.paused is False
        made.close()

    def test_what_a_host_lays_out_can_be_set(self) -> None:
        made = NumberWidget(layout={"width": "300px"}, title="/a")
        made.layout = {"width": "200px"}
        assert made.layout.width == "200px"
        made.close()

    def test_a_widget_prints_what_it_shows(self) -> None:
        made = NumberWidget(title="/count")
        assert repr(made) == "<NumberWidget /count: nothing yet>"
        made.update(7)
        assert repr(made) == "<NumberWidget /count: Number(value=7, stamp_ns=None)>"
        made.paused = True
        assert repr(made) == "<NumberWidget /count: frozen, Number(value=7, stamp_ns=None)>"
        made.close()

    def test_one_that_is_closed_prints_as_a_sentence_that_says_so(self) -> None:
        made = NumberWidget()
        assert repr(made).startswith("<")
        made.close()
        assert repr(made) == "this widget is closed: make a new one"
        assert DisplayFormatter().format(made) == ({"text/plain": repr(made)}, {})

    def test_a_widget_that_could_not_be_made_leaves_no_complaint_behind(self) -> None:
        with pytest.raises(TypeError, match="no keyword"):
            NumberWidget(nothing=1)
        with pytest.raises(TypeError, match="keywords only"):
            NumberWidget(1)
        with pytest.raises(traitlets.TraitError, match="'paused' trait of a NumberWidget"):
            NumberWidget(paused="soon")
        gc.collect()  # pytest turns errors in __del__ into a warning, and configuration turns that into a failure


class TestToThePage:
    def test_update_only_stores_and_the_pacer_sends(self, widget: NumberWidget, page: Page) -> None:
        widget.update(7)
        wait_for(lambda: page.messages, "something was sent")
        assert number_in(page.state["_frame"]) == 7
        assert page.state["_about"] == {"value": 7}
        assert page.threads == ["robowidgets-pacer"]
        assert len(page.messages) == 1

    def test_the_end_of_a_cell_finds_the_newest_sent(self, widget: NumberWidget, page: Page) -> None:
        for value in range(1000):
            widget.update(value)
        pacer.flush()
        assert number_in(page.state["_frame"]) == 999
        assert page.state["_about"] == {"value": 999}

    def test_the_head_says_how_many_came_how_fast_and_when(self, widget: NumberWidget, clock: Clock) -> None:
        widget.show(Number(1, stamp_ns=5))
        sequence, rate, stamp, arrived = head_of(widget.get_state()["_frame"])
        assert (sequence, stamp, arrived) == (1, 5, 100.0)
        assert isnan(rate)
        for i in range(1, 100):
            clock.now = 100 + i * 0.025
            widget.show(Number(1))
        assert head_of(widget.get_state()["_frame"]) == (100, pytest.approx(40), 0, 100 + 99 * 0.025)

    def test_what_does_not_count_leaves_count_and_rate(self, widget: NumberWidget) -> None:
        widget.show(Number(1))
        widget.show(Number(2), counts=False)
        assert head_of(widget.get_state()["_frame"])[0] == 1
        assert number_in(widget.get_state()["_frame"]) == 2

    def test_the_state_of_a_new_view_holds_the_newest_though_it_was_not_sent_yet(self, widget: NumberWidget) -> None:
        for value in range(100):
            widget.update(value)
            state = widget.get_state()
            assert number_in(state["_frame"]) == value
            assert state["_about"] == {"value": value}

    def test_a_page_that_is_loaded_learns_how_old_the_sample_of_a_live_source_is(
        self, widget: NumberWidget, clock: Clock
    ) -> None:
        widget._source = {"topic": "/number"}
        assert widget.get_state()["_silence"] == 0
        widget.update(1)
        clock.now += 60
        assert widget.get_state()["_silence"] == 60
        assert dependency_state(widget)[widget.model_id]["state"]["_silence"] == 0
        widget._source = {}
        assert widget.get_state()["_silence"] == 0, "filled by hand, it is not silent"

    def test_a_saved_notebook_holds_defaults_too(self, widget: NumberWidget) -> None:
        saved = widget.get_state(drop_defaults=True)
        assert (saved["color"], saved["paused"], saved["_frame"]) == ("red", False, b"")

    def test_a_new_view_takes_nothing_from_those_there_are(self, widget: NumberWidget, page: Page) -> None:
        with turn_of(pacer):
            widget.update(7)
            widget.get_state()
        pacer.flush()
        assert number_in(page.state["_frame"]) == 7
        assert page.state["_about"] == {"value": 7}

    def test_words_alone_do_not_send_the_sample_again(self, widget: NumberWidget, page: Page) -> None:
        widget.update(7)
        pacer.flush()
        with pytest.raises(TypeError):
            widget.update("seven")
        pacer.flush()
        assert [sorted(message) for message in page.messages] == [["_about", "_frame"], ["_about"]]

    def test_words_go_with_a_frame_again_and_again_for_a_message_may_be_lost_on_the_way(
        self, widget: NumberWidget, page: Page, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        widget.title = "/number"
        widget.update(1)
        pacer.flush()
        widget.update(2)
        pacer.flush()
        assert page.sent("title") == ["/number"]
        later = time.monotonic() + RESYNC_S
        monkeypatch.setattr(paced_widget, "time", SimpleNamespace(monotonic=lambda: later))
        widget.show(Number(3), {"value": 2})
        pacer.flush()
        assert page.messages[-1].keys() == {"_frame", *RESYNC_TRAITS}
        assert page.messages[-1]["title"] == "/number"
        widget.update(4)
        pacer.flush()
        assert page.sent("title") == ["/number", "/number"]

    def test_a_player_has_its_own_texts_about_its_content(
        self, widget: NumberWidget, page: Page, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        widget.driven_by_player = True
        later = time.monotonic() + RESYNC_S
        monkeypatch.setattr(paced_widget, "time", SimpleNamespace(monotonic=lambda: later))
        widget.history = 7
        pacer.flush()
        assert page.messages[-1].keys() == {"history"}

    def test_no_message_is_as_long_as_the_one_before_which_would_hold_up_the_next(
        self, widget: NumberWidget, page: Page, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        now = time.monotonic()
        monkeypatch.setattr(paced_widget, "time", SimpleNamespace(monotonic=lambda: now))
        for _ in range(200):
            widget.update(7)
            pacer.flush()
        assert len(page.sizes) == 200
        assert np.diff(page.sizes).all()
        assert max(page.sizes[1:]) < min(page.sizes) + 64

    def test_nothing_new_sends_nothing(self, widget: NumberWidget, page: Page) -> None:
        widget.update(7)
        pacer.flush()
        assert widget.send_newest() == 0
        assert len(page.messages) == 1

    def test_traits_that_a_loop_sets_keep_to_the_pace(self, widget: NumberWidget, page: Page) -> None:
        with turn_of(pacer):
            for i in range(1000):
                widget.color = f"color {i}"
            widget.update(7)
        pacer.flush()
        wait_for(lambda: page.state["color"] == "color 999" and number_in(page.state["_frame"]) == 7, "both were there")
        assert len(page.messages) == 1

    def test_all_traits_go_at_once_to_a_page_that_asks(self, widget: NumberWidget, page: Page) -> None:
        with turn_of(pacer):
            widget.color = "blue"
            widget.send_state()
            assert page.state["color"] == "blue"
            assert len(page.messages) == 1

    def test_what_could_not_be_sent_is_sent_the_next_time(
        self, widget: NumberWidget, page: Page, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def cut(**_: object) -> None:
            raise OSError("the wire is cut")

        with turn_of(pacer), monkeypatch.context() as patch:
            patch.setattr(page, "send", cut)
            widget.update(7)
            widget.color = "blue"
            with pytest.raises(OSError, match="cut"):
                widget.send_newest()
        pacer.flush()
        assert number_in(page.state["_frame"]) == 7
        assert page.state["color"] == "blue"
        assert page.state["_about"] == {"value": 7}

    @pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
    def test_from_a_forked_process_nothing_is_sent_and_the_log_says_so_once(
        self, widget: NumberWidget, page: Page
    ) -> None:
        reading, writing = os.pipe()
        holds, leave = threading.Event(), threading.Event()

        def hold() -> None:
            with get_newest(widget).lock, widget._send_lock:
                holds.set()
                leave.wait(120)

        holder = threading.Thread(target=hold)
        holder.start()
        assert holds.wait(120)
        child = os.fork()
        if child == 0:
            try:
                told: list[str] = []
                base_widget.log.addFilter(lambda record: told.append(record.getMessage()))
                for value in range(3):
                    widget.update(value)
                    pacer.flush()
                os.write(writing, f"{len(page.messages)} messages; {', '.join(told)}".encode())
            finally:
                os._exit(0)
        leave.set()
        holder.join()
        os.close(writing)
        with open(reading) as answer:
            said = answer.read()
        os.waitpid(child, 0)
        assert said == (
            "0 messages; NumberWidget : nothing reaches the page from a forked process; hand messages to the "
            "notebook's own, through a multiprocessing.Queue, and update there"
        )
        widget.update(9)
        pacer.flush()
        assert number_in(page.state["_frame"]) == 9


class TestRefusing:
    def test_it_raises_if_the_user_calls_it(self, widget: NumberWidget) -> None:
        with pytest.raises(TypeError, match=r"^expected a whole number, got 'seven'$"):
            widget.update("seven")

    def test_in_a_callback_the_widget_says_it_and_the_log_does(
        self, widget: NumberWidget, page: Page, caplog: pytest.LogCaptureFixture
    ) -> None:
        widget.title = "/numbers"
        in_a_thread(widget.update, "seven")
        pacer.flush()
        assert page.state["_about"] == {"error": "expected a whole number, got 'seven'."}
        (record,) = caplog.records
        assert (record.name, record.levelno) == ("robowidgets", logging.ERROR)
        assert record.getMessage() == (
            "NumberWidget /numbers: a message could not be shown: expected a whole number, got 'seven'"
        )

    def test_if_it_raises_the_widget_shows_the_error_too(self, widget: NumberWidget, page: Page) -> None:
        with pytest.raises(TypeError):
            widget.update("seven")
        pacer.flush()
        assert page.state["_about"] == {"error": "expected a whole number, got 'seven'."}

    def test_the_last_good_picture_stays_and_the_next_good_one_clears_the_words(
        self, widget: NumberWidget, page: Page
    ) -> None:
        widget.update(7)
        in_a_thread(widget.update, "eight")
        pacer.flush()
        assert number_in(page.state["_frame"]) == 7
        assert page.state["_about"] == {"value": 7, "error": "expected a whole number, got 'eight'."}
        widget.update(9)
        pacer.flush()
        assert number_in(page.state["_frame"]) == 9
        assert page.state["_about"] == {"value": 9}

    @pytest.mark.parametrize(
        ("text", "said"), [("too long", "too long."), ("swapped?", "swapped?"), ("Stop.", "Stop.")]
    )
    def test_words_end_as_a_sentence(self, widget: NumberWidget, text: str, said: str) -> None:
        with pytest.raises(ValueError, match=text.rstrip("?.")):
            widget._refuse(ValueError(text))
        assert widget.get_state()["_about"]["error"] == said

    def test_the_log_tells_each_error_once(self, widget: NumberWidget, caplog: pytest.LogCaptureFixture) -> None:
        for word in ("a", "b", "a", "b", "a"):
            in_a_thread(widget.update, word)
        assert [record.getMessage()[-3:] for record in caplog.records] == ["'a'", "'b'"]

    def test_a_source_gone_mad_does_not_fill_the_log(
        self, widget: NumberWidget, caplog: pytest.LogCaptureFixture
    ) -> None:
        def flood() -> None:
            for i in range(10 * MOST_LOGGED):
                widget.update(f"{i}")

        in_a_thread(flood)
        assert len(caplog.records) == MOST_LOGGED


class TestRate:
    def test_is_unknown_until_two_came(self, widget: NumberWidget) -> None:
        assert isnan(widget.rate)
        widget.update(1)
        assert isnan(widget.rate)

    def test_follows_the_last_ones(self, widget: NumberWidget, clock: Clock) -> None:
        for seconds in [1.0] * 100 + [0.1] * 40:
            clock.now += seconds
            widget.update(1)
            told = widget.rate  # as the pacer does with each frame
        assert told == pytest.approx(10)

    @pytest.mark.usefixtures("clock")
    def test_is_unknown_where_the_clock_stood_still(self, widget: NumberWidget) -> None:
        for _ in range(3):
            widget.update(1)
        assert isnan(widget.rate)


class TestBundle:
    def test_a_missing_front_end_says_how_to_get_it(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        monkeypatch.setattr(front_end, "STATIC", tmp_path)
        with pytest.raises(ImportError) as missing:
            bundle("laser_widget")
        assert str(missing.value) == (
            "robowidgets was installed without its front end (laser_widget.js is missing); "
            "in a checkout run `make build`, else install it again"
        )

    def test_it_is_text_and_a_path_for_hot_reload_only(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        monkeypatch.setattr(front_end, "STATIC", tmp_path)
        (tmp_path / "a.js").write_text("größe", encoding="utf-8")
        (tmp_path / "a.css").write_text(".größe {}", encoding="utf-8")
        monkeypatch.delenv("ROBOWIDGETS_DEV", raising=False)
        assert bundle("a") == ("größe", ".größe {}")
        monkeypatch.setenv("ROBOWIDGETS_DEV", "1")
        assert bundle("a") == (tmp_path / "a.js", tmp_path / "a.css")

    def test_instances_share_one_text(self) -> None:
        one, other = LaserWidget(), LaserWidget()
        assert synced(one, "_script") is synced(other, "_script")
        assert synced(one, "_style") is synced(other, "_style") is LaserWidget._css

    def test_what_the_host_runs_for_each_instance_is_small(self) -> None:
        state = LaserWidget().get_state()
        assert state["_script"] == LaserWidget._esm
        assert len(state["_esm"]) + len(state["_css"]) < 4000

    def test_the_class_with_the_front_end_is_made_once(self) -> None:
        one, other = NumberWidget(), NumberWidget()
        assert type(one) is type(other) is not NumberWidget
        assert other.get_state()["_esm"] == NumberWidget._esm
        other.add_traits(mine=traitlets.Int(3).tag(sync=True))
        assert other.get_state()["mine"] == 3
        assert "mine" not in NumberWidget().get_state()


def test_the_comment_of_the_base_says_what_each_of_its_classes_does() -> None:
    ours = [base for base in RobotWidget.__mro__[1:] if base.__module__.startswith("robowidgets.")]
    assert ours
    listed = [line.strip() for line in (RobotWidget.__doc__ or "").splitlines()]
    for base in ours:
        assert any(line.startswith(f"- `{base.__name__}`: ") for line in listed), base.__name__

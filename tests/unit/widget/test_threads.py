"""Common to all widgets: they may be updated, set and closed from any thread."""

from __future__ import annotations

import gc
import sys
import threading
import weakref
from collections.abc import Iterator

import pytest

from robowidgets.widget.pacer import pacer

from ..pages import Page, get_newest
from ..waiting import wait_for
from .number_widget import NumberWidget, head_of, number_in


@pytest.fixture
def _restless_threads() -> Iterator[None]:
    """Threads switch a thousand times more often than usual, to provoke races."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(5e-6)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("_restless_threads")
@pytest.mark.filterwarnings("error::pytest.PytestUnhandledThreadExceptionWarning")
class TestThreads:
    def test_nothing_is_lost_or_mixed_up_while_many_update_and_settings_change(
        self, widget: NumberWidget, page: Page, caplog: pytest.LogCaptureFixture
    ) -> None:
        each = 2000

        def flood(first: int) -> None:
            for value in range(first, first + each):
                widget.update(value)
                if value % 500 == 0:
                    widget.update("no number")

        threads = [threading.Thread(target=flood, args=(i * each,)) for i in range(8)]
        for thread in threads:
            thread.start()
        settings = 0
        while any(thread.is_alive() for thread in threads):
            settings += 1
            widget.color = f"color {settings}"
            widget.paused = settings % 2 == 1
            assert widget.rate != 0
            number_in(widget.get_state()["_frame"])
        widget.paused = False
        for thread in threads:
            thread.join()
        widget.update(-1)
        wait_for(lambda: number_in(page.state["_frame"]) == -1, "the last one was on the page")
        assert page.state["_about"] == {"value": -1}
        assert head_of(page.state["_frame"])[0] == 8 * each + 1
        assert page.state["color"] == f"color {settings}"
        assert page.state["paused"] is False
        assert page.state["_frozen_frame"] == b""
        sequences = [head_of(frame)[0] for frame in page.sent("_frame")]
        assert sequences == sorted(sequences)
        for message in page.messages:
            if "_frame" in message and "_about" in message and "error" not in message["_about"]:
                assert number_in(message["_frame"]) == message["_about"]["value"]
        assert {record.getMessage() for record in caplog.records} == {
            "NumberWidget : a message could not be shown: expected a whole number, got 'no number'"
        }

    def test_closing_in_a_flood_ends_it_quietly(self, caplog: pytest.LogCaptureFixture) -> None:
        widget = NumberWidget()
        page = Page(widget)
        stop = threading.Event()

        def flood() -> None:
            while not stop.is_set():
                widget.update(1)

        thread = threading.Thread(target=flood)
        thread.start()
        wait_for(lambda: len(page.messages) >= 3, "the flood was on the page")
        widget.close()
        sent, came = len(page.messages), get_newest(widget).sequence
        wait_for(lambda: get_newest(widget).sequence > came + 20_000, "many more came")
        stop.set()
        thread.join()
        pacer.flush()
        assert len(page.messages) == sent
        assert caplog.records == []

    def test_a_closed_widget_can_be_forgotten(self) -> None:
        widget = NumberWidget()
        page = Page(widget)
        widget.update(1)
        wait_for(lambda: page.messages, "it was sent")
        widget.close()
        widget.update(2)
        pacer.flush()
        gone = weakref.ref(widget)
        del widget
        gc.collect()
        assert gone() is None

    def test_closing_twice_is_closing(self) -> None:
        widget = NumberWidget()
        widget.close()
        widget.close()

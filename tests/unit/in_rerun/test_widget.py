"""One time for Python and the viewer; the tests play both by their messages."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest
from traitlets import TraitError

import robowidgets
from robowidgets.in_rerun import widget as widget_module
from robowidgets.in_rerun.widget import RerunWidget
from robowidgets.screens.player import Player

from ..pages import synced
from ..waiting import wait_for

pytest.importorskip("rerun_notebook", reason="Rerun is not installed: pip install 'robowidgets[rerun]'")


class Viewer:
    """The elements in a page, as a widget sees them."""

    def __init__(self, widget: RerunWidget) -> None:
        self._widget = widget
        self.told: list[float] = []
        widget.children[0].set_time_ctrl = self._tell

    def _tell(self, timeline: str, *, duration_nanos: int, play: bool) -> None:
        assert timeline == "recording_time"
        assert not play
        self.told.append(duration_nanos / 1e9)

    def says(self, kind: str, **more: object) -> None:
        event = {"application_id": "robowidgets", "recording_id": "1", "segment_id": None, "type": kind, **more}
        self._widget._on_event(json.dumps(event))

    def at(self, seconds: float) -> None:
        self.says("time_update", time=seconds * 1e9)

    def opens(self) -> None:
        self.says("recording_open", source="python", version="0.41.0")


@pytest.fixture
def widget() -> Iterator[RerunWidget]:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        made = recording.to_rerun()
    assert isinstance(made, RerunWidget)
    yield made
    made.close()


@pytest.fixture
def viewer(widget: RerunWidget) -> Viewer:
    made = Viewer(widget)
    made.opens()
    made.at(0)
    made.told.clear()
    return made


@pytest.fixture
def player() -> Iterator[Player]:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        made = recording.show(scanogram=False, rerun=True)
    yield made
    made.close()


def becomes(widget: Any, seconds: float) -> None:
    wait_for(lambda: widget.time == pytest.approx(seconds, abs=1e-9), f"it is {seconds} s")


def get_address(widget: RerunWidget) -> str:
    """Return the address from which the viewer fetches the data."""
    return str(synced(widget.children[0], "_url"))


def tells(viewer: Viewer, *seconds: float) -> None:
    wait_for(lambda: viewer.told[-len(seconds) :] == list(seconds), f"the viewer was told {seconds}")


def test_times_set_by_python_go_to_the_viewer_and_its_answer_is_not_news(widget: RerunWidget, viewer: Viewer) -> None:
    for seconds in (21.96, 22.5, 3.0):
        widget.time = seconds
        tells(viewer, seconds)
    viewer.at(21.96)
    viewer.at(22.5)
    viewer.at(3.0)
    viewer.at(4.0)
    becomes(widget, 4.0)
    assert viewer.told == [21.96, 22.5, 3.0]


def test_a_viewer_that_had_no_timeline_yet_gets_the_time_again(
    widget: RerunWidget, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(widget_module, "PATIENCE", 0.05)
    viewer = Viewer(widget)
    widget.time = 12.5
    viewer.opens()
    assert viewer.told == [12.5]
    viewer.at(0)
    tells(viewer, 12.5, 12.5)
    viewer.at(12.5)
    viewer.at(13.0)
    becomes(widget, 13.0)
    assert not widget._sent


def test_a_late_answer_does_not_take_the_time_back(widget: RerunWidget, viewer: Viewer) -> None:
    seen: list[float] = []
    widget.observe(lambda change: seen.append(change["new"]), "time")
    for seconds in (1.0, 2.0):
        widget.time = seconds
        tells(viewer, seconds)
    viewer.at(1.0)
    widget.time = 3.0
    tells(viewer, 3.0)
    viewer.at(2.0)
    viewer.at(3.0)
    viewer.at(9.0)
    becomes(widget, 9.0)
    wait_for(lambda: seen == [1.0, 2.0, 3.0, 9.0], "observers are called, which no lock waits for")


def test_late_answers_to_a_time_that_was_sent_twice_do_not_take_the_time_back(
    widget: RerunWidget, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(widget_module, "PATIENCE", 0.0)
    for seconds in (1.0, 2.0, 1.0, 3.0):
        widget.time = seconds
        tells(viewer, seconds)
    for seconds in (1.0, 2.0, 1.0, 3.0):
        viewer.at(seconds)
        widget.send_newest()
        assert widget.time == 3.0
    viewer.at(9.0)
    becomes(widget, 9.0)


def test_a_viewer_that_is_still_drawing_gets_only_the_newest_time(
    widget: RerunWidget, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(widget_module, "PATIENCE", 60.0)
    for seconds in (1.0, 2.0, 3.0):
        widget.time = seconds
        widget.send_newest()
    assert viewer.told == [1.0]
    viewer.at(1.0)
    tells(viewer, 1.0, 3.0)
    assert widget.time == 3
    monkeypatch.setattr(widget_module, "PATIENCE", 0.0)
    widget.time = 4.0
    tells(viewer, 1.0, 3.0, 4.0)


def test_answers_that_come_after_a_long_cell_are_not_news_either(
    widget: RerunWidget, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(widget_module, "PATIENCE", 0.0)
    for number in range(1, 3001):
        widget.time = number / 100
        widget.send_newest()
    for seconds in list(viewer.told):
        viewer.at(seconds)
    assert widget.time == 30
    viewer.at(1.0)
    becomes(widget, 1.0)


def test_a_page_that_loads_gets_the_time_and_does_not_set_it(widget: RerunWidget) -> None:
    viewer = Viewer(widget)
    widget.time = 20.0
    for _ in ("first", "and again, when it is reloaded"):
        assert viewer.told == []
        viewer.opens()
        assert viewer.told == [20.0]
        viewer.told.clear()
        viewer.at(0.0)
        viewer.at(0.16)
        viewer.at(20.0)
        assert widget.time == 20.0
    viewer.at(5.0)
    becomes(widget, 5.0)


def test_of_a_viewer_that_plays_the_newest_time_is_taken_now_and_then(widget: RerunWidget, viewer: Viewer) -> None:
    seen: list[float] = []
    widget.observe(lambda change: seen.append(change["new"]), "time")
    for number in range(1, 501):
        viewer.at(number / 50)
    becomes(widget, 10.0)
    assert len(seen) < 50
    assert seen == sorted(seen)
    assert viewer.told == []


def test_the_other_timeline_of_the_viewer_is_understood(widget: RerunWidget, viewer: Viewer) -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        start = recording.start_ns or 0
    viewer.says("timeline_change", timeline="message_log_time", time=float(start + 12_500_000_000))
    wait_for(lambda: widget.time == pytest.approx(12.5, abs=1e-6), "it is 12.5 s")
    viewer.says("timeline_change", timeline="recording_time", time=2e9)
    becomes(widget, 2.0)


def test_other_events_change_nothing(widget: RerunWidget, viewer: Viewer) -> None:
    for kind in ("play", "pause", "selection_change"):
        viewer.says(kind, items=[])
    assert widget.time == 0
    with pytest.raises(TraitError, match="expected seconds from the start, got 'now'"):
        widget.time = "now"


def test_viewer_and_player_follow_one_time_and_come_to_rest(player: Player) -> None:
    assert player.rerun is not None
    viewer = Viewer(player.rerun)
    viewer.opens()
    viewer.at(player.time)
    viewer.told.clear()
    player.time = 21.96
    tells(viewer, 21.96)
    viewer.at(21.96)
    viewer.at(8.25)
    becomes(player, 8.25)
    becomes(player.bar, 8.25)
    viewer.at(1e6)
    becomes(player, player.duration)
    tells(viewer, 21.96, player.duration)


def test_if_it_is_closed_nothing_is_served_any_more(widget: RerunWidget) -> None:
    address = get_address(widget)
    with urlopen(address, timeout=240) as answer:
        assert answer.read(4) == b"RRF2"
    widget.close()
    with pytest.raises(HTTPError, match="404"):
        urlopen(address, timeout=240)


def test_the_viewer_is_fetched_from_here(widget: RerunWidget) -> None:
    address = synced(widget.children[0], "_esm")
    assert address.startswith("http://127.0.0.1:")
    with urlopen(address, timeout=240) as answer:
        assert b"const fetch =" in answer.read(200)
    with urlopen(address.replace("widget.js", "re_viewer_bg.wasm"), timeout=240) as answer:
        assert answer.read(4) == b"\0asm"


def test_a_new_one_does_not_know_the_old_one(widget: RerunWidget, viewer: Viewer) -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        other = recording.to_rerun(None, "/scan")
    assert isinstance(other, RerunWidget)
    assert get_address(other) != get_address(widget)
    other.time = 5.0
    assert widget.time == 0
    other.close()


def test_a_page_of_the_player_leaves_the_viewer_on_show(player: Player) -> None:
    assert player.rerun is not None
    player.html_size(start=1, end=2)
    assert player.rerun.comm is not None
    assert player.rerun.children[0].comm is not None
    player.time = 3.0
    assert player.rerun.time == 3.0

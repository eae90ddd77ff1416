"""A recording on the page: its widgets, and their content at a time."""

from __future__ import annotations

import gc
import os
import sys
import threading
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count, islice
from math import isnan, nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from comm import get_comm_manager
from traitlets import TraitError

from robowidgets import LaserWidget, MessageWidget, SpeedWidget, TouchState, TouchWidget
from robowidgets.notebook import cells as _cells
from robowidgets.recording import Recording, open
from robowidgets.recordings import UnknownTopicError
from robowidgets.samples.touch_tracker import TouchSensor, TouchTracker
from robowidgets.scanogram.overview import readings_per_second
from robowidgets.screens import _prefetcher
from robowidgets.screens._prefetcher import segment
from robowidgets.screens.player import Player
from robowidgets.touch import marks as _touch_marks
from robowidgets.touch.history import TouchHistory
from robowidgets.touch.marks import touch_marks

from ..pages import from_page, synced, widgets_by_place
from ..waiting import threads_named, wait_for
from . import recorded, robot, sweeps, topics

S = 1_000_000_000


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return robot.write(tmp_path_factory.mktemp("recordings") / "drive")


@contextmanager
def shown(path: Path, *topics: str, **more: bool | None) -> Iterator[Player]:
    with open(path) as recording:
        player = recording.show(*topics, **more)
    yield player
    player.close()


@pytest.fixture
def player(path: Path) -> Iterator[Player]:
    with shown(path) as player:
        yield player


def widgets(player: Player) -> dict[tuple[str, ...], str]:
    return {view.choice.topics: type(view.widget).__name__ for view in player.views}


def widget(player: Player, kind: type) -> object:
    return next(view.widget for view in player.views if isinstance(view.widget, kind))


def test_each_topic_gets_its_widget_and_a_command_the_bars_of_the_measured_speed(player: Player) -> None:
    assert widgets(player) == {
        ("/scan",): "LaserWidget",
        ("/odom", "/cmd_vel"): "SpeedWidget",
        ("/bumper",): "TouchWidget",
        ("/odom",): "PathWidget",
    }
    assert [(v.widget.title, getattr(v.widget, "command_title", "")) for v in player.views] == [
        ("/scan", ""), ("/odom", "/cmd_vel"), ("/bumper", ""), ("/odom", "")
    ]  # fmt: skip
    about = f"{player.recording.path.name}: 0.00 of {player.duration:.2f} s, /scan, /odom, /cmd_vel, /bumper"
    assert repr(player) == f"<Player {about}>"


def test_the_list_of_topics_shows_the_wires_below_the_rest_which_open_messages_at_the_time_on_show(
    player: Player,
) -> None:
    assert player.topic_list is not None
    from_page(player.topic_list, {"toggle": "the wires", "on": True})
    wires = player.wires
    assert player.children[-1] is wires
    assert wires is not None
    before = player.arrangement
    from_page(wires, {"open": "/odom"})
    assert player.arrangement == [*before, "/odom as message"]
    assert getattr(widget(player, MessageWidget), "title", "") == "/odom"
    from_page(wires, {"open": "/odom"})
    assert player.arrangement == before
    player.topic_list.wires = False
    assert (player.wires, wires.comm) == (None, None)
    assert wires not in player.children


def test_a_span_is_named_renamed_and_loses_its_name_on_the_page_which_hears_what_came_of_it(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[Any] = []
    monkeypatch.setattr(
        "robowidgets.player_widget.PlayerWidget.send", lambda _self, content, _buffers=None: told.append(content)
    )
    with shown(path) as player:
        door, moment = [3.0, 4.5, "door"], [6.0, 6.0, "here"]
        from_page(player.bar, {"label": [door, None]})
        from_page(player.bar, {"label": [moment, None]})
        assert player.bar.labels == ((3.0, 4.5, "door"), (6.0, 6.001, "here"))
        for name in ("door", "wall"):  # the same name again is not a change
            from_page(player.bar, {"label": [[3.0, 4.5, name], door]})
            assert player.bar.labels[0] == (3.0, 4.5, name)
        from_page(player.bar, {"label": [None, [3.0, 4.5, "wall"]]})
        from_page(player.bar, {"label": [[5.0, 5.5, " "], None]})
        answers = [content for content in told if "labelled" in content]
        assert [bool(answer["problem"]) for answer in answers] == [False] * 5 + [True]
        assert answers[1]["stored"] == [6.0, 6.001, "here"]  # what an undo has to remove
        assert [one.label for one in player.recording.labels] == ["here"]
        for new in (None, door):
            from_page(player.bar, {"label": [new, door]})
            assert told[-1]["problem"].startswith("the label 'door' was changed or removed meanwhile")
        assert [one.label for one in player.recording.labels] == ["here"]
    with shown(path) as again:
        assert [name for _, _, name in again.bar.labels] == ["here"]
    (path.parent / "labels.jsonl").unlink()


class TestATopicWithoutAMessage:
    @pytest.fixture
    def path(self, tmp_path: Path) -> Path:
        some = topics.every(0.1, 0, 2, 1.0)
        return topics.write(tmp_path / "quiet", {"/front_scan": (), "/scan": some, "/odom": (), "/bump": ()})

    def test_gets_a_widget_only_if_it_is_named(self, path: Path) -> None:
        with shown(path) as player:
            assert widgets(player) == {("/scan",): "LaserWidget"}
            assert player.scanogram is not None
            assert player.scanogram.title == "/scan"
        with shown(path, "/front_scan", "/bump") as player:
            assert widgets(player) == {("/front_scan",): "LaserWidget", ("/bump",): "TouchWidget"}

    def test_is_not_meant_where_another_topic_has_some(self, path: Path) -> None:
        with open(path) as recording:
            assert recording.scans().topic == "/scan"
            assert len(recording.scans("/front_scan")) == 0
            assert recording.scanogram().title == "/scan"
            assert recording.problems == ()

    def test_is_reported_if_there_is_no_other(self, tmp_path: Path) -> None:
        path = recorded.write(
            tmp_path / "x", {"/scan": sweeps.TYPE, "/words": "std_msgs/msg/String"}, [(0, "/words", {"data": "hi"})]
        )
        with shown(path) as player:
            assert widgets(player) == {("/words",): "EventsWidget"}
            assert player.recording.problems == ("no message came on its topics that a widget shows",)


def test_topics_may_be_chosen_and_a_command_alone_has_bars_of_its_own(path: Path) -> None:
    with shown(path, "/cmd_vel", "/bumper") as player:
        assert widgets(player) == {("/cmd_vel",): "SpeedWidget", ("/bumper",): "TouchWidget"}
        player.seek(7.0)
        assert widget(player, SpeedWidget).speed.linear[0] == 0.7  # type: ignore[attr-defined]
        assert widget(player, SpeedWidget).bars == "commanded"  # type: ignore[attr-defined]
    with shown(path, "/odom", "/cmd_vel") as player:
        assert widget(player, SpeedWidget).bars == "measured"  # type: ignore[attr-defined]


def test_every_widget_shows_the_time_forth_and_back(player: Player) -> None:
    laser, speed, touch = (widget(player, kind) for kind in (LaserWidget, SpeedWidget, TouchWidget))
    for seconds in (6.55, 2.95, 9.9, 0.0):
        player.time = seconds
        i = int(seconds * 10)
        assert laser.scan.ranges.tolist() == [pytest.approx(1 + i / 100)]  # type: ignore[attr-defined]
        assert speed.speed.linear[0] == i / 100  # type: ignore[attr-defined]
        commanded = speed.commanded.linear[0]  # type: ignore[attr-defined]
        assert commanded == i / 100 if i >= 50 else isnan(commanded)
        expected = {
            6.55: (TouchState.TOUCHED, 2),
            2.95: (TouchState.TOUCHED, 1),
            9.9: (TouchState.FREE, 2),
            0.0: (TouchState.UNKNOWN, 0),
        }
        told = touch.states.get("left"), touch.touches.get("left")  # type: ignore[attr-defined]
        assert told == expected[seconds]


def test_before_the_first_message_of_a_topic_nothing_of_later_is_shown(player: Player) -> None:
    speed = widget(player, SpeedWidget)
    player.seek(9.0)
    player.seek(4.0)
    assert all(isnan(value) for value in speed.commanded.values)  # type: ignore[attr-defined]


def test_before_the_first_scan_one_note_says_so_and_the_range_is_one_of_a_room(data: Path) -> None:
    with shown(data / "odd" / "every_ros2_type_mcap", "/test/sensor_msgs/laser_scan", "/test/std_msgs/bool") as player:
        player.seek(0.0)
        scan = widget(player, LaserWidget).scan  # type: ignore[attr-defined]
        assert (len(scan), scan.range_max) == (0, 10.0)
        assert list(map(str, scan.problems())) == ["no scan up to this time of the recording"]


def test_the_widgets_keep_no_history_of_their_own(player: Player) -> None:
    assert [view.widget.history for view in player.views] == [0.0] * len(player.views) != []


def test_it_reads_on_when_the_recording_is_closed(path: Path) -> None:
    with open(path) as recording:
        player = recording.show()
    player.seek(5.0)
    assert widget(player, LaserWidget).scan.ranges.tolist() == [pytest.approx(1.5)]  # type: ignore[attr-defined]
    player.close()
    with pytest.raises(Exception, match="is closed"):
        player.recording.at("/scan", 1.0)


def test_it_holds_no_more_in_memory_than_the_recording(path: Path) -> None:
    with open(path) as recording:
        recording.memory = 1 << 20
        player = recording.show()
        assert player.recording.memory == 1 << 20
        player.close()


def test_its_time_can_be_observed_and_kept_within_the_recording(player: Player) -> None:
    seen: list[float] = []
    player.observe(lambda change: seen.append(change["new"]), "time")
    player.time = 7.77
    player.time = 99
    player.time = -1
    assert seen == [7.77, 10.0, 0.0]
    with pytest.raises(TraitError, match="time: expected seconds from the start, got nan"):
        player.seek(nan)


class TestTouches:
    def write(self, tmp_path: Path, *bumps: tuple[str, float, float]) -> Path:
        """Bumpers, left and right of the name of their topic, pressed from a time to another; scans for 60 s."""
        pressed: dict[str, list[tuple[float, float]]] = {}
        for topic, start, end in bumps:
            pressed.setdefault(topic, []).extend([(start, 1), (end, 0)])
        return topics.write(tmp_path / "bumped", {"/scan": topics.every(0.5, 0, 60, 1.0), **pressed})

    def test_are_marks_until_others_are_set(self, tmp_path: Path) -> None:
        with shown(self.write(tmp_path, ("/bump", 12, 13.5), ("/bump", 40, 40.25))) as player:
            assert player.marks == player.bar.marks == ((12, 13.5, "left"), (40, 40.25, "left"))
            assert player.scanogram
            assert player.scanogram.marks == player.marks
            player.marks = ()
            assert player.bar.marks == player.scanogram.marks == ()

    def test_that_follow_each_other_at_once_are_one_mark(self, tmp_path: Path) -> None:
        bumps = [("/bump", 12, 13), ("/bump", 13.25, 14), ("/rear/bump", 13.5, 14.25), ("/rear/bump", 15, 16)]
        with shown(self.write(tmp_path, *bumps), scanogram=False) as player:
            assert player.marks == ((12, 14.25, "left"), (15, 16, "left"))

    def test_of_topics_that_are_not_shown_are_left_out(self, tmp_path: Path) -> None:
        with shown(self.write(tmp_path, ("/bump", 12, 13.5)), "/scan") as player:
            assert player.marks == ()

    def test_are_joined_where_they_are_many(self, tmp_path: Path) -> None:
        bumps = [("/bump", start, start + 0.01) for start in range(1, 60)]
        path = self.write(tmp_path, *bumps)
        with open(path) as recording:
            assert len(touch_marks(recording, ["/bump"])) == 59
            with pytest.MonkeyPatch.context() as context:
                context.setattr(_touch_marks, "MOST", 20)
                assert touch_marks(recording, ["/bump"]) == [(1, pytest.approx(59.01), "left")]
                context.setattr(_touch_marks, "MOST_READ", 100)
                assert touch_marks(recording, ["/bump"]) == []


def test_settings_of_playing_reach_the_bar_and_back(player: Player) -> None:
    player.speed, player.loop, player.selection = 2, True, (2, 3)
    player.marks = [(4, 5, "late"), (1, 1.5, "early")]
    bar = player.bar
    assert (bar.speed, bar.loop, bar.selection, bar.span) == (2.0, True, (2.0, 3.0), (2.0, 3.0))
    assert bar.marks == ((1.0, 1.5, "early"), (4.0, 5.0, "late"))
    bar.playing = True
    assert player.playing
    cursor = player._prefetcher.cursor
    assert (cursor.rate, cursor.span) == (2.0, (2.0, 3.0))
    player.selection = (2, 1e6)
    assert bar.span == (2.0, 10.0)


def test_an_observer_of_the_time_may_set_it(player: Player, monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[object] = []
    monkeypatch.setattr(player.bar, "send", sent.append)
    player.observe(lambda change: change["new"] > 5 and player.seek(1.0), "time")
    player.bar.time = 7.0
    assert (player.time, player.bar.time) == (1.0, 1.0)
    assert sent == [{"seek": 1.0}]


def test_a_program_moves_it_by_another_widget_and_a_page_moves_it_by_itself(path: Path) -> None:
    with shown(path, "/scan", "/odom.twist.twist.linear.x", scanogram=True) as player:
        scanogram, plot = player.scanogram, player.views[-1].widget
        assert scanogram is not None
        scanogram.time = 3.0
        assert (player.time, player.bar.time) == (3.0, 3.0)
        plot.time = 4.0
        assert (player.time, player.bar.time) == (4.0, 4.0)
        plot.time = None
        assert player.time == 4.0
        for widget in (scanogram, plot):
            widget.set_state({"time": 2.0})
        assert player.time == 4.0, "a message of the page about it carries the time of the player"


def test_one_that_cannot_be_made_leaves_nothing_behind(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    unseen: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", unseen.append)
    with open(path) as recording:
        files = os.listdir("/proc/self/fd")
        with pytest.raises(UnknownTopicError) as raised:
            recording.show("/nothing")
        assert os.listdir("/proc/self/fd") == files, f"closed while {raised} refers to it"
    gc.collect()
    assert (threads_named("robowidgets-prefetcher"), unseen) == (0, [])


def test_what_was_found_is_marked(player: Player) -> None:
    found = player.recording.find(lambda moment: moment.scan is not None and moment.scan.nearest().range > 1.8)
    player.marks = found
    assert player.marks == ((pytest.approx(8.1), 10.0, f"{found.condition}: {found[0].met}"),)
    assert player.scanogram is not None
    assert player.scanogram.marks == player.bar.marks == player.marks
    player.scanogram.marks = [(1, 2, "seen")]
    assert player.marks == player.bar.marks == ((1.0, 2.0, "seen"),)


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [
        ("speed", 0.01, r"speed: expected 0\.1 to 10 seconds of the recording per second, got 0\.01"),
        ("speed", nan, r"speed: expected 0\.1 to 10 seconds of the recording per second, got nan"),
        ("selection", (3, 2), r"selection: expected None or \(start, end\) in seconds"),
        ("marks", [(1, 2)], r"marks: expected \(start, end, text\), seconds in order; got \(1, 2\)"),
        ("marks", [(2, 1, "x")], r"marks: expected \(start, end, text\), seconds in order; got \(2, 1, 'x'\)"),
    ],
)
def test_what_cannot_be_is_refused(player: Player, name: str, value: object, error: str) -> None:
    with pytest.raises(TraitError, match=error):
        setattr(player, name, value)


def test_a_page_that_has_nothing_gets_the_time_on_show_first(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[tuple[dict, list[bytes]]] = []
    monkeypatch.setattr(_prefetcher, "PATIENCE", 60.0)
    with shown(path) as player:
        monkeypatch.setattr(player.bar, "send", lambda content, buffers=(): sent.append((content, buffers)))
        player.time = 5.5
        from_page(player.bar, {"have": "nothing"})
        wait_for(lambda: len(sent) >= 6, "the last five seconds came, and the one before")
    segments = [(content, buffers) for content, buffers in sent if "segment" in content]
    assert [content["segment"] for content, _ in segments] == [5, 6, 4, 7, 8, 9, 10][: len(segments)]
    assert all(len(buffers) == len(content["abouts"]) == 4 for content, buffers in segments)


def test_a_step_that_the_page_cannot_take_goes_to_the_next_scan_or_the_one_before(
    player: Player, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent: list[object] = []
    monkeypatch.setattr(player.bar, "send", lambda content, _buffers=None: sent.append(content))
    scans = [moment.seconds for moment in player.recording.samples("/scan")]
    steps = [[scans[4], 1], [scans[4], -1], [scans[4] + 0.01, -1]]
    for step in (*steps, [scans[-1], 1], [scans[0], -1]):
        from_page(player.bar, {"step": step})
    assert sent == [{"seek": scans[i], "step": step} for i, step in zip((5, 3, 4), steps, strict=True)]


def test_a_step_that_the_page_cannot_take_goes_to_a_message_of_any_topic_of_the_widget(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent: list[dict] = []
    with shown(path, "/bumper.state", "/cmd_vel.linear.x") as player:
        monkeypatch.setattr(player.bar, "send", lambda content, _buffers=None: sent.append(content))
        for step in ([3.0, 1], [8.0, 1], [8.0, -1]):
            from_page(player.bar, {"step": step})
    assert [content["seek"] for content in sent if "step" in content] == pytest.approx([5.0, 8.1, 7.9])


def test_scans_and_speeds_grow_old_and_touches_hold(player: Player) -> None:
    assert synced(player.bar, "_pauses") == [2.0, 2.0, 0.0, 2.0]


def test_the_first_segments_are_in_the_state_of_the_bar(player: Player, monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = [held["segment"] for held in synced(player.bar, "_first")]
    assert numbers == list(range(int(player.duration) + 1))
    monkeypatch.setattr("robowidgets.screens.player.HELD_BYTES", 0)
    (first,) = player._first_segments(0)
    assert first["segment"] == int(player.time)
    _, frames = segment([view.track for view in player.views], 0)
    assert [len(track) for track in first["tracks"]] == [len(raw) for raw in frames]


def test_it_starts_where_what_starts_early_has_something_to_show(data: Path) -> None:
    with shown(data / "good" / "neato_fsm", "/scan", "/bump") as player:
        assert 0 < player.time < 3.3
        assert len(widget(player, LaserWidget).scan) == 361  # type: ignore[attr-defined]


def test_the_neato_bumps_where_it_bumped(data: Path) -> None:
    with shown(data / "good" / "neato_fsm", "/bump") as player:
        touch = widget(player, TouchWidget)
        bump = next(m for m in player.recording.samples("/bump") if any(m.sample.touched.values()))  # type: ignore[union-attr]
        player.seek(bump.seconds)
        assert TouchState.TOUCHED in touch.states.values()  # type: ignore[attr-defined]
        player.seek(21.9)
        assert set(touch.states.values()) == {TouchState.FREE}  # type: ignore[attr-defined]
        player.seek(22.0)
        touched = {name for name, state in touch.states.items() if state is TouchState.TOUCHED}  # type: ignore[attr-defined]
        assert touched == {"left front", "right front"}


def opened_in(folder: Path) -> int:
    """Return the number of files in a folder that this process has open. The number of all includes other tests'."""
    links = [os.path.realpath(f"/proc/self/fd/{number}") for number in os.listdir("/proc/self/fd")]
    return sum(link.startswith(f"{folder.resolve()}") for link in links)


@pytest.mark.slow
def test_a_cell_that_runs_again_and_again_holds_no_more_than_once(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_cells, "_made", {})
    held, players = set(), []
    gc.collect()  # widgets of other tests, whose comms would end meanwhile
    with open(path) as recording:
        for run in range(12):
            monkeypatch.setattr(_cells, "running_cell", lambda run=run: ("this cell", str(run)))
            player = recording.show("/scan")
            players.append(weakref.ref(player))
            files = opened_in(path)
            held.add((threads_named("robowidgets-prefetcher"), files, len(get_comm_manager().comms)))
    assert len(held) == 1, held
    gc.collect()
    assert [made() for made in players] == [None] * 11 + [player]
    player.close()


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("damaged/truncated.mcap", "the recording was cut off"),
        ("odd/empty_bag", "there is no message in it: nothing was recorded"),
    ],
)
def test_what_is_wrong_stands_above(data: Path, name: str, line: str) -> None:
    with shown(data / name) as player:
        assert player.notes[0].startswith(f"⚠ {line}")


def test_cards_without_a_sensor_of_a_kind_stand_below_no_warning_until_they_are_taken_off(data: Path) -> None:
    with shown(data / "odd" / "jazzy_mcap_no_laser") as player:
        assert [view.choice.topic for view in player.views] == ["/imu/data", "/joint_states"]
        assert player.notes == []
        player.arrangement = []
        for view in player.views:
            player._on_toggle(view.choice.topic, False)
        assert player.notes[0].startswith("⚠ none of its topics has a widget for its kind of sensor")


def test_if_nothing_can_be_shown_there_is_no_bar(data: Path) -> None:
    with shown(data / "odd" / "empty_bag") as player:
        assert player.children == ()


def test_what_is_wrong_is_not_markup(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Recording, "problems", ("/<b>: <script>",))
    with shown(path) as player:
        assert player.notes == ["⚠ /<b>: <script>"], "the page shows it as plain text"


def test_what_is_found_wrong_on_the_way_is_reported_then(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Otherwise the bad scan is among the data of a notebook.
    monkeypatch.setattr("robowidgets.screens.player.HELD_BYTES", 0)
    with shown(robot.write(tmp_path / "drive", bad_scan_at=40), scanogram=False) as player:
        assert player.notes == []
        player.seek(4.0)
        assert player.notes[0].startswith("⚠ /scan: messages that cannot be shown are left out, the first at 4.00 s")


def test_it_starts_with_the_first_topic_when_none_starts_early(data: Path) -> None:
    with shown(data / "odd" / "every_ros2_type_mcap") as player:
        assert player.time == pytest.approx(2.1, abs=0.01)
        assert widget(player, SpeedWidget).speed.linear[0] == 1.0  # type: ignore[attr-defined]


class TestATouchHistory:
    def expected(self, recording: Recording, time_ns: int) -> dict:
        tracker = TouchTracker()
        for moment in recording.samples("/bump"):
            if moment.time_ns <= time_ns:
                tracker.apply(moment.sample, moment.time_ns)  # type: ignore[arg-type]
        return tracker.states(time_ns)

    def test_is_at_every_time_what_listening_from_the_start_gives(
        self, data: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("robowidgets.touch.history._KEPT_EVERY", 20)
        with open(data / "good" / "neato_fsm") as recording:
            history = TouchHistory(recording, "/bump", TouchTracker().hold, None)
            start_ns = recording.start_ns or 0
            before = history.at(start_ns).states(start_ns)
            assert before == dict.fromkeys(self.expected(recording, start_ns + S), TouchSensor())
            for seconds in (21.9, 22.0, 25.0, 10.0, 32.2, 22.3, 24.0, 1.0):
                time_ns = start_ns + round(seconds * S)
                assert history.at(time_ns).states(time_ns) == self.expected(recording, time_ns), seconds

    def test_does_not_restart_each_time(self, data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("robowidgets.touch.history._KEPT_EVERY", 20)
        with open(data / "good" / "neato_fsm") as recording:
            history = TouchHistory(recording, "/bump", TouchTracker().hold, None)
            start_ns = recording.start_ns or 0
            history.at(start_ns + 32 * S)
            applied: list[int] = []
            apply = TouchTracker.apply
            monkeypatch.setattr(
                TouchTracker, "apply", lambda self, touch, at: (applied.append(at), apply(self, touch, at))[1]
            )
            for seconds in (20.0, 20.1, 20.2, 5.0):
                history.at(start_ns + round(seconds * S))
        assert len(applied) < 45


@pytest.mark.slow
def test_the_whole_drive_stands_above_as_one_picture_if_it_is_wanted_or_short(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def has_one(*topics: str, **more: bool) -> bool:
        with shown(path, *topics, **more) as player:
            return player.scanogram is not None and widgets_by_place(player)["mains"] == ["ScanogramWidget"]

    assert has_one()
    assert not has_one(scanogram=False)
    assert not has_one("/odom")
    monkeypatch.setattr("robowidgets.scanogram.overview.FEW", 99)
    assert has_one()
    monkeypatch.setattr("robowidgets.scanogram.overview.LONGEST", 0.0)
    assert not has_one()
    assert has_one(scanogram=True)


def test_the_bars_of_axes_that_no_speed_or_command_uses_are_left_out(path: Path, tmp_path: Path, data: Path) -> None:
    def is_planar(path: Path, **more: bool) -> bool:
        with shown(path, **more) as player:
            return bool(widget(player, SpeedWidget).planar)

    assert is_planar(path)
    assert not is_planar(robot.write(tmp_path / "climb", climb=0.1))
    assert not is_planar(data / "good" / "tilt_laser.bag")
    assert not is_planar(path, scanogram=False), "its speeds are not read before it is shown"


def test_without_a_scanogram_wide_widgets_or_a_map_stand_left_and_the_small_ones_right(path: Path) -> None:
    boxes = {
        (): {"wides": ["LaserWidget"], "smalls": ["SpeedWidget", "TouchWidget", "PathWidget"]},
        ("/odom", "/bumper"): {"wides": ["PathWidget"], "smalls": ["SpeedWidget", "TouchWidget"]},
        ("/bumper",): {"smalls": ["TouchWidget"]},
    }
    for names, expected in boxes.items():
        with shown(path, *names, scanogram=False) as player:
            assert widgets_by_place(player) == {"bar": ["PlayerWidget"], "topics": ["TopicsWidget"], **expected}


@pytest.mark.slow
def test_a_scanogram_that_takes_long_at_the_measured_rate_is_left_out_and_a_line_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    empty = [(0.0, sweeps.scan(sweeps.START_NS, []))]
    path = sweeps.write(tmp_path / "long", empty + sweeps.numbered(1200, rays=40)[1:])
    monkeypatch.setattr("robowidgets.scanogram.overview.FEW", 47_999)
    monkeypatch.setattr("robowidgets.scanogram.overview.readings_per_second", lambda *_: 1_000.0)
    words = "no scanogram: 1,200 scans of 40 rays take about 48 s; recording.show(scanogram=True) makes it"
    for wanted, there, told in ((None, False, words), (False, False, ""), (True, True, "")):
        with shown(path, scanogram=wanted) as player:
            assert (player.scanogram is not None, synced(player.bar, "_note")) == (there, told)
    monkeypatch.setattr("robowidgets.scanogram.overview.readings_per_second", lambda *_: 4_800.0)
    with shown(path) as player:
        assert (player.scanogram is not None, synced(player.bar, "_note")) == (True, "")


def test_the_rate_of_a_scanogram_is_measured_on_its_first_scans(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = sweeps.write(tmp_path / "long", sweeps.numbered(2000, rays=400))
    clock = count(step=0.11)
    monkeypatch.setattr("robowidgets.scanogram.overview.time", SimpleNamespace(perf_counter=lambda: next(clock)))
    with open(path) as recording:
        first, second = islice(recording.scans("/scan").chunks(), 2)
        assert readings_per_second(recording, "/scan") == (first.ranges.size + second.ranges.size) / 0.22


def test_a_drive_of_which_every_scan_is_damaged_has_no_scanogram_and_no_words_on_it(tmp_path: Path) -> None:
    good = sweeps.numbered(30)
    path = sweeps.write(tmp_path / "torn", [(seconds, raw[:40]) for seconds, raw in good])
    with shown(path) as player:
        assert (player.scanogram, synced(player.bar, "_note")) == (None, "")
        assert player.notes[0].startswith("⚠ /scan: messages that cannot be shown are left out")


def test_the_bar_knows_the_date_of_the_start_if_there_is_one(path: Path, data: Path) -> None:
    with shown(path) as player:
        assert synced(player.bar, "_start") == robot.START_NS / S
    with shown(data / "good" / "turtlebot3_gazebo.bag", "/odom") as player:
        assert synced(player.bar, "_start") is None


def test_settings_of_the_player_itself_are_sent_as_its_own(player: Player, monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[dict] = []
    monkeypatch.setattr(player.comm, "send", lambda data, **_: sent.append(data["state"]))
    player.tooltip = "a drive"
    assert sent == [{"tooltip": "a drive"}]


def test_the_selection_to_play_is_selected_on_the_picture(player: Player) -> None:
    assert player.scanogram is not None
    player.selection = (2, 3)
    assert player.scanogram.selection == (2.0, 3.0)
    player.scanogram.selection = (4.0, 5.0, 0, 1)
    player.bar.selection = (4.0, 5.0)
    assert player.scanogram.selection == (4.0, 5.0, 0, 1)


class Hangs:
    """A condition that loops by mistake."""

    def __init__(self) -> None:
        self.threads: set[threading.Thread] = set()

    def __call__(self, _scan: Any) -> bool:
        self.threads.add(threading.current_thread())
        while True:
            time.sleep(0.001)


def test_a_condition_that_loops_holds_up_neither_a_click_in_the_list_nor_the_end(player: Player) -> None:
    hangs, laser = Hangs(), widget(player, LaserWidget)
    wall = laser.watch(hangs, name="wall")  # type: ignore[attr-defined]
    player._prefetcher.start()  # type: ignore[union-attr]  # as a page that requests its segments
    wait_for(lambda: wall.error, "it is switched off")
    assert wall.error.startswith("has not returned for 1 s, line ")
    assert {thread.name for thread in hangs.threads} == {"robowidgets-judge"}
    other = laser.watch(Hangs(), name="other")  # type: ignore[attr-defined]
    player._on_toggle("/bumper", False)
    assert ("/bumper",) not in widgets(player)
    assert other.error
    player.close()
    wait_for(lambda: not any(thread.is_alive() for thread in hangs.threads), "what looped was ended")

"""The events of a recording: as a table, in searches, with labels, in its player and in its pages."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

import robowidgets
from robowidgets import EventsWidget, conditions
from robowidgets.command import main
from robowidgets.events import frames as _event_frames
from robowidgets.messages.encoding import encode
from robowidgets.recording import Recording
from robowidgets.recordings import RecordingError, UnknownTopicError
from robowidgets.samples.event import Level

from . import program_run, recorded

LOG, TEXT, ARRAY = "rcl_interfaces/msg/Log", "std_msgs/msg/String", "diagnostic_msgs/msg/DiagnosticArray"
BOOL, POINT = "std_msgs/msg/Bool", "geometry_msgs/msg/Point"
TYPES = {"/rosout": LOG, "/says": TEXT, "/diagnostics": ARRAY, "/bumper": BOOL, "/place": POINT}


def line(text: str, level: int = 20, name: str = "node") -> dict[str, Any]:
    return {"level": level, "name": name, "msg": text}


def statuses(level: int, text: str) -> dict[str, Any]:
    return {"status": [{"level": level, "name": "motor", "message": text, "hardware_id": "", "values": []}]}


MESSAGES: tuple[tuple[float, str, dict[str, Any]], ...] = (
    (0.0, "/rosout", line("started")),
    (0.5, "/diagnostics", statuses(0, "fine")),
    (1.0, "/says", {"data": "hello"}),
    (1.0, "/bumper", {"data": False}),
    (1.5, "/diagnostics", statuses(0, "fine")),
    (2.0, "/rosout", line("lost the line", 30, "follower")),
    (2.5, "/bumper", {"data": True}),
    (3.0, "/bumper", {"data": False}),
    (4.0, "/diagnostics", statuses(2, "stuck")),
    (4.5, "/place", {"x": 1.0, "y": 2.0, "z": 0.0}),
    (6.0, "/says", {"data": "a" * 5000}),
    (8.0, "/rosout", line("Lost the map", 40, "amcl")),
)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return recorded.write(tmp_path_factory.mktemp("events") / "drive", TYPES, MESSAGES)


@pytest.fixture
def recording(path: Path) -> Iterator[Recording]:
    with robowidgets.open(path) as opened:
        yield opened


def write_log(folder: Path, encoding: str) -> Path:
    """A log of 302 lines in 30 s, among them a warning and an error; the frame of the first has a long name."""
    lines = [(i / 10, "/rosout", line(f"tick {i}")) for i in range(300)]
    warn, error = (30, 40) if encoding == "cdr" else (4, 8)
    lines += [(5.0, "/rosout", line("hot", warn, "motor")), (29.5, "/rosout", line("overcurrent", error, "motor"))]
    lines.sort(key=lambda one: one[0])
    if encoding == "cdr":
        return recorded.write(folder / "x", {"/rosout": LOG}, lines)
    with BagWriter(folder / "x.bag") as writer:
        store = get_typestore(Stores.ROS1_NOETIC)
        connection = writer.add_connection("/rosout", "rosgraph_msgs/msg/Log", typestore=store)
        for number, (seconds, _, fields) in enumerate(lines):
            one = {**fields, "header": recorded.stamped(0, "" if number else "a frame")}
            one["level"] = 2 if one["level"] == 20 else one["level"]
            raw = encode("ros1", "rosgraph_msgs/msg/Log", one)
            writer.write(connection, recorded.START_NS + round(seconds * 1e9), raw)
    return folder / "x.bag"


class TestTheTable:
    def test_has_what_happened_on_all_topics_in_the_order_of_time(self, recording: Recording) -> None:
        assert [(e.seconds, e.level.name, e.source, e.text[:20], e.topic) for e in recording.events()] == [
            (0.0, "INFO", "node", "started", "/rosout"),
            (0.5, "INFO", "motor", "OK: fine", "/diagnostics"),
            (1.0, "INFO", "", "hello", "/says"),
            (2.0, "WARN", "follower", "lost the line", "/rosout"),
            (2.5, "INFO", "", "touched", "/bumper"),
            (3.0, "INFO", "", "released", "/bumper"),
            (4.0, "ERROR", "motor", "stuck", "/diagnostics"),
            (6.0, "INFO", "", "a" * 20, "/says"),
            (8.0, "ERROR", "amcl", "Lost the map", "/rosout"),
        ]

    def test_has_those_that_are_asked_for_alone(self, recording: Recording) -> None:
        assert [e.seconds for e in recording.events(level="WARN")] == [2.0, 4.0, 8.0]
        assert [e.seconds for e in recording.events("/rosout", text="lost")] == [2.0, 8.0]
        assert [e.seconds for e in recording.events(level=Level.ERROR, start=4.0, end=8.0)] == [4.0]
        assert [e.seconds for e in recording[1.5:4.5].events("/diagnostics")] == [4.0]  # only new events

    def test_goes_into_other_libraries(self, recording: Recording) -> None:
        events = recording.events("/rosout")
        frame = events.to_pandas()
        assert frame.index.tolist() == [0.0, 2.0, 8.0]
        assert frame["level"].tolist() == ["INFO", "WARN", "ERROR"]
        assert events.to_polars()["text"].to_list() == ["started", "lost the line", "Lost the map"]
        assert events.to_arrow()["source"].to_pylist() == ["node", "follower", "amcl"]
        assert events.to_numpy()["times_ns"][0] == recording.start_ns

    def test_prints_its_first_rows_and_cuts_long_texts(self, recording: Recording) -> None:
        text = repr(recording.events("/says"))
        assert text.startswith("2 events\n")
        assert "a" * 99 + "…" in text
        assert "a" * 101 not in text
        assert len(recording.events("/says")[1].text) == 5000

    def test_says_which_topics_tell_of_events(self, recording: Recording) -> None:
        with pytest.raises(UnknownTopicError, match="'/place' has no events; topics with events: /rosout, /says"):
            recording.events("/place")
        with pytest.raises(UnknownTopicError, match="did you mean '/rosout'"):
            recording.events("/rosut")
        with pytest.raises(ValueError, match="level: expected one of DEBUG"):
            recording.events(level="LOUD")
        with pytest.raises(TypeError, match="text: expected words as text, got 3"):
            recording.events(text=3)  # type: ignore[arg-type]

    def test_that_would_not_fit_into_memory_is_refused_with_what_to_do(self, recording: Recording) -> None:
        recording.memory = 5000
        with pytest.raises(RecordingError, match=r"up to 6\.0 s take more than the 5 kB .*: select a span"):
            recording.events()
        assert len(recording.events(level="WARN")) == 3

    def test_has_states_and_versions_of_programs(self, tmp_path: Path) -> None:
        with robowidgets.open(program_run.write(tmp_path / "run")) as recording:
            assert [(e.seconds, e.source, e.text) for e in recording.events()] == [
                (0.0, "Walker", "→ forward"),
                (0.0, "Walker", "version 1"),
                (3.0, "Walker", "version 2"),
                (4.0, "Walker", "→ avoid"),
                (4.0, "Walker › avoid", "→ stop"),
                (5.0, "Walker › avoid", "→ turn_left"),
                (7.0, "Walker", "→ forward"),
            ]


class TestFind:
    def test_has_a_span_of_a_moment_for_each_event(self, recording: Recording) -> None:
        found = recording.find(conditions.event("/rosout", level="WARN", text="lost"))
        assert [(span.start, span.end) for span in found] == [(2.0, 2.0), (8.0, 8.0)]
        assert found.condition == "WARN or more with 'lost' on /rosout"

    def test_joins_it_with_other_conditions(self, recording: Recording) -> None:
        late = conditions.event(level="WARN") & (conditions.field("/place.x") > 0)
        assert [span.start for span in recording.find(late)] == [8.0]
        assert [span.start for span in recording.find(conditions.event("/says") | conditions.event(level="ERROR"))] == [
            1.0,
            4.0,
            6.0,
            8.0,
        ]

    def test_needs_a_topic_that_tells_of_events(self, recording: Recording) -> None:
        with pytest.raises(UnknownTopicError, match="'/place' has no events"):
            recording.find(conditions.event("/place"))

    def test_is_a_command(self, path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        assert main(["find", "--event", str(path), "--level", "warn", "--text", "LOST", "--json"]) == 0
        assert [span["start"] for span in json.loads(capsys.readouterr().out)["spans"]] == [2.0, 8.0]
        assert main(["find", str(path), "--event", "/says", "--level", "loud"]) == 2
        assert "find: --level: expected one of DEBUG" in capsys.readouterr().err
        assert main(["find", str(path), "--touched", "--level", "WARN"]) == 2
        assert "--level needs --event, which is missing" in capsys.readouterr().err


class TestThePlayer:
    def test_has_one_list_of_all_topics_that_are_asked_for_with_what_touched_it(self, recording: Recording) -> None:
        player = recording.show("/rosout", "/diagnostics")
        (view,) = player.views
        assert isinstance(view.widget, EventsWidget)
        assert view.widget.title == "/rosout, /diagnostics"
        assert [row.text for row in view.widget.rows] == [
            *("started", "OK: fine", "lost the line", "touched", "released", "stuck", "Lost the map")
        ]
        assert player.bar.get_state()["_followers"] == [view.widget.model_id]
        player.close()

    def test_has_a_frame_at_each_event_and_the_last_event_for_programs(self, recording: Recording) -> None:
        player = recording.show("/rosout")
        (view,) = player.views
        assert [timed.seconds for timed in view.track.frames(2.2, 9.0)] == [2.0, 2.5, 3.0, 8.0]
        assert [timed.seconds for timed in view.track.frames(0.5, 1.5)] == [0.0]
        player.seek(4.0)
        assert view.widget.wait(timeout=0).text == "released"
        player.close()

    def test_marks_errors_and_warnings_as_it_begins_and_others_when_asked_for(self, recording: Recording) -> None:
        player = recording.show("/rosout")
        assert player.marks == (
            (2.0, 2.0, "WARN: follower: lost the line"),
            (4.0, 4.0, "ERROR: motor: stuck"),
            (8.0, 8.0, "ERROR: amcl: Lost the map"),
        )
        player.marks = recording.events("/says").marks
        assert [mark[0] for mark in player.marks] == [1.0, 6.0]
        player.close()

    def test_has_the_rows_that_matter_most_and_says_so(
        self, recording: Recording, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(_event_frames, "MOST_ROWS", 4)
        player = recording.show("/rosout", "/says")
        (view,) = player.views
        assert [row.text for row in view.widget.rows if row.level > Level.INFO] == ["lost the line", "Lost the map"]
        (timed, *_) = view.track.frames(0.0, 1.0)
        assert timed.about["notes"][0].startswith("4 of 7 rows: errors and warnings first")
        player.close()

    @pytest.mark.parametrize("encoding", ["cdr", "ros1"])
    def test_has_every_warning_of_a_long_log_and_says_what_is_left_out(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, encoding: str
    ) -> None:
        monkeypatch.setattr(_event_frames, "MOST_LINES", 30)
        with robowidgets.open(write_log(tmp_path, encoding)) as log:
            player = log.show("/rosout")
        (view,) = player.views
        severe = [(row.seconds, row.text) for row in view.widget.rows if row.level >= Level.WARN]
        assert severe == [(pytest.approx(5.0), "hot"), (pytest.approx(29.5), "overcurrent")]
        assert [mark[2] for mark in player.marks] == ["WARN: motor: hot", "ERROR: motor: overcurrent"]
        assert len(view.widget.rows) == 2 + 28
        assert view.widget.rows[-1].seconds > 29
        (note,) = next(iter(view.track.frames(0.0, 1.0))).about["notes"]
        assert note == "1 of 11 lines below a warning in 302, and all others; recording.events() has all"
        player.close()

    def test_a_page_of_a_stretch_has_the_rows_of_it_alone(self, recording: Recording, tmp_path: Path) -> None:
        player = recording.show("/rosout")
        (view,) = player.views
        state = view.widget.within(2.0, 4.0)
        assert [row[5] for row in json.loads(state["_old"])] == ["lost the line", "touched", "released"]
        assert state["_span"] == [2.0, 4.0]
        assert player.to_html(tmp_path / "page.html", start=2, end=4).stat().st_size > 10_000
        player.close()


def test_a_calibration_is_an_event_of_a_topic_that_is_asked_for_by_name(tmp_path: Path) -> None:
    info = {"width": 640, "height": 480, "k": [320.0, 0, 320, 0, 320, 240, 0, 0, 1]}
    messages = [(i / 10, "/camera_info", info) for i in range(9)]
    types = {"/camera_info": "sensor_msgs/msg/CameraInfo", "/rosout": LOG}
    folder = recorded.write(tmp_path / "x", types, [*messages, (1.0, "/rosout", line("hello"))])
    with robowidgets.open(folder) as recording:
        assert [event.text for event in recording.events()] == ["hello"], "all of its messages would be read"
        assert len(recording.events("/camera_info")) == 1
        player = recording.show("/camera_info")
        try:
            (view,) = player.views
            assert isinstance(view.widget, EventsWidget)
        finally:
            player.close()

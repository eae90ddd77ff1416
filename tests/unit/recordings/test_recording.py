"""`Recording` and its methods."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer

from robowidgets import Scan, Speed, Touch
from robowidgets.recording import Recording, open
from robowidgets.recordings import Moment, RecordingError, Topic, UnknownTopicError
from robowidgets.recordings._info import heading, table_of
from robowidgets.recordings.topics import check

from ..pages import display_html
from . import recorded, robot, sweeps

S = 1_000_000_000


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return robot.write(tmp_path_factory.mktemp("recordings") / "drive")


@pytest.fixture
def recording(path: Path) -> Iterator[Recording]:
    with open(path) as recording:
        yield recording


def seconds(moments: object) -> list[float]:
    return [(m.time_ns - robot.START_NS) / S for m in moments]  # type: ignore[attr-defined]


class TestTopics:
    def test_tell_type_count_rate_and_widget(self, recording: Recording) -> None:
        told = {t.name: (t.type, t.count, t.rate and round(t.rate, 1), t.widget, t.commanded) for t in recording.topics}
        assert told == {
            "/scan": ("sensor_msgs/msg/LaserScan", 100, 10.0, "laser", False),
            "/odom": ("nav_msgs/msg/Odometry", 100, 10.0, "speed", False),
            "/cmd_vel": ("geometry_msgs/msg/Twist", 50, 10.0, "speed", True),
            "/bumper": ("kobuki_ros_interfaces/msg/BumperEvent", 4, 0.6, "touch", False),
            "/log": ("std_msgs/msg/String", 1, None, None, False),
        }

    @pytest.mark.parametrize(
        ("span", "whole", "rate"),
        [(0.0013, 2.0, None), (0.034, 60.0, None), (0.034, 0.05, 1000), (0.34, 60.0, 100), (34.0, 60.0, 1)],
    )
    def test_of_messages_that_all_come_as_a_node_starts_have_no_rate(
        self, tmp_path: Path, span: float, whole: float, rate: float | None
    ) -> None:
        text = {"data": "hello"}
        latched = [(i * span / 34, "/rosout", text) for i in range(35)]
        topics = dict.fromkeys(("/rosout", "/words"), "std_msgs/msg/String")
        with open(recorded.write(tmp_path / "x", topics, [*latched, (whole, "/words", text)])) as recording:
            assert recording.topics[0].rate == (rate and pytest.approx(rate, rel=1e-3))

    def test_span_the_time_of_the_recording(self, recording: Recording, path: Path) -> None:
        assert (recording.start_ns, recording.end_ns) == (robot.START_NS, robot.START_NS + 10 * S)
        assert recording.duration == 10.0
        assert recording.path == path
        assert recording.problems == ()


class TestSamples:
    def test_come_in_the_order_of_time_with_their_topic(self, recording: Recording) -> None:
        moments = list(recording.samples())
        assert len(moments) == 254
        assert seconds(moments) == sorted(seconds(moments))
        kinds = {m.topic: type(m.sample) for m in moments}
        assert kinds == {"/scan": Scan, "/odom": Speed, "/cmd_vel": Speed, "/bumper": Touch}
        assert isinstance(moments[0], Moment)
        assert [m.seconds for m in moments] == seconds(moments)

    def test_of_one_topic_or_several(self, recording: Recording) -> None:
        assert {m.topic for m in recording.samples("/bumper")} == {"/bumper"}
        assert {m.topic for m in recording.samples(["/bumper", "/scan", "/scan"])} == {"/bumper", "/scan"}
        assert len(list(recording.samples(["/scan", "/scan"]))) == 100
        assert list(recording.samples([])) == []

    def test_of_a_part_of_the_time_the_end_not_included(self, recording: Recording) -> None:
        assert seconds(recording.samples("/scan", 2.0, 2.3)) == [2.0, 2.1, 2.2]
        assert seconds(recording.samples("/scan", end=0.2)) == [0.0, 0.1]
        assert seconds(recording.samples("/scan", start=9.75)) == [9.8, 9.9]
        assert seconds(recording.samples("/scan", start=-5, end=0.1)) == [0.0]

    def test_are_the_numbers_that_were_sent(self, recording: Recording) -> None:
        scan, speed = (next(recording.samples(topic, 1.0)).sample for topic in ("/scan", "/odom"))
        assert isinstance(scan, Scan)
        assert scan.ranges.tolist() == [pytest.approx(1.1)]
        assert scan.stamp_ns == robot.START_NS + S
        assert isinstance(speed, Speed)
        assert (speed.linear[0], speed.frame_id) == (0.1, "base_link")

    @pytest.mark.parametrize(
        "read", [lambda recording: list(recording.samples()), lambda recording: recording.speeds()]
    )
    def test_of_two_frames_on_one_topic_are_reported_once_they_were_read(
        self, tmp_path: Path, read: Callable[[Recording], Iterable[Moment]]
    ) -> None:
        with open(robot.write(tmp_path / "two", second_frame="robot2/base_link")) as recording:
            assert recording.problems == ()
            assert len(list(recording.samples("/odom", end=5.0))) == 50
            assert recording.problems == ()
            assert all(moment.topic for moment in read(recording))
            assert recording.problems == ("/odom: speeds of 2 frames: base_link, robot2/base_link",)

    def test_that_cannot_be_shown_are_left_out_and_reported(self, tmp_path: Path) -> None:
        with open(robot.write(tmp_path / "bad", bad_scan_at=33)) as recording:
            assert recording.problems == ()
            for _ in range(2):
                assert len(list(recording.samples("/scan"))) == 99
            assert recording.problems == (
                "/scan: messages that cannot be shown are left out, the first at 3.30 s: range_max: expected metres "
                "above range_min (30), got 0.1; are the two swapped?",
            )
            at = recording.at("/scan", 3.35)
            assert at is not None
            assert seconds([at]) == [3.2]

    def test_may_be_asked_for_while_others_are_read(self, recording: Recording) -> None:
        first, second = recording.samples("/scan"), recording.samples("/scan", 5.0)
        assert [seconds([next(first), next(second)]) for _ in range(2)] == [[0.0, 5.0], [0.1, 5.1]]
        at = recording.at("/odom", 8.0)
        assert at is not None
        assert seconds([at, next(first)]) == [8.0, 0.2]


class TestAt:
    @pytest.mark.parametrize(
        ("topic", "asked", "expected"),
        [
            ("/scan", 0.0, 0.0), ("/scan", 4.55, 4.5), ("/scan", 9.9, 9.9), ("/scan", 99.0, 9.9), ("/scan", -0.1, None),
            ("/bumper", 1.99, None), ("/bumper", 2.0, 2.0), ("/bumper", 5.9, 3.0), ("/bumper", 10.0, 7.0),
            ("/cmd_vel", 4.99, None),
        ],
    )  # fmt: skip
    def test_is_the_last_sample_up_to_a_time(
        self, recording: Recording, topic: str, asked: float, expected: float | None
    ) -> None:
        moment = recording.at(topic, asked)
        assert (moment and seconds([moment])[0]) == expected

    def test_agrees_with_reading_all_of_it(self, recording: Recording) -> None:
        for topic in ("/scan", "/bumper"):
            for moment in recording.samples(topic):
                assert recording.at(topic, moment.seconds).time_ns == moment.time_ns  # type: ignore[union-attr]

    def test_decodes_no_more_than_it_needs(self, recording: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
        decoded: list[int] = []
        for decoder in recording._messages._decoders.values():

            def decode(raws: list[bytes], *args: Any, _decode: Any = decoder.decode) -> Any:
                decoded.append(len(raws))
                return _decode(raws, *args)

            monkeypatch.setattr(decoder, "decode", decode)
        recording.at("/scan", 9.0)
        recording.at("/bumper", 10.0)
        assert decoded == [1, 1]

    @pytest.mark.slow
    def test_reads_a_silence_once(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        times = [*(i / 10 for i in range(200)), 5000.0, 5000.1, 9000.0]
        scans = [(time, sweeps.scan(sweeps.START_NS, [1.0])) for time in times]
        with open(sweeps.write(tmp_path / "scans", scans)) as recording:
            read = []
            source = recording._messages._source

            def messages(*given: Any, _messages: Any = source.messages) -> Any:
                for message in _messages(*given):
                    read.append(message)
                    yield message

            monkeypatch.setattr(source, "messages", messages)
            for asked in range(30, 5000, 60):
                moment = recording.at("/scan", asked)
                assert moment
                assert moment.seconds == pytest.approx(19.9)
            assert len(read) <= 200
            shuffled = np.random.default_rng(1).permutation(
                [*np.arange(-5, 9100, 7.3), *times, *np.arange(0, 22, 0.07)]
            )
            for asked in shuffled:
                moment = recording.at("/scan", asked)
                expected = max((time for time in times if time <= asked), default=None)
                assert (moment and moment.seconds) == (expected and pytest.approx(expected))


class TestErrors:
    def test_name_the_topics_there_are(self, recording: Recording) -> None:
        for ask in (
            lambda: recording.samples("/scam"),
            lambda: recording.at("/scam", 1),
            lambda: recording.show("/scam"),
        ):
            with pytest.raises(UnknownTopicError) as caught:
                ask()
            assert str(caught.value) == (
                "drive has no topic '/scam'; topics with a widget: /scan, /odom, /cmd_vel, /bumper; "
                "did you mean '/scan'?"
            )
        assert isinstance(caught.value, KeyError)
        assert isinstance(caught.value, RecordingError)

    def test_say_why_a_topic_is_not_shown(self, recording: Recording) -> None:
        with pytest.raises(UnknownTopicError, match=r"'/log' cannot be shown \(no widget shows std_msgs/msg/String\)"):
            recording.samples(["/scan", "/log"])
        topic = Topic("/odd", "my_msgs/msg/Odd", 1, None, None, False, "no definition of its messages")
        with pytest.raises(UnknownTopicError, match=r"\(no definition of its messages\): topics that can: none$"):
            check("/odd", (topic,), "drive")

    def test_name_a_topic_that_is_not_a_text(self, recording: Recording) -> None:
        with pytest.raises(TypeError, match=r"expected the name of a topic as text, got \['/scan', '/odom'\]"):
            recording.show(["/scan", "/odom"])  # type: ignore[arg-type]
        with pytest.raises(TypeError, match="expected the name of a topic as text, got None"):
            recording.at(None, 1.0)  # type: ignore[arg-type]

    @pytest.mark.parametrize("value", [None, "5", 1j])
    def test_name_a_time_that_is_not_a_number(self, recording: Recording, value: object) -> None:
        with pytest.raises(TypeError, match="seconds: expected seconds from the start of the recording, got"):
            recording.at("/scan", value)  # type: ignore[arg-type]

    @pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e300])
    def test_name_an_invalid_time(self, recording: Recording, value: float) -> None:
        with pytest.raises(ValueError, match="seconds: expected seconds from the start of the recording, got"):
            recording.at("/scan", value)
        with pytest.raises(ValueError, match="end: expected seconds"):
            recording.samples("/scan", end=value)

    def test_say_that_it_is_closed(self, path: Path) -> None:
        with open(path) as recording:
            pass
        recording.close()
        for ask in (lambda: recording.samples("/scan"), lambda: recording.at("/scan", 1)):
            with pytest.raises(RecordingError, match="drive is closed: open it again"):
                ask()
        assert len(recording.topics) == 5


class TestItsTable:
    def test_is_what_printing_shows(self, recording: Recording) -> None:
        head, names, *rows = repr(recording).splitlines()
        assert head == f"{recording.path}: 10.0 s, from 2023-11-14 22:13:20 UTC, 5 topics, 255 messages"
        assert names.split() == ["topic", "type", "messages", "Hz", "widget"]
        assert rows[2].split() == ["/cmd_vel", "geometry_msgs/msg/Twist", "50", "10.0", "speed", "(commanded)"]
        assert rows[4].split() == ["/log", "std_msgs/msg/String", "1"]
        slow = table_of("drive", (Topic("/map", "my_msgs/msg/Map", 2, 0.03, None, False, ""),), ()).to_text()
        assert slow.splitlines()[2].split() == ["/map", "my_msgs/msg/Map", "2", "<0.1"]
        assert recording.info() == repr(recording)

    def test_tells_what_is_wrong(self) -> None:
        topic = Topic("/odd", "my_msgs/msg/Odd", 1200, None, None, False, "no definition")
        text = table_of("drive", (topic,), ("/odd: no definition",)).to_text()
        assert text.splitlines()[2:] == [
            "  /odd   my_msgs/msg/Odd     1,200      unreadable",
            "! /odd: no definition",
        ]

    def test_of_nothing_says_so(self, tmp_path: Path) -> None:
        with Writer(tmp_path / "drive", version=9, storage_plugin=StoragePlugin.MCAP):
            pass
        with open(tmp_path / "drive") as recording:
            assert recording.duration == 0.0
            head, problem = repr(recording).splitlines()
        assert head == f"{tmp_path / 'drive'}: 0.0 s, 0 topics, 0 messages"
        assert problem == "! there is no message in it: nothing was recorded"

    def test_in_a_notebook_is_a_table_without_markup_from_the_file(self, recording: Recording) -> None:
        html = display_html(recording)
        assert html.count("<tr>") == 6
        assert '<td style="text-align:left">/scan</td>' in html
        evil = "<script>alert('x')</script>&"
        topic = Topic(evil, evil, 1, None, None, False, evil)
        html = table_of(heading(evil, (topic,), 1.0, None), (topic,), (evil,)).to_html()
        assert "<script" not in html
        assert html.count("&lt;script&gt;alert(&#x27;x&#x27;)&lt;/script&gt;&amp;") == 4


@pytest.mark.slow
def test_reading_a_recording_needs_no_page_and_importing_robowidgets_no_reader(path: Path) -> None:
    code = (
        "import sys, robowidgets; assert 'rosbags' not in sys.modules; "
        f"recording = robowidgets.open({str(path)!r}); assert len(list(recording.samples())) == 254; "
        "assert 'rosbags' in sys.modules and 'robowidgets.screens.player' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)

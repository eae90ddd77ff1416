"""CARMEN logs: their lines, their clocks, and the log as a whole."""

from __future__ import annotations

import gzip
from collections.abc import Callable, Sequence
from math import degrees, pi
from pathlib import Path

import numpy as np
import pytest

import robowidgets
from robowidgets import Recording, RecordingError, Scan, Speed
from robowidgets.repair import open_repaired
from robowidgets.repair._carmen_lines import LONGEST
from robowidgets.samples import Pose

from ..recordings.clock_back import START_NS

S = 1_000_000_000
EPOCH = START_NS / 1e9

Open = Callable[..., Recording]


@pytest.fixture
def log(tmp_path: Path) -> Open:
    """Opens a log of these lines."""

    def open_log(*lines: bytes) -> Recording:
        path = tmp_path / "drive.log"
        path.write_bytes(b"\n".join((b"# CARMEN", *lines)) + b"\n")
        return robowidgets.open(path)

    return open_log


def flaser(count: int = 180, time: float = 1.0, far: float = 81.83) -> bytes:
    ranges = " ".join(str(far if i % 3 == 0 else i / 10) for i in range(count))
    return f"FLASER {count} {ranges} 0 0 0 0 0 0 {time} host {time}".encode()


def odom(forward: float = 0.5, turn: float = -0.1, time: object = 1.0) -> bytes:
    return f"ODOM 1 2 0.5 {forward} {turn} 0 {time} host {time}".encode()


def scan_of(recording: Recording) -> Scan:
    (moment,) = (moment for moment in recording.samples() if isinstance(moment.sample, Scan))
    assert isinstance(moment.sample, Scan)
    return moment.sample


class TestTheClock:
    def open(self, log: Open, times: Sequence[object]) -> Recording:
        return log(*(odom(time=time) for time in times))

    def check(self, recording: Recording, *seconds: float) -> None:
        assert [moment.seconds for moment in recording.samples("ODOM")] == pytest.approx(seconds)

    def test_is_kept_when_it_runs(self, log: Open) -> None:
        recording = self.open(log, [1.0, 1.5, 1.5, 2.0])
        self.check(recording, 0, 0.5, 0.5, 1)
        assert (recording.start_ns, recording.problems) == (S, ())

    def test_is_held_when_it_goes_back_a_little(self, log: Open) -> None:
        recording = self.open(log, [1.0, 2.0, 1.5, 1.75, 3.0])
        self.check(recording, 0, 1, 1, 1, 2)
        assert recording.problems == (
            "the clock goes back once, by up to 0.50 s: order is kept, time stands still meanwhile",
        )

    def test_goes_on_when_it_was_set_back_for_good(self, log: Open) -> None:
        recording = self.open(log, [100.0, 101.0, 3.0, 4.0, 6.0])
        self.check(recording, 0, 1, 1, 2, 4)
        assert "once, by up to 98.00 s" in recording.problems[0]

    def test_is_not_taken_for_set_back_by_one_stray_time(self, log: Open) -> None:
        self.check(self.open(log, [100.0, 101.0, 0.0, 102.0, 103.0]), 0, 1, 1, 2, 3)

    def test_is_replaced_when_it_stands_still(self, log: Open) -> None:
        recording = self.open(log, [0.0] * 30)
        self.check(recording, *(i / 10 for i in range(30)))
        assert recording.problems[0] == (
            "the clock stood still (1 different time in 30 lines): the lines are set 0.1 s apart, in their order"
        )

    def test_may_miss_in_places(self, log: Open) -> None:
        recording = self.open(log, ["nan", 1.0, "none", 2.0])
        self.check(recording, 0, 0, 0, 1)
        assert recording.start_ns == S
        assert recording.problems == ()

    def test_goes_on_after_a_leap_ahead(self, log: Open) -> None:
        recording = self.open(log, [1.0, 2.0, EPOCH, EPOCH + 1])
        assert recording.problems == (
            "the clock jumps ahead once, by 19,675.9 days: time goes on without a gap, dated 2023-11-14",
        )
        self.check(recording, 0, 1, 1, 2)
        assert recording.end_ns == START_NS + S

    @pytest.mark.parametrize("stray", ["inf", "1e300", "nan", "-1e300", "4e9"])
    def test_is_not_led_astray_by_one_time(self, log: Open, stray: str) -> None:
        recording = self.open(log, [EPOCH, EPOCH + 1, stray, EPOCH + 2, EPOCH + 3])
        assert recording.start_ns == START_NS
        seconds = [moment.seconds for moment in recording.samples("ODOM")]
        assert len(seconds) == 5
        assert seconds[-1] == pytest.approx(2.5, abs=0.5)


class TestAScan:
    @pytest.mark.parametrize(
        ("count", "first", "step"),
        [(180, -90, 1), (181, -90, 1), (360, -90, 0.5), (361, -90, 0.5), (401, -50, 0.25), (91, -90, 2)],
    )
    def test_is_spread_as_carmen_spreads_it(self, log: Open, count: int, first: float, step: float) -> None:
        scan = scan_of(log(flaser(count)))
        assert len(scan) == count
        assert degrees(scan.angle_min) == pytest.approx(first)
        assert degrees(scan.angle_increment) == pytest.approx(step)

    def test_has_its_numbers_time_and_frame(self, log: Open) -> None:
        scan = scan_of(log(flaser(time=12.5)))
        assert scan.ranges[1:3].tolist() == pytest.approx([0.1, 0.2])
        assert scan.stamp_ns == 12_500_000_000
        assert scan.frame_id == "front_laser"
        assert scan_of(log(flaser().replace(b"FLASER", b"RLASER"))).frame_id == "rear_laser"

    def test_a_range_that_no_float32_holds_is_infinite(self, log: Open) -> None:
        assert scan_of(log(flaser(far=1e300))).ranges[0] == np.inf

    def test_looks_from_the_right_to_the_left(self, log: Open) -> None:
        scan = scan_of(log(flaser()))
        assert scan.angles[0] == pytest.approx(-pi / 2)
        assert scan.y[1] < 0

    def test_of_the_newer_format_tells_its_own_angles_and_limits(self, log: Open) -> None:
        line = b"ROBOTLASER1 0 -1.5 3.0 0.75 30.0 0.01 0 5 1 2 3 4 5 5 9 8 7 6 5 0 0 0 0 0 0 0.1 0.2 0 0 0 7.5 host 7.6"
        scan = scan_of(log(line))
        assert (len(scan), scan.angle_min, scan.angle_increment, scan.range_max) == (5, -1.5, 0.75, 30.0)
        assert scan.intensities.tolist() == [9, 8, 7, 6, 5]
        assert scan.frame_id == "robotlaser1"
        raw = scan_of(log(b"RAWLASER2 0 0 3.14 0 30.0 0.01 0 3 1 2 3 0 7.5 host 7.6"))
        assert raw.angle_increment == pytest.approx(3.14 / 2)

    @pytest.mark.parametrize(
        "line",
        [
            b"FLASER 180 1 2 3",
            b"FLASER x 1 2 3 4 5 6 7 8 9 10",
            flaser()[:300],
            b"FLASER -1 0 0 0 0 0 0 0 h 0",
            b"ROBOTLASER1 0 -1.5 3.0 0.75 30.0 0.01 0 500 1 2 3 4 5 host 7.6",
        ],
    )
    def test_that_was_cut_is_left_out_and_gives_no_time(self, log: Open, line: bytes) -> None:
        recording = log(odom(time=1), line, odom(time=2))
        assert [(topic.name, topic.count) for topic in recording.topics] == [("ODOM", 2)]
        assert recording.duration == 1
        (problem,) = recording.problems
        word = line.split()[0].decode()
        assert problem.startswith(f"{word}: left out 1 line that cannot be read, such as: ")
        assert problem.endswith(("the line is cut", "it is cut", "invalid literal for int() with base 10: b'x'"))


class TestLinesThatWereJoined:
    """A block of zeros, or one that is missing, joins the head of a line to the tail of a later one."""

    def test_by_zeros_are_left_out_and_reported(self, log: Open) -> None:
        first, second, third = flaser(time=1), flaser(time=2), flaser(time=3)
        recording = log(first, second[:400] + bytes(64) + third[464:], flaser(time=4))
        assert [moment.seconds for moment in recording.samples("FLASER")] == [0, 3]
        assert recording.problems == (
            "64 bytes of the log are zeros, in 1 place: the lines that they replace or cut are left out",
        )

    def test_by_zeros_within_a_number_are_left_out(self, log: Open) -> None:
        torn = odom(time=2).replace(b"-0.1", b"-0.1\0\0")
        recording = log(odom(time=1), torn, b"\0\0 3.0 host 3.0", odom(time=4))
        assert [moment.seconds for moment in recording.samples("ODOM")] == [0, 3]
        assert recording.problems[0].startswith("4 bytes of the log are zeros, in 2 places: ")

    @pytest.mark.parametrize("cut", [330, 600, 790])
    def test_without_a_trace_have_too_many_words_or_too_few(self, log: Open, cut: int) -> None:
        joined = flaser(time=2)[:cut] + flaser(time=3)[480:]
        recording = log(flaser(time=1), joined, flaser(time=4))
        assert [moment.seconds for moment in recording.samples("FLASER")] == [0, 3]
        (problem,) = recording.problems
        assert problem.startswith("FLASER: left out 1 line that cannot be read, such as: expected ")

    def test_of_speeds_have_too_many_words(self, log: Open) -> None:
        recording = log(odom(time=1), b"ODOM 1 2 0.5 0.5 " + odom(time=2), odom(time=4))
        assert [moment.seconds for moment in recording.samples("ODOM")] == [0, 3]
        assert recording.problems == (
            "ODOM: left out 1 line that cannot be read, such as: "
            "expected 10 words other than readings, got 15: the line is cut, or joined to another",
        )

    def test_do_not_turn_a_measured_speed_into_an_estimate(self, log: Open) -> None:
        recording = log(odom(time=1), b"ODOM 1 2\0\0 0 host 0", b"NEFF 26.4", odom(time=2))
        assert [(topic.name, topic.count) for topic in recording.topics] == [("ODOM", 2)]

    def test_differ_from_lines_to_which_a_program_added_a_word(self, log: Open) -> None:
        recording = log(*(flaser(time=time).replace(b" host", b" 0.1 host") for time in (1, 2, 3)), flaser(time=4))
        assert [moment.seconds for moment in recording.samples("FLASER")] == [0, 1, 2, 3]
        assert recording.problems == ()


class TestTheLongestRange:
    def test_is_carmens_where_nothing_is_coded(self, log: Open) -> None:
        assert scan_of(log(flaser(far=19.0))).range_max == LONGEST
        assert scan_of(log(flaser(0))).range_max == LONGEST

    @pytest.mark.parametrize(("code", "longest"), [(81.83, 80.0), (51.15, 51.13), (32.767, 32.74), (8.191, 80.0)])
    def test_ends_below_the_number_that_means_nothing(self, log: Open, code: float, longest: float) -> None:
        assert scan_of(log(flaser(far=code))).range_max == pytest.approx(longest)


class TestASpeed:
    def test_is_forward_and_turning(self, log: Open) -> None:
        (moment,) = log(odom(0.5, -0.1, 2.0)).samples("ODOM")
        pose = moment.sample.pose
        assert moment.sample == Speed((0.5, 0.0, 0.0), (0.0, 0.0, -0.1), 2 * S, "base_link", pose)
        assert pose == pytest.approx(Pose(1.0, 2.0, 0.5))

    def test_that_was_cut_is_left_out(self, log: Open) -> None:
        recording = log(odom(time=1), b"ODOM 1 2 3", odom(time=2))
        assert recording.topics[0].count == 2
        assert recording.problems == (
            "ODOM: left out 1 line that cannot be read, such as: "
            "expected 10 words or more in a line ODOM, got 4: it is cut",
        )

    def test_comes_with_the_pose_of_the_robot(self, log: Open) -> None:
        (transform,) = log(odom()).transforms()
        assert (transform.parent, transform.child) == ("odom", "base_link")
        assert transform.pose[:3] == (1.0, 2.0, 0.0)

    def test_that_holds_no_numbers_is_reported(self, log: Open) -> None:
        recording = log(odom(), b"ODOM x y z fast slow 0 2.0 host 2.0")
        samples = [moment.sample for moment in recording.samples("ODOM")]
        assert len(samples) == 2
        assert np.isnan(samples[1].values).any()


class TestALog:
    LINES = (
        b"PARAM a b nohost 0",
        odom(time=1),
        flaser(time=2),
        b"",
        b"FLASERS 1",
        odom(0.6, time=3),
        b"FLASER 180 1 2",
        odom(time=5),
    )

    def test_lists_its_messages_as_topics(self, log: Open) -> None:
        recording = log(*self.LINES)
        assert [(topic.name, topic.type, topic.count, topic.widget) for topic in recording.topics] == [
            ("ODOM", "nav_msgs/msg/Odometry", 3, "speed"),
            ("FLASER", "sensor_msgs/msg/LaserScan", 1, "laser"),
        ]
        assert (recording.start_ns, recording.end_ns) == (S, 5 * S)
        assert recording.topics[0].rate == pytest.approx(0.5)

    def test_gives_its_lines_in_their_order(self, log: Open) -> None:
        assert [(m.topic, m.time_ns // S) for m in log(*self.LINES).samples()] == [
            ("ODOM", 1), ("FLASER", 2), ("ODOM", 3), ("ODOM", 5)
        ]  # fmt: skip

    def test_gives_a_part_of_its_time(self, log: Open) -> None:
        recording = log(*self.LINES)
        assert [(m.time_ns // S, m.seconds) for m in recording.samples("ODOM", 1, 4)] == [(3, 2.0)]
        assert list(recording.samples("FLASER", 2)) == []

    def test_knows_the_last_sample_at_a_time(self, log: Open) -> None:
        recording = log(*self.LINES)
        at = [recording.at("ODOM", seconds) for seconds in (-0.1, 0.0, 1.9, 2.0, 98.0)]
        assert [moment and moment.time_ns // S for moment in at] == [None, 1, 1, 3, 5]
        scan = recording.at("FLASER", 98)
        assert scan is not None
        assert isinstance(scan.sample, Scan)
        assert scan.time_ns == 2 * S

    def test_counts_what_a_mapper_wrote_for_itself_apart(self, log: Open) -> None:
        recording = log(odom(time=1), flaser(time=2), odom(0.0, 0.0, 0.0), b"NEFF 26.4", odom(time=3))
        assert [(topic.name, topic.type, topic.count, topic.widget) for topic in recording.topics] == [
            ("ODOM", "nav_msgs/msg/Odometry", 2, "speed"),
            ("FLASER", "sensor_msgs/msg/LaserScan", 1, "laser"),
            ("NEFF", "geometry_msgs/msg/Pose2D", 1, None),
        ]
        assert recording.problems == ()
        assert [m.time_ns // S for m in recording.samples("ODOM")] == [1, 3]

    def test_without_lines_is_empty(self, log: Open) -> None:
        recording = log(b"PARAM a b nohost 0")
        assert (recording.topics, recording.start_ns, recording.end_ns) == ((), None, None)
        assert list(recording.samples()) == []
        assert recording.problems == ("there is no message in it: nothing was recorded",)

    def test_of_which_every_line_is_cut_says_so(self, log: Open) -> None:
        with pytest.raises(RecordingError, match=r"^drive\.log: .*nothing can be saved"):
            log(b"FLASER 180 1 2", b"FLASER 180 1 2 3")

    def test_whose_compression_was_cut_gives_what_it_holds(self, tmp_path: Path) -> None:
        path = tmp_path / "cut.log.gz"
        path.write_bytes(gzip.compress(b"\n".join(odom(time=i + i * i / 1e6) for i in range(5000)))[:-2000])
        source = open_repaired([path])
        assert 1000 < source.channels[0].count < 5000
        assert source.problems[0] == "the file was cut off or is damaged: read what could be decompressed"

    @pytest.mark.parametrize("missing", [0, 1, 2, 4, 5, 6, 7, 8, 30, 41, 43])
    def test_that_was_cut_in_its_last_line_ends_with_the_line_before(self, tmp_path: Path, missing: int) -> None:
        path = tmp_path / "cut.log"
        whole = b"\n".join(odom(time=f"{1000 + i / 100:.2f}") for i in range(25))
        last = b"ODOM 1 2 0.5 0.5 -0.1 0 1000.259 host 1000.259"
        path.write_bytes(whole + b"\n" + last[: len(last) - missing])
        with robowidgets.open(path) as recording:
            (topic,) = recording.topics
            assert (topic.count, recording.duration) == (25, pytest.approx(0.24))
            assert recording.problems == ("the log was cut off within its last line, which is left out",)

    def test_that_was_cut_after_an_estimate_without_a_time_does_not_set_the_clock_back(self, tmp_path: Path) -> None:
        path = tmp_path / "cut.log"
        timed = [odom(time=f"{1000 + i / 100:.2f}") for i in range(25)]
        path.write_bytes(b"\n".join([*timed, odom(time="0"), b"NEFF 26.4", b"ODOM 1 2 0.5 0.5 -0.1 0 1000.25 host 1"]))
        with robowidgets.open(path) as recording:
            assert recording.duration == pytest.approx(0.24)
            assert recording.problems == ("the log was cut off within its last line, which is left out",)

    def test_of_one_file_among_several_is_read_with_them(self, tmp_path: Path) -> None:
        paths = [tmp_path / "1.log", tmp_path / "2.log.gz"]
        paths[0].write_bytes(odom(time=1))
        paths[1].write_bytes(gzip.compress(odom(time=2)))
        source = open_repaired(paths)
        assert [time_ns for _, time_ns, _ in source.messages(source.channels)] == [S, 2 * S]

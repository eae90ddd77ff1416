"""CARMEN logs: clocks, lines and the log as a whole."""

from __future__ import annotations

from math import degrees, nan, pi

import numpy as np
import pytest
from robowidgets.recordings.timeline import Moment
from robowidgets.repair._carmen_clock import steady

from robowidgets import Scan, Speed
from robowidgets.repair._carmen import CarmenLog
from robowidgets.repair._carmen_lines import LONGEST, new_scan, old_scan, range_max_of, speed, time_of, word_of

S = 1_000_000_000


def flaser(count: int = 180, time: float = 1.0, far: float = 81.83) -> bytes:
    ranges = " ".join(str(far if i % 3 == 0 else i / 10) for i in range(count))
    return f"FLASER {count} {ranges} 0 0 0 0 0 0 {time} host {time}".encode()


def odom(forward: float = 0.5, turn: float = -0.1, time: float = 1.0) -> bytes:
    return f"ODOM 1 2 0.5 {forward} {turn} 0 {time} host {time}".encode()


class TestTheClock:
    def test_is_kept_when_it_runs(self) -> None:
        assert steady([1.0, 1.5, 1.5, 2.0]) == ([S, 1_500_000_000, 1_500_000_000, 2 * S], True, "")

    def test_is_held_when_it_goes_back_a_little(self) -> None:
        times, timed, line = steady([1.0, 2.0, 1.5, 1.75, 3.0])
        assert times == [S, 2 * S, 2 * S, 2 * S, 3 * S]
        assert timed
        assert line == "the clock goes back once, by up to 0.50 s: order is kept, time held meanwhile"

    def test_goes_on_when_it_was_set_back_for_good(self) -> None:
        times, _, line = steady([100.0, 101.0, 3.0, 4.0, 6.0])
        assert times == [100 * S, 101 * S, 101 * S, 102 * S, 104 * S]
        assert "once, by up to 98.00 s" in line

    def test_is_not_taken_for_set_back_by_one_stray_time(self) -> None:
        times, _, _ = steady([100.0, 101.0, 0.0, 102.0, 103.0])
        assert times == [100 * S, 101 * S, 101 * S, 102 * S, 103 * S]

    def test_is_replaced_when_it_stands_still(self) -> None:
        times, timed, line = steady([0.0] * 30)
        assert times == [i * S // 10 for i in range(30)]
        assert not timed
        assert line.startswith("the clock stood still (1 different time in 30 lines): the lines are set 0.1 s apart")

    def test_may_miss_in_places(self) -> None:
        times, _, line = steady([nan, 1.0, nan, 2.0])
        assert times == [S, S, S, 2 * S]
        assert "goes back" in line

    def test_of_nothing_is_nothing(self) -> None:
        assert steady([]) == ([], True, "")


class TestAScan:
    @pytest.mark.parametrize(
        ("count", "first", "step"),
        [(180, -90, 1), (181, -90, 1), (360, -90, 0.5), (361, -90, 0.5), (401, -50, 0.25), (91, -90, 2)],
    )
    def test_is_spread_as_carmen_spreads_it(self, count: int, first: float, step: float) -> None:
        scan = old_scan(flaser(count), LONGEST)
        assert len(scan) == count
        assert degrees(scan.angle_min) == pytest.approx(first)
        assert degrees(scan.angle_increment) == pytest.approx(step)

    def test_has_its_numbers_time_and_frame(self) -> None:
        scan = old_scan(flaser(time=12.5), LONGEST)
        assert scan.ranges[1:3].tolist() == pytest.approx([0.1, 0.2])
        assert scan.stamp_ns == 12_500_000_000
        assert scan.frame_id == "front_laser"
        assert old_scan(flaser().replace(b"FLASER", b"RLASER"), LONGEST).frame_id == "rear_laser"

    def test_of_the_newer_format_tells_its_own_angles_and_limits(self) -> None:
        line = b"ROBOTLASER1 0 -1.5 3.0 0.75 30.0 0.01 0 5 1 2 3 4 5 5 9 8 7 6 5 0 0 0 0 0 0 0.1 0.2 0 0 0 7.5 host 7.6"
        scan = new_scan(line)
        assert (len(scan), scan.angle_min, scan.angle_increment, scan.range_max) == (5, -1.5, 0.75, 30.0)
        assert scan.intensities.tolist() == [9, 8, 7, 6, 5]
        assert scan.frame_id == "robotlaser1"
        raw = new_scan(b"RAWLASER2 0 0 3.14 0 30.0 0.01 0 3 1 2 3 0 7.5 host 7.6")
        assert raw.angle_increment == pytest.approx(3.14 / 2)

    @pytest.mark.parametrize(
        "line", [b"FLASER 180 1 2 3", b"FLASER x 1 2 3 4 5 6 7 8 9 10", flaser()[:300], b"FLASER -1 0 0 0 0 0 0 0 h 0"]
    )
    def test_that_was_cut_is_refused(self, line: bytes) -> None:
        with pytest.raises(ValueError, match=r"the line is cut|it is cut|invalid literal"):
            old_scan(line, LONGEST)

    def test_that_was_cut_is_refused_in_the_newer_format_too(self) -> None:
        with pytest.raises(ValueError, match="the line is cut"):
            new_scan(b"ROBOTLASER1 0 -1.5 3.0 0.75 30.0 0.01 0 500 1 2 3 4 5 host 7.6")


class TestTheLongestRange:
    def test_is_carmens_where_nothing_is_coded(self) -> None:
        assert range_max_of([flaser(far=19.0)]) == LONGEST
        assert range_max_of([]) == LONGEST

    @pytest.mark.parametrize(("code", "longest"), [(81.83, 80.0), (51.15, 51.13), (32.767, 32.74), (8.191, 80.0)])
    def test_ends_below_the_number_that_means_nothing(self, code: float, longest: float) -> None:
        assert range_max_of([flaser(far=code)]) == longest


def test_a_speed_is_forward_and_turning() -> None:
    assert speed(odom(0.5, -0.1, 2.0)) == Speed((0.5, 0.0, 0.0), (0.0, 0.0, -0.1), 2 * S, "base_link")


def test_lines_tell_their_name_and_time() -> None:
    assert word_of(flaser()) == "FLASER"
    assert word_of(b"# a comment") == word_of(b"") == word_of(b"FLASERS 1") == ""
    assert time_of(odom(time=3.25)) == 3.25
    assert np.isnan(time_of(b"ODOM 1 2 3 nonsense"))


class TestALog:
    TEXT = b"\n".join(
        [
            b"# CARMEN",
            b"PARAM a b nohost 0",
            odom(time=1),
            flaser(time=2),
            odom(0.6, time=3),
            b"FLASER 180 1 2",
            odom(time=5),
        ]
    )

    def moments(self, log: CarmenLog, *topics: str, start: int | None = None, stop: int | None = None) -> list[Moment]:
        return list(log.moments(topics, start, stop))

    def test_lists_its_messages_as_topics(self) -> None:
        log = CarmenLog(self.TEXT)
        told = [(topic.name, topic.type, topic.count, topic.widget) for topic in log.topics]
        assert told == [("ODOM", "CARMEN ODOM", 3, "speed"), ("FLASER", "CARMEN FLASER", 2, "laser")]
        assert (log.start_ns, log.end_ns) == (S, 5 * S)
        assert log.topics[0].rate == pytest.approx(0.5)

    def test_gives_its_lines_in_their_order_and_leaves_out_what_is_cut(self) -> None:
        log = CarmenLog(self.TEXT)
        assert [(m.topic, m.time_ns // S) for m in self.moments(log, "FLASER", "ODOM")] == [
            ("ODOM", 1), ("FLASER", 2), ("ODOM", 3), ("ODOM", 5)
        ]  # fmt: skip
        assert log.problems[-1].startswith(
            "FLASER: lines that cannot be shown are left out, such as: expected 11 words"
        )

    def test_gives_a_part_of_its_time(self) -> None:
        log = CarmenLog(self.TEXT)
        assert [(m.time_ns // S, m.seconds) for m in self.moments(log, "ODOM", start=2 * S, stop=5 * S)] == [(3, 2.0)]
        assert self.moments(log, "FLASER", start=3 * S) == []

    def test_knows_the_last_sample_at_a_time(self) -> None:
        log = CarmenLog(self.TEXT)
        at = [log.last("ODOM", round(seconds * S)) for seconds in (0.9, 1.0, 2.9, 3.0, 99.0)]
        assert [moment and moment.time_ns // S for moment in at] == [None, 1, 1, 3, 5]
        scan = log.last("FLASER", 99 * S)
        assert scan is not None
        assert isinstance(scan.sample, Scan)
        assert scan.time_ns == 2 * S

    def test_counts_what_a_mapper_wrote_for_itself_apart(self) -> None:
        text = b"\n".join([odom(time=1), flaser(time=2), odom(0.0, 0.0, 0.0), b"NEFF 26.4", odom(time=3)])
        log = CarmenLog(text)
        assert [(topic.name, topic.count, topic.widget) for topic in log.topics] == [
            ("ODOM", 2, "speed"), ("FLASER", 1, "laser"), ("NEFF", 1, None)
        ]  # fmt: skip
        assert log.problems == ()
        assert [m.time_ns // S for m in self.moments(log, "ODOM")] == [1, 3]

    def test_tells_what_was_wrong_with_its_file_and_its_clock(self) -> None:
        log = CarmenLog(b"\n".join(odom(time=0) for _ in range(20)), ["the file was cut off"])
        assert log.problems[0] == "the file was cut off"
        assert log.problems[1].startswith("the clock stood still")
        assert log.topics[0].rate is None

    def test_without_lines_is_empty(self) -> None:
        log = CarmenLog(b"PARAM a b nohost 0\n")
        assert (log.topics, log.start_ns, log.end_ns, log.last("ODOM", 0)) == ((), None, None, None)
        assert self.moments(log, "ODOM") == []

    def test_scans_look_from_the_right_to_the_left(self) -> None:
        scan = self.moments(CarmenLog(self.TEXT), "FLASER")[0].sample
        assert isinstance(scan, Scan)
        assert scan.angles[0] == pytest.approx(-pi / 2)
        assert scan.y[1] < 0

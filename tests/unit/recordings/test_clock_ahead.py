"""Recordings whose clock leapt ahead while they were written: nobody has to wait for years that never were."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from robowidgets.repair._held_clock import LEAP, hold
from robowidgets.repair._one_clock import leaps

import robowidgets
from robowidgets import LaserWidget, Recording
from robowidgets._widget_choice import WidgetChoice
from robowidgets.kinds import LASER
from robowidgets.player._frames import SampleFrames
from robowidgets.player._prefetcher import segment
from robowidgets.recordings import ros_arrivals
from robowidgets.repair._carmen import CarmenLog

from .clock_back import KINDS, SCAN, SPEED, START_NS, Message, cut, drive, long_mcap, mcap, step

YEAR = 365 * 86_400.0
EPOCH = START_NS / 1e9
SET = "the clock jumps ahead once, by 19,675.9 days: time goes on from where it was, dated 2023-11-14"
GONE_ON = [i / 10 - 0.1 * (i >= 50) for i in range(100)]


def from_1970(at: int = 50) -> list[Message]:
    """By a clock that starts in 1970 and is set after five seconds."""
    return drive([i / 10 - EPOCH * (i < at) for i in range(100)])


def order(recording: Recording, topic: str = SCAN) -> list[int]:
    return [
        round((float(m.sample.ranges[0]) - 1) * 100) if topic == SCAN else round(m.sample.linear[0] * 100)  # type: ignore[union-attr]
        for m in recording.samples(topic)
    ]


@pytest.mark.parametrize("kind", KINDS)
class TestAClockThatStartsIn1970AndIsSet:
    @pytest.fixture
    def recording(self, tmp_path: Path, kind: str) -> Recording:
        return robowidgets.open(KINDS[kind](tmp_path, from_1970()))

    def test_is_told_in_a_line_and_goes_on(self, recording: Recording) -> None:
        assert recording.problems == (SET,)
        assert recording.duration == pytest.approx(9.8, abs=1e-5)
        for topic in (SCAN, SPEED):
            assert order(recording, topic) == list(range(100))
            assert [m.seconds for m in recording.samples(topic)] == pytest.approx(GONE_ON, abs=1e-5)
        assert recording.scans().seconds.tolist() == pytest.approx(GONE_ON, abs=1e-5)
        assert recording.problems == (SET,)

    def test_has_the_date_after_it_was_set(self, recording: Recording) -> None:
        assert recording.end_ns == START_NS + 9_900_000_000
        assert "9.8 s, from 2023-11-14 22:13:2" in repr(recording)
        assert [topic.rate for topic in recording.topics] == pytest.approx([99 / 9.8] * 2)

    def test_plays_across(self, recording: Recording) -> None:
        track = SampleFrames(recording, WidgetChoice(LASER, SCAN), LaserWidget())
        assert [len(list(track.frames(second, second + 1.0))) for second in range(10)] == pytest.approx(
            [11] * 10, abs=1
        )


@pytest.mark.parametrize("kind", KINDS)
def test_a_date_that_can_be_is_kept(tmp_path: Path, kind: str) -> None:
    recording = robowidgets.open(KINDS[kind](tmp_path, drive(step(-YEAR))))
    assert recording.problems == (
        "the clock jumps ahead once, by 365.0 days: time goes on from where it was, dated 2023-11-14",
    )
    assert recording.start_ns == START_NS
    assert recording.scans().seconds.tolist() == pytest.approx(GONE_ON)


@pytest.mark.parametrize("kind", KINDS)
def test_a_silence_of_29_days_is_left_as_it_is_and_plays(tmp_path: Path, kind: str) -> None:
    days = LEAP - 86_400
    recording = robowidgets.open(KINDS[kind](tmp_path, drive(step(-days))))
    assert recording.problems == ()
    assert order(recording) == list(range(100))
    assert recording.duration == pytest.approx(days + 9.9)
    assert recording.scans().problems == (
        f"nothing was recorded for {days + 0.1:.2f} s from 4.90 s on, or the clock jumped ahead",
    )
    track = SampleFrames(recording, WidgetChoice(LASER, SCAN), LaserWidget())
    assert len(list(track.frames(days + 9.0, days + 10.0))) == 11
    ((_, raw),) = segment([track], int(days) + 9)
    assert np.frombuffer(raw, np.float64, 1)[0] == 11


@pytest.mark.parametrize("kind", KINDS)
def test_a_clock_may_leap_again_and_again(tmp_path: Path, kind: str) -> None:
    times = [i / 10 + YEAR * (i >= 20) + 2 * YEAR * (i >= 70) for i in range(100)]
    recording = robowidgets.open(KINDS[kind](tmp_path, drive(times)))
    assert recording.problems == (
        "the clock jumps ahead 2 times, by up to 730.0 days: time goes on from where it was, dated 2023-11-14",
    )
    assert order(recording) == list(range(100))
    assert recording.duration == pytest.approx(9.7)


@pytest.mark.parametrize("kind", KINDS)
def test_a_clock_may_leap_and_be_set_back(tmp_path: Path, kind: str) -> None:
    times = [i / 10 + YEAR * (20 <= i < 70) for i in range(100)]
    recording = robowidgets.open(KINDS[kind](tmp_path, drive(times)))
    assert recording.problems == (
        f"the clock goes back once, by up to {YEAR - 0.1:.2f} s: order is kept, time held meanwhile; "
        "it jumps ahead once, by 365.0 days: time goes on from where it was, dated 2023-11-14",
    )
    assert order(recording) == order(recording, SPEED) == list(range(100))
    assert recording.duration == pytest.approx(9.7)


@pytest.mark.parametrize("kind", KINDS)
def test_one_message_from_another_century_holds_nothing_up(tmp_path: Path, kind: str) -> None:
    held = from_1970(at=0)
    held[60] = (held[60][0], 50 * YEAR, held[60][2])
    recording = robowidgets.open(KINDS[kind](tmp_path, held))
    assert " jumps ahead once, by 18,250.0 days: " in recording.problems[0]
    assert recording.duration == pytest.approx(9.9)
    assert sorted(order(recording)) == order(recording, SPEED) == list(range(100))


@pytest.mark.parametrize("kind", KINDS)
def test_a_recording_of_many_weeks_is_left_as_it_is(tmp_path: Path, kind: str) -> None:
    recording = robowidgets.open(KINDS[kind](tmp_path, drive([i * 86_400.0 for i in range(100)])))
    assert recording.problems == ()
    assert recording.duration == 99 * 86_400
    assert order(recording) == list(range(100))


@pytest.mark.parametrize("kind", ["bag", "bz2", "mcap", "long_mcap", "db3"])
def test_a_file_that_was_cut_off_goes_on_too(tmp_path: Path, kind: str) -> None:
    recording = robowidgets.open(cut(KINDS[kind](tmp_path, from_1970())))
    about_damage, about_clock = recording.problems
    assert about_damage.startswith("the recording was cut off: read ")
    assert recording.duration < 10
    assert about_damage.endswith(f", up to {recording.duration:.1f} s")
    assert about_clock == SET


@pytest.mark.parametrize("kind", ["split_mcap", "split_db3", "bare_split"])
@pytest.mark.parametrize("at", [20, 57, 80])
def test_what_leaps_within_a_file_of_several_goes_on_in_all(tmp_path: Path, kind: str, at: int) -> None:
    recording = robowidgets.open(KINDS[kind](tmp_path, from_1970(at)))
    (line,) = recording.problems
    assert line.endswith(SET)
    assert recording.duration == pytest.approx(9.8, abs=1e-5)
    assert order(recording) == list(range(100))


@pytest.mark.parametrize("write", [mcap, long_mcap])
def test_a_long_mcap_file_tells_it_by_its_chunks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, write: type[mcap]
) -> None:
    monkeypatch.setattr(ros_arrivals, "_MOST_CHUNKS", 0)
    assert robowidgets.open(write(tmp_path, from_1970())).problems == (SET,)


class TestALog:
    def open(self, times: Sequence[object]) -> CarmenLog:
        return CarmenLog(b"\n".join(f"ODOM {i} 0 0 0.1 0 0 {t} host {t}".encode() for i, t in enumerate(times)))

    def test_goes_on_too(self) -> None:
        log = self.open([1.0, 2.0, EPOCH, EPOCH + 1])
        assert log.problems == (SET,)
        assert [moment.seconds for moment in log.moments(["ODOM"], None, None)] == pytest.approx([0.0, 1.0, 1.0, 2.0])
        assert log.end_ns == START_NS + 1_000_000_000

    @pytest.mark.parametrize("stray", ["inf", "1e300", "nan", "-1e300", "4e9"])
    def test_is_not_led_astray_by_one_time(self, stray: str) -> None:
        log = self.open([EPOCH, EPOCH + 1, stray, EPOCH + 2, EPOCH + 3])
        assert log.start_ns == START_NS
        seconds = [moment.seconds for moment in log.moments(["ODOM"], None, None)]
        assert len(seconds) == 5
        assert seconds[-1] == pytest.approx(2.5, abs=0.5)


def test_times_as_far_apart_as_can_be_are_held_together() -> None:
    ends = [-(2**63), 2**63 - 1, 5, 6 + 10**9]
    held, odd = hold(ends, 10**9)
    assert held[-1] - held[0] == 10**9 + 1
    assert odd.leaps == 1
    assert leaps(np.array(ends, np.int64))


def test_nothing_leaps_where_there_is_nothing() -> None:
    assert not leaps(np.empty(0, np.int64))
    assert hold([], 1)[0] == []

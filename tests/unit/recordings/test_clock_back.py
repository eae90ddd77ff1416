"""Recordings whose clock went back: played in the order of arrival, on one time that only goes forward."""

from __future__ import annotations

import time
import tracemalloc
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from robowidgets.recordings.chunk_pages import ENTRY, INDEX_HEAD
from robowidgets.recordings.relay import Relay
from robowidgets.repair._inflate import zstd
from robowidgets.repair._one_clock import steps_back, was_set

import robowidgets
from robowidgets import LaserWidget, Recording
from robowidgets._core.robot_widget import FRAME_HEADER
from robowidgets._widget_choice import WidgetChoice
from robowidgets.kinds import LASER
from robowidgets.player._frames import SampleFrames
from robowidgets.player._prefetcher import segment
from robowidgets.recordings import ros_arrivals, ros_files
from robowidgets.recordings.files import open_timeline
from robowidgets.repair.source import Arrivals

from .clock_back import KINDS, SCAN, SPEED, START_NS, cut, db3, drive, long_mcap, mcap, step

SET_BACK_3 = "the clock goes back once, by up to 2.90 s: order is kept, time held meanwhile"
SET_BACK_3600 = "the clock goes back once, by up to 3599.90 s: order is kept, time held meanwhile"
HELD = [max(i / 10 - 3 * (i >= 50), 4.9 * (i >= 50)) for i in range(100)]


def number(scan: Any) -> int:
    return round((float(scan.ranges[0]) - 1) * 100)


def order(recording: Recording, topic: str = SCAN) -> list[int]:
    return [
        number(moment.sample) if topic == SCAN else round(moment.sample.linear[0] * 100)
        for moment in recording.samples(topic)
    ]


def without_arrival(frame: bytes) -> bytes:
    """A frame without the time at which its sample was read."""
    return frame[:24] + frame[FRAME_HEADER.size :]


@pytest.mark.parametrize("kind", KINDS)
class TestAClockThatIsSetBackByThreeSeconds:
    @pytest.fixture
    def recording(self, tmp_path: Path, kind: str) -> Recording:
        return robowidgets.open(KINDS[kind](tmp_path, drive(step(3.0))))

    def test_is_told_in_a_line_and_held(self, recording: Recording) -> None:
        assert recording.problems == (SET_BACK_3,)
        assert recording.duration == pytest.approx(6.9)
        assert recording.start_ns == START_NS
        for topic in (SCAN, SPEED):
            assert order(recording, topic) == list(range(100))
            assert [moment.seconds for moment in recording.samples(topic)] == pytest.approx(HELD)

    def test_mixes_no_topics_up(self, recording: Recording) -> None:
        assert [moment.topic for moment in recording.samples()] == [SCAN, SPEED] * 100

    def test_leaves_one_time_to_random_access_and_columns(self, recording: Recording) -> None:
        for seconds, expected in ((4.85, 48), (4.9, 79), (4.95, 79), (5.0, 80), (6.9, 99), (99.0, 99)):
            moment = recording.at(SCAN, seconds)
            assert moment
            assert number(moment.sample) == expected, seconds
        assert [number(moment.sample) for moment in recording.samples(SCAN, 4.75, 5.15)] == list(range(48, 82))
        scans = recording.scans()
        assert scans.seconds.tolist() == pytest.approx(HELD)
        assert [number(moment.sample) for moment in scans] == list(range(100))
        assert [number(moment.sample) for moment in scans.between(4.95, 5.25)] == [80, 81, 82]
        assert recording.speeds().linear[:, 0].tolist() == pytest.approx([i / 100 for i in range(100)])
        assert scans.problems == ()
        assert recording.problems == (SET_BACK_3,)

    def test_leaves_the_scanners_own_time_as_it_is(self, recording: Recording) -> None:
        assert recording.scans().stamps_ns.tolist() == [START_NS + i * 10**8 for i in range(100)]

    def test_plays_in_that_order(self, recording: Recording) -> None:
        track = SampleFrames(recording, WidgetChoice(LASER, SCAN), LaserWidget())
        timed = [list(track.frames(second, second + 1.0)) for second in range(7)]
        assert [len(some) for some in timed] == [11, 11, 11, 11, 41, 11, 11]
        frames = [without_arrival(one.frame) for some in timed for one in some[1:]]
        expected = [track._frame(moment.seconds, moment.sample).frame for moment in recording.samples(SCAN)]
        assert frames == [without_arrival(frame) for frame in expected]
        ((_, raw),) = segment([track], 4)
        assert np.frombuffer(raw, np.float64, 1)[0] == 41

    def test_is_searched_in_that_order(self, recording: Recording) -> None:
        (span,) = recording.find(lambda moment: number(moment.scan) >= 90)
        assert (span.start, span.end) == pytest.approx((6.0, 6.9))
        assert len(recording.find(robowidgets.conditions.nearest_below(1.895))) == 1


@pytest.mark.parametrize("kind", KINDS)
def test_a_clock_that_is_set_back_for_good_goes_on_from_where_it_was(tmp_path: Path, kind: str) -> None:
    recording = robowidgets.open(KINDS[kind](tmp_path, drive(step(3600.0))))
    assert recording.problems == (SET_BACK_3600,)
    assert order(recording) == list(range(100))
    expected = [i / 10 - 0.1 * (i >= 50) for i in range(100)]
    assert recording.scans().seconds.tolist() == pytest.approx(expected)
    assert recording.duration == pytest.approx(9.8)


@pytest.mark.parametrize("kind", KINDS)
class TestNothingIsSaidAndNothingTouched:
    """Where the clock did not go back."""

    def check(self, path: Path, times: Sequence[float]) -> None:
        with robowidgets.open(path) as recording:
            assert recording.scans().seconds.tolist() == pytest.approx(times)
            assert [moment.seconds for moment in recording.samples(SCAN)] == pytest.approx(sorted(times))
            assert recording.problems == ()

    def test_when_topics_overtake_each_other(self, tmp_path: Path, kind: str) -> None:
        held = [(topic, max(time - 0.25 * (topic == SPEED), 0.0), i) for topic, time, i in drive(step(0.0))]
        self.check(KINDS[kind](tmp_path, held), [i / 10 for i in range(100)])

    def test_when_messages_of_one_topic_do_by_milliseconds(self, tmp_path: Path, kind: str) -> None:
        times = [i / 500 + 0.004 * (i % 5 == 0) for i in range(100)]
        path = KINDS[kind](tmp_path, drive(times))
        if kind in ("db3", "split_db3", "bare_split"):  # a database is read by time
            times.sort()
        times = [time - min(times) for time in times]
        self.check(path, times)


@pytest.mark.parametrize("kind", ["bag", "bz2", "mcap", "long_mcap", "db3"])
def test_a_file_that_was_cut_off_is_read_in_the_same_order(tmp_path: Path, kind: str) -> None:
    recording = robowidgets.open(cut(KINDS[kind](tmp_path, drive(step(3.0)))))
    about_damage, about_clock = recording.problems
    assert about_damage.startswith("the recording was cut off: read ")
    assert about_clock == SET_BACK_3
    found = order(recording)
    assert found == list(range(98 if kind == "db3" else 100))
    assert recording.scans().seconds.tolist() == pytest.approx(HELD[: len(found)])


@pytest.mark.parametrize("kind", ["split_mcap", "split_db3", "bare_split"])
def test_a_folder_with_a_damaged_file_is_read_in_the_same_order(tmp_path: Path, kind: str) -> None:
    folder = KINDS[kind](tmp_path, drive(step(3.0)))
    cut(next(folder.glob("drive_1.*")))
    with robowidgets.open(folder) as recording:
        about_clock, about_damage = recording.problems
        assert about_clock == SET_BACK_3
        assert about_damage.startswith("drive_1.")
        assert order(recording) == order(recording, SPEED) == list(range(100))


def test_a_file_that_was_compressed_as_a_whole_is_read_in_the_same_order(tmp_path: Path) -> None:
    packed = tmp_path / "drive.db3.zstd"
    packed.write_bytes(zstd.compress(db3(tmp_path, drive(step(3.0))).read_bytes()))
    with robowidgets.open(packed) as recording:
        assert recording.problems == (SET_BACK_3,)
        assert order(recording) == list(range(100))


def test_an_index_in_the_order_of_time_hides_nothing(tmp_path: Path) -> None:
    path = mcap(tmp_path, drive(step(3.0)))
    with closing(ros_files.open_mcap(path)) as source:
        offsets = source._reader.chunks[0].message_index_offsets
    raw = bytearray(path.read_bytes())
    for at in offsets.values():
        entries = np.frombuffer(raw, ENTRY, 100, at + INDEX_HEAD.size)
        entries[:] = np.sort(entries, order="time")
    path.write_bytes(raw)
    with robowidgets.open(path) as recording:
        assert recording.problems == (SET_BACK_3,)
        assert order(recording) == list(range(100))


def test_what_a_split_off_file_holds_is_shifted_as_a_whole(tmp_path: Path) -> None:
    recording = robowidgets.open(KINDS["split_mcap"](tmp_path, drive(step(3600.0, at=40))))
    assert recording.scans().seconds.tolist() == pytest.approx([i / 10 - 0.1 * (i >= 40) for i in range(100)])


def test_a_clock_may_be_set_back_again_and_again(tmp_path: Path) -> None:
    times = [i / 10 - 2.0 * (i >= 30) - 1000 * (i >= 60) for i in range(100)]
    recording = robowidgets.open(mcap(tmp_path, drive(times)))
    assert recording.problems == ("the clock goes back 2 times, by up to 999.90 s: order is kept, time held meanwhile",)
    assert order(recording) == list(range(100))


def test_a_clock_that_stands_still_is_told_and_played_in_the_order_of_arrival(tmp_path: Path) -> None:
    for kind, write in KINDS.items():
        (tmp_path / kind).mkdir()
        with robowidgets.open(write(tmp_path / kind, drive([1.0] * 100))) as recording:
            assert order(recording) == list(range(100)), kind
            assert [number(moment.sample) for moment in recording.scans()] == list(range(100)), kind
            assert recording.problems == (
                "/scan: the clock stands still: 99 of 100 samples bear the time of the one before",
            )


class TestALongMcapFile:
    """Of whose index not all is read."""

    @pytest.fixture(autouse=True)
    def _short(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(ros_arrivals, "_MOST_CHUNKS", 0)

    def test_tells_by_its_chunks_that_the_clock_went_back(self, tmp_path: Path) -> None:
        recording = robowidgets.open(long_mcap(tmp_path, drive(step(3.0))))
        assert recording.problems == (SET_BACK_3,)
        assert order(recording) == list(range(100))

    def test_tells_it_across_files(self, tmp_path: Path) -> None:
        recording = robowidgets.open(KINDS["split_mcap"](tmp_path, drive(step(3.0))))
        assert recording.problems == (SET_BACK_3,)

    def test_that_went_back_within_a_chunk_says_so_when_it_was_read(self, tmp_path: Path) -> None:
        recording = robowidgets.open(mcap(tmp_path, drive(step(3.0))))
        assert recording.problems == ()
        assert recording.scans().seconds.tolist() == pytest.approx(step(3.0))
        assert recording.problems == (
            "/scan: the clock goes back once, first at 4.90 s, by up to 2.90 s: "
            "arrays keep the order of arrival, samples and players go by time",
        )


@pytest.mark.parametrize("back", [0.0, 3.0])
def test_an_index_that_claims_more_than_the_file_holds_is_not_read(tmp_path: Path, back: float) -> None:
    path = long_mcap(tmp_path, drive(step(back)))
    raw = bytearray(path.read_bytes())
    # In the index of a chunk, after the offsets of two channels, stands how long the chunk's own index is.
    at = raw.rindex(b"\x08" + (8 * 4 + 4 + 2 * 10 + 8 + 4 + 8 + 8).to_bytes(8, "little")) + 9 + 32 + 4 + 20
    raw[at : at + 8] = (2**40).to_bytes(8, "little")
    path.write_bytes(raw)
    tracemalloc.start()
    with robowidgets.open(path) as recording:
        assert tracemalloc.get_traced_memory()[1] < 10_000_000
        tracemalloc.stop()
        assert order(recording) == list(range(100))
        assert recording.problems == ((SET_BACK_3,) if back else ())


def test_real_recordings_are_left_to_the_quick_reader(data: Path) -> None:
    for path in sorted((data / "good").iterdir()):
        if path.suffix == ".gz":
            continue
        source: Any = open_timeline(path)._source  # type: ignore[attr-defined]
        assert isinstance(source, Relay), path.name
        assert not was_set(source)
        assert source.problems == ()
        source.close()


def arrivals(*messages: tuple[float, int]) -> Arrivals:
    """Seconds and topics."""
    times, channels = np.array(messages, np.float64).reshape(-1, 2).T
    return Arrivals(np.round(times * 1e9).astype(np.int64), channels.astype(np.int64))


class TestAStepBack:
    """Is told from what only looks like one."""

    LASER, ODOM, TF, MAP = range(4)

    def run(self, until: float = 20.0) -> list[tuple[float, int]]:
        """A laser at 10 Hz and odometry at 50 Hz."""
        topics = ((self.LASER, self.ODOM), (self.ODOM,), (self.ODOM,), (self.ODOM,), (self.ODOM,))
        return [(i / 50, topic) for i in range(int(until * 50)) for topic in topics[i % 5]]

    def test_is_where_all_topics_go_back(self) -> None:
        before = self.run()
        after = [(time + 17.0, topic) for time, topic in self.run()]
        assert steps_back(arrivals(*before, *after)) == [len(before)]

    def test_is_seen_by_a_topic_alone(self) -> None:
        assert steps_back(arrivals((0.0, 0), (1.0, 0), (2.0, 0), (0.5, 0), (1.5, 0))) == [3]

    def test_is_not_hidden_by_a_topic_that_seldom_speaks(self) -> None:
        before = [(0.0, self.MAP), (10.0, self.MAP), *self.run()]
        after = [*((time + 18.0, topic) for time, topic in self.run(5.0)), (23.0, self.MAP)]
        assert steps_back(arrivals(*before, *after)) == [len(before)]

    def test_is_not_hidden_by_topics_that_were_silent_since_the_clock_leapt_ahead(self) -> None:
        slow = [(10.0 * i, topic) for i in range(10) for topic in range(self.MAP, self.MAP + 5)]
        run = sorted((*self.run(90.0), *slow))
        at = [i for i, (time, _) in enumerate(run) if 33.0 < time < 35.0]
        ahead = [(time + 1e8 * (i in at), topic) for i, (time, topic) in enumerate(run)]
        assert steps_back(arrivals(*ahead)) == [at[-1] + 1]

    def test_is_not_where_one_topic_bears_times_of_its_own(self) -> None:
        run = self.run()
        run[500:500] = [(run[500][0] + 0.5, self.TF), (run[500][0], self.TF)]
        assert steps_back(arrivals(*run)) == []
        often = [pair for time, topic in self.run() for pair in ((time, topic), (time + 0.05 * (topic == 0), self.TF))]
        assert steps_back(arrivals(*often)) == []

    def test_is_not_where_messages_were_added_to_a_recording_that_was_finished(self) -> None:
        run = self.run()
        more = [(time, topic) for time, _ in run[::5] for topic in (self.TF, self.MAP)]
        assert steps_back(arrivals(*[(time, self.TF) for time, _ in run[:3]], *run, *more)) == []

    def test_is_not_in_jitter(self) -> None:
        assert steps_back(arrivals((0.0, 0), (1.0, 0), (0.995, 0), (2.0, 0))) == []
        assert steps_back(arrivals((0.0, 0), (1.0, 0), (0.985, 0), (2.0, 0))) == [2]

    def test_is_nowhere_where_there_is_nothing(self) -> None:
        assert steps_back(arrivals()) == []

    @pytest.mark.slow
    def test_is_not_looked_for_without_end(self) -> None:
        count = 60_000
        times = np.tile(np.array([50, 0], np.int64), 10 * count) * 10**9
        began = time.perf_counter()
        assert steps_back(Arrivals(times, np.arange(2 * 10 * count, dtype=np.int64) // 20)) == []
        assert time.perf_counter() - began < 10

    def test_may_be_as_large_as_times_can_be(self) -> None:
        ends = np.array([2**63 - 1, -(2**63), 5], np.int64)
        assert steps_back(Arrivals(ends, np.zeros(3, np.int64))) == [1]


def test_times_that_would_pass_the_end_of_all_times_stay_there(tmp_path: Path) -> None:
    last = (2**63 - 1 - START_NS) / 1e9 - 1.0
    recording = robowidgets.open(db3(tmp_path, drive([last, 1.0, 2.0, 3.0, 4.0, 5.0])))
    assert order(recording) == list(range(6))
    assert recording.end_ns == 2**63 - 1

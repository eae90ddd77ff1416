"""Clocks that were set while a recording was written: one time that only goes forward, in every file format."""

from __future__ import annotations

import sqlite3
import time
import tracemalloc
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2.storage_mcap import McapReader

import robowidgets
from robowidgets import LaserWidget, Recording
from robowidgets.files import _index
from robowidgets.kinds.choice import WidgetChoice
from robowidgets.laser.row import LASER
from robowidgets.messages.compression import zstd
from robowidgets.repair import LEAP_NS, Arrivals, Source, has_clock_step, open_repaired
from robowidgets.screens._prefetcher import segment
from robowidgets.tracks import SampleFrames
from robowidgets.widget.timed_frame import FRAME_HEADER

from ..recordings.clock_back import KINDS, SCAN, SPEED, START_NS, Message, cut, db3, drive, long_mcap, mcap, step
from ..recordings.written import MCAP_END, MCAP_MAGIC, read, record, string
from .test_sqlite import HUMBLE

YEAR = 365 * 86_400.0
EPOCH = START_NS / 1e9
SET_BACK_3 = "the clock goes back once, by up to 2.90 s: order is kept, time stands still meanwhile"
SET_BACK_3600 = "the clock goes back once, by up to 3599.90 s: order is kept, time stands still meanwhile"
SET = "the clock jumps ahead once, by 19,675.9 days: time goes on without a gap, dated 2023-11-14"
HELD = [max(i / 10 - 3 * (i >= 50), 4.9 * (i >= 50)) for i in range(100)]
GONE_ON = [i / 10 - 0.1 * (i >= 50) for i in range(100)]

ONE_FILE = ("bag", "bz2", "mcap", "long_mcap", "db3")
FOLDERS = ("split_mcap", "split_db3", "bare_split")
PARTS_FOLLOW_ON = [kind for kind in KINDS if kind != "bare_split"]
"""Files without metadata whose times do not follow on are several recordings."""


def number(scan: Any) -> int:
    return round((float(scan.ranges[0]) - 1) * 100)


def order(recording: Recording, topic: str = SCAN) -> list[int]:
    return [
        number(moment.sample) if topic == SCAN else round(moment.sample.linear[0] * 100)  # type: ignore[union-attr]
        for moment in recording.samples(topic)
    ]


def from_1970(at: int = 50) -> list[Message]:
    """A recording by a clock that starts in 1970 and is set after five seconds."""
    return drive([i / 10 - EPOCH * (i < at) for i in range(100)])


def open_scans(path: Path) -> tuple[Recording, SampleFrames]:
    """A recording, and the frames of its laser as a player asks for them."""
    recording = robowidgets.open(path)
    return recording, SampleFrames(recording, WidgetChoice(LASER, ((LASER.roles[0], SCAN),)), LaserWidget())


@pytest.mark.parametrize("kind", KINDS)
class TestAClockThatIsSetBackByThreeSeconds:
    @pytest.fixture
    def recording(self, tmp_path: Path, kind: str) -> Recording:
        return robowidgets.open(KINDS[kind](tmp_path, drive(step(3.0))))

    def test_is_reported_in_a_line_and_held(self, recording: Recording) -> None:
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


class TestARecordingWithARepairedClock:
    def test_plays_in_the_order_of_arrival(self, tmp_path: Path) -> None:
        recording, track = open_scans(mcap(tmp_path, drive(step(3.0))))
        timed = [list(track.frames(second, second + 1.0)) for second in range(7)]
        assert [len(some) for some in timed] == [11, 11, 11, 11, 41, 11, 11]
        frames = [without_arrival(one.frame) for some in timed for one in some[1:]]
        expected = [track._frame(moment.seconds, moment.sample).frame for moment in recording.samples(SCAN)]
        assert frames == [without_arrival(frame) for frame in expected]
        _, (raw,) = segment([track], 4)
        assert np.frombuffer(raw, np.float64, 1)[0] == 41

    def test_is_searched_in_that_order(self, tmp_path: Path) -> None:
        recording = robowidgets.open(mcap(tmp_path, drive(step(3.0))))
        (span,) = recording.find(lambda moment: number(moment.scan) >= 90)
        assert (span.start, span.end) == pytest.approx((6.0, 6.9))
        assert len(recording.find(robowidgets.conditions.nearest_below(1.895))) == 1

    def test_plays_across_a_leap(self, tmp_path: Path) -> None:
        _, track = open_scans(mcap(tmp_path, from_1970()))
        counts = [len(list(track.frames(second, second + 1.0))) for second in range(10)]
        assert counts == pytest.approx([11] * 10, abs=1)


def without_arrival(frame: bytes) -> bytes:
    """A frame without the time at which its sample was read."""
    return frame[:24] + frame[FRAME_HEADER.size :]


@pytest.mark.parametrize("kind", PARTS_FOLLOW_ON)
def test_a_clock_that_is_set_back_for_good_goes_on_from_where_it_was(tmp_path: Path, kind: str) -> None:
    recording = robowidgets.open(KINDS[kind](tmp_path, drive(step(3600.0))))
    assert recording.problems == (SET_BACK_3600,)
    assert order(recording) == list(range(100))
    assert recording.scans().seconds.tolist() == pytest.approx(GONE_ON)
    assert recording.duration == pytest.approx(9.8)


@pytest.mark.parametrize("kind", KINDS)
class TestAClockThatStartsIn1970AndIsSet:
    @pytest.fixture
    def recording(self, tmp_path: Path, kind: str) -> Recording:
        return robowidgets.open(KINDS[kind](tmp_path, from_1970()))

    def test_is_reported_in_a_line_and_goes_on(self, recording: Recording) -> None:
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


@pytest.mark.parametrize("kind", KINDS)
class TestALeapAhead:
    def test_keeps_a_date_that_can_be(self, tmp_path: Path, kind: str) -> None:
        recording = robowidgets.open(KINDS[kind](tmp_path, drive(step(-YEAR))))
        assert recording.problems == (
            "the clock jumps ahead once, by 365.0 days: time goes on without a gap, dated 2023-11-14",
        )
        assert recording.start_ns == START_NS
        assert recording.scans().seconds.tolist() == pytest.approx(GONE_ON)

    def test_may_come_again_and_again(self, tmp_path: Path, kind: str) -> None:
        times = [i / 10 + YEAR * (i >= 20) + 2 * YEAR * (i >= 70) for i in range(100)]
        recording = robowidgets.open(KINDS[kind](tmp_path, drive(times)))
        assert recording.problems == (
            "the clock jumps ahead 2 times, by up to 730.0 days: time goes on without a gap, dated 2023-11-14",
        )
        assert order(recording) == list(range(100))
        assert recording.duration == pytest.approx(9.7)

    def test_may_be_taken_back(self, tmp_path: Path, kind: str) -> None:
        times = [i / 10 + YEAR * (20 <= i < 70) for i in range(100)]
        recording = robowidgets.open(KINDS[kind](tmp_path, drive(times)))
        assert recording.problems == (
            f"the clock goes back once, by up to {YEAR - 0.1:.2f} s: order is kept, time stands still meanwhile; "
            "it jumps ahead once, by 365.0 days: time goes on without a gap, dated 2023-11-14",
        )
        assert order(recording) == order(recording, SPEED) == list(range(100))
        assert recording.duration == pytest.approx(9.7)

    def test_of_one_message_alone_delays_no_other(self, tmp_path: Path, kind: str) -> None:
        held = drive(step(0.0))
        held[60] = (held[60][0], 50 * YEAR, held[60][2])
        recording = robowidgets.open(KINDS[kind](tmp_path, held))
        assert " jumps ahead once, by 18,250.0 days: " in recording.problems[0]
        assert recording.duration == pytest.approx(9.9)
        assert sorted(order(recording)) == order(recording, SPEED) == list(range(100))


@pytest.mark.parametrize("kind", KINDS)
class TestNoNoteAndNoChange:
    """Positions at which the clock was not set."""

    def check(self, path: Path, times: Sequence[float]) -> None:
        with robowidgets.open(path) as recording:
            assert recording.scans().seconds.tolist() == pytest.approx(times)
            assert [moment.seconds for moment in recording.samples(SCAN)] == pytest.approx(times)
            assert recording.problems == ()

    def test_when_topics_overtake_each_other(self, tmp_path: Path, kind: str) -> None:
        held = [(topic, max(time - 0.25 * (topic == SPEED), 0.0), i) for topic, time, i in drive(step(0.0))]
        self.check(KINDS[kind](tmp_path, held), [i / 10 for i in range(100)])

    def test_when_messages_of_one_topic_do_by_milliseconds(self, tmp_path: Path, kind: str) -> None:
        times = [i / 500 + 0.004 * (i % 5 == 0) for i in range(100)]
        path = KINDS[kind](tmp_path, drive(times))
        self.check(path, sorted(time - min(times) for time in times))

    def test_but_that_a_clock_stood_still(self, tmp_path: Path, kind: str) -> None:
        recording = robowidgets.open(KINDS[kind](tmp_path, drive([1.0] * 100)))
        assert order(recording) == list(range(100))
        assert [number(moment.sample) for moment in recording.scans()] == list(range(100))
        assert recording.problems == (
            "/scan: the clock stands still: 99 of 100 samples bear the time of the one before",
        )


@pytest.mark.parametrize("kind", PARTS_FOLLOW_ON)
class TestALongSilence:
    def test_is_not_a_step_if_a_day_lies_between_any_two_messages(self, tmp_path: Path, kind: str) -> None:
        recording = robowidgets.open(KINDS[kind](tmp_path, drive([i * 86_400.0 for i in range(100)])))
        assert recording.problems == ()
        assert recording.duration == 99 * 86_400
        assert order(recording) == list(range(100))

    def test_is_not_a_step_if_it_takes_29_days(self, tmp_path: Path, kind: str) -> None:
        days = LEAP_NS / 1e9 - 86_400
        recording, track = open_scans(KINDS[kind](tmp_path, drive(step(-days))))
        assert recording.problems == ()
        assert order(recording) == list(range(100))
        assert recording.duration == pytest.approx(days + 9.9)
        assert recording.scans().problems == (
            f"nothing was recorded for {days + 0.1:.2f} s from 4.90 s on, or the clock jumped ahead",
        )
        assert len(list(track.frames(days + 9.0, days + 10.0))) == 11
        _, (raw,) = segment([track], int(days) + 9)
        assert np.frombuffer(raw, np.float64, 1)[0] == 11


class TestADamagedRecording:
    @pytest.mark.parametrize("kind", ONE_FILE)
    def test_that_was_cut_off_keeps_the_order_of_arrival(self, tmp_path: Path, kind: str) -> None:
        recording = robowidgets.open(cut(KINDS[kind](tmp_path, drive(step(3.0)))))
        about_damage, about_clock = recording.problems
        assert about_damage.startswith("the recording was cut off: read ")
        assert about_clock == SET_BACK_3
        found = order(recording)
        assert found == list(range(98 if kind == "db3" else 100))
        assert recording.scans().seconds.tolist() == pytest.approx(HELD[: len(found)])

    @pytest.mark.parametrize("kind", ONE_FILE)
    def test_that_was_cut_off_goes_on_after_a_leap(self, tmp_path: Path, kind: str) -> None:
        recording = robowidgets.open(cut(KINDS[kind](tmp_path, from_1970())))
        about_damage, about_clock = recording.problems
        assert about_damage.startswith("the recording was cut off: read ")
        assert recording.duration < 10
        assert about_damage.endswith(f", up to {recording.duration:.1f} s")
        assert about_clock == SET

    @pytest.mark.parametrize("kind", FOLDERS)
    def test_of_several_files_keeps_the_order_of_arrival(self, tmp_path: Path, kind: str) -> None:
        folder = KINDS[kind](tmp_path, drive(step(3.0)))
        cut(next(folder.glob("drive_1.*")))
        recording = robowidgets.open(folder)
        about_damage, about_clock = recording.problems
        assert about_clock == SET_BACK_3
        assert about_damage.startswith("drive_1.")
        assert order(recording) == order(recording, SPEED) == list(range(100))

    def test_that_was_compressed_as_a_whole_keeps_the_order_of_arrival(self, tmp_path: Path) -> None:
        packed = tmp_path / "drive.db3.zstd"
        packed.write_bytes(zstd.compress(db3(tmp_path, drive(step(3.0))).read_bytes()))
        recording = robowidgets.open(packed)
        assert recording.problems == (SET_BACK_3,)
        assert order(recording) == list(range(100))


class TestSeveralFiles:
    def test_are_shifted_together_where_the_clock_was_set_back_in_one(self, tmp_path: Path) -> None:
        recording = robowidgets.open(KINDS["split_mcap"](tmp_path, drive(step(3600.0, at=40))))
        assert recording.scans().seconds.tolist() == pytest.approx([i / 10 - 0.1 * (i >= 40) for i in range(100)])

    @pytest.mark.parametrize("kind", FOLDERS)
    @pytest.mark.parametrize("at", [20, 57, 80])
    def test_go_on_together_after_a_leap_in_one(self, tmp_path: Path, kind: str, at: int) -> None:
        recording = robowidgets.open(KINDS[kind](tmp_path, from_1970(at)))
        assert recording.problems == (SET,)
        assert recording.duration == pytest.approx(9.8, abs=1e-5)
        assert order(recording) == list(range(100))


class TestTheIndexOfAnMcapFile:
    def test_hides_nothing_when_it_is_in_the_order_of_time(self, tmp_path: Path) -> None:
        path = mcap(tmp_path, drive(step(3.0)))
        rewrite_index(path, lambda entries: np.sort(entries, order="time"))
        recording = robowidgets.open(path)
        assert recording.problems == (SET_BACK_3,)
        assert order(recording) == list(range(100))

    @pytest.mark.parametrize("back", [0.0, 3.0])
    def test_is_not_read_when_it_claims_more_than_the_file_holds(self, tmp_path: Path, back: float) -> None:
        path = long_mcap(tmp_path, drive(step(back)))
        raw = bytearray(path.read_bytes())
        # In the index of a chunk, the length of the chunk's own index follows the offsets of two channels.
        at = raw.rindex(b"\x08" + (8 * 4 + 4 + 2 * 10 + 8 + 4 + 8 + 8).to_bytes(8, "little")) + 9 + 32 + 4 + 20
        raw[at : at + 8] = (2**40).to_bytes(8, "little")
        path.write_bytes(raw)
        tracemalloc.start()
        with robowidgets.open(path) as recording:
            assert tracemalloc.get_traced_memory()[1] < 10_000_000
            tracemalloc.stop()
            assert order(recording) == list(range(100))
            assert recording.problems == ((SET_BACK_3,) if back else ())


def rewrite_index(path: Path, change: Callable[[Any], Any]) -> None:
    """Change the entries (time, offset) of both channels in the index of the first chunk; there are 100 of each."""
    with closing(McapReader(path)) as reader:
        reader.open()
        offsets = reader.chunks[0].message_index_offsets
    raw = bytearray(path.read_bytes())
    for at in offsets.values():
        entries = np.frombuffer(raw, [("time", "<u8"), ("offset", "<u8")], 100, at + 15)
        entries[:] = change(entries)
    path.write_bytes(raw)


class TestALongMcapFile:
    """A file whose index is read in part."""

    @pytest.fixture(autouse=True)
    def _short(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(_index, "_MOST_CHUNKS", 0)

    @pytest.mark.parametrize("kind", ["long_mcap", "split_mcap"])
    def test_tells_by_its_chunks_that_the_clock_went_back(self, tmp_path: Path, kind: str) -> None:
        recording = robowidgets.open(KINDS[kind](tmp_path, drive(step(3.0))))
        assert recording.problems == (SET_BACK_3,)
        assert order(recording) == list(range(100))

    @pytest.mark.parametrize("kind", ["mcap", "long_mcap"])
    def test_tells_by_its_chunks_that_the_clock_leapt(self, tmp_path: Path, kind: str) -> None:
        assert robowidgets.open(KINDS[kind](tmp_path, from_1970())).problems == (SET,)

    def test_whose_clock_went_back_within_a_chunk_is_read_by_time(self, tmp_path: Path) -> None:
        recording = robowidgets.open(mcap(tmp_path, drive(step(3.0))))
        assert recording.problems == ()
        assert recording.scans().seconds.tolist() == pytest.approx(sorted(step(3.0)))


def written(folder: Path, *messages: tuple[float, int]) -> Source:
    """A source over messages with these times in seconds, and topics; each holds its number."""
    topics = sorted({topic for _, topic in messages})
    head = [
        record(0x04, topic.to_bytes(2, "little") + bytes(2) + string(f"/{topic}") + string("cdr") + bytes(4))
        for topic in topics
    ]
    body = []
    for i, (seconds, topic) in enumerate(messages):
        time_ns = (START_NS + round(seconds * 1e9)).to_bytes(8, "little")
        body.append(record(0x05, topic.to_bytes(2, "little") + bytes(4) + 2 * time_ns + i.to_bytes(4, "little")))
    path = folder / "written.mcap"
    path.write_bytes(MCAP_MAGIC + record(0x01, string("") + string("")) + b"".join((*head, *body)) + MCAP_END)
    return open_repaired([path])


def numbers(source: Source) -> list[int]:
    return [int.from_bytes(data, "little") for _, _, data in read(source)]


class TestAStepBack:
    """Steps are distinguished from data that only look like one."""

    LASER, ODOM, TF, MAP = range(4)

    def run(self, until: float = 20.0) -> list[tuple[float, int]]:
        """A laser at 10 Hz and odometry at 50 Hz."""
        topics = ((self.LASER, self.ODOM), (self.ODOM,), (self.ODOM,), (self.ODOM,), (self.ODOM,))
        return [(i / 50, topic) for i in range(int(until * 50)) for topic in topics[i % 5]]

    def check_step(self, folder: Path, before: Sequence[tuple[float, int]], after: Sequence[tuple[float, int]]) -> None:
        """Check that all of `before` come before all of `after`, each in order of time."""
        source = written(folder, *before, *after)
        assert source.problems[0].startswith("the clock goes back once, ")
        found = numbers(source)
        assert sorted(found[: len(before)]) == list(range(len(before)))

    def check_none(self, folder: Path, messages: Sequence[tuple[float, int]]) -> None:
        """Check that the messages are read in order of time, without a problem."""
        source = written(folder, *messages)
        assert source.problems == ()
        times = [time for time, _ in messages]
        assert numbers(source) == sorted(range(len(times)), key=times.__getitem__)

    def test_is_where_all_topics_go_back(self, tmp_path: Path) -> None:
        self.check_step(tmp_path, self.run(), [(time + 17.0, topic) for time, topic in self.run()])

    def test_is_seen_by_a_topic_alone(self, tmp_path: Path) -> None:
        self.check_step(tmp_path, [(0.0, 0), (1.0, 0), (2.0, 0)], [(0.5, 0), (1.5, 0)])

    def test_may_come_again_and_again(self, tmp_path: Path) -> None:
        times = [i / 10 - 2.0 * (i >= 30) - 1000 * (i >= 60) for i in range(100)]
        source = written(tmp_path, *((time, 0) for time in times))
        assert source.problems == (
            "the clock goes back 2 times, by up to 999.90 s: order is kept, time stands still meanwhile",
        )
        assert numbers(source) == list(range(100))

    def test_is_not_hidden_by_a_topic_that_seldom_speaks(self, tmp_path: Path) -> None:
        before = [(0.0, self.MAP), (10.0, self.MAP), *self.run()]
        after = [*((time + 18.0, topic) for time, topic in self.run(5.0)), (23.0, self.MAP)]
        self.check_step(tmp_path, before, after)

    def test_is_not_hidden_by_topics_that_were_silent_since_the_clock_leapt_ahead(self, tmp_path: Path) -> None:
        slow = [(10.0 * i, topic) for i in range(10) for topic in range(self.MAP, self.MAP + 5)]
        run = sorted((*self.run(90.0), *slow))
        at = [i for i, (time, _) in enumerate(run) if 33.0 < time < 35.0]
        ahead = [(time + 1e8 * (i in at), topic) for i, (time, topic) in enumerate(run)]
        self.check_step(tmp_path, ahead[: at[-1] + 1], ahead[at[-1] + 1 :])

    def test_is_not_a_step_if_one_topic_has_its_own_times(self, tmp_path: Path) -> None:
        run = self.run()
        run[500:500] = [(run[500][0] + 0.5, self.TF), (run[500][0], self.TF)]
        self.check_none(tmp_path, run)
        often = [pair for time, topic in self.run() for pair in ((time, topic), (time + 0.05 * (topic == 0), self.TF))]
        self.check_none(tmp_path, often)

    def test_is_not_where_messages_were_added_to_a_recording_that_was_finished(self, tmp_path: Path) -> None:
        run = self.run()
        more = [(time, topic) for time, _ in run[::5] for topic in (self.TF, self.MAP)]
        self.check_none(tmp_path, [*((time, self.TF) for time, _ in run[:3]), *run, *more])

    def test_is_not_in_jitter(self, tmp_path: Path) -> None:
        self.check_none(tmp_path, [(0.0, 0), (1.0, 0), (0.995, 0), (2.0, 0)])
        self.check_step(tmp_path, [(0.0, 0), (1.0, 0)], [(0.985, 0), (2.0, 0)])

    @pytest.mark.slow
    def test_is_not_looked_for_without_end(self) -> None:
        count = 60_000
        times = np.tile(np.array([50, 0], np.int64), 10 * count) * 10**9
        began = time.thread_time()
        assert not has_clock_step(Arrivals(times, np.arange(2 * 10 * count, dtype=np.int64) // 20))
        assert time.thread_time() - began < 10


class TestTimesAtTheirLimits:
    def open(self, folder: Path, *times: int) -> Source:
        path = folder / "drive.db3"
        with closing(sqlite3.connect(path)) as connection, connection:
            connection.executescript(HUMBLE)
            rows = [(time, bytes([i])) for i, time in enumerate(times)]
            connection.executemany("INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?, ?)", rows)
        return open_repaired([path])

    def test_are_brought_together_however_far_apart_they_are(self, tmp_path: Path) -> None:
        source = self.open(tmp_path, -(2**63), 2**62, 5, 6 + 10**9)
        assert numbers(source) == [0, 1, 2, 3]
        assert source.start_ns is not None
        assert source.end_ns is not None
        assert source.end_ns - source.start_ns == 10**9 + 1
        assert "goes back once" in source.problems[0]
        assert "jumps ahead once" in source.problems[0]

    def test_stay_there_where_they_would_pass_them(self, tmp_path: Path) -> None:
        last = (2**63 - 1 - START_NS) / 1e9 - 1.0
        recording = robowidgets.open(db3(tmp_path, drive([last, 1.0, 2.0, 3.0, 4.0, 5.0])))
        assert order(recording) == list(range(6))
        assert recording.end_ns == 2**63 - 1

    def test_are_seen_to_leap(self) -> None:
        ends = np.array([2**63 - 1, -(2**63), 5], np.int64)
        assert has_clock_step(Arrivals(ends, np.zeros(3, np.int64)))

    def test_are_none_if_there_is_no_message(self) -> None:
        assert not has_clock_step(Arrivals(np.empty(0, np.int64), np.empty(0, np.int64)))


def test_messages_of_the_same_time_stay_in_the_order_of_the_file(tmp_path: Path) -> None:
    source = written(tmp_path, *[(5.0, 1), (0.0, 2)] * 50)
    assert numbers(source) == [*range(1, 100, 2), *range(0, 100, 2)]


@pytest.mark.parametrize("kind", ONE_FILE)
class TestAClockWithoutADate:
    def test_that_begins_after_the_recorder_leaves_the_drive_on_the_whole_axis(self, tmp_path: Path, kind: str) -> None:
        times = [0.0] * 5 + [900 + i / 10 for i in range(100)]
        with robowidgets.open(KINDS[kind](tmp_path, drive([time - EPOCH for time in times]))) as recording:
            assert recording.problems == (
                "the clock began only after 10 messages at time 0, which are put at its start",
            )
            assert (recording.start_ns, recording.duration) == (900 * 10**9, pytest.approx(9.9))
            assert order(recording) == list(range(105))

    def test_that_is_reset_within_ten_seconds_goes_on(self, tmp_path: Path, kind: str) -> None:
        times = [0.3 + i / 10 for i in range(80)] + [i / 10 for i in range(200)]
        with robowidgets.open(KINDS[kind](tmp_path, drive([time - EPOCH for time in times]))) as recording:
            assert recording.problems[0].startswith("the clock goes back once, by up to 8.20 s")
            assert len(set(recording.scans(SCAN).times_ns.tolist())) == 279
            assert order(recording) == list(range(280))

    def test_that_starts_at_0_and_goes_on_is_right(self, tmp_path: Path, kind: str) -> None:
        times = [i / 10 - EPOCH for i in range(200)]
        with robowidgets.open(KINDS[kind](tmp_path, drive(times))) as recording:
            assert (recording.problems, recording.duration) == ((), pytest.approx(19.9))


def test_a_recorder_that_waited_for_the_clock_of_a_simulation(data: Path) -> None:
    with robowidgets.open(data / "reports/before_the_clock/simtime_before_clock.mcap") as recording:
        assert recording.duration == pytest.approx(9.9)
        assert "the clock began only after 5 messages at time 0" in recording.info()

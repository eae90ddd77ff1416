"""Scans, speeds and touches of a recording as columns."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionMode, StoragePlugin

import robowidgets
from robowidgets import RecordingError, Touch, TouchMode
from robowidgets.recordings import UnknownTopicError
from robowidgets.recordings.columns.chunks import SampleChunk
from robowidgets.recordings.columns.touches import _read

from . import hazards, robot, sweeps
from .sweeps import START_NS

NAN, INF = float("nan"), float("inf")


@pytest.fixture
def drive(tmp_path: Path) -> Iterator[robowidgets.Recording]:
    with robowidgets.open(robot.write(tmp_path / "drive")) as recording:
        yield recording


def open_sweeps(folder: Path, *scans: Any) -> robowidgets.Recording:
    return robowidgets.open(sweeps.write(folder / "sweeps", scans))


def touch_chunk(touches: Sequence[Touch], times_ns: Sequence[int]) -> SampleChunk:
    column = np.empty(len(touches), object)
    column[:] = touches
    return SampleChunk(0, np.array(times_ns, np.int64), np.zeros(len(touches), np.int64), column)


class TestColumns:
    def test_scans_are_arrays(self, drive: robowidgets.Recording) -> None:
        scans = drive.scans("/scan")
        assert len(scans) == 100
        assert (scans.times_ns.dtype, scans.ranges.dtype, scans.ranges.shape) == (np.int64, np.float32, (100, 1))
        np.testing.assert_array_equal(scans.times_ns, robot.START_NS + np.arange(100) * 100_000_000)
        np.testing.assert_array_equal(scans.stamps_ns, scans.times_ns)
        np.testing.assert_allclose(scans.seconds, np.arange(100) / 10)
        np.testing.assert_allclose(scans.ranges[:, 0], 1 + np.arange(100) / 100, rtol=1e-6)
        assert scans.intensities.shape == (100, 0)
        assert [float(getattr(scans, name)[7]) for name in ("range_min", "range_max")] == pytest.approx([0.1, 30])

    def test_speeds_are_arrays(self, drive: robowidgets.Recording) -> None:
        speeds = drive.speeds("/odom")
        assert (speeds.linear.shape, speeds.angular.shape) == ((100, 3), (100, 3))
        np.testing.assert_allclose(speeds.linear[:, 0], np.arange(100) / 100)
        assert not speeds.angular.any()
        np.testing.assert_array_equal(speeds.poses, np.zeros((100, 3)))
        assert np.isnan(drive.speeds("/cmd_vel").poses).all()

    def test_a_mask_picks_samples(self, drive: robowidgets.Recording) -> None:
        scans = drive.scans("/scan")
        some = scans[10:][(scans[10:].ranges[:, 0] > 1.5) & (scans[10:].seconds % 1 < 0.05)]
        np.testing.assert_allclose(some.seconds, [6, 7, 8, 9])
        np.testing.assert_allclose(some.ranges[:, 0], [1.6, 1.7, 1.8, 1.9], rtol=1e-6)
        assert len(scans[np.zeros(100, bool)]) == 0
        with pytest.raises(IndexError, match=r"^/scan: expected a mask of 100 values, got shape \(5,\)$"):
            scans[np.ones(5, bool)]

    def test_values_are_those_that_were_sent(self, tmp_path: Path) -> None:
        sent = [[1.0, NAN, INF, -INF, 0.0], [2.0, 3.0, NAN, 0.001, 31.0]]
        scans = open_sweeps(
            tmp_path, *((i, sweeps.scan(START_NS + i, row, [9, 8, 7, 6, i])) for i, row in enumerate(sent))
        ).scans()
        np.testing.assert_array_equal(scans.ranges, np.array(sent, np.float32))
        np.testing.assert_array_equal(scans.intensities[:, -1], [0, 1])
        np.testing.assert_array_equal(scans.stamps_ns, [START_NS, START_NS + 1])
        np.testing.assert_allclose(scans.angles, -0.5 + 0.1 * np.arange(5), rtol=1e-6)

    def test_columns_cannot_be_changed_behind_the_back_of_others(self, drive: robowidgets.Recording) -> None:
        scans = drive.scans()
        for column in (scans.times_ns, scans.seconds, next(iter(scans.chunks())).ranges):
            with pytest.raises(ValueError, match="read-only"):
                column[0] = 0

    @pytest.mark.parametrize(
        ("plugin", "compression"),
        [
            *((plugin, how) for plugin in ("MCAP", "SQLITE3") for how in ("NONE", "FILE", "MESSAGE")),
            ("MCAP", "STORAGE"),
        ],
    )
    def test_every_kind_of_file_gives_the_same(self, tmp_path: Path, plugin: str, compression: str) -> None:
        folder = sweeps.write(
            tmp_path / "x", sweeps.numbered(300, rays=2000), StoragePlugin[plugin], CompressionMode[compression]
        )
        scans = robowidgets.open(folder).scans()
        assert scans.ranges.shape == (300, 2000)
        np.testing.assert_allclose(scans.ranges[:, 7], 1 + np.arange(300) / 100, rtol=1e-6)
        np.testing.assert_allclose(scans[250:].ranges[:, 7], 1 + np.arange(250, 300) / 100, rtol=1e-6)

    @pytest.mark.slow
    def test_all_recordings_give_what_their_samples_say(self, data: Path) -> None:
        compared = 0
        for path in sorted([*(data / "good").iterdir(), *(data / "odd").iterdir(), *(data / "damaged").iterdir()]):
            try:
                recording = robowidgets.open(path)
            except RecordingError:
                continue
            with recording:
                for topic in recording.topics:
                    if topic.widget in ("laser", "speed") and topic.count < 3000:
                        compared += compare(recording, topic.name, topic.widget)
        assert compared > 10_000


def compare(recording: robowidgets.Recording, topic: str, widget: str) -> int:
    series = recording.scans(topic) if widget == "laser" else recording.speeds(topic)
    told = sorted(recording.samples(topic), key=lambda moment: moment.time_ns)
    for moments in (series, series[:]):
        ours = sorted(moments, key=lambda moment: moment.time_ns)
        assert [moment.time_ns for moment in ours] == [moment.time_ns for moment in told]
        for mine, theirs in zip(ours, told, strict=True):
            for name in ("ranges", "intensities", "angle_min", "header_problems") if widget == "laser" else ("values",):
                one, other = (np.asarray(getattr(sample, name)) for sample in (mine.sample, theirs.sample))
                assert one.tobytes() == other.tobytes(), name
            assert mine.sample.stamp_ns == theirs.sample.stamp_ns
            assert mine.seconds == theirs.seconds
    return len(told)


class TestPicking:
    def test_by_number(self, drive: robowidgets.Recording) -> None:
        scans = drive.scans()
        moment = scans[3]
        assert (moment.topic, moment.seconds) == ("/scan", 0.3)
        assert moment.sample.ranges[0] == pytest.approx(1.03)
        assert scans[-1].seconds == 9.9
        assert [m.seconds for m in scans[10:13]] == [1.0, 1.1, 1.2]
        assert [m.seconds for m in scans[::-40]] == [9.9, 5.9, 1.9]
        np.testing.assert_allclose(scans[5:90:30][1:].ranges[:, 0], [1.35, 1.65], rtol=1e-6)
        assert len(scans[50:40]) == 0
        assert scans[50:40].ranges.shape == (0, 0)
        np.testing.assert_allclose(scans[::-40].ranges[:, 0], [1.99, 1.59, 1.19], rtol=1e-6)

    @pytest.mark.parametrize(
        ("start", "end", "seconds"),
        [
            (2.0, 2.3, [2.0, 2.1, 2.2]),
            (None, 0.2, [0.0, 0.1]),
            (9.8, None, [9.8, 9.9]),
            (5.0, 5.0, []),
            (-3, 0.05, [0.0]),
        ],
    )
    def test_by_time(self, drive: robowidgets.Recording, start: Any, end: Any, seconds: list[float]) -> None:
        part = drive.scans().between(start, end)
        assert [moment.seconds for moment in part] == seconds
        assert part.seconds.tolist() == seconds

    @pytest.mark.parametrize("read_before", [False, True])
    def test_a_part_is_the_same_whether_all_were_read_or_the_part_alone(
        self, drive: robowidgets.Recording, monkeypatch: pytest.MonkeyPatch, read_before: bool
    ) -> None:
        source, read = drive._messages._source, []
        messages = source.messages

        def counted(*asked: Any) -> Iterator[Any]:
            for message in messages(*asked):
                read.append(message[1])
                yield message

        monkeypatch.setattr(source, "messages", counted)
        scans = drive.scans()
        if read_before:
            assert len(scans) == 100
        read.clear()
        part = scans.between(2.0, 5.0)
        np.testing.assert_allclose(part.ranges[:, 0], 1 + np.arange(20, 50) / 100, rtol=1e-6)
        np.testing.assert_allclose(part[5:8].seconds, [2.5, 2.6, 2.7])
        assert part.between(4.0, 4.2).seconds.tolist() == [4.0, 4.1]
        assert part.ray_counts == {1: 30}
        assert read == ([] if read_before else part.times_ns.tolist()), "each once, and no other"
        assert len(scans) == 100

    def test_a_part_outlives_the_recording_and_what_was_not_read_says_that_it_is_closed(
        self, drive: robowidgets.Recording
    ) -> None:
        scans, moments = drive.scans(), drive.samples("/scan")
        part = scans.between(2.0, 5.0)
        drive.close()
        assert part.ranges.shape == (30, 1)
        for read in (lambda: scans.ranges, lambda: list(moments)):
            with pytest.raises(RecordingError, match="closed"):
                read()
        assert drive.problems == ()

    @pytest.mark.parametrize(("asked", "got"), [(2.04, 2.0), (2.06, 2.1), (-5, 0.0), (99.0, 9.9), (np.float32(3), 3.0)])
    def test_the_nearest_to_a_time(self, drive: robowidgets.Recording, asked: float, got: float) -> None:
        assert drive.scans().at(asked).seconds == got
        assert drive.scans()[:100].at(asked).seconds == got

    def test_errors_say_what_to_do(self, drive: robowidgets.Recording) -> None:
        scans = drive.scans()
        with pytest.raises(IndexError, match="/scan: expected a number from 0 to 99, got 100"):
            scans[100]
        with pytest.raises(
            TypeError, match=r"a slice of numbers or a mask, got 2\.5; by time there are at\(seconds\) and between"
        ):
            scans[2.5]  # type: ignore[call-overload]
        with pytest.raises(TypeError, match="start: expected seconds from the start of the recording, got 'x'"):
            scans.between("x")  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="seconds: expected seconds from the start of the recording, got nan"):
            scans.at(NAN)
        with pytest.raises(RecordingError, match="/scan: the topic has no samples"):
            scans[:0].at(1)

    def test_the_topic_may_be_left_out_if_there_is_only_one(self, drive: robowidgets.Recording, tmp_path: Path) -> None:
        assert drive.scans().topic == "/scan"
        assert drive.speeds().topic == "/odom"  # /cmd_vel is commanded
        assert drive.touches().topic == "/bumper"
        with pytest.raises(UnknownTopicError, match="has no touch sensors"):
            open_sweeps(tmp_path, *sweeps.numbered(2)).touches()
        with pytest.raises(UnknownTopicError, match="'/odom' is a topic of speeds; topics of laser scans: /scan"):
            drive.scans("/odom")
        with pytest.raises(UnknownTopicError, match="has no topic '/scam'"):
            drive.scans("/scam")
        drive.close()
        with pytest.raises(RecordingError, match="is closed: open it again"):
            drive.scans()

    def test_several_of_a_kind_have_to_be_named(self, data: Path) -> None:
        with pytest.raises(UnknownTopicError, match=r"several topics of laser scans \(/scan, /stable_scan\): name the"):
            robowidgets.open(data / "good" / "neato_fsm").scans()


class TestRayCounts:
    @pytest.fixture
    def scans(self, tmp_path: Path) -> Any:
        rays = [4, 4, 6, 4, 6]
        return open_sweeps(tmp_path, *((i, sweeps.scan(START_NS, [i + 1.0] * n)) for i, n in enumerate(rays))).scans()

    def test_are_never_mixed_in_one_array(self, scans: Any) -> None:
        with pytest.raises(
            RecordingError, match=r"number of rays changes: 3 with 4 rays, 2 with 6 rays; \.groups has one series"
        ):
            _ = scans.ranges
        assert scans.ray_counts == {4: 3, 6: 2}
        assert [len(moment.sample) for moment in scans] == [4, 4, 6, 4, 6]

    def test_each_has_a_series_of_its_own(self, scans: Any) -> None:
        four, six = scans.groups
        assert (four.ranges.shape, six.ranges.shape) == ((3, 4), (2, 6))
        np.testing.assert_array_equal(four.ranges[:, 0], [1, 2, 4])
        np.testing.assert_array_equal(six.seconds, [2, 4])
        assert four.groups == (four,)
        assert [chunk.start for chunk in four.chunks()] == [0, 2]

    def test_geometry_that_changes_has_no_common_angles(self, tmp_path: Path) -> None:
        moved = [(i, sweeps.scan(START_NS, [1.0] * 3, angle_min=i)) for i in range(2)]
        scans = open_sweeps(tmp_path, *moved).scans()
        assert scans.ranges.shape == (2, 3)
        assert scans.angle_min.tolist() == [0, 1]
        with pytest.raises(RecordingError, match=r"have no common angles, because their geometry changes \(2 kinds\)"):
            _ = scans.angles

    def test_intensities_that_come_and_go_are_nan_if_there_are_none(self, tmp_path: Path) -> None:
        some = [(0, sweeps.scan(START_NS, [1.0] * 3, [5.0] * 3)), (1, sweeps.scan(START_NS, [1.0] * 3))]
        np.testing.assert_array_equal(open_sweeps(tmp_path, *some).scans().intensities, [[5.0] * 3, [NAN] * 3])


class TestClocks:
    def test_that_go_back_keep_the_order_of_arrival(self, tmp_path: Path) -> None:
        times = [0.0, 1.0, 2.0, 0.5, 1.5, 2.5]
        scans = open_sweeps(tmp_path, *((t, sweeps.scan(START_NS, [i + 1.0])) for i, t in enumerate(times))).scans()
        assert scans.seconds.tolist() == [0.0, 1.0, 2.0, 2.0, 2.0, 2.5]
        assert scans.ranges[:, 0].tolist() == [1, 2, 3, 4, 5, 6]
        assert scans.problems == ()
        assert scans.between(2.0, 2.5).ranges[:, 0].tolist() == [3, 4, 5]
        assert scans.at(1.6).sample.ranges[0] == 3

    def test_of_several_senders_are_put_into_the_order_of_time(self, tmp_path: Path) -> None:
        times = [i / 10 + 0.5 * (i % 2) for i in range(40)]
        recording = open_sweeps(tmp_path, *((t, sweeps.scan(START_NS, [i + 1.0])) for i, t in enumerate(times)))
        scans = recording.scans()
        assert scans.seconds.tolist() == pytest.approx(sorted(times))
        assert scans.problems == recording.problems == ()
        assert scans.ranges[:, 0].tolist() == [moment.sample.ranges[0] for moment in recording.samples("/scan")]
        assert sorted(scans.between(1.0, 1.45).ranges[:, 0].tolist()) == [6, 8, 10, 11, 13, 15]
        assert scans.at(0.61).sample.ranges[0] in (2, 7)

    def test_are_problems_of_the_recording_once_they_were_read_and_after_it_is_closed(self, tmp_path: Path) -> None:
        recording = open_sweeps(tmp_path, *((0.0, sweeps.scan(START_NS, [1.0])) for _ in range(20)))
        assert recording.problems == ()
        assert len(recording.scans()) == 20
        told = ("/scan: the clock stands still: 19 of 20 samples bear the time of the one before",)
        assert recording.problems == told
        recording.close()
        assert recording.problems == told

    def test_that_stand_still_or_jump_are_reported(self, tmp_path: Path) -> None:
        still = open_sweeps(tmp_path, *((0, sweeps.scan(START_NS, [1.0])) for _ in range(20))).scans()
        assert still.problems == ("the clock stands still: 19 of 20 samples bear the time of the one before",)
        times = [0.1 * i + 4000 * (i > 5) for i in range(10)]
        jumps = open_sweeps(tmp_path / "2", *((t, sweeps.scan(START_NS, [1.0])) for t in times)).scans()
        assert jumps.problems == ("nothing was recorded for 4000.10 s from 0.50 s on, or the clock jumped ahead",)

    def test_that_go_on_are_not_worth_a_word(self, data: Path) -> None:
        for path in (data / "good").iterdir():
            with robowidgets.open(path) as recording:
                for topic in recording.topics:
                    if topic.widget == "laser":
                        assert recording.scans(topic.name).problems == ()


class TestMemory:
    def test_an_array_beyond_the_limit_is_refused_with_what_to_do(self, tmp_path: Path) -> None:
        recording = open_sweeps(tmp_path, *sweeps.numbered(300, rays=1000))
        recording.memory = 1_000_000
        scans = recording.scans()
        with pytest.raises(
            RecordingError,
            match=r"/scan: the array of all ranges would take 1\.2 MB of memory, and the limit is 1\.0 MB: take a "
            r"part of it \(series\[a:b\], series\.between\(start, end\)\), go through \.chunks\(\), or set recording\.",
        ):
            _ = scans.ranges
        assert scans[:100].ranges.shape == (100, 1000)
        assert sum(len(chunk) for chunk in scans.chunks()) == 300
        recording.memory = 2_000_000
        assert scans.ranges.shape == (300, 1000)

    def test_what_is_held_stays_below_the_limit(self, tmp_path: Path) -> None:
        recording = open_sweeps(tmp_path, *sweeps.numbered(3000, rays=1000))
        recording.memory = 3_000_000
        scans = recording.scans()
        seen = []
        for chunk in scans.chunks():
            seen.append(recording._memory._bytes)
            whole = chunk.ranges
            while isinstance(whole, np.ndarray) and whole.base is not None:
                whole = whole.base
            assert memoryview(whole).nbytes <= 2 * chunk.ranges.nbytes  # not a view of all that was read
        assert 1_000_000 < max(seen) <= 3_000_000
        assert [moment.seconds for moment in scans[::1500]] == [0, 150]

    def test_a_file_that_is_gone_can_be_read_until_it_is_closed(self, tmp_path: Path) -> None:
        recording = open_sweeps(tmp_path, *sweeps.numbered(900, rays=1000))
        scans = recording.scans()
        recording.memory = 1
        assert len(scans) == 900
        next((tmp_path / "sweeps").glob("*.mcap")).unlink()
        assert scans[3].sample.ranges[0] == np.float32(1.03)
        recording.close()
        with pytest.raises(RecordingError, match="is closed"):
            recording.scans()

    @pytest.mark.parametrize(
        ("limit", "error", "text"),
        [
            (0, ValueError, "expected a number of bytes above 0, got 0"),
            ("1 GB", TypeError, "expected a whole number of bytes, got '1 GB'"),
        ],
    )
    def test_an_invalid_limit_is_refused(
        self, drive: robowidgets.Recording, limit: Any, error: type[Exception], text: str
    ) -> None:
        with pytest.raises(error, match=f"memory: {text}"):
            drive.memory = limit


class TestTables:
    def test_numpy(self, drive: robowidgets.Recording) -> None:
        assert {name: column.shape for name, column in drive.scans().to_numpy().items()} == {
            "times_ns": (100,),
            "seconds": (100,),
            "stamps_ns": (100,),
            "ranges": (100, 1),
            "intensities": (100, 0),
        }

    def test_pandas_has_a_column_for_each_ray(self, tmp_path: Path) -> None:
        frame = open_sweeps(tmp_path, *sweeps.numbered(5)).scans().to_pandas()
        assert frame.shape == (5, 4)
        assert frame.index.name == "seconds"
        assert frame.loc[0.3, 2] == pytest.approx(1.03)

    def test_polars_and_arrow_have_arrays_of_ranges(self, tmp_path: Path) -> None:
        scans = open_sweeps(tmp_path, *sweeps.numbered(5)).scans()
        frame, table = scans.to_polars(), scans.to_arrow()
        assert frame.columns == table.column_names == ["times_ns", "seconds", "stamps_ns", "ranges"]
        assert frame["ranges"][3].to_list() == pytest.approx([1.03] * 4)
        assert str(table.schema.field("ranges").type) == "fixed_size_list<item: float>[4]"
        assert table["ranges"][3].as_py() == pytest.approx([1.03] * 4)

    def test_speeds_and_touches_have_a_column_for_each_axis_and_sensor(self, drive: robowidgets.Recording) -> None:
        assert drive.speeds().to_pandas()["linear.x"].iloc[-1] == pytest.approx(0.99)
        assert drive.speeds().to_arrow()["angular.z"].null_count == 0
        touches = drive.touches()
        assert touches.to_pandas()["left"].tolist() == [True, False, True, False]
        assert touches.to_pandas()["center"].isna().all()
        assert touches.to_polars()["left"].to_list() == [True, False, True, False]
        assert touches.to_arrow()["right"].to_pylist() == [None] * 4
        for some in (touches, touches[:0]):
            assert str(some.to_pandas()["left"].dtype) == "boolean"
            assert str(some.to_polars()["left"].dtype) == "Boolean"
            assert str(some.to_arrow()["left"].type) == "bool"

    @pytest.mark.parametrize(
        ("method", "library"), [("to_pandas", "pandas"), ("to_polars", "polars"), ("to_arrow", "pyarrow")]
    )
    def test_a_missing_library_is_named(
        self, drive: robowidgets.Recording, monkeypatch: pytest.MonkeyPatch, method: str, library: str
    ) -> None:
        monkeypatch.setitem(sys.modules, library, None)
        with pytest.raises(ImportError, match=rf"{method}\(\) needs {library}, .*: pip install {library}"):
            getattr(drive.scans(), method)()


class TestTouches:
    def test_events_hold_until_the_next(self, drive: robowidgets.Recording) -> None:
        touches = drive.touches()
        assert touches.labels == ("left", "center", "right")
        assert touches.states.tolist() == [[1, 2, 2], [0, 2, 2], [1, 2, 2], [0, 2, 2]]
        assert touches.seconds.tolist() == [2, 3, 6, 7]
        assert touches.said.all()
        assert dict(touches.at(2.2).sample.touched) == {"left": True, "center": None, "right": None}
        assert [dict(moment.sample.touched)["left"] for moment in touches[1:3]] == [False, True]

    def test_the_real_bump_is_found(self, data: Path) -> None:
        touches = robowidgets.open(data / "good" / "neato_fsm").touches()
        pressed = (touches.states == 1).any(axis=1)
        assert int(pressed.sum()) == 13
        assert touches.seconds[pressed][0] == pytest.approx(21.96, abs=0.01)

    def test_a_list_of_touched_sensors_releases_without_a_message(self, tmp_path: Path) -> None:
        touched = {0.0: True, 0.1: True, 0.2: False, 2.0: True}
        touches = robowidgets.open(hazards.write(tmp_path / "x", touched)).touches()
        left = touches.labels.index("left")
        rows = zip(touches.seconds.tolist(), touches.states[:, left].tolist(), touches.said.tolist(), strict=True)
        assert [(round(t, 3), state, said) for t, state, said in rows] == [
            (0.0, 1, True),
            (0.1, 1, True),
            (0.2, 1, True),  # left out, and held for 0.15 s after it was last listed
            (0.25, 0, False),
            (2.0, 1, True),
            (2.15, 0, False),
        ]

    @pytest.mark.parametrize("mode", TouchMode)
    def test_a_message_that_says_the_same_again_changes_no_more_than_one_that_differs(self, mode: TouchMode) -> None:
        said = [{"left": True}, {"left": True}, {}, {}, {"left": True}, {"left": True}, {"left": True}]
        times = [0, 10**8, 2 * 10**8, 5 * 10**8, 6 * 10**8, 6 * 10**8, 9 * 10**8]
        touches = [Touch(touched, mode, ("left",)) for touched in said]
        again = [touches[0], touches[0], touches[2], touches[2], touches[4], touches[4], touches[4]]
        one, other = (_read([touch_chunk(t, times)]) for t in (touches, again))
        for column in ("times_ns", "states", "said"):
            assert getattr(one, column).tolist() == getattr(other, column).tolist()

    def test_a_sensor_is_unknown_in_the_rows_before_it_is_heard_of(self) -> None:
        said = [{}, {"left": True}, {"left": False, "right": True}, {"left": True}]
        chunk = touch_chunk([Touch(touched) for touched in said], range(10, 14))
        table = _read([chunk])
        assert table.labels == ("left", "right")
        assert table.states.tolist() == [[2, 2], [1, 2], [0, 1], [1, 1]]
        assert (table.times_ns.tolist(), table.said.tolist()) == ([10, 11, 12, 13], [True] * 4)

"""The fast path from bytes to samples gives the results of the slow one."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robowidgets import Scan, Speed
from robowidgets.files import open_source
from robowidgets.kinds import kind_of_shape, kind_of_type
from robowidgets.laser.row import LASER
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import DecodeError, shape_of
from robowidgets.recordings.columns.series import series_of
from robowidgets.speed.row import SPEED

SCAN = "sensor_msgs/msg/LaserScan"
ODOMETRY = "nav_msgs/msg/Odometry"
FILES = (
    *(
        "good/turtlebot3_gazebo.bag",
        "good/turtlebot3_gazebo_mcap/fuse_turtlebot3_mcap.mcap",
        "good/neato_fsm/fsm_0.db3",
    ),
    *("good/tilt_laser.bag", "good/urg_681.bag", "odd/ros1_messages_in_mcap.mcap", "odd/lz4_stage_90_rays.bag"),
    *("odd/every_ros2_type_mcap/test_bag_mcap.mcap", "odd/no_slash_topic_minus_inf.bag"),
)


class Watched:
    """A decoder of one channel, and the number of messages that it read in full."""

    def __init__(self, type_name: str, encoding: str = "cdr", definition: str = "") -> None:
        channel = Channel(1, "/topic", type_name, encoding, definition, 1)
        kind = kind_of_type(type_name) or kind_of_shape(shape_of(channel))
        assert kind
        self.convert = kind.read
        self.decoder: Any = series_of(kind).decoder(channel, kind)
        self.full = self.decoder.read
        self.calls = 0
        self.decoder.read = self._read

    def _read(self, raw: bytes) -> Any:
        self.calls += 1
        return self.full(raw)

    def __call__(self, *raws: bytes) -> list[Any]:
        """The samples, together."""
        errors: list[Exception] = []
        chunks = self.decoder.decode(raws, list(range(len(raws))), lambda _, error: errors.append(error))
        if errors:
            raise errors[0]
        return [chunk.sample(row) for chunk in chunks for row in range(len(chunk))]

    def slowly(self, raw: bytes) -> Any:
        """The sample from rosbags and the reader of the kind."""
        return self.convert(self.full(raw))


def same(one: Scan | Speed, other: Scan | Speed) -> bool:
    if isinstance(one, Speed):
        return one == other
    assert isinstance(other, Scan)
    names = ("angle_min", "angle_increment", "range_min", "range_max", "stamp_ns", "frame_id", "header_problems")
    arrays = ("ranges", "intensities", "angles", "validity")
    return all(getattr(one, n) == getattr(other, n) for n in names) and all(
        np.array_equal(getattr(one, n), getattr(other, n), equal_nan=True) for n in arrays
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_every_sample_of_real_files_is_the_same(data: Path, name: str) -> None:
    source = open_source(data / name)
    tried = 0
    for channel in source.channels:
        if kind_of_type(channel.type) not in (LASER, SPEED) or not channel.count:
            continue
        watched = Watched(channel.type, channel.encoding, channel.definition)
        raws = [raw for _, _, raw in source.messages([channel])]
        for at in range(0, len(raws), 100):
            for sample, raw in zip(watched(*raws[at : at + 100]), raws[at : at + 100], strict=True):
                assert same(sample, watched.slowly(raw))
        tried += 1
        # Scans with several echoes have their numbers at other positions each time.
        if "MultiEcho" not in channel.type:
            assert watched.calls <= max(1, channel.count // 10), f"{channel.topic}: {watched.calls} read in full"
    source.close()
    assert tried


def scan_bytes(
    ranges: tuple[float, ...] = (1.0, 2.0, 3.0),
    intensities: tuple[float, ...] = (),
    frame: bytes = b"laser\0\0\0",
    angle_min: float = -1.0,
    stamp: tuple[int, int] = (5, 6),
    times: tuple[float, float] = (0.0, 0.0),
) -> bytes:
    """A LaserScan in little-endian CDR; the frame's length is a multiple of four."""
    return (
        b"\0\1\0\0"
        + struct.pack("<iII", *stamp, len(frame))
        + frame
        + struct.pack("<7f", angle_min, 1.0, 1.0, *times, 0.1, 30.0)
        + struct.pack(f"<I{len(ranges)}f", len(ranges), *ranges)
        + struct.pack(f"<I{len(intensities)}f", len(intensities), *intensities)
    )


class TestScans:
    def test_of_a_scanner_are_read_in_full_only_once(self) -> None:
        watched = Watched(SCAN)
        _, scan = watched(scan_bytes(), scan_bytes((4.0, np.inf, np.nan), stamp=(7, 8)))
        assert watched.calls == 1
        assert scan.ranges.tolist()[:2] == [4.0, np.inf]
        assert scan.stamp_ns == 7_000_000_008
        assert scan.frame_id == "laser\0\0"
        assert not scan.ranges.flags.writeable

    @pytest.mark.parametrize(
        "other",
        [
            scan_bytes(angle_min=-1.5),
            scan_bytes(frame=b"lasex\0\0\0"),
            scan_bytes((1.0, 2.0, 3.0, 4.0)),
            scan_bytes((1.0, 2.0), intensities=(9.0,)),
            scan_bytes((1.0,), intensities=(9.0, 8.0)),
            scan_bytes(()),
        ],
    )
    def test_of_another_scanner_are_read_in_full(self, other: bytes) -> None:
        watched = Watched(SCAN)
        first, second, third = watched(scan_bytes(), other, scan_bytes())
        assert same(second, watched.slowly(other))
        assert watched.calls >= 2
        assert same(first, watched.slowly(scan_bytes()))
        assert same(third, watched.slowly(scan_bytes()))

    def test_with_intensities_that_change(self) -> None:
        watched = Watched(SCAN)
        scans = watched(scan_bytes(intensities=(1.0, 2.0, 3.0)), scan_bytes(intensities=(4.0, 5.0, 6.0)))
        assert scans[1].intensities.tolist() == [4.0, 5.0, 6.0]
        assert watched.calls == 1

    def test_say_each_time_that_intensities_do_not_fit(self) -> None:
        for scan in Watched(SCAN)(*2 * [scan_bytes(intensities=(1.0, 2.0))]):
            assert scan.intensities.size == 0
            assert any("2 intensities for 3 rays" in odd.what for odd in scan.problems())

    def test_of_which_the_times_change_are_read_in_full_only_once(self) -> None:
        watched = Watched(SCAN)
        raws = [scan_bytes((float(i), 2.0, 3.0), times=(i / 1e6, i / 10)) for i in range(100)]
        assert [scan.ranges[0] for scan in watched(*raws)] == list(range(100))
        assert watched.calls == 1

    @pytest.mark.parametrize("times", [(0.0, 61.0), (0.0, -1.0), (np.nan, 0.1), (np.inf, 0.1)])
    def test_note_times_that_no_scanner_has(self, times: tuple[float, float]) -> None:
        watched = Watched(SCAN)
        usual, odd, again = watched(scan_bytes(), scan_bytes(times=times), scan_bytes())
        assert not usual.problems()
        assert any("not used" in problem.what for problem in odd.problems())
        assert not again.problems()

    def test_go_on_after_a_message_that_is_not_a_scan(self) -> None:
        watched = Watched(SCAN)
        watched(scan_bytes())
        with pytest.raises(DecodeError):
            watched(scan_bytes()[:-9])
        assert len(watched(scan_bytes())[0]) == 3

    def test_in_big_endian_are_read_in_full(self) -> None:
        little = scan_bytes()
        big = b"\0\0\0\0" + struct.pack(">iII", 5, 6, 8) + b"laser\0\0\0"
        big += struct.pack(">7f", -1.0, 1.0, 1.0, 0.0, 0.0, 0.1, 30.0) + struct.pack(">I3fI", 3, 1.0, 2.0, 3.0, 0)
        watched = Watched(SCAN)
        assert all(scan.ranges.tolist() == [1.0, 2.0, 3.0] for scan in watched(big, big, little, big))
        assert watched.calls == 4

    def test_without_a_header_have_no_stamp(self) -> None:
        names = ("angle_min", "angle_increment", "range_min", "range_max")
        definition = "int32 a\nuint32 b\n" + "".join(f"float32 {name}\n" for name in names) + "float32[] ranges\n"
        raw = b"\0\1\0\0" + struct.pack("<iI4fI2f", 0, 0, -1.0, 1.0, 0.1, 30.0, 2, 1.0, 2.0)
        for scan in Watched("my_msgs/msg/Scan", definition=definition)(raw, raw):
            assert (scan.ranges.tolist(), scan.stamp_ns) == ([1.0, 2.0], None)


class TestSpeeds:
    def odometry(
        self,
        x: float,
        frame: bytes = b"odom\0\0\0\0",
        child: bytes = b"base\0\0\0\0",
        pose: Sequence[float] = (1, 2, 3, 0.1, 0.2, 0.3, 0.9),
    ) -> bytes:
        head = struct.pack("<iII", 5, 6, len(frame)) + frame + struct.pack("<I", len(child)) + child
        head += bytes(-len(head) % 8)
        return b"\0\1\0\0" + head + struct.pack("<43d", *pose, *range(36)) + struct.pack("<42d", x, *range(41))

    def test_of_a_robot_are_read_in_full_only_once(self) -> None:
        watched = Watched(ODOMETRY)
        raws = [self.odometry(x) for x in (0.5, -0.25, np.nan)]
        assert [repr(speed) for speed in watched(*raws)] == [repr(watched.slowly(raw)) for raw in raws]
        assert watched.calls == 1

    def test_the_poses_of_odometry_come_with_them(self) -> None:
        watched = Watched(ODOMETRY)
        turned, unset = (4, 5, 0, 0, 0, -3.0, 0), (6, 7, 0, 0, 0, 0, 0)
        raws = [self.odometry(0.5), *(self.odometry(0.5, pose=pose) for pose in (turned, unset))]
        first, second, third = (speed.pose for speed in watched(*raws))
        assert [first, second] == [watched.slowly(raw).pose for raw in raws[:2]]
        assert second == (4.0, 5.0, pytest.approx(np.pi))
        assert third.x == 6.0
        assert np.isnan(third.yaw), "the user has not set the orientation"
        assert watched.calls == 1

    def test_of_another_frame_are_read_in_full(self) -> None:
        watched = Watched(ODOMETRY)
        raws = [self.odometry(0.5, child=child) for child in (b"base\0\0\0\0", b"bass\0\0\0\0", b"base_footprint\0\0")]
        assert watched(*raws) == [watched.slowly(raw) for raw in raws]
        assert watched.calls == 3

    @pytest.mark.parametrize("encoding", ["cdr", "ros1"])
    def test_in_a_plain_twist(self, encoding: str) -> None:
        watched = Watched("geometry_msgs/msg/Twist", encoding)
        lead = b"\0\1\0\0" if encoding == "cdr" else b""
        speeds = watched(*(lead + struct.pack("<6d", x, 1, 2, 3, 4, 5) for x in (0.0, 1.0, 2.0)))
        assert speeds == [Speed((x, 1, 2), (3, 4, 5)) for x in (0.0, 1.0, 2.0)]
        assert watched.calls == 1

    def test_within_a_larger_message(self) -> None:
        definition = "string name\ngeometry_msgs/Twist twist\nfloat64 weight\n"
        watched = Watched("my_msgs/msg/State", "ros1", definition)
        raws = [struct.pack("<I", 3) + b"bot" + struct.pack("<7d", x, 1, 2, 3, 4, 5, 60) for x in (0.5, 0.75)]
        assert watched(*raws) == [Speed((x, 1, 2), (3, 4, 5)) for x in (0.5, 0.75)]
        assert watched.calls == 1

    def test_before_other_fields(self) -> None:
        watched = Watched("my_msgs/msg/State", "ros1", "geometry_msgs/Twist twist\nstring name\nfloat64[] weights\n")
        raws = [
            struct.pack("<6d", x, 1, 2, 3, 4, 5) + struct.pack("<I", 3) + b"bot" + struct.pack("<Id", 1, x)
            for x in (0.5, 0.75)
        ]
        assert watched(*raws) == [Speed((x, 1, 2), (3, 4, 5)) for x in (0.5, 0.75)]
        assert watched.calls == 1

    def test_without_a_fixed_place_are_read_in_full(self) -> None:
        watched = Watched("my_msgs/msg/State", "ros1", "geometry_msgs/Twist twist\nstring name\n")
        raws = [
            struct.pack("<6d", x, 1, 2, 3, 4, 5) + struct.pack("<I", len(name)) + name
            for x, name in ((0.5, b"one"), (0.75, b"three"))
        ]
        assert [speed.linear[0] for speed in watched(*raws)] == [0.5, 0.75]
        assert watched.calls == 2

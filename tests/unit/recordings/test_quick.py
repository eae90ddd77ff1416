"""The short way from bytes to samples gives what the long one does."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from robowidgets.recordings.quick import ScanReader, SpeedReader

from robowidgets import Scan, Speed
from robowidgets.kinds import widget_by_type
from robowidgets.messages import to_scan, to_speed
from robowidgets.messages.decoding import Decode, decoder_of, shape_of
from robowidgets.recordings.files import _open_file
from robowidgets.repair.source import Channel, RecordingError

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


def of(type_name: str, encoding: str = "cdr") -> tuple[Decode, dict, str]:
    channel = Channel(1, "/topic", type_name, encoding, "", 1)
    return decoder_of(channel), shape_of(channel), encoding


def counting(decode: Decode) -> tuple[Decode, Callable[[], int]]:
    """The decoder, and how often it was used."""
    calls: list[int] = []
    return lambda raw: (calls.append(1), decode(raw))[1], lambda: len(calls)


def same(one: Scan | Speed, other: Scan | Speed) -> bool:
    if isinstance(one, Speed):
        return one == other
    assert isinstance(other, Scan)
    names = ("angle_min", "angle_increment", "range_min", "range_max", "stamp_ns", "frame_id", "notes")
    arrays = ("ranges", "intensities", "angles", "validity")
    return all(getattr(one, n) == getattr(other, n) for n in names) and all(
        np.array_equal(getattr(one, n), getattr(other, n), equal_nan=True) for n in arrays
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_every_sample_of_real_files_is_the_same(data: Path, name: str) -> None:
    source = _open_file(data / name)
    tried = 0
    for channel in source.channels:
        widget = widget_by_type(channel.type)
        if widget not in ("laser", "speed") or not channel.count:
            continue
        decode, shape = decoder_of(channel), shape_of(channel)
        watched, calls = counting(decode)
        reader = (ScanReader if widget == "laser" else SpeedReader)(watched, shape, channel.encoding)
        convert = to_scan if widget == "laser" else to_speed
        for _, _, raw in source.messages([channel]):
            assert same(reader(raw), convert(decode(raw)))
        tried += 1
        assert calls() <= max(1, channel.count // 10), f"{channel.topic} took the long way {calls()} times"
    source.close()
    assert tried


def scan_bytes(
    ranges: tuple[float, ...] = (1.0, 2.0, 3.0),
    intensities: tuple[float, ...] = (),
    frame: bytes = b"laser\0\0\0",
    angle_min: float = -1.0,
    stamp: tuple[int, int] = (5, 6),
) -> bytes:
    """A LaserScan in little-endian CDR; the frame's length is a multiple of four."""
    return (
        b"\0\1\0\0"
        + struct.pack("<iII", *stamp, len(frame))
        + frame
        + struct.pack("<7f", angle_min, 1.0, 1.0, 0.0, 0.0, 0.1, 30.0)
        + struct.pack(f"<I{len(ranges)}f", len(ranges), *ranges)
        + struct.pack(f"<I{len(intensities)}f", len(intensities), *intensities)
    )


class TestAScanReader:
    def reader(self) -> tuple[ScanReader, Callable[[], int]]:
        decode, shape, encoding = of(SCAN)
        watched, calls = counting(decode)
        return ScanReader(watched, shape, encoding), calls

    def test_reads_only_the_first_of_a_scanner_in_full(self) -> None:
        reader, calls = self.reader()
        reader(scan_bytes())
        scan = reader(scan_bytes((4.0, np.inf, np.nan), stamp=(7, 8)))
        assert calls() == 1
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
    def test_reads_in_full_what_is_not_the_same_scanner(self, other: bytes) -> None:
        reader, calls = self.reader()
        reader(scan_bytes())
        assert same(reader(other), to_scan(of(SCAN)[0](other)))
        assert calls() == 2
        assert same(reader(scan_bytes()), to_scan(of(SCAN)[0](scan_bytes())))

    def test_reads_intensities_that_change(self) -> None:
        reader, calls = self.reader()
        reader(scan_bytes(intensities=(1.0, 2.0, 3.0)))
        assert reader(scan_bytes(intensities=(4.0, 5.0, 6.0))).intensities.tolist() == [4.0, 5.0, 6.0]
        assert calls() == 1

    def test_says_again_that_intensities_do_not_fit(self) -> None:
        reader, _ = self.reader()
        for _ in range(2):
            scan = reader(scan_bytes(intensities=(1.0, 2.0)))
            assert scan.intensities.size == 0
            assert scan.notes == ("2 intensities for 3 rays: not used", *scan.notes[1:]) or any(
                "2 intensities for 3 rays" in note for note in scan.notes
            )

    def test_refuses_what_is_no_scan_and_goes_on(self) -> None:
        reader, _ = self.reader()
        reader(scan_bytes())
        with pytest.raises(RecordingError):
            reader(scan_bytes()[:-9])
        assert len(reader(scan_bytes())) == 3

    def test_reads_big_endian_messages_the_long_way(self) -> None:
        little = scan_bytes()
        big = b"\0\0\0\0" + struct.pack(">iII", 5, 6, 8) + b"laser\0\0\0"
        big += struct.pack(">7f", -1.0, 1.0, 1.0, 0.0, 0.0, 0.1, 30.0) + struct.pack(">I3fI", 3, 1.0, 2.0, 3.0, 0)
        reader, calls = self.reader()
        for raw in (big, big, little, big):
            assert reader(raw).ranges.tolist() == [1.0, 2.0, 3.0]
        assert calls() == 4

    def test_does_not_look_for_a_stamp_where_there_is_no_header(self) -> None:
        names = ("angle_min", "angle_increment", "range_min", "range_max")
        definition = "int32 a\nuint32 b\n" + "".join(f"float32 {name}\n" for name in names) + "float32[] ranges\n"
        channel = Channel(1, "/topic", "my_msgs/msg/Scan", "cdr", definition, 1)
        reader = ScanReader(decoder_of(channel), shape_of(channel), "cdr")
        raw = b"\0\1\0\0" + struct.pack("<iI4fI2f", 0, 0, -1.0, 1.0, 0.1, 30.0, 2, 1.0, 2.0)
        for _ in range(2):
            scan = reader(raw)
            assert (scan.ranges.tolist(), scan.stamp_ns) == ([1.0, 2.0], None)


class TestASpeedReader:
    def odometry(self, x: float, frame: bytes = b"odom\0\0\0\0", child: bytes = b"base\0\0\0\0") -> bytes:
        head = struct.pack("<iII", 5, 6, len(frame)) + frame + struct.pack("<I", len(child)) + child
        head += bytes(-len(head) % 8)
        return b"\0\1\0\0" + head + struct.pack("<43d", *range(43)) + struct.pack("<42d", x, *range(41))

    def test_reads_only_the_first_of_a_robot_in_full(self) -> None:
        decode, shape, encoding = of(ODOMETRY)
        watched, calls = counting(decode)
        reader = SpeedReader(watched, shape, encoding)
        for x in (0.5, -0.25, np.nan):
            raw = self.odometry(x)
            assert repr(reader(raw)) == repr(to_speed(decode(raw)))
        assert calls() == 1

    def test_reads_in_full_what_is_said_of_another_frame(self) -> None:
        decode, shape, encoding = of(ODOMETRY)
        watched, calls = counting(decode)
        reader = SpeedReader(watched, shape, encoding)
        for child in (b"base\0\0\0\0", b"bass\0\0\0\0", b"base_footprint\0\0"):
            raw = self.odometry(0.5, child=child)
            assert reader(raw) == to_speed(decode(raw))
        assert calls() == 3

    @pytest.mark.parametrize("encoding", ["cdr", "ros1"])
    def test_reads_a_plain_twist(self, encoding: str) -> None:
        decode, shape, _ = of("geometry_msgs/msg/Twist", encoding)
        watched, calls = counting(decode)
        reader = SpeedReader(watched, shape, encoding)
        for x in (0.0, 1.0, 2.0):
            raw = (b"\0\1\0\0" if encoding == "cdr" else b"") + struct.pack("<6d", x, 1, 2, 3, 4, 5)
            assert reader(raw) == Speed((x, 1, 2), (3, 4, 5))
        assert calls() == 1

    def test_finds_a_twist_within_a_larger_message(self) -> None:
        definition = "string name\ngeometry_msgs/Twist twist\nfloat64 weight\n"
        channel = Channel(1, "/topic", "my_msgs/msg/State", "ros1", definition, 1)
        watched, calls = counting(decoder_of(channel))
        reader = SpeedReader(watched, shape_of(channel), "ros1")
        for x in (0.5, 0.75):
            raw = struct.pack("<I", 3) + b"bot" + struct.pack("<7d", x, 1, 2, 3, 4, 5, 60)
            assert reader(raw) == Speed((x, 1, 2), (3, 4, 5))
        assert calls() == 1

    def test_reads_the_long_way_what_has_no_fixed_place(self) -> None:
        definition = "geometry_msgs/Twist twist\nstring name\n"
        channel = Channel(1, "/topic", "my_msgs/msg/State", "ros1", definition, 1)
        reader = SpeedReader(decoder_of(channel), shape_of(channel), "ros1")
        for x, name in ((0.5, b"one"), (0.75, b"three")):
            raw = struct.pack("<6d", x, 1, 2, 3, 4, 5) + struct.pack("<I", len(name)) + name
            assert reader(raw).linear[0] == x

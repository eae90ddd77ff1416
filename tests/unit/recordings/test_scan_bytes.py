"""What is read of a LaserScan without rosbags is what rosbags reads of it."""

from __future__ import annotations

import random
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robowidgets.messages.decoding import shape_of, store_of
from robowidgets.recordings import scan_bytes
from robowidgets.recordings.files import _open_file
from robowidgets.repair.source import Channel

SCAN = "sensor_msgs/msg/LaserScan"
FILES = ("good/turtlebot3_gazebo.bag", "good/neato_fsm/fsm_0.db3", "good/urg_681.bag", "odd/lz4_stage_90_rays.bag")
SETTINGS = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")
CDR = shape_of(Channel(1, "/scan", SCAN, "cdr", "", 1))


def theirs(channel: Channel, raw: bytes) -> Any:
    """The message as rosbags alone reads it."""
    store = store_of(channel)
    read = store.deserialize_ros1 if channel.encoding == "ros1" else store.deserialize_cdr
    return read(memoryview(raw), channel.type)


def same(ours: Any, other: Any) -> bool:
    """Whether two messages say the same, to the bit."""
    one, two = ours.header, other.header
    return (
        (one.stamp.sec, one.stamp.nanosec, one.frame_id) == (two.stamp.sec, two.stamp.nanosec, two.frame_id)
        and all(struct.pack("<f", getattr(ours, n)) == struct.pack("<f", getattr(other, n)) for n in SETTINGS)
        and all(getattr(ours, n).tobytes() == getattr(other, n).tobytes() for n in ("ranges", "intensities"))
    )


def message(encoding: str, frame: bytes = b"laser", ranges: int = 3, intensities: int = 2) -> bytes:
    text = frame + b"\0" * (encoding == "cdr")
    pad = b"\0" * (-len(text) % 4 if encoding == "cdr" else 0)
    return b"".join(
        (
            b"\0\1\0\0" if encoding == "cdr" else b"\7\0\0\0",
            struct.pack("<iII", 5, 4_000_000_000, len(text)) + text + pad,
            struct.pack("<7f", -1.0, 1.0, 0.5, 0.0, 0.1, 0.2, 30.0),
            struct.pack(f"<I{ranges}f", ranges, *range(ranges)),
            struct.pack(f"<I{intensities}f", intensities, *range(intensities)),
        )
    )


@pytest.mark.parametrize("name", FILES)
def test_every_scan_of_real_files_is_the_same(data: Path, name: str) -> None:
    source = _open_file(data / name)
    channels = [channel for channel in source.channels if channel.type == SCAN]
    assert channels
    for channel in channels:
        assert scan_bytes.is_usual(shape_of(channel), channel.encoding)
        for _, _, raw in source.messages([channel]):
            ours = scan_bytes.read(raw, channel.encoding)
            assert ours is not None
            assert same(ours, theirs(channel, raw))
    source.close()


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
@pytest.mark.parametrize("frame", [b"", b"l", b"laser", b"base_laser_link"])
@pytest.mark.parametrize("counts", [(0, 0), (1, 0), (3, 3), (0, 2)])
def test_any_frame_and_any_number_of_rays_is_read(encoding: str, frame: bytes, counts: tuple[int, int]) -> None:
    raw = message(encoding, frame, *counts)
    ours = scan_bytes.read(raw, encoding)
    assert ours is not None
    assert (ours.ranges.size, ours.intensities.size) == counts
    assert same(ours, theirs(Channel(1, "/scan", SCAN, encoding, "", 1), raw))


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_what_is_damaged_is_read_alike_or_left_to_rosbags(encoding: str) -> None:
    chance, channel, read = random.Random(1), Channel(1, "/scan", SCAN, encoding, "", 1), 0
    for _ in range(3000):
        raw = bytearray(message(encoding, b"laser"[: chance.randrange(6)], chance.randrange(4), chance.randrange(4)))
        for _ in range(chance.randrange(3)):
            raw[chance.randrange(len(raw))] = chance.choice((0, 1, 2, 255, chance.randrange(256)))
        kept = bytes(raw[: chance.choice((None, chance.randrange(len(raw) + 1)))]) + bytes(chance.choice((0, 0, 1, 4)))
        ours = scan_bytes.read(kept, encoding)
        if ours is not None:
            read += 1
            assert same(ours, theirs(channel, kept))
    assert 300 < read < 2700


@pytest.mark.parametrize(
    "raw",
    [
        b"\0\0" + message("cdr")[2:],
        message("cdr", "läser".encode()),
        message("cdr") + b"\0",
        message("cdr")[:-1],
        message("cdr")[:-12],
    ],
    ids=["big-endian", "not ASCII", "too long", "too short", "no intensities"],
)
def test_what_is_unusual_is_left_to_rosbags(raw: bytes) -> None:
    assert scan_bytes.read(raw, "cdr") is None


@pytest.mark.parametrize(
    ("shape", "encoding"),
    [
        ({"ranges": "float32[]"}, "cdr"),
        ({}, "cdr"),
        (CDR, "ros1"),
        ({**CDR, "more": "uint8"}, "cdr"),
        ({**CDR, "ranges": "float64[]"}, "cdr"),
        ({**CDR, "header": "std_msgs/Header"}, "cdr"),
    ],
    ids=["ranges alone", "nothing", "another encoding", "one more field", "doubles", "another header"],
)
def test_other_types_are_left_to_rosbags(shape: dict[str, Any], encoding: str) -> None:
    assert not scan_bytes.is_usual(shape, encoding)


def test_its_arrays_are_views_of_the_message() -> None:
    raw = message("cdr")
    scan = scan_bytes.read(raw, "cdr")
    assert scan is not None
    assert np.shares_memory(scan.ranges, np.frombuffer(raw, np.uint8))
    assert not scan.ranges.flags.writeable

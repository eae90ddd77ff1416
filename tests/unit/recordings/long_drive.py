"""An MCAP file of many chunks, written for a test: as long as wanted, with little on disk."""

from __future__ import annotations

import struct
from pathlib import Path

from robowidgets.messages.encoding import encode

from .recorded import START_NS, stamped
from .sweeps import TYPE as SCAN
from .sweeps import scan

_MAGIC = b"\x89MCAP0\r\n"
_SECOND = 1_000_000_000
CHUNK_SECONDS = 1.0
_SPEED = "geometry_msgs/msg/TwistStamped"
_IMAGE = "sensor_msgs/msg/CompressedImage"


def write(
    path: Path,
    chunks: int,
    *,
    image: int = 1 << 20,
    others: int = 0,
    rare: int = 0,
    overlap_ns: int = 0,
    profile: str = "ros2",
    encoding: str = "cdr",
) -> Path:
    """A drive with a chunk each second: ten scans, two speeds and an image of so many zeros, which are a hole on disk.

    Args:
        path: the file.
        chunks: the number of chunks, and of seconds.
        image: bytes of the image in each chunk.
        others: the number of further topics with a speed each second.
        rare: the number of further topics with three messages each, at different times in the middle.
        overlap_ns: how much before the end of the chunk before it a chunk begins.
        profile: the profile in the header.
        encoding: the encoding that the other topics claim.
    """
    topics = [("/scan", SCAN), ("/speed", _SPEED), ("/camera", _IMAGE)]
    topics += [(f"/other_{i}", _SPEED) for i in range(others)] + [(f"/rare_{i}", _SPEED) for i in range(rare)]
    with path.open("wb") as file:
        file.write(_MAGIC + _record(1, _text(profile) + _text("tests")))
        indexes = [_write_chunk(file, number, chunks, topics, image, others, overlap_ns) for number in range(chunks)]
        file.write(_record(15, bytes(4)))
        start = file.tell()
        counts: dict[int, int] = {}
        for _, _, own in indexes:
            for channel, count in own.items():
                counts[channel] = counts.get(channel, 0) + count
        for name in dict.fromkeys(kind for _, kind in topics):
            number = 1 + [SCAN, _SPEED, _IMAGE].index(name)
            file.write(_record(3, struct.pack("<H", number) + _text(name) + _text("ros2msg") + _text("")))
        for channel, (topic, name) in enumerate(topics):
            schema = 1 + [SCAN, _SPEED, _IMAGE].index(name)
            named = encoding if channel > 2 else "cdr"
            file.write(_record(4, struct.pack("<HH", channel, schema) + _text(topic) + _text(named) + bytes(4)))
        first, last = START_NS - overlap_ns, max(end for _, end, _ in indexes)
        table = b"".join(struct.pack("<HQ", *one) for one in counts.items())
        head = struct.pack("<QHIIIIQQ", sum(counts.values()), 3, len(topics), 0, 0, chunks, first, last)
        file.write(_record(11, head + struct.pack("<I", len(table)) + table))
        for index, _, _ in indexes:
            file.write(index)
        file.write(_record(2, struct.pack("<QQI", start, 0, 0)) + _MAGIC)
    return path


def _write_chunk(
    file,
    number: int,
    chunks: int,
    topics: list[tuple[str, str]],
    image: int,
    others: int,
    overlap_ns: int,  # type: ignore[no-untyped-def]
) -> tuple[bytes, int, dict[int, int]]:
    """Write a chunk with its message indexes; return the record of its index, its end, and its counts by channel."""
    start = file.tell()
    begin = START_NS + int(number * CHUNK_SECONDS * _SECOND)
    data = bytearray()
    entries: dict[int, list[tuple[int, int]]] = {}

    def add(channel: int, time_ns: int, raw: bytes) -> None:
        entries.setdefault(channel, []).append((time_ns, len(data)))
        data.extend(_head(5, 22 + len(raw)) + struct.pack("<HIQQ", channel, 0, time_ns, time_ns) + raw)

    for i in range(10):
        time_ns = begin + i * _SECOND // 10
        time_ns -= overlap_ns if i == 0 else 0
        add(0, time_ns, scan(time_ns, [1 + (number * 10 + i) % 1000 / 100] * 4))
    for i in range(2):
        add(1, begin + i * _SECOND // 2, _speed(begin, number / 100))
    for i in range(others):
        add(3 + i, begin + i * 1000, _speed(begin, i))
    for i in range(3 + others, len(topics)):
        if number in {(chunks * (i + 1)) // (len(topics) + 8) + k * 3 for k in range(3)}:
            add(i, begin + i * 1000, _speed(begin, i))
    head = encode("cdr", _IMAGE, {"header": stamped(begin), "format": "jpeg", "data": b""})[:-4]
    entries[2] = [(begin + 1, len(data))]
    data += _head(5, 22 + len(head) + 4 + image) + struct.pack("<HIQQ", 2, 0, begin + 1, begin + 1)
    data += head + struct.pack("<I", image)
    size = len(data) + image
    times = [time_ns for own in entries.values() for time_ns, _ in own]
    first, last = min(times), max(times)
    file.write(_head(6, 40 + size) + struct.pack("<QQQIIQ", first, last, size, 0, 0, size) + data)
    file.seek(image, 1)
    length = file.tell() - start
    offsets, index_start = b"", file.tell()
    for channel, own in entries.items():
        offsets += struct.pack("<HQ", channel, file.tell())
        table = b"".join(struct.pack("<QQ", *entry) for entry in own)
        file.write(_record(7, struct.pack("<HI", channel, len(table)) + table))
    index = struct.pack("<QQQQI", first, last, start, length, len(offsets)) + offsets
    index += struct.pack("<Q", file.tell() - index_start) + _text("") + struct.pack("<QQ", size, size)
    return _record(8, index), last, {channel: len(own) for channel, own in entries.items()}


def _speed(stamp_ns: int, forward: float) -> bytes:
    return encode("cdr", _SPEED, {"header": stamped(stamp_ns), "twist": {"linear": {"x": forward}}})


def _head(op: int, size: int) -> bytes:
    return struct.pack("<BQ", op, size)


def _record(op: int, body: bytes) -> bytes:
    return _head(op, len(body)) + body


def _text(text: str) -> bytes:
    return struct.pack("<I", len(text)) + text.encode()

"""CARMEN logs: text, a message a line, in the order in which they were logged."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

from ..messages.channel import Channel
from ._carmen_lines import (
    ESTIMATE,
    NEW_SCANS,
    OLD_SCANS,
    SPEEDS,
    checked,
    estimate,
    new_scan,
    odometry,
    old_scan,
    range_max_of,
    time_ns_of,
    word_of,
)
from ._clock import repaired_log
from ._records import Damage
from ._report import kind
from ._walk import Walk
from .source import RecordingError

_EXPECTED = "a ROS bag (.bag), a rosbag2 folder, a .db3, an .mcap or a CARMEN log (.log, .clf, gzipped or not)"
_GZIP = b"\x1f\x8b"
_BLOCK = 1 << 16
_LOOKED_AT = 1 << 20
_SMALL = 1 << 26
_RATIO = 20
"""Bytes of text from one of a gzipped log, at most: real ones give ten. Up to `_SMALL` any do."""

_TYPES = {
    **dict.fromkeys(SPEEDS, "nav_msgs/msg/Odometry"),
    **dict.fromkeys((*OLD_SCANS, *NEW_SCANS), "sensor_msgs/msg/LaserScan"),
    ESTIMATE: "geometry_msgs/msg/Pose2D",
}


def walk_carmen(path: Path) -> Walk:
    """The messages of a CARMEN log, gzipped or not, as the ROS 1 messages that say the same.

    Its topics are the names of the lines: FLASER, ROBOTLASER1, ODOM, ... A program that makes maps writes ODOM lines of
    its own into a log, each before a line NEFF: poses that it estimates, with a speed of 0 and mostly without a time.
    They are no measurement, and are the poses of NEFF.

    Raises:
        RecordingError: it is no such log.
    """
    text, problems = _text(path)
    words: list[str] = []
    lines: list[bytes] = []
    left_out: dict[str, str] = {}
    for line in text.splitlines():
        word = word_of(line)
        if word == ESTIMATE and words and words[-1] == "ODOM":
            words[-1] = ESTIMATE
        elif word in _TYPES and word != ESTIMATE:
            try:
                checked(line)
            except ValueError as error:
                left_out.setdefault(word, f"{word}: lines that cannot be read are left out, such as: {error}")
                continue
            words.append(word)
            lines.append(line)
    if len(lines) > 1 and text.endswith(lines[-1]) and _is_before(lines[-1], lines[-2]):
        # A number that was cut is a smaller one.
        words.pop()
        lines.pop()
        problems = problems or ["the log was cut off within its last line, which is left out"]
    timed = [i for i, word in enumerate(words) if word != ESTIMATE]
    monotonic, about_times = repaired_log([time_ns_of(lines[i]) for i in timed])
    times = [monotonic[0] if monotonic else 0] * len(lines)
    for time_ns, i in zip(monotonic, timed, strict=True):
        times[i] = time_ns
    for i in range(1, len(lines)):
        times[i] = max(times[i - 1], times[i]) if words[i] == ESTIMATE else times[i]
    names = list(dict.fromkeys(words))
    numbers = {name: i for i, name in enumerate(names)}
    by_name: dict[str, list[bytes]] = {name: [] for name in names}
    for word, line in zip(words, lines, strict=True):
        by_name[word].append(line)
    encoders = {name: _encoder(name, own) for name, own in by_name.items()}
    return Walk(
        name=path.name,
        size=len(text),
        channels=[Channel(i, name, _TYPES[name], "ros1", "", 0) for i, name in enumerate(names)],
        times=times,
        ids=[numbers[word] for word in words],
        read=lambda number: encoders[words[number]](lines[number]),
        close=lambda: None,
        damage=Damage(),
        problems=tuple(filter(None, (*problems, about_times, *left_out.values()))),
    )


def _is_before(line: bytes, other: bytes) -> bool:
    """Whether a line has an earlier time than another."""
    time, other_time = time_ns_of(line), time_ns_of(other)
    return time is None or (other_time is not None and time < other_time)


def _encoder(word: str, lines: list[bytes]) -> Callable[[bytes], bytes]:
    if word in SPEEDS:
        return odometry
    if word in NEW_SCANS:
        return new_scan
    return estimate if word == ESTIMATE else partial(old_scan, range_max=range_max_of(lines))


def _text(path: Path) -> tuple[bytes, list[str]]:
    with path.open("rb") as file:
        head = file.read(64)
        if not head:
            raise RecordingError(f"{path.name}: the file is empty: expected {_EXPECTED}")
        packed = head.startswith(_GZIP)
        file.seek(0)
        start = file.read(_LOOKED_AT)
        start = _gunzip(start, _LOOKED_AT)[0] if packed else start
        if not any(word_of(line) for line in start.splitlines()):
            is_foreign = not packed or not start
            got = kind(head) if is_foreign else f"{kind(start[:64])} in gzip: unpack it with gunzip"
            raise RecordingError(f"{path.name}: expected {_EXPECTED}, got {got}")
        file.seek(0)
        text = file.read()
    if not packed:
        return text, []
    limit = max(_SMALL, _RATIO * len(text))
    text, whole = _gunzip(text, limit)
    if whole:
        return text, []
    if len(text) == limit:
        return text, [f"more than {_RATIO} times its size comes out of the file: read the first {limit:,} bytes"]
    return text, ["the file was cut off or is damaged: read what could be decompressed"]


def _gunzip(data: bytes, limit: int) -> tuple[bytes, bool]:
    """What can be decompressed, up to a limit, and whether that is all of it."""
    text = bytearray()
    stream = zlib.decompressobj(wbits=31)
    try:
        for start in range(0, len(data), _BLOCK):
            text += stream.decompress(data[start : start + _BLOCK], limit - len(text) + 1)
            if len(text) > limit:
                return bytes(text[:limit]), False
    except zlib.error:
        return bytes(text), False
    return bytes(text), stream.eof

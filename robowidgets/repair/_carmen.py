"""CARMEN logs: text files with one message per line, in the order of logging."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from functools import cache, partial
from itertools import compress
from pathlib import Path
from typing import NamedTuple

from ..messages.channel import Channel
from ._carmen_lines import (
    ESTIMATE,
    NEW_SCANS,
    OLD_SCANS,
    SPEEDS,
    check,
    estimate,
    name_of,
    new_scan,
    odometry,
    old_scan,
    range_max_of,
    time_ns_of,
)
from ._clock import repaired_log
from ._found_messages import Damage, Walk
from ._report import format_of
from .source import RecordingError

_EXPECTED = "a ROS bag (.bag), a rosbag2 folder, a .db3, an .mcap or a CARMEN log (.log, .clf, gzipped or not)"
_GZIP = b"\x1f\x8b"
_BLOCK = 1 << 16
_LOOKED_AT = 1 << 20
_SMALL = 1 << 26
_RATIO = 20
"""Most bytes of text per byte of a gzipped log: real logs have ten. Up to `_SMALL` bytes any ratio is accepted."""

_TYPES = {
    **dict.fromkeys(SPEEDS, "nav_msgs/msg/Odometry"),
    **dict.fromkeys((*OLD_SCANS, *NEW_SCANS), "sensor_msgs/msg/LaserScan"),
    ESTIMATE: "geometry_msgs/msg/Pose2D",
}


class _Lines(NamedTuple):
    """The lines with messages: the names of their topics, their bytes, and the first error of each topic."""

    names: list[str]
    texts: list[bytes]
    errors: dict[str, str]


def walk_carmen(path: Path) -> Walk:
    """The messages of a CARMEN log, gzipped or not, as ROS 1 messages with the same content.

    Its topics are the names of the lines: FLASER, ROBOTLASER1, ODOM, ... Lines that are cut are left out.

    Raises:
        RecordingError: the file is no CARMEN log.
    """
    text, problems = _text(path)
    if b"\n" in text and not text.endswith(b"\n"):
        # A whole log ends with a newline, and a number that was cut off is another number.
        text = text[: text.rindex(b"\n") + 1]
        problems = problems or ["the log was cut off within its last line, which is left out"]
    names, lines, errors = _lines(text)
    times, about_clock = _times(names, lines)
    topics = list(dict.fromkeys(names))
    numbers = {topic: i for i, topic in enumerate(topics)}
    encoder = cache(lambda topic: _encoder(topic, names, lines))
    return Walk(
        name=path.name,
        size=len(text),
        channels=[Channel(i, topic, _TYPES[topic], "ros1", "", 0) for topic, i in numbers.items()],
        times=times,
        ids=[numbers[name] for name in names],
        read=lambda number: encoder(names[number])(lines[number]),
        close=lambda: None,
        damage=Damage(),
        problems=tuple(filter(None, (*problems, about_clock, *errors.values()))),
    )


def _lines(text: bytes) -> _Lines:
    """The lines of a log in their order.

    Mapping programs add ODOM lines of their own to a log, each before a line NEFF. These are estimated poses, not
    measurements, with a speed of 0 and mostly without a time. They become the topic NEFF.
    """
    found = _Lines([], [], {})
    for line in text.splitlines():
        name = name_of(line)
        if name == ESTIMATE and found.names and found.names[-1] == "ODOM":
            found.names[-1] = ESTIMATE
        elif name in _TYPES and name != ESTIMATE:
            try:
                check(name, line)
            except ValueError as error:
                found.errors.setdefault(name, f"{name}: lines that cannot be read are left out, such as: {error}")
                continue
            found.names.append(name)
            found.texts.append(line)
    return found


def _times(names: Sequence[str], lines: Sequence[bytes]) -> tuple[list[int], str]:
    """Monotonic log times, and a line on problems of the clock. An estimate has the time of the line before it."""
    is_timed = [name != ESTIMATE for name in names]
    monotonic, about_clock = repaired_log([time_ns_of(line) for line in compress(lines, is_timed)])
    latest = monotonic[0] if monotonic else 0
    remaining = iter(monotonic)
    times = []
    for timed in is_timed:
        latest = next(remaining) if timed else latest
        times.append(latest)
    return times, about_clock


def _encoder(topic: str, names: Sequence[str], lines: Sequence[bytes]) -> Callable[[bytes], bytes]:
    """A function that turns a line of a topic into a message."""
    if topic in SPEEDS:
        return odometry
    if topic in NEW_SCANS:
        return new_scan
    if topic == ESTIMATE:
        return estimate
    own = [line for name, line in zip(names, lines, strict=True) if name == topic]
    return partial(old_scan, range_max=range_max_of(own))


def _text(path: Path) -> tuple[bytes, list[str]]:
    with path.open("rb") as file:
        head = file.read(64)
        if not head:
            raise RecordingError(f"{path.name}: the file is empty: expected {_EXPECTED}")
        packed = head.startswith(_GZIP)
        file.seek(0)
        start = file.read(_LOOKED_AT)
        start = _gunzip(start, _LOOKED_AT)[0] if packed else start
        if not any(name_of(line) for line in start.splitlines()):
            is_foreign = not packed or not start
            got = format_of(head) if is_foreign else f"{format_of(start[:64])} in gzip: unpack it with gunzip"
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
    """The data that can be decompressed, up to a limit, and whether it is complete."""
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

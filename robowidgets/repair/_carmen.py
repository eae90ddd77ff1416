"""CARMEN logs: text files with one message per line, in the order of logging."""

from __future__ import annotations

import gzip
import re
import zlib
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from functools import cache, partial
from itertools import compress
from pathlib import Path
from typing import NamedTuple

from ..messages.channel import Channel
from ..runtime.text import many
from ._carmen_lines import (
    ESTIMATE,
    NEW_SCANS,
    OLD_SCANS,
    SPEEDS,
    WORDS,
    count_words,
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
from ._report import HEAD, format_of
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
    """The lines with messages: the names of their topics, their bytes, and problems of omitted lines by topic."""

    names: list[str]
    texts: list[bytes]
    problems: list[str]


def is_carmen(path: Path) -> bool:
    """Return True if a file has the name of a CARMEN log, and one of its first lines is a message of CARMEN."""
    name = path.with_suffix("") if path.suffix == ".gz" else path
    if name.suffix not in (".log", ".clf") or not path.is_file():
        return False
    try:
        with (gzip.open if path.suffix == ".gz" else open)(path, "rb") as file:
            return any(map(name_of, file.read(_BLOCK).splitlines()))
    except (OSError, EOFError, zlib.error):
        return False


def walk_carmen(path: Path) -> Walk:
    """Find the messages of a CARMEN log, gzipped or not, as ROS 1 messages with the same content.

    Its topics are the names of the lines: FLASER, ROBOTLASER1, ODOM, ... Lines that are cut are left out.

    Raises:
        RecordingError: the file is not a CARMEN log.
    """
    text, problems = _text(path)
    if b"\n" in text and not text.endswith(b"\n"):
        # A complete log ends with a newline, and a number that was cut off is another number.
        text = text[: text.rindex(b"\n") + 1]
        problems = problems or ["the log was cut off within its last line, which is left out"]
    if zeros := re.findall(rb"\0+", text):
        # Data that a disk lost, or never wrote, reads as zeros. A line before them may continue as another line.
        size, places = sum(map(len, zeros)), many(len(zeros), "place")
        problems.append(
            f"{size:,} bytes of the log are zeros, in {places}: the lines that they replace or cut are left out"
        )
    names, lines, about_lines = _lines(text)
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
        problems=tuple(filter(None, (*problems, about_clock, *about_lines))),
    )


def _lines(text: bytes) -> _Lines:
    """Return the lines of a log in their order.

    Mapping programs add further ODOM lines to a log, each before a line NEFF. These are estimated poses, not
    measurements, with a speed of 0 and mostly without a time. They become the topic NEFF.

    A line has as many words as CARMEN writes, or as most lines of its topic, because other programs add some. A line
    with more or fewer words was cut, or joined to the rest of another.
    """
    names: list[str] = []
    lines: list[tuple[bytes, int]] = []
    errors: dict[str, list[str]] = defaultdict(list)
    before = ""
    for line in text.splitlines():
        name = "" if b"\0" in line else name_of(line)
        if name == ESTIMATE and before == "ODOM":
            names[-1] = ESTIMATE
        elif name in _TYPES and name != ESTIMATE:
            try:
                lines.append((line, count_words(name, line)))
                names.append(name)
            except ValueError as error:
                errors[name].append(str(error))
                name = ""
        before = name
    usual = _usual_words(names, [words for _, words in lines])
    whole = []
    for name, (_, words) in zip(names, lines, strict=True):
        whole.append(words in (WORDS[name], usual[name]))
        if not whole[-1]:
            expected = f"expected {usual[name]} words other than readings, got {words}"
            errors[name].append(f"{expected}: the line is cut, or joined to another")
    problems = [
        f"{name}: left out {many(len(texts), 'line')} that cannot be read, such as: {texts[0]}"
        for name, texts in errors.items()
    ]
    return _Lines(list(compress(names, whole)), [line for line, _ in compress(lines, whole)], problems)


def _usual_words(names: Sequence[str], words: Sequence[int]) -> dict[str, int]:
    """Return the usual number of words other than readings in the lines of a topic; the default is CARMEN's number."""
    counts: dict[str, Counter[int]] = defaultdict(Counter)
    for name, number in zip(names, words, strict=True):
        counts[name][number] += 1
    usual = dict(WORDS)
    for name, own in counts.items():
        ((number, lines),) = own.most_common(1)
        if 1 < lines > own.total() / 2:
            usual[name] = number
    return usual


def _times(names: Sequence[str], lines: Sequence[bytes]) -> tuple[list[int], str]:
    """Return monotonic log times, and a line on problems of the clock. An estimate gets the time of the line before."""
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
    """Return a function that converts a line of a topic to a message."""
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
        head = file.read(HEAD)
        if not head:
            raise RecordingError(f"{path.name}: the file is empty: expected {_EXPECTED}")
        packed = head.startswith(_GZIP)
        file.seek(0)
        start = file.read(_LOOKED_AT)
        start = _gunzip(start, _LOOKED_AT)[0] if packed else start
        if not any(name_of(line) for line in start.splitlines()):
            is_foreign = not packed or not start
            got = format_of(head) if is_foreign else format_of(start[:HEAD])
            if not is_foreign and ";" not in got:
                got = f"{got} in gzip: unpack it with gunzip"
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
        return text, [f"the file decompresses to more than {_RATIO} times its size: read the first {limit:,} bytes"]
    return text, ["the file was cut off or is damaged: read what could be decompressed"]


def _gunzip(data: bytes, limit: int) -> tuple[bytes, bool]:
    """Return the data that can be decompressed, up to a limit, and True if it is complete."""
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

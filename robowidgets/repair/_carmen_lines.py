"""The lines of a CARMEN log, and the ROS 1 messages with the same content.

Source: the Carnegie Mellon Robot Navigation Toolkit, http://carmen.sourceforge.net/logger_playback.html
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, isfinite, nan, radians, sin
from struct import pack

import numpy as np
from numpy.typing import NDArray

SPEEDS = ("ODOM",)
OLD_SCANS = ("FLASER", "RLASER")
NEW_SCANS = tuple(f"{word}{number}" for word in ("RAWLASER", "ROBOTLASER") for number in range(1, 6))
ESTIMATE = "NEFF"
_NAMES = {name.encode(): name for name in (*SPEEDS, *OLD_SCANS, *NEW_SCANS, ESTIMATE, "PARAM", "SYNC", "TRUEPOS")}

LONGEST = 80.0
_SHORTEST = 0.01
_STEPS = {180: 1.0, 181: 1.0, 360: 0.5, 361: 0.5, 400: 0.25, 401: 0.25}
_NOTHING = (8.187, 16.379, 32.763, 51.15)
_NEAR = 0.02
_SHARE = 1 / 200
_LINES_LOOKED_AT = 100
_LATEST = 2**62 / 1e9
_LATEST_STAMP = 2**32
"""Seconds at which ROS 1 stamps overflow."""

WORDS = {
    **dict.fromkeys((*SPEEDS, ESTIMATE), 10),
    **dict.fromkeys(OLD_SCANS, 11),
    **{name: 13 if name.startswith("RAW") else 24 for name in NEW_SCANS},
}
"""The number of words of a line other than ranges and remissions."""


def name_of(line: bytes) -> str:
    """Return the name of the message in a line, or an empty text if CARMEN does not have such a message."""
    return _NAMES.get(line.partition(b" ")[0], "")


def time_ns_of(line: bytes) -> int | None:
    """Return the log time of a line, its last word, in nanoseconds, or None if it is not a number or out of range."""
    try:
        seconds = float(line.rsplit(None, 1)[-1])
    except ValueError:
        return None
    return round(seconds * 1e9) if abs(seconds) < _LATEST else None


def count_words(name: str, line: bytes) -> int:
    """Return the number of words in a line other than ranges and remissions.

    Raises:
        ValueError: the line has fewer words than its name and its counts require.
    """
    words = line.split()
    least = 10 if name in SPEEDS else 11 if name in OLD_SCANS else 13
    if len(words) < least:
        raise ValueError(f"expected {least} words or more in a line {name}, got {len(words)}: it is cut")
    counted = 0
    if name in OLD_SCANS:
        counted = _check_count(words, 2, int(words[1]))
    elif name in NEW_SCANS:
        counted = _check_count(words, 9, int(words[8]))
        counted += _check_count(words, 10 + counted, int(words[9 + counted]))
    return len(words) - counted


def odometry(line: bytes) -> bytes:
    """Return the nav_msgs/Odometry for a line ``ODOM x y theta tv rv accel time host logged``."""
    words = line.split()
    x, y, turn = (_float(word) for word in words[1:4])
    if not isfinite(x + y + turn):
        x = y = turn = nan
    pose = (x, y, 0.0, 0.0, 0.0, sin(turn / 2), cos(turn / 2))
    twist = (_float(words[4]), 0.0, 0.0, 0.0, 0.0, _float(words[5]))
    unknown = bytes(36 * 8)
    return b"".join(
        (_header(words, "odom"), _string("base_link"), pack("<7d", *pose), unknown, pack("<6d", *twist), unknown)
    )


def estimate(line: bytes) -> bytes:
    """Return the geometry_msgs/Pose2D for the ODOM line of an estimate."""
    return pack("<3d", *(_float(word) for word in line.split()[1:4]))


def old_scan(line: bytes, range_max: float) -> bytes:
    """Return the LaserScan for an FLASER or RLASER line.

    ``name count ranges… x y theta odom_x odom_y odom_theta time host logged``

    Such lines have no angles. As in CARMEN, 180 or 181 readings are 1 degree apart, 360 or 361 half a degree, 400 or
    401 a quarter, others fill 180 degrees; ray 0 is at the right.
    """
    words = line.split()
    count = int(words[1])
    step = _STEPS.get(count) or 180.0 / max(count - 1, 1)
    start = radians(-50.0 if step == 0.25 else -90.0)
    frame_id = "rear_laser" if words[0] == b"RLASER" else "front_laser"
    return _scan(words, frame_id, start, radians(step), range_max, _floats(words, 2, count))


def new_scan(line: bytes) -> bytes:
    """Return the LaserScan for a RAWLASER or ROBOTLASER line.

    ``name type start_angle field_of_view step range_max accuracy mode count ranges… count remissions… … time host log``
    """
    words = line.split()
    start, sweep, step, range_max = (_float(word) for word in words[2:6])
    count = int(words[8])
    remissions = _floats(words, 10 + count, int(words[9 + count]))
    step = step or sweep / max(count - 1, 1)
    return _scan(words, name_of(line).lower(), start, step, range_max, _floats(words, 9, count), remissions)


def range_max_of(lines: Sequence[bytes]) -> float:
    """Return the maximum range in metres for the scanner of FLASER or RLASER lines, which do not contain it.

    It is 80 m, as in CARMEN. But if the largest reading is a number that such scanners send for "nothing in range", and
    it is frequent (1 reading in 200), the maximum range is just below it.
    """
    seen = _some_ranges(lines)
    longest = float(seen.max()) if seen.size else 0.0
    for nothing in _NOTHING:
        if abs(longest - nothing) < _NEAR and np.count_nonzero(seen > nothing - _NEAR) >= _SHARE * seen.size:
            return round(nothing - _NEAR, 2)
    return LONGEST


def _some_ranges(lines: Sequence[bytes]) -> NDArray[np.float32]:
    looked_at = [np.empty(0, np.float32)]
    for line in lines[:: max(len(lines) // _LINES_LOOKED_AT, 1)]:
        words = line.split()
        looked_at.append(_floats(words, 2, int(words[1])))
    seen = np.concatenate(looked_at)
    return seen[np.isfinite(seen)]


def _scan(
    words: list[bytes],
    frame_id: str,
    start: float,
    step: float,
    range_max: float,
    ranges: NDArray[np.float32],
    intensities: Sequence[float] | NDArray[np.float32] = (),
) -> bytes:
    end = start + step * max(len(ranges) - 1, 0)
    settings = pack("<7f", start, end, step, 0.0, 0.0, _SHORTEST, range_max)
    columns = (pack("<I", len(column)) + np.asarray(column, "<f4").tobytes() for column in (ranges, intensities))
    return b"".join((_header(words, frame_id), settings, *columns))


def _header(words: list[bytes], frame_id: str) -> bytes:
    seconds = _float(words[-3])
    stamp_ns = round(seconds * 1e9) if 0 < seconds < _LATEST_STAMP else 0
    return pack("<III", 0, *divmod(stamp_ns, 1_000_000_000)) + _string(frame_id)


def _string(text: str) -> bytes:
    return pack("<I", len(text)) + text.encode()


def _check_count(words: list[bytes], first: int, count: int) -> int:
    if not 0 <= count <= len(words) - 3 - first:
        raise ValueError(f"expected {count} numbers, got {max(len(words) - 3 - first, 0)}: the line is cut")
    return count


def _floats(words: list[bytes], first: int, count: int) -> NDArray[np.float32]:
    with np.errstate(over="ignore"):  # damaged numbers
        return np.array([_float(word) for word in words[first : first + count]], np.float32)


def _float(word: bytes) -> float:
    """Return the number in a word, or NaN if the word is damaged."""
    try:
        return float(word)
    except ValueError:
        return nan

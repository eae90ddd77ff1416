"""What the lines of a CARMEN log say.

Source: the Carnegie Mellon Robot Navigation Toolkit, http://carmen.sourceforge.net/logger_playback.html
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, isfinite, nan, radians, sin

import numpy as np
from numpy.typing import NDArray

from ..poses.transforms import Pose
from ..samples import Scan, Speed

SPEEDS = ("ODOM",)
OLD_SCANS = ("FLASER", "RLASER")
NEW_SCANS = tuple(f"{word}{number}" for word in ("RAWLASER", "ROBOTLASER") for number in range(1, 6))
ESTIMATE = "NEFF"
WORDS = frozenset((*SPEEDS, *OLD_SCANS, *NEW_SCANS, ESTIMATE, "PARAM", "SYNC", "TRUEPOS"))

LONGEST = 80.0
_SHORTEST = 0.01
_STEPS = {180: 1.0, 181: 1.0, 360: 0.5, 361: 0.5, 400: 0.25, 401: 0.25}
_NOTHING = (8.187, 16.379, 32.763, 51.15)
_NEAR = 0.02
_SHARE = 1 / 200
_LINES_LOOKED_AT = 100
_LATEST = 2**62 / 1e9


def word_of(line: bytes) -> str:
    """The name of a line's message; empty when it is none of CARMEN's."""
    word = line.partition(b" ")[0].decode("ascii", "replace")
    return word if word in WORDS else ""


def time_of(line: bytes) -> float:
    """When a line was logged, in seconds: its last word. NaN when that is no number, or more than clocks have."""
    try:
        seconds = float(line.rsplit(None, 1)[-1])
    except ValueError:
        return nan
    return seconds if abs(seconds) < _LATEST else nan


def speed(line: bytes) -> Speed:
    """The speed in ``ODOM x y theta tv rv accel time host logged``; ValueError when it is no such line."""
    words = _words(line, 10)
    forward, turn = float(words[4]), float(words[5])
    return Speed((forward, 0.0, 0.0), (0.0, 0.0, turn), _stamp_ns(words), "base_link")


def pose(line: bytes) -> Pose | None:
    """Where odometry has the robot, from a line that `speed` reads; None when it says no place."""
    try:
        x, y, turn = (float(word) for word in line.split()[1:4])
    except ValueError:
        return None
    return (x, y, 0.0, 0.0, 0.0, sin(turn / 2), cos(turn / 2)) if isfinite(x + y + turn) else None


def old_scan(line: bytes, range_max: float) -> Scan:
    """The scan in ``FLASER count ranges… x y theta odom_x odom_y odom_theta time host logged``, or in an RLASER line.

    Such lines tell no angles. As in CARMEN, 180 or 181 readings are 1 degree apart, 360 or 361 half a degree, 400 or
    401 a quarter, others fill 180 degrees; ray 0 is at the right.

    Raises:
        ValueError: it is no such line.
    """
    words = _words(line, 11)
    count = int(words[1])
    ranges = _floats(words, 2, count)
    step = _STEPS.get(count) or 180.0 / max(count - 1, 1)
    return Scan(
        ranges=ranges,
        angle_min=radians(-50.0 if step == 0.25 else -90.0),
        angle_increment=radians(step),
        range_min=_SHORTEST,
        range_max=range_max,
        stamp_ns=_stamp_ns(words),
        frame_id="rear_laser" if words[0] == b"RLASER" else "front_laser",
    )


def new_scan(line: bytes) -> Scan:
    """The scan in a RAWLASER or ROBOTLASER line; ValueError when it is no such line.

    ``name type start_angle field_of_view step range_max accuracy mode count ranges… count remissions… … time host log``
    """
    words = _words(line, 13)
    start, sweep, step, range_max = (float(word) for word in words[2:6])
    count = int(words[8])
    ranges = _floats(words, 9, count)
    return Scan(
        ranges=ranges,
        angle_min=start,
        angle_increment=step or sweep / max(count - 1, 1),
        range_min=_SHORTEST,
        range_max=range_max,
        intensities=_floats(words, 10 + count, int(words[9 + count])),
        stamp_ns=_stamp_ns(words),
        frame_id=word_of(line).lower(),
    )


def range_max_of(lines: Sequence[bytes]) -> float:
    """The longest range in metres of the scanner behind some FLASER or RLASER lines, which do not tell it.

    80 m as in CARMEN; but where the greatest number of the log is one of those that such scanners send, by their scale,
    for "nothing", and comes again and again (1 reading in 200), the range ends just below it.
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
        try:
            looked_at.append(_floats(words, 2, int(words[1])))
        except (ValueError, IndexError):
            continue
    seen = np.concatenate(looked_at)
    return seen[np.isfinite(seen)]


def _words(line: bytes, least: int) -> list[bytes]:
    words = line.split()
    if len(words) < least:
        raise ValueError(f"expected {least} words or more in a line {word_of(line)}, got {len(words)}: it is cut")
    return words


def _floats(words: list[bytes], first: int, count: int) -> NDArray[np.float32]:
    if not 0 <= count <= len(words) - 3 - first:
        raise ValueError(f"expected {count} numbers, got {max(len(words) - 3 - first, 0)}: the line is cut")
    return np.array([float(word) for word in words[first : first + count]], np.float32)


def _stamp_ns(words: list[bytes]) -> int | None:
    seconds = float(words[-3])
    return round(seconds * 1e9) if 0 < seconds < _LATEST else None

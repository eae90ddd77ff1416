"""LaserScan messages to scans."""

from __future__ import annotations

from collections.abc import Callable, Sized
from math import degrees, isfinite, pi
from typing import Any

import numpy as np

from ..samples import Scan
from ..samples.scan import number
from .fields import MISSING, describe, frame_id, reader, stamp_ns, unwrap

_NEEDED = ("ranges", "angle_min", "angle_increment", "range_min", "range_max")
_LONGEST_SCAN = 60.0


def to_scan(message: Any) -> Scan:
    """The scan in a LaserScan-like message.

    Args:
        message: an object or dictionary with the fields of sensor_msgs/LaserScan; a `Scan` is returned as it is.

    Raises:
        TypeError: it is not such a message; the text says what came and what was expected.
        ValueError: it is one, but its numbers cannot be shown.
    """
    message = unwrap(message)
    if isinstance(message, Scan):
        return message
    read = reader(message)
    given = {name: read(name, MISSING) for name in _NEEDED}
    missing = [name for name, value in given.items() if value is MISSING]
    if missing:
        raise TypeError(
            f"expected a message like sensor_msgs/LaserScan, with {', '.join(_NEEDED)}; got {describe(message)} "
            f"(missing: {', '.join(missing)})"
        )
    ranges, angle_min, increment, range_min, range_max = given.values()
    if increment is None:
        increment = float("nan")
    intensities = read("intensities", None)
    return Scan(
        ranges=ranges,
        angle_min=angle_min,
        angle_increment=increment,
        range_min=range_min,
        range_max=range_max,
        intensities=np.empty(0, np.float32) if intensities is None else intensities,
        stamp_ns=stamp_ns(message),
        frame_id=frame_id(message),
        notes=(*_about_angles(read("angle_max", None), _count(ranges), angle_min, increment), *_about_times(read)),
    )


def _count(ranges: Any) -> int:
    if not isinstance(ranges, Sized) or isinstance(ranges, (bytes, bytearray, str)):
        raise TypeError(f"ranges: expected an array of numbers, got {describe(ranges)}")
    return len(ranges)


def _about_angles(stated: Any, count: int, angle_min: Any, increment: Any) -> tuple[str, ...]:
    """What the header's angle_max says of the angles where the array says otherwise."""
    if stated is None or count < 2:
        return ()
    first, step = number("angle_min", angle_min), number("angle_increment", increment)
    last = number("angle_max", stated)
    if not all(map(isfinite, (first, step, last))) or step == 0:
        return ()
    implied = (last - first) / step + 1
    off = implied - count
    if abs(off) < 0.5:
        return ()
    if abs(off - 1) < 0.1:
        return ("angle_max is one step too far: angles are counted from angle_min",)
    if implied < 0 and abs(implied + 2 * pi / abs(step) - count) < 1.5:
        return ()
    if implied < 0:
        return (f"angle_max ({degrees(last):.1f}°) lies against angle_increment: angles are counted from angle_min",)
    return (
        f"{count} rays, but the header implies {round(implied)} "
        f"(angle_max {degrees(last):.1f}°): angles are counted from angle_min",
    )


def _about_times(read: Callable[[str, Any], Any]) -> tuple[str, ...]:
    """Times that no scanner can have; they are not used."""
    notes = []
    for name in ("time_increment", "scan_time"):
        value = read(name, 0.0)
        if value is None:
            continue
        seconds = number(name, value)
        if not isfinite(seconds) or not 0 <= seconds <= _LONGEST_SCAN:
            notes.append(f"{name} is {seconds:g} s: not used")
    return tuple(notes)

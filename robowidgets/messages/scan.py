"""LaserScan messages to scans."""

from __future__ import annotations

from math import degrees, isfinite, pi
from typing import Any

from ..samples import Scan
from ..samples.scan import number
from .fields import MISSING, describe, frame_id, get, stamp_ns, unwrap

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
    if isinstance(message, Scan):
        return message
    message = unwrap(message)
    missing = [name for name in _NEEDED if get(message, name) is MISSING]
    if missing:
        raise TypeError(
            f"expected a message like sensor_msgs/LaserScan, with {', '.join(_NEEDED)}; got {describe(message)} "
            f"(missing: {', '.join(missing)})"
        )
    increment = get(message, "angle_increment")
    if increment is None:
        increment = float("nan")
    ranges = get(message, "ranges")
    if isinstance(ranges, (bytes, bytearray, str)):
        raise TypeError(f"ranges: expected an array of numbers, got {type(ranges).__name__}")
    angle_min = get(message, "angle_min")
    return Scan(
        ranges=ranges,
        angle_min=angle_min,
        angle_increment=increment,
        range_min=get(message, "range_min"),
        range_max=get(message, "range_max"),
        intensities=get(message, "intensities", ()),
        stamp_ns=stamp_ns(message),
        frame_id=frame_id(message),
        notes=(*_about_angles(message, len(ranges), angle_min, increment), *_about_times(message)),
    )


def _about_angles(message: Any, count: int, angle_min: Any, increment: Any) -> tuple[str, ...]:
    """What the header says of the angles where the array says otherwise."""
    stated = get(message, "angle_max", None)
    if stated is None or count < 2:
        return ()
    first, step, last = number("angle_min", angle_min), number("angle_increment", increment), number("angle_max", stated)
    if not all(map(isfinite, (first, step, last))) or step == 0:
        return ()
    implied = (last - first) / step + 1
    off = implied - count
    if abs(off) < 0.5:
        return ()
    if abs(off - 1) < 0.1:
        return ("angle_max is one step too far: angles are counted from angle_min",)
    if step > 0 and last < first and abs(implied + 2 * pi / step - count) < 1.5:
        return ()
    return (
        f"{count} rays, but the header implies {round(implied)} "
        f"(angle_max {degrees(last):.1f}°): angles are counted from angle_min",
    )


def _about_times(message: Any) -> tuple[str, ...]:
    """Times that no scanner can have; they are not used."""
    notes = []
    for name in ("time_increment", "scan_time"):
        value = get(message, name, 0.0)
        if value is None:
            continue
        seconds = number(name, value)
        if not isfinite(seconds) or not 0 <= seconds <= _LONGEST_SCAN:
            notes.append(f"{name} is {seconds:g} s: not used")
    return tuple(notes)

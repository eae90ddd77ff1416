"""LaserScan messages to scans."""

from __future__ import annotations

from array import array
from collections.abc import Callable, KeysView, Mapping, Sized
from math import degrees, inf, isfinite, nan, pi
from operator import attrgetter, itemgetter, methodcaller
from typing import Any

import numpy as np

from ..samples import Problem, Scan
from ..samples.checks import OF_DEGREES, is_angle, number, to_radians
from .fields import MISSING, describe, frame_id, get, has, reader, stamp_ns, unwrap

_NEEDED = ("ranges", "angle_min", "angle_increment", "range_min", "range_max")
_SETTINGS = (*_NEEDED[1:], "angle_max", "time_increment", "scan_time")
_COMPARED = frozenset((float, int, np.float32, np.float64, type(None)))
_COPIED = frozenset((np.ndarray, array, list, tuple))
LONGEST_SCAN = 60.0
"""Seconds; a scan_time or time_increment above it is noted and not used."""
_NOTHING: dict[str, Any] = {}
_ONE_RAY = (
    "; a single distance is one ray: ranges=[message.range], angle_min=0, angle_increment=0, "
    "range_min=message.min_range, range_max=message.max_range"
)


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
        by_last = "angle_increment" in missing and read("angle_max", None) is not None
        raise TypeError(
            f"expected a message like sensor_msgs/LaserScan, with {', '.join(_NEEDED)}; got {describe(message)} "
            f"(missing: {', '.join(missing)})"
            + ("; angle_increment = (angle_max - angle_min) / (len(ranges) - 1)" if by_last else "")
            + (_ONE_RAY if has(message, "range", "min_range", "max_range") else "")
        )
    ranges, angle_min, increment, range_min, range_max = given.values()
    # JSON has neither NaN nor infinity.
    if increment is None:
        increment = nan
    if range_max is None:
        range_max = inf
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
        header_problems=(
            *_about_angles(read("angle_max", None), _count(ranges), angle_min, increment),
            *_about_unit(angle_min),
            *_about_times(read),
            *_about_frame(message),
        ),
    )


class ScanReader:
    """Makes scans of the messages of one scanner, as `to_scan` does, but checks only once what stays the same.

    A scanner sends its settings with every scan, and to check them takes longer than to copy the ranges.
    """

    def __init__(self) -> None:
        self.next: Callable[[Any], Scan | None] = _nothing
        """Gives the scan in a message that differs from the last one in values and stamp alone; None for any other."""

    def __call__(self, message: Any) -> Scan:
        """The scan in a message. Raises as `to_scan` does."""
        message = unwrap(message)
        if isinstance(message, Scan):
            return message
        scan = self.next(message)
        if scan is None:
            scan = to_scan(message)
            known = _Known(message, scan)
            self.next = known.next if known.is_usual else _nothing
        return scan


class _Known:
    """A message that was read, to tell whether another differs from it in its values and its stamp alone."""

    def __init__(self, message: Any, scan: Scan) -> None:
        read = reader(message)
        there = [name for name in _SETTINGS if read(name, MISSING) is not MISSING]
        keyed = isinstance(message, Mapping)
        values_of: Callable[..., Callable[[Any], Any]] = itemgetter if keyed else attrgetter
        self._scan = scan
        self._form = type(message)
        self._fields_of: Callable[[Any], KeysView[str]] = methodcaller("keys") if keyed else _fields
        self._fields = frozenset(self._fields_of(message))
        self._values_of = values_of(*there, "ranges")
        self._settings: list[Any] = [*self._values_of(message)][:-1]
        self._kinds = list(map(type, self._settings))
        intensities = read("intensities", None)
        self._uses_intensities = intensities is None or len(intensities) == scan.intensities.size
        self._has_more = not keyed or not self._fields <= {*there, "ranges"}

    @property
    def is_usual(self) -> bool:
        """Whether the next may be like it: what is missing in one, or not used, is looked for in the next."""
        comparable = _COMPARED.issuperset(self._kinds) and None not in self._settings[: len(_NEEDED) - 1]
        return comparable and self._uses_intensities

    def next(self, message: Any) -> Scan | None:
        """The scan in a message that differs in values and stamp alone; None for any other message."""
        if type(message) is not self._form:
            return None
        try:
            # Of those that have nothing more, the names are the same where they are as many, and none is missing.
            if self._fields_of(message) != self._fields if self._has_more else len(message) != len(self._fields):
                return None
            *settings, ranges = self._values_of(message)
            if list(map(type, settings)) != self._kinds or settings != self._settings or type(ranges) not in _COPIED:
                return None
            if not self._has_more:
                return self._scan.again(ranges, None, None)
            if frame_id(message) != self._scan.frame_id:
                return None
            intensities = reader(message)("intensities", None)
            if intensities is not None and type(intensities) not in _COPIED:
                return None
            if intensities is None or not len(intensities):
                return None if self._scan.intensities.size else self._scan.again(ranges, None, stamp_ns(message))
            return self._scan.again(ranges, intensities, stamp_ns(message))
        except (TypeError, ValueError, LookupError, AttributeError):  # `to_scan` finds out what is different
            return None


def _nothing(_message: Any) -> None:
    """Without a previous message, none is like it."""


def _fields(message: Any) -> KeysView[str]:
    """The names in an object that may be different in another of the same type."""
    return getattr(message, "__dict__", _NOTHING).keys()


def _count(ranges: Any) -> int:
    if not isinstance(ranges, Sized) or isinstance(ranges, (bytes, bytearray, str)):
        raise TypeError(f"ranges: expected an array of numbers, got {describe(ranges)}")
    return len(ranges)


def _about_unit(angle_min: Any) -> tuple[Problem, ...]:
    """What is said of an angle that no scanner starts at in radians."""
    first = to_radians("angle_min", angle_min)
    if not isfinite(first) or is_angle(first):
        return ()
    return (Problem(f"angle_min is {first:g} rad", f"is it in degrees? {OF_DEGREES}"),)


def _about_angles(stated: Any, count: int, angle_min: Any, increment: Any) -> tuple[Problem, ...]:
    """The problem of an angle_max that contradicts the number of ranges."""
    if stated is None or count < 2:
        return ()
    first, step = to_radians("angle_min", angle_min), to_radians("angle_increment", increment)
    last = to_radians("angle_max", stated)
    if not all(map(isfinite, (first, step, last))) or step == 0:
        return ()
    implied = (last - first) / step + 1
    off = implied - count
    if abs(off) < 0.5:
        return ()
    if abs(off - 1) < 0.1:
        return (
            Problem(
                f"angle_max is one step too far for {count} rays",
                "angles are counted from angle_min; programs should do so too",
            ),
        )
    if implied < 0 and abs(implied + 2 * pi / abs(step) - count) < 1.5:
        return ()
    if implied < 0:
        return (
            Problem(
                f"angle_max ({degrees(last):.1f}°) lies against angle_increment",
                "angles are counted from angle_min; if left and right are swapped, the driver has a wrong sign",
            ),
        )
    return (
        Problem(
            f"{count} rays, but the header implies {round(implied)} (angle_max {degrees(last):.1f}°)",
            "angles are counted from angle_min; check a known corner, and angle_increment in the driver",
        ),
    )


def _about_times(read: Callable[[str, Any], Any]) -> tuple[Problem, ...]:
    """Times that no scanner can have; they are not used."""
    odd = []
    for name in ("time_increment", "scan_time"):
        value = read(name, 0.0)
        if value is None:
            continue
        seconds = number(name, value)
        if not isfinite(seconds) or not 0 <= seconds <= LONGEST_SCAN:
            odd.append(Problem(f"{name} is {seconds:g} s: not used", "the driver should send seconds, 0 if unknown"))
    return tuple(odd)


def _about_frame(message: Any) -> tuple[Problem, ...]:
    """A header without the name of a coordinate frame. Numbers without a header need none."""
    if get(message, "header.frame_id", None) != "":
        return ()
    return (Problem("frame_id is empty", "set it in the driver, or tf cannot tell where the scanner is"),)

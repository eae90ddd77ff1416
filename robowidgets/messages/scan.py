"""Conversion of LaserScan and MultiEchoLaserScan messages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence, Sized
from math import degrees, inf, isfinite, nan, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..samples import Problem, Scan
from ..samples.checks import OF_DEGREES, floats, is_angle, number, to_radians
from ..samples.echoes import Echoes
from .fields import MISSING, describe, frame_id, get, has, reader, stamp_ns, unwrap

_NEEDED = ("ranges", "angle_min", "angle_increment", "range_min", "range_max")
LONGEST_SCAN = 60.0
"""Seconds; a longer scan_time or time_increment is a problem and not used."""
MOST_ECHOES = 100
"""Echoes of a ray; scanners send up to five."""
_ONE_RAY = (
    "; a single distance is one ray: ranges=[message.range], angle_min=0, angle_increment=0, "
    "range_min=message.min_range, range_max=message.max_range"
)


def to_scan(message: Any) -> Scan:
    """Return the scan in a LaserScan-like message, with the first of several echoes of each ray.

    Args:
        message: an object or dictionary with the fields of sensor_msgs/LaserScan or MultiEchoLaserScan; a `Scan` is
            returned as it is.

    Raises:
        TypeError: the message has another type; the text says what came and what was expected.
        ValueError: its numbers cannot be shown.
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
    intensities = () if intensities is None else intensities
    count = _count(ranges)
    odd: tuple[Problem, ...] = ()
    several: dict[str, Any] = {}
    if count and has(ranges[0], "echoes"):
        echoes, odd = _echoes(ranges, intensities)
        sources = echoes.sources("first")
        ranges, intensities = echoes.at(sources.numbers)
        several = {"echoes": echoes, "sources": sources}
    return Scan(
        ranges=ranges,
        angle_min=angle_min,
        angle_increment=increment,
        range_min=range_min,
        range_max=range_max,
        intensities=intensities,
        stamp_ns=stamp_ns(message),
        frame_id=frame_id(message),
        header_problems=(
            *odd,
            *_about_angles(read("angle_max", None), count, angle_min, increment),
            *_about_unit(angle_min),
            *_about_times(read),
            *_about_frame(message),
        ),
        **several,
    )


def _echoes(ranges: Sequence[Any], intensities: Sequence[Any]) -> tuple[Echoes, tuple[Problem, ...]]:
    """Return the echoes of all rays, and their problems."""
    counts, columns = _columns("ranges", ranges)
    none = np.empty((len(counts), 0), np.float32)
    if not len(intensities):
        return Echoes(counts, columns, none), ()
    lit, strengths = _columns("intensities", intensities)
    if np.array_equal(lit, counts):
        # A scanner without intensities may send empty lists.
        return Echoes(counts, columns, strengths if lit.any() else none), ()
    if not lit.any():
        return Echoes(counts, columns, none), ()
    odd = Problem(
        f"{lit.sum():,} intensities for {counts.sum():,} echoes: not used",
        "the driver should send one for each echo of each ray, or none",
    )
    return Echoes(counts, columns, none), (odd,)


def _columns(name: str, rays: Sequence[Any]) -> tuple[NDArray[np.intp], NDArray[np.float32]]:
    """Return the number of values of each ray, and the values as rows padded with NaN."""
    lists = [get(ray, "echoes", None) for ray in rays]
    if any(not isinstance(values, Sized) or isinstance(values, (bytes, str)) for values in lists):
        raise TypeError(f"{name}: expected a list of echoes for each ray, got {describe(rays[0])}")
    counts = np.fromiter(map(len, lists), np.intp, len(lists))
    columns = np.full((len(lists), counts.max(initial=0)), np.nan, np.float32)
    if columns.shape[1] > MOST_ECHOES:
        raise ValueError(f"{name}: expected at most {MOST_ECHOES} echoes of a ray, got {columns.shape[1]:,}")
    columns[np.arange(columns.shape[1]) < counts[:, None]] = floats(name, [value for ray in lists for value in ray])
    return counts, columns


def _count(ranges: Any) -> int:
    if not isinstance(ranges, Sized) or isinstance(ranges, (bytes, bytearray, str)):
        raise TypeError(f"ranges: expected an array of numbers, got {describe(ranges)}")
    return len(ranges)


def _about_unit(angle_min: Any) -> Iterator[Problem]:
    """Yield the problem of an angle_min that is beyond a full turn, as degrees are."""
    first = to_radians("angle_min", angle_min)
    if isfinite(first) and not is_angle(first):
        yield Problem(f"angle_min is {first:g} rad", f"is it in degrees? {OF_DEGREES}")


def _about_angles(stated: Any, count: int, angle_min: Any, increment: Any) -> Iterator[Problem]:
    """Yield the problem of an angle_max that contradicts the number of ranges."""
    if stated is None or count < 2:
        return
    first, step = to_radians("angle_min", angle_min), to_radians("angle_increment", increment)
    last = to_radians("angle_max", stated)
    if not all(map(isfinite, (first, step, last))) or step == 0:
        return
    implied = (last - first) / step + 1
    if abs(implied - count) < 0.5:
        return
    if abs(implied - count - 1) < 0.1:
        yield Problem(
            f"angle_max is one step too far for {count} rays",
            "angles are counted from angle_min; programs should do so too",
        )
    elif implied >= 0:
        yield Problem(
            f"{count} rays, but the header implies {round(implied)} (angle_max {degrees(last):.1f}°)",
            "angles are counted from angle_min; check a known corner, and angle_increment in the driver",
        )
    elif abs(implied + 2 * pi / abs(step) - count) >= 1.5:
        yield Problem(
            f"angle_max ({degrees(last):.1f}°) lies against angle_increment",
            "angles are counted from angle_min; if left and right are swapped, the driver has a wrong sign",
        )


def _about_times(read: Callable[[str, Any], Any]) -> Iterator[Problem]:
    """Yield the problems of impossible times; they are not used."""
    for name in ("time_increment", "scan_time"):
        value = read(name, None)
        seconds = 0.0 if value is None else number(name, value)
        if not 0 <= seconds <= LONGEST_SCAN:
            yield Problem(f"{name} is {seconds:g} s: not used", "the driver should send seconds, 0 if unknown")


def _about_frame(message: Any) -> Iterator[Problem]:
    """Yield the problem of a header with an empty frame_id. A message without a header does not need one."""
    if get(message, "header.frame_id", None) == "":
        yield Problem("frame_id is empty", "set it in the driver, or tf cannot tell where the scanner is")

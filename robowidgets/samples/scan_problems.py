"""The problems of a scan: of its geometry, which is the same for all scans of a scanner, and of its ranges.

The reader of LaserScan messages (`messages/scan.py`) adds problems of the fields that a `Scan` does not keep.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import numpy as np
from numpy.typing import NDArray

from .checks import OF_DEGREES, shortest
from .problem import Problem
from .ray import CODES_END

_MOST_TURNS = 3

_MILLIMETRES = 25
"""Median ranges above this multiple of range_max are millimetres: it is more than drivers send for "nothing seen"."""

_SHARE = 3
"""It is a problem if at least one ray in this many lies outside the limits."""


def of_geometry(count: int, increment: float) -> Iterator[Problem]:
    """Yield the problems of the angles of a scan: rays that sweep more than a full circle."""
    turns = abs(increment) * (count - 1) / (2 * pi)
    if turns > _MOST_TURNS:
        yield Problem(f"the rays sweep {turns:,.0f} full circles", f"is angle_increment in degrees? {OF_DEGREES}")
    elif turns > 1 + abs(increment) / pi:
        yield Problem(
            "the rays sweep more than a full circle", "the last ones point where the first do; check angle_increment"
        )


def of_intensities(count: int, rays: int) -> Problem:
    """Return the problem of a number of intensities that differs from the number of rays."""
    return Problem(f"{count:,} intensities for {rays:,} rays: not used", "the driver should send one for each, or none")


def of_ranges(ranges: NDArray[np.float32], low: float, high: float) -> Iterator[Problem]:
    """Yield the problems of ranges: no reading at all, or a third or more of the rays outside the limits.

    Codes below `CODES_END`, which many scanners send for "nothing seen", do not count as outside. The text of a problem
    is the same for all scans that have it, so that it is sent to the page, and listed for a recording, once.

    Args:
        ranges: metres, shape (R,).
        low: range_min in metres.
        high: range_max in metres.
    """
    rays = ranges.size
    readings = int(np.count_nonzero((low <= ranges) & (ranges <= high)))
    if rays and _SHARE * (rays - readings) < rays:
        return
    if not readings:
        yield _of_no_reading(ranges, low, high)
        return
    far = int(np.count_nonzero((ranges > high) & (ranges < np.inf)))
    near = int(np.count_nonzero((ranges < low) & (ranges >= CODES_END)))
    if _SHARE * far >= rays:
        yield Problem(
            f"a third or more of the rays lie beyond range_max ({_metres(high)})",
            "they count as nothing met; if they are real, the driver should set range_max higher",
        )
    if _SHARE * near >= rays:
        yield Problem(
            f"a third or more of the rays lie below range_min ({_metres(low)})",
            "they count as too close; uncover the scanner, or set range_min lower in the driver",
        )


def _of_no_reading(ranges: NDArray[np.float32], low: float, high: float) -> Problem:
    """Return the problem of a scan without a reading, by the value that all its rays share."""
    rays = ranges.size
    if not rays:
        return Problem("the scan has no rays", "is the scanner turning? see the log of its driver")
    who = "no readings: " + ("the one ray says" if rays == 1 else f"all {rays:,} rays say")
    first = float(ranges[0])
    if np.isnan(ranges).all():
        return Problem(f"{who} NaN, no measurement", "uncover the scanner; does it turn, and has it power?")
    if np.isposinf(ranges).all():
        return Problem(f"{who} +inf, nothing in range", f"is all farther than {_metres(high)}, or is it covered?")
    if np.isneginf(ranges).all():
        return Problem(f"{who} -inf, too close", f"uncover the scanner: something is nearer than {_metres(low)}")
    finite = ranges[np.isfinite(ranges)]
    usual = float(np.median(finite)) if finite.size else 0.0
    if usual > _MILLIMETRES * high:
        return Problem(
            f"no readings: ranges are around {usual:,.0f} where range_max is {high:g} m",
            "are they in millimetres? They go in metres",
        )
    if (ranges == first).all():
        return Problem(
            f"{who} {shortest(first):g} m, outside {_metres(low)} to {_metres(high)}",
            "the scanner sees nothing, or is covered" if first < CODES_END else "check range_min and range_max",
        )
    return Problem(
        f"no readings: none of the {rays:,} rays lies within {_metres(low)} to {_metres(high)}",
        "uncover the scanner; check range_min and range_max in its driver",
    )


def _metres(value: float) -> str:
    return "no limit" if value >= np.finfo(np.float32).max else f"{value:.4g} m"

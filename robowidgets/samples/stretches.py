"""Stretches: consecutive rays in the array, and the code that names them."""

from __future__ import annotations

import re
from math import ceil, degrees, floor, pi, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .checks import ANGLE_ROUNDING
from .scan import Scan
from .sector import Sector, in_sector

_PART = re.compile(r"\s*(?:(?:msg\.|scan\.)?ranges\s*)?\[\s*(-?\d{1,7})?\s*(:)?\s*(-?\d{1,7})?\s*\]\s*")
_EXPECTED = 'expected text like "ranges[240:300]" or "ranges[350:] + ranges[:10]"'

_LOST = 3e-5
"""Degrees of rounding error; `in_sector` allows for more."""


class Stretch(NamedTuple):
    """Consecutive rays in the array, from one index up to, but not including, another."""

    start: int
    stop: int


def stretches(scan: Scan, sector: Sector) -> list[Stretch]:
    """Return the stretches of the array in a sector, in the order in which the scanner passes through it."""
    inside = np.concatenate(([False], in_sector(scan.angles, sector), [False]))
    edges = np.flatnonzero(inside[1:] != inside[:-1]).tolist()
    found = [Stretch(*pair) for pair in zip(edges[::2], edges[1::2], strict=True)]
    turned = [_passed(scan, sector, one.start) for one in found]
    return [one for _, one in sorted(zip(turned, found, strict=True))]


def expression(found: list[Stretch], count: int) -> str:
    """Return code for stretches: ``ranges[540:610]``, ``ranges[350:] + ranges[:10]``."""
    parts = [
        f"ranges[{'' if len(found) > 1 and start == 0 else start}:{'' if len(found) > 1 and stop == count else stop}]"
        for start, stop in found
    ]
    return " + ".join(parts) or "ranges[0:0]"


def sector_of(scan: Scan, first: int, last: int) -> Sector:
    """Return the sector of the rays from one index to another, both included, with angles in few decimals of degrees.

    The angles are rounded outwards, by less than half a step, so that the sector has these rays and no others.

    Args:
        scan: any scan of the scanner.
        first: index of a ray; on a full circle it may lie beyond the array.
        last: index of another ray.
    """
    step = degrees(abs(scan.angle_increment))
    unit = next((10**n for n in (1, 2, 3) if 10**-n <= step / 2 or not step), 10**4)
    ends = sorted(degrees(scan.angle_min + index * scan.angle_increment) * unit for index in (first, last))
    low, high = floor(ends[0] + _LOST * unit), ceil(ends[1] - _LOST * unit)
    if low == high:
        low, high = low - 1, high + 1
    if high - low >= 360 * unit:
        return Sector("-180deg", "180deg")
    return Sector(*(radians(_within_half_turn(angle, unit) / unit) for angle in (low, high)))


def parse(text: str, count: int) -> NDArray[np.intp]:
    """Return the indices of the rays that a text names: slices and single indices, joined by ``+``.

    Args:
        text: such as ``ranges[240:300]``, ``[-10:]`` or ``ranges[350:] + ranges[:10]``.
        count: the number of rays; slices end there, as in Python.

    Raises:
        ValueError: the text is invalid, or names no ray.
    """
    found: list[int] = []
    for part in text.split("+"):
        match = _PART.fullmatch(part)
        if not match or (not match[2] and (match[1] is None or match[3] is not None)):
            raise ValueError(f"{_EXPECTED}, got {text!r}")
        first, last = (None if number is None else int(number) for number in (match[1], match[3]))
        if match[2]:
            found += range(count)[first:last]
        elif first is not None and -count <= first < count:
            found.append(first % count)
    if not found:
        raise ValueError(f"{text.strip()} names no ray: this scan has {count:,}")
    return np.array(found)


def to_stretches(indices: NDArray[np.intp]) -> list[Stretch]:
    """Return the same rays as stretches, in the order of the array."""
    ordered = np.unique(indices)
    breaks = np.flatnonzero(np.diff(ordered) > 1) + 1
    return [Stretch(int(part[0]), int(part[-1]) + 1) for part in np.split(ordered, breaks) if part.size]


def _within_half_turn(angle: int, unit: int) -> int:
    """Return the same direction above -180 degrees and up to 180, in fractions ``1 / unit`` of a degree."""
    half = 180 * unit
    return (angle + half - 1) % (2 * half) - half + 1


def _passed(scan: Scan, sector: Sector, index: int) -> float:
    """Return the radians of the sector that the scanner has passed when it reaches a ray."""
    angle = float(scan.angles[index])
    turned = sector.end - angle if scan.angle_increment < 0 else angle - sector.start
    return (turned + ANGLE_ROUNDING) % (2 * pi)

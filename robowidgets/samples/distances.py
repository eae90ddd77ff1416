"""Distances that follow from the rays of one scan, or of many with the same limits and angles."""

from __future__ import annotations

from functools import lru_cache
from math import pi
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .checks import ANGLE_ROUNDING, frozen, number
from .ray import CODES_END
from .sector import ALL_ROUND, Sector, SectorLike, in_sector, to_sector


class ScanRays(Protocol):
    """The rays of a scan: the part of `Scan` that this module needs, without importing it."""

    @property
    def ranges(self) -> NDArray[np.float32]:
        """Metres, shape (R,)."""

    @property
    def range_min(self) -> float:
        """Metres."""

    @property
    def range_max(self) -> float:
        """Metres."""

    @property
    def angle_min(self) -> float:
        """Radians."""

    @property
    def angle_increment(self) -> float:
        """Radians."""

    @property
    def angles(self) -> NDArray[np.float64]:
        """Radians, shape (R,)."""

    def __len__(self) -> int: ...


def distances(
    ranges: NDArray[np.float32],
    like: ScanRays,
    sector: SectorLike = ALL_ROUND,
    percentile: float | None = None,
) -> NDArray[np.float32]:
    """Return `Scan.distance` for one scan, shape (), or for many, shape (N,).

    Args:
        ranges: metres, shape (R,) for one scan or (N, R) for many.
        like: a scan with the same limits and angles.
        sector: as in `Scan.distance`.
        percentile: as in `Scan.distance`.
    """
    if percentile is not None and not 0 <= number("percentile", percentile) <= 100:
        raise ValueError(f"percentile: expected a number from 0 to 100, got {percentile!r}")
    if sector is not ALL_ROUND:
        ranges = ranges[..., inside(like, sector)]
    away = ray_distances(ranges, like)
    least = np.asarray(np.fmin.reduce(away, axis=-1, initial=np.nan))
    if percentile is None or not away.size:
        return least
    # If something was measured, a code counts as nothing in range. NaN is sorted to the end.
    away = np.sort(np.where(np.isnan(away) & ~np.isnan(ranges), np.float32(np.inf), away))
    last = np.maximum((~np.isnan(away)).sum(axis=-1, keepdims=True) - 1, 0)
    picked = np.take_along_axis(away, (percentile / 100 * last).astype(int), axis=-1)[..., 0]
    return np.where(np.isnan(least), least, picked)


def ray_distances(ranges: NDArray[np.float32], like: ScanRays) -> NDArray[np.float32]:
    """Return the distance of each ray as in `Scan.distance`, in a new array of the same shape; NaN for a code.

    Args:
        ranges: metres, shape (R,) for one scan or (N, R) for many.
        like: a scan with the same limits.
    """
    away = np.where(ranges > like.range_max, np.float32(np.inf), ranges)
    below = ranges < like.range_min
    if below.any():
        away[below] = 0
        away[below & (ranges < CODES_END) & (ranges > -np.inf)] = np.nan
    return away


def difference(now: ScanRays, then: ScanRays) -> NDArray[np.float32]:
    """Return ``now - then`` as `Scan.__sub__` does."""
    here, there = ray_distances(now.ranges, now), ray_distances(then.ranges, then)
    if len(now) != len(then) or not np.allclose(now.angles, then.angles, rtol=0, atol=ANGLE_ROUNDING):
        found = indices_at(then, now.angles)
        # The index is -1 if no ray points there: it picks the appended NaN.
        there = np.append(there, np.float32(np.nan))[found]
    with np.errstate(invalid="ignore"):
        return np.where(here == there, np.float32(0), here - there).astype(np.float32)


def indices_at(like: ScanRays, angles: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the index of the ray closest to each angle in radians, or -1 more than half a step outside the sweep."""
    step = abs(like.angle_increment) or 2 * pi
    turned = (angles - like.angle_min) * (-1 if like.angle_increment < 0 else 1) % (2 * pi)
    index = np.rint(turned / step)
    to_first = 2 * pi - turned
    is_ray = (index < len(like)) & (np.abs(turned - index * step) <= to_first)
    return np.where(is_ray, index, np.where((to_first <= step / 2) & (len(like) > 0), 0, -1)).astype(np.intp)


def angles_of(angle_min: float, angle_increment: float, count: int) -> NDArray[np.float64]:
    """Return the angle of each ray in radians, shape (R,), read-only."""
    return frozen(angle_min + np.arange(count) * angle_increment)


def inside(like: ScanRays, sector: SectorLike) -> NDArray[np.bool_]:
    """Return True for each ray in a sector, for scans with the same angles, shape (R,), read-only."""
    return _inside(like.angle_min, like.angle_increment, len(like), to_sector(sector))


@lru_cache(maxsize=100)
def _inside(angle_min: float, angle_increment: float, count: int, sector: Sector) -> NDArray[np.bool_]:
    return frozen(in_sector(angles_of(angle_min, angle_increment, count), sector))

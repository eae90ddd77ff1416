"""How far the readings of a ray scatter from scan to scan."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from .scan import Scan

LOW, HIGH = 0.05, 0.95


def spread(scans: Iterable[Scan]) -> NDArray[np.float32]:
    """How far the readings of each ray scatter over some scans: metres, shape (R,).

    Half of the way from the 5th percentile of its readings to the 95th, so that single wrong readings do not count:
    1.6 standard deviations of normal noise. Rays are told apart by index; what is no reading is left out. NaN where a
    ray has fewer than two readings.

    Args:
        scans: scans with the same number of rays.

    Raises:
        TypeError: something is no `Scan`. ValueError: there is none, or their numbers of rays differ.

    Examples:
        >>> scans = [Scan([2.0 + noise, 3.0], 0.0, 0.1, 0.1, 10.0) for noise in (0.0, 0.01, 0.02)]
        >>> spread(scans).round(4)
        array([0.009, 0.   ], dtype=float32)
    """
    given = list(scans)
    for one in given:
        if not isinstance(one, Scan):
            raise TypeError(f"spread: expected scans, got {type(one).__name__}; of a recording, scans[-50:].spread()")
    counts = sorted({len(one) for one in given})
    if len(counts) != 1:
        got = f"scans with {' and '.join(map(str, counts))}" if given else "none"
        raise ValueError(f"spread: expected scans with the same number of rays, got {got}")
    return spread_of(np.stack([readings(one.ranges, one) for one in given]))


def readings(ranges: NDArray[np.float32], like: Scan) -> NDArray[np.float32]:
    """The readings among ranges of any shape, of scans with the same limits; NaN for all others."""
    return np.where((like.range_min <= ranges) & (ranges <= like.range_max), ranges, np.float32(np.nan))


def spread_of(readings: NDArray[np.float32]) -> NDArray[np.float32]:
    """`spread` of readings, shape (N, R), with NaN for what is none: shape (R,). The page has the same rule."""
    found = np.sort(readings, axis=0).astype(np.float64)  # NaN comes last
    last = (~np.isnan(found)).sum(axis=0) - 1

    def percentile(share: float) -> NDArray[np.float64]:
        place = share * np.maximum(last, 0)
        below = place.astype(int)
        low, high = (np.take_along_axis(found, rows[None], axis=0)[0] for rows in (below, np.minimum(below + 1, last)))
        return np.asarray(low + (place - below) * (high - low))

    return np.where(last > 0, (percentile(HIGH) - percentile(LOW)) / 2, np.nan).astype(np.float32)

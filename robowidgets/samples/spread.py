"""The spread of the readings of a ray from scan to scan."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from .scan import Scan

LOW, HIGH = 0.05, 0.95


def spread(scans: Iterable[Scan]) -> NDArray[np.float32]:
    """Return the spread of the readings of each ray over some scans: metres, shape (R,).

    The spread is half the distance from the 5th percentile of the readings to the 95th, so that single wrong readings
    do not count: 1.6 standard deviations of normal noise. Rays are matched by index, and only readings count. The
    spread is NaN for a ray with fewer than two readings.

    Args:
        scans: scans with the same number of rays.

    Raises:
        TypeError: an item is not a `Scan`. ValueError: scans is empty, or their numbers of rays differ.

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
    """Return ranges of any shape, with NaN for ranges that are not readings of scans with these limits."""
    return np.where((like.range_min <= ranges) & (ranges <= like.range_max), ranges, np.float32(np.nan))


def spread_of(readings: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the spread of readings, shape (N, R), NaN without a reading: shape (R,). The page has the same rule."""
    found = np.sort(readings, axis=0).astype(np.float64)  # NaN comes last
    last = (~np.isnan(found)).sum(axis=0) - 1

    def percentile(share: float) -> NDArray[np.float64]:
        place = share * np.maximum(last, 0)
        below = place.astype(int)
        low, high = (np.take_along_axis(found, rows[None], axis=0)[0] for rows in (below, np.minimum(below + 1, last)))
        return np.asarray(low + (place - below) * (high - low))

    return np.where(last > 0, (percentile(HIGH) - percentile(LOW)) / 2, np.nan).astype(np.float32)

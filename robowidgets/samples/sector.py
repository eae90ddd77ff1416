"""A part of the circle round a scanner."""

from __future__ import annotations

from collections.abc import Iterable
from math import pi

import numpy as np
from numpy.typing import NDArray

from .numbers import ANGLE_ROUNDING, in_radians

Sector = tuple[float, float]
"""Two angles in radians: from the first counter-clockwise to the second."""


def to_sector(sector: Iterable[float]) -> Sector:
    """Two angles in radians.

    Raises:
        TypeError: it is no pair of numbers. ValueError: an angle is beyond a full turn either way, infinite or NaN.
    """
    try:
        start, end = sector
    except (TypeError, ValueError):
        raise TypeError(f"sector: expected two angles in radians, got {sector!r}") from None
    return in_radians("sector", start), in_radians("sector", end)


def in_sector(angles: NDArray[np.float64], sector: Sector) -> NDArray[np.bool_]:
    """Whether each of some angles in radians lies in a sector, its ends included."""
    start, end = sector
    sweep = end - start if end - start >= 2 * pi else (end - start) % (2 * pi)
    inside: NDArray[np.bool_] = (angles - start + ANGLE_ROUNDING) % (2 * pi) <= sweep + 2 * ANGLE_ROUNDING
    return inside

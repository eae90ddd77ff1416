"""A part of the circle round a scanner."""

from __future__ import annotations

from collections.abc import Iterable
from math import pi

import numpy as np
from numpy.typing import NDArray

from .checks import ANGLE_ROUNDING, in_radians

Sector = tuple[float, float]
"""Two angles in radians: from the first counter-clockwise to the second."""

Asked = tuple[float | str, float | str] | str
"""A sector as it is given: two angles, each in radians or as text like ``"20deg"``, or a name in `SECTORS`."""

SECTORS: dict[str, Sector] = {
    "front": (-pi / 4, pi / 4),
    "left": (pi / 4, 3 * pi / 4),
    "back": (3 * pi / 4, 5 * pi / 4),
    "right": (-3 * pi / 4, -pi / 4),
}
"""Quarters of the circle by name, centred on 0, 90, 180 and -90 degrees: together they leave no direction out."""


def to_sector(sector: Iterable[float | str] | str) -> Sector:
    """Two angles in radians, also of degrees as text (``"20deg"``), or of a name in `SECTORS`.

    Raises:
        TypeError: it is no pair of angles.
        ValueError: no such name, or an angle is beyond a full turn either way, infinite or NaN.
    """
    if isinstance(sector, str):
        if sector not in SECTORS:
            raise ValueError(f"sector: expected {', '.join(SECTORS)} or two angles in radians, got {sector!r}")
        return SECTORS[sector]
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

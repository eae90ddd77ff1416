"""One ray of a scan, and the class of its range (REP-117)."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

CODES_END = 0.0195
"""Metres. A range below it and below range_min is a code of the scanner, not a distance.

LDS-01, Neato and YDLIDAR send 0.0, Hokuyo 0.001 to 0.019. Half a millimetre less than 0.02, which rounds in float32.
"""


class Validity(IntEnum):
    """The class of a range (REP-117). Pictures, pop-ups and counts distinguish all five."""

    READING = 0
    TOO_CLOSE = 1
    NOTHING_IN_RANGE = 2
    NO_MEASUREMENT = 3
    OUTSIDE_LIMITS = 4


class Ray(NamedTuple):
    """One ray of a scan.

    ``index`` is the index in ``ranges``. ``range`` is in metres, as measured, the shortest decimal of its float32; it
    may be NaN or infinite. ``angle`` is in radians within ±pi, counter-clockwise from forward. ``x`` and ``y`` are in
    metres, or None without a reading. ``intensity`` is in device units, or None if the scanner sent none. ``source``
    is the number of its echo or of its point, or None if the scan was not made from echoes or a cloud.
    """

    index: int  # type: ignore[assignment]  # as ROS calls it; it hides tuple.index
    range: float
    angle: float
    x: float | None
    y: float | None
    intensity: float | None
    validity: Validity
    source: int | None = None

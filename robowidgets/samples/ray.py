"""One ray of a scan, and the class of its range (REP-117)."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

CODES_END = 0.0195
"""Metres: a range below it, and below range_min, is a code of the scanner's, not a distance.

LDS-01, Neato and YDLIDAR send 0.0, Hokuyo 0.001 to 0.019. Half a millimetre less than 0.02, which rounds to float32.
"""


class Validity(IntEnum):
    """The class of a range (REP-117). The five are kept apart everywhere: in pictures, pop-ups and counts."""

    READING = 0
    TOO_CLOSE = 1
    NOTHING_IN_RANGE = 2
    NO_MEASUREMENT = 3
    OUTSIDE_LIMITS = 4


class Ray(NamedTuple):
    """One ray of a scan.

    ``index`` is the index in ``ranges``; ``range`` is in metres, as measured, the shortest decimal of its float32 (it
    may be NaN or infinite); ``angle`` is in radians within ±pi, counter-clockwise from forward; ``x`` and ``y`` are in
    metres and None when there is no reading; ``intensity`` is in device units and None when the scanner sent none;
    ``source`` is the number of its echo, or of its point in the cloud, where the scan was made of these; else None.
    """

    index: int  # type: ignore[assignment]  # as ROS calls it; it hides tuple.index
    range: float
    angle: float
    x: float | None
    y: float | None
    intensity: float | None
    validity: Validity
    source: int | None = None

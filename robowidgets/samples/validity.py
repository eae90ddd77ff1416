"""The classes of a range (REP-117)."""

from __future__ import annotations

from enum import IntEnum

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

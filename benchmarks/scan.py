"""The scan of the benchmarks: 1040 rays over 270 degrees, with a number in them that the page can read back."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

BITS = 24
RAYS_PER_BIT = 43
RAY_COUNT = 1040
NEAR, FAR = 3.0, 5.0
"""The ranges of the rays of a bit in metres: near for 0, far for 1."""
NOISE = 0.02
"""The largest error of a range in metres, as with real scanners: less than half a dot."""

ANGLE_MIN = -3 * pi / 4
ANGLE_INCREMENT = 1.5 * pi / (RAY_COUNT - 1)
RANGE_MIN, RANGE_MAX = 0.1, 6.0

_ANGLES = ANGLE_MIN + ANGLE_INCREMENT * np.arange(RAY_COUNT)
COS, SIN = np.cos(_ANGLES).astype(np.float32), np.sin(_ANGLES).astype(np.float32)

# The rays of eight bits at a time, so that making a scan costs almost nothing compared with showing it.
_BYTES = [
    np.repeat(np.where([byte >> bit & 1 for bit in range(8)], FAR, NEAR), RAYS_PER_BIT).astype(np.float32)
    for byte in range(256)
]
_REST = np.full(RAY_COUNT - BITS * RAYS_PER_BIT, NEAR, np.float32)
_NOISE: NDArray[np.float32] = np.random.default_rng(1).uniform(-NOISE, NOISE, (251, RAY_COUNT)).astype(np.float32)


def encode(number: int) -> NDArray[np.float32]:
    """Return ranges in metres, shape (1040,), that encode a number below 2**24: bit `b` in rays from `43 * b` on."""
    said = np.concatenate((_BYTES[number & 255], _BYTES[number >> 8 & 255], _BYTES[number >> 16 & 255], _REST))
    return said + _NOISE[number % len(_NOISE)]


def points(ranges: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return x and y in metres, for libraries without support for lasers."""
    return ranges * COS, ranges * SIN

"""Codes: ranges as whole numbers. If several codes share a pixel, the lowest is shown."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Codes = NDArray[np.uint16]

TOO_CLOSE = 0

CLOSEST, FARTHEST = 1, 65_001
"""The codes of range_min and of the farthest possible reading; codes are linear in between."""

OUTSIDE_LIMITS, NO_MEASUREMENT, NOTHING_IN_RANGE = 65_532, 65_533, 65_534
NO_SCAN = 65_535

WITHOUT_READING = (TOO_CLOSE, NOTHING_IN_RANGE, NO_MEASUREMENT, OUTSIDE_LIMITS)
"""The codes of the classes of `Validity` from TOO_CLOSE on, in its order."""


def encode(ranges: NDArray[np.float32], range_min: float, far: float) -> Codes:
    """Return ranges in metres as codes of the same shape.

    If several rays share a pixel, the lowest code is shown: too close, the nearest reading, or without either the first
    of outside the limits, no measurement, nothing in range. So a coarse picture omits nothing near.

    Source: REP-117 for the classes.
    """
    low, high = np.float32(range_min), np.float32(far)
    reading = ranges >= low
    reading &= ranges <= high
    with np.errstate(invalid="ignore", over="ignore"):  # values that are not readings get their codes below
        scaled = ranges - low
        scaled *= np.float32((FARTHEST - CLOSEST) / (float(high) - float(low)))
        scaled += CLOSEST
        codes: Codes = scaled.astype(np.uint16)
    if not reading.all():
        np.copyto(codes, OUTSIDE_LIMITS, where=~reading)
        np.copyto(codes, NO_MEASUREMENT, where=np.isnan(ranges))
        np.copyto(codes, NOTHING_IN_RANGE, where=ranges == np.inf)
        np.copyto(codes, TOO_CLOSE, where=ranges == -np.inf)
    return codes


def fold(codes: Codes, count: int, axis: int = 0) -> Codes:
    """Return the lowest of each ``count`` codes along an axis; the last group may be smaller."""
    if axis == 0:
        while count % 2 == 0:  # halving is five times as fast as reduceat
            even = len(codes) // 2 * 2
            half = np.minimum(codes[0:even:2], codes[1:even:2])
            codes = half if even == len(codes) else np.concatenate((half, codes[even:]))
            count //= 2
    if count == 1 or codes.shape[axis] == 0:
        return codes
    folded: Codes = np.minimum.reduceat(codes, range(0, codes.shape[axis], count), axis=axis)
    return folded


def fold_median(codes: Codes, count: int, axis: int = 0) -> Codes:
    """Return the median of each ``count`` codes like `fold`; for an even number, the lower of the two in the middle."""
    if count == 1 or codes.shape[axis] == 0:
        return codes
    by_row = codes if axis == 0 else codes.T
    whole = len(by_row) // count * count
    groups = by_row[:whole].reshape(-1, count, by_row.shape[1])
    middle = (count - 1) // 2
    folded = [np.partition(groups, middle, axis=1)[:, middle]]
    if whole < len(by_row):
        rest = by_row[whole:]
        middle = (len(rest) - 1) // 2
        folded.append(np.partition(rest, middle, axis=0)[middle : middle + 1])
    joined = np.concatenate(folded)
    return joined if axis == 0 else np.ascontiguousarray(joined.T)

"""Packing float32 numbers, exact to the bit, so that deflate makes them small."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_IN_FLOAT32 = tuple(float(np.float32(step)) for step in (0.01, 0.001, 0.00025))
STEPS = (1.0, 0.01, 0.002, 0.001, 0.0005, 0.00025, 0.0001, 1 / 256, 1 / 512, 1 / 1024, 1 / 4096, *_IN_FLOAT32)
"""Steps of the numbers of scanners, in metres. The last ones come from drivers that multiply in float32."""

CLASSES = tuple(int(np.float32(value).view(np.uint32)) for value in (np.nan, np.inf, -np.inf, 0.0))
"""Bits of frequent values that are not multiples of a step: class 1, 2, 3, 4. Class 0 is a multiple of the step."""

OTHER = 5
"""The class of all other values, whose bits are listed."""

ESCAPE = 255
"""The byte for a difference that does not fit in a byte, and is listed instead."""

_LEAST = 0.9
"""The smallest share of finite values that must be multiples of the step."""

_SAMPLED = 4096
_MOST = 2**30


def pack_floats(values: NDArray[np.float32]) -> tuple[dict[str, Any], list[bytes]]:
    """Return facts and parts from which the page restores the numbers (js/export/floats.ts).

    Scanners measure in steps, such as millimetres, but float32 hides the pattern. The numbers of steps are whole, and
    change little from ray to ray. Values without a common step are sorted by bytes: first all lowest bytes, last all
    highest ones.

    Args:
        values: shape (N,).
    """
    bits = values.view(np.uint32)
    step = _step_of(values)
    if not step:
        return {"step": 0, "count": len(bits)}, [planes(bits)]
    whole = _multiples(values, step)
    classes = np.full(len(bits), OTHER, np.uint8)
    for number, known in enumerate(CLASSES, start=1):
        classes[bits == known] = number
    classes[(classes == OTHER) & _fits(values, whole, step)] = 0
    folded = folded_changes(whole[classes == 0]).astype(np.uint32)
    is_large = folded >= ESCAPE
    large, other = folded[is_large], bits[classes == OTHER]
    small = np.where(is_large, ESCAPE, folded).astype(np.uint8)
    facts = {"step": step, "count": len(bits), "small": len(small), "large": len(large), "other": len(other)}
    return facts, [classes.tobytes(), small.tobytes(), planes(large), planes(other)]


def folded_changes(whole: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the changes between whole numbers, starting from 0: 0, -1, 1, -2, 2 ... as 0, 1, 2, 3, 4 ..."""
    changes = np.diff(whole, prepend=0)
    return np.where(changes < 0, -2 * changes - 1, 2 * changes)


def planes(values: NDArray[Any]) -> bytes:
    """Return the bytes of the elements, or of the rows, of an array, sorted by position: all first bytes first."""
    if not len(values):
        return b""
    rows = np.ascontiguousarray(values).view(np.uint8).reshape(len(values), -1)
    return np.ascontiguousarray(rows.T).tobytes()


def _step_of(values: NDArray[np.float32]) -> float:
    """Return the first step for which nearly all finite values are multiples, or 0 without one."""
    some = values[np.isfinite(values)]
    some = some[:: max(1, len(some) // _SAMPLED)]
    if not len(some):
        return STEPS[0]
    return next((s for s in STEPS if np.mean(_fits(some, _multiples(some, s), s)) >= _LEAST), 0.0)


def _multiples(values: NDArray[np.float32], step: float) -> NDArray[np.int64]:
    with np.errstate(invalid="ignore"):
        counts = np.rint(values.astype(np.float64) / step)
    return np.where(np.abs(counts) < _MOST, counts, 0).astype(np.int64)


def _fits(values: NDArray[np.float32], whole: NDArray[np.int64], step: float) -> NDArray[np.bool_]:
    same: NDArray[np.bool_] = (whole * step).astype(np.float32).view(np.uint32) == values.view(np.uint32)
    return same

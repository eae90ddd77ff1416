"""A line of a plot: a growing series of numbers over time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..samples.checks import is_masked

MOST_VALUES = 4_000_000
"""Values that a line keeps: an hour at 1 kHz. If there are more, the oldest quarter is dropped."""

_FIRST_ROOM = 256

Floats = NDArray[np.float64]


class GrowingLine:
    """Numbers over time in seconds, in order of time. The widget holds its lock during each call.

    NaN is a gap. It also replaces infinities.
    """

    def __init__(self, times: Floats | None = None, values: Floats | None = None) -> None:
        self._times = np.empty(0) if times is None else times
        self._values = np.empty(0) if values is None else values
        self._count = len(self._times)

    @property
    def times(self) -> Floats:
        """Times, shape (N,). The numbers in this array do not change while the line grows."""
        return self._times[: self._count]

    @property
    def values(self) -> Floats:
        """Values, shape (N,). They do not change while the line grows."""
        return self._values[: self._count]

    def append(self, time: float, value: float) -> None:
        """Add a value that is not earlier than the last one."""
        if self._count == len(self._times):
            first = self._count // 4 if self._count >= MOST_VALUES else 0
            room = max(_FIRST_ROOM, min(2 * self._count, MOST_VALUES))
            # New arrays, because another thread may be reading the old ones.
            self._times, self._values = (_moved(array[first:], room) for array in (self._times, self._values))
            self._count -= first
        self._times[self._count], self._values[self._count] = time, value
        self._count += 1


def _moved(array: Floats, room: int) -> Floats:
    larger = np.empty(room)
    larger[: len(array)] = array
    return larger


def checked(name: str, seconds: ArrayLike, values: ArrayLike) -> tuple[Floats, Floats]:
    """Return times and values of a line as float64, with NaN for values that are not finite.

    Raises:
        TypeError: not numbers. ValueError: shapes that do not fit, or times that go back.
    """
    times, numbers = _numbers(f"{name}: seconds", seconds), _numbers(f"{name}: values", values)
    if times.shape != numbers.shape:
        raise ValueError(f"{name}: expected a time for each value, got {len(times):,} and {len(numbers):,}")
    bad = np.flatnonzero(~(np.isfinite(times) & (times >= 0)))
    if bad.size:
        raise ValueError(f"{name}: expected seconds from 0 on, got {times[bad[0]]!r} at index {bad[0]}")
    back = np.flatnonzero(np.diff(times) < 0)
    if back.size:
        at = int(back[0]) + 1
        raise ValueError(
            f"{name}: expected times in order, but index {at} is {times[at]:g} s, after {times[at - 1]:g} s; "
            "sort them first"
        )
    return times, np.where(np.isfinite(numbers), numbers, np.nan)


def _numbers(what: str, given: ArrayLike) -> Floats:
    array: Any = np.asanyarray(given)
    if array.dtype.kind not in "iufb":
        raise TypeError(f"{what}: expected an array of numbers, got {array.dtype}")
    if array.ndim != 1:
        raise ValueError(f"{what}: expected an array of one dimension, got shape {array.shape}")
    numbers = array.astype(np.float64)
    if is_masked(numbers):
        return np.asarray(numbers.filled(np.nan))
    return np.asarray(numbers)


def slope(times: Floats, values: Floats) -> Floats:
    """Return the change per second up to each value; NaN for the first one, or if no time has passed."""
    steps = np.diff(times, prepend=np.nan)
    changes = np.diff(values, prepend=np.nan)
    slopes: Floats = np.divide(changes, steps, out=np.full(len(times), np.nan), where=steps > 0)
    return slopes


def held(times: Floats, values: Floats, at: Floats) -> Floats:
    """Return the last value up to each of some times; NaN before the first, and for a time of NaN."""
    rows = np.searchsorted(times, at, "right") - 1
    is_known = np.isfinite(at) & (rows >= 0)
    found: Floats = np.where(is_known, values[np.where(is_known, rows, 0)] if len(values) else np.nan, np.nan)
    return found

"""Steps in time: the value of a condition (true, false or unknown) from each time on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

NO, UNKNOWN, YES = 0, 1, 2
"""The order makes "and" the minimum, "or" the maximum, and "not" ``YES - value``."""


class Steps(NamedTuple):
    """The value of a condition from each time until the next: ``NO``, ``UNKNOWN`` or ``YES``.

    ``times``: nanoseconds, shape (N,), ascending; before the first it is unknown. ``values``: shape (N,).
    Several values at one time all apply at that moment, and the last of them from then on.
    """

    times: NDArray[np.int64]
    values: NDArray[np.int8]

    def at(self, times: NDArray[np.int64]) -> NDArray[np.int8]:
        """Return the values from some times on."""
        known = np.concatenate((np.array([UNKNOWN], np.int8), self.values))
        return known[np.searchsorted(self.times, times, side="right")]

    def during(self, times: NDArray[np.int64], which: np.ufunc) -> NDArray[np.int8]:
        """Return the least (`np.minimum`) or greatest (`np.maximum`) value at moments that include `times`."""
        values = self.at(times)
        if len(self.times):
            own, first = np.unique(self.times, return_index=True)
            values[np.searchsorted(times, own)] = which.reduceat(self.values, first)
        return values


def steps(times: ArrayLike, values: ArrayLike) -> Steps:
    """Return steps from sequences of times, ascending, and values."""
    return Steps(np.asarray(times, np.int64), np.asarray(values, np.int8))


def known_ns(part: Steps, end_ns: int) -> int:
    """Return the nanoseconds until ``end_ns`` in which a condition is true or false, and not unknown."""
    edges = np.minimum(np.append(part.times, end_ns), end_ns)
    return int(np.diff(edges)[part.values != UNKNOWN].sum())


def combined(parts: Sequence[Steps], how: Callable[..., Any]) -> Steps:
    """Join several steps into one, with all their times.

    If parts have several values at one time, their order across parts is unknown. So the result has the least and
    the greatest possible value at that time, and then the value from there on.
    """
    times = np.unique(np.concatenate([part.times for part in parts]))
    after = how([part.at(times) for part in parts], axis=0)
    if all(np.all(part.times[1:] > part.times[:-1]) for part in parts):
        return Steps(times, after)
    least, most = (how([part.during(times, which) for part in parts], axis=0) for which in (np.minimum, np.maximum))
    return Steps(np.repeat(times, 3), np.stack((least, most, after), axis=1).ravel())


def inverted(part: Steps) -> Steps:
    """Return the opposite of the steps."""
    return Steps(part.times, (YES - part.values).astype(np.int8))


def spans(part: Steps, end_ns: int) -> list[tuple[int, int]]:
    """Return the spans (start, end) in which a condition is true; the last value lasts until ``end_ns``.

    A span starts and ends at the same time if the condition is true only at that moment.
    """
    moments = np.unique(part.times)
    times = np.repeat(moments, 2)
    values = np.stack((part.during(moments, np.maximum), part.at(moments)), axis=1).ravel()
    yes = np.concatenate(([False], values == YES, [False])).astype(np.int8)
    first, after = np.flatnonzero(np.diff(yes) == 1), np.flatnonzero(np.diff(yes) == -1)
    edges = np.append(times, max(end_ns, int(times[-1])) if len(times) else end_ns)
    return [(int(edges[a]), int(edges[b])) for a, b in zip(first, after, strict=True)]

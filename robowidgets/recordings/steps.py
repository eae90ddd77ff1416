"""Whether something holds, over time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

NO, UNKNOWN, YES = 0, 1, 2
"""In this order, so that "and" is the least of two, "or" the greatest, and "not" the distance from the other end."""


class Steps(NamedTuple):
    """From each time on, until the next, whether something holds: ``NO``, ``UNKNOWN`` or ``YES``.

    ``times``: nanoseconds, shape (N,), ascending; before the first it is unknown. ``values``: shape (N,).
    """

    times: NDArray[np.int64]
    values: NDArray[np.int8]

    def at(self, times: NDArray[np.int64]) -> NDArray[np.int8]:
        """What holds at some times."""
        known = np.concatenate((np.array([UNKNOWN], np.int8), self.values))
        return known[np.searchsorted(self.times, times, side="right")]


def steps(times: ArrayLike, values: ArrayLike) -> Steps:
    """Steps from times in the order of arrival: one that goes back counts as the latest before it."""
    held = np.asarray(times, np.int64)
    return Steps(np.maximum.accumulate(held) if held.size else held, np.asarray(values, np.int8))


def combined(parts: Sequence[Steps], how: Callable[..., Any]) -> Steps:
    """Steps of several, at every time of any of them."""
    times = np.unique(np.concatenate([part.times for part in parts]))
    return Steps(times, how([part.at(times) for part in parts], axis=0))


def inverted(part: Steps) -> Steps:
    """What holds where this does not."""
    return Steps(part.times, (YES - part.values).astype(np.int8))


def spans(part: Steps, end_ns: int) -> list[tuple[int, int]]:
    """From when to when it holds; what holds at the last time goes on to ``end_ns``."""
    times = np.append(part.times, end_ns)
    # Of several values at one time the last counts.
    last = np.append(part.times[1:] != part.times[:-1], True)[: len(part.values)]
    starts, values = part.times[last], part.values[last]
    yes = np.concatenate(([False], values == YES, [False])).astype(np.int8)
    first, after = np.flatnonzero(np.diff(yes) == 1), np.flatnonzero(np.diff(yes) == -1)
    edges = np.append(starts, max(end_ns, int(times[-1])))
    return [(int(edges[a]), int(edges[b])) for a, b in zip(first, after, strict=True)]

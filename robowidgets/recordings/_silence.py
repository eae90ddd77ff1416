"""How long a topic may be silent until what it said last is old."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ..find._steps import UNKNOWN, Steps

_SHORTEST = 2_000_000_000


def usual_step(times_ns: NDArray[np.int64]) -> int:
    """Nanoseconds from one time to the next one that is later, the median; 0 where there is none."""
    ahead = np.diff(times_ns)
    ahead = ahead[ahead > 0]
    return round(float(np.median(ahead))) if ahead.size else 0


def longest_pause(usual: int) -> int:
    """Nanoseconds after which a topic with this usual step is silent."""
    return max(_SHORTEST, 2 * usual)


def until_old(held: Steps, topics: Iterable[tuple[NDArray[np.int64], NDArray[np.bool_]]], end_ns: int) -> Steps:
    """Steps that are unknown where they tell of a sample that is old.

    Where a topic is silent, what is known of it ends a usual step after its last sample; where there is no usual step,
    with that sample.

    Args:
        held: what was found at the samples.
        topics: of each topic the times of its samples, ascending, and which of the steps depend on them, shape (N,).
        end_ns: the end of the recording, before which the last sample may be old too.
    """
    values = held.values.copy()
    places, ends = [np.empty(0, np.intp)], [np.empty(0, np.int64)]
    for times, depends in topics:
        usual = usual_step(times)
        silent = np.flatnonzero(np.append(times[1:], end_ns) - times > longest_pause(usual))
        old = times[silent] + usual
        first = np.searchsorted(held.times, old, side="left" if usual else "right")
        last = np.append(np.searchsorted(held.times, times[1:]), len(held.times))[silent]
        for start, stop in zip(first, last, strict=True):
            values[start:stop][depends[start:stop]] = UNKNOWN
        known = depends[first - 1]
        places.append(first[known])
        ends.append(old[known])
    place, end = np.concatenate(places), np.concatenate(ends)
    order = np.argsort(end, kind="stable")
    return Steps(np.insert(held.times, place[order], end[order]), np.insert(values, place[order], UNKNOWN))

"""Stale samples: the last ones before a silence of their topic, for which conditions are unknown."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ...samples.staleness import RECORDED, usual_step
from ._steps import UNKNOWN, Steps


def mark_stale(result: Steps, topics: Iterable[tuple[NDArray[np.int64], NDArray[np.bool_]]], end_ns: int) -> Steps:
    """Return the steps, with UNKNOWN wherever they depend on a stale sample.

    The last sample before a silence is stale one usual step after its time, or at once without a usual step.

    Args:
        result: N steps, found at the samples.
        topics: for each topic the times of its samples, ascending, and True for each step that depends on them, shape
            (N,).
        end_ns: the end of the recording; the last sample may be stale before it, too.
    """
    values = result.values.copy()
    places, ends = [np.empty(0, np.intp)], [np.empty(0, np.int64)]
    for times, rests_on in topics:
        usual = round(usual_step(times))
        silent = np.flatnonzero(np.append(times[1:], end_ns) - times > RECORDED.after(usual, 1e9))
        stale_from = times[silent] + usual
        first = np.searchsorted(result.times, stale_from, side="left" if usual else "right")
        last = np.append(np.searchsorted(result.times, times[1:]), len(result.times))[silent]
        for start, stop in zip(first, last, strict=True):
            values[start:stop][rests_on[start:stop]] = UNKNOWN
        known = rests_on[first - 1]
        places.append(first[known])
        ends.append(stale_from[known])
    place, end = np.concatenate(places), np.concatenate(ends)
    order = np.argsort(end, kind="stable")
    return Steps(np.insert(result.times, place[order], end[order]), np.insert(values, place[order], UNKNOWN))

"""How evenly the samples of a topic follow each other: jitter, lost samples, pauses, a rate that falls."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..samples.staleness import PAUSE

_LEAST = 20
"""Samples that a judgement needs at least."""

_STEADY, _SHARE = 0.1, 0.75
"""A topic is steady if this share of its steps differs from the usual one by no more than this part of it."""

_WINDOW = 20
"""Steps over which the rate is measured."""


class Timing(NamedTuple):
    """How evenly the samples of a topic follow each other; times in seconds.

    ``step``: the usual (median) time from one sample to the next. ``jitter``: how far from it 19 of 20 steps stay at
    most. ``lost``: the number of samples that are missing between others. ``pauses`` and ``slow``: start and length of
    each time without samples, and of each at less than half the usual rate.

    All are None or empty with fewer than twenty samples. The last three are so where the steps differ, as in the log of
    a robot that measures when it can: nobody knows what is missing there.
    """

    step: float | None = None
    jitter: float | None = None
    lost: int | None = None
    pauses: tuple[tuple[float, float], ...] = ()
    slow: tuple[tuple[float, float], ...] = ()


def timing_of(times: NDArray[np.float64], seconds: NDArray[np.float64]) -> Timing:
    """The timing of samples that were taken at these times.

    Args:
        times: seconds by any clock, shape (N,), ascending.
        seconds: the same times as seconds from the start of the recording, in which starts are given, shape (N,).
    """
    steps = np.diff(times)
    step = float(np.median(steps)) if len(times) >= _LEAST else 0.0
    if step <= 0:
        return Timing()
    off = np.abs(steps - step)
    timing = Timing(step, float(np.percentile(off, 95)))
    if np.count_nonzero(off <= _STEADY * step) < _SHARE * len(steps):
        return timing
    is_pause = steps > PAUSE.after(step)
    missing = np.round(steps[~is_pause] / step) - 1
    return timing._replace(
        lost=int(missing[missing > 0].sum()),
        pauses=tuple((float(seconds[i]), float(steps[i])) for i in np.flatnonzero(is_pause)),
        slow=tuple((float(seconds[i]), float(times[j] - times[i])) for i, j in _slow(times, step, is_pause)),
    )


def _slow(times: NDArray[np.float64], step: float, is_pause: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last sample of each time at less than half the usual rate, pauses left out."""
    took = times[_WINDOW:] - times[:-_WINDOW]
    pauses = np.concatenate([[0], np.cumsum(is_pause)])
    is_slow = (took > 2 * step * _WINDOW) & (pauses[_WINDOW:] == pauses[:-_WINDOW])
    found: list[tuple[int, int]] = []
    for i in map(int, np.flatnonzero(is_slow)):
        if found and i <= found[-1][1]:
            found[-1] = (found[-1][0], i + _WINDOW)
        else:
            found.append((i, i + _WINDOW))
    return found

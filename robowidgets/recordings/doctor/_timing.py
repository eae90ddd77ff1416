"""The regularity of the samples of a topic: jitter, lost samples, pauses, falling rates."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...samples.staleness import PAUSE

_LEAST = 20
"""The minimum number of samples for a judgement."""

_STEADY, _SHARE = 0.1, 0.75
"""A topic is steady if this share of its steps differs from the usual step by this share of it at most."""

_LONG = 1.5
"""The share of the usual step above which a step is a part of a span below the usual rate."""

_WINDOW = 20
"""The number of steps over which the rate is measured, and a late sample may delay others."""

_SHORT = 0.75
"""The share of the usual step below which a sample follows one that was late."""


class Timing(NamedTuple):
    """The regularity of the samples of a topic; times in seconds.

    ``step``: the usual (median) time from one sample to the next. ``jitter``: the maximum deviation from it of 19 of 20
    steps. ``lost``: the number of missing samples between others. ``pauses`` and ``slow``: start and length of each
    span without samples, and of each span below half the usual rate.

    With fewer than twenty samples, no field is set. The last three are not set either if the steps vary, as in the log
    of a robot that measures at irregular times: the missing samples are unknown then.
    """

    step: float | None = None
    jitter: float | None = None
    lost: int | None = None
    pauses: tuple[tuple[float, float], ...] = ()
    slow: tuple[tuple[float, float], ...] = ()


def timing_of(times: NDArray[np.float64], seconds: NDArray[np.float64]) -> Timing:
    """Return the timing of samples that were taken at these times.

    Args:
        times: seconds by any clock, shape (N,), ascending.
        seconds: the same times in seconds from the start of the recording, for the starts of spans, shape (N,).
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
    return timing._replace(
        lost=_lost(times, step, is_pause),
        pauses=tuple((float(seconds[i]), float(steps[i])) for i in np.flatnonzero(is_pause)),
        slow=tuple((float(seconds[i]), float(times[j] - times[i])) for i, j in _slow(times, step, is_pause)),
    )


def _lost(times: NDArray[np.float64], step: float, is_pause: NDArray[np.bool_]) -> int:
    """Return the number of missing samples, without pauses.

    A late sample makes a long step and later a short one, without a loss: a long step counts by the samples that
    are still missing after each of the next short steps.
    """
    steps = np.diff(times)
    missing = np.round(steps / step) - 1
    starts = np.flatnonzero((missing > 0) & ~is_pause)
    missing = missing[starts]
    for count in range(2, _WINDOW + 1):
        ends = np.minimum(starts + count, len(steps))
        still = np.round((times[ends] - times[starts]) / step) - count
        caught_up = (ends == starts + count) & (steps[ends - 1] < _SHORT * step)
        missing = np.where(caught_up, np.minimum(missing, still), missing)
    return int(missing[missing > 0].sum())


def _slow(times: NDArray[np.float64], step: float, is_pause: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the first and the last sample of each span below half the usual rate, without pauses."""
    took = times[_WINDOW:] - times[:-_WINDOW]
    pauses = np.concatenate([[0], np.cumsum(is_pause)])
    is_slow = (took > 2 * step * _WINDOW) & (pauses[_WINDOW:] == pauses[:-_WINDOW])
    found: list[tuple[int, int]] = []
    for i in map(int, np.flatnonzero(is_slow)):
        if found and i <= found[-1][1]:
            found[-1] = (found[-1][0], i + _WINDOW)
        else:
            found.append((i, i + _WINDOW))
    # A window may begin before the first long step, and end after the last one.
    long = np.flatnonzero(np.diff(times) > _LONG * step)
    return [(int(long[np.searchsorted(long, i)]), int(long[np.searchsorted(long, j) - 1]) + 1) for i, j in found]

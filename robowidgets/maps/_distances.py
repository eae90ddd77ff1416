"""How far a way is from another, or from a plan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def to_polyline(places: Floats, line: Floats) -> Floats:
    """Metres from each of some places, shape (N, 2), to the nearest point of a line through others, shape (M, 2).

    Without a line NaN.
    """
    if not len(line):
        return np.full(len(places), np.nan)
    starts = line[:-1] if len(line) > 1 else line
    along = np.diff(line, axis=0) if len(line) > 1 else np.zeros((1, 2))
    squares = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    found = np.empty(len(places))
    for i, place in enumerate(places):
        away = place - starts
        share = ((away * along).sum(axis=1) / squares).clip(0.0, 1.0)
        found[i] = np.sqrt((((away - share[:, None] * along) ** 2).sum(axis=1)).min())
    return found


def to_plans(track: Floats, plans: Sequence[tuple[float, Floats]]) -> Floats:
    """Metres from each point of a way to the plan that was the newest then; NaN before the first.

    Args:
        track: seconds, x and y first in each row, shape (N, 3 or more).
        plans: the seconds of each plan, in order, and its places.
    """
    starts = np.array([seconds for seconds, _ in plans])
    newest = np.searchsorted(starts, track[:, 0], side="right") - 1
    found = np.full(len(track), np.nan)
    for i, (_, line) in enumerate(plans):
        rows = newest == i
        if rows.any():
            found[rows] = to_polyline(track[rows, 1:3], line)
    return found


def to_track(track: Floats, other: Floats) -> Floats:
    """Metres from each point of a way to where another was at that time; NaN before its start and after its end."""
    if not len(other):
        return np.full(len(track), np.nan)
    x, y = (np.interp(track[:, 0], other[:, 0], other[:, i], np.nan, np.nan) for i in (1, 2))
    return np.hypot(track[:, 1] - x, track[:, 2] - y)

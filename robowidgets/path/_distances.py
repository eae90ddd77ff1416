"""Distances between two tracks, and between a track and a plan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def to_polyline(places: Floats, line: Floats) -> Floats:
    """Return the metres from each place, shape (N, 2), to the nearest point of a polyline, shape (M, 2).

    Return NaN if the polyline is empty.
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
    """Return the metres from each point of a track to the newest plan at its time, or NaN before the first plan.

    Args:
        track: rows that begin with seconds, x and y, shape (N, 3 or more).
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
    """Return the metres from each point of a track to another at the same time; NaN before and after the latter."""
    if not len(other):
        return np.full(len(track), np.nan)
    x, y = (np.interp(track[:, 0], other[:, 0], other[:, i], np.nan, np.nan) for i in (1, 2))
    return np.hypot(track[:, 1] - x, track[:, 2] - y)

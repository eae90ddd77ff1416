"""The values of a line that a page needs: the first, last, least and greatest one of each column of pixels."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..samples.staleness import PLOT_GAP, usual_step
from .line import Floats

_EACH = 4
"""Values for each column: the first, last, least and greatest."""

_STEPS = 1000
"""The number of time steps from which the usual one is found."""


class ThinRows(NamedTuple):
    """Values of a line at their times, with sums of the values in between.

    ``counts`` and ``sums`` cover the finite values after the previous row, up to this row. A row of count -1 is a gap,
    not a value: after the value before, nothing came for a long time, and the line is interrupted.
    """

    times: Floats
    values: Floats
    counts: Floats
    sums: Floats


def thinned(times: Floats, values: Floats, start: float, end: float, columns: int) -> ThinRows:
    """Return the values that show a line in so many columns from one time to another, with a value beyond each end.

    Values are never invented: each is a value of the line at its time, and all extremes are kept. A line with up to
    four values for each column is kept whole.
    """
    low = max(0, int(np.searchsorted(times, start, "left")) - 1)
    high = min(len(times), int(np.searchsorted(times, end, "right")) + 1)
    kept = low + _kept(times[low:high], values[low:high], start, end, columns)
    if not kept.size:
        return ThinRows(*np.empty((4, 0)))
    part = values[kept[0] : kept[-1] + 1]
    finite = np.isfinite(part)
    firsts = np.concatenate(([0], kept[:-1] + 1 - kept[0]))
    counts = np.add.reduceat(finite.astype(np.float64), firsts)
    sums = np.add.reduceat(np.where(finite, part, 0.0), firsts)
    return _broken(times, kept, ThinRows(times[kept], values[kept], counts, sums))


def _kept(times: Floats, values: Floats, start: float, end: float, columns: int) -> NDArray[np.int64]:
    """Return the indices of the values that are shown, in order."""
    count = len(times)
    if count <= _EACH * columns:
        return np.arange(count)
    edges = np.unique(np.searchsorted(times, np.linspace(start, end, columns + 1)))
    edges = np.unique(np.concatenate(([0], edges, [count])))
    kept = []
    for first, stop in pairwise(edges.tolist()):
        kept += [first, stop - 1, *(first + at for at in _extremes(values[first:stop]))]
    return np.unique(kept)


def _extremes(values: Floats) -> tuple[int, ...]:
    """Return the indices of the least and the greatest value, and of the first gap, if any."""
    least = int(values.argmin())
    if not np.isnan(values[least]):
        return least, int(values.argmax())
    if np.isnan(values).all():
        return (least,)
    return least, int(np.nanargmin(values)), int(np.nanargmax(values))


def _broken(times: Floats, kept: NDArray[np.int64], rows: ThinRows) -> ThinRows:
    """Return the rows with a gap in the middle of each silence of the line. Rows at both ends of it are kept."""
    longest = PLOT_GAP.after(usual_step(times[-_STEPS:]))
    breaks = np.flatnonzero((np.diff(kept) == 1) & (np.diff(rows.times) > longest))
    if not breaks.size:
        return rows
    middle = (rows.times[breaks] + rows.times[breaks + 1]) / 2
    at = breaks + 1
    return ThinRows(
        np.insert(rows.times, at, middle),
        np.insert(rows.values, at, np.nan),
        np.insert(rows.counts, at, -1.0),
        np.insert(rows.sums, at, 0.0),
    )

"""What of a line a page needs: of each column of pixels the first, last, least and greatest value."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..samples.staleness import LIVE, usual_step
from .line import Floats

_EACH = 4
"""Values that a column needs: its first, last, least and greatest."""

_STEPS = 1000
"""Steps of time among which the usual one is found."""


class ThinRows(NamedTuple):
    """Values of a line at their own times, and what lies between them.

    ``counts`` and ``sums`` are of the finite values after the row before, up to this one. A row of count -1 is no
    value: after the value before nothing came for long, and the line ends there.
    """

    times: Floats
    values: Floats
    counts: Floats
    sums: Floats


def thinned(times: Floats, values: Floats, start: float, end: float, columns: int) -> ThinRows:
    """What shows a line in so many columns from one time to another, with a value beyond each end.

    Values are never made up: each is one of the line at its own time, and none of the extremes is missing. With up to
    four values for each column there are all of them.
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
    """Indices of the values that are shown, in order."""
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
    """Where the least and the greatest value are, and, if there is one, the first gap."""
    least = int(values.argmin())
    if not np.isnan(values[least]):
        return least, int(values.argmax())
    if np.isnan(values).all():
        return (least,)
    return least, int(np.nanargmin(values)), int(np.nanargmax(values))


def _broken(times: Floats, kept: NDArray[np.int64], rows: ThinRows) -> ThinRows:
    """The rows with one more in each silence of the line, of which both ends are kept."""
    longest = LIVE.after(usual_step(times[-_STEPS:]))
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

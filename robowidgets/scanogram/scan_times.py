"""The times of the scans of a scanogram, on an axis that only goes forward."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..samples.staleness import SCAN_GAP

_PAUSE = 0.1


class Thinned(NamedTuple):
    """The facts about a picture of scans from a few parts of a drive.

    ``lasts``: the number of the last scan of each part. ``pause``: the usual seconds from scan to scan. ``of``: the
    number of scans of the drive.
    """

    lasts: NDArray[np.int64]
    pause: float
    of: int


class ScanTimes:
    """Start and end of all scans in seconds: a scan ends where the next scan or a gap begins.

    ``pause`` is the median time from one scan to the next, ``gap`` is the longest pause that does not count as a gap. A
    time that goes back is replaced by the latest time before it, with a line in `notes`.

    Args:
        times_ns: shape (N,), in the order of arrival.
        start_ns: the time of 0 s.
        thinned: the scans if they are only some of the drive, or None.
    """

    def __init__(self, times_ns: NDArray[np.int64], start_ns: int, thinned: Thinned | None = None) -> None:
        self.starts = (np.maximum.accumulate(times_ns) - start_ns) / 1e9
        steps = np.diff(self.starts)
        follows = np.append(steps, np.inf)
        if thinned:
            follows[thinned.lasts] = np.inf
        moving = follows[(follows > 0) & np.isfinite(follows)]
        alone = thinned.pause if thinned else _PAUSE
        usual, long = moving.size // 2, moving.size * 9 // 10
        ordered = np.partition(moving, (usual, long)) if moving.size else moving
        self.pause = float(ordered[usual]) if moving.size else alone
        self.gap = SCAN_GAP.after(float(ordered[long]) if moving.size else alone)
        self.ends = self.starts + np.where(follows > self.gap, self.pause, follows)
        back = int((np.diff(times_ns) < 0).sum())
        self.notes = (f"the clock goes back {_times(back)}: shown in the order of arrival",) if back else ()
        if len(times_ns) > 1 and not (steps > 0).any() and not back:
            self.notes = (f"the clock stands still: all {len(times_ns)} scans have the same time",)

    def __len__(self) -> int:
        return len(self.starts)

    def between(self, start: float, end: float) -> tuple[int, int]:
        """Return the scans to show between two times in seconds: number of the first, and of the first after them."""
        first = int(np.searchsorted(self.ends, start, "right"))
        return first, max(first, int(np.searchsorted(self.starts, end, "left")))

    def cells(self, level: int, start: int, stop: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return start and end of the cells ``start`` to ``stop - 1`` of a level, in seconds."""
        size, count = 1 << level, len(self)
        firsts = np.arange(start, stop) * size
        return self.starts[firsts], self.ends[np.minimum(firsts + size, count) - 1]


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"

"""The levels of detail: the same scans in cells of 1, 2, 4, 8 and more scans."""

from __future__ import annotations

from math import gcd

import numpy as np
from numpy.typing import NDArray

from ._codes import FARTHEST, NO_SCAN, WITHOUT_READING, Codes, encode, fold
from .scans import Scans, Sweep

BUDGET = 256 << 20
"""Most bytes that all levels together take; finer levels are read again from the scans."""

FIRST = 3
"""The first level that is kept if there are many scans; finer ones are made when they are drawn."""

FEW = 16 << 20
"""Most bytes of all levels together for which level 0 is kept, too."""

COARSEST = 256
"""Most cells of the last level."""

_FAR = 0.01 * FARTHEST
"""Metres up to which neighbouring codes are at most a centimetre apart."""

_SAMPLED = 1 << 14
_BIN = 4
"""Bits by which a bin of the histogram is coarser than a code: a few thousand bins fit into the processor cache."""


class Levels:
    """Scans in cells of ``2 ** level`` scans each; a cell contains the least code of each ray.

    Args:
        scans: the scans; read once from start to end, and again for fine levels.
        sweep: their common geometry.
        budget: most bytes of all levels.

    ``counts``: the number of rays of each class of `Validity`. ``far``: the distance of the greatest code, which is
    range_max, or the farthest reading if codes up to range_max would be too far apart.
    """

    def __init__(self, scans: Scans, sweep: Sweep, budget: int = BUDGET) -> None:
        self.scans, self.sweep = scans, sweep
        self.far = sweep.range_max if sweep.range_max < _FAR else _farthest(scans, sweep)
        self.counts = np.zeros(1 + len(WITHOUT_READING), np.int64)
        self._histogram = np.zeros((FARTHEST >> _BIN) + 1, np.int64)
        count = len(scans.times_ns)
        self._first = 0 if 4 * sweep.ray_count * count <= min(FEW, budget) else FIRST
        while 4 * sweep.ray_count * (count >> self._first) > budget:
            self._first += 1
        self._kept: list[Codes] = [self._build()]
        while len(self._kept[-1]) > COARSEST:
            self._kept.append(fold(self._kept[-1], 2))

    @property
    def last(self) -> int:
        """The coarsest level."""
        return self._first + len(self._kept) - 1

    def codes(self, level: int, start: int, stop: int) -> Codes:
        """The codes of the cells ``start`` to ``stop - 1`` of a level: shape (stop - start, rays)."""
        if level >= self._first:
            return self._kept[level - self._first][start:stop]
        size = 1 << level
        return fold(self._encode(self.scans.read(start * size, stop * size)), size)

    @property
    def near_and_far(self) -> tuple[float, float]:
        """The distances in metres between which nearly all readings lie, for the scale of colours.

        From the nearest reading to the 99th percentile; range_min and `far` without a reading.
        """
        low, high = self.sweep.range_min, self.far
        counts = self._histogram
        if not counts.any():
            return low, high
        near = int(self._kept[-1].min())
        far = int(np.searchsorted(np.cumsum(counts), 0.99 * counts.sum()) + 1) << _BIN
        step = (high - low) / FARTHEST
        return low + near * step, min(high, low + max(far, near + 1) * step)

    def _build(self) -> Codes:
        """Make the first level that is kept, and count the codes meanwhile."""
        size = 1 << self._first
        cells = -(-len(self.scans.times_ns) // size)
        kept = np.full((cells, self.sweep.ray_count), NO_SCAN, np.uint16)
        every = _step(self.sweep.ray_count, cells * size)
        at = 0
        for ranges in self.scans.chunks():
            codes = self._encode(ranges)
            self._count(codes, every)
            ahead = min(-at % size, len(codes))
            if ahead:
                cell = at // size
                np.minimum(kept[cell], codes[:ahead].min(axis=0), out=kept[cell])
            if ahead < len(codes):
                folded = fold(codes[ahead:], size)
                first = (at + ahead) // size
                kept[first : first + len(folded)] = folded
            at += len(codes)
        return kept

    def _encode(self, ranges: NDArray[np.float32]) -> Codes:
        return encode(ranges, self.sweep.range_min, self.far)

    def _count(self, codes: Codes, every: int) -> None:
        without = [int(np.count_nonzero(codes == code)) for code in WITHOUT_READING]
        self.counts += [codes.size - sum(without), *without]
        binned = np.bincount(codes.ravel()[::every] >> _BIN, minlength=len(self._histogram))
        self._histogram += binned[: len(self._histogram)]


def _farthest(scans: Scans, sweep: Sweep) -> float:
    """The farthest reading in metres; a fixed distance beyond range_min without a reading."""
    far = sweep.range_min
    for ranges in scans.chunks():
        far = float(ranges.max(initial=far, where=ranges <= sweep.range_max))
    return far if far > sweep.range_min else sweep.range_min + _FAR


def _step(rays: int, scans: int) -> int:
    """A step for sampling the codes that visits all rays in turn."""
    step = max(1, rays * scans // _SAMPLED)
    while gcd(step, rays) > 1:
        step += 1
    return step

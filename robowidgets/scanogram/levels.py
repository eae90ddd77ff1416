"""The levels of detail: the same scans in cells of 1, 2, 4, 8 and more scans."""

from __future__ import annotations

from math import gcd

import numpy as np
from numpy.typing import NDArray

from ._codes import FARTHEST, NO_SCAN, WITHOUT_READING, Codes, encode, fold
from .scans import Scans, Sweep

BUDGET = 256 << 20
"""Bytes that all levels together may take. What is finer is read again from where it lies."""

FIRST = 3
"""The first level that is kept, where there are many scans. What is finer is made when it is looked at."""

FEW = 16 << 20
"""Bytes of all levels together that are kept from level 0 on."""

COARSEST = 256
"""Cells of the last level, at most."""

_FAR = 0.01 * FARTHEST
"""Metres up to which codes lie within a centimetre of each other."""

_SAMPLED = 1 << 14
_BIN = 4
"""Bits of a code by which a bin of the histogram is coarser: a few thousand bins stay in the processor's cache."""


class Levels:
    """Scans in cells of ``2 ** level`` scans each; a cell holds the least code of each ray.

    Args:
        scans: where they lie; read once from start to end, and again where it is looked at closely.
        sweep: what they share.
        budget: bytes.

    ``counts`` is how many rays there are of each class of `Validity`. ``far`` is the distance of the greatest code:
    range_max; where codes up to there would lie too far apart, the farthest reading.
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
        """The codes of the cells from one number up to, not including, another: shape (stop - start, rays)."""
        if level >= self._first:
            return self._kept[level - self._first][start:stop]
        size = 1 << level
        return fold(self._encode(self.scans.read(start * size, stop * size)), size)

    @property
    def near_and_far(self) -> tuple[float, float]:
        """The distances in metres between which nearly all readings lie, for a scale of colours.

        The nearest counts always; of the farthest, the last hundredth is left out. The limits where there is no
        reading.
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
        """The first level that is kept; on the way, everything is counted."""
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
    """The farthest reading in metres, where there is one beyond range_min."""
    far = sweep.range_min
    for ranges in scans.chunks():
        far = float(ranges.max(initial=far, where=ranges <= sweep.range_max))
    return far if far > sweep.range_min else sweep.range_min + _FAR


def _step(rays: int, scans: int) -> int:
    """From one code to the next of a sample of all: one that meets every ray in turn."""
    step = max(1, rays * scans // _SAMPLED)
    while gcd(step, rays) > 1:
        step += 1
    return step

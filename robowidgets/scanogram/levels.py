"""The levels of detail: the same scans in cells of 1, 2, 4, 8 and more scans."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from ._codes import CLOSEST, FARTHEST, WITHOUT_READING, Codes, encode, fold, fold_median
from .scans import ScanRanges, Sweep

BUDGET = 256 << 20
"""The maximum size of all levels together; finer levels are read again from the scans."""

FIRST = 3
"""The first level that is kept if there are many scans; finer levels are made when they are drawn."""

FEW = 16 << 20
"""The maximum size of all levels together for which level 0 is kept, too."""

COARSEST = 256
"""The maximum number of cells of the last level, by default."""

_BIN = 4
"""Bits by which a bin is coarser than a code when readings are counted by distance."""

_FAR = 0.01 * (FARTHEST - CLOSEST)
"""Metres up to which neighbouring codes are at most a centimetre apart."""

NEAREST, MEDIAN = "nearest", "median"
"""The code of each ray that a cell contains: the lowest, or the median; of many scans, the median of medians."""

_FOLDS: dict[str, Callable[..., Codes]] = {NEAREST: fold, MEDIAN: fold_median}


class Levels:
    """Scans in cells of ``2 ** level`` scans each; a cell contains one code for each ray.

    Args:
        scans: the scans, which are read once from start to end, and again for fine levels.
        sweep: their common geometry.
        budget: the maximum size of all levels in bytes.
        coarsest: the maximum number of cells of the last level.

    ``counts``: the number of rays of each class of `Validity`. ``far``: the distance of the highest code: range_max, or
    the farthest reading if codes up to range_max would be too coarse.
    """

    def __init__(self, scans: ScanRanges, sweep: Sweep, budget: int = BUDGET, coarsest: int = COARSEST) -> None:
        self.scans, self.sweep, self._coarsest = scans, sweep, coarsest
        self.far = sweep.range_max if sweep.range_max < _FAR else _farthest(scans, sweep)
        self.counts = np.zeros(1 + len(WITHOUT_READING), np.int64)
        self._readings = np.zeros(1 + (FARTHEST >> _BIN), np.int64)
        count = len(scans.times_ns)
        self._first = 0 if 4 * sweep.ray_count * count <= min(FEW, budget) else FIRST
        while 4 * sweep.ray_count * (count >> self._first) > budget:
            self._first += 1
        self._pixel, self._kept = "", list[Codes]()
        self._levels(NEAREST)

    @property
    def last(self) -> int:
        """The coarsest level."""
        return self._first + len(self._kept) - 1

    @property
    def color_range(self) -> tuple[float, float]:
        """The range in metres of the readings of all scans, without the nearest and the farthest hundredth."""
        below = np.cumsum(self._readings)
        if not below[-1]:
            return self.sweep.range_min, self.far
        low, high = np.searchsorted(below, (0.01 * below[-1], 0.99 * below[-1]))
        most = FARTHEST - CLOSEST
        step = (self.far - self.sweep.range_min) / most
        near, far = (int(low) << _BIN) - 0.5, min(most, (int(high) + 1) << _BIN) - 0.5
        return self.sweep.range_min + near * step, self.sweep.range_min + far * step

    def codes(self, level: int, start: int, stop: int, pixel: str = NEAREST) -> Codes:
        """Return the codes of the cells ``start`` to ``stop - 1`` of a level: shape (stop - start, rays)."""
        if level >= self._first:
            return self._levels(pixel)[level - self._first][start:stop]
        size = 1 << level
        return folded(self._encode(self.scans.read(start * size, stop * size)), size, pixel)

    def _levels(self, pixel: str) -> list[Codes]:
        """Return the levels that are kept, with nearest or median codes, whichever was requested last."""
        if pixel != self._pixel:
            count = -(-len(self.scans.times_ns) // (1 << self._first))
            first = np.empty((count, self.sweep.ray_count), np.uint16)
            at = 0
            for cells in self._cells(pixel):
                first[at : at + len(cells)] = cells
                at += len(cells)
            levels, size = [first], 1
            while len(levels[-1]) > self._coarsest:
                size *= 2
                # A median of medians of two is inaccurate: fold medians from the first level.
                levels.append(fold(levels[-1], 2) if pixel == NEAREST else folded(first, size, pixel))
            self._pixel, self._kept = pixel, levels
        return self._kept

    def _cells(self, pixel: str) -> Iterator[Codes]:
        """Yield the cells of the first level that is kept; the first time, this counts the codes."""
        size, counted = 1 << self._first, bool(self._pixel)
        rest = np.empty((0, self.sweep.ray_count), np.uint16)
        for ranges in self.scans.chunks():
            codes = self._encode(ranges)
            if not counted:
                self._count(codes)
            codes = np.concatenate((rest, codes)) if len(rest) else codes
            whole = len(codes) // size * size
            yield folded(codes[:whole], size, pixel)
            rest = codes[whole:]
        yield folded(rest, size, pixel)

    def _encode(self, ranges: NDArray[np.float32]) -> Codes:
        return encode(ranges, self.sweep.range_min, self.far)

    def _count(self, codes: Codes) -> None:
        without = [int(np.count_nonzero(codes == code)) for code in WITHOUT_READING]
        self.counts += [codes.size - sum(without), *without]
        beyond_closest = codes.ravel() - np.uint16(CLOSEST)  # TOO_CLOSE becomes the highest number, which has no bin
        bins = np.bincount(beyond_closest >> _BIN, minlength=len(self._readings))
        self._readings += bins[: len(self._readings)]


def folded(codes: Codes, count: int, pixel: str, axis: int = 0) -> Codes:
    """Return one code for each ``count`` along an axis: the lowest or the median."""
    return _FOLDS[pixel](codes, count, axis)


def _farthest(scans: ScanRanges, sweep: Sweep) -> float:
    """Return the farthest reading in metres, or a fixed distance beyond range_min without a reading."""
    far = sweep.range_min
    for ranges in scans.chunks():
        far = float(ranges.max(initial=far, where=ranges <= sweep.range_max))
    return far if far > sweep.range_min else sweep.range_min + _FAR

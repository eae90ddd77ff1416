"""Counts, means and quantiles of numbers that come in parts, in bounded memory, the same in any order of the parts."""

from __future__ import annotations

from math import floor, fsum, inf, isfinite, log, nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

EXACT = 100_000
"""The number of different values up to which quantiles are exact."""
ERROR = 0.001
"""The greatest relative error of a quantile of more different values."""
_LARGE = 2.0**900
"""The size of values whose sum may be too large for a number: they are added in parts, divided by `_PART`."""
_PART = 2.0**100
_GROWTH = (1 + ERROR) / (1 - ERROR)


class ValueCounts(NamedTuple):
    """Different finite numbers, ascending, and how many there are of each; both of shape (N,)."""

    values: NDArray[np.float64]
    counts: NDArray[np.int64]


class Tally:
    """Counts, mean, limits and quantiles of numbers.

    Up to `EXACT` different values are counted each. If there are more, each value is counted as the middle of a bin
    whose ends differ from it by at most `ERROR` of its size; a quantile lies between two values, and so differs by at
    most `ERROR` of the size of the greater one. The result does not depend on the order of the values. Memory is
    bounded: all numbers that exist fall into 1.5 million bins, and numbers from a millimetre to a kilometre into 7,000.
    """

    def __init__(self) -> None:
        self.unknown = self.inf = self.minus_inf = 0
        self.least, self.most = inf, -inf
        self.drives = 0
        self.is_exact = True
        self._sums: list[float] = []
        self._large: list[float] = []
        self._numbers = ValueCounts(np.empty(0), np.empty(0, np.int64))

    @property
    def count(self) -> int:
        """The number of finite values."""
        return int(self._numbers.counts.sum())

    @property
    def mean(self) -> float:
        """The mean of the finite values, NaN without any; the sum is rounded once for each drive."""
        if not self.count:
            return nan
        mean = fsum(self._sums) / self.count + fsum(self._large) / self.count * _PART
        return min(max(mean, self.least), self.most)

    def add(self, values: NDArray[np.float64]) -> None:
        """Add some values."""
        is_finite = np.isfinite(values)
        finite = values[is_finite]
        others = values[~is_finite]
        self.inf += int((others == inf).sum())
        self.minus_inf += int((others == -inf).sum())
        self.unknown += int(np.isnan(others).sum())
        if len(finite):
            self.least, self.most = min(self.least, float(finite.min())), max(self.most, float(finite.max()))
            is_large = np.abs(finite) > _LARGE
            self._sums = [fsum([*self._sums, float(finite[~is_large].sum())])]
            self._large = [fsum([*self._large, float((finite[is_large] / _PART).sum())])]
            self._put(ValueCounts(*np.unique(finite, return_counts=True)), is_exact=True)

    def merge(self, other: Tally) -> None:
        """Add the values of another one."""
        self.inf += other.inf
        self.minus_inf += other.minus_inf
        self.unknown += other.unknown
        self.drives += other.drives
        self.least, self.most = min(self.least, other.least), max(self.most, other.most)
        self._sums += other._sums
        self._large += other._large
        self._put(other._numbers, is_exact=other.is_exact)

    def quantile(self, part: float) -> float:
        """Return a quantile as `numpy.quantile` does, with its linear interpolation, or NaN without a value."""
        values, counts = self._numbers
        if not len(values) or part in (0, 1):
            return nan if not len(values) else self.most if part else self.least
        ends = np.cumsum(counts)
        place = part * (int(ends[-1]) - 1)
        low, high = (
            float(values[np.searchsorted(ends, rank, side="right")]) for rank in (int(place), -int(-place // 1))
        )
        share = place - floor(place)
        found = low + (high - low) * share if isfinite(high - low) else low * (1 - share) + high * share
        return min(max(found, self.least), self.most)

    def _put(self, more: ValueCounts, *, is_exact: bool) -> None:
        both = [self._numbers, more]
        if self.is_exact and is_exact:
            merged = _merged(both)
            if len(merged.values) <= EXACT:
                self._numbers = merged
                return
        self.is_exact = False
        self._numbers = _merged([ValueCounts(_binned(one.values), one.counts) for one in both])


def _merged(parts: list[ValueCounts]) -> ValueCounts:
    values = np.concatenate([part.values for part in parts])
    counts = np.concatenate([part.counts for part in parts])
    different, where = np.unique(values, return_inverse=True)
    return ValueCounts(different, np.bincount(where, counts, len(different)).astype(np.int64))


def _binned(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the middle of the bin of each value, which is its own middle; zero is a bin of its own."""
    sizes = np.abs(values)
    with np.errstate(divide="ignore", over="ignore"):
        bins = np.ceil(np.log(sizes) / log(_GROWTH))
        middles = np.minimum(np.exp(bins * log(_GROWTH)) * (2 / (_GROWTH + 1)), np.finfo(float).max)
    return np.where(sizes == 0, 0.0, np.copysign(middles, values))

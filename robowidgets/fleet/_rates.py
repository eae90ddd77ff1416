"""Rates of events, and the interval of their difference."""

from __future__ import annotations

from math import nan, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

_Z = 1.959964
"""The normal quantile of an interval of 95 %."""


class Rate(NamedTuple):
    """Events per hour, with the ends of its interval; all NaN without hours, and the ends with one drive."""

    per_hour: float
    low: float
    high: float


class Exposure(NamedTuple):
    """The number of events in each of some drives, and its hours; both of shape (N,)."""

    counts: NDArray[np.int64]
    hours: NDArray[np.float64]


def rates_of(one: Exposure, other: Exposure) -> tuple[Rate, Rate, Rate, tuple[float, float]]:
    """Return the rates of two sets of drives, their difference (the second minus the first), and the spreads.

    Each rate has Byar's interval of 95 % for a Poisson rate, and the difference the interval by MOVER (Zou and Donner
    2008), which joins these two. Events that come in bursts make drives differ more than a Poisson rate allows: the
    spread of a set is Pearson's chi-squared by its degrees of freedom, of its drives or of the drives of both sets, the
    greater one, and at least 1. Then each count weighs so much less (quasi-Poisson). The spread of one drive is NaN,
    and so are the ends of its interval.

    In simulations, the interval contains the difference in 92 to 99 % of cases from ten drives a set on, if the sets
    are alike in size and bursts; and in 85 to 99 % with two or three drives, or if ten drives with bursts are compared
    with hundreds.
    """
    chi = _chi_squared(one), _chi_squared(other)
    freedom = [max(0, int((part.hours > 0).sum()) - 1) for part in (one, other)]
    pooled = sum(chi) / max(1, sum(freedom))
    spreads = [max(1.0, pooled, own / free) if free else nan for own, free in zip(chi, freedom, strict=True)]
    first, second = _rate(one, spreads[0]), _rate(other, spreads[1])
    difference = second.per_hour - first.per_hour
    low = sqrt((second.per_hour - second.low) ** 2 + (first.high - first.per_hour) ** 2)
    high = sqrt((second.high - second.per_hour) ** 2 + (first.per_hour - first.low) ** 2)
    return first, second, Rate(difference, difference - low, difference + high), (spreads[0], spreads[1])


def _chi_squared(part: Exposure) -> float:
    hours = part.hours.sum()
    expected = part.hours * (part.counts.sum() / hours) if hours else part.hours
    is_expected = expected > 0
    return float((((part.counts - expected)[is_expected]) ** 2 / expected[is_expected]).sum())


def _rate(part: Exposure, spread: float) -> Rate:
    hours = float(part.hours.sum())
    if not hours:
        return Rate(np.nan, np.nan, np.nan)
    count = int(part.counts.sum())
    fewer = count / spread
    low = fewer * max(0.0, 1 - 1 / (9 * fewer) - _Z / (3 * sqrt(fewer))) ** 3 if count else 0.0
    high = (fewer + 1) * (1 - 1 / (9 * (fewer + 1)) + _Z / (3 * sqrt(fewer + 1))) ** 3
    return Rate(count / hours, low * spread / hours, high * spread / hours)

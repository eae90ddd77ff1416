"""Times that only go forward, without leaps, from a clock that did not: the one rule for all recordings."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import NamedTuple, TypeVar

import numpy as np

RESET = 10.0
"""Seconds that a clock may go back until it counts as set back for good."""
LEAP = 30 * 86_400.0
"""Seconds between two messages, of whatever topics, that are no silence: the clock was set ahead."""
REAL_FROM = 631_152_000.0
"""1990 in seconds since the epoch: a clock before that was never set, or counts from somewhere else, as in a
simulation."""

Time = TypeVar("Time", int, float)


class Oddities(NamedTuple):
    """What was odd about a clock.

    Seconds that it was behind at most, how often it leapt ahead, by how many seconds at most; and the first of the
    times that were made of it, in seconds since the epoch.
    """

    behind: float
    leaps: int
    ahead: float
    start: float


def hold(times: Sequence[Time], second: int) -> tuple[list[Time], Oddities]:
    """Times that never go back and never leap, in the same order, and what was odd.

    A clock that goes back is held until it has caught up; one that was set back, by more than `RESET` seconds and for
    good, goes on from where it was, and so does one that leaps ahead by more than `LEAP`. Where it does, times have the
    date that it told first from 1990 on; without such a leap, or such a date, that of the first.

    Args:
        times: by the clock, in the order of arrival; NaN where there is none.
        second: what a second is in them.
    """
    result: list[Time] = []
    latest: Time = next((time for time in times if isfinite(time)), 0)
    shift: Time = 0
    furthest: Time = 0
    widest: Time = 0
    leaps = 0
    reset, leap = RESET * second, LEAP * second
    for i, time in enumerate(times):
        now = time + shift
        if not now >= latest:
            behind = latest - now
            furthest = max(furthest, behind) if isfinite(behind) else furthest
            if behind > reset and _goes_on(times[i : i + 2], reset):
                shift += behind
            now = latest
        elif now - latest > leap:
            leaps += 1
            widest = max(widest, now - latest)
            shift -= now - latest
            now = latest
        latest = now
        result.append(now)
    if leaps:
        moved = next((time - result[i] for i, time in enumerate(times) if time >= REAL_FROM * second), 0)
        result = [time + moved for time in result]
    return result, Oddities(furthest / second, leaps, widest / second, result[0] / second if result else 0.0)


def about_set(back: int, odd: Oddities) -> str:
    """What is said of a clock that went back so often; empty where it did not, and leapt nowhere."""
    lines = []
    if back:
        lines.append(f"goes back {often(back)}, by up to {odd.behind:.2f} s: order is kept, time held meanwhile")
    if odd.leaps:
        by = f"{'up to ' * (odd.leaps > 1)}{odd.ahead / 86_400:,.1f} days"
        date = np.datetime64(int(odd.start), "s").astype("datetime64[D]")
        lines.append(f"jumps ahead {often(odd.leaps)}, by {by}: time goes on from where it was, dated {date}")
    return f"the clock {'; it '.join(lines)}" if lines else ""


def often(count: int) -> str:
    """How often, for a person."""
    return "once" if count == 1 else f"{count:,} times"


def _goes_on(pair: Sequence[float], reset: float) -> bool:
    return len(pair) == 2 and 0 <= pair[1] - pair[0] < reset

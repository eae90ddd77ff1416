"""Times that only go forward, from a clock that did not: the one rule for all recordings."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import TypeVar

RESET = 10.0
"""Seconds that a clock may go back until it counts as set back for good."""

Time = TypeVar("Time", int, float)


def hold(times: Sequence[Time], second: int) -> tuple[list[Time], Time]:
    """Times that never go back, in the same order, and by how much the clock was behind at most.

    A clock that goes back is held until it has caught up; one that was set back, by more than `RESET` seconds and for
    good, goes on from where it was.

    Args:
        times: by the clock, in the order of arrival; NaN where there is none.
        second: what a second is in them.
    """
    result: list[Time] = []
    latest: Time = next((time for time in times if isfinite(time)), 0)
    shift: Time = 0
    furthest: Time = 0
    reset = RESET * second
    for i, time in enumerate(times):
        now = time + shift
        if not now >= latest:
            behind = latest - now
            furthest = max(furthest, behind) if isfinite(behind) else furthest
            if behind > reset and _goes_on(times[i : i + 2], reset):
                shift += behind
            now = latest
        latest = now
        result.append(now)
    return result, furthest


def about_held(back: int, seconds: float) -> str:
    """What is said of a clock that went back so often, and was behind by so much at most."""
    return f"the clock goes back {often(back)}, by up to {seconds:.2f} s: order is kept, time held meanwhile"


def often(count: int) -> str:
    """How often, for a person."""
    return "once" if count == 1 else f"{count:,} times"


def _goes_on(pair: Sequence[float], reset: float) -> bool:
    return len(pair) == 2 and 0 <= pair[1] - pair[0] < reset

"""Times that only go forward, from logs whose clocks did not."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

RESET = 10.0
STILL = 0.1


def steady(times: Sequence[float]) -> tuple[list[int], bool, str]:
    """Nanoseconds that never go back, whether they are the clock's, and a line about what was wrong with it.

    Order is kept. A clock that goes back is held until it has caught up; one that was set back, by more than `RESET`
    seconds and for good, goes on from where it was. One that hardly moves (fewer than one different time in ten) is of
    no use: its lines are set `STILL` seconds apart.

    Args:
        times: seconds, in the order of the lines; NaN where a line has none.
    """
    if len(times) > 1 and 10 * len(set(times)) < len(times):
        different = len(set(times))
        line = (
            f"the clock stood still ({different} different time{'s' * (different > 1)} in {len(times):,} lines): "
            f"the lines are set {STILL:g} s apart, in their order"
        )
        return [round(i * STILL * 1e9) for i in range(len(times))], False, line
    result: list[int] = []
    latest = next((t for t in times if isfinite(t)), 0.0)
    shift = furthest = 0.0
    back = 0
    for i, time in enumerate(times):
        now = time + shift
        back += i > 0 and not time >= times[i - 1]
        if not now >= latest:
            furthest = max(furthest, latest - now) if isfinite(now) else furthest
            if latest - now > RESET and _goes_on(times[i : i + 2]):
                shift += latest - now
            now = latest
        latest = now
        result.append(round(now * 1e9))
    if not back:
        return result, True, ""
    times_back = "once" if back == 1 else f"{back:,} times"
    return (
        result,
        True,
        f"the clock goes back {times_back}, by up to {furthest:.2f} s: order is kept, time held meanwhile",
    )


def _goes_on(pair: Sequence[float]) -> bool:
    return len(pair) == 2 and 0 <= pair[1] - pair[0] < RESET

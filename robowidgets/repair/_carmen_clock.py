"""Times that only go forward, from logs whose clocks did not."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from ._held_clock import about_set, hold

STILL = 0.1


def steady(times: Sequence[float]) -> tuple[list[int], bool, str]:
    """Nanoseconds that never go back, whether they are the clock's, and a line about what was wrong with it.

    Order is kept, a clock that goes back is held, and one that leaps ahead goes on: see `hold`. One that hardly moves
    (fewer than one different time in ten) is of no use: its lines are set `STILL` seconds apart.

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
    held, odd = hold(times, 1)
    back = sum(not after >= before for before, after in pairwise(times))
    return [round(time * 1e9) for time in held], True, about_set(back, odd)

"""What is wrong with the clock behind the times of a topic."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .held_clock import often
from .one_clock import JITTER_NS

_STILL_SHARE = 0.5
_STILL_LEAST = 10
_JUMP = 60.0
_JUMP_STEPS = 100


def about_clock(times_ns: NDArray[np.int64], start_ns: int) -> tuple[str, ...]:
    """Lines about a clock that goes back, stands still or jumps ahead; nothing about one that does neither.

    One that goes back is mostly held when the file is opened. Here it still does where a topic has several senders or
    messages that came late; or, in an MCAP file so long that its index is not read, within a chunk.

    It stands still when every other message, and ten at least, bears the time of the one before. It jumps where nothing
    comes for a minute and for a hundred times the usual pause: what was recorded does not tell it from a long silence.

    Args:
        times_ns: nanoseconds, shape (N,), in the order of arrival.
        start_ns: start of the recording.
    """
    steps = np.diff(times_ns)
    if not steps.size:
        return ()
    lines = []
    back = np.flatnonzero(steps < -JITTER_NS)
    if back.size:
        at = (times_ns[back[0]] - start_ns) / 1e9
        lines.append(
            f"the clock goes back {often(back.size)}, first at {at:.2f} s, by up to {-steps.min() / 1e9:.2f} s: "
            "arrays keep the order of arrival, samples and players go by time"
        )
    still = int(np.count_nonzero(steps == 0))
    if still >= max(_STILL_SHARE * steps.size, _STILL_LEAST):
        lines.append(f"the clock stands still: {still:,} of {len(times_ns):,} samples bear the time of the one before")
    forward = steps[steps > 0]
    usual = float(np.median(forward)) if forward.size else 0.0
    jumps = np.flatnonzero(steps > max(_JUMP * 1e9, _JUMP_STEPS * usual))
    if jumps.size:
        at = (times_ns[jumps[0]] - start_ns) / 1e9
        lines.append(
            f"the clock jumps ahead {often(jumps.size)}, or nothing was recorded: first at {at:.2f} s, "
            f"by up to {steps.max() / 1e9:.2f} s"
        )
    return tuple(lines)

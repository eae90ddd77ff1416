"""Rules for stale samples: the times after which a topic, a kernel, a page or a robot counts as silent.

The rules of the page are in js/shared/staleness.ts. `tests/vectors.py` checks that both agree.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class SilenceRule(NamedTuple):
    """The longest silence of a topic: a number of its usual steps, with a lower and an upper limit in seconds."""

    steps: float
    shortest: float = 0.0
    longest: float = inf

    def after(self, step: float, second: float = 1.0) -> float:
        """Return the time without a message after which a topic is silent, in the unit of the step.

        If the step is unknown, 0 gives the shortest time, and infinity the longest.

        Args:
            step: the usual time between two messages.
            second: one second in the unit of the step: 1e9 for nanoseconds.
        """
        return min(max(self.shortest * second, self.steps * step), self.longest * second)


LIVE = SilenceRule(3, 1.0, 10.0)
"""For a source on show: its picture turns pale, verdicts on its samples are unknown, `wait` gives up."""

TO_DRIVE_BY = SilenceRule(2, 0.4, 2.0)
"""For topics that a program drives by: the robot is stopped."""

TO_DRIVE_BY_NAMED = TO_DRIVE_BY._replace(longest=inf)
"""For a steady topic without a widget that a program names. It may be slow, such as the state of a battery."""

LISTED = SilenceRule(3, 3.0)
"""For a row in the list of a robot's topics: its rate is shown as zero."""

RECORDED = SilenceRule(2, 2.0)
"""For a topic of a recording: the last sample is stale, for `find` and in a player."""

STEP_SILENCE = 1.0
"""Seconds without a message of the topic on which a program steps, after which it reports that it waits."""

PAUSE = SilenceRule(10, 2.0)
"""For a topic of a recording: a longer gap means that nothing was sent, a shorter one that samples were lost."""

OPEN_END = SilenceRule(10, 5.0)
"""For the start and the end of a recording: the topic began late, or ended early."""

ENDED = SilenceRule(10)
"""For the end of a damaged file: the topic has ended, and no longer shows the clock."""

CLOCK_JUMP = SilenceRule(100, 60.0)
"""For a topic of a recording: nothing was recorded for long, or the clock jumped ahead."""

PARTS_PAUSE = 60.0
"""Longest time in seconds between two files that count as parts of one recording only because of their times."""

SCAN_GAP = SilenceRule(3)
"""For two scans of a scanogram, with the 90th percentile of the steps: the picture has a gap."""

PLOT_GAP = SilenceRule(3, 1.0)
"""For two values of a plot: the line has a gap. A slow topic keeps its line, such as one message a minute."""

BEAT = 1.0
"""Seconds between two heartbeats of a kernel whose widget has nothing new to show; the page waits for two."""

PAGE_SILENCE = 3.0
"""Seconds without a message from any page after which no page is open. A page sends one every second."""

NO_ANSWER = 1.5
"""Seconds without an answer to a first attempt to connect, after which a hint says what to compare."""

ROBOT_SILENCE = 1.0
"""Seconds without an answer from a robot after which only zero is sent, because commands would arrive late."""

ROBOT_GONE = 10.0
"""Seconds without an answer from a robot after which the connection is given up."""


def usual_step(times: NDArray[np.float64] | NDArray[np.int64]) -> float:
    """Return the median step between times that increase, in the unit of the times, or 0 without such steps."""
    import numpy as np  # Imported lazily: the rules do not need it, and a guard has to start fast.

    ahead = np.diff(times)
    ahead = ahead[ahead > 0]
    return float(np.median(ahead)) if ahead.size else 0.0


def is_steady(times: NDArray[np.float64] | NDArray[np.int64]) -> bool:
    """Return True if messages come at a steady pace, as from a sensor, so that silence means a missing message.

    A few messages may seem steady by chance, such as two that were sent by hand.
    """
    import numpy as np

    if len(times) < _LEAST:
        return False
    ahead, usual = np.diff(times), usual_step(times)
    return bool(usual and np.count_nonzero(np.abs(ahead - usual) <= _STEADY * usual) >= _SHARE * len(ahead))


_STEADY, _SHARE = 0.25, 0.5
"""A topic is steady if at least `_SHARE` of its steps differ from the usual step by at most `_STEADY` of it."""

_LEAST = 10
"""The fewest messages with which a topic may count as steady."""

STEPS = 20
"""The number of newest messages of a running robot that decide if a topic is steady."""

SEEN_FOR = 40.0
"""Seconds for which a widget counts as seen. A page reports this every ten seconds, and may close without a message."""

"""When a sample is stale: the rules by which a topic, a kernel, a page or a robot counts as silent, by their names.

The page's own are in js/shared/staleness.ts. `tests/vectors.py` holds both to each other.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class SilenceRule(NamedTuple):
    """How long a topic may send nothing: so many of its usual steps, and at least and at most so many seconds."""

    steps: float
    shortest: float = 0.0
    longest: float = inf

    def after(self, step: float, second: float = 1.0) -> float:
        """The time without a message after which a topic with this usual step is silent, in the unit of the step.

        Where the step is unknown, 0 gives the shortest time, and infinity the longest.

        Args:
            step: the usual time between two messages.
            second: one second in its unit: 1e9 for nanoseconds.
        """
        return min(max(self.shortest * second, self.steps * step), self.longest * second)


LIVE = SilenceRule(3, 1.0, 10.0)
"""Of a source that is on show now: its picture turns pale, verdicts on its samples are unknown, `wait` gives up."""

TO_DRIVE_BY = SilenceRule(2, 0.4, 2.0)
"""Of what a program drives by: the robot is stopped."""

TO_DRIVE_BY_NAMED = TO_DRIVE_BY._replace(longest=inf)
"""Of a steady topic without a widget that a program names. It may be slow, as the state of a battery is."""

LISTED = SilenceRule(3, 3.0)
"""Of a row in the list of a robot's topics: its rate is none."""

RECORDED = SilenceRule(2, 2.0)
"""Of a topic of a recording: the sample before is stale, to `find` and in a player."""

STEP_SILENCE = 1.0
"""Seconds without a message of the topic on which a program steps: it says that it waits for it."""

PAUSE = SilenceRule(10, 2.0)
"""Of a topic of a recording: nothing was sent. After a shorter time samples were lost."""

OPEN_END = SilenceRule(10, 5.0)
"""At an end of a recording: the topic began late, or ended early."""

ENDED = SilenceRule(10)
"""At the end of a damaged file: the topic has ended, and says no more of the clock."""

CLOCK_JUMP = SilenceRule(100, 60.0)
"""Of a topic of a recording: nothing was recorded for long, or the clock jumped ahead."""

PARTS_PAUSE = 60.0
"""Longest time in seconds between two files that are parts of one recording, where nothing else says that they are."""

SCAN_GAP = SilenceRule(3)
"""Between two scans of a scanogram, of steps that nine of ten stay below: the picture has a gap."""

BEAT = 1.0
"""Seconds between two signs of life of a kernel whose widget has nothing new to show; the page waits for two."""

PAGE_SILENCE = 3.0
"""Seconds without a message from any page after which no page is there. A page sends one every second."""

NO_ANSWER = 1.5
"""Seconds without an answer to a first attempt to connect, after which it is said what to compare."""

ROBOT_SILENCE = 1.0
"""Seconds without an answer of a robot after which only zero is sent: what is sent then waits, and arrives late."""

ROBOT_GONE = 10.0
"""Seconds without an answer of a robot after which the connection to it is given up."""


def usual_step(times: NDArray[np.float64] | NDArray[np.int64]) -> float:
    """The median time to the next later time, in the unit of the times; 0 if there is none."""
    import numpy as np  # Imported lazily: the rules need none, and a guard is to start soon.

    ahead = np.diff(times)
    ahead = ahead[ahead > 0]
    return float(np.median(ahead)) if ahead.size else 0.0


def is_steady(times: NDArray[np.float64] | NDArray[np.int64]) -> bool:
    """Whether messages come at a steady pace, as those of a sensor do: then a silence says that one is missing.

    A few may come so by chance, such as two that somebody sent by hand.
    """
    import numpy as np

    if len(times) < _LEAST:
        return False
    ahead, usual = np.diff(times), usual_step(times)
    return bool(usual and np.count_nonzero(np.abs(ahead - usual) <= _STEADY * usual) >= _SHARE * len(ahead))


_STEADY, _SHARE = 0.25, 0.5
"""A topic is steady if this share of its steps differs from the usual one by no more than this part of it."""

_LEAST = 10
"""The number of messages from which on a topic may count as steady."""

STEPS = 20
"""Number of the newest messages of a running robot by whose times a topic counts as steady."""

SEEN_FOR = 40.0
"""Seconds for which it counts that somebody looks. A page says so every ten, and may go without a word."""

"""Feeds with a robot in the process of the kernel: their scans, and the times when these are due."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from itertools import chain, repeat
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robowidgets import feeds
from robowidgets.feeds import Feed
from robowidgets.samples import Scan
from robowidgets.simulator import Robot, Scanner, World

from .recordings import write_scans
from .scan import ANGLE_INCREMENT, RANGE_MAX, RANGE_MIN, RAY_COUNT, encode

SECOND = 1_000_000_000
LEAD = 0.5
"""Seconds before the first counted scan: the feed connects, its notes disappear, and scans have the number 0."""
TAIL = 0.5
"""Seconds in which the last scan is repeated, because a note at the end of a recording moves the picture."""


def steps(hz: float, count: int) -> NDArray[np.float64]:
    """Return seconds from each scan to the next. They vary by a tenth, to meet every phase of the display."""
    return np.random.default_rng(1).uniform(0.9, 1.1, count) / hz


def recorded(first: int, hz: float, seconds: float) -> tuple[Feed, NDArray[np.float64]]:
    """Return the feed of a recording, and the seconds at which its scans are due."""
    due = LEAD + np.cumsum(steps(hz, round(hz * seconds)))
    path = Path(tempfile.mkdtemp()) / "scans"
    before, after = np.arange(0, LEAD, 1 / hz), due[-1] + np.arange(1 / hz, TAIL, 1 / hz)
    last = first + len(due) - 1
    said = [*((0, when) for when in before), *enumerate(due, first), *((last, when) for when in after)]
    write_scans(path, ((number, SECOND + round(when * SECOND), number * SECOND) for number, when in said))
    return feeds.recording(path), due


class Counting(Robot):
    """A robot with consecutive numbers in its scans. Its scanner still does all the usual work."""

    def __init__(self, numbers: Iterator[int]) -> None:
        scanner = Scanner(RAY_COUNT, ANGLE_INCREMENT * (RAY_COUNT - 1), RANGE_MIN, RANGE_MAX, rate=200.0)
        super().__init__(World.rooms(), (0.2, -0.85, 0.5), scanner=scanner)
        self._numbers = numbers
        self._seen: Any = None
        self._said: Any = None

    def scan(self) -> Scan:
        """See `Robot`."""
        seen = super().scan()
        if seen is not self._seen:
            self._seen = seen
            number = next(self._numbers)
            self._said = seen.again(encode(number), None, number * SECOND)
        return self._said  # type: ignore[no-any-return]


def simulated(first: int, hz: float, seconds: float) -> tuple[Feed, NDArray[np.float64]]:
    """Return the feed of the simulated robot, and the seconds at which its scans are due, with constant steps."""
    hz *= 0.93  # at 40 Hz, every second scan would meet the same phase of the display
    count = round(hz * seconds)
    last = first + count - 1
    numbers = chain([0] * round(LEAD * hz), range(first, last), repeat(last))
    return feeds.simulator(Counting(numbers), hz=hz), np.arange(count) / hz


MADE = {"recording": recorded, "simulator": simulated}

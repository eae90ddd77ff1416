"""Counting the messages that are missing in a topic while it is recorded."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np

from ..messages.fields import get, stamp_ns
from ..samples.staleness import PAUSE, STEPS, is_steady, usual_step

_LONG, _NEAR, _SHORT = 1.5, 1.25, 0.5
"""Shares of the usual step. A step above the first is a gap. Up to the second, the topic continues at its pace. Below
the third, a message was only late."""


class Gaps:
    """A counter of the messages that a topic lacks: by ``header.seq`` of ROS 1, else by the stamps of a steady topic.

    A gap counts once the topic continues at its usual pace, so a topic that becomes slower has no gap. A gap that is
    long for the pace (`PAUSE`) does not count: nothing was sent.

    Attributes:
        missing: the number of missing messages.
        by_number: True if the count is by ``header.seq``.
    """

    def __init__(self) -> None:
        self.missing = 0
        self.by_number = False
        self._pending = 0
        self._number: int | None = None
        self._are_numbered = True
        """True until a number is lower than the one before, because of several publishers or a restarted one."""
        self._stamps: deque[int] = deque(maxlen=STEPS)
        self._count, self._usual = 0, 0.0

    def see(self, message: Any) -> None:
        """Count the next message."""
        number = get(message, "header.seq", None)
        if self._are_numbered and isinstance(number, int) and number > 0:
            self._see_number(number)
        elif (stamp := stamp_ns(message)) is not None:
            self._see_stamp(stamp)

    def _see_number(self, number: int) -> None:
        step = 1 if self._number is None else number - self._number
        self._number, self.by_number = number, True
        if step <= 0:
            self._are_numbered, self.by_number, self._pending = False, False, 0
        elif step > 1:
            self._pending += step - 1
        else:
            self._end_gap()

    def _see_stamp(self, stamp: int) -> None:
        step = stamp - self._stamps[-1] if self._stamps else 0
        if self._usual and step > _LONG * self._usual:
            if step > PAUSE.after(self._usual, 1e9):
                self._pending = 0
            elif is_steady(np.array(self._stamps)):
                self._pending += round(step / self._usual) - 1
        elif step < _SHORT * self._usual:
            self._pending = max(0, self._pending - 1)
        elif step <= _NEAR * self._usual:
            self._end_gap()
        self._stamps.append(stamp)
        self._count += 1
        if self._count % (STEPS // 2) == 0:
            usual = usual_step(np.array(self._stamps))
            if abs(usual - self._usual) > self._usual / 4:
                self._pending = 0
            self._usual = usual

    def _end_gap(self) -> None:
        self.missing, self._pending = self.missing + self._pending, 0

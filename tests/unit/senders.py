"""Senders for a pacer, and a pacer whose time a test advances."""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import Any

from robowidgets.runtime.clock import Threads
from robowidgets.widget.pacer import Pacer

from .clocks import ManualClock

MOST_IN_A_SECOND = 300


def turn_of(pacer: Pacer) -> AbstractContextManager[bool]:
    """Hold the turn of a pacer: nothing is sent meanwhile."""
    return pacer._turn


def get_timers(pacer: Pacer) -> Mapping[Any, float]:
    """Return the senders that a pacer sends later, with their times."""
    return pacer._timers


class Sender:
    """Stores a newest value and notes what was sent, and when."""

    def __init__(self, clock=time.monotonic, size: int = 0) -> None:
        self.clock = clock
        self.size = size
        self.newest = 0
        self.sent: list[int] = []
        self.times: list[float] = []

    def send_newest(self) -> int:
        self.sent.append(self.newest)
        self.times.append(self.clock())
        return self.size


class Restless(Sender):
    """Has a newer value after each send: a source that floods."""

    def __init__(self, pacer: Pacer, **more: object) -> None:
        super().__init__(**more)
        self.pacer = pacer

    def send_newest(self) -> int:
        size = super().send_newest()
        self.newest += 1
        self.pacer.mark(self)
        return size


class Failing(Sender):
    """Raises its error instead of sending, while it has one; notes the time of each try."""

    error: BaseException | None = OSError("the wire is cut")

    def send_newest(self) -> int:
        if self.error is not None:
            self.times.append(self.clock())
            raise self.error.with_traceback(None)
        return super().send_newest()


class Gated(Sender):
    """Is sent only when the gate opens."""

    def __init__(self) -> None:
        super().__init__()
        self.gate = threading.Event()
        self.begun = threading.Event()

    def send_newest(self) -> int:
        self.begun.set()
        assert self.gate.wait(120)
        return super().send_newest()


class ByHand(Pacer):
    """A pacer without a thread, whose time passes on demand."""

    def __init__(self) -> None:
        self._time = ManualClock()
        super().__init__(Threads(self._time))

    @property
    def now(self) -> float:
        return self._time.now()

    @now.setter
    def now(self, seconds: float) -> None:
        self._time.set(seconds)

    def _start(self) -> None:
        pass

    def run(self, seconds: float) -> None:
        """Act as the thread does, for some seconds of its clock."""
        end = self.now + seconds
        while (wait := self._send_one()) is not None and self.now + wait <= end:
            # Floating point may end a wait a little early, as a real clock may.
            self.now += max(wait, 1e-9)
        self.now = end


def most_in_a_second(times: list[float]) -> int:
    times = sorted(times)
    most = first = 0
    for last, when in enumerate(times):
        while times[first] <= when - 1:
            first += 1
        most = max(most, last - first + 1)
    return most

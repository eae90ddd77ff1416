"""The newest sample of a widget, and the threads that wait for the next one."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

from ..runtime.waiters import Waiters
from .rate import RateMeter

S = TypeVar("S")


class Shot(NamedTuple):
    """The state of a widget at one time: its sample with the texts on it. Each new one has a higher version."""

    version: int
    sequence: int
    arrived: float
    sample: Any
    about: dict[str, Any]


class NewestSample(Generic[S]):
    """The newest sample of a widget, with the known texts on it.

    Any thread may store a sample at any rate. Hold `lock` to read several attributes.

    Attributes:
        waiters: the threads that wait for another sample.
    """

    def __init__(self) -> None:
        self.sample: S | None = None
        """None before the first one."""
        self.about: dict[str, Any] = {}
        self.sequence = 0
        """The number of samples so far."""
        self.replaced = 0
        """The number of messages that were skipped for a newer one."""
        self.version = 1
        """The version to judge. Each sample, and each improvement of a sample, has a higher one."""
        self.arrived = 0.0
        """The time at which the sample came, by the monotonic clock."""
        self.changed = False
        """True if there is something newer than what was packed last."""
        self.meter = RateMeter()
        self.on_new: Callable[[], object] | None = None
        """Called with the lock for each new version to judge."""
        self.make_locks()

    def make_locks(self) -> None:
        """Make free locks; again in a forked process, which has no threads that could release the old ones."""
        self.lock = threading.RLock()
        self.waiters = Waiters(self.lock)
        self._taken = threading.local()

    def put(self, sample: S, about: dict[str, Any], *, counts: bool) -> None:
        """Store a sample with its texts; with ``counts=False`` an improved version of the one before."""
        with self.lock:
            self.sample, self.about, self.changed = sample, about, True
            if counts:
                self.sequence += 1
                self.arrived = time.monotonic()
            self.renew()

    def count_replaced(self, count: int) -> None:
        """Count messages that were skipped for a newer one, for the rate; not before the first sample."""
        with self.lock:
            if self.sequence:
                self.replaced += count

    def renew(self) -> None:
        """Get the sample judged again, and wake the threads that wait. Called with the lock."""
        self.version += 1
        if self.on_new:
            self.on_new()
        self.waiters.wake()

    def is_new(self) -> bool:
        """Return True if the calling thread has not taken this sample yet."""
        return self.sequence > getattr(self._taken, "sequence", 0)

    def take(self) -> None:
        """Note that the calling thread has this sample."""
        self._taken.sequence = self.sequence

    @property
    def age(self) -> float:
        """Seconds since the sample came."""
        return time.monotonic() - self.arrived

    @property
    def rate(self) -> float:
        """Messages per second over the last seconds with messages, including skipped ones. NaN while it is unknown."""
        with self.lock:
            return self.meter.rate(self.sequence + self.replaced, self.arrived)

    def shot(self) -> Shot:
        """Return the sample to show, with its texts. Called with the lock."""
        return Shot(self.version, self.sequence, self.arrived, self.sample, self.about)

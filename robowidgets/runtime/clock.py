"""Time as a dependency: what waits or times out takes a `Clock`, and what runs as time passes takes a `Scheduler`."""

from __future__ import annotations

import heapq
import itertools
import logging
import os
import threading
import time
from collections.abc import Callable, Coroutine
from contextlib import suppress
from typing import Any, Protocol, TypeVar

from .platform_fixes import run_beside_debugger
from .user_threads import UserThread

log = logging.getLogger("robowidgets")

T = TypeVar("T")

Turn = Callable[[], "float | None"]
"""Does the due work and returns the time of the next turn, or None to wait for a wake-up. `Detached` ends it."""


class Detached(BaseException):
    """Raised in a turn that its owner has detached. User code never sees it."""


class Signal(Protocol):
    """Wakes the one thread that waits for it. Setting it twice has the effect of setting it once."""

    def set(self) -> None:
        """Wake the thread that waits, or the next one that would."""

    def wait_until(self, when: float | None) -> None:
        """Wait until it is set, or until a time, or for ever if the time is None."""


class ConditionVariable(Protocol):
    """A condition variable whose lock the caller holds."""

    def notify_all(self) -> None:
        """Wake all threads that wait."""

    def wait_until(self, when: float | None) -> bool:
        """Wait for a notification, at most until a time unless it is None; return False if the time came first."""


class Clock(Protocol):
    """Seconds of a monotonic clock, and the waits that use it.

    All times are absolute, so that a wait which begins late ends in time. A clock makes the objects that wait, and
    `began` reports the threads that use it. So a clock that a test moves knows which threads are still at work.
    """

    def now(self) -> float:
        """Return the time in seconds."""
        ...

    def slept(self) -> float:
        """Return the seconds for which the computer has slept since its start. `now` stands still meanwhile."""
        ...

    def sleep(self, seconds: float) -> None:
        """Return after some seconds."""

    def signal(self) -> Signal:
        """Return a new signal that waits by this clock."""
        ...

    def condition(self, lock: threading.RLock) -> ConditionVariable:
        """Return a new condition variable of a lock, which waits by this clock."""
        ...

    def began(self, thread: threading.Thread) -> None:
        """Note a thread that waits by this clock, before it starts."""

    def run(self, main: Coroutine[Any, Any, T]) -> T:
        """Run a coroutine in an event loop of its own, which uses the time of this clock."""
        ...


class Ticket(Protocol):
    """Repeats one turn. Any thread and any signal handler may call its methods: they take no lock."""

    def wake(self) -> None:
        """Do the turn now."""

    def detach(self) -> None:
        """Do no further turn, without waiting for a turn that is under way."""


class Scheduler(Protocol):
    """Repeats turns, and calls functions at a time."""

    clock: Clock

    def start(self, turn: Turn, name: str, *, runs_user_code: bool = False) -> Ticket:
        """Do a turn now, and again whenever it is due or woken. A debugger suspends turns that run user code."""
        ...

    def call_at(self, when: float, function: Callable[[], object]) -> None:
        """Call a function of this package, which must not wait, at a time."""


def _never_sleeps() -> int | None:
    # On macOS CLOCK_MONOTONIC goes on while the computer sleeps, but `time.monotonic` does not.
    number: int = getattr(time, "CLOCK_BOOTTIME", getattr(time, "CLOCK_MONOTONIC", -1))
    with suppress(AttributeError, OSError):
        time.clock_gettime(number)
        return number
    return None


_NEVER_SLEEPS = _never_sleeps()
"""The number of the system's clock that goes on while the computer sleeps, or None if it has no such clock."""


class RealClock:
    """The monotonic clock of the computer."""

    now = staticmethod(time.monotonic)
    sleep = staticmethod(time.sleep)

    def slept(self) -> float:
        """See `Clock`."""
        return 0.0 if _NEVER_SLEEPS is None else time.clock_gettime(_NEVER_SLEEPS) - time.monotonic()

    def signal(self) -> Signal:
        """See `Clock`."""
        return _RealSignal()

    def condition(self, lock: threading.RLock) -> ConditionVariable:
        """See `Clock`."""
        return _RealCondition(lock)

    def began(self, thread: threading.Thread) -> None:
        """See `Clock`."""

    def run(self, main: Coroutine[Any, Any, T]) -> T:
        """See `Clock`."""
        import asyncio  # Imported lazily: a guard may need none, and is to start soon.

        return asyncio.run(main)


class _RealSignal:
    def __init__(self) -> None:
        # A lock costs callers half as much as a Condition.
        self._lock = threading.Lock()
        self._lock.acquire()

    def set(self) -> None:
        if self._lock.locked():
            with suppress(RuntimeError):  # another thread was faster
                self._lock.release()

    def wait_until(self, when: float | None) -> None:
        self._lock.acquire(timeout=-1 if when is None else _remaining(when))


class _RealCondition(threading.Condition):
    def wait_until(self, when: float | None) -> bool:
        return self.wait(None if when is None else _remaining(when))


def _remaining(when: float) -> float:
    return min(max(0.0, when - time.monotonic()), threading.TIMEOUT_MAX)


class _Worker(UserThread):
    """The thread of one turn. A turn may call functions of a user, so it can be detached."""

    def __init__(self, clock: Clock, turn: Turn, name: str) -> None:
        super().__init__(self._repeat, name)
        self._clock, self._turn, self._signal = clock, turn, clock.signal()

    def wake(self) -> None:
        self._signal.set()

    def detach(self) -> None:
        self.abandon()
        self.wake()

    def _repeat(self) -> None:
        with suppress(Detached):
            while not self.is_abandoned:
                try:
                    when = self._turn()
                except Exception:  # of this package: errors of users are caught at the calls of their functions
                    log.exception("robowidgets: error in %s", self.name)
                    when = None
                if not self.is_abandoned and (when is None or when > self._clock.now()):
                    self._signal.wait_until(when)


class Threads:
    """Runs each turn in a thread of its own, so that a turn that hangs delays no other; all timers in one more thread.

    Args:
        clock: the clock of the computer by default.
    """

    def __init__(self, clock: Clock | None = None) -> None:
        self.clock: Clock = clock or RealClock()
        self.reset()

    def reset(self) -> None:
        """Reset to no timers. A forked process inherits held locks, but not the threads that hold them."""
        self._lock = threading.RLock()
        self._timers: list[tuple[float, int, Callable[[], object]]] = []
        self._numbers = itertools.count()
        self._timer: Ticket | None = None

    def start(self, turn: Turn, name: str, *, runs_user_code: bool = False) -> _Worker:
        """See `Scheduler`."""
        worker = _Worker(self.clock, turn, name)
        if not runs_user_code:
            run_beside_debugger(worker)
        self.clock.began(worker)
        worker.start()
        return worker

    def call_at(self, when: float, function: Callable[[], object]) -> None:
        """See `Scheduler`."""
        with self._lock:
            heapq.heappush(self._timers, (when, next(self._numbers), function))
            if self._timer is None:
                self._timer = self.start(self._call_due, "robowidgets-timer")
            else:
                self._timer.wake()

    def _call_due(self) -> float | None:
        """Call the function that is due, if any, and return the time of the next one."""
        with self._lock:
            if not self._timers or self._timers[0][0] > self.clock.now():
                return self._timers[0][0] if self._timers else None
            _, _, function = heapq.heappop(self._timers)
        try:
            function()
        except Exception:
            log.exception("robowidgets: error in a timer")
        return self.clock.now()


scheduler = Threads()
"""The scheduler of this process."""

if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=scheduler.reset)

"""A clock whose time passes when a test says so."""

from __future__ import annotations

import asyncio
import itertools
import selectors
import threading
import time
from collections.abc import Callable, Coroutine
from contextlib import suppress
from math import inf
from typing import Any, TypeVar

from robowidgets.runtime.clock import Threads

T = TypeVar("T")


def end_timers(threads: Threads) -> None:
    """End the thread of the timers if it has begun."""
    if (timer := threads._timer) is not None:
        timer.detach()


class ManualClock:
    """A clock that stands still until `advance`, which returns when all threads that it knows wait again or have ended.

    It knows the threads that it started, and threads that have ever waited by it. One that hangs elsewhere, as in a
    function that a test gates, has to be named in `hangs`.
    """

    def __init__(self, start: float = 1000.0) -> None:
        self._now = start
        self.asleep = 0.0
        """Seconds that the computer slept, while the time stood still."""
        self._lock = threading.RLock()
        self._rests = threading.Condition(self._lock)
        self._waits: list[tuple[float, int, Any, threading.Thread]] = []
        self._number = itertools.count()
        self._awake: set[threading.Thread] = set()

    def now(self) -> float:
        return self._now

    def slept(self) -> float:
        return self.asleep

    def sleep(self, seconds: float) -> None:
        self.signal().wait_until(self._now + seconds)

    def set(self, now: float) -> None:
        """Set the time while no thread waits by this clock."""
        assert not self._waits, "advance() wakes the waiting threads"
        self._now = now

    def jump(self, seconds: float) -> None:
        """Advance the time without waking a thread."""
        with self._lock:
            self._now += seconds

    def signal(self) -> _Signal:
        return _Signal(self)

    def condition(self, lock: threading.RLock) -> _Condition:
        return _Condition(self, lock)

    def began(self, thread: threading.Thread) -> None:
        with self._lock:
            self._awake.add(thread)

    def beside(self, function: Callable[[], object], name: str = "beside") -> threading.Thread:
        """Call a function in a thread that this clock knows."""
        thread = threading.Thread(target=function, name=name, daemon=True)
        self.began(thread)
        thread.start()
        return thread

    def run(self, main: Coroutine[Any, Any, T]) -> T:
        loop = _Loop(self)
        try:
            return loop.run_until_complete(main)
        finally:
            asyncio.runners._cancel_all_tasks(loop)  # type: ignore[attr-defined]
            loop.run_until_complete(loop.shutdown_asyncgens())
            loop.close()

    def changing(self) -> threading.RLock:
        """Return the lock under which threads begin and end to wait."""
        return self._lock

    def enter(self, when: float | None, what: Any) -> bool:
        """Note that the calling thread waits for this time; return False if the time has passed already."""
        with self._lock:
            if when is not None and when <= self._now:
                return False
            me = threading.current_thread()
            self._waits.append((inf if when is None else when, next(self._number), what, me))
            self._awake.discard(me)
            self._rests.notify_all()
            return True

    def wakes(self, what: Any) -> None:
        """Note that the threads that wait for this run again from now on."""
        with self._lock:
            for entry in [entry for entry in self._waits if entry[2] is what]:
                self._waits.remove(entry)
                self._awake.add(entry[3])

    def advance(self, seconds: float = 0.0, hangs: tuple[str, ...] = ()) -> None:
        """Advance the time, from one wait that ends to the next; `hangs` names threads that are not waited for."""
        end = self._now + seconds
        while True:
            self.settle(hangs)
            with self._lock:
                due = min((entry for entry in self._waits if entry[0] <= end), default=None)
                if due is None:
                    self._now = end
                    return
                self._now = max(self._now, due[0])
            due[2].wake()

    def stand_still(self, seconds: float, hangs: tuple[str, ...] = ()) -> None:
        """Advance the time while the process stands still: all waiting threads wake late, by the same time."""
        self.settle(hangs)
        self.jump(seconds)
        self.advance(hangs=hangs)

    def settle(self, hangs: tuple[str, ...] = ()) -> None:
        """Wait until no thread that this clock knows is at work."""
        until = time.monotonic() + 240.0
        with self._lock:
            self._awake.discard(threading.current_thread())
            while busy := [thread.name for thread in self._awake if thread.is_alive() and thread.name not in hangs]:
                assert time.monotonic() < until, f"{busy} did not wait again"
                self._rests.wait(0.005)  # a thread that ends notifies no other
            self._awake = {thread for thread in self._awake if thread.is_alive()}


class _Signal:
    def __init__(self, clock: ManualClock) -> None:
        self._clock, self._lock = clock, threading.Lock()
        self._lock.acquire()

    def set(self) -> None:
        with self._clock.changing(), suppress(RuntimeError):
            self._clock.wakes(self)
            self._lock.release()

    def wake(self) -> None:
        self.set()

    def wait_until(self, when: float | None) -> None:
        with self._clock.changing():  # a thread whose signal is set already does not wait
            if self._lock.acquire(blocking=False) or not self._clock.enter(when, self):
                return
        self._lock.acquire()


class _Condition:
    def __init__(self, clock: ManualClock, lock: threading.RLock) -> None:
        self._clock, self._lock = clock, lock
        self._changed = threading.Condition(lock)

    def notify_all(self) -> None:
        self._clock.wakes(self)
        self._changed.notify_all()

    def wake(self) -> None:
        with self._lock:
            self.notify_all()

    def wait_until(self, when: float | None) -> bool:
        if not self._clock.enter(when, self):
            return False
        self._changed.wait()
        return when is None or self._clock.now() < when


class _Loop(asyncio.SelectorEventLoop):
    """An event loop that waits for real sockets, and for the time of a clock."""

    def __init__(self, clock: ManualClock) -> None:
        self._clock, self._lock, self._is_poked = clock, threading.Lock(), False
        super().__init__(_Selector(self))

    def time(self) -> float:
        return self._clock.now()

    def wake(self) -> None:
        self._write_to_self()

    def run_in_executor(self, _: Any, func: Any, *args: Any) -> asyncio.Future[Any]:
        """Call it at once in this thread: no time passes during a name lookup."""
        future: asyncio.Future[Any] = self.create_future()
        try:
            future.set_result(func(*args))
        except Exception as error:
            future.set_exception(error)
        return future

    def _write_to_self(self) -> None:
        with self._lock:
            self._is_poked = True
            self._clock.wakes(self)
        super()._write_to_self()

    def may_rest(self) -> bool:
        """True while it waits for a socket, a call of another thread, or the time of its next timer."""
        with self._lock:
            is_poked, self._is_poked = self._is_poked, False
            return not is_poked and self._clock.enter(self._scheduled[0].when() if self._scheduled else None, self)


class _Selector(selectors.DefaultSelector):  # type: ignore[misc,valid-type]
    def __init__(self, loop: _Loop) -> None:
        super().__init__()
        self._loop = loop

    def select(self, timeout: float | None = None) -> Any:
        there = super().select(0)
        if there or timeout == 0 or not self._loop.may_rest():
            return there
        try:
            return super().select(None)
        finally:
            self._loop._clock.wakes(self._loop)

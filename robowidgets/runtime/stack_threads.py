"""Threads for a Python without threads: each is a stack of its own, which yields while it waits.

In a browser Python has one thread, but WebAssembly can suspend a stack while the event loop goes on (JSPI). So a thread
is a call that the loop starts, and a wait in it lets the loop start or resume others. Functions of the user may compute
without waiting: they yield at their loops and calls when their time slice is over. The classes of `threading` are used
unchanged: only the functions below them are replaced.
"""

from __future__ import annotations

import asyncio
import contextvars
import ctypes
import itertools
import sys
import threading
import time
from collections import deque
from collections.abc import Awaitable, Callable
from types import CodeType, FrameType
from typing import Any, NamedTuple, Protocol

SLICE = 0.02
"""Seconds that a function of the user may compute before it yields."""

_MOST_STEPS = 256
"""The most steps, which are turns of loops and calls, between two readings of the clock."""

_TOOL = 3
"""The first tool id of `sys.monitoring` that Python does not reserve."""

_NO_WAIT = (
    "cannot wait here: the browser cannot put this call aside. "
    "What a button of the page calls must not wait; a cell, a program and a connected function may"
)


class Host(Protocol):
    """An environment with an event loop that can suspend stacks."""

    loop: asyncio.AbstractEventLoop
    can_switch: bool
    """True if it can suspend stacks at all. Else threads start, but never run."""

    def can_wait(self) -> bool:
        """Return True if the calling stack can be suspended."""
        ...

    def wait(self, awaitable: Awaitable[Any]) -> Any:
        """Suspend the calling stack until an awaitable is done, and return its result."""
        ...


class _Stack:
    """A stack of calls: of a thread, or of a callback of the event loop, which belongs to the main thread.

    Attributes:
        ends: the error to raise in it when it goes on.
        computes_since: the time at which it last waited.
    """

    def __init__(self, ident: int) -> None:
        self.ident = ident
        self.ends: type[BaseException] | None = None
        self.computes_since = time.monotonic()


class _SeenFrame(NamedTuple):
    """A copy of a frame from the time its stack was suspended. The C stack around it is moved in memory then."""

    f_code: CodeType
    f_lineno: int | None
    f_globals: dict[str, Any]
    f_back: _SeenFrame | None


def _seen(frame: FrameType | None) -> _SeenFrame | None:
    frames: list[FrameType] = []
    while frame is not None:
        frames.append(frame)
        frame = frame.f_back
    seen: _SeenFrame | None = None
    for one in reversed(frames):
        seen = _SeenFrame(one.f_code, one.f_lineno, one.f_globals, seen)
    return seen


class StackThreads:
    """The threads of a host.

    Args:
        host: suspends stacks.
        on_long: called after each slice of the main thread, with the seconds since it last waited.
    """

    def __init__(self, host: Host, on_long: Callable[[float], None] = lambda _: None) -> None:
        self._host, self._on_long = host, on_long
        self._main = threading.main_thread().ident or 0
        self._idents = itertools.count(self._main + 1)
        self._now = _Stack(self._main)
        """The running stack. It is never suspended."""
        self._aside: dict[_Stack, _SeenFrame | None] = {}
        self._begun: dict[int, _Stack] = {}
        self._slice_end = 0.0
        self._sleep = time.sleep

    # -- waiting -------------------------------------------------------------------------------------------------------

    @property
    def current(self) -> _Stack:
        """The running stack."""
        return self._now

    def block(self, seconds: float | None, waiters: deque[asyncio.Future[None]] | None = None) -> None:
        """Run others until one of them wakes these waiters, at most for some seconds unless they are None.

        Raises:
            RuntimeError: the calling stack cannot be suspended.
        """
        if not self._host.can_wait():
            raise RuntimeError(_NO_WAIT)
        loop, me = self._host.loop, self._now
        self._aside[me] = _seen(sys._getframe(1))
        woken = loop.create_future()
        # A delay, not a time: a time may be over before it is scheduled.
        timer = None if seconds is None else loop.call_later(max(0.0, seconds), _wake, woken)
        if waiters is not None:
            waiters.append(woken)
        self._now = _Stack(self._main)
        try:
            self._host.wait(woken)
        finally:
            self._now = me
            del self._aside[me]
            if waiters is not None and woken in waiters:
                waiters.remove(woken)
            if timer is not None:
                timer.cancel()

    def sleep(self, seconds: float) -> None:
        """Sleep as `time.sleep` does."""
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        if not self._host.can_wait():
            self._sleep(seconds)  # Python's own `sleep`, which blocks the others
            return
        self.block(seconds)
        self._has_waited()

    def _has_waited(self) -> None:
        me = self._now
        me.computes_since = time.monotonic()
        self._slice_end = me.computes_since + SLICE
        if me.ends is not None:
            ends, me.ends = me.ends, None
            raise ends

    # -- the functions below `threading` -------------------------------------------------------------------------------

    def get_ident(self) -> int:
        """Replace `threading.get_ident`."""
        return self._now.ident

    def begin(self, function: Callable[[], object], handle: _Handle, daemon: bool = True) -> None:  # noqa: ARG002
        """Start a thread. Its `Thread` need not wait for the start."""
        stack = _Stack(next(self._idents))
        self._begun[stack.ident] = stack
        handle.ident = stack.ident

        def run() -> None:
            self._now = stack
            try:
                function()
            finally:
                self._now = _Stack(self._main)
                del self._begun[stack.ident]
                handle.end()

        if self._host.can_switch:
            self._host.loop.call_soon(run, context=contextvars.Context())
        started: threading.Event = vars(function.__self__)["_started"]  # type: ignore[attr-defined]
        started.set()

    def current_frames(self) -> dict[int, Any]:
        """Replace `sys._current_frames`."""
        frames: dict[int, Any] = {self._now.ident: sys._getframe(1)}
        for stack, frame in self._aside.items():
            frames.setdefault(stack.ident, frame)
        return frames

    def raise_in(self, ident: ctypes.c_ulong, error: ctypes.py_object[type[BaseException]]) -> int:
        """Raise an error in a thread when it next yields or has slept, as `PyThreadState_SetAsyncExc` does."""
        stack = self._begun.get(ident.value)
        if stack is None:
            return 0
        stack.ends = error.value
        return 1

    def install(self) -> None:
        """Replace the functions for threads in `threading` and other modules by these."""
        import _threading_local

        replaced: tuple[tuple[Any, str, Any], ...] = (
            (threading, "_start_joinable_thread", self.begin),
            (threading, "_ThreadHandle", lambda: _Handle(self)),
            (threading, "_allocate_lock", lambda: Lock(self)),
            (threading, "Lock", lambda: Lock(self)),
            (threading, "_CRLock", lambda: RLock(self)),
            (_threading_local, "RLock", lambda: RLock(self)),
            (threading, "local", _threading_local.local),
            (threading, "get_ident", self.get_ident),
            (threading, "get_native_id", self.get_ident),
            (time, "sleep", self.sleep),
            (sys, "_current_frames", self.current_frames),
            (ctypes.pythonapi, "PyThreadState_SetAsyncExc", self.raise_in),
        )
        for module, name, ours in replaced:
            setattr(module, name, ours)

    # -- slices of time ------------------------------------------------------------------------------------------------

    def slice_time(self, is_users: Callable[[CodeType], bool]) -> None:
        """Make code of the user yield at its loops and calls when its slice is over. For Python 3.12 or later.

        Errors for a thread (`raise_in`) are also raised at these points. No ``except`` around the loop in the same
        function catches them, so they end even a loop that catches everything.
        """
        monitoring: Any = sys.monitoring  # type: ignore[attr-defined,unused-ignore]
        jump, start = monitoring.events.JUMP, monitoring.events.PY_START
        left = every = 1

        def on_step(_: CodeType, *__: int) -> None:
            # The clock is read less often if steps are short.
            nonlocal left, every
            left -= 1
            if left:
                return
            if time.monotonic() < self._slice_end:
                left = every = min(2 * every, _MOST_STEPS)
            else:
                left = every = 1
                self._give_way()

        def on_start(code: CodeType, offset: int) -> Any:
            if not monitoring.get_local_events(_TOOL, code):
                if not is_users(code):
                    return monitoring.DISABLE  # permanently, so it costs nothing from now on
                monitoring.set_local_events(_TOOL, code, jump)
            return on_step(code, offset)

        monitoring.use_tool_id(_TOOL, "robowidgets")
        monitoring.register_callback(_TOOL, jump, on_step)
        monitoring.register_callback(_TOOL, start, on_start)
        monitoring.set_events(_TOOL, start)
        frame: FrameType | None = sys._getframe()
        while frame is not None:  # a cell may go on to compute after its import of robowidgets
            if is_users(frame.f_code):
                monitoring.set_local_events(_TOOL, frame.f_code, jump)
            frame = frame.f_back

    def _give_way(self) -> None:
        me = self._now
        # The garbage collector may call a function of the user while this stack is being suspended.
        if self._host.can_wait() and me not in self._aside:
            # A delay above 0: Firefox runs no timers while callbacks are due at once, which they would always be.
            self.block(0.001)
            if me.ident == self._main:
                self._on_long(time.monotonic() - me.computes_since)
        self._slice_end = time.monotonic() + SLICE
        if me.ends is not None:
            ends, me.ends = me.ends, None
            raise ends


class Lock:
    """A lock like `threading.Lock`."""

    def __init__(self, threads: StackThreads) -> None:
        self._threads = threads
        self._waiters: deque[asyncio.Future[None]] = deque()
        self._is_held = False

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """See `threading.Lock`."""
        if not blocking and timeout != -1:
            raise ValueError("can't specify a timeout for a non-blocking call")
        if timeout < 0 and timeout != -1:
            raise ValueError("timeout value must be a non-negative number")
        if self._is_held and blocking and timeout:
            end = None if timeout == -1 else time.monotonic() + timeout
            while self._is_held and (end is None or time.monotonic() < end):
                self._threads.block(None if end is None else end - time.monotonic(), self._waiters)
            self._threads.current.computes_since = time.monotonic()
        if self._is_held:
            return False
        self._is_held = True
        return True

    def release(self) -> None:
        """See `threading.Lock`."""
        if not self._is_held:
            raise RuntimeError("release unlocked lock")
        self._is_held = False
        wake_one(self._waiters)

    def locked(self) -> bool:
        """See `threading.Lock`."""
        return self._is_held

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        self.__init__(self._threads)  # type: ignore[misc]


class RLock:
    """A lock like `threading.RLock`. Its owner is a stack: callbacks of the event loop share a thread, not a stack."""

    def __init__(self, threads: StackThreads) -> None:
        self._threads, self._lock = threads, Lock(threads)
        self._owner: _Stack | None = None
        self._count = 0

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """See `threading.RLock`."""
        if self._owner is self._threads.current:
            self._count += 1
        elif self._lock.acquire(blocking, timeout):
            self._owner, self._count = self._threads.current, 1
        else:
            return False
        return True

    def release(self) -> None:
        """See `threading.RLock`."""
        if not self._is_owned():
            raise RuntimeError("cannot release un-acquired lock")
        self._count -= 1
        if not self._count:
            self._owner = None
            self._lock.release()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()

    # For `threading.Condition`.

    def _is_owned(self) -> bool:
        return self._owner is self._threads.current

    def _release_save(self) -> tuple[int, _Stack | None]:
        saved, self._count, self._owner = (self._count, self._owner), 0, None
        self._lock.release()
        return saved

    def _acquire_restore(self, saved: tuple[int, _Stack | None]) -> None:
        self._lock.acquire()
        self._count, self._owner = saved

    def _at_fork_reinit(self) -> None:
        self.__init__(self._threads)  # type: ignore[misc]


class _Handle:
    """The handle of a `Thread` for the thread below it, like `_thread._ThreadHandle`."""

    def __init__(self, threads: StackThreads) -> None:
        self.ident = 0
        self._running = Lock(threads)
        self._running.acquire()

    def is_done(self) -> bool:
        return not self._running.locked()

    def end(self) -> None:
        self._running.release()

    def join(self, timeout: float | None = None) -> None:
        # Only joining threads take this lock, one after the other.
        if self._running.acquire(timeout=-1 if timeout is None else timeout):
            self._running.release()


def wake_one(waiters: deque[asyncio.Future[None]]) -> None:
    """Wake the first waiter."""
    while waiters:
        woken = waiters.popleft()
        if not woken.done():
            woken.set_result(None)
            return


def _wake(woken: asyncio.Future[None]) -> None:
    if not woken.done():
        woken.set_result(None)

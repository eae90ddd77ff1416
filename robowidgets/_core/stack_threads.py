"""Threads where Python has none: each is a stack of its own, which gives way where it waits.

In a browser Python has one thread, but WebAssembly can put a stack aside while the event loop goes on (JSPI). So a
thread is a call that the loop begins, and whatever waits there lets the loop begin or resume others. The functions of a
user may compute without waiting: they give way at their loops and calls, when their slice of time is over. What is
started, joined, locked and waited for is that of `threading`, as ever: only what is below that is replaced.
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
"""Seconds that a function of a user may compute before it gives way."""

_MOST_STEPS = 256
"""Turns of loops, and calls, between two looks at the clock."""

_TOOL = 3
"""Of `sys.monitoring`: the first that Python leaves to anybody."""

_NO_WAIT = (
    "cannot wait here: the browser cannot put this call aside. "
    "What a button of the page calls must not wait; a cell, a program and a connected function may"
)


class Host(Protocol):
    """What has an event loop, and can put stacks aside."""

    loop: asyncio.AbstractEventLoop
    can_switch: bool
    """Whether it can put stacks aside at all. Else threads begin, but never run."""

    def can_wait(self) -> bool:
        """Whether the calling stack can be put aside."""
        ...

    def wait(self, awaitable: Awaitable[Any]) -> Any:
        """Put the calling stack aside until this is done."""
        ...


class _Stack:
    """A stack of calls: of a thread, or of what the event loop calls, which is the main thread.

    Attributes:
        ends: what is raised in it when it goes on.
        computes_since: when it last waited.
    """

    def __init__(self, ident: int) -> None:
        self.ident = ident
        self.ends: type[BaseException] | None = None
        self.computes_since = time.monotonic()


class _SeenFrame(NamedTuple):
    """A frame of a stack, as it was when that was put aside: what is around it is then elsewhere in memory."""

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
        host: puts stacks aside.
        on_long: called with the seconds when the main thread has computed for a slice, and not waited for as long.
    """

    def __init__(self, host: Host, on_long: Callable[[float], None] = lambda _: None) -> None:
        self._host, self._on_long = host, on_long
        self._main = threading.main_thread().ident or 0
        self._idents = itertools.count(self._main + 1)
        self._now = _Stack(self._main)
        """The stack that runs. It is never one that is put aside."""
        self._aside: dict[_Stack, _SeenFrame | None] = {}
        self._begun: dict[int, _Stack] = {}
        self._slice_end = 0.0
        self._sleep = time.sleep

    # -- waiting -------------------------------------------------------------------------------------------------------

    @property
    def current(self) -> _Stack:
        """The stack that runs."""
        return self._now

    def block(self, seconds: float | None, waiters: deque[asyncio.Future[None]] | None = None) -> None:
        """Let others run until one of them wakes these waiters, or for some seconds; None: however long that takes.

        Raises:
            RuntimeError: the calling stack cannot be put aside.
        """
        if not self._host.can_wait():
            raise RuntimeError(_NO_WAIT)
        loop, me = self._host.loop, self._now
        self._aside[me] = _seen(sys._getframe(1))
        woken = loop.create_future()
        # A time from now, not a moment: that may be over before the loop is told of it.
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
        """As `time.sleep`."""
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        if not self._host.can_wait():
            self._sleep(seconds)  # that of Python, which holds up the others
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

    # -- what is below `threading` -------------------------------------------------------------------------------------

    def get_ident(self) -> int:
        """As `threading.get_ident`."""
        return self._now.ident

    def begin(self, function: Callable[[], object], handle: _Handle, daemon: bool = True) -> None:  # noqa: ARG002
        """Begin a thread. Its `Thread` need not wait for that."""
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
        """As `sys._current_frames`."""
        frames: dict[int, Any] = {self._now.ident: sys._getframe(1)}
        for stack, frame in self._aside.items():
            frames.setdefault(stack.ident, frame)
        return frames

    def raise_in(self, ident: ctypes.c_ulong, error: ctypes.py_object[type[BaseException]]) -> int:
        """As `PyThreadState_SetAsyncExc`: raise an error in a thread, when it next gives way or has slept."""
        stack = self._begun.get(ident.value)
        if stack is None:
            return 0
        stack.ends = error.value
        return 1

    def install(self) -> None:
        """Have `threading`, and what else is told of threads, use these."""
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
        """Have code of the user give way at its loops and calls when its slice is over. For Python 3.12 or later.

        What is raised in a thread is raised there, too. Python lets no ``except`` around a loop catch it, in the same
        function: so that ends a loop which catches all.
        """
        monitoring: Any = sys.monitoring  # type: ignore[attr-defined,unused-ignore]
        jump, start = monitoring.events.JUMP, monitoring.events.PY_START
        left = every = 1

        def on_step(_: CodeType, *__: int) -> None:
            # The clock is read less often where steps are short.
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
                    return monitoring.DISABLE  # for good: it costs nothing any more
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
        # The collector may call a function of the user while this stack is being put aside.
        if self._host.can_wait() and me not in self._aside:
            # By a timer: Firefox runs none while anything is due at once, which would be so all the time.
            self.block(0.001)
            if me.ident == self._main:
                self._on_long(time.monotonic() - me.computes_since)
        self._slice_end = time.monotonic() + SLICE
        if me.ends is not None:
            ends, me.ends = me.ends, None
            raise ends


class Lock:
    """As `threading.Lock`."""

    def __init__(self, threads: StackThreads) -> None:
        self._threads = threads
        self._waiters: deque[asyncio.Future[None]] = deque()
        self._is_held = False

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """As that of `threading.Lock`."""
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
        """As that of `threading.Lock`."""
        if not self._is_held:
            raise RuntimeError("release unlocked lock")
        self._is_held = False
        wake_one(self._waiters)

    def locked(self) -> bool:
        """As that of `threading.Lock`."""
        return self._is_held

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        self.__init__(self._threads)  # type: ignore[misc]


class RLock:
    """As `threading.RLock`. Its owner is a stack: those that the event loop calls are one thread, but two stacks."""

    def __init__(self, threads: StackThreads) -> None:
        self._threads, self._lock = threads, Lock(threads)
        self._owner: _Stack | None = None
        self._count = 0

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """As that of `threading.RLock`."""
        if self._owner is self._threads.current:
            self._count += 1
        elif self._lock.acquire(blocking, timeout):
            self._owner, self._count = self._threads.current, 1
        else:
            return False
        return True

    def release(self) -> None:
        """As that of `threading.RLock`."""
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
    """As `_thread._ThreadHandle`: what a `Thread` knows of the thread below it."""

    def __init__(self, threads: StackThreads) -> None:
        self.ident = 0
        self._running = Lock(threads)
        self._running.acquire()

    def is_done(self) -> bool:
        return not self._running.locked()

    def end(self) -> None:
        self._running.release()

    def join(self, timeout: float | None = None) -> None:
        # Nobody else takes this lock, and another one that joins takes it after this one.
        if self._running.acquire(timeout=-1 if timeout is None else timeout):
            self._running.release()


def wake_one(waiters: deque[asyncio.Future[None]]) -> None:
    """Wake the first that waits."""
    while waiters:
        woken = waiters.popleft()
        if not woken.done():
            woken.set_result(None)
            return


def _wake(woken: asyncio.Future[None]) -> None:
    if not woken.done():
        woken.set_result(None)

"""Stacks that are put aside, as in a browser, emulated in CPython: threads that hand over, so that only one runs."""

from __future__ import annotations

import _thread
import asyncio
from collections.abc import Awaitable, Callable
from typing import Any


class BatonHost:
    """See `robowidgets.runtime.stack_threads.Host`."""

    can_switch = True

    def __init__(self) -> None:
        self.loop = _Loop(self)
        self._main = _thread.get_ident()
        self._back = _thread.allocate_lock()
        self._back.acquire()
        self._idle: list[tuple[_thread.LockType, list[Any]]] = []
        """Threads without a stack: the events that wake each, and its function."""

    def can_wait(self) -> bool:
        return _thread.get_ident() != self._main

    def wait(self, awaitable: Awaitable[Any]) -> Any:
        mine = _thread.allocate_lock()
        mine.acquire()
        future = asyncio.ensure_future(awaitable, loop=self.loop)
        future.add_done_callback(_Resume(self, mine))
        task = asyncio.tasks._swap_current_task(self.loop, None)  # type: ignore[attr-defined]
        self._back.release()
        mine.acquire()
        asyncio.tasks._swap_current_task(self.loop, task)  # type: ignore[attr-defined]
        return future.result()

    def call(self, callback: Any, *args: Any) -> None:
        """Call a function on a stack of its own, until it returns or waits."""
        if not self._idle:
            self._idle.append((_thread.allocate_lock(), []))
            self._idle[0][0].acquire()
            _thread.start_new_thread(self._run, self._idle[0])
        woken, job = self._idle.pop()
        job[:] = [callback, *args]
        self.hand_to(woken.release)

    def run(self, main: Callable[[], object]) -> None:
        """Call a function on a stack that can be put aside, and the loop until that returns or raises."""
        raised: list[BaseException] = []

        def until_over() -> None:
            try:
                main()
            except BaseException as error:
                raised.append(error)
            self.loop.stop()

        self.loop.call_soon(until_over)
        self.loop.run_forever()
        if raised:
            raise raised[0]

    def hand_to(self, go: Callable[[], object]) -> None:
        """Continue a stack, until it returns or waits. Called by the loop."""
        go()
        self._back.acquire()

    def _run(self, woken: _thread.LockType, job: list[Any]) -> None:
        asyncio._set_running_loop(self.loop)
        while True:
            woken.acquire()
            try:
                job[0](*job[1:])
            finally:
                self._idle.append((woken, job))
                self._back.release()


class _Resume:
    def __init__(self, host: BatonHost, stack: _thread.LockType) -> None:
        self._host, self._stack = host, stack

    def __call__(self, _: Any) -> None:
        self._host.hand_to(self._stack.release)


class _Loop(asyncio.SelectorEventLoop):
    """Calls each callback on a stack of its own, as the loop of Pyodide does."""

    def __init__(self, host: BatonHost) -> None:
        super().__init__()
        self._host = host

    def call_soon(self, callback: Any, *args: Any, context: Any = None) -> Any:
        if isinstance(callback, _Resume):
            return super().call_soon(callback, *args, context=context)
        return super().call_soon(self._host.call, callback, *args, context=context)

    def call_later(self, delay: float, callback: Any, *args: Any, context: Any = None) -> Any:
        if delay < 0:
            raise ValueError("Can't schedule in the past")  # as unforgiving as the loop of Pyodide
        return super().call_at(self.time() + delay, self._host.call, callback, *args, context=context)

    def call_at(self, when: float, callback: Any, *args: Any, context: Any = None) -> Any:
        return self.call_later(when - self.time(), callback, *args, context=context)

    def call_from_page(self, callback: Callable[[], object]) -> None:
        """Call a function on a stack that cannot be put aside."""
        super().call_soon(callback)

"""Threads on stacks that are put aside: in CPython, by threads that hand over to each other, and in a browser.

Each case is called with the threads that are installed, and a function that calls another one on a stack that cannot be
put aside, as the page does.
"""

from __future__ import annotations

import asyncio
import ctypes
import itertools
import sys
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from typing import Any

CASES: dict[str, Callable[..., None]] = {}


def case(function: Callable[..., None]) -> Callable[..., None]:
    CASES[function.__name__] = function
    return function


def run(names: list[str], threads: Any, call_from_page: Any) -> dict[str, str]:
    """Return the failures by the name of the case; a case that passes has none."""
    told = {}
    for name in names:
        told[name] = ""
        try:
            CASES[name](threads, call_from_page)
        except BaseException:
            told[name] = traceback.format_exc()
    return told


def began(*functions: Callable[[], object]) -> list[threading.Thread]:
    """Threads that run these functions."""
    started = [threading.Thread(target=function, daemon=True) for function in functions]
    for thread in started:
        thread.start()
    return started


class Pushed:
    """Within it, the clock advances by an hour at each reading: every wait is over when the loop hears of it."""

    def __init__(self, threads: Any) -> None:
        self.threads = threads

    def __enter__(self) -> None:
        self.real = time.monotonic
        time.monotonic = itertools.count(self.real(), 3600.0).__next__  # type: ignore[assignment]  # no code of ours

    def __exit__(self, *_: object) -> None:
        time.monotonic = self.real
        self.threads._slice_end = 0.0
        self.threads.current.computes_since = time.monotonic()


@case
def threads_take_turns_where_they_sleep_and_join_waits_for_them(threads: Any, call_from_page: Any) -> None:
    done: list[str] = []

    def count(name: str, other: str) -> None:
        for number in range(3):
            done.append(f"{name}{number}")
            while f"{other}{number}" not in done:
                time.sleep(0.002)

    started = began(lambda: count("a", "b"), lambda: count("b", "a"))
    assert all(thread.is_alive() for thread in started)
    assert set(started) < {*threading.enumerate()}
    for thread in started:
        thread.join()
    assert [sorted(done[i : i + 2]) for i in (0, 2, 4)] == [["a0", "b0"], ["a1", "b1"], ["a2", "b2"]], done
    assert not any(thread.is_alive() for thread in started)
    assert threading.enumerate() == [threading.main_thread()]


@case
def a_thread_knows_itself_and_has_values_of_its_own(threads: Any, call_from_page: Any) -> None:
    local = threading.local()
    seen: dict[str, Any] = {}

    def note(name: str) -> None:
        local.name = name
        time.sleep(0.005)
        seen[name] = (local.name, threading.current_thread().name, threading.get_ident())

    local.name = "main"
    started = [threading.Thread(target=note, args=(name,), name=name) for name in "ab"]
    for thread in started:
        thread.start()
    for thread in started:
        thread.join()
    assert seen == {thread.name: (thread.name, thread.name, thread.ident) for thread in started}
    assert local.name == "main"
    assert threading.current_thread() is threading.main_thread()


@case
def a_lock_is_held_by_one_and_goes_to_those_that_wait_in_their_order(threads: Any, call_from_page: Any) -> None:
    lock, order = threading.Lock(), []

    def take(name: str) -> None:
        with lock:
            order.append(name)
            time.sleep(0.002)
            order.append(name)

    with lock:
        assert not lock.acquire(blocking=False)
        assert not lock.acquire(timeout=0.01)
        started = began(*(lambda name=name: take(name) for name in "abc"))
        time.sleep(0.01)
        assert order == []
    for thread in started:
        thread.join()
    assert order == ["a", "a", "b", "b", "c", "c"]
    assert not lock.locked()


@case
def an_rlock_belongs_to_the_stack_that_took_it(threads: Any, call_from_page: Any) -> None:
    lock, got = threading.RLock(), []
    with lock, lock:
        (thread,) = began(lambda: got.append(lock.acquire(timeout=0.005)))
        # Another call of the event loop is the same thread as this one, but must not run in between.
        threads._host.loop.call_soon(lambda: got.append(lock.acquire(blocking=False)))
        thread.join()
        assert got == [False, False], got
    (thread,) = began(lambda: got.append(lock.acquire()) or lock.release())
    thread.join()
    assert got[2:] == [True]


@case
def a_condition_wakes_who_waits_and_says_when_the_time_came_first(threads: Any, call_from_page: Any) -> None:
    lock = threading.RLock()
    changed, woken = threading.Condition(lock), []

    def wait() -> None:
        with lock:
            woken.append(changed.wait(240))

    started = began(wait, wait)
    time.sleep(0.005)
    with lock:
        changed.notify_all()
        assert woken == []
    for thread in started:
        thread.join()
    assert woken == [True, True]
    with lock:
        assert not changed.wait(0.005)
    event = threading.Event()
    assert not event.wait(0.005)
    threading.Timer(0.005, event.set).start()
    assert event.wait(240)


@case
def a_wait_whose_time_is_over_before_the_loop_knows_of_it_is_over(threads: Any, call_from_page: Any) -> None:
    lock = threading.Lock()
    lock.acquire()
    with Pushed(threads):
        time.sleep(0.001)
        assert not lock.acquire(timeout=0.001)
        assert not threading.Event().wait(0.001)

    async def late() -> str:
        try:
            await asyncio.wait_for(asyncio.Event().wait(), 0.001)
        except asyncio.TimeoutError:
            return "late"
        return "?"

    called: list[str] = []
    host = threads._host
    host.loop.call_at(host.loop.time() - 5.0, called.append, "at once")
    assert host.wait(late()) == "late"
    assert called == ["at once"]


@case
def an_error_in_a_thread_is_told_and_ends_no_other(threads: Any, call_from_page: Any) -> None:
    told, done = [], []
    hook, threading.excepthook = threading.excepthook, lambda args: told.append(repr(args.exc_value))
    try:
        started = began(lambda: 1 / 0, lambda: time.sleep(0.002) or done.append(1))
        for thread in started:
            thread.join()
    finally:
        threading.excepthook = hook
    assert told == ["ZeroDivisionError('division by zero')"]
    assert done == [1]


@case
def loops_and_calls_that_never_wait_give_way_and_are_ended(threads: Any, call_from_page: Any) -> None:
    alive, ended = [True], []

    def spin() -> None:
        while alive:
            pass

    def recur(depth: int = 0) -> None:
        if depth < 20 and alive:
            recur(depth + 1)
            recur(depth + 1)

    def compute() -> None:
        while True:
            with suppress(BaseException):
                alive.append(True)
                while True:
                    pass

    def swallow() -> None:
        try:
            compute()
        except BaseException as error:
            ended.append(repr(error))

    started = began(spin, recur, swallow)
    while len(alive) < 2:
        time.sleep(0.001)  # returns, though three compute
    frame = sys._current_frames()[started[0].ident]
    assert spin.__code__ in [frame.f_code for frame, _ in traceback.walk_stack(frame)]
    thread = started[2]
    assert ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident), ctypes.py_object(SystemExit)) == 1
    thread.join(240)
    assert not thread.is_alive()
    assert ended == ["SystemExit()"]
    alive.clear()
    for thread in started:
        thread.join(240)
    assert not any(thread.is_alive() for thread in started)
    assert ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident), ctypes.py_object(SystemExit)) == 0


@case
def one_that_sleeps_in_a_loop_is_ended_after_its_sleep(threads: Any, call_from_page: Any) -> None:
    def doze() -> None:
        while True:
            time.sleep(0.001)

    (thread,) = began(doze)
    time.sleep(0.005)
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident), ctypes.py_object(SystemExit))
    thread.join(240)
    assert not thread.is_alive()


@case
def code_of_others_is_not_sliced(threads: Any, call_from_page: Any) -> None:
    from robowidgets.notebook.in_browser import is_users

    codes = [function.__code__ for function in (asyncio.wait_for, threading.Thread.start, type(threads).block)]
    codes += [type(threads._host.loop).call_later.__code__] * (sys.platform == "emscripten")
    assert not any(map(is_users, codes))
    space: dict[str, Any] = {}
    exec(compile("def count():\n    for n in range(300_000): pass", "<frozen library>", "exec"), space)
    moved: list[int] = []
    (thread,) = began(lambda: moved.append(1))
    space["count"]()
    assert moved == []
    thread.join()


@case
def what_the_page_calls_cannot_wait_and_says_so(threads: Any, call_from_page: Any) -> None:
    lock, told = threading.Lock(), []
    lock.acquire()

    def handler() -> None:
        try:
            lock.acquire(timeout=1)
        except RuntimeError as error:
            told.append(str(error))
        for _ in range(100):  # no error if its slice is over
            threads._slice_end = 0.0
        time.sleep(0.001)
        threading.Thread(target=told.append, args=("began",)).start()

    call_from_page(handler)
    while len(told) < 2:
        time.sleep(0.001)
    assert told[0].startswith("cannot wait here: the browser cannot put this call aside."), told
    assert told[1] == "began"


@case
def a_cell_that_computes_for_long_is_told_once(threads: Any, call_from_page: Any) -> None:
    told: list[float] = []
    before, threads._on_long = threads._on_long, told.append
    try:
        while max(told, default=0.0) < 0.05:
            pass
    finally:
        threads._on_long = before
    since = threads.current.computes_since
    time.sleep(0.001)
    assert threads.current.computes_since >= since + 0.05, "a wait begins another count"


if __name__ == "__main__":  # in CPython: prints the failures
    import json
    from pathlib import Path
    from types import ModuleType

    root = Path(__file__).parents[1]
    sys.path.insert(0, str(root))
    # Without the rest of the package, which takes longer to import than the cases take.
    sys.modules["robowidgets"] = ModuleType("robowidgets")
    sys.modules["robowidgets"].__path__ = [str(root / "robowidgets")]
    from robowidgets.notebook.in_browser import clamp_timers, is_users
    from robowidgets.runtime.stack_threads import StackThreads
    from tests.unit import baton_host

    host = baton_host.BatonHost()
    clamp_timers(type(host.loop))
    installed = StackThreads(host)
    installed.install()
    installed.slice_time(lambda code: is_users(code) and code.co_filename != baton_host.__file__)
    results: dict[str, str] = {}
    host.run(lambda: results.update(run(list(CASES), installed, host.loop.call_from_page)))
    sys.stdout.write(json.dumps(results))

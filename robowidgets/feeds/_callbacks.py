"""The connected functions of a program, and the thread that calls them."""

from __future__ import annotations

import logging
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from types import FunctionType
from typing import Any

from .._core.cells import running_cell
from .._core.log_once import LogOnce
from .._core.pacer import pacer
from .._core.tables import Table
from .._core.text import many
from .._core.user_function import line_of, name_of
from .._core.user_threads import UserThread, frames_of
from ..samples import HasAge
from ._topics import Topic, queue_length, sample_of

log = logging.getLogger("robowidgets")

SLOW = 1.0
"""Seconds after which a function that has not returned is named on the widgets."""

CLOSING = 0.2
"""Seconds for which closing waits for a running function."""


class Function:
    """A function that is connected to a topic.

    Attributes:
        runs: the number of calls.
        error: the error of the last call, with its line; empty when the call returned.
        entered: the time of the running call; None while it is not running.
    """

    def __init__(self, topic: str, call: Callable[[Any], object], raw: bool) -> None:
        self.topic, self.call, self.raw = topic, call, raw
        self.cell, self.run = running_cell()
        self.runs = 0
        self.error = ""
        self.entered: float | None = None

    @property
    def name(self) -> str:
        """Its name, for a person."""
        return name_of(self.call)

    def takes(self, topic: str, calls: Sequence[Any] | None) -> bool:
        """Whether it takes a message of a topic that is for these functions; None: for all."""
        return self.topic == topic and (calls is None or self.call in calls)

    def replaces(self, other: Function) -> bool:
        """Whether it replaces another: one from an earlier run of its cell, or one that had its name before."""
        if self.cell and self.cell == other.cell and self.run != other.run:
            return True
        return self.topic == other.topic and _full_name(self.call) == _full_name(other.call) != ""


class FunctionCaller:
    """Calls functions with the newest message of their topics, one at a time, in a thread of its own.

    Of some kinds, such as touch sensors, every message counts. A function that is disconnected while it runs is
    abandoned: another thread calls the other functions.

    Args:
        on_change: called with a topic whose `status_of` has changed.
    """

    def __init__(self, on_change: Callable[[str], None]) -> None:
        self._on_change = on_change
        self._lock = threading.RLock()
        self._changed = threading.Condition(self._lock)
        self._functions: list[Function] = []
        self._waiting: dict[str, deque[tuple[Any, Topic, Sequence[Any] | None, float]]] = {}
        """By topic, messages with the functions that they are for and the time at which they came."""
        self._thread: UserThread | None = None
        self._current: Function | None = None
        self._slow_topic = ""
        """The topic whose widgets show that a function has not returned."""
        self._closed = False
        self._log = LogOnce(log.exception)

    @property
    def functions(self) -> tuple[Function, ...]:
        """The functions that are connected now."""
        return tuple(self._functions)

    def table(self) -> Table:
        """Each function with its topic, its number of runs, and its last error."""
        rows = [(f.name, f.topic, str(f.runs), f.error) for f in self._functions]
        slow = [status for f in self._functions if (status := self._status(f)) and status != f.error]
        heads = ("function", "topic", "runs", "last error")
        return Table(many(len(rows), "connected function"), heads, rows, right=(2,), problems=slow)

    def connect(self, topic: str, calls: Iterable[Callable[[Any], object]], raw: bool) -> None:
        """Call functions with the messages of a topic; they replace those that `Function.replaces` names."""
        for call in calls:
            new = Function(topic, call, raw)
            with self._lock:
                same = [old for old in self._functions if (old.topic, old.call, old.raw) == (topic, call, raw)]
                if same:  # by the newest run of its cell, so that what else this run connects does not replace it
                    same[0].cell, same[0].run = new.cell, new.run
                    continue
                self._drop([old for old in self._functions if new.replaces(old)])
                self._functions.append(new)

    def disconnect(self, topic: str, calls: Iterable[Any] | None) -> None:
        """Call these functions, and others of their names, no more with messages of a topic; None: all functions."""
        gone = None if calls is None else list(calls)
        names = {_full_name(call) for call in gone or ()} - {""}
        with self._lock:
            here = [function for function in self._functions if function.topic == topic]
            self._drop([f for f in here if gone is None or f.call in gone or _full_name(f.call) in names])

    def put(self, topic: Topic, message: Any, calls: Sequence[Any] | None = None) -> None:
        """Queue a message for these functions, None: all; it replaces a queued one, unless every message counts."""
        with self._lock:
            if self._closed or not any(function.takes(topic.name, calls) for function in self._functions):
                return
            waiting = self._waiting.setdefault(topic.name, deque(maxlen=queue_length(topic.type)))
            waiting.append((message, topic, calls, time.monotonic()))
            if self._thread is None:
                self._start()
            self._changed.notify()

    def status_of(self, topic: str) -> str:
        """A text that names the functions of a topic that have not returned or have raised; empty if there are none."""
        return "; ".join(filter(None, (self._status(f) for f in self.functions if f.topic == topic)))

    def close(self) -> None:
        """Call no function any more; waits a moment for one that is running."""
        with self._lock:
            self._closed = True
            self._changed.notify_all()
            thread = self._thread
        pacer.forget(self)
        if thread is not None and thread is not threading.current_thread():
            thread.join(CLOSING)

    def send_newest(self) -> int:
        """Update the seconds for which a function has not returned. The pacer calls it."""
        current, before = self._current, self._slow_topic
        entered = current.entered if current is not None else None
        is_slow = entered is not None and time.monotonic() - entered >= SLOW
        self._slow_topic = current.topic if current is not None and is_slow else ""
        for topic in {before, self._slow_topic} - {""}:
            self._on_change(topic)
        with self._lock:
            if self._thread is not None and not self._closed:
                pacer.mark_at(self, time.monotonic() + SLOW)
        return 0

    def _status(self, function: Function) -> str:
        entered = function.entered
        passed = time.monotonic() - entered if entered is not None else 0.0
        if passed < SLOW:
            return function.error
        where = line_of(function.call, frames_of(self._thread))
        return f"your function `{function.name}`{where}, has not returned for {passed:.0f} s"

    def _drop(self, gone: list[Function]) -> None:
        self._functions = [function for function in self._functions if function not in gone]
        topics = {function.topic for function in self._functions}
        for topic in self._waiting.keys() - topics:
            del self._waiting[topic]
        if self._current in gone and self._thread is not None and self._thread is not threading.current_thread():
            self._thread.abandon()
            self._thread = self._current = None
            if self._waiting:
                self._start()

    def _start(self) -> None:
        self._thread = UserThread(self._run, "robowidgets-functions")
        self._thread.start()
        pacer.mark_at(self, time.monotonic() + SLOW)

    def _run(self) -> None:
        me = threading.current_thread()
        while True:
            with self._lock:
                while self._thread is me and not self._closed and not self._waiting:
                    self._changed.wait()
                if self._thread is not me or self._closed:
                    return
                name = next(iter(self._waiting))
                waiting = self._waiting.pop(name)
                message, topic, calls, came_at = waiting.popleft()
                if waiting:  # after the other topics
                    self._waiting[name] = waiting
                functions = [function for function in self._functions if function.takes(name, calls)]
            before = self.status_of(name)
            for function in functions:
                with self._lock:
                    if self._thread is not me or self._closed:
                        return
                    if function not in self._functions:
                        continue
                    self._current = function
                self._call(function, message, topic, came_at)
                with self._lock:
                    if self._thread is not me:
                        return
                    self._current = None
            if self.status_of(name) != before:
                self._on_change(name)

    def _call(self, function: Function, message: Any, topic: Topic, came_at: float) -> None:
        try:
            sample = message if function.raw else sample_of(message, topic)
            if not function.raw and isinstance(sample, HasAge):
                sample._arrive(came_at)
        except (TypeError, ValueError) as error:
            function.error = f"a message of {function.topic} cannot be read for `{function.name}`: {error}"
            self._log(function.error)
            return
        function.entered = time.monotonic()
        try:
            function.call(sample)
        except BaseException as error:  # not even a SystemExit may end the thread that all functions share
            line = line_of(function.call, traceback.walk_tb(error.__traceback__))
            function.error = f"your function `{function.name}`{line}: {type(error).__name__}: {error}"
            self._log(function.error)
        else:
            function.error = ""
        finally:
            function.entered = None
            function.runs += 1


def _full_name(call: Any) -> str:
    """The name, with its module, that the next version of a function has: of one defined outside of functions."""
    if not isinstance(call, FunctionType) or "<" in call.__qualname__:
        return ""
    return f"{call.__module__}.{call.__qualname__}"

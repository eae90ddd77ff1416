"""The connected functions of a program, and the thread that calls them."""

from __future__ import annotations

import logging
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextvars import copy_context
from types import FunctionType
from typing import Any
from weakref import WeakSet

from .._core.cells import CellRun, is_same_cell, on_cell_error, running_cell
from .._core.clock import Scheduler
from .._core.clock import scheduler as threads
from .._core.log_once import LogOnce
from .._core.policies import FUNCTION
from .._core.runner import Call, Runner
from .._core.short_traceback import without_our_frames
from .._core.tables import Table
from .._core.text import many
from .._core.user_function import line_of, name_of
from .._core.user_threads import MayDrive
from ..samples import HasAge
from ..samples.age import note_arrival
from ._topics import FeedTopic, queue_length, sample_of

log = logging.getLogger("robowidgets")

CLOSING = 0.2
"""Seconds for which closing waits for a running function."""

OFF = "its cell ended with an error; run the cell again, to its end"


class ConnectedFunction(MayDrive):
    """A function that is connected to a topic.

    Attributes:
        cell, run: the cell that connected it, and the run of that cell.
        context: that of this run: so what the function prints, and its errors, appear below the cell.
        runs: the number of calls.
        error: the error of the last call, with its line; empty when the call returned.
        entered: the time of the running call; None while it is not running.
    """

    def __init__(self, topic: str, call: Callable[[Any], object], raw: bool) -> None:
        super().__init__()
        self.topic, self.call, self.raw = topic, call, raw
        self.cell, self.run = running_cell()
        self.context = copy_context()
        self.runs = 0
        self.error = ""
        self.entered: float | None = None

    @property
    def name(self) -> str:
        """Its name, for a person."""
        return name_of(self.call)

    @property
    def is_off(self) -> bool:
        """Whether it is called no more, because it drives and may not."""
        return bool(self.refused and self.driven)

    @property
    def problem(self) -> str:
        """Why it is off, or the error of its last call; empty if there is none."""
        return f"your function `{self.name}` is off: {self.refused}" if self.is_off else self.error

    def takes(self, topic: str, calls: Sequence[Any] | None) -> bool:
        """Whether it takes a message of a topic that is for these functions; None: for all."""
        return self.topic == topic and (calls is None or self.call in calls)

    def replaces(self, other: ConnectedFunction) -> bool:
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

    def __init__(self, on_change: Callable[[str], None], scheduler: Scheduler = threads) -> None:
        self._on_change = on_change
        self._now = scheduler.clock.now
        self._lock = threading.RLock()
        self._runner = Runner(
            self._call_next,
            self._lock,
            "robowidgets-functions",
            FUNCTION,
            on_look=self._show_slow,
            scheduler=scheduler,
        )
        self._functions: list[ConnectedFunction] = []
        self._waiting: dict[str, deque[tuple[Any, FeedTopic, Sequence[Any] | None, float]]] = {}
        """By topic, messages with the functions that they are for and the time at which they came."""
        self._slow_topic = ""
        """The topic whose widgets show that a function has not returned."""
        self._closed = False
        self._log = LogOnce(log.error)
        _all.add(self)

    @property
    def functions(self) -> tuple[ConnectedFunction, ...]:
        """The functions that are connected now."""
        return tuple(self._functions)

    def table(self) -> Table:
        """Each function with its topic, its number of runs, and its last error."""
        rows = [(f.name, f.topic, str(f.runs), f.problem) for f in self._functions]
        slow = [status for f in self._functions if (status := self._status(f)) and status != f.problem]
        heads = ("function", "topic", "runs", "last error")
        return Table(many(len(rows), "connected function"), heads, rows, right=(2,), problems=slow)

    def connect(self, topic: str, calls: Iterable[Callable[[Any], object]], raw: bool) -> None:
        """Call functions with the messages of a topic; they replace those that `ConnectedFunction.replaces` names."""
        on_cell_error(_switch_off)
        for call in calls:
            new = ConnectedFunction(topic, call, raw)
            with self._lock:
                same = [old for old in self._functions if (old.topic, old.call, old.raw) == (topic, call, raw)]
                if same:  # by the newest run of its cell, so that what else this run connects does not replace it
                    same[0].cell, same[0].run, same[0].refused = new.cell, new.run, ""
                    same[0].context = new.context
                    continue
                replaced = [old for old in self._functions if new.replaces(old)]
                # Of a new version it is known what it drives before its first call.
                new.driven = next((old.driven for old in replaced if old.name == new.name), ())
                self._drop(replaced)
                self._functions.append(new)

    def disconnect(self, topic: str, calls: Iterable[Any] | None) -> None:
        """Call these functions, and others of their names, no more with messages of a topic; None: all functions."""
        gone = None if calls is None else list(calls)
        names = {_full_name(call) for call in gone or ()} - {""}
        with self._lock:
            here = [function for function in self._functions if function.topic == topic]
            self._drop([f for f in here if gone is None or f.call in gone or _full_name(f.call) in names])

    def switch_off(self, cell: CellRun) -> list[ConnectedFunction]:
        """Have the functions that a cell connected drive no more, and stop their robots; returns those that are off.

        Those that never drove are called as before.
        """
        with self._lock:
            there = () if self._closed else self._functions
            here = [function for function in there if is_same_cell((function.cell, function.run), cell)]
        for function in here:
            function.refused = OFF
        off = [function for function in here if function.is_off]
        for watchdog in {watchdog for function in off for watchdog in function.driven}:
            watchdog.stop_program()
        for topic in {function.topic for function in off}:
            self._on_change(topic)
        return off

    def put(self, topic: FeedTopic, message: Any, calls: Sequence[Any] | None = None) -> None:
        """Queue a message for these functions, None: all; it replaces a queued one, unless every message counts."""
        with self._lock:
            if self._closed or not any(function.takes(topic.name, calls) for function in self._functions):
                return
            waiting = self._waiting.setdefault(topic.name, deque(maxlen=queue_length(topic.type)))
            waiting.append((message, topic, calls, time.monotonic()))
            self._runner.wake()

    def status_of(self, topic: str) -> str:
        """A text that names the functions of a topic that have not returned or have raised; empty if there are none."""
        return "; ".join(filter(None, (self._status(f) for f in self.functions if f.topic == topic)))

    def close(self) -> None:
        """Call no function any more; waits a moment for one that is running."""
        with self._lock:
            self._closed = True
            left = self._runner.leave()
        if left is not None:
            left.join(CLOSING)

    def _show_slow(self) -> None:
        """Show the seconds for which a function has not returned, or that it has."""
        function, before = self._runner.current, self._slow_topic
        entered = function.entered if isinstance(function, ConnectedFunction) else None
        is_slow = entered is not None and self._now() - entered >= FUNCTION.late
        self._slow_topic = function.topic if isinstance(function, ConnectedFunction) and is_slow else ""
        for topic in {before, self._slow_topic} - {""}:
            self._on_change(topic)

    def _status(self, function: ConnectedFunction) -> str:
        entered = function.entered
        passed = self._now() - entered if entered is not None else 0.0
        if passed < FUNCTION.late:
            return function.problem
        where = self._runner.where(function.call)
        return f"your function `{function.name}`{where}, has not returned for {passed:.0f} s"

    def _drop(self, gone: list[ConnectedFunction]) -> None:
        self._functions = [function for function in self._functions if function not in gone]
        topics = {function.topic for function in self._functions}
        for topic in self._waiting.keys() - topics:
            del self._waiting[topic]
        if any(function is self._runner.current for function in gone):
            self._runner.leave()
            if self._waiting:
                self._runner.wake()

    def _call_next(self, call: Call) -> float | None:
        """Call the functions of the topic that has waited for longest, with its oldest message."""
        with self._lock:
            if self._closed or not self._waiting:
                return None
            name = next(iter(self._waiting))
            waiting = self._waiting.pop(name)
            message, topic, calls, came_at = waiting.popleft()
            if waiting:  # after the other topics
                self._waiting[name] = waiting
            functions = [function for function in self._functions if function.takes(name, calls)]
        before = self.status_of(name)
        for function in functions:
            if function in self._functions and not function.is_off and not self._closed:
                self._call(call, function, message, topic, came_at)
        if self.status_of(name) != before:
            self._on_change(name)
        return 0.0  # other messages may wait

    def _call(self, call: Call, function: ConnectedFunction, message: Any, topic: FeedTopic, came_at: float) -> None:
        try:
            sample = message if function.raw else sample_of(message, topic)
            if not function.raw and isinstance(sample, HasAge):
                note_arrival(sample, came_at)
        except (TypeError, ValueError) as error:
            function.error = f"a message of {function.topic} cannot be read for `{function.name}`: {error}"
            function.context.copy().run(self._log, function.error, exc_info=error)
            return
        function.entered, was_on = self._now(), not function.refused
        try:
            raised = call(function.context.copy().run, function.drive_by, function.call, sample, of=function).error
        finally:  # also where it was left
            function.entered = None
            function.runs += 1
        function.error = ""
        if raised is not None:
            line = line_of(function.call, traceback.walk_tb(raised.__traceback__))
            function.error = f"your function `{function.name}`{line}: {type(raised).__name__}: {raised}"
            if not (was_on and function.is_off):  # the cell names it that switched it off meanwhile
                with without_our_frames(raised) as shown:
                    function.context.copy().run(self._log, function.error, exc_info=shown)


_all: WeakSet[FunctionCaller] = WeakSet()


def _switch_off(cell: CellRun) -> list[str]:
    """Switch off what a cell that ended with an error connected; returns a line for each function that drove."""
    off = [function for caller in list(_all) for function in caller.switch_off(cell)]
    return [f"`{function.name}` ({function.topic}) is off, and its robot got zero: {OFF}" for function in off]


def _full_name(call: Any) -> str:
    """The name, with its module, that the next version of a function has: of one defined outside of functions."""
    if not isinstance(call, FunctionType) or "<" in call.__qualname__:
        return ""
    return f"{call.__module__}.{call.__qualname__}"

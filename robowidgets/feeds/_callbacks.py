"""The connected functions of a program, and the thread that calls them."""

from __future__ import annotations

import inspect
import logging
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextvars import copy_context
from functools import partial
from types import FunctionType
from typing import Any, NamedTuple
from weakref import WeakSet

from ..notebook.cells import CellRun, is_same_cell, on_cell_error, on_interrupt, running_cell
from ..runtime.clock import Scheduler
from ..runtime.clock import scheduler as threads
from ..runtime.inform import inform
from ..runtime.log_once import LogOnce, call_in_thread
from ..runtime.policies import FUNCTION
from ..runtime.runner import Call, Runner
from ..runtime.short_traceback import without_our_frames
from ..runtime.tables import Table
from ..runtime.text import many
from ..runtime.user_function import line_of, name_of
from ..runtime.user_threads import MayDrive
from ..samples import HasAge
from ..samples.age import note_arrival
from ._topics import FeedTopic, queue_length, sample_of
from .middleware import MOST_UNREAD

log = logging.getLogger("robowidgets")

CLOSING = 0.2
"""Seconds for which closing waits for a running function."""

OFF = "its cell ended with an error; run the cell again, to its end"
INTERRUPTED = "the kernel was interrupted; run its cell again"


class ConnectedFunction(MayDrive):
    """A function that is connected to a topic.

    Attributes:
        cell, run: the cell that connected it, and the run of that cell.
        context: the context of this run, so that the function's output and errors appear below the cell.
        runs: the number of calls.
        got, gave: the argument and the result of the last finished call, or None before the first.
        error: the error of the last call with its line, or empty if the call returned.
        entered: the time at which the running call began, or None while it is not running.
        each: True if it gets every message, False if it gets only the newest.
        missed: the number of messages that it did not get, although it gets every message.
        takes_time: True if it also gets the time of a message.
    """

    def __init__(self, topic: str, call: Callable[..., object], raw: bool, each: bool = False) -> None:
        super().__init__()
        self.topic, self.call, self.raw, self.each = topic, call, raw, each
        self.missed = 0
        self.takes_time = _takes_two(call)
        self.cell, self.run = running_cell()
        self.context = copy_context()
        self.runs = 0
        self.got: Any = None
        self.gave: Any = None
        self.error = ""
        self.entered: float | None = None

    @property
    def name(self) -> str:
        """Its name, for the user."""
        return name_of(self.call)

    @property
    def is_off(self) -> bool:
        """True if it is not called any more, because it drives and is not allowed to."""
        return bool(self.refused and self.driven)

    @property
    def problem(self) -> str:
        """The reason why it is off, or the error of its last call, or empty."""
        if self.is_off:
            return f"your function `{self.name}` is off: {self.refused}"
        missed = f"your function `{self.name}` did not get {many(self.missed, 'message')}, which came too fast"
        return "; ".join(filter(None, (self.error, missed if self.missed else "")))

    def takes(self, topic: str, calls: Sequence[Any] | None, *, each: bool) -> bool:
        """Return True if it gets a message of a topic that is for these functions, or for all functions if None.

        Args:
            topic: the topic.
            calls: the functions that the message is for.
            each: True for the functions that get every message, False for the functions that get the newest one.
        """
        return self.topic == topic and self.each is each and (calls is None or self.call in calls)

    def replaces(self, other: ConnectedFunction) -> bool:
        """Return True if it replaces another: from an earlier run of the same cell, or of the same name."""
        if self.cell and self.cell == other.cell and self.run != other.run:
            return True
        return self.topic == other.topic and _full_name(self.call) == _full_name(other.call) != ""


class _Message(NamedTuple):
    """A message that waits for functions, or for all functions of its topic if ``calls`` is not given.

    It arrived at ``came_at`` on the monotonic clock, and at ``time_ns`` in nanoseconds since the epoch.
    """

    message: Any
    topic: FeedTopic
    calls: Sequence[Any] | None
    came_at: float
    time_ns: int


class FunctionCaller:
    """A caller of functions with the newest message of their topics. It calls one at a time, in a thread.

    Some kinds, such as touch sensors, queue every message. A function that is disconnected while it runs is abandoned:
    another thread calls the other functions.

    Args:
        on_change: called with a topic whose `status_of` has changed.
        mounted: returns a sample with the angles of the robot.
    """

    def __init__(
        self,
        on_change: Callable[[str], None],
        scheduler: Scheduler = threads,
        *,
        mounted: Callable[[Any], Any] = lambda sample: sample,
    ) -> None:
        self._on_change, self._mounted = on_change, mounted
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
        self._waiting: dict[tuple[str, bool], deque[_Message]] = {}
        """By topic and `ConnectedFunction.each`, the messages that wait."""
        self._slow_topic = ""
        """The topic whose widgets show that a function has not returned yet."""
        self._closed = False
        self._log = LogOnce(log.error)
        _all.add(self)

    @property
    def functions(self) -> tuple[ConnectedFunction, ...]:
        """The functions that are connected now."""
        return tuple(self._functions)

    def table(self) -> Table:
        """Return the functions with their topics, numbers of runs, and last errors."""
        rows = [(f.name, f.topic, str(f.runs), f.problem) for f in self._functions]
        slow = [status for f in self._functions if (status := self._status(f)) and status != f.problem]
        heads = ("function", "topic", "runs", "last error")
        return Table(many(len(rows), "connected function"), heads, rows, right=(2,), problems=slow)

    def passes_each(self, topic: str) -> bool:
        """Return True if a function gets every message of a topic."""
        return any(function.topic == topic and function.each for function in self._functions)

    def connect(self, topic: str, calls: Iterable[Callable[..., object]], raw: bool, each: bool = False) -> None:
        """Call functions with the messages of a topic. They replace functions as `ConnectedFunction.replaces` says."""
        on_cell_error(_switch_off)
        on_interrupt(_interrupt_all)
        for call in calls:
            new = ConnectedFunction(topic, call, raw, each)
            how = (topic, call, raw, each)
            with self._lock:
                same = [old for old in self._functions if (old.topic, old.call, old.raw, old.each) == how]
                if same:  # assign it to this run of its cell, so that other functions of this run do not replace it
                    same[0].cell, same[0].run, same[0].refused = new.cell, new.run, ""
                    same[0].context = new.context
                    continue
                replaced = [old for old in self._functions if new.replaces(old)]
                # What the previous version drove is what the new version drives, until its first call.
                new.driven = next((old.driven for old in replaced if old.name == new.name), ())
                self._drop(replaced)
                self._functions.append(new)

    def disconnect(self, topic: str, calls: Iterable[Any] | None) -> None:
        """Stop calling these functions, and others of their names, for a topic; or all functions if None."""
        gone = None if calls is None else list(calls)
        names = {_full_name(call) for call in gone or ()} - {""}
        with self._lock:
            here = [function for function in self._functions if function.topic == topic]
            self._drop([f for f in here if gone is None or f.call in gone or _full_name(f.call) in names])

    def switch_off(self, cell: CellRun) -> list[ConnectedFunction]:
        """Stop the functions that a cell connected from driving, and stop their robots. Return the functions now off.

        Functions that never drove are still called.
        """
        with self._lock:
            there = () if self._closed else self._functions
            here = [function for function in there if is_same_cell((function.cell, function.run), cell)]
        off = _refuse(here, OFF)
        self._show(off)
        return off

    def interrupt(self) -> None:
        """Switch off all functions as `switch_off` does. A signal handler calls it, so it does not take the lock."""
        off = [] if self._closed else _refuse([one for one in self.functions if not one.is_off], INTERRUPTED)
        if off:
            call_in_thread(partial(self._report_interrupt, off))

    def _report_interrupt(self, off: list[ConnectedFunction]) -> None:
        self._show(off)
        for function in off:
            function.context.copy().run(inform, _off_line(function))

    def _show(self, changed: Sequence[ConnectedFunction]) -> None:
        for topic in {function.topic for function in changed}:
            self._on_change(topic)

    def put(
        self,
        topic: FeedTopic,
        message: Any,
        calls: Sequence[Any] | None = None,
        *,
        newest: bool = True,
        each: bool = True,
    ) -> None:
        """Queue a message for these functions, or for all if None. It replaces a queued one unless every one counts.

        Args:
            topic: its topic.
            message: the message.
            calls: the functions.
            newest: True to pass it to the functions that get the newest message.
            each: True to pass it to the functions that get every message.
        """
        came = _Message(message, topic, calls, time.monotonic(), time.time_ns())
        with self._lock:
            for of_each in (False, True):
                if (each if of_each else newest) and not self._closed:
                    self._put(came, each=of_each)

    def miss(self, topic: str, count: int) -> None:
        """Count messages that did not reach the functions of a topic that get every message."""
        with self._lock:
            for function in self._functions:
                if function.topic == topic and function.each:
                    function.missed += count
        self._on_change(topic)

    def _put(self, came: _Message, *, each: bool) -> None:
        takers = [function for function in self._functions if function.takes(came.topic.name, came.calls, each=each)]
        if not takers:
            return
        length = MOST_UNREAD if each else queue_length(came.topic.type)
        waiting = self._waiting.setdefault((came.topic.name, each), deque(maxlen=length))
        if each and len(waiting) == length:
            for function in takers:
                function.missed += 1
        waiting.append(came)
        self._runner.wake()

    def status_of(self, topic: str) -> str:
        """Return a text for the functions of a topic that have not returned or have raised an error, or empty."""
        return "; ".join(filter(None, (self._status(f) for f in self.functions if f.topic == topic)))

    def close(self) -> None:
        """Call no function any more. Wait a moment for a running function."""
        with self._lock:
            self._closed = True
            left = self._runner.detach()
        if left is not None:
            left.join(CLOSING)

    def _show_slow(self) -> None:
        """Show for how many seconds a function has not returned, or that it has returned."""
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
        taken = {(function.topic, function.each) for function in self._functions}
        for key in self._waiting.keys() - taken:
            del self._waiting[key]
        if any(function is self._runner.current for function in gone):
            self._runner.detach()
            if self._waiting:
                self._runner.wake()

    def _call_next(self, call: Call) -> float | None:
        """Call the functions of the topic that has waited longest, with its oldest message."""
        with self._lock:
            if self._closed or not self._waiting:
                return None
            key = name, each = next(iter(self._waiting))
            waiting = self._waiting.pop(key)
            came = waiting.popleft()
            if waiting:  # after the other topics
                self._waiting[key] = waiting
            functions = [function for function in self._functions if function.takes(name, came.calls, each=each)]
        before = self.status_of(name)
        for function in functions:
            if function in self._functions and not function.is_off and not self._closed:
                self._call(call, function, came)
        if self.status_of(name) != before:
            self._on_change(name)
        return 0.0  # other messages may wait

    def _call(self, call: Call, function: ConnectedFunction, came: _Message) -> None:
        try:
            sample = came.message if function.raw else self._mounted(sample_of(came.message, came.topic))
            if not function.raw and isinstance(sample, HasAge):
                note_arrival(sample, came.came_at)
        except (TypeError, ValueError) as error:
            function.error = f"a message of {function.topic} cannot be read for `{function.name}`: {error}"
            function.context.copy().run(self._log, function.error, exc_info=error)
            return
        function.entered, was_on = self._now(), not function.refused
        try:
            given = (sample, came.time_ns) if function.takes_time else (sample,)
            outcome = call(function.context.copy().run, function.drive_by, function.call, *given, of=function)
        finally:  # even if the function was detached
            function.entered = None
            function.runs += 1
        function.error, function.got, function.gave = "", sample, outcome.value
        raised = outcome.error
        if raised is not None:
            line = line_of(function.call, traceback.walk_tb(raised.__traceback__))
            function.error = f"your function `{function.name}`{line}: {type(raised).__name__}: {raised}"
            if not (was_on and function.is_off):  # else the cell that switched it off reports it
                with without_our_frames(raised) as shown:
                    function.context.copy().run(self._log, function.error, exc_info=shown)


_all: WeakSet[FunctionCaller] = WeakSet()


def _switch_off(cell: CellRun) -> list[str]:
    """Switch off the functions of a cell that ended with an error. Return a line for each function that drove."""
    off = [function for caller in list(_all) for function in caller.switch_off(cell)]
    return list(map(_off_line, off))


def _interrupt_all() -> None:
    for caller in list(_all):
        caller.interrupt()


def _refuse(functions: Sequence[ConnectedFunction], why: str) -> list[ConnectedFunction]:
    """Stop functions from driving, and stop the robots that they drive. Return the functions that are off now."""
    for function in functions:
        function.refused = why
    off = [function for function in functions if function.is_off]
    for watchdog in {watchdog for function in off for watchdog in function.driven}:
        watchdog.stop_program()
    return off


def _off_line(function: ConnectedFunction) -> str:
    return f"`{function.name}` ({function.topic}) is off, and its robot got zero: {function.refused}"


def _takes_two(call: Any) -> bool:
    """Return True if a function needs two arguments: a message and its time."""
    try:
        parameters = inspect.signature(call).parameters.values()
    except (TypeError, ValueError):  # some functions in C, such as `print`, have no signature
        return False
    places = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(one.kind in places and one.default is one.empty for one in parameters) == 2


def _full_name(call: Any) -> str:
    """Return the module and name of a function, which its next version shares; or empty for an inner function."""
    if not isinstance(call, FunctionType) or "<" in call.__qualname__:
        return ""
    return f"{call.__module__}.{call.__qualname__}"

"""Watching the steps of a program: each function that they call is rewritten once, and its notes are kept for views."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

from ...reasons.look import LookHooks, Note, Reasons
from ...reasons.looker import LineLooker
from ...reasons.places import FunctionSource
from ...reasons.rewriting import NoteCall, Notes, NotRewrittenError, Rewritten, function_in, rewritten
from ...runtime.policies import NO_RETURN
from ...runtime.user_threads import is_abandoned
from .noting import CallNotes, Notebook

MOST_STEPS = 600
"""Steps that are kept for a view that has not taken them yet."""
_MOST_FUNCTIONS = 200
"""Functions that are kept in their rewritten form."""
_MOST_CALLS = 50
"""Calls of one step that are kept."""
_SHOWN = (float, int, bool)
"""Types of arguments that are kept with a step."""


KeepInputs = Callable[[tuple[str, int], float, Callable[..., Any], Mapping[str, Any]], object]
"""Takes the name and the number of a version, the seconds of the program, the function and the arguments of a step."""


@dataclass(slots=True)
class WatchedCall:
    """One call of a function in a step.

    Attributes:
        source: of the function; without lines if it was not rewritten.
        notes: its notes, or None if it was not rewritten.
        why: the reason why it was not rewritten; empty if it was.
        error: the error that ended it, empty without one.
        error_line: the line in its file at which it ended, or None.
    """

    source: FunctionSource
    notes: CallNotes | None
    why: str = ""
    error: str = ""
    error_line: int | None = None


@dataclass(slots=True, eq=False)
class WatchedStep:
    """One step of a program.

    Attributes:
        program: the name of the program, and the number of its version.
        number: the number of the step.
        time: the seconds of the program.
        at: the monotonic time at which it began.
        calls: the calls of the user's functions, in their order.
        given: the numbers that the step got, with their parameters.
        returned_none: True if it returned None.
    """

    program: tuple[str, int]
    number: int
    time: float
    at: float
    calls: list[WatchedCall]
    given: list[tuple[str, Any]]
    returned_none: bool


class LineWatch:
    """Calls the rewritten functions of a program's steps, and keeps their notes.

    The thread of the program only appends to lists. Views read the notes in their own time.

    Attributes:
        is_on: True while a view exists.
    """

    def __init__(self) -> None:
        self.is_on = True
        self.newest: WatchedStep | None = None
        self.keep: KeepInputs | None = None
        """Keeps the inputs of each step, so that another version can be tried on them; None if no view asks for it."""
        self._views: list[deque[WatchedStep]] = []
        self._known: dict[tuple[int, bool], _Known] = {}
        """The functions of the running version, by their id, and True for events."""
        self._version: tuple[str, int] | None = None
        self._prepared: tuple[tuple[str, int] | None, dict[tuple[int, bool], _Known]] = None, {}
        """The next version, and its rewritten functions."""
        self._calls: list[WatchedCall] = []
        """The calls of the running step, and its thread."""
        self._thread = 0

    def add_view(self) -> deque[WatchedStep]:
        """Return a queue that gets each step from now on; the oldest are dropped if a view does not take them."""
        queue: deque[WatchedStep] = deque(maxlen=MOST_STEPS)
        self._views = [*self._views, queue]
        self.is_on = True
        return queue

    def remove_view(self, queue: deque[WatchedStep]) -> None:
        """Put no more steps into a queue."""
        self._views = [one for one in self._views if one is not queue]
        self.is_on = bool(self._views)
        if not self.is_on:  # a machine has it for longer
            self.newest, self._known, self._prepared = None, {}, (None, {})

    def prepare(self, program: tuple[str, int], function: Callable[..., Any]) -> None:
        """Rewrite the functions of a version before its first step, which a long source would make late.

        Args:
            program: its name, and the number of its version.
            function: the function, or the machine.
        """
        functions = function.functions if _calls_functions(function) else [(function, False)]  # type: ignore[attr-defined]
        self._prepared = program, {(id(one), event): _rewrite(one, is_event=event) for one, event in functions}

    def step(
        self,
        program: tuple[str, int],
        made_at: tuple[int, float],
        function: Callable[..., Any],
        values: Mapping[str, Any],
        *samples: Any,
    ) -> Any:
        """Make a step: call its function, or let a state machine call the functions of its active states.

        Args:
            program: its name, and the number of its version.
            made_at: the number of the step, and the seconds of the program.
            function: the function, or the machine.
            values: the arguments by name.
            samples: the arguments before them.
        """
        calls: list[WatchedCall] = []
        self._calls, self._thread = calls, threading.get_ident()
        if program != self._version:
            (prepared, known), self._prepared = self._prepared, (None, {})
            self._version, self._known = program, known if prepared == program else {}
        began = time.monotonic()
        if self.keep is not None:
            self.keep(program, made_at[1], function, values)
        result: Any = self
        """None only if the function returned it."""
        try:
            if _calls_functions(function):
                function.lines = self  # type: ignore[attr-defined]
                result = function(*samples, **values)
            else:
                result = self.call(function, values, *samples)
            return result
        finally:
            given = [(name, value) for name, value in values.items() if type(value) in _SHOWN]
            number, seconds = made_at
            if self._calls is calls:  # else it was abandoned, and another one has begun
                step = self.newest = WatchedStep(program, number, seconds, began, calls, given, result is None)
                for queue in self._views:
                    queue.append(step)

    def prepared(self, program: tuple[str, int]) -> WatchedCall | None:
        """Return the function of a version that has made no step yet, as a call without values, or None.

        The several functions of a machine are shown once it calls them.
        """
        of, known = self._prepared
        if of != program or len(known) != 1:
            return None
        (one,) = known.values()
        return WatchedCall(one.source, None, one.why)

    def function_of(self, key: str) -> Callable[..., Any] | None:
        """Return the function with this `FunctionSource.key` that was called or prepared, or None."""
        known = [*self._prepared[1].values(), *self._known.values()]
        return next((one.function for one in known if one.source.key == key and one.rewritten is not None), None)

    def call(self, function: Callable[..., Any], values: Mapping[str, Any], *samples: Any) -> Any:
        """Call a function of the running step. Its exceptions pass through."""
        return self._call(function, values, samples)[0]

    def call_event(self, event: Callable[..., Any], values: Mapping[str, Any]) -> tuple[Any, Reasons]:
        """Call an event of the running step, and return its result with its reasons. Its exceptions pass through."""
        result, notes, why = self._call(event, values, (), is_event=True)
        return result, Reasons(values.values(), notes, why)

    def _call(
        self, function: Callable[..., Any], values: Mapping[str, Any], samples: Sequence[Any], *, is_event: bool = False
    ) -> tuple[Any, Sequence[Note], str]:
        """Return the result of a function; of an event also its notes for `Reasons`, and the reason if it has none."""
        calls = self._calls
        if not self.is_on or self._thread != threading.get_ident():  # the step was abandoned, and another one runs
            return function(*samples, **values), (), ""
        known = self._known.get((id(function), is_event))
        if known is None or known.is_outdated():
            if len(self._known) >= _MOST_FUNCTIONS:
                self._known = {}
            known = self._known[id(function), is_event] = _rewrite(function, is_event=is_event)
        if known.rewritten is None:
            try:
                result = function(*samples, **values)
            except BaseException as error:
                _add(calls, WatchedCall(known.source, None, known.why, *_error_in(known.source, error)))
                raise
            _add(calls, WatchedCall(known.source, None, known.why))
            return result, (), known.why
        ready = known.ready.pop() if known.ready else known.made()
        error_text_and_line: tuple[Any, ...] = ()
        try:
            result = ready.function(*samples, **values)
        except BaseException as error:
            error_text_and_line = _error_in(known.source, error)
            raise
        finally:
            _add(calls, WatchedCall(known.source, ready.notebook.take(), "", *error_text_and_line))
            notes, why = ready.take_looks()
            known.ready.append(ready)
        return result, notes, why


def _calls_functions(function: Callable[..., Any]) -> bool:
    """Return True for a state machine: by its class, since an object may have any attributes."""
    return getattr(type(function), "calls_functions", False) is True


def _rewrite(function: Callable[..., Any], *, is_event: bool = False) -> _Known:
    try:
        found = rewritten(function, LineLooker) if is_event else rewritten(function)
        return _Known(function, found, found.source, is_event=is_event)
    except NotRewrittenError as error:
        why = str(error)
    except Exception as error:  # the robot drives on: it is shown in the view
        why = f"its source could not be read ({type(error).__name__}: {error})"
    return _Known(function, None, _source_without_lines(function), why)


def _add(calls: list[WatchedCall], call: WatchedCall) -> None:
    if len(calls) < _MOST_CALLS:
        calls.append(call)


class _Known:
    """A function, kept so that no other function gets its id, and its idle rewritten forms."""

    def __init__(
        self,
        function: Callable[..., Any],
        found: Rewritten | None,
        source: FunctionSource,
        why: str = "",
        *,
        is_event: bool = False,
    ) -> None:
        self.function, self.rewritten, self.source, self.why = function, found, source, why
        self._is_event = is_event
        self.ready: list[_Ready] = []
        inner = self._inner = function_in(function) if found is not None else None
        if inner is not None:
            self._code, self._defaults, self._keywords = inner.__code__, inner.__defaults__, inner.__kwdefaults__

    def is_outdated(self) -> bool:
        """Return True if the function was changed in place, as autoreload does."""
        inner = self._inner
        return inner is not None and not (
            inner.__code__ is self._code
            and inner.__defaults__ is self._defaults
            and inner.__kwdefaults__ is self._keywords
        )

    def made(self) -> _Ready:
        """Return another rewritten form. The notes of an abandoned call go to a form that nothing reads."""
        assert self.rewritten is not None
        return _Ready(self.rewritten, LookHooks() if self._is_event else None)


class _Ready:
    """A rewritten form of a function, with its notes: for one call at a time.

    Args:
        found: the function.
        hooks: of an event, take its notes for `Reasons`, too.
    """

    def __init__(self, found: Rewritten, hooks: LookHooks | None) -> None:
        self.notebook, self._hooks = Notebook(found.source), hooks
        self.function = found.bind(self.notebook.notes if hooks is None else _event_notes(self.notebook, hooks))

    def take_looks(self) -> tuple[Sequence[Note], str]:
        """Return the notes for `Reasons` since the last time, and the reason why some are missing, and begin again."""
        if self._hooks is None:
            return (), ""
        looks = [*self._hooks.log]
        self._hooks.log.clear()
        return looks, self._hooks.why


def _event_notes(notebook: Notebook, hooks: LookHooks) -> Notes:
    """Return the functions that note the values of an event, for its lines and for its reasons."""
    places, add = notebook.source.places, hooks.log.append

    def both(note: NoteCall) -> NoteCall:
        def noted(place: int, value: Any, *more: Any) -> Any:
            add((places, place, value, *more))
            return value if places[place].is_inner else note(place, value, *more)

        return noted

    return *map(both, notebook.notes), hooks.method, hooks.called


def _source_without_lines(function: Callable[..., Any]) -> FunctionSource:
    inner = getattr(function, "func", function)
    code = getattr(inner, "__code__", None)
    name = str(getattr(inner, "__name__", type(inner).__name__))
    return FunctionSource(name, code.co_filename if code else "", code.co_firstlineno if code else 0, ())


def _error_in(source: FunctionSource, error: BaseException) -> tuple[str, int | None]:
    """Return the text of an error, and the last line of a function at which it came."""
    line = None
    traceback: TracebackType | None = error.__traceback__
    end = source.first + max(1, len(source.texts))
    while traceback is not None:
        code = traceback.tb_frame.f_code
        if code.co_filename == source.file and source.first <= traceback.tb_lineno < end:
            line = traceback.tb_lineno
        traceback = traceback.tb_next
    # `UserThread.end` raised it, and not the function.
    is_ended = isinstance(error, SystemExit) and is_abandoned()
    return NO_RETURN if is_ended else error_text(error), line


def error_text(error: BaseException) -> str:
    """Return an error as text, at most 300 characters: ``ZeroDivisionError: division by zero``."""
    try:
        text = f"{type(error).__name__}: {error}"
    except Exception:  # of the user's own class
        text = type(error).__name__
    return text[:300]

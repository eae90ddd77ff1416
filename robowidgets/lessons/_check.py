"""The check of an answer to a task."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol

from ..behaviors.lines.watch import WatchedStep
from ..behaviors.machine import Machine
from ..behaviors.prints import Prints
from ..behaviors.simulation import function_of
from ._bounded import Bounded, BrokenError, WrongError
from ._case import Case
from ._lines import CaseLines
from ._programs import back_off, follow_wall, stop_before_wall, wall_ahead
from ._progress import keep
from ._result import Result
from ._tasks import bumper_reflex, fits_through, nearest_on_the_left, slow_in_doorway, stop_at_wall

TASKS: dict[str, Callable[[], Sequence[Case]]] = {
    task.__name__: task
    for task in (
        *(nearest_on_the_left, fits_through, stop_at_wall, bumper_reflex, slow_in_doorway),
        *(wall_ahead, stop_before_wall, follow_wall, back_off),
    )
}
"""The tasks by the name of their answer, in the order of the two lessons."""


def check(function: Callable[..., Any], task: str | None = None) -> Result:
    """Check the answer to a task: a function, or a program or state machine that drives the simulated robot.

    Errors of the function appear in the result and are not raised. A step may take half a second, as on a live robot,
    and all steps of a case together 10 s of the computer's time. The result contains the lines of the function with
    their values in the first wrong case, and the last three lines that the function printed. After `progress`, the
    result is saved, and is in the language of the lesson.

    Args:
        function: ``nearest_on_the_left(scan)``, ``fits_through(scan)``, ``stop_at_wall(scan)``,
            ``bumper_reflex(touch)``, ``slow_in_doorway(scan)`` or ``wall_ahead(scan)``; the lessons explain what each
            returns. For the tasks ``stop_before_wall``, ``follow_wall`` and ``back_off``, a program or the class of a
            state machine.
        task: the name of the task, or None for the name of the function.

    Raises:
        TypeError: it is not a function.
        ValueError: no task has this name.

    Examples:
        >>> from robowidgets import lessons
        >>> def nearest_on_the_left(scan):
        ...     return scan.distance("left")
        >>> lessons.check(nearest_on_the_left)
        nearest_on_the_left: right in all 8 cases. Well done!
    """
    if not callable(function):
        raise TypeError(f"check: expected the function that answers a task, without brackets, got {function!r}")
    name = task or str(getattr(function, "__name__", "") or getattr(function, "name", ""))
    cases = _cases("check", name, "" if task else f"; name the task, as in check({name}, 'stop_before_wall')")
    result = judged(function, name, cases, Bounded())
    keep(function, name, result)
    return result


class Caller(Protocol):
    """A caller of an answer, with the prints, the hints and the lines of the calls."""

    prints: Prints
    hints: list[str]
    is_late: bool

    @property
    def steps(self) -> Iterable[WatchedStep]:
        """The last calls of the case; empty if their lines are not known."""

    def begin_case(self) -> None:
        """Begin another case."""

    def of(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function to call, which raises only `WrongError`."""


def judged(function: Callable[..., Any], name: str, cases: Sequence[Case], bounded: Caller) -> Result:
    """Return the result of a function on some cases, within limits."""
    right, wrong, given = 0, list[str](), set[str]()
    sample, fault = None, ""
    lines: CaseLines | None = None
    for case in cases:
        bounded.begin_case()
        error = _error_of(case, function, bounded)
        if error is None:
            right += 1
            continue
        hints = dict.fromkeys(bounded.hints)  # a hint replaces the advice of the error
        advice = [f"{hint[0].upper()}{hint[1:]}" for hint in hints if hint not in given]
        advice += [error.advice] if error.advice and not hints else []
        given.update(hints)
        wrong.append(". ".join((f"{case.title}: {error}", *advice)))
        sample, fault = (case.sample if sample is None else sample), fault or error.fault
        lines = lines or _lines_of(case, error, bounded)
        if isinstance(error, BrokenError):
            break
    if wrong and (note := _note_of(function)):
        wrong[0] = f"{wrong[0]}. {note}"
    return Result(name, wrong, right, len(cases), sample, [text for _, text in bounded.prints.lines], fault, lines)


def example(name: str) -> Any:
    """Return a scan or a touch as the task gives it to its answer, to look at it.

    Raises:
        ValueError: no task has this name.
    """
    return _cases("example", name)[0].sample


def _error_of(case: Case, function: Callable[..., Any], bounded: Caller) -> WrongError | None:
    try:
        answer = function_of(function)
    except (TypeError, ValueError) as error:
        return BrokenError("{error}", error=error)
    try:
        case.judge(bounded.of(answer))
    except WrongError as error:
        return error
    return None


def _lines_of(case: Case, error: WrongError, bounded: Caller) -> CaseLines | None:
    """Return the lines of the call with a fault, or None if they are not known."""
    steps = {step.number: step for step in bounded.steps}
    if not steps:
        return None
    last = max(steps)
    step = steps.get(last if error.step is None else error.step, steps[last])
    return CaseLines(case.title, case.sample, step, is_drive=last > 1, is_late=bounded.is_late)


def _note_of(function: Callable[..., Any]) -> str:
    """Return hints on likely mistakes in a state machine, or an empty text."""
    try:
        answer = function_of(function)
    except (TypeError, ValueError):
        return ""
    return answer.note if isinstance(answer, Machine) else ""


def _cases(call: str, name: str, hint: str = "") -> Sequence[Case]:
    if name not in TASKS:
        raise ValueError(f"{call}: no task is called {name!r}; the tasks are {', '.join(TASKS)}{hint}")
    return TASKS[name]()

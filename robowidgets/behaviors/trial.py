"""Another version of a program, tried on the inputs of the last steps: the steps in which it decides otherwise."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from .drive import Drive, drive_of
from .kept_steps import KeptStep, copied_state
from .lines.differences import first_difference
from .lines.effects import effect_of
from .lines.values import glimpse, text_of
from .lines.watch import LineWatch, WatchedStep, error_text
from .machine import Machine
from .variables import ProgramState, Variables

MOST_SPANS = 20
"""Spans that are described."""

Function = Callable[..., Any]


class Tried(NamedTuple):
    """The outcome of a step that was tried: its speed, None before the first one; its error; and its lines."""

    drive: Drive | None
    error: str = ""
    lines: WatchedStep | None = None

    @property
    def text(self) -> str:
        """The speed or the error, as a program writes it."""
        return f"! {self.error}" if self.error else "None" if self.drive is None else text_of(glimpse(self.drive))


class TriedSpan(NamedTuple):
    """A span in which two versions decided otherwise.

    Attributes:
        first, last: the positions of its first and last step.
        line: the first line of the new version that was otherwise, by its number in the file, or None.
        old_value, new_value: the values of this line.
        old, new: what both decided at its first step.
    """

    first: int
    last: int
    line: int | None
    old_value: str
    new_value: str
    old: str
    new: str


class ComparedSteps:
    """The outcomes of two versions on the same steps.

    Attributes:
        steps: the number of compared steps.
        otherwise: the number of steps in which they decided otherwise.
        failed: the number of steps in which the new one raised an error, though the old one did not.
        error: the first of these errors.
        spans: the first spans in which they decided otherwise.
        all_spans: the number of these spans.
    """

    def __init__(self) -> None:
        self.steps = self.otherwise = self.failed = self.all_spans = 0
        self.error = ""
        self.spans: list[TriedSpan] = []
        self._is_open = False

    def add(self, old: Tried, new: Tried) -> None:
        """Compare the next step."""
        number, self.steps = self.steps, self.steps + 1
        if new.error and not old.error:
            self.failed += 1
            self.error = self.error or new.error
        differs = (old.drive, old.error) != (new.drive, new.error)
        self.otherwise += differs
        if differs and self._is_open and len(self.spans) == self.all_spans:
            self.spans[-1] = self.spans[-1]._replace(last=number)
        elif differs and not self._is_open:
            self.all_spans += 1
            if self.all_spans <= MOST_SPANS:
                where: tuple[int | None, str, str] = None, "", ""
                if old.lines is not None and new.lines is not None:
                    where = first_difference(old.lines, new.lines)
                self.spans.append(TriedSpan(number, number, *where, old.text, new.text))
        self._is_open = differs

    def packed(self, steps: Sequence[KeptStep]) -> dict[str, Any]:
        """Return the counts for the page, and the seconds of the compared steps, which were the first of these."""
        seconds = steps[self.steps - 1].at - steps[0].at if self.steps else 0.0
        return {
            "steps": self.steps,
            "seconds": round(seconds, 1),
            "otherwise": self.otherwise,
            "failed": self.failed,
            "error": self.error,
        }


def why_not_tried(function: Function) -> str:
    """Return the reason why a version must not be called only to try it, or an empty text.

    A trial must change nothing: the running version would notice.
    """
    functions = [one for one, _ in function.functions] if isinstance(function, Machine) else [function]
    for one in functions:
        if effect := effect_of(one):
            return f"{getattr(one, '__name__', 'it')} may not be tried, because {effect}"
    return ""


def steps_to_try(steps: Sequence[KeptStep], asks_for: Sequence[str], most: int) -> tuple[list[KeptStep], str]:
    """Return the last steps on which a version can be tried, or the reason why it cannot be tried.

    Args:
        steps: kept steps, oldest first.
        asks_for: the parameters of the version.
        most: the number of steps to return at most.
    """
    why = "" if steps else "no step was made yet"
    for name in asks_for:
        if steps and not _has(steps[-1], name):
            return [], f"the version before did not read {name}"
    first = max(0, len(steps) - most)
    for number in range(first, len(steps)):
        step = steps[number]
        if not step.why and all(_has(step, name) for name in asks_for):
            found = [one for one in steps[number:] if all(_has(one, name) for name in asks_for)]
            return found, ""
        why = why or step.why
    return [], why


def _has(step: KeptStep, name: str) -> bool:
    own = {"state": True, "variables": step.variables is not None}  # a state that was not asked for is empty
    return own.get(name, name in step.values)


def tried(
    function: Function, asks_for: Sequence[str], steps: Sequence[KeptStep], lines: LineWatch | None = None
) -> Iterator[Tried]:
    """Make steps again, and yield their outcomes. The version has a state of its own, as it was before the first step.

    Args:
        function: the function of the version; for a state machine, another one of its class makes the steps.
        asks_for: its parameters.
        steps: the inputs.
        lines: notes the values of its lines, or None.
    """
    state = ProgramState(copied_state(steps[0].state or {})) if steps else ProgramState()
    if isinstance(function, Machine):
        function = function.fresh()
        if steps and steps[0].progress is not None:
            function.continue_from(steps[0].progress)
    drive: Drive | None = None
    for number, step in enumerate(steps):
        values = {name: step.values[name] for name in asks_for if name in step.values}
        if "state" in asks_for:
            values["state"] = state
        if "variables" in asks_for:
            values["variables"] = Variables.restored(step.variables or {})
        before = None if lines is None else lines.newest
        error = ""
        try:
            made_at = number, step.time
            result = function(**values) if lines is None else lines.step(("", 0), made_at, function, values)
            if result is not None:
                drive = drive_of(result, Drive())
        except Exception as raised:  # it is counted, and shown with its line
            error = error_text(raised)
        noted = None if lines is None or lines.newest is before else lines.newest
        yield Tried(None if error else drive, error, noted)


def compared(
    old: tuple[Function, Sequence[str]],
    new: tuple[Function, Sequence[str]],
    steps: Sequence[KeptStep],
    found: ComparedSteps,
) -> Iterator[None]:
    """Compare two versions, given as functions with their parameters, step by step, with the values of their lines."""
    runs = (tried(function, asks_for, steps, LineWatch()) for function, asks_for in (old, new))
    for one, other in zip(*runs, strict=True):
        found.add(one, other)
        yield

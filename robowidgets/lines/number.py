"""A number in a line of the running program that the user changes on the page."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from ..behaviors.drive import Drive
from ..behaviors.exchange import exchanged
from ..behaviors.kept_steps import KeptStep
from ..behaviors.lines.numbers import Changed, NotChangedError, numbers_in, with_number
from ..behaviors.machine import Machine
from ..behaviors.program import RUNNING
from ..behaviors.programs import Programs
from ..behaviors.trial import ComparedSteps, Tried, steps_to_try, tried, why_not_tried
from ..behaviors.trials import TrialJob, Trials
from ..behaviors.version import Version
from ..driving.press import Tokens
from ..reasons.rewriting import function_in

EFFECT_S = 10.0
"""Seconds of the past on which a number is tried."""
TRIAL_S = 0.4
"""Seconds of work for one number."""
FRESH_S = 3.0
"""Seconds for which the page may act after it was heard last."""
_LATE = "the kernel heard of it too late, so the number is as it was"
_SLOW = "trying it took too long, so the number is as it was"
_MOST_POINTS = 200
"""Points of the graph of the effect."""
_TRIAL = "number"
_ACTS = ("try", "put", "undo", "end")
_FIELDS: dict[str, Any] = {"act": "", "press": "", "text": "", "token": 0}
_AXES = ("linear", "angular", "lateral")


@dataclass
class _Press:
    """A number that was pressed: its place in a function of a version, and the steps to try others on.

    ``why`` is the reason why nothing can be tried. ``old`` are the outcomes of the version itself.
    """

    name: str
    version: Version
    function: Callable[..., Any]
    line: int
    column: int
    steps: list[KeptStep] = field(default_factory=list)
    why: str = ""
    old: list[Tried] | None = None


@dataclass
class _Try:
    """A number that is tried in the place of the pressed one."""

    press: _Press
    text: str
    found: ComparedSteps = field(default_factory=ComparedSteps)
    new: list[Tried] = field(default_factory=list)
    refused: str = ""
    is_done: bool = False
    put_at: float | None = None
    """The time at which it was let go, or None."""


class ChangedNumber:
    """Tries numbers in the place of one in the running program, and makes the chosen one drive.

    A number is tried on the inputs of the last seconds, in a thread that may hang. It drives only if no step hung or
    failed; then the program goes on with another version, as after an edit of its cell.

    Args:
        programs: the programs of the robot.
        trials: the thread of trials.
        on_change: called when `state` has changed.
        now: the clock of the age of messages.

    Attributes:
        state: the state for the page, as plain values; empty before the first press.
    """

    def __init__(
        self,
        programs: Programs,
        trials: Trials,
        on_change: Callable[[], object],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._programs, self._trials, self._on_change, self._now = programs, trials, on_change, now
        self._tokens = Tokens(FRESH_S, now)
        self._lock = threading.Lock()
        self.state: dict[str, Any] = {}
        self._press: _Press | None = None
        self._try: _Try | None = None
        self._undo: tuple[Version, Version, str] | None = None
        """The version with the number, the one before, and the number before."""

    def on_page(self, content: dict[str, Any]) -> None:
        """Handle a message of the page.

        It has ``act``: try a number, put it into the program, undo this, or end without it. The page repeats a try
        while the number is held, to get a fresh token.

        Raises:
            ValueError: the message is not valid.
        """
        act, name, text, token = (content.get(key, other) for key, other in _FIELDS.items())
        is_named = type(name) is str and 0 < len(name) <= 64
        if act not in _ACTS or not is_named or type(text) is not str or type(token) is not int:
            raise ValueError(f"expected a message about a number, got {repr(content)[:200]}")
        if act == "undo":
            self._take_back(name)
        with self._lock:
            if act == "end":
                self._end(name)
                return
            if act in ("try", "put"):
                press = self._pressed(name, content)
                if press is not None:
                    self._ask(press, text, token if act == "put" else None)
            if self.state.get("press") == name:
                self.state = {**self.state, "token": self._tokens.issue()}
        self._on_change()

    # -- within, with the lock -----------------------------------------------------------------------------------------

    def _end(self, name: str) -> None:
        if self.state.get("press") == name:
            self._trials.drop(_TRIAL)
            self._press = self._try = None

    def _say(self, name: str, text: str, state: str, why: str = "", **more: Any) -> None:
        self.state = {"press": name, "text": text, "state": state, "why": why[:300], **more}

    def _pressed(self, name: str, content: dict[str, Any]) -> _Press | None:
        """Return the press of this name, a new one if it is not known, or None if it cannot be."""
        if self._press is not None and self._press.name == name:
            return self._press
        key, function, line, column = (content.get(one) for one in ("key", "function", "line", "column"))
        if type(function) is not str or type(line) is not int or type(column) is not int:
            raise ValueError(f"expected the place of a number, got {repr(content)[:200]}")
        program, lines, kept = self._programs.current, self._programs.lines, self._programs.kept
        if program is None or lines is None or kept is None or key != f"{program.name} {program.version.number}":
            self._say(name, "", "refused", "another version is in force now")
            return None
        version = program.version
        found = lines.function_of(function)
        if found is None:
            self._say(name, "", "refused", "its function was not called by this version yet")
            return None
        why, steps = why_not_tried(version.function), list[KeptStep]()
        if not why:
            most = max(1, int(TRIAL_S / max(program.step_time, 1e-5)))
            steps, why = steps_to_try(kept.last(program.name, EFFECT_S), version.asks_for, most)
        self._press = _Press(name, version, found, line, column, steps, why)
        return self._press

    def _ask(self, press: _Press, text: str, token: int | None) -> None:
        """Try a number. With a token it was let go, and drives if the trial is good."""
        if token is not None and not self._tokens.is_fresh(token):
            self._press = self._try = None
            self._say(press.name, text, "refused", _LATE)
            return
        known = self._try
        is_new = known is None or known.press is not press or known.text != text
        if known is None or is_new:
            known = self._try = _Try(press, text)
            self._say(press.name, text, "trying")
        if token is not None:
            known.put_at = self._now()
        if is_new or (known.is_done and token is not None):
            work = iter(()) if known.is_done else self._work(known)
            self._trials.ask(_TRIAL, TrialJob(work, press.function, lambda job: self._on_tried(job, known)))

    # -- in the thread of trials ---------------------------------------------------------------------------------------

    def _changed(self, tried_: _Try, file: str = "") -> tuple[Callable[..., Any], Changed]:
        press = tried_.press
        changed = with_number(press.function, press.line, press.column, tried_.text, file)
        return exchanged(press.version.function, press.function, changed.function), changed

    def _work(self, known: _Try) -> Iterator[None]:
        """Make the steps with the number that is tried, and before the first number the steps of the version itself."""
        press = known.press
        known.found, known.new = ComparedSteps(), []
        try:
            function, _ = self._changed(known)
        except (NotChangedError, LookupError) as error:
            known.refused = str(error.args[0])
            return
        if press.why:
            return
        yield  # compiling a long source has taken some time of this slice
        asks_for = press.version.asks_for
        if press.old is None:
            old = []
            for one in tried(press.version.function, asks_for, press.steps):
                old.append(one)
                yield
            press.old = old
        for one, other in zip(press.old, tried(function, asks_for, press.steps), strict=True):
            known.found.add(one, other)
            known.new.append(other)
            yield

    def _on_tried(self, job: TrialJob, known: _Try) -> None:
        with self._lock:
            if self._try is not known:
                return
            press, found, puts = known.press, known.found, known.put_at is not None
            known.is_done = True
            if job.error:
                known.refused = f"it is not put into the program: {job.error}"
            if puts and not known.refused and found.failed:
                known.refused = f"the program would fail with it: {found.error}"
            if known.put_at is not None and not known.refused and self._now() - known.put_at > FRESH_S:
                known.refused = _SLOW
            effect = self._effect(known)
            if puts:
                self._press = self._try = None
            if known.refused:
                self._say(press.name, known.text, "refused", known.refused, **effect)
            elif not puts:
                self._say(press.name, known.text, "tried", press.why, **effect)
        if puts and not known.refused:
            self._put(known, effect)
        with self._lock:
            self.state = {**self.state, "token": self._tokens.issue()}
        self._on_change()

    # -- another version drives: without the lock, as observers are called ---------------------------------------------

    def _take_back(self, name: str) -> None:
        with self._lock:
            undo, text = self._undo, self.state.get("text", "")
            if undo is None or self.state.get("press") != name:
                return
            self._undo = None
        changed, before, number = undo
        function = before.function.fresh() if isinstance(before.function, Machine) else before.function
        try:
            version = self._programs.change(changed, replace(before, function=function, change=f"{number} is back"))
        except RuntimeError as error:
            with self._lock:
                self._say(name, text, "refused", str(error))
        else:
            with self._lock:
                self._say(name, number, "back", version=version.number, note=self._note())

    def _put(self, known: _Try, effect: dict[str, Any]) -> None:
        press, before = known.press, known.press.version
        program = self._programs.current
        file = f"<{program.name if program else ''}, version {before.number + 1}, a number changed>"
        number = _number_at(press.function, press.line, press.column)
        try:
            function, changed = self._changed(known, file)
            line = press.line + function_in(press.function).__code__.co_firstlineno
            change = f"line {line}, {known.text} instead of {number}"
            written = before.written or changed.before
            after = replace(before, function=function, text=changed.text, written=written, change=change)
            version = self._programs.change(before, after)
        except (NotChangedError, LookupError, RuntimeError) as error:
            with self._lock:
                self._say(press.name, known.text, "refused", str(error.args[0]), **effect)
            return
        note = self._note()
        with self._lock:
            self._undo = version, before, number
            self._say(press.name, known.text, "driving", version=version.number, back=number, note=note, **effect)

    def _note(self) -> str:
        """Return the reason why the program does not drive now, or an empty text."""
        program = self._programs.current
        return "" if program is None else program.waiting if program.mode == RUNNING else program.note

    def _effect(self, known: _Try) -> dict[str, Any]:
        press, found = known.press, known.found
        steps = press.steps[: found.steps]
        if not steps or press.old is None:
            return {}
        return {**found.packed(steps), "axes": _curves(steps, press.old, known.new)}


def _number_at(function: Callable[..., Any], line: int, column: int) -> str:
    return next((one.text for one in numbers_in(function) if (one.line, one.column) == (line, column)), "")


def _curves(steps: list[KeptStep], old: list[Tried], new: list[Tried]) -> list[dict[str, Any]]:
    """Return a curve of both versions for each axis that one of them uses: times before now, and the speeds."""
    chosen = steps, old, new
    if len(steps) > _MOST_POINTS:
        picked = [round(i * (len(steps) - 1) / (_MOST_POINTS - 1)) for i in range(_MOST_POINTS)]
        steps, old, new = ([one[i] for i in picked] for one in chosen)  # type: ignore[assignment]
    end = steps[-1].at
    curves = []
    for name, (axis, unit) in zip(_AXES, (("forward", "m/s"), ("turn", "rad/s"), ("left", "m/s")), strict=True):
        both = [[_speed(one.drive, name) for one in each] for each in (old, new)]
        if any(any(one) for one in both):
            at = [round(step.at - end, 3) for step in steps]
            curves.append({"axis": axis, "unit": unit, "at": at, "old": both[0], "new": both[1]})
    return curves


def _speed(drive: Drive | None, name: str) -> float | None:
    return None if drive is None else round(float(getattr(drive, name)), 4)

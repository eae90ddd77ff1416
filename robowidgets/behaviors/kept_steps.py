"""The inputs of the last steps of a program, kept so that another version can be tried on them."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..runtime.sizes import approximate_bytes
from .lines.values import is_kept
from .machine import Machine, MachineProgress
from .variables import Variable, Variables

KEPT_S = 60.0
"""Seconds of steps that are kept."""
MOST_BYTES = 64_000_000
"""Bytes of samples that are kept at most. Pictures and clouds reach less far back."""
_MOST_PARTS = 500
"""Parts of a program's state that are copied before a step."""
_LARGEST_ARRAY = 10_000
"""Entries of an array in a state that are copied."""
_OWN = ("state", "variables")
_OBJECT_BYTES = 200


class KeptStep(NamedTuple):
    """The inputs of a step.

    Attributes:
        program: the name of the program, and the number of its version.
        time: the seconds of the program.
        at: the monotonic time at which it began.
        values: the arguments by name, except ``state`` and ``variables``.
        state: a copy of the program's state before the step, None if the step did not get it.
        variables: the variables at that time, None if the step did not get them.
        progress: of a state machine, its active states before the step.
        why: the reason why no trial can begin with this step; empty if one can.
        size: the bytes of its samples that no earlier step has.
    """

    program: tuple[str, int]
    time: float
    at: float
    values: Mapping[str, Any]
    state: Mapping[str, Any] | None
    variables: Mapping[str, Variable] | None
    progress: MachineProgress | None
    why: str
    size: int


class KeptSteps:
    """The inputs of the last minute. The thread of the steps adds to it, in a few microseconds; any thread may read."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._steps: deque[KeptStep] = deque()
        self._last: Mapping[str, Any] = {}
        self._bytes = 0

    def add(
        self, program: tuple[str, int], seconds: float, function: Callable[..., Any], values: Mapping[str, Any]
    ) -> None:
        """Keep the inputs of a step that is about to be made."""
        own = {name: value for name, value in values.items() if name not in _OWN}
        last, size = self._last, 0
        for name, value in own.items():
            if last.get(name) is not value and not is_kept(type(value), numbers_only=True):
                size += approximate_bytes(value, _OBJECT_BYTES)
        self._last = own
        state = variables = progress = None
        why = ""
        if "state" in values:
            try:
                state = copied_state(values["state"])
            except _NotCopiedError as error:
                why = str(error)
            except RuntimeError:  # also RecursionError; no error may end the step that is about to be made
                why = "state refers to itself, or was changed while it was copied"
        if type(values.get("variables")) is Variables:
            variables = values["variables"].table
        if type(function) is Machine:
            if function.before is None:
                progress = function.hand_on()
            else:
                why = "its states are handed on in this step"
        now = self._now()
        self._steps.append(KeptStep(program, seconds, now, own, state, variables, progress, why, size))
        self._bytes += size
        while self._steps and (self._steps[0].at < now - KEPT_S or self._bytes > MOST_BYTES):
            self._bytes -= self._steps.popleft().size

    def last(self, name: str, seconds: float) -> list[KeptStep]:
        """Return the steps of a program in the last seconds before now, oldest first."""
        since = self._now() - seconds
        while True:
            try:
                steps = [*self._steps]
            except RuntimeError:  # a step came meanwhile
                continue
            return [step for step in steps if step.at >= since and step.program[0] == name]


class _NotCopiedError(Exception):
    """A part of a state cannot be copied without a call of a user's code, or is too large."""


def copied_state(state: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of a state: of its lists and other containers, too, but of no object of a user's class."""
    items: list[tuple[Any, Any]] = [*state.items()]
    left = [_MOST_PARTS]

    def copied(name: str, value: Any) -> Any:
        left[0] -= 1
        kind = type(value)
        if left[0] < 0:
            raise _NotCopiedError(f"state.{name} is too large to be copied at each step")
        if kind is str or kind is bytes or is_kept(kind):
            return value
        if kind in (list, tuple, set, frozenset):
            return kind([copied(name, one) for one in value])
        if kind is dict:
            return {copied(name, key): copied(name, one) for key, one in value.items()}
        if kind is deque:
            return deque([copied(name, one) for one in value], value.maxlen)
        if kind is np.ndarray and value.dtype.kind in "biufc" and value.size <= _LARGEST_ARRAY:
            return value.copy()
        raise _NotCopiedError(f"state.{name} is {_kind_text(kind)}, which cannot be copied at each step")

    return {key: copied(str(key), value) for key, value in items}


def _kind_text(kind: type) -> str:
    name = type.__dict__["__name__"].__get__(kind)
    return "an array" if kind is np.ndarray else f"{'an' if name[:1] in 'AEIOUaeiou' else 'a'} {name}"

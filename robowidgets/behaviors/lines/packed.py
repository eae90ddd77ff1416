"""Steps and sources as plain values, for the page."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from .shown import FLAG, LineValues, levels_of, lines_of, passes_of
from .values import text_of
from .watch import WatchedCall, WatchedStep

_UNITS = {"time": "s", "since": "s", "driven": "m", "turned": "rad"}
"""The units of the arguments of a step, by parameter."""


def packed_function(call: WatchedCall) -> dict[str, Any]:
    """The source of a function, and why it has no values."""
    source = call.source
    return {
        "key": source.key,
        "name": source.name,
        "first": source.first,
        "texts": source.texts,
        "code": sorted(line - source.first for line in source.reach),
        "why": call.why,
    }


def calls_by_function(step: WatchedStep) -> list[WatchedCall]:
    """Return the last call of each function of a step, by line. Of a failed function, return the failed call."""
    last: dict[str, WatchedCall] = {}
    for call in step.calls:
        if not last.get(call.source.key, call).error or call.error:
            last[call.source.key] = call
    return sorted(last.values(), key=lambda call: call.source.first)


def packed_step(step: WatchedStep) -> dict[str, Any]:
    """Return a step as plain values, with the lines of each called function."""
    return {
        "number": step.number,
        "time": step.time,
        "at": step.at,
        "given": [[name, text_of(value, _UNITS.get(name, ""))] for name, value in step.given],
        "calls": [_packed_call(call) for call in calls_by_function(step)],
        "none": step.returned_none,
    }


def _packed_call(call: WatchedCall) -> dict[str, Any]:
    line = call.error_line
    return {
        "key": call.source.key,
        "lines": [_packed_line(line) for line in lines_of(call)],
        "loops": [[*one] for one in passes_of(call)],
        "error": [line - call.source.first, call.error] if call.error and line is not None else None,
    }


def _packed_line(line: LineValues) -> list[Any]:
    rays = [[*rays] for rays in line.rays]
    return [line.number, line.value, line.details, line.times, line.kind, line.level, rays]


class Totals:
    """The number of steps in which each line was reached, and was true."""

    def __init__(self) -> None:
        self.steps = 0
        self._counts: dict[str, dict[int, list[int]]] = {}

    def add(self, steps: Iterable[WatchedStep]) -> None:
        """Count steps."""
        for step in steps:
            self.steps += 1
            for call in calls_by_function(step):
                counts = self._counts.setdefault(call.source.key, {})
                for line, (kind, level) in levels_of(call).items():
                    count = counts.setdefault(line, [0, 0])
                    count[0] += 1
                    count[1] += kind == FLAG and level == 1.0

    def packed(self) -> dict[str, list[list[int]]]:
        """Return the lines of each function with both numbers."""
        return {key: [[line, *both] for line, both in counts.items()] for key, counts in self._counts.items()}


def spread(steps: Sequence[WatchedStep], most: int) -> list[WatchedStep]:
    """Return evenly chosen steps, including the last one."""
    if len(steps) <= most:
        return [*steps]
    return [steps[round(i * (len(steps) - 1) / (most - 1))] for i in range(most)]

"""The small graphs of a function's lines over a recording, in a size that does not depend on its length."""

from __future__ import annotations

from typing import Any

from ..behaviors.lines.shown import FLAG, levels_of
from ..recordings.search.lines import MadeStep

MOST_POINTS = 240
"""Points of a graph, which is 124 pixels wide."""


class Graphs:
    """The levels of each line, in equal parts of the time.

    Args:
        start: the time of their left edges, by the clock of the recording.
        end: the time of their right edges.
    """

    def __init__(self, start: int, end: int) -> None:
        self._start, self._part = start, max(1, -(-(end - start) // MOST_POINTS))
        self._number = -1
        self._times: list[float] = []
        self._kinds: dict[tuple[str, int], str] = {}
        self._levels: dict[tuple[str, int], list[float | None]] = {}
        """For each time the last level of the line, or 1 if it was true in a step; None if it was not reached."""

    def add(self, made: MadeStep, seconds: float) -> None:
        """Add a step at a later time than the one before."""
        number = (made.time_ns - self._start) // self._part
        if number != self._number or not self._times:
            self._number = number
            self._times.append(round(seconds, 3))
        last = len(self._times) - 1
        for call in made.step.calls:
            for line, (kind, level) in levels_of(call).items():
                levels = self._levels.setdefault((call.source.key, line), [])
                is_true = kind == FLAG and len(levels) > last and levels[last] == 1.0
                levels.extend([None] * (last + 1 - len(levels)))
                levels[last] = 1.0 if is_true or level is None else float(f"{level:.4g}")
                if kind == "reached":
                    self._kinds.setdefault((call.source.key, line), kind)
                else:
                    self._kinds[call.source.key, line] = kind

    def packed(self) -> dict[str, Any]:
        """Return the times, and for each function its lines with their kinds and levels."""
        lines: dict[str, list[Any]] = {}
        for (key, line), levels in self._levels.items():
            padded = [*levels, *[None] * (len(self._times) - len(levels))]
            lines.setdefault(key, []).append([line, self._kinds[key, line], padded])
        return {"times": self._times, "lines": lines}

"""The condition on gaps between samples: ``gap(2)``."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from ...kinds import KINDS
from ...samples.checks import number
from ..topics import UnknownTopicError, UnnamedTopicError
from ._steps import NO, YES, Steps, combined
from .base import UndecidedCondition
from .seconds import Possible, SecondRows

if TYPE_CHECKING:
    from .. import RecordingData
    from ._search import Search


class GapCondition(UndecidedCondition):
    """The condition that no sample came for longer than some time; see `gap`."""

    why = "a gap lies between samples"

    def __init__(self, seconds: float, topic: str | None) -> None:
        self._seconds = number("seconds", seconds)
        if not 0 < self._seconds < inf:
            raise ValueError(f"seconds: expected a time above 0, got {self._seconds!r}")
        self._topic = topic

    def steps(self, search: Search) -> Steps:
        silences = [(name, self._of(search, name)) for name in self.topics(search.recording, None)]
        search.silences += silences
        return combined([when for _, when in silences], np.max)

    def possible(self, rows: SecondRows) -> Possible:
        if self._topic is not None:
            return super().possible(rows)
        # NaN without topics to check. Slightly less, because the seconds of an index are rounded.
        return Possible(~(rows["gap"] <= self._seconds * (1 - 1e-9)), np.ones(len(rows), bool))

    def topics(self, recording: RecordingData, asked: Any) -> list[str]:  # noqa: ARG002
        if self._topic is not None:
            return [self._topic]
        shown = [topic for topic in recording.topics if topic.widget]
        found = [topic.name for topic in shown if KINDS[topic.widget or ""].goes_stale and not topic.commanded]
        if found:
            return found
        *others, last = (f"{'measured ' * kind.commands}{kind.noun}" for kind in KINDS.values() if kind.goes_stale)
        there = f"{recording.path.name} has no {', '.join(others)} or {last}"
        if not shown:
            raise UnknownTopicError(there)
        raise UnnamedTopicError(there, [topic.name for topic in shown], None)

    def _of(self, search: Search, topic: str) -> Steps:
        series = search.recording.series(topic)
        times = search.times(series)
        # Without rows for releases without a message.
        times = times[series.said[: len(times)]]
        # Silence before the first sample and after the last counts, too.
        ends = np.array([search.recording.start_ns or 0, search.end_ns], np.int64)
        edges = np.unique(np.concatenate((ends[:1], times, ends[1:])))
        silent = np.append(np.diff(edges) > self._seconds * 1e9, False)
        # A sample between two silences separates them: the second begins a nanosecond after it.
        again = np.flatnonzero(silent[1:] & silent[:-1]) + 1
        values = np.where(silent, YES, NO).astype(np.int8)
        values[again] = NO
        return Steps(np.insert(edges, again + 1, edges[again] + 1), np.insert(values, again + 1, YES))

    def __str__(self) -> str:
        return f"gap longer than {self._seconds:g} s" + (f" in {self._topic}" if self._topic else "")

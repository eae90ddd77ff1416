"""Ready-made conditions for `Recording.find`, joined by ``&``, ``|`` and ``~``.

Each condition is computed for whole columns, while another thread reads and decompresses the next part of the file. The
last scan or speed before a silence is stale one usual step after its time; a silence is a pause of more than 2 s and
more than two usual steps. The state of a touch sensor lasts until its next message.

Example:
    >>> from robowidgets import conditions
    >>> recording.find(conditions.touched() & conditions.nearest_below(0.3))  # doctest: +SKIP
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..kinds import KINDS
from ..recordings.columns.chunks import ScanChunk, SpeedChunk
from ..recordings.topics import UnknownTopicError, UnnamedTopicError
from ..samples import AXES, TouchState
from ..samples.checks import number
from ..samples.scan import distances
from ..samples.sector import Asked, to_sector
from ._predicate import Function
from ._steps import NO, UNKNOWN, YES, Steps, combined, inverted, steps

if TYPE_CHECKING:
    from .search import Search

__all__ = ["Condition", "gap", "nearest_below", "speed_above", "touched", "when"]


class Condition(ABC):
    """A condition, which is true, false or unknown at each time of a recording."""

    @abstractmethod
    def steps(self, search: Search) -> Steps:
        """The steps of the condition, up to the end of the search."""

    def __and__(self, other: Any) -> Condition:
        return _Joined(" & ", np.min, self, other)

    def __rand__(self, other: Any) -> Condition:
        return _Joined(" & ", np.min, other, self)

    def __or__(self, other: Any) -> Condition:
        return _Joined(" | ", np.max, self, other)

    def __ror__(self, other: Any) -> Condition:
        return _Joined(" | ", np.max, other, self)

    def __invert__(self) -> Condition:
        return _Not(self)

    def __bool__(self) -> bool:
        raise TypeError(
            "a condition is neither true nor false by itself: join conditions with &, | and ~ (in brackets)"
        )


def touched(label: str | None = None, topic: str | None = None) -> Condition:
    """A touch sensor is touched.

    Args:
        label: the name of the sensor; None: any sensor.
        topic: as in `Recording.touches`.
    """
    return _Touched(label, topic)


def nearest_below(distance: float, sector: Asked | None = None, topic: str | None = None) -> Condition:
    """`Scan.distance` is below a distance. Where it is NaN, neither this nor its opposite holds.

    Args:
        distance: metres.
        sector: as in `Scan.distance`.
        topic: as in `Recording.scans`.

    Raises:
        TypeError: something is no number.
        ValueError: the distance is not above 0, no such sector, or an angle is beyond a full turn either way,
            infinite or NaN.
    """
    return _NearestBelow(distance, sector, topic)


def speed_above(limit: float, axis: str = "linear.x", topic: str | None = None) -> Condition:
    """A speed is past a limit, in either direction.

    Args:
        limit: m/s or rad/s, 0 or more.
        axis: one of `robowidgets.samples.AXES`: linear.x (forward) to angular.z (yaw).
        topic: as in `Recording.speeds`.

    Raises:
        TypeError: the limit is no number.
        ValueError: the limit is below 0 or NaN, or there is no such axis.
    """
    return _SpeedAbove(limit, axis, topic)


def gap(seconds: float, topic: str | None = None) -> Condition:
    """No sample came for longer than some time: from one sample to the next, or to the end of the recording.

    Each silence is a span of its own, even if only one sample lies between two of them.

    Args:
        seconds: above 0.
        topic: None: any topic of scans or measured speeds. Touch sensors and commands may be silent for long.

    Raises:
        TypeError: ``seconds`` is no number.
        ValueError: the number is not above 0.
        UnknownTopicError: raised by `Recording.find` if no topic is named and none has scans or measured speeds.
    """
    return _Gap(seconds, topic)


def when(function: Callable[[Any], Any]) -> Condition:
    """A function of one moment is true; see `Recording.find`."""
    return _When(function)


def condition(given: Any) -> Condition:
    """A condition, or the function of one moment as a condition; TypeError for anything else."""
    if isinstance(given, Condition):
        return given
    if callable(given):
        return when(given)
    raise TypeError(f"condition: expected a function of one moment, or one of robowidgets.conditions, got {given!r}")


class _When(Function, Condition):
    """A function of one moment as a condition."""


class _Joined(Condition):
    def __init__(self, word: str, how: Callable[..., Any], *parts: Any) -> None:
        self._word = word
        self._how = how
        self._parts = [condition(part) for part in parts]

    def steps(self, search: Search) -> Steps:
        return combined([part.steps(search) for part in self._parts], self._how)

    def __str__(self) -> str:
        return f"({self._word.join(map(str, self._parts))})"


class _Not(Condition):
    def __init__(self, part: Condition) -> None:
        self._part = part

    def steps(self, search: Search) -> Steps:
        return inverted(self._part.steps(search))

    def __str__(self) -> str:
        return f"~{self._part}"


class _Touched(Condition):
    def __init__(self, label: str | None, topic: str | None) -> None:
        if label is not None and not isinstance(label, str):
            raise TypeError(f"label: expected the name of a sensor, got {label!r}")
        self._label = label
        self._topic = topic

    def steps(self, search: Search) -> Steps:
        touches = search.recording.touches(self._topic)
        labels = touches.labels
        if self._label is not None and self._label not in labels:
            there = ", ".join(labels) or "none"
            raise ValueError(f"label: {touches.topic} has no sensor {self._label!r}; it has {there}")
        states = touches.states if self._label is None else touches.states[:, [labels.index(self._label)]]
        is_touched = (states == TouchState.TOUCHED).any(axis=1)
        is_known = touches.lists_touches | (states != TouchState.UNKNOWN).any(axis=1)
        return steps(touches.times_ns, np.where(is_touched, YES, np.where(is_known, NO, UNKNOWN)))

    def __str__(self) -> str:
        return f"{self._label or 'anything'} touched"


class _NearestBelow(Condition):
    def __init__(self, distance: float, sector: Asked | None, topic: str | None) -> None:
        self._distance = number("distance", distance)
        if not 0 < self._distance < inf:
            raise ValueError(f"distance: expected metres above 0, got {self._distance!r}")
        self._sector = None if sector is None else to_sector(sector)
        self._where = ""
        if self._sector is not None:
            named = isinstance(sector, str)
            self._where = f" in {sector}" if named else " between {:g} and {:g} rad".format(*self._sector)
        self._topic = topic

    def steps(self, search: Search) -> Steps:
        return search.over(search.recording.scans(self._topic), self._test)

    def _test(self, chunk: ScanChunk) -> NDArray[np.int8]:
        away = distances(chunk.ranges, chunk.like, self._sector)
        return np.where(np.isnan(away), UNKNOWN, np.where(away < np.float32(self._distance), YES, NO)).astype(np.int8)

    def __str__(self) -> str:
        return f"nearest below {self._distance:g} m{self._where}"


class _SpeedAbove(Condition):
    def __init__(self, limit: float, axis: str, topic: str | None) -> None:
        self._limit = number("limit", limit)
        if not self._limit >= 0:
            raise ValueError(f"limit: expected a speed, 0 or more, got {self._limit!r}")
        if axis not in AXES:
            raise ValueError(f"axis: expected one of {', '.join(AXES)}, got {axis!r}")
        self._axis = axis
        self._topic = topic

    def steps(self, search: Search) -> Steps:
        return search.over(search.recording.speeds(self._topic), self._test)

    def _test(self, chunk: SpeedChunk) -> NDArray[np.int8]:
        values = chunk.values[:, AXES.index(self._axis)]
        return np.where(np.isnan(values), UNKNOWN, np.where(np.abs(values) > self._limit, YES, NO)).astype(np.int8)

    def __str__(self) -> str:
        return f"{self._axis} above {self._limit:g} {'m' if self._axis.startswith('linear') else 'rad'}/s"


class _Gap(Condition):
    def __init__(self, seconds: float, topic: str | None) -> None:
        self._seconds = number("seconds", seconds)
        if not 0 < self._seconds < inf:
            raise ValueError(f"seconds: expected a time above 0, got {self._seconds!r}")
        self._topic = topic

    def steps(self, search: Search) -> Steps:
        silences = [(name, self._of(search, name)) for name in self._topics(search)]
        search.silences += silences
        return combined([when for _, when in silences], np.max)

    def _topics(self, search: Search) -> Sequence[str]:
        if self._topic is not None:
            return [self._topic]
        shown = [topic for topic in search.recording.topics if topic.widget]
        found = [topic.name for topic in shown if KINDS[topic.widget or ""].goes_stale and not topic.commanded]
        if found:
            return found
        there = f"{search.recording.path.name} has neither laser scans nor measured speeds"
        if not shown:
            raise UnknownTopicError(there)
        raise UnnamedTopicError(there, [topic.name for topic in shown], None)

    def _of(self, search: Search, topic: str) -> Steps:
        series = search.recording.series(topic)
        times = search.times(series)
        # Without rows for releases, which no message told of.
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

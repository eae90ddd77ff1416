"""Ready-made conditions for `Recording.find` and for `watch` of a widget, joined by ``&``, ``|`` and ``~``.

`Recording.find` computes a condition for whole columns; `Condition.judge` applies the same test to one sample. The last
scan or speed before a silence is stale one usual step after its time; a silence is a pause of more than 2 s and more
than two usual steps. The state of a touch sensor lasts until its next message.

Examples:
    >>> from robowidgets import conditions
    >>> recording.find(conditions.touched() & conditions.nearest_below(0.3))  # doctest: +SKIP
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from math import degrees, inf
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...behaviors.version import RATE
from ...kinds import KINDS, Kind, kind_of_class
from ...samples import AXES, HasAge, Scan, Speed, Touch, TouchMode, TouchState
from ...samples.checks import number
from ...samples.distances import distances, inside, ray_distances
from ...samples.sector import ALL_ROUND, SectorLike, to_sector
from ...samples.verdict import Verdict, fact
from ..columns.chunks import ScanChunk, SpeedChunk, single_scan, single_speed
from ..topics import UnknownTopicError, UnnamedTopicError
from ._events import EventCondition
from ._fields import Field
from ._labels import LabelCondition
from ._steps import NO, UNKNOWN, YES, Steps, combined, steps
from ._stops import StopsCondition
from .base import VALUES, Condition, Curve, FunctionCondition, UndecidedCondition
from .instant import NoSampleYetError
from .seconds import SPEEDS, Possible, SecondRows

if TYPE_CHECKING:
    from .. import RecordingData
    from ._search import Search

__all__ = ["Condition", "event", "field", "gap", "label", "nearest_below", "speed_above", "stops", "touched", "when"]


def touched(label: str | None = None, topic: str | None = None) -> Condition:
    """Return the condition that a touch sensor is touched.

    Args:
        label: the name of the sensor, or None for any.
        topic: as in `Recording.touches`.
    """
    return _Touched(label, topic)


def nearest_below(distance: float, sector: SectorLike = ALL_ROUND, topic: str | None = None) -> Condition:
    """Return the condition that `Scan.distance` is below a distance. It is unknown if the distance is NaN.

    Args:
        distance: metres.
        sector: as in `Scan.distance`.
        topic: as in `Recording.scans`.

    Raises:
        TypeError: an argument is not a number.
        ValueError: the distance is not above 0, the sector does not exist, or an angle is beyond a full turn, infinite
            or NaN.
    """
    return _NearestBelow(distance, sector, topic)


def speed_above(limit: float, axis: str = "linear.x", topic: str | None = None) -> Condition:
    """Return the condition that a speed is past a limit, in either direction.

    Args:
        limit: m/s or rad/s, 0 or more.
        axis: one of `robowidgets.samples.AXES`: linear.x (forward) to angular.z (yaw).
        topic: as in `Recording.speeds`.

    Raises:
        TypeError: the limit is not a number.
        ValueError: the limit is below 0 or NaN, or the axis does not exist.
    """
    return _SpeedAbove(limit, axis, topic)


def gap(seconds: float, topic: str | None = None) -> Condition:
    """Return the condition that no sample came for longer than some time, up to the next sample or the end.

    Each silence is a separate span, even if only one sample lies between two of them.

    Args:
        seconds: the length of the gap, above 0.
        topic: a topic, or None for any topic of scans, measured speeds or sonars. Touch sensors and commands may be
            silent for long.

    Raises:
        TypeError: ``seconds`` is not a number.
        ValueError: the number is not above 0.
        UnknownTopicError: raised by `Recording.find` if no topic is named, and the recording has no topic with such
            samples.
    """
    return _Gap(seconds, topic)


def event(topic: str | None = None, level: str | int | None = None, text: str | None = None) -> Condition:
    """Return the condition that an event happened, such as a log line or a pressed button; see `Recording.events`.

    It is true only at that moment, so each event is a span of 0 seconds. Joined with ``&``, it selects the events
    during which another condition is true. A watch of an `EventsWidget` judges it on the newest event.

    Args:
        topic: the topic of the event, or None for any topic with events.
        level: the lowest level: ``"DEBUG"``, ``"INFO"``, ``"WARN"``, ``"ERROR"`` or ``"FATAL"``, or None for any.
        text: a text to find in its text or its source, in any case, or None for any.

    Raises:
        TypeError, ValueError: an argument is not a name, a level or a text.

    Examples:
        >>> from robowidgets import conditions
        >>> print(conditions.event("/rosout", level="WARN", text="lost"))
        WARN or more with 'lost' on /rosout
    """
    return EventCondition(topic, level, text)


def field(name: str) -> Field:
    """Return a field of the messages of any topic, to be compared: ``field("/imu.linear_acceleration.x") > 12``.

    `Recording.find` and `Feed.watch` judge it. The condition is unknown for NaN, if an array is too short, and before
    the first message. For a topic that sends steadily, such as a sensor, it is also unknown during a silence. For any
    other topic, a value holds until the next message.

    Args:
        name: the topic with a field of its definition, such as ``"/odom.twist.twist.linear.x"`` or
            ``"/diagnostics.status[0].name"``. It is a number, a flag or a text.

    Raises:
        TypeError: ``name`` is not a text. ValueError: it names no field. Judging the condition raises UnknownTopicError
            and UnknownFieldError, which name the nearest ones, and TypeError if the field is not a number, a flag or a
            text.

    Examples:
        >>> import robowidgets
        >>> from robowidgets import conditions
        >>> recording = robowidgets.open(robowidgets.SAMPLE)
        >>> found = recording.find(conditions.field("/odom.twist.twist.linear.x") < 0)
        >>> found.condition
        '/odom.twist.twist.linear.x < 0'
    """
    return Field(name)


def stops(program: Any, rate: float = RATE) -> Condition:
    """Return the condition that a program tells the robot to stop, given recorded samples.

    ``stops(new) & ~stops(old)`` finds the differences of two programs. The program is stepped through the recording
    from its beginning. The recorded drive does not change, whatever the program does: each result is the program's
    decision at that moment of that drive. The condition is unknown, and the program is not called, until all of its
    samples have come, and while one of them is too old to drive by.

    Args:
        program: a function or a state machine, as for `robowidgets.feeds.Feed.program`, or the result of that method.
        rate: steps per second.

    Raises:
        TypeError, ValueError: as `program` of a feed.

    Example:
        >>> import robowidgets
        >>> from robowidgets.behaviors import Drive
        >>> def careful(scan):
        ...     return Drive(0.0 if scan.distance("front") < 0.5 else 0.2)
        >>> recording = robowidgets.open(robowidgets.SAMPLE)
        >>> recording.find(conditions.stops(careful)).condition
        'careful stops'
    """
    return StopsCondition(program, rate)


def label(name: str | None = None) -> Condition:
    """Return the condition that a span has a label, set with `Recording.label` or on a contact sheet.

    Args:
        name: the name of the label, or None for any.

    Raises:
        TypeError, ValueError: ``name`` is not a name.
    """
    return LabelCondition(name)


def when(function: Callable[[Any], Any]) -> Condition:
    """Return the condition that a function of one moment is true; see `Recording.find`."""
    return FunctionCondition(function)


def last(moment: Any, kind: Kind, topic: str | None) -> Any:
    """Return the last sample of a kind or a topic at a moment, or None before the first. See `Condition.judge`."""
    if isinstance(moment, HasAge):
        if not isinstance(moment, kind.sample):
            raise TypeError(f"expected a {kind.sample_name}, got a {type(moment).__name__.lower()}")
        return moment
    try:
        return moment[topic] if topic is not None else getattr(moment, kind.sample_name)
    except NoSampleYetError:
        return None


def _state(touch: Touch, name: str) -> TouchState:
    """Return the state of a sensor from one message."""
    if touch.mode is TouchMode.PRESENCE:
        return TouchState.TOUCHED if touch.touched.get(name) else TouchState.FREE
    touched = touch.touched.get(name)
    return TouchState.UNKNOWN if touched is None else TouchState(int(touched))


class _OfOneTopic(Condition):
    """A condition on the last sample of a kind, or of one topic of that kind."""

    kind: ClassVar[Kind]

    def __init__(self, topic: str | None) -> None:
        self._topic = topic

    def topics(self, recording: RecordingData, asked: Any) -> list[str]:  # noqa: ARG002
        return [self._topic or recording.only(self.kind.name)]

    def judge(self, moment: Any) -> Verdict:
        sample = last(moment, self.kind, self._topic)
        return Verdict(None) if sample is None else self._judge(sample)

    @property
    def reads(self) -> frozenset[str]:
        return frozenset({self.kind.sample_name})

    @abstractmethod
    def _judge(self, sample: Any) -> Verdict:
        """Return the verdict of the condition on a sample."""


class _Touched(_OfOneTopic):
    kind = kind_of_class(Touch)

    def __init__(self, label: str | None, topic: str | None) -> None:
        super().__init__(topic)
        if label is not None and not isinstance(label, str):
            raise TypeError(f"label: expected the name of a sensor, got {label!r}")
        self._label = label

    def steps(self, search: Search) -> Steps:
        touches = search.recording.touches(self._topic)
        labels = touches.labels
        if self._label is not None and self._label not in labels:
            there = ", ".join(map(repr, labels)) or "none"
            raise ValueError(f"label: {touches.topic} has no sensor {self._label!r}; it has {there}")
        search.looked_at(len(touches))
        states = touches.states if self._label is None else touches.states[:, [labels.index(self._label)]]
        return steps(touches.times_ns, self._test(states, touches.lists_touches))

    def possible(self, rows: SecondRows) -> Possible:
        return rows.judged(self.kind, self._topic, rows.touched(self._label))

    def _judge(self, touch: Touch) -> Verdict:
        lists_touches = touch.mode is TouchMode.PRESENCE
        if self._label is not None and self._label not in touch.sensors and not lists_touches:
            # While a sensor that only sends events is silent, its state is unknown.
            return Verdict(None, f"nothing of {self._label!r} yet")
        names = touch.sensors if self._label is None else (self._label,)
        states = np.array([[_state(touch, name) for name in names]], np.uint8)
        touched = [name for name, state in zip(names, states[0], strict=True) if state == TouchState.TOUCHED]
        return Verdict(VALUES[int(self._test(states, lists_touches)[0])], ", ".join(touched))

    @staticmethod
    def _test(states: NDArray[np.uint8], lists_touches: bool) -> NDArray[np.int8]:
        """Return the values for the states of some sensors, shape (N, L)."""
        is_touched = (states == TouchState.TOUCHED).any(axis=1)
        is_known = lists_touches | (states != TouchState.UNKNOWN).any(axis=1)
        return np.where(is_touched, YES, np.where(is_known, NO, UNKNOWN)).astype(np.int8)

    def __str__(self) -> str:
        return f"{self._label or 'anything'} touched"


class _NearestBelow(_OfOneTopic):
    kind = kind_of_class(Scan)

    def __init__(self, distance: float, sector: SectorLike, topic: str | None) -> None:
        super().__init__(topic)
        self._distance = number("distance", distance)
        if not 0 < self._distance < inf:
            raise ValueError(f"distance: expected metres above 0, got {self._distance!r}")
        self._sector = to_sector(sector)
        self._where = ""
        if self._sector is not ALL_ROUND:
            start, end = (f"{degrees(angle):.4g}°" for angle in (self._sector.start, self._sector.end))
            angles = f"between {start} and {end}"
            self._where = f" in {sector}" if isinstance(sector, str) else f" {angles}"

    def steps(self, search: Search) -> Steps:
        def test(chunk: ScanChunk) -> NDArray[np.int8]:
            values = self._test(chunk)
            self._note_nearest(search, chunk, np.flatnonzero(values == YES))
            return values

        return search.over(search.recording.scans(self._topic), test)

    def possible(self, rows: SecondRows) -> Possible:
        return rows.judged(self.kind, self._topic, rows.nearest(self._sector) < np.float32(self._distance))

    def _note_nearest(self, search: Search, chunk: ScanChunk, rows: NDArray[np.intp]) -> None:
        """Note the nearest readings in the scans for which the condition is true."""
        if not rows.size:
            return
        away = ray_distances(chunk.ranges[rows], chunk.like)
        away[:, ~inside(chunk.like, self._sector)] = np.inf
        away[np.isnan(away)] = np.inf
        indices = away.argmin(axis=1)
        search.met(chunk.times_ns[rows], away.min(axis=1), indices, chunk.like.angles[indices])

    def _judge(self, scan: Scan) -> Verdict:
        value = VALUES[int(self._test(single_scan(scan, 0))[0])]
        text = "" if value is None else fact(scan.distance(self._sector), "<", self._distance)
        if not value:
            return Verdict(value, text)
        is_near = ray_distances(scan.ranges, scan) < np.float32(self._distance)
        return Verdict(value, text, np.flatnonzero(is_near & inside(scan, self._sector)), scan.nearest(self._sector))

    def _test(self, chunk: ScanChunk) -> NDArray[np.int8]:
        away = distances(chunk.ranges, chunk.like, self._sector)
        return np.where(np.isnan(away), UNKNOWN, np.where(away < np.float32(self._distance), YES, NO)).astype(np.int8)

    def __str__(self) -> str:
        return f"nearest below {self._distance:g} m{self._where}"


class _SpeedAbove(_OfOneTopic):
    kind = kind_of_class(Speed)

    def __init__(self, limit: float, axis: str, topic: str | None) -> None:
        super().__init__(topic)
        self._limit = number("limit", limit)
        if not self._limit >= 0:
            raise ValueError(f"limit: expected a speed, 0 or more, got {self._limit!r}")
        if axis not in AXES:
            raise ValueError(f"axis: expected one of {', '.join(AXES)}, got {axis!r}")
        self._axis = axis

    def steps(self, search: Search) -> Steps:
        def test(chunk: SpeedChunk) -> NDArray[np.int8]:
            values = self._test(chunk)
            speeds = chunk.values[values == YES, AXES.index(self._axis)]
            search.compared(self, chunk.times_ns[values == YES], speeds, -np.abs(speeds))
            return values

        return search.over(search.recording.speeds(self._topic), test)

    def possible(self, rows: SecondRows) -> Possible:
        least, most = (rows[name] for name in SPEEDS[self._axis])
        true = (most > self._limit) | (least < -self._limit)
        return rows.judged(self.kind, self._topic, true, (least <= self._limit) & (most >= -self._limit))

    def number(self, recording: RecordingData) -> Curve:
        speeds = recording.speeds(self._topic)
        return Curve(speeds.times_ns, speeds.values[:, AXES.index(self._axis)])

    def _judge(self, speed: Speed) -> Verdict:
        value = VALUES[int(self._test(single_speed(speed, 0))[0])]
        size = abs(speed.values[AXES.index(self._axis)])
        return Verdict(value, "" if value is None else fact(size, ">", self._limit, self._unit))

    @property
    def _unit(self) -> str:
        return f"{'m' if self._axis.startswith('linear') else 'rad'}/s"

    def _test(self, chunk: SpeedChunk) -> NDArray[np.int8]:
        values = chunk.values[:, AXES.index(self._axis)]
        return np.where(np.isnan(values), UNKNOWN, np.where(np.abs(values) > self._limit, YES, NO)).astype(np.int8)

    def __str__(self) -> str:
        return f"{self._axis} above {self._limit:g} {self._unit}"


class _Gap(UndecidedCondition):
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

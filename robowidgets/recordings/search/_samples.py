"""Conditions on the last sample of one topic: touched, near, fast."""

from __future__ import annotations

from abc import abstractmethod
from math import degrees, inf
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...kinds import Kind, kind_of_class
from ...samples import AXES, HasAge, Scan, Speed, Touch, TouchMode, TouchState
from ...samples.checks import number
from ...samples.distances import distances, inside, ray_distances
from ...samples.sector import ALL_ROUND, SectorLike, to_sector
from ...samples.verdict import Verdict, fact
from ..columns.chunks import ScanChunk, SpeedChunk, single_scan, single_speed
from ._steps import NO, UNKNOWN, YES, Steps, steps
from .base import VALUES, Condition, Curve
from .instant import NoSampleYetError
from .seconds import SPEEDS, Possible, SecondRows

if TYPE_CHECKING:
    from .. import RecordingData
    from ._search import Search


def _last(moment: Any, kind: Kind, topic: str | None) -> Any:
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
        sample = _last(moment, self.kind, self._topic)
        return Verdict(None) if sample is None else self._judge(sample)

    @property
    def reads(self) -> frozenset[str]:
        return frozenset({self.kind.sample_name})

    @abstractmethod
    def _judge(self, sample: Any) -> Verdict:
        """Return the verdict of the condition on a sample."""


class TouchedCondition(_OfOneTopic):
    """The condition that a touch sensor is touched; see `touched`."""

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


class NearestCondition(_OfOneTopic):
    """The condition that the nearest reading is below a distance; see `nearest_below`."""

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
            self._note_nearest(search, chunk, values == YES)
            return values

        return search.over(search.recording.scans(self._topic), test)

    def possible(self, rows: SecondRows) -> Possible:
        return rows.judged(self.kind, self._topic, rows.nearest(self._sector) < np.float32(self._distance))

    def _note_nearest(self, search: Search, chunk: ScanChunk, is_true: NDArray[np.bool_]) -> None:
        """Note the nearest readings in the scans for which the condition is true."""
        away = ray_distances(chunk.ranges[is_true], chunk.like)
        away[:, ~inside(chunk.like, self._sector)] = np.inf
        away[np.isnan(away)] = np.inf
        indices = away.argmin(axis=1) if away.size else np.empty(0, np.intp)  # scans may have no ray at all
        search.met(chunk.times_ns, is_true, away.min(axis=1, initial=np.inf), indices, chunk.like.angles[indices])

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


class SpeedCondition(_OfOneTopic):
    """The condition that a speed is past a limit; see `speed_above`."""

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
            search.compared(self, chunk.times_ns, values == YES, speeds, -np.abs(speeds))
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

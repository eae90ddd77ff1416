"""What a recording holds in each of its seconds, and what that says of conditions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, pi
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..kinds import KINDS, LASER, SPEED, TOUCH, Kind
from ..recordings.odometry import odometry
from ..recordings.topics import UnknownTopicError
from ..samples import AXES, TouchState
from ..samples.checks import ANGLE_ROUNDING
from ..samples.distances import inside, ray_distances
from ..samples.sector import ALL_ROUND, SECTORS, Sector
from ..samples.staleness import RECORDED, usual_step

if TYPE_CHECKING:
    from ..recordings import RecordingData
    from ..recordings.columns.speeds import Speeds

Numbers = NDArray[np.floating[Any]]
Flags = NDArray[np.bool_]

SECOND = 1_000_000_000
NEAREST = ("nearest", *SECTORS)
"""Metres to the nearest thing, all round and in each quarter."""
SPEEDS = {axis: (f"{axis.replace('.', '_')}_min", f"{axis.replace('.', '_')}_max") for axis in AXES}
"""The least and the greatest speed, by axis."""
POSE = ("x", "y", "yaw")
NUMBERS = (*NEAREST, *(name for names in SPEEDS.values() for name in names), "gap", *POSE)
BETWEEN = ", "
"""Between the names of several sensors."""


class Possible(NamedTuple):
    """Whether a condition may be true, and whether it may be false, in each of some seconds, shape (N,)."""

    true: Flags
    false: Flags


class Texts(NamedTuple):
    """A column of texts: for each row the number of one, shape (N,), -1 for none."""

    numbers: NDArray[np.integer[Any]]
    texts: Sequence[str]

    def where(self, holds: Mapping[str, bool]) -> Flags:
        """What holds of the text in each row; False without one."""
        found: Flags = np.array([*(holds[text] for text in self.texts), False], bool)[self.numbers]
        return found


class SecondRows:
    """Rows of an index, each for a second of a recording; see `seconds_of`.

    Args:
        numbers: the columns of `NUMBERS` that were read; NaN where nothing is known.
        texts: ``scan``, ``speed`` and ``touch``, the topics that were looked at; ``touched``, the sensors that were,
            and ``sensors``, all of them.
    """

    def __init__(self, numbers: Mapping[str, Numbers], texts: Mapping[str, Texts]) -> None:
        self._numbers, self._texts = numbers, texts

    def __len__(self) -> int:
        return len(self._texts["scan"].numbers)

    def __getitem__(self, name: str) -> Numbers:
        return self._numbers[name]

    def nearest(self, sector: Sector) -> Numbers:
        """No more than the metres to the nearest thing in a sector."""
        if sector is ALL_ROUND:
            return self["nearest"]
        nearest: Numbers = np.fmin.reduce([self[name] for name, part in SECTORS.items() if _overlap(part, sector)])
        return nearest

    def touched(self, label: str | None) -> Flags:
        """Whether a sensor was touched, or may have been: there is none of this name."""
        touched = {text: bool(text) if label is None else label in text for text in self._texts["touched"].texts}
        sensors = {
            text: label is not None and label not in text.split(BETWEEN) for text in self._texts["sensors"].texts
        }
        return self._texts["touched"].where(touched) | self._texts["sensors"].where(sensors)

    def judged(self, kind: Kind, topic: str | None, true: Flags, false: Flags | bool = True) -> Possible:
        """What may be, where a topic was looked at; where it was not, anything.

        Args:
            kind: of the topic.
            topic: its name; None: the only one, or the one that is meant.
            true: whether the condition may be true.
            false: whether it may be false.
        """
        column = self._texts[kind.sample_name]
        is_unknown = ~column.where({text: topic in (None, text) for text in column.texts})
        return Possible(true | is_unknown, false | is_unknown)


def seconds_of(recording: RecordingData) -> dict[str, Any]:
    """The columns of a recording for an index, as arrays, and as lists of texts where they differ by row.

    A row is for a second in which a message came, the first and the last one; it holds until the next row. It tells of
    the samples that came in it and of the last before, unless that was stale: all that a condition may look at then.
    """
    start, end = recording.start_ns, recording.end_ns
    if start is None or end is None:
        return {"second": np.empty(0, np.int64)}
    scans, speeds, touches = (_series(recording, kind) for kind in (LASER, SPEED, TOUCH))
    placed = odometry(recording.topics)
    poses = recording.speeds(placed) if placed else None
    regular = [
        recording.series(topic.name)
        for topic in recording.topics
        if topic.widget and KINDS[topic.widget].goes_stale and not topic.commanded
    ]
    came = [one.times_ns for one in (scans, speeds, touches, poses, *regular) if one is not None]
    ends = np.array([start, end], np.int64)
    second = np.unique((np.concatenate((ends, *came)) - start) // SECOND)
    starts = start + second * SECOND
    found: dict[str, Any] = {"second": second, **{name: np.full(len(second), np.nan) for name in NUMBERS}}
    if scans is not None:
        times, nearest = _nearest(scans)
        for name, column in zip(NEAREST, nearest, strict=True):
            found[name] = _over(times, column, starts, np.fmin, _in_force(times))
    if speeds is not None:
        for column, names in zip(_values(speeds), SPEEDS.values(), strict=True):
            for name, how in zip(names, (np.fmin, np.fmax), strict=True):
                found[name] = _over(speeds.times_ns, column, starts, how, _in_force(speeds.times_ns))
    if touches is not None:
        found["sensors"] = BETWEEN.join(touches.labels)
        found["touched"] = _touched(touches, starts)
    if poses is not None:
        begin, stop = _parts(poses.times_ns, starts, _in_force(poses.times_ns))
        values = np.concatenate((poses.poses, np.full((1, 3), np.nan)))
        picked = values[np.where(begin < stop, begin, -1)]
        found |= dict(zip(POSE, picked.T, strict=True))
    for one in regular:
        edges = np.unique(np.concatenate((ends[:1], one.times_ns[one.said], ends[1:])))
        silence = _over(edges[:-1], np.diff(edges) / SECOND, starts, np.fmax, inf)
        found["gap"] = np.fmax(found["gap"], silence)
    for kind, one in ((LASER, scans), (SPEED, speeds), (TOUCH, touches)):
        found[kind.sample_name] = None if one is None else one.topic
    return found


def _series(recording: RecordingData, kind: Kind) -> Any:
    """The samples of the topic that is meant; None where there is none, or several."""
    try:
        return recording.series(recording.only(kind.name))
    except UnknownTopicError:
        return None


def _values(speeds: Speeds) -> Numbers:
    """The speeds by axis, shape (6, N)."""
    values: Numbers = np.concatenate((speeds.linear, speeds.angular), axis=1).T
    return values


def _nearest(scans: Any) -> tuple[NDArray[np.int64], Numbers]:
    """The times of scans, and the nearest thing by quarter, shape (5, N)."""
    times: list[NDArray[np.int64]] = [np.empty(0, np.int64)]
    least: list[Numbers] = [np.empty((len(NEAREST), 0), np.float32)]
    for chunk in scans.chunks():
        away = ray_distances(chunk.ranges, chunk.like)
        parts = [away, *(away[:, inside(chunk.like, quarter)] for quarter in SECTORS.values())]
        least.append(np.array([np.fmin.reduce(part, axis=1, initial=np.nan) for part in parts]))
        times.append(chunk.times_ns)
    return np.concatenate(times), np.concatenate(least, axis=1)


def _touched(touches: Any, starts: NDArray[np.int64]) -> list[str]:
    is_touched = np.concatenate((touches.states == TouchState.TOUCHED, np.zeros((1, len(touches.labels)), bool)))
    begin, stop = _parts(touches.times_ns, starts, inf)
    rows = [np.flatnonzero(is_touched[a:b].any(axis=0)) for a, b in zip(begin, stop, strict=True)]
    return [BETWEEN.join(touches.labels[i] for i in row) for row in rows]


def _in_force(times: NDArray[np.int64]) -> float:
    """Nanoseconds for which a sample of a topic counts at most when no other follows."""
    return RECORDED.after(usual_step(times), SECOND)


def _parts(times: NDArray[np.int64], starts: NDArray[np.int64], longest: float) -> tuple[Any, Any]:
    """From which sample to which each row tells, shape (M,) each: with the last before, if that is not too old."""
    first = np.searchsorted(times, starts)
    stop = np.append(first[1:], len(times))
    is_late = first == 0
    if len(times):
        is_late |= starts - times[first - 1] > longest
    return np.where(is_late, first, first - 1), stop


def _over(
    times: NDArray[np.int64], values: Numbers, starts: NDArray[np.int64], how: np.ufunc, longest: float
) -> Numbers:
    """The least or greatest value in each row, as float32 where the values are; NaN where there is none."""
    begin, stop = _parts(times, starts, longest)
    # Of each pair of edges the part between them; one more value, because an edge must be an index.
    edges = np.stack((begin, stop), axis=1).ravel()
    found = how.reduceat(np.append(values, np.array(np.nan, values.dtype)), edges)[::2]
    return np.where(begin < stop, found, np.array(np.nan, values.dtype))


def _overlap(one: Sector, other: Sector) -> bool:
    """Whether two sectors may have a ray in common."""
    slack = 10 * ANGLE_ROUNDING
    return any((b.start - a.start + slack) % (2 * pi) <= a.sweep + 2 * slack for a, b in ((one, other), (other, one)))

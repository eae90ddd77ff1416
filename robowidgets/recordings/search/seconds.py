"""A summary of each second of a recording, and the possible values of conditions in it."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from math import inf, pi
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...kinds import KINDS, Kind, kind_of_class, topic_and_field
from ...samples import AXES, Scan, Speed, Touch, TouchState
from ...samples.checks import ANGLE_ROUNDING
from ...samples.distances import inside, ray_distances
from ...samples.sector import ALL_ROUND, SECTORS, Sector
from ...samples.staleness import RECORDED, usual_step
from ..columns._fields import UnknownFieldError
from ..odometry import odometry
from ..topics import UnknownTopicError

if TYPE_CHECKING:
    from .. import RecordingData
    from ..columns.speeds import Speeds

Numbers = NDArray[np.floating[Any]]
Flags = NDArray[np.bool_]

SECOND = 1_000_000_000
NEAREST = ("nearest", *SECTORS)
"""The nearest distance in metres, all round and in each quarter."""
SPEEDS = {axis: (f"{axis.replace('.', '_')}_min", f"{axis.replace('.', '_')}_max") for axis in AXES}
"""The lowest and the highest speed, by axis."""
POSE = ("x", "y", "yaw")
NUMBERS = (*NEAREST, *(name for names in SPEEDS.values() for name in names), "gap", *POSE)
BETWEEN = ", "
"""The separator between the names of several sensors."""
EXACT = 2**53
"""The largest size of an integer that a column of numbers has exactly."""
_MANY = 16
"""A row has so many different texts of a field at most."""


class Possible(NamedTuple):
    """True if a condition may be true, and True if it may be false, in each of some seconds, shape (N,)."""

    true: Flags
    false: Flags


class Texts(NamedTuple):
    """A column of texts: for each row the number of its text, shape (N,), or -1 for no text."""

    numbers: NDArray[np.integer[Any]]
    texts: Sequence[str]

    def where(self, holds: Mapping[str, bool]) -> Flags:
        """Return the flag of the text in each row, or False without a text."""
        found: Flags = np.array([*(holds[text] for text in self.texts), False], bool)[self.numbers]
        return found


class FieldRange(NamedTuple):
    """The values of a field in each row of an index.

    ``least``, ``most``: shape (N,), NaN for a field of texts, and if all its values are NaN or no message has come.
    ``kinds``: its type in the recording; for a field of texts, a list of the different ones as JSON. A row without one
    does not have the values.
    """

    least: Numbers
    most: Numbers
    kinds: Texts

    def texts(self) -> dict[str, list[str]]:
        """Return the texts of a field of texts, by the text of its kind."""
        return {kind: json.loads(kind) for kind in self.kinds.texts if kind.startswith("[")}


class SecondRows:
    """Rows of an index, each for a second of a recording; see `seconds_of`.

    Args:
        numbers: the columns of `NUMBERS` that were read; NaN for unknown values. For each field, both `field_columns`.
        texts: ``scan``, ``speed`` and ``touch``, the topics of these samples; ``touched``, the touched sensors, and
            ``sensors``, all sensors. For each field its kinds, by its name.
    """

    def __init__(self, numbers: Mapping[str, Numbers], texts: Mapping[str, Texts]) -> None:
        self._numbers, self._texts = numbers, texts

    def __len__(self) -> int:
        return len(self._texts["scan"].numbers)

    def __getitem__(self, name: str) -> Numbers:
        return self._numbers[name]

    def field(self, name: str) -> FieldRange | None:
        """Return the values of a field, or None if the index does not have it."""
        if name not in self._texts:
            return None
        least, most = (self._numbers[column] for column in field_columns(name))
        return FieldRange(least, most, self._texts[name])

    def nearest(self, sector: Sector) -> Numbers:
        """Return a lower limit of the nearest distance in a sector in metres."""
        if sector is ALL_ROUND:
            return self["nearest"]
        nearest: Numbers = np.fmin.reduce([self[name] for name, part in SECTORS.items() if _overlap(part, sector)])
        return nearest

    def touched(self, label: str | None) -> Flags:
        """Return True if a sensor was touched, or if no sensor has this label, so that it may have been."""
        touched = {text: bool(text) if label is None else label in text for text in self._texts["touched"].texts}
        sensors = {
            text: label is not None and label not in text.split(BETWEEN) for text in self._texts["sensors"].texts
        }
        return self._texts["touched"].where(touched) | self._texts["sensors"].where(sensors)

    def judged(self, kind: Kind, topic: str | None, true: Flags, false: Flags | bool = True) -> Possible:
        """Return the possible values: the given ones if the topic was read, otherwise both.

        Args:
            kind: the kind of the topic.
            topic: its name, or None for the only or preferred topic.
            true: True if the condition may be true.
            false: True if it may be false.
        """
        column = self._texts[kind.sample_name]
        is_unknown = ~column.where({text: topic in (None, text) for text in column.texts})
        return Possible(true | is_unknown, false | is_unknown)


def field_columns(name: str) -> tuple[str, str]:
    """Return the names of the columns with the least and the greatest value of a field."""
    return f"{name}_min", f"{name}_max"


def seconds_of(recording: RecordingData, fields: Collection[str] = ()) -> dict[str, Any]:
    """Return the columns of a recording for an index as arrays, or as lists of texts that differ by row.

    Each second with a message has a row, and so have the first and the last second. A row is valid until the next one.
    It covers the samples of its second and the last one before, unless that was stale: all samples on which a condition
    can depend then.

    Args:
        recording: the recording.
        fields: the names of fields of topics, whose values are columns too.
    """
    start, end = recording.start_ns, recording.end_ns
    if start is None or end is None:
        return {"second": np.empty(0, np.int64)}
    kinds = [kind_of_class(sample) for sample in (Scan, Speed, Touch)]
    scans, speeds, touches = (_series(recording, kind) for kind in kinds)
    placed = odometry(recording.topics)
    poses = recording.speeds(placed) if placed else None
    regular = [
        recording.series(topic.name)
        for topic in recording.topics
        if topic.widget and KINDS[topic.widget].goes_stale and not topic.commanded
    ]
    columns = {name: column for name in fields if (column := _field(recording, name)) is not None}
    came = [one.times_ns for one in (scans, speeds, touches, poses, *regular, *columns.values()) if one is not None]
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
    for name, column in columns.items():
        found |= _range(name, column, starts)
    for kind, one in zip(kinds, (scans, speeds, touches), strict=True):
        found[kind.sample_name] = None if one is None else one.topic
    return found


def _series(recording: RecordingData, kind: Kind) -> Any:
    """Return the samples of the only or preferred topic, or None if the topic is not unique."""
    try:
        return recording.series(recording.only(kind.name))
    except UnknownTopicError:
        return None


class _FieldColumn(NamedTuple):
    """The values of a field at the times of its topic, and its type."""

    times_ns: NDArray[np.int64]
    values: NDArray[Any]
    type_name: str


def _field(recording: RecordingData, name: str) -> _FieldColumn | None:
    """Return a field with one number, flag or text in a message, or None if an index cannot have its values."""
    topic, path = topic_and_field(name, [one.name for one in recording.topics])
    try:
        fields = recording.fields(topic)
        values, kind = fields[path], fields.types.get(path, "")
    except (UnknownTopicError, UnknownFieldError):
        return None
    if values.ndim != 1 or kind in ("time", "duration") or any(isinstance(one, np.ndarray) for one in values[:1]):
        return None
    if values.dtype.kind in "iu" and len(values) and (values.max() > EXACT or values.min() < -EXACT):
        return None
    return _FieldColumn(fields.times_ns, values, kind or values.dtype.name)


def _range(name: str, column: _FieldColumn, starts: NDArray[np.int64]) -> dict[str, Any]:
    """Return the columns of a field. Each row has the last value before it too, however old."""
    if column.values.dtype == object:
        return {name: list(_different(column, starts))}
    numbers = np.ma.filled(np.ma.asarray(column.values, np.float64), np.nan)
    least, most = (_over(column.times_ns, numbers, starts, how, inf) for how in (np.fmin, np.fmax))
    return {name: column.type_name, **dict(zip(field_columns(name), (least, most), strict=True))}


def _different(column: _FieldColumn, starts: NDArray[np.int64]) -> Iterator[str | None]:
    """Yield the different texts in each row as JSON, or None if there are too many."""
    for begin, stop in zip(*_parts(column.times_ns, starts, inf), strict=True):
        texts = sorted({one for one in column.values[begin:stop] if one is not None})
        yield json.dumps(texts) if len(texts) <= _MANY else None


def _values(speeds: Speeds) -> Numbers:
    """Return the speeds by axis, shape (6, N)."""
    values: Numbers = np.concatenate((speeds.linear, speeds.angular), axis=1).T
    return values


def _nearest(scans: Any) -> tuple[NDArray[np.int64], Numbers]:
    """Return the times of scans, and the nearest distance by quarter, shape (5, N)."""
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
    """Return the maximum number of nanoseconds for which a sample of a topic counts when no other follows."""
    return RECORDED.after(usual_step(times), SECOND)


def _parts(times: NDArray[np.int64], starts: NDArray[np.int64], longest: float) -> tuple[Any, Any]:
    """Return first and end index of the samples of each row, shape (M,) each, with the one before unless too old."""
    first = np.searchsorted(times, starts)
    stop = np.append(first[1:], len(times))
    is_late = first == 0
    if len(times):
        is_late |= starts - times[first - 1] > longest
    return np.where(is_late, first, first - 1), stop


def _over(
    times: NDArray[np.int64], values: Numbers, starts: NDArray[np.int64], how: np.ufunc, longest: float
) -> Numbers:
    """Return the least or greatest value in each row, as float32 if the values are, or NaN without values."""
    begin, stop = _parts(times, starts, longest)
    # From each pair of edges, the part between them. One more value, because an edge must be an index.
    edges = np.stack((begin, stop), axis=1).ravel()
    found = how.reduceat(np.append(values, np.array(np.nan, values.dtype)), edges)[::2]
    return np.where(begin < stop, found, np.array(np.nan, values.dtype))


def _overlap(one: Sector, other: Sector) -> bool:
    """Return True if two sectors may have a ray in common."""
    slack = 10 * ANGLE_ROUNDING
    return any((b.start - a.start + slack) % (2 * pi) <= a.sweep + 2 * slack for a, b in ((one, other), (other, one)))

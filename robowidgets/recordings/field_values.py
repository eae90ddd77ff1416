"""The numbers of a field, an axis of the speed or a sector of the scan, chunk by chunk."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..kinds import topic_and_field
from ..samples import AXES
from ..samples.distances import distances
from ..samples.sector import ALL_ROUND, SECTORS, SectorLike
from .columns._fields import Fields
from .columns.scans import Scans
from .search._fields import Field

if TYPE_CHECKING:
    from . import RecordingData

_SECTORS: dict[str, SectorLike] = {"nearest": ALL_ROUND, **SECTORS}


def check_value_name(given: Any) -> str:
    """Return the name of a request for `values_of`: the text, or ``abs(...)`` of a field.

    Raises:
        TypeError: it is not a text or a field. ValueError: it is not a sector, an axis, or a topic with a field.
    """
    if isinstance(given, Field):
        return f"abs({given.name})" if given.is_size else given.name
    if not isinstance(given, str):
        raise TypeError(f"statistics(): expected a topic with a field, a sector, an axis, or a field, got {given!r}")
    if given not in (*_SECTORS, *AXES) and not given.startswith("/"):
        there = ", ".join(map(repr, (*_SECTORS, *AXES)))
        raise ValueError(
            f"statistics(): expected a topic with a field, such as '/odom.twist.twist.linear.x', or one of {there}; "
            f"got {given!r}"
        )
    return given


def values_of(recording: RecordingData, given: Any) -> Iterator[NDArray[np.float64]]:
    """Yield the numbers of a request chunk by chunk, in any order within a chunk.

    A distance is NaN if it is unknown, inf with nothing in range, and -inf if something is too close to be measured,
    as in REP 117.

    Args:
        recording: the recording.
        given: a topic with a field or with a sector, such as ``"/scan.front"``; a sector of the only or preferred scan,
            such as ``"front"`` or ``"nearest"``; an axis of the speed, such as ``"linear.x"``; or a `Field`.

    Raises:
        UnknownTopicError, UnknownFieldError: the recording does not have it. TypeError: it is not a number.
    """
    if isinstance(given, Field):
        yield from map(np.abs, _of_topic(recording, given.name)) if given.is_size else _of_topic(recording, given.name)
    elif given in _SECTORS:
        yield from _distances(recording.scans(), given)
    elif given in AXES:
        for chunk in recording.speeds().chunks():
            yield chunk.values[:, AXES.index(given)]
    else:
        yield from _of_topic(recording, given)


def first_value(recording: RecordingData, name: str) -> Any:
    """Return the first value of a field, or None without a message."""
    topic, inner = topic_and_field(name, [one.name for one in recording.topics])
    values = recording.fields(topic)[:1][inner]
    return np.ma.getdata(values)[0] if len(values) else None


def _of_topic(recording: RecordingData, name: str) -> Iterator[NDArray[np.float64]]:
    topic, inner = topic_and_field(name, [one.name for one in recording.topics])
    fields: Fields = recording.fields(topic)
    if inner in _SECTORS and inner not in fields.names and isinstance(series := recording.series(topic), Scans):
        yield from _distances(series, inner)
    else:
        yield from fields.numbers(inner)


def _distances(scans: Scans, sector: str) -> Iterator[NDArray[np.float64]]:
    for chunk in scans.chunks():
        away = distances(chunk.ranges, chunk.like, _SECTORS[sector]).astype(np.float64)
        away[away == 0] = -np.inf  # as in `Scan.distance`, 0 is too close to be measured
        yield away

"""The numbers in fields of a recording, over time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from itertools import islice
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..kinds import topic_and_field
from ..messages.units import unit_of
from ..repair import RecordingError
from .columns._fields import Fields
from .topics import Topic

_MOST = 2000
"""The maximum number of field names from which the user can choose."""

_NUMBERS = ("int", "uint", "float", "bool")


class Fielded(Protocol):
    """A recording, or a part of it."""

    @property
    def topics(self) -> tuple[Topic, ...]:
        """Its topics."""

    def fields(self, topic: str) -> Fields:
        """Return the messages of a topic with each field as a column."""


class FieldLine(NamedTuple):
    """A number of a topic over time: its name with the topic, seconds, values as float64, and its unit, if known."""

    name: str
    seconds: NDArray[np.float64]
    values: NDArray[np.float64]
    unit: str


def field_lines(source: Fielded, field: str, most: int) -> list[FieldLine]:
    """Return each number in a field of a topic, or in a message within the field.

    Args:
        source: the recording.
        field: the topic with the field: ``"/odom.twist.twist.linear"``.
        most: the maximum number of values for a topic that is named without a field.

    Raises:
        UnknownTopicError: the topic does not exist, or its messages cannot be read.
        KeyError: the messages have no such field. TypeError: the field has no single numbers, or the topic has more
            than `most`.
    """
    topic, inner = topic_and_field(field, [one.name for one in source.topics])
    part = source.fields(topic)
    if inner:
        part = part[[inner]]
    names = list(numbers_in(part))
    if not names or (not inner and len(names) > most):
        has = ", ".join(f"{topic}.{name}" for name in names) or ", ".join(f"{n} ({t})" for n, t in part.types.items())
        raise TypeError(f"{field!r} is not one number; there are {has}")
    kind = next(one.type for one in source.topics if one.name == topic)
    table = part[names].to_numpy()
    seconds = np.asarray(table["seconds"], np.float64)
    columns = ((name, table.get(name, table.get(f"{name}_"))) for name in names)
    return [
        FieldLine(
            f"{topic}.{name}", seconds, np.ma.filled(np.ma.asarray(values, np.float64), np.nan), unit_of(kind, name)
        )
        for name, values in columns
    ]


def numbers_in(fields: Fields) -> Iterator[str]:
    """Yield the names of the fields that hold one number each."""
    for name, type_name in fields.types.items():
        if type_name.startswith(_NUMBERS) and (name.endswith("]") or not type_name.endswith("]")) and "[]" not in name:
            yield name


def choices(source: Fielded) -> list[str]:
    """Return the names of all fields that hold one number each, of all readable topics; 2,000 at most."""
    found: list[str] = []
    for topic in source.topics:
        with suppress(RecordingError):  # its messages cannot be read
            found += (f"{topic.name}.{name}" for name in islice(numbers_in(source.fields(topic.name)), _MOST))
    return found[:_MOST]

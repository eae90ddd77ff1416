"""Conditions on a field of the messages of any topic: ``field("/imu.linear_acceleration.x") > 12``."""

from __future__ import annotations

from collections.abc import Mapping
from math import isnan
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...kinds import KINDS, topic_and_field
from ...messages.fields import FieldOf, ShortArrayError
from ...messages.units import unit_of
from ...samples.checks import number
from ...samples.staleness import is_steady
from ...samples.verdict import OPERATORS, OPPOSITE, Verdict, fact
from ..topics import UnknownTopicError
from ._silence import mark_stale
from ._steps import NO, UNKNOWN, YES, Steps, steps
from .base import Condition, Curve
from .instant import NoSampleYetError
from .seconds import EXACT, Possible, SecondRows

if TYPE_CHECKING:
    from .. import RecordingData
    from ._search import Search

_SIGNS = {"≤": "<=", "≥": ">=", "=": "==", "≠": "!="}


class Field:
    """A field of the messages of a topic. Comparing it makes a condition; `conditions.field` makes the field.

    ``<``, ``<=``, ``>``, ``>=``, ``==`` and ``!=`` compare it to a number, a flag or a text, `between` to two numbers;
    ``abs(field)`` is its absolute value.
    """

    __hash__ = None  # type: ignore[assignment]  # not hashable: == makes a condition

    def __init__(self, name: str, *, is_size: bool = False) -> None:
        expected = f"field: expected a topic with a field, such as '/odom.twist.twist.linear.x', got {name!r}"
        if not isinstance(name, str):
            raise TypeError(expected)
        if "." not in name.strip("."):
            raise ValueError(expected)
        self.name, self.is_size = name, is_size

    def __lt__(self, limit: Any) -> Condition:
        return self._compared("<", limit)

    def __le__(self, limit: Any) -> Condition:
        return self._compared("≤", limit)

    def __gt__(self, limit: Any) -> Condition:
        return self._compared(">", limit)

    def __ge__(self, limit: Any) -> Condition:
        return self._compared("≥", limit)

    def __eq__(self, value: Any) -> Condition:  # type: ignore[override]
        return self._compared("=", value)

    def __ne__(self, value: Any) -> Condition:  # type: ignore[override]
        return self._compared("≠", value)

    def between(self, least: float, most: float) -> Condition:
        """Return the condition that the field is from one number to another, both included.

        Raises:
            TypeError: one of them is not a number. ValueError: the first is greater than the second.
        """
        between = (self >= least) & (self <= most)
        if least > most:
            raise ValueError(f"between: expected the lower limit first, got {least!r} and {most!r}")
        return between

    def __abs__(self) -> Field:
        return Field(self.name, is_size=True)

    def __bool__(self) -> bool:
        raise TypeError(f"{self!r} is neither true nor false by itself: compare it, as in field({self.name!r}) == True")

    def __repr__(self) -> str:
        return f"abs(field({self.name!r}))" if self.is_size else f"field({self.name!r})"

    def _compared(self, relation: str, limit: Any) -> Condition:
        return FieldCondition(self.name, relation, limit, is_size=self.is_size)


class FieldCondition(Condition):
    """The comparison of a field with a number, a flag or a text. It is unknown if the field is NaN or missing.

    Args:
        name: the topic with the field.
        relation: one of `OPERATORS`.
        limit: the value to which it is compared.
        is_size: True to compare the absolute value.
    """

    def __init__(self, name: str, relation: str, limit: Any, *, is_size: bool = False) -> None:
        self.name, self._relation, self._is_size = name, relation, is_size
        self._limit = _limit(name, relation, limit, is_size)
        self._readers: dict[str, FieldOf] = {}
        """The reader of the field for each topic."""

    def topics(self, recording: RecordingData, asked: Any) -> list[str]:  # noqa: ARG002
        """See `Condition`."""
        return [self._split([topic.name for topic in recording.topics])[0]]

    def steps(self, search: Search) -> Steps:
        """See `Condition`."""
        recording = search.recording
        topic, path = self._split([one.name for one in recording.topics])
        fields = recording.fields(topic)
        column, times = fields[path], fields.times_ns
        self._check(fields.types.get(path, ""), column)
        values = self._test(column)
        if column.dtype.kind in "iuf":
            is_true = values == YES
            numbers = np.ma.filled(column[is_true].astype(np.float64), np.nan)
            numbers = np.abs(numbers) if self._is_size else numbers
            side = {">": -1, "≥": -1, "<": 1, "≤": 1}.get(self._relation, 0)
            ranks = side * numbers if side else np.zeros(len(numbers))  # 0 times infinity is NaN, with a warning
            search.compared(self, times, is_true, numbers, ranks)
        found = steps(times, values)
        search.looked_at(len(times))
        kind = next(one.widget for one in recording.topics if one.name == topic)
        if KINDS[kind].goes_stale if kind else is_steady(times):
            return mark_stale(found, [(times, np.ones(len(times), bool))], search.end_ns)
        return found

    def possible(self, rows: SecondRows) -> Possible:
        """See `Condition`."""
        found = rows.field(self.name)
        limit = self._limit
        if found is None or (isinstance(limit, int) and abs(limit) > EXACT):
            return super().possible(rows)
        texts = found.texts()
        if isinstance(limit, str):
            has = found.kinds.where({kind: limit in texts.get(kind, ()) for kind in found.kinds.texts})
            others = found.kinds.where({kind: texts.get(kind, []) not in ([], [limit]) for kind in found.kinds.texts})
            true, false = (has, others) if self._relation == "=" else (others, has)
        else:
            least, most = _sizes(found.least, found.most) if self._is_size else (found.least, found.most)
            true, false = _possible(least, most, self._relation, limit)
        # The search itself complains of texts that are compared to numbers, and of missing fields.
        fits = {kind: (kind in texts) is isinstance(limit, str) for kind in found.kinds.texts}
        is_unknown = ~found.kinds.where(fits)
        return Possible(true | is_unknown, false | is_unknown)

    def number(self, recording: RecordingData) -> Curve | None:
        """See `Condition`."""
        topic, path = self._split([one.name for one in recording.topics])
        fields = recording.fields(topic)
        column = fields[path]
        if column.dtype == object:
            return None
        values = np.ma.filled(column.astype(np.float64), np.nan)
        return Curve(fields.times_ns, np.abs(values) if self._is_size else values)

    def judge(self, moment: Any) -> Verdict:
        """See `Condition`. The moment has ``messages``, or is a mapping from topics to messages."""
        messages = moment if isinstance(moment, Mapping) else getattr(moment, "messages", None)
        if messages is None:
            raise TypeError(f"{self}: expected messages by topic, got a {type(moment).__name__}")
        topic, path = self._split(messages)
        try:
            message = messages[topic]
            if message is None:
                return Verdict(None)
            if topic not in self._readers:
                self._readers[topic] = FieldOf(path, self.name)
            value = self._readers[topic](message)
        except (KeyError, NoSampleYetError, ShortArrayError):
            return Verdict(None)
        if isinstance(value, np.generic):
            value = value.item()
        self._check_value(value)
        size = abs(value) if self._is_size else value
        if isinstance(size, float) and isnan(size):
            return Verdict(None)
        return Verdict(bool(OPERATORS[self._relation](size, self._limit)), self._fact(size, path))

    @property
    def reads(self) -> frozenset[str]:
        """See `Condition`: the name of the topic with the field."""
        return frozenset({self.name})

    def __str__(self) -> str:
        name = f"abs({self.name})" if self._is_size else self.name
        limit = self._limit if isinstance(self._limit, (bool, int)) else _shown(self._limit)
        return f"{name} {_SIGNS.get(self._relation, self._relation)} {limit}"

    def _split(self, topics: Any) -> tuple[str, str]:
        topic, path = topic_and_field(self.name, topics)
        if not path:
            raise UnknownTopicError(f"field: {self.name!r} is a topic without a field, such as {self.name}.data")
        return topic, path

    def _test(self, column: NDArray[Any]) -> NDArray[np.int8]:
        is_missing = np.ma.getmaskarray(column)
        values = np.ma.getdata(column)
        if isinstance(self._limit, str):
            is_missing = is_missing | np.array([value is None for value in values], bool)
        elif values.dtype.kind == "f":
            values = values.astype(np.float64)  # compares like `judge`: 0.7 in 32 bits is less than 0.7
            is_missing = is_missing | np.isnan(values)
        size = np.abs(values) if self._is_size and values.dtype.kind != "b" else values
        if size.dtype.kind == "i" and self._is_size:
            size = size.view(f"u{size.itemsize}")  # the type has no room for the size of its smallest integer
        holds = OPERATORS[self._relation](size, self._limit)
        return np.where(is_missing, UNKNOWN, np.where(np.asarray(holds, bool), YES, NO)).astype(np.int8)

    def _check(self, type_name: str, column: NDArray[Any]) -> None:
        """Raise TypeError for a column that cannot be compared."""
        if column.ndim == 2 or (column.dtype == object and any(isinstance(one, np.ndarray) for one in column[:1])):
            raise TypeError(f"field: {self.name} is an array; name one of its numbers, such as {self.name}[0]")
        if type_name in ("time", "duration"):
            raise TypeError(f"field: {self.name} is a {type_name}; name a part of it, such as {self.name}.sec")
        if (column.dtype == object) is not isinstance(self._limit, str):
            raise self._unlike("text" if column.dtype == object else "a number")

    def _check_value(self, value: Any) -> None:
        """Raise TypeError for a value of a message that cannot be compared."""
        if not isinstance(value, (Real, str)):
            raise TypeError(
                f"field: {self.name} is not a single number or text, but {type(value).__name__}: name a field within it"
            )
        if isinstance(value, str) is not isinstance(self._limit, str):
            raise self._unlike("text" if isinstance(value, str) else "a number")

    def _unlike(self, what: str) -> TypeError:
        return TypeError(f"field: {self.name} is {what}, and cannot be compared to {self._limit!r}")

    def _fact(self, value: Any, path: str) -> str:
        if isinstance(value, (str, bool)):
            return f"{_shown(value)} {'=' if value == self._limit else '≠'} {_shown(self._limit)}"
        return fact(value, self._relation, self._limit, unit_of("", path))


def _sizes(least: NDArray[Any], most: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the least and the greatest absolute value between two numbers."""
    sizes = np.abs(least), np.abs(most)
    has_zero = (least <= 0) & (most >= 0)
    return np.where(has_zero, 0.0, np.minimum(*sizes)), np.maximum(*sizes)


def _possible(least: NDArray[Any], most: NDArray[Any], relation: str, limit: Any) -> tuple[Any, Any]:
    """Return True if a value from the least to the greatest may fulfil a comparison, and if one may not."""
    if relation in ("=", "≠"):
        same, other = (least <= limit) & (most >= limit), (least < limit) | (most > limit)
        return (same, other) if relation == "=" else (other, same)
    most_first = relation in (">", "≥")
    true, false = (most, least) if most_first else (least, most)
    return OPERATORS[relation](true, limit), OPERATORS[OPPOSITE[relation]](false, limit)


def _limit(name: str, relation: str, limit: Any, is_size: bool) -> Any:
    """Return the value to which a field is compared: a text, a flag, an integer or a float."""
    if isinstance(limit, np.generic):
        limit = limit.item()
    if isinstance(limit, (str, bool)):
        if relation not in ("=", "≠") or is_size:
            raise TypeError(f"field: {name} can only be equal to {limit!r} or not, by == or !=")
        return limit
    if isinstance(limit, Field):
        raise TypeError(f"field: {name} is compared to a number, not to another field: use a function of one moment")
    value = limit if isinstance(limit, int) else number("field", limit)
    if isnan(value):
        raise ValueError(f"field: {name}: expected a number to compare it to, got NaN, which nothing is equal to")
    return value


def _shown(value: Any) -> str:
    return repr(value) if isinstance(value, (str, bool)) else f"{value:g}"

"""Sensors that measure one number: the sample, the reader of its messages, and the row."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from robowidgets import kinds
from robowidgets.kinds import KINDS, Kind
from robowidgets.messages.fields import describe, get, has, stamp_ns, unwrap
from robowidgets.samples import HasAge

if TYPE_CHECKING:
    from .number_widget import NumberWidget


@dataclass(frozen=True)
class Number(HasAge):
    """One number, in a unit that may be empty."""

    value: float
    unit: str = ""
    stamp_ns: int | None = None


def to_number(message: Any) -> Number:
    """Return the number in a Float64, or in a String like "1.5 m"; return a `Number` as it is.

    Raises:
        TypeError: the message has another type, or a String of other words.
    """
    message = unwrap(message)
    if isinstance(message, Number):
        return message
    if not has(message, "data"):
        raise TypeError(f"expected a message like std_msgs/Float64 or std_msgs/String, got {describe(message)}")
    data = get(message, "data")
    if not isinstance(data, str):
        return Number(float(data), "", stamp_ns(message))
    try:
        value, _, unit = data.partition(" ")
        return Number(float(value), unit, stamp_ns(message))
    except ValueError:
        raise TypeError(f"expected a number and its unit, such as '1.5 m', got {data!r}") from None


def _widget() -> type[NumberWidget]:
    from .number_widget import NumberWidget

    return NumberWidget


NUMBER = Kind(
    name="number",
    sample_name="number",
    noun="numbers",
    sample=Number,
    read=to_number,
    types=frozenset({"std_msgs/msg/Float64", "std_msgs/msg/String"}),
    undecided=frozenset({"std_msgs/msg/String"}),
    widget=_widget,
    nothing=Number(float("nan")),
)


@contextmanager
def added() -> Iterator[Kind]:
    """Add numbers to the table of kinds for a while."""
    before = dict(KINDS)
    kinds.add(NUMBER)
    try:
        yield NUMBER
    finally:
        KINDS.clear()
        KINDS.update(before)

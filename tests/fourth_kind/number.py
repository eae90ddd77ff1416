"""Sensors that measure one number: the sample, the reader of its messages, and the row."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from robowidgets import kinds
from robowidgets.kinds import KINDS, Kind
from robowidgets.messages.fields import describe, get, has, stamp_ns, unwrap
from robowidgets.samples import HasAge


@dataclass(frozen=True)
class Number(HasAge):
    """One number, in a unit that may be empty."""

    value: float
    unit: str = ""
    stamp_ns: int | None = None


def to_number(message: Any) -> Number:
    """The number in a Float64, or the distance in a Range; a `Number` is returned as it is.

    Raises:
        TypeError: it is no such message, or a Range that says whether something is there, not how far.
        ValueError: it is no number.
    """
    message = unwrap(message)
    if isinstance(message, Number):
        return message
    if has(message, "range", "min_range", "max_range") and message_measures(message):
        return Number(float(get(message, "range")), "m", stamp_ns(message))
    if has(message, "data"):
        return Number(float(get(message, "data")))
    raise TypeError(f"expected a message like std_msgs/Float64 or sensor_msgs/Range, got {describe(message)}")


def message_measures(message: Any) -> bool:
    """Whether a Range tells how far something is."""
    return bool(get(message, "min_range") < get(message, "max_range"))


NUMBER = Kind(
    name="number",
    sample_name="number",
    noun="numbers",
    sample=Number,
    read=to_number,
    types=frozenset({"std_msgs/msg/Float64", "sensor_msgs/msg/Range"}),
    undecided=frozenset({"sensor_msgs/msg/Range"}),
    widget="tests.fourth_kind.number_widget:NumberWidget",
    nothing=Number(float("nan")),
)


@contextmanager
def added() -> Iterator[Kind]:
    """Have numbers in the table of kinds for a while."""
    before = dict(KINDS)
    kinds.add(NUMBER)
    try:
        yield NUMBER
    finally:
        KINDS.clear()
        KINDS.update(before)

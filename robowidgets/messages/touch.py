"""Conversion of messages of touch sensors."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from numbers import Real
from typing import Any

from ..samples import Touch
from ._codes import is_flag
from .dialects import DIALECTS, Sensor
from .fields import describe, stamp_ns, type_name, unwrap

TOUCH_TYPES: frozenset[str] = frozenset(name.replace("/", "/msg/") for dialect in DIALECTS for name in dialect.types)
"""The message types that `to_touch` reads, as recordings name them. It reads a ``sensor_msgs/msg/Range`` only if its
``min_range`` equals its ``max_range``, which only the messages show."""


def to_touch(message: Any, own: Collection[str] = ()) -> Touch:
    """Return the states of touch sensors in a message.

    Args:
        message: an object or dictionary in one of the dialects of `robowidgets.messages.dialects`, or a mapping of
            sensor names to True, False or None; a `Touch` is returned as it is.
        own: names of the robot's collisions. A contact names two collisions, in either order: its sensor is the one in
            this list, else the first. Collisions in this list that a list of contacts does not contain are free.

    Raises:
        TypeError: the message is not in one of these dialects; the text says what came and what was expected.
        ValueError: a number in it has no meaning in its dialect.
    """
    message = unwrap(message)
    if isinstance(message, Touch):
        return message
    dialect = next((d for d in DIALECTS if d.fits(message)), None)
    if dialect is None:
        _refuse_plain(message)
        known = ", ".join(d.types[0] for d in DIALECTS if d.types)
        raise TypeError(
            "expected sensor names with True, False or None, like {'left': True}, or a message like one of "
            f"{known}; got {describe(message)}"
        )
    states, stated = dialect.read(message), type_name(message)
    return Touch(
        touched={_name(sensor, own): state for sensor, state in states.items()},
        mode=dialect.mode,
        sensors=tuple(own) if dialect.of_contacts else dialect.sensors,
        stamp_ns=stamp_ns(message),
        dialect=stated if stated in dialect.types else "".join(dialect.types[:1]),
    )


def _refuse_plain(message: Any) -> None:
    """Raise TypeError for a mapping of names to numbers or text, because these may be bits, codes or words."""
    values = message.values() if isinstance(message, Mapping) else ((),)
    if all(value is None or is_flag(value) or isinstance(value, (Real, str)) for value in values):
        for name, value in message.items():
            if value is not None and not is_flag(value):
                remedy = "" if isinstance(value, str) else "; bool() converts a number"
                raise TypeError(
                    f"{name}: expected True, False or None in a mapping of sensor names, got {value!r}{remedy}"
                )


def _name(sensor: Sensor, own: Collection[str]) -> str:
    if not isinstance(sensor, tuple):
        return sensor
    first, second = sensor
    return second if second in own and first not in own else first

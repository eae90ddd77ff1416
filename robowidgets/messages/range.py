"""Conversion of Range messages of sonars and infrared sensors."""

from __future__ import annotations

from math import inf, isnan, nan
from typing import Any

from ..samples import Problem, Range
from ..samples.checks import OF_DEGREES, is_angle, number
from .fields import describe, frame_id, get, has, stamp_ns, unwrap

_NEEDED = ("range", "min_range", "max_range")
_RADIATIONS: dict[float, str] = {0: "ultrasound", 1: "infrared"}


def to_range(message: Any) -> Range:
    """Return the range in a Range-like message.

    Args:
        message: an object or dictionary with the fields of sensor_msgs/Range; a `Range` is returned as it is.

    Raises:
        TypeError: the message has another type; the text says what came and what was expected.
        ValueError: its limits are invalid, or equal. With equal limits it is a binary touch sensor (REP-117).
    """
    message = unwrap(message)
    if isinstance(message, Range):
        return message
    missing = [name for name in _NEEDED if not has(message, name)]
    if missing:
        raise TypeError(
            f"expected a message like sensor_msgs/Range, with {', '.join(_NEEDED)}; got {describe(message)} "
            f"(missing: {', '.join(missing)})"
        )
    measured, low, high = (get(message, name) for name in _NEEDED)
    view, odd = _field_of_view(get(message, "field_of_view", None))
    return Range(
        # JSON has null for NaN and both infinities, so the value that was sent is unknown.
        range=nan if measured is None else measured,
        min_range=low,
        max_range=inf if high is None else high,
        field_of_view=view,
        radiation=_radiation(get(message, "radiation_type", None)),
        stamp_ns=stamp_ns(message),
        frame_id=frame_id(message),
        problems=odd,
    )


def _field_of_view(given: Any) -> tuple[float, tuple[Problem, ...]]:
    """Return the opening angle in radians; an invalid one is 0 and a problem, because the distance is still right."""
    view = 0.0 if given is None else number("field_of_view", given)
    if view >= 0 and is_angle(view):
        return view, ()
    if isnan(view):
        return 0.0, ()
    hint = f"is it in degrees? {OF_DEGREES}" if view > 0 else "the driver should send radians, 0 if unknown"
    return 0.0, (Problem(f"field_of_view is {view:g} rad: not used", hint),)


def _radiation(code: Any) -> str:
    """Return the name of a code, or an empty text if it is unknown."""
    return "" if code is None else _RADIATIONS.get(number("radiation_type", code), "")

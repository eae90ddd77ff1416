"""Range messages of sonars and infrared sensors to ranges."""

from __future__ import annotations

from math import inf, isnan, nan
from typing import Any

from ..samples import Problem, Range
from ..samples.checks import OF_DEGREES, is_angle, number
from .fields import describe, frame_id, get, has, stamp_ns, unwrap

_NEEDED = ("range", "min_range", "max_range")
_RADIATIONS: dict[float, str] = {0: "ultrasound", 1: "infrared"}


def to_range(message: Any) -> Range:
    """The distance in a Range-like message.

    Args:
        message: an object or dictionary with the fields of sensor_msgs/Range; a `Range` is returned as it is.

    Raises:
        TypeError: it is not such a message; the text says what came and what was expected.
        ValueError: it is one, but its limits are no limits, or equal: such a sensor tells whether something is there,
            not how far, and is a touch sensor.
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
        # JSON has neither NaN nor infinity: which of the three it was cannot be told any more.
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
    """The opening angle in radians, 0 for what is none, which does not make the distance wrong."""
    view = 0.0 if given is None else number("field_of_view", given)
    if view >= 0 and is_angle(view):
        return view, ()
    if isnan(view):
        return 0.0, ()
    hint = f"is it in degrees? {OF_DEGREES}" if view > 0 else "the driver should send radians, 0 if unknown"
    return 0.0, (Problem(f"field_of_view is {view:g} rad: not used", hint),)


def _radiation(code: Any) -> str:
    """The name of a code; empty for another one."""
    return "" if code is None else _RADIATIONS.get(number("radiation_type", code), "")

"""Traits for times and spans of time."""

from __future__ import annotations

from math import inf, isfinite, nan
from numbers import Real
from typing import Any

import traitlets

from ..samples.time_span import time_span

SLOWEST, FASTEST = 0.1, 10.0
"""Limits of the playback speed, in seconds of a recording per second."""


class TimeSpan(traitlets.TraitType[Any, Any]):
    """None, (start, end) in seconds from the start with 0 <= start < end, or a span of `Recording.find`.

    Args:
        rays: True to accept (start, end, first, stop), too: the rays from index ``first`` to ``stop``, exclusive.
    """

    def __init__(self, *, rays: bool = False, **more: Any) -> None:
        super().__init__(None, allow_none=True, **more)
        self._rays = rays

    def validate(self, _obj: Any, value: Any) -> Any:
        """Return the span as a tuple, or None. Raise TraitError for other values."""
        if value is None:
            return None
        try:
            return time_span(str(self.name), value, rays=self._rays)
        except ValueError as error:
            raise traitlets.TraitError(str(error)) from None


class Seconds(traitlets.TraitType[Any, Any]):
    """A time in seconds from the start. A time outside of 0 to the owner's ``duration`` becomes the nearer end."""

    default_value = 0.0

    def validate(self, obj: Any, value: Any) -> float:
        """Return the time. Raise TraitError for other values."""
        if isinstance(value, bool) or not isinstance(value, Real) or not isfinite(value):
            raise traitlets.TraitError(f"{self.name}: expected seconds from the start, got {value!r}")
        return min(max(0.0, float(value)), float(obj.duration))


class PlaybackSpeed(traitlets.Float[Any, Any]):
    """Seconds of a recording per second, 0.1 to 10."""

    def validate(self, obj: Any, value: Any) -> float:
        """Return the speed. Raise TraitError for other values, including NaN, which bounds do not refuse."""
        speed: float = super().validate(obj, value)
        if not SLOWEST <= speed <= FASTEST:
            raise traitlets.TraitError(
                f"{self.name}: expected {SLOWEST:g} to {FASTEST:g} seconds of the recording per second, got {value!r}"
            )
        return speed


class Marks(traitlets.TraitType[Any, Any]):
    """Marked spans as (start, end, text), 0 <= start <= end in seconds from the start.

    The result of `Recording.find` is accepted, too.
    """

    default_value = ()

    def validate(self, _obj: Any, value: Any) -> tuple[tuple[float, float, str], ...]:
        """Return the marks in order of time. TraitError names a wrong mark."""
        condition = getattr(value, "condition", None)
        marks = value if condition is None else [(s.start, s.end, _label(condition, s.met)) for s in value]
        return tuple(sorted(self._mark(mark) for mark in marks))

    def _mark(self, mark: Any) -> tuple[float, float, str]:
        try:
            start, end, text = mark
            seconds = float(start), float(end)
        except (TypeError, ValueError):
            seconds = nan, nan
        if not 0 <= seconds[0] <= seconds[1] < inf:
            raise traitlets.TraitError(f"{self.name}: expected (start, end, text), seconds in order; got {mark!r}")
        return *seconds, str(text)


class States(Marks):
    """Rows of states, each as (start, end, path) in order of time. A path looks like ``Walker.avoid.turn``."""

    def validate(self, obj: Any, value: Any) -> Any:
        """Return the rows as tuples. TraitError names a wrong state."""
        try:
            return tuple(super(States, self).validate(obj, row) for row in value)
        except TypeError:
            expected = "rows of states, each (start, end, path)"
            raise traitlets.TraitError(f"{self.name}: expected {expected}; got {value!r}") from None


def _label(condition: str, met: str) -> str:
    return f"{condition}: {met}" if met else condition

"""Traits for times and spans of time."""

from __future__ import annotations

from math import inf, isfinite, nan
from numbers import Real
from typing import Any

import traitlets

from ..samples.time_span import time_span

SLOWEST, FASTEST = 0.1, 10.0
"""Seconds of a recording per second, at least and at most."""


class TimeSpan(traitlets.TraitType[Any, Any]):
    """None, or (start, end) in seconds from the start, 0 <= start < end; a span of `Recording.find` is accepted, too.

    Args:
        rays: whether (start, end, first, stop) is accepted, too: the rays from index ``first`` up to, not including,
            ``stop``.
    """

    def __init__(self, *, rays: bool = False, **more: Any) -> None:
        super().__init__(None, allow_none=True, **more)
        self._rays = rays

    def validate(self, _obj: Any, value: Any) -> Any:
        """The span as a tuple, or None; TraitError says what is wrong with it."""
        if value is None:
            return None
        try:
            return time_span(str(self.name), value, rays=self._rays)
        except ValueError as error:
            raise traitlets.TraitError(str(error)) from None


class Seconds(traitlets.TraitType[Any, Any]):
    """A time in seconds from the start; one outside of 0 to the owner's ``duration`` becomes the nearer end."""

    default_value = 0.0

    def validate(self, obj: Any, value: Any) -> float:
        """The time; TraitError if the value is no time."""
        if isinstance(value, bool) or not isinstance(value, Real) or not isfinite(value):
            raise traitlets.TraitError(f"{self.name}: expected seconds from the start, got {value!r}")
        return min(max(0.0, float(value)), float(obj.duration))


class PlaybackSpeed(traitlets.Float[Any, Any]):
    """Seconds of a recording per second, 0.1 to 10."""

    def validate(self, obj: Any, value: Any) -> float:
        """The speed; TraitError if the value is none, as NaN, which no bound refuses."""
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
        """The marks in the order of time; TraitError names the one that is wrong."""
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
    """Rows of states, each as (start, end, path) in the order of time; the path is such as ``Walker.avoid.turn``."""

    def validate(self, obj: Any, value: Any) -> Any:
        """The rows as tuples; TraitError names the state that is wrong."""
        try:
            return tuple(super(States, self).validate(obj, row) for row in value)
        except TypeError:
            expected = "rows of states, each (start, end, path)"
            raise traitlets.TraitError(f"{self.name}: expected {expected}; got {value!r}") from None


def _label(condition: str, met: str) -> str:
    return f"{condition}: {met}" if met else condition

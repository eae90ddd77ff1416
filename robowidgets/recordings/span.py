"""A span of a recording, as `Recording.find` returns it."""

from __future__ import annotations

from typing import NamedTuple

from ..runtime.text import degrees_of


class Span(NamedTuple):
    """A span: start, end and length in seconds from the start of the recording, and start and end by its clock.

    ``end`` is the time of the first sample for which the condition is no longer true, or the time at which the last
    sample is stale, or the end of the recording. It equals ``start`` if several samples have the same time and the
    condition is true for one of them, but not for the last. ``silent`` names the topics with a gap in the span, if the
    condition contains a gap.

    ``nearest`` is the smallest distance in the span in metres, as in `Scan.distance`, ``index`` is the index of its
    ray, ``angle`` the angle of the ray in radians, and ``nearest_ns`` the time of its scan by the clock of the
    recording. Conditions without a distance set none of these four. ``value`` is the number that a condition on a speed
    or a field compared: the one farthest beyond the limit in the span, or the first one if the limit has no sides.
    ``value_ns`` is its time. Other conditions set neither.

    The sample in force at the start belongs to the span, so ``nearest_ns`` and ``value_ns`` may be before ``start_ns``.
    Of joined conditions, the samples count while their condition makes the whole one true: with ``|``, only samples of
    the true parts, and after ``~`` none.
    """

    start: float
    end: float
    seconds: float
    start_ns: int
    end_ns: int
    silent: tuple[str, ...] = ()
    nearest: float | None = None
    index: int | None = None  # type: ignore[assignment]  # as ROS calls it; it hides tuple.index
    angle: float | None = None
    nearest_ns: int | None = None
    value: float | None = None
    value_ns: int | None = None

    @property
    def met(self) -> str:
        """The nearest reading as a text: ``"0.15 m at [173], -31.2°"``, or empty for conditions without a distance."""
        if self.nearest is None or self.angle is None:
            return ""
        return f"{self.nearest:.2f} m at [{self.index}], {degrees_of(self.angle)}"

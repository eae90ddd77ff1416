"""A span of a recording, as `Recording.find` returns it."""

from __future__ import annotations

from typing import NamedTuple

from .._core.text import degrees_of


class Span(NamedTuple):
    """A span: start, end and length in seconds from the start of the recording, and start and end by its clock.

    ``end`` is the time of the first sample for which the condition is no longer true, or the time at which the last
    sample is stale, or the end of the recording. It equals ``start`` if the condition is true for one of several
    samples of one time and not for the last of them. ``silent`` names the topics with a gap in the span, if the
    condition contains a gap.

    ``nearest`` is the distance in metres, as in `Scan.distance`, of the nearest thing that was met in the span,
    ``index`` that of its ray, ``angle`` that of the ray in radians, and ``nearest_ns`` the time of its scan by the
    clock of the recording; all four are None for conditions that look at no distance. ``value`` is the number that a
    condition on a speed or a field compared, the one farthest beyond the limit in the span, or the first where there is
    no such side, and ``value_ns`` its time; None for other conditions.
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
        """What was met, for a person: ``"0.15 m at [173], -31.2°"``; empty for conditions that look at no distance."""
        if self.nearest is None or self.angle is None:
            return ""
        return f"{self.nearest:.2f} m at [{self.index}], {degrees_of(self.angle)}"

"""Whether the scans of one topic come from one scanner."""

from __future__ import annotations

import time
from collections.abc import Callable
from math import degrees
from typing import Any, NamedTuple

from ..messages.fields import frame_id, reader, unwrap


class Shape(NamedTuple):
    """What a scan tells of its scanner: rays, first angle and increment in radians, frame."""

    rays: int
    first: float
    step: float
    frame_id: str


ALIKE = 0.05
"""Of one scanner, rays and increment differ by no more than this share, and the first angle by this share of its sweep.

Some publish each turn as it was measured: 359, 360 or 361 rays.
"""

FORGET = 3.0
"""Seconds without a change after which there is one scanner again."""


class Geometry:
    """Watches the geometry of the scans that come; two that take turns are two publishers.

    A scanner that is set up anew changes it once, and is one.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._now: Shape | None = None
        self._before: Shape | None = None
        self._changed_at = 0.0
        self.words = ""

    def see(self, message: Any) -> None:
        """Take a message into account; what is no scan does not count."""
        shape = _shape(message)
        if shape is None:
            return
        if _is_one(shape, self._now):
            if self.words and self._clock() - self._changed_at > FORGET:
                self.words = ""
            return
        if self._now is not None and _is_one(shape, self._before) and self._clock() - self._changed_at <= FORGET:
            if not self.words:
                told = ", and ".join(
                    _told(one, shape.frame_id != self._now.frame_id) for one in sorted((shape, self._now))
                )
                self.words = f"two scanners take turns on this topic: {told}"
        elif self.words and self._before is not None:
            self.words = ""
        self._before, self._now, self._changed_at = self._now, shape, self._clock()


def _shape(message: Any) -> Shape | None:
    message = unwrap(message)
    read = reader(message)
    try:
        angles = float(read("angle_min", None)), float(read("angle_increment", None))
        return Shape(len(read("ranges", None)), *angles, frame_id(message))
    except (OverflowError, TypeError, ValueError):
        return None


def _is_one(shape: Shape, other: Shape | None) -> bool:
    """Whether two shapes may be turns of one scanner."""
    if other is None or shape.frame_id != other.frame_id:
        return False
    return (
        abs(shape.rays - other.rays) <= ALIKE * shape.rays
        and abs(shape.step - other.step) <= ALIKE * abs(shape.step)
        and abs(shape.first - other.first) <= ALIKE * shape.rays * abs(shape.step)
    )


def _told(shape: Shape, by_frame: bool) -> str:
    frame = f"{shape.frame_id or 'no frame'}: " if by_frame else ""
    return f"{frame}{shape.rays} rays from {degrees(shape.first):.1f}° in steps of {degrees(shape.step):.2f}°"

"""Detecting two scanners that publish on one topic."""

from __future__ import annotations

import time
from collections.abc import Callable
from math import degrees
from typing import Any, NamedTuple

from ..messages.fields import frame_id, reader, unwrap


class ScanGeometry(NamedTuple):
    """The geometry of a scan: number of rays, first angle and increment in radians, and frame."""

    rays: int
    first: float
    step: float
    frame_id: str


TOLERANCE = 0.05
"""The relative difference within which the rays and the increment of two scans belong to one scanner.

For the first angle, it is relative to the sweep. Some scanners publish each turn as measured: 359, 360 or 361 rays.
"""

FORGET = 3.0
"""Seconds without a change of geometry after which only one scanner is assumed again."""


class TwoScanners:
    """A comparison of the geometries of scans. Geometries that alternate belong to two scanners.

    A scanner that is reconfigured changes its geometry once.

    Attributes:
        status: text that describes both scanners, or empty if there is only one.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._now: ScanGeometry | None = None
        self._before: ScanGeometry | None = None
        self._changed_at = 0.0
        self.status = ""

    def see(self, message: Any) -> None:
        """Compare a message, if it is a scan."""
        shape = _shape(message)
        if shape is None:
            return
        if _is_same(shape, self._now):
            if self.status and self._clock() - self._changed_at > FORGET:
                self.status = ""
            return
        if self._now is not None and _is_same(shape, self._before) and self._clock() - self._changed_at <= FORGET:
            if not self.status:
                by_frame = shape.frame_id != self._now.frame_id
                both = ", and ".join(_described(one, by_frame) for one in sorted((shape, self._now)))
                or_one = "" if by_frame else ", or one changes its rays"
                self.status = f"two scanners take turns on this topic{or_one}: {both}"
        elif self.status and self._before is not None:
            self.status = ""
        self._before, self._now, self._changed_at = self._now, shape, self._clock()


def _shape(message: Any) -> ScanGeometry | None:
    message = unwrap(message)
    read = reader(message)
    try:
        angles = float(read("angle_min", None)), float(read("angle_increment", None))
        return ScanGeometry(len(read("ranges", None)), *angles, frame_id(message))
    except (OverflowError, TypeError, ValueError):
        return None


def _is_same(shape: ScanGeometry, other: ScanGeometry | None) -> bool:
    """Return True if two geometries may belong to one scanner."""
    if other is None or shape.frame_id != other.frame_id:
        return False
    return (
        abs(shape.rays - other.rays) <= TOLERANCE * shape.rays
        and abs(shape.step - other.step) <= TOLERANCE * abs(shape.step)
        and abs(shape.first - other.first) <= TOLERANCE * shape.rays * abs(shape.step)
    )


def _described(shape: ScanGeometry, by_frame: bool) -> str:
    frame = f"{shape.frame_id or 'no frame'}: " if by_frame else ""
    return f"{frame}{shape.rays} rays from {degrees(shape.first):.1f}° in steps of {degrees(shape.step):.2f}°"

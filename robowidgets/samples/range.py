"""One distance that a sonar or an infrared sensor measured within its beam."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isnan, nan, pi
from typing import Any

import numpy as np

from .age import HasAge, note_arrival
from .checks import number, shortest
from .pose import Pose
from .problem import Problem
from .ray import CODES_END, Validity

RADIATIONS = ("", "ultrasound", "infrared")


@dataclass(frozen=True)
class Range(HasAge):
    """One distance within a beam: the distance to the nearest thing anywhere in its width.

    Numbers are kept at float32's precision, each as its shortest decimal: a limit and a reading sent as the same number
    are equal.

    Args:
        range: metres, as measured. -inf: too close; +inf: nothing in range; NaN: no measurement (REP-117).
        min_range, max_range: metres; a range within them, both included, is a reading. A max_range of inf is unknown.
        field_of_view: the opening angle of the beam in radians, half of it on each side, up to 2 pi, or 0 if unknown.
        radiation: "ultrasound" or "infrared", or empty if unknown.
        stamp_ns: time in nanoseconds since the epoch, or None.
        frame_id: coordinate frame of the sensor, whose beam points along x.
        pose: the pose of the sensor in the robot's frame, in metres and radians, or None if unknown.
        problems: problems of the message.

    Raises:
        TypeError: a value is not a number.
        ValueError: the limits are not distances, equal, or swapped; the opening angle is beyond a full turn; the
            radiation is another text.

    Source: sensor_msgs/Range, REP-117.

    Examples:
        >>> front = Range(0.42, min_range=0.1, max_range=5.0)
        >>> front.distance, front.validity.name
        (0.42, 'READING')
    """

    range: float
    min_range: float = 0.0
    max_range: float = inf
    field_of_view: float = 0.0
    radiation: str = ""
    stamp_ns: int | None = None
    frame_id: str = ""
    pose: Pose | None = None
    problems: tuple[Problem, ...] = ()

    def __post_init__(self) -> None:
        note_arrival(self)
        for name in ("range", "min_range", "max_range", "field_of_view"):
            object.__setattr__(self, name, _float32(name, getattr(self, name)))
        low, high = self.min_range, self.max_range
        if not 0 <= low < inf:
            raise ValueError(f"min_range: expected metres, 0 or more, got {low!r}")
        if low == high:
            raise ValueError(
                f"max_range: expected metres above min_range, got {high:g} for both; such a sensor tells whether "
                "something is there, not how far: a touch widget shows it"
            )
        if not low < high:
            swapped = "" if isnan(high) else "; are the two swapped?"
            raise ValueError(f"max_range: expected metres above min_range ({low:g}), got {high!r}{swapped}")
        if not 0 <= self.field_of_view <= 2 * pi + 0.01:
            raise ValueError(f"field_of_view: expected radians from 0 to 2 pi, got {self.field_of_view!r}")
        if self.pose is not None and not isinstance(self.pose, Pose):
            raise TypeError(f"pose: expected a Pose or None, got {self.pose!r}")
        if self.radiation not in RADIATIONS:
            raise ValueError(f"radiation: expected 'ultrasound', 'infrared' or '', got {self.radiation!r}")

    @property
    def validity(self) -> Validity:
        """The class of the range (REP-117)."""
        if self.min_range <= self.range <= self.max_range and self.range < inf:
            return Validity.READING
        if self.range == -inf:
            return Validity.TOO_CLOSE
        if self.range == inf:
            return Validity.NOTHING_IN_RANGE
        return Validity.NO_MEASUREMENT if isnan(self.range) else Validity.OUTSIDE_LIMITS

    @property
    def distance(self) -> float:
        """The distance in metres for a program to use, as in `Scan.distance`.

        0 if something is too close: -inf, or below min_range. inf if nothing is in range: +inf, or above max_range.
        NaN if the distance is unknown: NaN, or a code, which is a number below both min_range and 0.02 m.
        """
        if self.range > self.max_range:
            return inf
        if self.range < self.min_range:
            return nan if -inf < self.range < CODES_END else 0.0
        return self.range


def _float32(name: str, value: Any) -> float:
    with np.errstate(over="ignore"):
        return shortest(np.float32(number(name, value)))

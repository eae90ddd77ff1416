"""One velocity of a robot."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass
from typing import Any

from .age import HasAge, note_arrival
from .checks import number
from .pose import Pose

AXES = ("linear.x", "linear.y", "linear.z", "angular.x", "angular.y", "angular.z")


@dataclass(frozen=True)
class Speed(HasAge):
    """A velocity in the body frame: measured, or commanded.

    Args:
        linear: x forward, y left, z up, in m/s. NaN means no value; it is never taken for 0.
        angular: about x (roll), y (pitch) and z (yaw, counter-clockwise), in rad/s. NaN as above.
        stamp_ns: time in nanoseconds since the epoch, or None.
        frame_id: the frame in which the velocity is expressed (``child_frame_id`` of an odometry message).
        pose: the pose from odometry: x, y in metres and yaw in radians, or None without odometry.
        steering: the angle of the front wheels of a car in radians, left is positive, or None for other robots.

    Raises:
        TypeError: a value is not a number.
        ValueError: there are not three values.

    Source: geometry_msgs/Twist, nav_msgs/Odometry, ackermann_msgs/AckermannDrive, REP-103.

    Examples:
        >>> Speed(linear=(0.5, 0.0, 0.0), angular=(0.0, 0.0, 0.1)).values[5]
        0.1
    """

    linear: tuple[float, float, float] = (0.0, 0.0, 0.0)
    angular: tuple[float, float, float] = (0.0, 0.0, 0.0)
    stamp_ns: int | None = None
    frame_id: str = ""
    pose: Pose | None = None
    steering: float | None = None

    def __post_init__(self) -> None:
        note_arrival(self)
        for name in ("linear", "angular"):
            given = getattr(self, name)
            if type(given) is tuple and len(given) == 3 and all(type(v) is float for v in given):
                continue
            values = _in_order(given)
            if values is None:
                raise TypeError(f"{name}: expected three numbers (x, y, z), got {given!r}")
            if len(values) != 3:
                raise ValueError(f"{name}: expected three numbers (x, y, z), got {len(values)}")
            object.__setattr__(
                self, name, tuple(number(f"{name}.{axis}", v) for axis, v in zip("xyz", values, strict=True))
            )
        if self.pose is not None and not isinstance(self.pose, Pose):
            raise TypeError(f"pose: expected a Pose or None, got {self.pose!r}")
        if self.steering is not None:
            object.__setattr__(self, "steering", number("steering", self.steering))

    @property
    def values(self) -> tuple[float, ...]:
        """The six numbers in the order of `AXES`."""
        return self.linear + self.angular


def _in_order(given: Any) -> tuple[Any, ...] | None:
    """Return the values of a sequence or an array, or None for text, mappings and sets, which have no order x, y, z."""
    try:
        return None if isinstance(given, (str, bytes, Mapping, Set)) else tuple(given)
    except TypeError:
        return None

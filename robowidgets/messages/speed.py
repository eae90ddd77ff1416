"""Conversion of twists and odometry to speeds."""

from __future__ import annotations

from math import nan
from typing import Any

from ..samples import Speed
from .fields import describe, frame_id, get, has, stamp_ns, unwrap
from .pose import pose_of


def to_speed(message: Any) -> Speed:
    """Return the velocity in a Twist, TwistStamped, TwistWithCovariance(Stamped) or Odometry-like message.

    Odometry has a pose too. An AckermannDrive(Stamped) has a speed and a steering angle; the angular velocity of such a
    car is unknown, because it depends on the wheelbase.

    Args:
        message: an object or dictionary of one of these shapes; a `Speed` is returned as it is.

    Raises:
        TypeError: the message has another type; the text says what came and what was expected.
    """
    message = unwrap(message)
    if isinstance(message, Speed):
        return message
    twist = message
    while not has(twist, "linear", "angular") and has(twist, "twist"):
        twist = get(twist, "twist")
    drive = get(message, "drive", message)
    if not has(twist, "linear", "angular") and has(drive, "speed", "steering_angle"):
        speed, steering = (_number(get(drive, name)) for name in ("speed", "steering_angle"))
        return Speed((speed, nan, nan), (nan,) * 3, stamp_ns(message), frame_id(message), steering=steering)
    if not has(twist, "linear", "angular"):
        raise TypeError(
            "expected a message like geometry_msgs/Twist, TwistStamped, TwistWithCovariance or nav_msgs/Odometry, "
            f"with linear and angular, or ackermann_msgs/AckermannDrive; got {describe(message)}"
        )
    linear, angular = (_vector(name, get(twist, name)) for name in ("linear", "angular"))
    frame = str(get(message, "child_frame_id", "") or frame_id(message))
    return Speed(linear, angular, stamp_ns(message), frame, pose_of(message))


def _vector(name: str, value: Any) -> tuple[float, float, float]:
    if not has(value, "x", "y", "z"):
        raise TypeError(f"{name}: expected a vector with x, y and z, got {describe(value)}")
    x, y, z = (_number(get(value, axis)) for axis in "xyz")
    return x, y, z


def _number(value: Any) -> Any:
    """Return a number as it is, and null, which JSON has for NaN, as NaN."""
    return nan if value is None else value

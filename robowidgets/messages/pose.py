"""Conversion of poses and odometry to poses on the floor."""

from __future__ import annotations

from typing import Any

from ..samples import Pose, Speed, yaw_of
from .fields import describe, get, has, unwrap


def to_pose(message: Any) -> Pose:
    """Return the pose in a Pose, PoseStamped, PoseWithCovariance(Stamped) or Odometry-like message.

    Args:
        message: an object or dictionary of one of these shapes, or a `Speed` from odometry.

    Raises:
        TypeError: the message has no pose; the text says what came and what was expected.
    """
    message = unwrap(message)
    pose = pose_of(message)
    if pose is None:
        what = "a speed without odometry" if isinstance(message, Speed) else describe(message)
        raise TypeError(
            "expected a message like nav_msgs/Odometry, geometry_msgs/Pose, PoseStamped or PoseWithCovarianceStamped, "
            f"with position and orientation; got {what}"
        )
    return pose


def pose_of(message: Any) -> Pose | None:
    """Return the pose in a message, as `to_pose` reads it, or None."""
    if isinstance(message, Speed):
        return message.pose
    pose = message
    while not has(pose, "position", "orientation") and has(pose, "pose"):
        pose = get(pose, "pose")
    position, orientation = get(pose, "position", None), get(pose, "orientation", None)
    if not has(position, "x", "y") or not has(orientation, "x", "y", "z", "w"):
        return None
    yaw = yaw_of(*(_number(orientation, name) for name in "xyzw"))
    return Pose(_number(position, "x"), _number(position, "y"), float(yaw))


def _number(vector: Any, name: str) -> float:
    value = get(vector, name)
    return float("nan") if value is None else float(value)

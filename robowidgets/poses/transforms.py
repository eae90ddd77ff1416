"""Where one frame of a robot was in another, as odometry, tf and a CARMEN log tell it."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot, isfinite
from typing import Any, NamedTuple

from ..messages.fields import stamp_ns

ODOMETRY = "nav_msgs/msg/Odometry"
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
STATIC = "tf_static"

Pose = tuple[float, float, float, float, float, float, float]


class Joint(NamedTuple):
    """What one message says of one frame.

    ``pose``: where ``child`` is in ``parent``: x, y, z in metres, and a quaternion x, y, z, w of length 1. ``time_ns``
    is the log time, ``stamp_ns`` the message's own, 0 where it bears none. ``static``: it holds for all times.
    ``odometry``: it was not told by tf.
    """

    parent: str
    child: str
    time_ns: int
    stamp_ns: int
    pose: Pose
    static: bool = False
    odometry: bool = False


def joints_of(message: Any, topic: str, time_ns: int) -> Iterator[Joint]:
    """What an Odometry or a TFMessage says.

    Raises:
        ValueError: a pose is none: NaN, infinite, or a quaternion of length 0.
    """
    if hasattr(message, "transforms"):
        static = topic.rpartition("/")[2] == STATIC
        for told in message.transforms:
            at = told.transform
            yield _joint(told, time_ns, at.translation, at.rotation, static=static)
    else:
        at = message.pose.pose
        yield _joint(message, time_ns, at.position, at.orientation, odometry=True)


def _joint(told: Any, time_ns: int, place: Any, turn: Any, **kind: bool) -> Joint:
    parent, child = told.header.frame_id, told.child_frame_id
    length = hypot(turn.x, turn.y, turn.z, turn.w)
    pose = (place.x, place.y, place.z, *(part / (length or 1.0) for part in (turn.x, turn.y, turn.z, turn.w)))
    if not length or not all(map(isfinite, pose)):
        raise ValueError(f"{child!r} in {parent!r} is at no pose: {place.x}, {place.y}, {place.z}, a turn of {length}")
    # ROS 1 wrote names of frames with a slash before them, or without.
    return Joint(parent.lstrip("/"), child.lstrip("/"), time_ns, stamp_ns(told) or 0, pose, **kind)

"""The transforms between coordinate frames in messages of odometry and tf."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import hypot, isfinite
from typing import Any, NamedTuple

from ..messages.fields import as_object, get, stamp_ns

TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
STATIC = "tf_static"

PoseNumbers = tuple[float, float, float, float, float, float, float]


class Transform(NamedTuple):
    """The pose of one frame in another, at one time.

    ``pose`` of ``child`` in ``parent``: x, y, z in metres, and a quaternion x, y, z, w of length 1. ``time_ns`` is the
    log time, ``stamp_ns`` the stamp of the message, 0 without one. ``static``: it is valid at all times.
    ``odometry``: it comes from an odometry message, not from tf.
    """

    parent: str
    child: str
    time_ns: int
    stamp_ns: int
    pose: PoseNumbers
    static: bool = False
    odometry: bool = False


def transforms_of(message: Any, topic: str, time_ns: int) -> Iterator[Transform]:
    """The transforms in an Odometry or a TFMessage.

    Raises:
        ValueError: a pose contains NaN or infinity, or a quaternion of length 0.
    """
    if hasattr(message, "transforms"):
        yield from transforms_in(message, topic.rpartition("/")[2] == STATIC, time_ns)
    else:
        at = message.pose.pose
        yield _transform(message, time_ns, at.position, at.orientation, odometry=True)


def transforms_in(message: Any, static: bool, time_ns: int) -> Iterator[Transform]:
    """The transforms in a TFMessage, which may be a dictionary.

    Raises:
        ValueError: as `transforms_of`.
    """
    for stamped in get(message, "transforms"):
        one = as_object(stamped) if isinstance(stamped, Mapping) else stamped
        at = one.transform
        yield _transform(one, time_ns, at.translation, at.rotation, static=static)


def _transform(stamped: Any, time_ns: int, position: Any, orientation: Any, **flags: bool) -> Transform:
    parent, child = stamped.header.frame_id, stamped.child_frame_id
    x, y, z = position.x, position.y, position.z
    quaternion = orientation.x, orientation.y, orientation.z, orientation.w
    length = hypot(*quaternion)
    i, j, k, w = (part / (length or 1.0) for part in quaternion)
    pose = x, y, z, i, j, k, w
    if not length or not all(map(isfinite, pose)):
        raise ValueError(f"{child!r} in {parent!r} is at no pose: {x}, {y}, {z}, a turn of {length}")
    # ROS 1 wrote the names of frames with a leading slash, or without.
    return Transform(parent.lstrip("/"), child.lstrip("/"), time_ns, stamp_ns(stamped) or 0, pose, **flags)

"""The transforms between coordinate frames in messages of odometry and tf."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import hypot, isfinite
from typing import Any, NamedTuple

from ..messages.fields import as_object, describe, get, stamp_ns

TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
STATIC = "tf_static"

PoseNumbers = tuple[float, float, float, float, float, float, float]


class Transform(NamedTuple):
    """The pose of a frame in another, at one time.

    ``pose`` is the pose of ``child`` in ``parent``: x, y, z in metres, and a quaternion x, y, z, w of length 1.
    ``time_ns`` is the log time, ``stamp_ns`` the stamp of the message, or 0 without a stamp. ``static`` is True if it
    is valid at all times, ``odometry`` if it comes from an odometry message instead of tf.
    """

    parent: str
    child: str
    time_ns: int
    stamp_ns: int
    pose: PoseNumbers
    static: bool = False
    odometry: bool = False


def transforms_of(message: Any, topic: str, time_ns: int) -> Iterator[Transform]:
    """Yield the transforms in an Odometry or a TFMessage, which may be a dictionary.

    Raises:
        ValueError: a pose contains NaN, infinity, null or a quaternion of length 0, or fields are missing. It is raised
            after all valid transforms of the message.
    """
    if get(message, "transforms", None) is not None:
        yield from transforms_in(message, topic.rpartition("/")[2] == STATIC, time_ns)
    else:
        yield _transform(message, time_ns, odometry=True)


def transforms_in(message: Any, static: bool, time_ns: int) -> Iterator[Transform]:
    """Yield the transforms in a TFMessage, which may be a dictionary.

    Raises:
        ValueError: as in `transforms_of`.
    """
    given, wrong = get(message, "transforms", None), None
    if not isinstance(given, Iterable):
        raise ValueError(f"expected a message like tf2_msgs/TFMessage, got {describe(message)}")
    for stamped in given:
        try:
            one = _transform(stamped, time_ns, static=static)
        except ValueError as error:  # noqa: PERF203  # the others count
            wrong = wrong or error
        else:
            yield one
    if wrong is not None:
        raise wrong


def _transform(stamped: Any, time_ns: int, *, static: bool = False, odometry: bool = False) -> Transform:
    one = as_object(stamped)
    try:
        at = one.pose.pose if odometry else one.transform
        position, orientation = (at.position, at.orientation) if odometry else (at.translation, at.rotation)
        parent, child = one.header.frame_id, one.child_frame_id
        # ROS 1 may write the names of frames with a leading slash.
        names = parent.lstrip("/"), child.lstrip("/")
        x, y, z = position.x, position.y, position.z
        quaternion = orientation.x, orientation.y, orientation.z, orientation.w
    except AttributeError:
        expected = "nav_msgs/Odometry" if odometry else "geometry_msgs/TransformStamped"
        raise ValueError(f"expected a message like {expected}, got {describe(stamped)}") from None
    try:
        length = hypot(*quaternion)
        i, j, k, w = (part / (length or 1.0) for part in quaternion)
        pose = x, y, z, i, j, k, w
        is_pose = length > 0 and all(map(isfinite, pose))
    except (TypeError, OverflowError):  # null, which rosbridge sends for NaN
        is_pose = False
    if not is_pose:
        turn = ", ".join(map(str, quaternion))
        raise ValueError(f"{child!r} in {parent!r} has no valid pose: {x}, {y}, {z}, with the quaternion {turn}")
    return Transform(*names, time_ns, stamp_ns(one) or 0, pose, static, odometry)

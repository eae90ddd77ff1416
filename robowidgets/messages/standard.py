"""Conversion of samples to messages of ROS 2, for feeds without messages: the simulated robot, a recording."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, sin
from typing import Any

import numpy as np

from ..samples import CameraInfo, Image, Range, Scan, Speed, Touch, TouchState
from ..samples.touch_tracker import TouchTracker
from .twist import TWIST, TWIST_STAMPED

LASER_SCAN = "sensor_msgs/msg/LaserScan"
ODOMETRY = "nav_msgs/msg/Odometry"
RANGE = "sensor_msgs/msg/Range"
TF = "tf2_msgs/msg/TFMessage"
IMAGE = "sensor_msgs/msg/Image"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
CONTACTS = "ros_gz_interfaces/msg/Contacts"

ToMessage = Callable[[Any, int, str], tuple[str, dict[str, Any]]]
"""A function of a sample, its time in nanoseconds and the type of its topic; it returns a message type and fields."""


def scan_message(scan: Scan, time_ns: int, _topic_type: str) -> tuple[str, dict[str, Any]]:
    """Return a ``sensor_msgs/LaserScan`` with the scanner's angles, stamped with the time."""
    scan = scan.unmounted()
    return LASER_SCAN, {
        "header": _header(time_ns, scan.frame_id),
        "angle_min": scan.angle_min,
        "angle_max": scan.angle_min + max(0, len(scan) - 1) * scan.angle_increment,
        "angle_increment": scan.angle_increment,
        "range_min": scan.range_min,
        "range_max": scan.range_max,
        "ranges": scan.ranges,
        "intensities": scan.intensities,
    }


def range_message(measured: Range, time_ns: int, _topic_type: str) -> tuple[str, dict[str, Any]]:
    """Return a ``sensor_msgs/Range``, stamped with the time."""
    return RANGE, {
        "header": _header(time_ns, measured.frame_id),
        "radiation_type": 1 if measured.radiation == "infrared" else 0,
        "field_of_view": measured.field_of_view,
        "min_range": measured.min_range,
        "max_range": measured.max_range,
        "range": measured.range,
    }


def mount_message(sample: Any, time_ns: int) -> tuple[str, dict[str, Any]] | None:
    """Return a ``tf2_msgs/TFMessage`` with the pose of a sensor on the robot, or None if its sample has no pose."""
    if isinstance(sample, Scan) and sample.mount and sample.mount.by == "hand" and sample.frame_id:
        turn = turn_of(sample.mount.yaw, upside_down=sample.mount.upside_down)
        return TF, {"transforms": [transform_fields("base_link", sample.frame_id, (0.0, 0.0, 0.0), turn, time_ns)]}
    if not isinstance(sample, Range) or sample.pose is None or not sample.frame_id:
        return None
    x, y, yaw = sample.pose
    return TF, {"transforms": [transform_fields("base_link", sample.frame_id, (x, y, 0.0), turn_of(yaw), time_ns)]}


def turn_of(yaw: float, *, upside_down: bool = False) -> tuple[float, float, float, float]:
    """Return the quaternion x, y, z, w of a yaw in radians, for a sensor that is upside down or not."""
    return (cos(yaw / 2), sin(yaw / 2), 0.0, 0.0) if upside_down else (0.0, 0.0, sin(yaw / 2), cos(yaw / 2))


def image_fields(image: Image) -> dict[str, Any]:
    """Return the fields of a ``sensor_msgs/Image``, with the stamp of the image."""
    pixels = np.ascontiguousarray(image.pixels)
    (height, width), data = image.shape, pixels.view(np.uint8).ravel()
    header = _header(image.stamp_ns or 0, image.frame_id)
    size = {"height": height, "width": width, "step": data.size // height}
    return {"header": header, **size, "encoding": image.encoding, "is_bigendian": 0, "data": data}


def camera_info_fields(info: CameraInfo, stamp_ns: int) -> dict[str, Any]:
    """Return the fields of a ``sensor_msgs/CameraInfo`` of ROS 2 for a whole picture."""
    size = {"height": info.height, "width": info.width, "distortion_model": info.distortion_model}
    return {"header": _header(stamp_ns, info.frame_id), **size, "d": info.d, "k": info.k, "r": info.r, "p": info.p}


def transform_fields(
    parent: str, child: str, place: Sequence[float], turn: Sequence[float], stamp_ns: int
) -> dict[str, Any]:
    """Return the fields of a ``geometry_msgs/TransformStamped`` from metres and a quaternion x, y, z, w."""
    pose = {"translation": dict(zip("xyz", place, strict=True)), "rotation": dict(zip("xyzw", turn, strict=True))}
    return {"header": _header(stamp_ns, parent), "child_frame_id": child, "transform": pose}


def speed_message(speed: Speed, time_ns: int, topic_type: str) -> tuple[str, dict[str, Any]]:
    """Return Odometry for a speed with a pose, else Twist if the topic has that type, else TwistStamped."""
    linear, angular = (dict(zip("xyz", values, strict=True)) for values in (speed.linear, speed.angular))
    twist = {"linear": linear, "angular": angular}
    if speed.pose is not None:
        x, y, yaw = speed.pose
        orientation = {"z": sin(yaw / 2), "w": cos(yaw / 2)}
        pose = {"position": {"x": x, "y": y}, "orientation": orientation}
        header = _header(time_ns, "odom")
        fields = {"header": header, "child_frame_id": speed.frame_id, "pose": {"pose": pose}, "twist": {"twist": twist}}
        return ODOMETRY, fields
    if topic_type == TWIST:
        return TWIST, twist
    return TWIST_STAMPED, {"header": _header(time_ns, speed.frame_id), "twist": twist}


class ContactMessages:
    """A function that converts the touches of a topic to ``ros_gz_interfaces/Contacts``: a contact per touched sensor.

    No standard type is made for touch sensors. This type takes any names, and each message covers all sensors.
    """

    def __init__(self) -> None:
        self._touches = TouchTracker()

    def __call__(self, touch: Touch, time_ns: int, _topic_type: str) -> tuple[str, dict[str, Any]]:
        """See `ToMessage`."""
        self._touches.apply(touch, time_ns)
        states = self._touches.states(time_ns)
        touched = [name for name, one in states.items() if one.state is TouchState.TOUCHED]
        contacts = [{"collision1": {"name": name}, "collision2": {"name": "something"}} for name in touched]
        return CONTACTS, {"header": _header(time_ns, ""), "contacts": contacts}


def _header(time_ns: int, frame_id: str) -> dict[str, Any]:
    sec, nanosec = divmod(time_ns, 1_000_000_000)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame_id}

"""Samples as messages of ROS 2, where a feed has samples and no messages: the simulated robot, a recording."""

from __future__ import annotations

from typing import Any

from ..samples import Scan, Speed, TouchState
from ..samples.touch_tracker import TouchTracker

LASER_SCAN = "sensor_msgs/msg/LaserScan"
TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"
CONTACTS = "ros_gz_interfaces/msg/Contacts"


def scan_fields(scan: Scan, time_ns: int) -> dict[str, Any]:
    """The fields of a ``sensor_msgs/LaserScan``, stamped with a time in nanoseconds."""
    return {
        "header": _header(time_ns, scan.frame_id),
        "angle_min": scan.angle_min,
        "angle_max": scan.angle_min + max(0, len(scan) - 1) * scan.angle_increment,
        "angle_increment": scan.angle_increment,
        "range_min": scan.range_min,
        "range_max": scan.range_max,
        "ranges": scan.ranges,
        "intensities": scan.intensities,
    }


def speed_fields(speed: Speed, time_ns: int) -> dict[str, Any]:
    """The fields of a ``geometry_msgs/TwistStamped``; its ``twist`` has those of a Twist."""
    linear, angular = (dict(zip("xyz", values, strict=True)) for values in (speed.linear, speed.angular))
    return {"header": _header(time_ns, speed.frame_id), "twist": {"linear": linear, "angular": angular}}


def contact_fields(touches: TouchTracker, time_ns: int) -> dict[str, Any]:
    """The fields of ``ros_gz_interfaces/Contacts``: a contact for each sensor that is touched now.

    No standard type names touch sensors. This one takes any names, and each message tells of all sensors.
    """
    touched = [name for name, one in touches.states(time_ns).items() if one.state is TouchState.TOUCHED]
    contacts = [{"collision1": {"name": name}, "collision2": {"name": "something"}} for name in touched]
    return {"header": _header(time_ns, ""), "contacts": contacts}


def _header(time_ns: int, frame_id: str) -> dict[str, Any]:
    sec, nanosec = divmod(time_ns, 1_000_000_000)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame_id}

"""A small recording of a robot, written for a test: scans, speeds, commands, bumps, and what no widget shows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

START_NS = 1_700_000_000_000_000_000
SECONDS = 10

_STORE = get_typestore(Stores.ROS2_HUMBLE)
_STORE.register(get_types_from_msg("uint8 bumper\nuint8 state\n", "kobuki_ros_interfaces/msg/BumperEvent"))
_TYPES = {
    "/scan": "sensor_msgs/msg/LaserScan",
    "/odom": "nav_msgs/msg/Odometry",
    "/cmd_vel": "geometry_msgs/msg/Twist",
    "/bumper": "kobuki_ros_interfaces/msg/BumperEvent",
    "/log": "std_msgs/msg/String",
}
_COVARIANCE = np.zeros(36)


def write(
    folder: Path,
    bad_scan_at: int | None = None,
    silence: int = 0,
    robots: Sequence[str] = ("",),
    climb: float = 0.0,
    second_frame: str = "base_link",
) -> Path:
    """Ten seconds at 10 Hz: scan i has the one range 1 + i / 100, speed and command are i / 100.

    Commands begin at 5 s. The left bumper is pressed at 2 and 6 s, and released at 3 and 7 s.

    Args:
        folder: is made, with an MCAP file in it.
        bad_scan_at: number of a scan whose limits are the wrong way round.
        silence: seconds without a message in the middle.
        robots: namespaces, each with all the topics.
        climb: speed upwards of the last command.
        second_frame: frame of the speeds in the second half.
    """
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {
            robot + t: writer.add_connection(robot + t, name, typestore=_STORE)
            for robot in robots
            for t, name in _TYPES.items()
        }

        def put(topic: str, time_ns: int, message: Any) -> None:
            for robot in robots:
                writer.write(connections[robot + topic], time_ns, _STORE.serialize_cdr(message, _TYPES[topic]))

        for i in range(10 * SECONDS):
            time_ns = START_NS + i * 100_000_000 + (i >= 5 * SECONDS) * silence * 1_000_000_000
            put("/scan", time_ns, _scan(time_ns, 1 + i / 100, swapped=i == bad_scan_at))
            put("/odom", time_ns, _odometry(time_ns, i / 100, "base_link" if i < 50 else second_frame))
            if i >= 50:
                put("/cmd_vel", time_ns, _twist(i / 100, climb if i == 10 * SECONDS - 1 else 0.0))
            if i in (20, 30, 60, 70):
                put("/bumper", time_ns, _new("kobuki_ros_interfaces/msg/BumperEvent", 0, i in (20, 60)))
        put("/log", START_NS + (SECONDS + silence) * 1_000_000_000, _new("std_msgs/msg/String", "done"))
    return folder


def _new(type_name: str, *values: Any) -> Any:
    return _STORE.types[type_name](*values)


def _header(time_ns: int) -> Any:
    stamp = _new("builtin_interfaces/msg/Time", *divmod(time_ns, 10**9))
    return _new("std_msgs/msg/Header", stamp, "laser")


def _scan(time_ns: int, distance: float, swapped: bool) -> Any:
    low, high = (30.0, 0.1) if swapped else (0.1, 30.0)
    ranges, none = np.array([distance], np.float32), np.empty(0, np.float32)
    return _new("sensor_msgs/msg/LaserScan", _header(time_ns), 0.0, 0.0, 0.1, 0.0, 0.0, low, high, ranges, none)


def _twist(forward: float, up: float = 0.0) -> Any:
    zero = _new("geometry_msgs/msg/Vector3", 0.0, 0.0, 0.0)
    return _new("geometry_msgs/msg/Twist", _new("geometry_msgs/msg/Vector3", forward, 0.0, up), zero)


def _odometry(time_ns: int, forward: float, frame_id: str) -> Any:
    pose = _new(
        "geometry_msgs/msg/Pose",
        _new("geometry_msgs/msg/Point", 0.0, 0.0, 0.0),
        _new("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0),
    )
    return _new(
        "nav_msgs/msg/Odometry",
        _header(time_ns),
        frame_id,
        _new("geometry_msgs/msg/PoseWithCovariance", pose, _COVARIANCE),
        _new("geometry_msgs/msg/TwistWithCovariance", _twist(forward), _COVARIANCE),
    )

"""The messages of a robot with thirty topics, without its scans: mixed types as CDR, two topics at 1 kHz."""

from __future__ import annotations

import heapq
import struct
import threading
import time
from collections.abc import Callable
from math import cos, sin
from typing import Any

import numpy as np

Send = Callable[[bytes], None]

TOPICS = {
    "/imu": ("sensor_msgs/msg/Imu", 1000),
    "/joint_states": ("sensor_msgs/msg/JointState", 1000),
    "/wheel/left": ("std_msgs/msg/Float64", 100),
    "/wheel/right": ("std_msgs/msg/Float64", 100),
    "/odom": ("nav_msgs/msg/Odometry", 40),
    "/tf": ("tf2_msgs/msg/TFMessage", 40),
    "/ticks": ("std_msgs/msg/Int32", 50),
    "/magnetic_field": ("sensor_msgs/msg/MagneticField", 50),
    "/range/front": ("sensor_msgs/msg/Range", 20),
    "/range/left": ("sensor_msgs/msg/Range", 20),
    "/joy": ("sensor_msgs/msg/Joy", 20),
    "/effort": ("std_msgs/msg/Float64MultiArray", 20),
    "/cmd_vel": ("geometry_msgs/msg/Twist", 10),
    "/rosout": ("rcl_interfaces/msg/Log", 10),
    "/pose": ("geometry_msgs/msg/PoseStamped", 10),
    "/bumper": ("std_msgs/msg/Bool", 10),
    "/fluid_pressure": ("sensor_msgs/msg/FluidPressure", 10),
    "/points": ("sensor_msgs/msg/PointCloud2", 5),
    "/fix": ("sensor_msgs/msg/NavSatFix", 5),
    "/amcl_pose": ("geometry_msgs/msg/PoseWithCovarianceStamped", 2),
    "/particles": ("geometry_msgs/msg/PoseArray", 2),
    "/plan": ("nav_msgs/msg/Path", 1),
    "/map": ("nav_msgs/msg/OccupancyGrid", 1),
    "/goal": ("geometry_msgs/msg/PoseStamped", 1),
    "/battery_state": ("sensor_msgs/msg/BatteryState", 1),
    "/temperature": ("sensor_msgs/msg/Temperature", 1),
    "/humidity": ("sensor_msgs/msg/RelativeHumidity", 1),
    "/mode": ("std_msgs/msg/String", 1),
    "/diagnostics": ("diagnostic_msgs/msg/DiagnosticArray", 1),
}
"""Type and messages per second of each topic; /scan is the thirtieth."""

VARIANTS = 16
"""The number of different messages of a topic, which come in turn."""
_SIDE, _POINTS = 200, 2000
_LENGTHS = {
    "transforms": 3,
    "poses": 100,
    "position": 12,
    "velocity": 12,
    "effort": 12,
    "axes": 6,
    "buttons": 12,
    "cell_voltage": 4,
    "cell_temperature": 4,
}
"""The lengths of arrays, by field. Other arrays have one element."""
_STAMPED = ("builtin_interfaces/msg/Time", "std_msgs/msg/Header")


class Robot:
    """A publisher of all topics in `TOPICS`: first once each, and from `start` on in a thread, each at its rate.

    Args:
        sender_of: returns the publisher of a topic of a type.
    """

    def __init__(self, sender_of: Callable[[str, str], Send]) -> None:
        made = _Messages()
        self._parts = [
            (1 / hz, sender_of(topic, kind), made.stamp_at(kind), made.of(topic, kind))
            for topic, (kind, hz) in TOPICS.items()
        ]
        self._ended = threading.Event()
        self._count, self._began = 0, time.perf_counter()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def say_once(self) -> None:
        """Publish one message on each topic."""
        for _, send, _, messages in self._parts:
            send(bytes(messages[0]))

    def start(self) -> None:
        """Publish each topic at its rate."""
        self._began = time.perf_counter()
        self._thread.start()

    def rate(self) -> float:
        """Return the messages per second since the start."""
        return self._count / (time.perf_counter() - self._began)

    def stop(self) -> None:
        """End the thread."""
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        start = time.perf_counter()
        due = [(start + every * index / len(self._parts), index, 0) for index, (every, *_) in enumerate(self._parts)]
        heapq.heapify(due)
        while not self._ended.is_set():
            when, index, turn = due[0]
            if (wait := when - time.perf_counter()) > 0:
                time.sleep(wait)
            every, send, stamp_at, messages = self._parts[index]
            raw = messages[turn % VARIANTS]
            if stamp_at:
                struct.pack_into("<iI", raw, stamp_at, *divmod(time.time_ns(), 1_000_000_000))
            send(bytes(raw))
            self._count += 1
            heapq.heapreplace(due, (when + every, index, turn + 1))


class _Messages:
    """A factory of messages of any ROS 2 type, with numbers that change from message to message."""

    def __init__(self) -> None:
        from rosbags.typesys import Stores, get_typestore

        self._store = get_typestore(Stores.ROS2_HUMBLE)

    def stamp_at(self, kind: str) -> int:
        """Return the offset of the first stamp in the bytes of a message, or 0 without a stamp."""
        if kind == "tf2_msgs/msg/TFMessage":
            return 8  # after the number of transforms
        _, what = self._store.fielddefs[kind][1][0][1]
        return 4 if what in _STAMPED else 0

    def of(self, topic: str, kind: str) -> list[bytearray]:
        """Return the messages of a topic."""
        made = (self._filled(kind, number) for number in range(VARIANTS))
        return [bytearray(self._store.serialize_cdr(_sensible(topic, message), kind)) for message in made]

    def _filled(self, kind: str, number: int) -> Any:
        if kind == "geometry_msgs/msg/Quaternion":
            return self._store.types[kind](0.0, 0.0, sin(number / 9), cos(number / 9))
        fields = self._store.fielddefs[kind][1]
        return self._store.types[kind](*(self._field(name, *what, number) for name, what in fields))

    def _field(self, name: str, sort: int, what: Any, number: int) -> Any:
        from rosbags.interfaces import Nodetype

        if sort == Nodetype.NAME:
            return self._filled(what, number)
        if sort == Nodetype.BASE:
            return _value(name, what[0], number)
        (inner, one), count = what
        count = count if sort == Nodetype.ARRAY else _LENGTHS.get(name, 1)
        if inner == Nodetype.BASE and one[0] != "string":
            kind = {"octet": "uint8", "byte": "uint8", "char": "uint8"}.get(one[0], one[0])
            return np.array([_value(f"{name}{i}", one[0], number) for i in range(count)]).astype(kind)
        return [self._field(f"{name}_{i}", inner, one, number + i) for i in range(count)]


def _value(name: str, kind: str, number: int) -> Any:
    if kind == "string":
        return f"{name} {number}"
    if kind == "bool":
        return number % 2 == 0
    return sin(number / 3 + len(name)) if kind.startswith("float") else number % 5


def _sensible(topic: str, message: Any) -> Any:
    """Return the message with consistent sizes and names."""
    frames = {"/imu": "base_link", "/odom": "odom", "/range/front": "front", "/range/left": "left"}
    if hasattr(message, "header"):
        message.header.frame_id = frames.get(topic, "map")
    if topic == "/odom":
        message.child_frame_id = "base_link"
    if topic == "/tf":
        names = ("map", "odom", "base_link", "laser")
        for part, parent, child in zip(message.transforms, names[:-1], names[1:], strict=True):
            part.header.frame_id, part.child_frame_id = parent, child
    if topic == "/plan":
        for pose in message.poses:
            pose.header.frame_id = "map"
    if topic == "/joint_states":
        message.name = [f"joint {i + 1}" for i in range(len(message.position))]
    if topic.startswith("/range/"):
        message.min_range, message.max_range, message.range, message.field_of_view = 0.02, 4.0, 1.0, 0.5
    if topic == "/rosout":
        message.level, message.name, message.msg = (20, 20, 30, 40)[message.level % 4], "planner", "no path to the goal"
    if topic == "/map":
        message.info.resolution, message.info.width, message.info.height = 0.05, _SIDE, _SIDE
        message.data = np.tile(np.array([0, 0, 100, -1], np.int8), _SIDE * _SIDE // 4)
    if topic == "/points":
        field = type(message.fields[0])
        message.fields = [field(name, 4 * i, 7, 1) for i, name in enumerate("xyz")]
        message.height, message.width, message.point_step, message.row_step = 1, _POINTS, 12, 12 * _POINTS
        message.data = np.random.default_rng(1).uniform(-5, 5, 3 * _POINTS).astype(np.float32).view(np.uint8)
    return message

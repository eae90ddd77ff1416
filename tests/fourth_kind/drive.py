"""A recording of numbers: a depth as Float64, and how far something is as Range."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

START_NS = 1_700_000_000_000_000_000
COUNT = 50
STEP = 0.1

_STORE = get_typestore(Stores.ROS2_HUMBLE)
_FLOAT, _RANGE, _TIME, _HEADER = (
    _STORE.types[name]
    for name in ("std_msgs/msg/Float64", "sensor_msgs/msg/Range", "builtin_interfaces/msg/Time", "std_msgs/msg/Header")
)


def write(folder: Path) -> Path:
    """Five seconds at 10 Hz: number i of /depth is i / 10, of /sonar 2 m - i cm; /cliff says that nothing is there."""
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        topics = {"/depth": _FLOAT, "/sonar": _RANGE, "/cliff": _RANGE}
        connections = {
            topic: writer.add_connection(topic, of.__msgtype__, typestore=_STORE) for topic, of in topics.items()
        }

        def put(topic: str, time_ns: int, message: Any) -> None:
            writer.write(connections[topic], time_ns, _STORE.serialize_cdr(message, message.__msgtype__))

        for i in range(COUNT):
            time_ns = START_NS + round(i * STEP * 1e9)
            put("/depth", time_ns, _FLOAT(i / 10))
            put("/sonar", time_ns, _range(time_ns, 2.0 - i / 100, (0.1, 4.0)))
            put("/cliff", time_ns, _range(time_ns, float("inf"), (0.3, 0.3)))
    return folder


def _range(time_ns: int, distance: float, limits: tuple[float, float]) -> Any:
    header = _HEADER(_TIME(*divmod(time_ns, 10**9)), "front")
    return _RANGE(header, _RANGE.ULTRASOUND, 0.1, *limits, distance)

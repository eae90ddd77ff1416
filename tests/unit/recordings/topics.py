"""Recordings with several topics of a kind, written for a test: any times, any values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from . import sweeps

_BUMP = "kobuki_ros_interfaces/msg/BumperEvent"
_TWIST = "geometry_msgs/msg/Twist"
_STORE = get_typestore(Stores.ROS2_HUMBLE)
_STORE.register(get_types_from_msg("uint8 bumper\nuint8 state\n", _BUMP))


def write(folder: Path, topics: Mapping[str, Iterable[tuple[float, float]]]) -> Path:
    """A folder with times, in seconds after the start, and values of topics, told apart by their names.

    With "scan": scans of one ray with that range; with "bump": 1 as the left one is pressed, 0 as it is released; all
    others: speeds forward.
    """
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, samples in topics.items():
            connection = writer.add_connection(topic, _type(topic), typestore=_STORE)
            for seconds, value in samples:
                writer.write(connection, sweeps.START_NS + round(seconds * 1e9), _bytes(_type(topic), value))
    return folder


def every(seconds: float, start: float, stop: float, value: float) -> Sequence[tuple[float, float]]:
    """Times that far apart, all of one value."""
    return [(start + i * seconds, value) for i in range(round((stop - start) / seconds))]


def _type(topic: str) -> str:
    return sweeps.TYPE if "scan" in topic else _BUMP if "bump" in topic else _TWIST


def _bytes(type_name: str, value: float) -> bytes:
    if type_name == sweeps.TYPE:
        return sweeps.scan(sweeps.START_NS, [value])
    vector = _STORE.types["geometry_msgs/msg/Vector3"]
    message = (
        _STORE.types[_BUMP](0, int(value))
        if type_name == _BUMP
        else _STORE.types[_TWIST](vector(value, 0.0, 0.0), vector(0.0, 0.0, 0.0))
    )
    return bytes(_STORE.serialize_cdr(message, type_name))

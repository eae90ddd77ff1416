"""A recording of bumps alone, written for a test, by a robot that lists only what is touched."""

from __future__ import annotations

from pathlib import Path

from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from .sweeps import START_NS


def write(folder: Path, touched: dict[float, bool]) -> Path:
    """A recording of a Create 3 whose left bumper is listed, or not, at some times."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    one, several = (f"irobot_create_msgs/msg/HazardDetection{end}" for end in ("", "Vector"))
    store.register(get_types_from_msg("std_msgs/Header header\nuint8 type\n", one))
    store.register(
        get_types_from_msg("std_msgs/Header header\nirobot_create_msgs/HazardDetection[] detections\n", several)
    )
    stamp = store.types["builtin_interfaces/msg/Time"](0, 0)
    header = store.types["std_msgs/msg/Header"]
    bump = store.types[one](header(stamp, "bump_left"), 1)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/hazard_detection", several, typestore=store)
        for seconds, is_touched in touched.items():
            message = store.types[several](header(stamp, ""), [bump] if is_touched else [])
            writer.write(connection, START_NS + round(seconds * 1e9), store.serialize_cdr(message, several))
    return folder

"""Recordings of scans alone, written for a test: any times, any number of rays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

START_NS = 1_700_000_000_000_000_000
TYPE = "sensor_msgs/msg/LaserScan"

_STORE = get_typestore(Stores.ROS2_HUMBLE)


def scan(
    stamp_ns: int,
    ranges: Sequence[float],
    intensities: Sequence[float] = (),
    angle_min: float = -0.5,
    increment: float = 0.1,
    frame_id: str = "laser",
) -> bytes:
    """The bytes of a scan; limits 0.1 to 30 m, rays so many radians apart."""
    stamp = _STORE.types["builtin_interfaces/msg/Time"](*divmod(stamp_ns, 10**9))
    header = _STORE.types["std_msgs/msg/Header"](stamp, frame_id)
    both = (np.asarray(values, np.float32) for values in (ranges, intensities))
    message = _STORE.types[TYPE](header, angle_min, 0.5, increment, 0.0, 0.0, 0.1, 30.0, *both)
    return bytes(_STORE.serialize_cdr(message, TYPE))


def write(
    folder: Path,
    scans: Iterable[tuple[float, bytes]],
    plugin: StoragePlugin = StoragePlugin.MCAP,
    compression: CompressionMode = CompressionMode.NONE,
    silent: Sequence[str] = (),
) -> Path:
    """A folder with scans on /scan, each with its log time in seconds after the start; nothing on silent topics."""
    writer = Writer(folder, version=9, storage_plugin=plugin)
    if compression is not CompressionMode.NONE:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection("/scan", TYPE, typestore=_STORE)
        for topic in silent:
            writer.add_connection(topic, TYPE, typestore=_STORE)
        for seconds, raw in scans:
            writer.write(connection, START_NS + round(seconds * 1e9), raw)
    return folder


def numbered(count: int, rays: int = 4) -> list[tuple[float, bytes]]:
    """Scans a tenth of a second apart; every range of scan i is 1 + i / 100."""
    return [(i / 10, scan(START_NS + i * 10**8, [1 + i / 100] * rays)) for i in range(count)]

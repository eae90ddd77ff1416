"""Recordings of scans and speeds with any times, in any order, in every file format, written for a test."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as FolderWriter
from rosbags.typesys import Stores, get_typestore
from ruamel.yaml import YAML

START_NS = 1_700_000_000_000_000_000
SCAN, SPEED = "/scan", "/vel"

Message = tuple[str, float, int]
"""Topic, log time in seconds after the start, and number."""

_TYPES = {SCAN: "sensor_msgs/msg/LaserScan", SPEED: "geometry_msgs/msg/Twist"}
_ROS1, _ROS2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)


def drive(times: Sequence[float]) -> list[Message]:
    """A scan and a speed at each time, numbered in order of arrival."""
    return [(topic, time, i) for i, time in enumerate(times) for topic in (SCAN, SPEED)]


def step(by: float, at: int = 50, count: int = 100) -> list[float]:
    """Times a tenth of a second apart, by a clock that is set back."""
    return [i / 10 - by * (i >= at) for i in range(count)]


def bag(folder: Path, held: Sequence[Message], compression: str = "none") -> Path:
    """A ROS 1 bag of many chunks."""
    writer = BagWriter(folder / "drive.bag")
    if compression != "none":
        writer.set_compression(BagWriter.CompressionFormat[compression.upper()])
    writer.chunk_threshold = 3000
    _fill(writer, _ROS1, _ROS1.serialize_ros1, held)
    return folder / "drive.bag"


def bz2(folder: Path, held: Sequence[Message]) -> Path:
    """The same, compressed."""
    return bag(folder, held, "bz2")


def mcap(folder: Path, held: Sequence[Message], rays: int = 4) -> Path:
    """An MCAP file, of one chunk if scans have few rays."""
    return _rosbag2(folder / "drive", held, StoragePlugin.MCAP, rays)


def long_mcap(folder: Path, held: Sequence[Message]) -> Path:
    """An MCAP file of several chunks."""
    return mcap(folder, held, rays=8000)


def db3(folder: Path, held: Sequence[Message]) -> Path:
    """A database."""
    return _rosbag2(folder / "drive", held, StoragePlugin.SQLITE3)


def bare_split(folder: Path, held: Sequence[Message]) -> Path:
    """A folder of three databases without metadata, the second of which begins where a clock set back at 50 is."""
    return _split(folder, held, StoragePlugin.SQLITE3).parent


def split_db3(folder: Path, held: Sequence[Message]) -> Path:
    """The same with metadata."""
    return _with_metadata(_split(folder, held, StoragePlugin.SQLITE3), held)


def split_mcap(folder: Path, held: Sequence[Message]) -> Path:
    """The same as MCAP files."""
    return _with_metadata(_split(folder, held, StoragePlugin.MCAP), held)


KINDS: dict[str, Callable[[Path, Sequence[Message]], Path]] = {
    write.__name__: write for write in (bag, bz2, mcap, long_mcap, db3, bare_split, split_db3, split_mcap)
}


def _rosbag2(folder: Path, held: Sequence[Message], plugin: StoragePlugin, rays: int = 4) -> Path:
    _fill(FolderWriter(folder, version=9, storage_plugin=plugin), _ROS2, _ROS2.serialize_cdr, held, rays)
    return folder / f"{folder.name}.{'mcap' if plugin is StoragePlugin.MCAP else 'db3'}"


def _fill(writer: Any, store: Any, serialize: Any, held: Sequence[Message], rays: int = 4) -> None:
    with writer:
        connections = {topic: writer.add_connection(topic, name, typestore=store) for topic, name in _TYPES.items()}
        for topic, seconds, number in held:
            message = _scan(store, number, rays) if topic == SCAN else _twist(store, number)
            raw = serialize(message, _TYPES[topic])
            writer.write(connections[topic], START_NS + round(seconds * 1e9), bytes(raw))


def _scan(store: Any, number: int, rays: int) -> Any:
    """Every range of scan i is 1 + i / 100, and its own clock was not set back."""
    stamp = store.types["builtin_interfaces/msg/Time"](*divmod(START_NS + number * 10**8, 10**9))
    kind = store.types["std_msgs/msg/Header"]
    header = kind(0, stamp, "laser") if store is _ROS1 else kind(stamp, "laser")
    ranges = np.full(rays, 1 + number / 100, np.float32)
    return store.types[_TYPES[SCAN]](header, 0.0, 1.0, 0.1, 0.0, 0.0, 0.1, 30.0, ranges, np.empty(0, np.float32))


def _twist(store: Any, number: int) -> Any:
    vector = store.types["geometry_msgs/msg/Vector3"]
    return store.types[_TYPES[SPEED]](vector(number / 100, 0.0, 0.0), vector(0.0, 0.0, 0.0))


def _split(folder: Path, held: Sequence[Message], plugin: StoragePlugin) -> Path:
    (folder / "split").mkdir()
    edges = (0, 100, 130, len(held))
    for number in range(3):
        file = _rosbag2(folder / f"part_{number}", held[edges[number] : edges[number + 1]], plugin)
        file.rename(folder / "split" / f"drive_{number}{file.suffix}")
    return folder / "split" / "metadata.yaml"


def _with_metadata(path: Path, held: Sequence[Message]) -> Path:
    yaml = YAML(typ="safe")
    told = yaml.load((path.parents[1] / "part_0" / path.name).read_text())
    about = told["rosbag2_bagfile_information"]
    times = [seconds for _, seconds, _ in held]
    about["relative_file_paths"] = sorted(file.name for file in path.parent.iterdir())
    about["starting_time"]["nanoseconds_since_epoch"] = START_NS + round(min(times) * 1e9)
    about["duration"]["nanoseconds"] = round((max(times) - min(times)) * 1e9)
    about["message_count"] = len(held)
    for topic in about["topics_with_message_count"]:
        topic["message_count"] = sum(name == topic["topic_metadata"]["name"] for name, _, _ in held)
    text = StringIO()
    yaml.dump(told, text)
    path.write_text(text.getvalue())
    return path.parent


def cut(path: Path) -> Path:
    """The file without its end: a part of the index, or the last rows."""
    path.write_bytes(path.read_bytes()[:-80])
    return path

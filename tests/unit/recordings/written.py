"""Small recordings written for a test, and their content."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterable
from pathlib import Path

from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as FolderWriter
from rosbags.typesys import Stores, get_typestore

from robowidgets.repair.source import Source

START_NS = 1_700_000_000_000_000_000
STEP_NS = 50_000_000
TYPES = {"/scan": "sensor_msgs/msg/LaserScan", "/cmd_vel": "geometry_msgs/msg/Twist"}

Message = tuple[str, int, bytes]


def messages(count: int = 100, size: int = 400) -> list[Message]:
    """Topic, log time and bytes: every third is a speed, the rest are scans; bytes that hardly compress."""
    return [
        (
            "/cmd_vel" if i % 3 == 2 else "/scan",
            START_NS + i * STEP_NS,
            b"".join(hashlib.sha256(struct.pack("<HH", i, k)).digest() for k in range(size // 32)),
        )
        for i in range(count)
    ]


def write_bag(path: Path, held: Iterable[Message], compression: str = "none", chunk: int = 8000) -> Path:
    """A ROS 1 bag with chunks of about so many bytes."""
    writer = BagWriter(path)
    if compression != "none":
        writer.set_compression(BagWriter.CompressionFormat[compression.upper()])
    writer.chunk_threshold = chunk
    store = get_typestore(Stores.ROS1_NOETIC)
    with writer:
        connections = {topic: writer.add_connection(topic, name, typestore=store) for topic, name in TYPES.items()}
        for topic, time_ns, data in held:
            writer.write(connections[topic], time_ns, data)
    return path


def write_db3(folder: Path, held: Iterable[Message]) -> Path:
    """A rosbag2 database in a folder of its own."""
    _write_folder(folder, held, StoragePlugin.SQLITE3)
    return folder / f"{folder.name}.db3"


def write_indexed_mcap(folder: Path, held: Iterable[Message]) -> Path:
    """A whole MCAP file in a folder of its own, as rosbags writes it."""
    _write_folder(folder, held, StoragePlugin.MCAP)
    return folder / f"{folder.name}.mcap"


def _write_folder(folder: Path, held: Iterable[Message], plugin: StoragePlugin) -> None:
    store = get_typestore(Stores.ROS2_HUMBLE)
    with FolderWriter(folder, version=9, storage_plugin=plugin) as writer:
        connections = {topic: writer.add_connection(topic, name, typestore=store) for topic, name in TYPES.items()}
        for topic, time_ns, data in held:
            writer.write(connections[topic], time_ns, data)


MCAP_MAGIC = b"\x89MCAP0\r\n"


def record(op: int, payload: bytes) -> bytes:
    """One MCAP record."""
    return struct.pack("<BQ", op, len(payload)) + payload


def string(text: str) -> bytes:
    """A string as MCAP writes it."""
    return struct.pack("<I", len(text.encode())) + text.encode()


def mcap_head(encoding: str = "cdr", schema: str = "ros2msg", names: Iterable[str] = tuple(TYPES.values())) -> bytes:
    """Header, schemas and channels 1, 2, ... of the topics of `TYPES`."""
    raw = record(0x01, string("ros2") + string("test"))
    for number, (topic, name) in enumerate(zip(TYPES, names, strict=True), start=1):
        raw += record(0x03, struct.pack("<H", number) + string(name) + string(schema) + string(f"# {name}\n"))
        raw += record(
            0x04, struct.pack("<HH", number, number) + string(topic) + string(encoding) + struct.pack("<I", 0)
        )
    return raw


def mcap_messages(held: Iterable[Message]) -> bytes:
    """Message records on the channels of `mcap_head`."""
    ids = {topic: number for number, topic in enumerate(TYPES, start=1)}
    return b"".join(
        record(0x05, struct.pack("<HIQQ", ids[topic], 0, time_ns, time_ns) + data) for topic, time_ns, data in held
    )


def mcap_chunk(raw: bytes, compression: str, packed: bytes, checksum: int = 0) -> bytes:
    """A chunk record; the times of its messages stay 0, because no reader should need them."""
    head = struct.pack("<QQQI", 0, 0, len(raw), checksum) + string(compression)
    return record(0x06, head + struct.pack("<Q", len(packed)) + packed)


MCAP_END = record(0x0F, bytes(4)) + record(0x02, bytes(20)) + MCAP_MAGIC


def read(source: Source) -> list[Message]:
    """All messages of a source."""
    return [(channel.topic, time_ns, data) for channel, time_ns, data in source.messages(source.channels)]

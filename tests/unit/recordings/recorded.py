"""Recordings written for tests, of messages given by their fields."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from robowidgets.messages import definitions
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import store_of
from robowidgets.messages.encoding import encode

START_NS = 1_700_000_000_000_000_000
"""Log time of second 0."""


def write(
    folder: Path,
    topics: Mapping[str, str],
    messages: Iterable[tuple[float, str, Mapping[str, Any] | bytes]],
    plugin: StoragePlugin = StoragePlugin.MCAP,
    compression: CompressionMode = CompressionMode.NONE,
) -> Path:
    """A folder with these topics, each of a message type.

    Messages are seconds, a topic, and fields or bytes. A field that is left out is zero or empty.
    """
    writer = Writer(folder, version=9, storage_plugin=plugin)
    if compression is not CompressionMode.NONE:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        stores = {name: store_of(Channel(0, "", name, "cdr", "", 0)) for name in topics.values()}
        connections = {
            topic: writer.add_connection(topic, name, typestore=stores[name]) for topic, name in topics.items()
        }
        for seconds, topic, message in messages:
            raw = message if isinstance(message, bytes) else encode("cdr", topics[topic], message)
            writer.write(connections[topic], START_NS + round(seconds * 1e9), raw)
    return folder


def forget_definitions(folder: Path) -> Path:
    """Remove the definitions of its messages from a database, as in ROS 2 Humble, and the added definitions.

    Returns:
        The database.
    """
    (database,) = folder.glob("*.db3")
    connection = sqlite3.connect(database)
    with connection:
        connection.execute("DROP TABLE message_definitions")
    connection.close()
    definitions._added.clear()
    definitions.add({})  # so that definitions are looked up again
    return database


def stamped(time_ns: int, frame_id: str = "") -> dict[str, Any]:
    """The fields of a header."""
    return {"stamp": dict(zip(("sec", "nanosec"), divmod(time_ns, 10**9), strict=True)), "frame_id": frame_id}

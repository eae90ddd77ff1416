"""When the last message of a connection was written, from the indexes of files that rosbags has opened.

What is here reads no message, and next to nothing of a file.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag2.storage_mcap import McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from ..repair.source import latest
from .chunk_pages import ENTRY, INDEX_HEAD
from .ros_arrivals import read_index


def bag_last(reader: BagReader, number: int) -> int | None:
    """Log time of the last message of a connection in a bag."""
    index = reader.indexes[number]
    return index[-1].time if index else None


def mcap_last(reader: McapReader, number: int) -> int | None:
    """The same in an MCAP file; where chunks overlap, perhaps a time after it.

    Raises:
        RecordingError: the index claims what cannot be.
    """
    chunks = sorted((chunk for chunk in reader.chunks if chunk.channel_count.get(number)), key=_end)
    if not chunks:
        return None
    size = INDEX_HEAD.size + chunks[-1].channel_count[number] * ENTRY.itemsize
    times = read_index(Path(str(reader.path)), [(chunks[-1].message_index_offsets[number], size)]).entries["time"]
    return max([int(times.max()) if times.size else _end(chunks[-1]), *map(_end, chunks[-2:-1])])


def sqlite_last(reader: Sqlite3Reader, number: int) -> int | None:
    """The same in a database."""
    assert reader.dbconn
    query = "SELECT timestamp FROM messages WHERE topic_id = ? ORDER BY timestamp DESC LIMIT 1"
    row = reader.dbconn.execute(query, (number,)).fetchone()
    return int(row[0]) if row else None


def folder_last(reader: Any, number: int) -> int | None:
    """The same in the files of a folder.

    Args:
        reader: a DirectoryReader.
        number: of one of its connections.

    Raises:
        RecordingError: as `mcap_last`.
    """
    ours = next((c.topic, c.msgtype) for c in reader.connections if c.id == number)
    return latest(
        mcap_last(storage, c.id) if isinstance(storage, McapReader) else sqlite_last(storage, c.id)
        for storage in reader.storages
        for c in storage.connections
        if (c.topic, c.msgtype) == ours and c.msgcount
    )


def _end(chunk: Any) -> int:
    return int(chunk.message_end_time)

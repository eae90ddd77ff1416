"""When and in which order messages were written, from the indexes of files that rosbags has opened.

What is here takes a moment even for a large file: no message is read.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag2.storage_mcap import ChunkInfo, McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from .chunk_pages import ENTRY, index_records
from .one_clock import JITTER_NS
from .source import Arrivals, RecordingError, joined

_MOST_BYTES = 1 << 22
"""Of the indexes of chunks: more are only read where the times of the chunks overlap."""


def bag_arrivals(reader: BagReader) -> Arrivals:
    """Of every message in a bag."""
    counts = [len(index) for index in reader.indexes.values()]
    entries = chain.from_iterable(chain.from_iterable(reader.indexes.values()))
    table = np.fromiter(entries, np.int64, 3 * sum(counts)).reshape(-1, 3)
    order = np.lexsort((table[:, 2], table[:, 1]))
    return Arrivals(table[order, 0], np.repeat(_ids(reader.indexes), counts)[order])


def mcap_arrivals(reader: McapReader) -> Arrivals:
    """Of every message in an MCAP file; of a long one, whose chunks follow each other, of the ends of its chunks.

    Raises:
        RecordingError: there is no index, or it is none.
    """
    chunks = sorted(reader.chunks, key=lambda chunk: chunk.chunk_start_offset)
    if not chunks and reader.metadata.message_count:
        raise RecordingError(f"{reader.path}: expected an index of its chunks")
    starts, ends = (np.array([chunk[i] for chunk in chunks], np.int64) for i in (0, 1))
    overlap = (starts[1:] < np.maximum.accumulate(ends)[:-1] - JITTER_NS).any()
    if sum(chunk.message_index_length for chunk in chunks) <= _MOST_BYTES or overlap:
        return _by_message(Path(str(reader.path)), chunks)
    return joined(
        Arrivals(np.full(len(chunk.channel_count), time), _ids(chunk.channel_count))
        for chunk in chunks
        for time in (chunk.message_start_time, chunk.message_end_time)
    )


def sqlite_arrivals(reader: Sqlite3Reader) -> Arrivals:
    """Of every row in a database, as if of one topic where their order alone shows that no topic goes back."""
    assert reader.dbconn
    # The one index there is has both, so that no row is read.
    rows = chain.from_iterable(reader.dbconn.execute("SELECT rowid, timestamp FROM messages"))
    table = np.fromiter(rows, np.int64).reshape(-1, 2)
    times = table[np.argsort(table[:, 0], kind="stable"), 1]
    if not times.size or (times >= np.maximum.accumulate(times) - JITTER_NS).all():
        return Arrivals(times, np.full(times.size, reader.connections[0].id if times.size else 0))
    rows = chain.from_iterable(reader.dbconn.execute("SELECT timestamp, topic_id FROM messages ORDER BY rowid"))
    table = np.fromiter(rows, np.int64).reshape(-1, 2)
    return Arrivals(table[:, 0], table[:, 1])


def folder_arrivals(reader: Any) -> Arrivals:
    """Of every message in the files of a folder, one file after the other.

    Args:
        reader: a DirectoryReader.

    Raises:
        RecordingError: as `mcap_arrivals`.
    """
    ours = {(connection.topic, connection.msgtype): connection.id for connection in reader.connections}
    parts = []
    for storage in reader.storages:
        arrivals = mcap_arrivals(storage) if isinstance(storage, McapReader) else sqlite_arrivals(storage)
        parts.append(arrivals.renumbered({c.id: ours.get((c.topic, c.msgtype), 0) for c in storage.connections}))
    return joined(parts)


def _by_message(path: Path, chunks: list[ChunkInfo]) -> Arrivals:
    ids: list[int] = []
    counts: list[int] = []
    bodies: list[bytes] = []
    bases: list[int] = []
    base = 0
    with path.open("rb", buffering=0) as file:
        if sum(chunk.message_index_length for chunk in chunks) > path.stat().st_size:
            raise RecordingError(f"{path}: the index of its chunks claims more than there is")
        for chunk in chunks:
            file.seek(chunk.chunk_start_offset + chunk.chunk_length)
            index = file.read(chunk.message_index_length)
            for channel, at, count in index_records(index):
                ids.append(channel)
                counts.append(count)
                bodies.append(index[at : at + count * ENTRY.itemsize])
                bases.append(base)
            base += chunk.uncompressed_size
    entries = np.frombuffer(b"".join(bodies), ENTRY)
    order = np.argsort(entries["offset"].astype(np.int64) + np.repeat(np.array(bases, np.int64), counts), kind="stable")
    return Arrivals(entries["time"].astype(np.int64)[order], np.repeat(np.array(ids, np.int64), counts)[order])


def _ids(channels: Mapping[int, object]) -> NDArray[np.int64]:
    return np.array(list(channels), np.int64)

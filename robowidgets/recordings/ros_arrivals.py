"""When and in which order messages were written, from the indexes of files that rosbags has opened.

What is here takes a moment even for a large file: no message is read.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from operator import itemgetter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag2.storage_mcap import ChunkInfo, McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from ..repair._one_clock import JITTER_NS, LEAP_NS
from ..repair.source import Arrivals, RecordingError, joined
from .chunk_pages import ENTRY, INDEX_HEAD, index_records

_MOST_CHUNKS = 1000
"""Of an MCAP file: of more than these, a look into the index of each may take seconds where a disk is slow."""


def bag_arrivals(reader: BagReader) -> Arrivals:
    """Of every message in a bag."""
    counts = [len(index) for index in reader.indexes.values()]
    entries = chain.from_iterable(chain.from_iterable(reader.indexes.values()))
    table = np.fromiter(entries, np.int64, 3 * sum(counts)).reshape(-1, 3)
    order = np.lexsort((table[:, 2], table[:, 1]))
    return Arrivals(table[order, 0], np.repeat(_ids(reader.indexes), counts)[order])


def mcap_arrivals(reader: McapReader) -> Arrivals:
    """Of every message in an MCAP file, or of the ends of its chunks.

    Of the ends where time goes forward from each chunk to the next, and leaps in none.

    Raises:
        RecordingError: there is no index, or it claims what cannot be.
    """
    chunks = sorted(reader.chunks, key=lambda chunk: chunk.chunk_start_offset)
    if not chunks and reader.metadata.message_count:
        raise RecordingError(f"{reader.path}: expected an index of its chunks")
    starts, ends = (np.array([chunk[i] for chunk in chunks], np.int64) for i in (0, 1))
    path = Path(str(reader.path))
    is_back = (starts[1:] < np.maximum.accumulate(ends)[:-1] - JITTER_NS).any()
    if is_back or (ends - LEAP_NS > starts).any() or _goes_back_within(path, chunks):
        return _by_message(path, chunks)
    counts = np.array([len(chunk.channel_count) for chunk in chunks], np.int64)
    ids = [number for chunk in chunks for number in (*chunk.channel_count, *chunk.channel_count)]
    return Arrivals(np.repeat(np.stack((starts, ends), 1), np.repeat(counts, 2)), np.array(ids, np.int64))


def sqlite_arrivals(reader: Sqlite3Reader) -> Arrivals:
    """Of every row in a database, or of its ends, as if each topic was there.

    Of the ends where time goes forward with the rows, and not for so long that it may leap.
    """
    assert reader.dbconn
    ids = [connection.id for connection in reader.connections if connection.msgcount]
    if not ids:
        return joined(())
    # Of the index of times alone, and as one text: that takes a tenth of the time to open the file.
    query = "SELECT group_concat(rowid) FROM (SELECT rowid FROM messages ORDER BY timestamp)"
    ((rows,),) = reader.dbconn.execute(query)
    start, end = reader.metadata.start_time, reader.metadata.end_time - 1
    if end - start <= LEAP_NS and (np.diff(np.fromstring(rows, np.int64, sep=",")) > 0).all():
        ends = np.array([start, end], np.int64)
        return Arrivals(np.repeat(ends, len(ids)), np.array(2 * ids, np.int64))
    entries = chain.from_iterable(reader.dbconn.execute("SELECT timestamp, topic_id FROM messages ORDER BY rowid"))
    table = np.fromiter(entries, np.int64).reshape(-1, 2)
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


def _goes_back_within(path: Path, chunks: Sequence[ChunkInfo]) -> bool:
    """Whether the clock goes back within a chunk, as far as the channel with the most messages there tells."""
    if len(chunks) > _MOST_CHUNKS:
        return False
    most = [max(chunk.channel_count.items(), key=itemgetter(1), default=(0, 0)) for chunk in chunks]
    index = read_index(
        path,
        [
            (chunk.message_index_offsets[channel], INDEX_HEAD.size + count * ENTRY.itemsize)
            for chunk, (channel, count) in zip(chunks, most, strict=True)
            if count
        ],
    )
    times, offsets = index.entries["time"], index.entries["offset"]
    # Some writers sort an index by time.
    back = (times[1:] + np.uint64(JITTER_NS) < times[:-1]) | (offsets[1:] < offsets[:-1])
    back[np.cumsum(index.counts)[:-1] - 1] = False
    return bool(back.any())


def _by_message(path: Path, chunks: Sequence[ChunkInfo]) -> Arrivals:
    index = read_index(
        path, [(chunk.chunk_start_offset + chunk.chunk_length, chunk.message_index_length) for chunk in chunks]
    )
    order = np.lexsort((index.entries["offset"], np.repeat(index.places, index.counts)))
    return Arrivals(index.entries["time"].astype(np.int64)[order], np.repeat(index.channels, index.counts)[order])


class Index(NamedTuple):
    """Of each record: the number of the place where it was read, channel, number of entries; and all entries."""

    places: NDArray[np.int64]
    channels: NDArray[np.int64]
    counts: NDArray[np.int64]
    entries: NDArray[Any]


def read_index(path: Path, places: Sequence[tuple[int, int]]) -> Index:
    """The records of indexes of chunks at some places: where each starts, and its bytes."""
    records: list[tuple[int, int, int]] = []
    bodies: list[bytes] = []
    with path.open("rb", buffering=0) as file:
        sizes = [size for _, size in places]
        if sum(sizes) > path.stat().st_size or min(sizes, default=0) < 0:
            raise RecordingError(f"{path}: the index of its chunks claims more than there is")
        for number, (start, size) in enumerate(places):
            file.seek(start)
            index = file.read(size)
            for channel, at, count in index_records(index):
                records.append((number, channel, count))
                bodies.append(index[at : at + count * ENTRY.itemsize])
    table = np.array(records, np.int64).reshape(-1, 3)
    return Index(table[:, 0], table[:, 1], table[:, 2], np.frombuffer(b"".join(bodies), ENTRY))


def _ids(channels: Mapping[int, object]) -> NDArray[np.int64]:
    return np.array(list(channels), np.int64)

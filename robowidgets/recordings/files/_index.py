"""The times and the order of messages, from the indexes of files that rosbags has opened.

No message is read: this takes a moment even for a large file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from heapq import nlargest, nsmallest
from itertools import chain
from operator import itemgetter
from pathlib import Path
from struct import Struct, error
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag2.storage_mcap import ChunkInfo, McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from ...repair import JITTER_NS, LEAP_NS, Arrivals, RecordingError

_MOST_CHUNKS = 1000
"""Most chunks of an MCAP file whose indexes are read: with more, a slow disk would take seconds."""

_INDEX_OP = 7
_RECORD_HEAD = 9
_INDEX_HEAD = Struct("<BQHI")
_ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
"""The entry of a message in the index of a chunk of an MCAP file; the entries of a channel follow a head."""


class Index(Protocol):
    """The index of a file or folder."""

    def arrivals(self) -> Arrivals:
        """The order of arrival of all messages, or of some messages of each part."""

    def span_ns(self, number: int) -> tuple[int, int] | None:
        """Log times of the first and the last message of a connection, or a little around them; None if it has none."""


class BagIndex:
    """The index of a bag."""

    def __init__(self, reader: BagReader) -> None:
        self._indexes = reader.indexes

    def arrivals(self) -> Arrivals:
        """See `Index`: all messages."""
        counts = [len(index) for index in self._indexes.values()]
        entries = chain.from_iterable(chain.from_iterable(self._indexes.values()))
        table = np.fromiter(entries, np.int64, 3 * sum(counts)).reshape(-1, 3)
        order = np.lexsort((table[:, 2], table[:, 1]))
        return Arrivals(table[order, 0], np.repeat(np.array(list(self._indexes), np.int64), counts)[order])

    def span_ns(self, number: int) -> tuple[int, int] | None:
        """See `Index`."""
        index = self._indexes[number]
        return (index[0].time, index[-1].time) if index else None


class McapIndex:
    """The index of an MCAP file. Its methods raise RecordingError if its contents are impossible."""

    def __init__(self, reader: McapReader) -> None:
        self._path = Path(str(reader.path))
        self._chunks = sorted(reader.chunks, key=lambda chunk: chunk.chunk_start_offset)
        self._is_missing = bool(not self._chunks and reader.metadata.message_count)

    def arrivals(self) -> Arrivals:
        """See `Index`: all messages, or the first and last ones of each chunk.

        The latter if time goes forward from each chunk to the next and leaps in none.
        """
        if self._is_missing:
            raise RecordingError(f"{self._path}: expected an index of its chunks")
        path, chunks = self._path, self._chunks
        starts, ends = (np.array([chunk[i] for chunk in chunks], np.int64) for i in (0, 1))
        is_back = (starts[1:] < np.maximum.accumulate(ends)[:-1] - JITTER_NS).any()
        if is_back or (ends - LEAP_NS > starts).any() or _goes_back_within(path, chunks):
            return _by_message(path, chunks)
        counts = np.array([len(chunk.channel_count) for chunk in chunks], np.int64)
        ids = [number for chunk in chunks for number in (*chunk.channel_count, *chunk.channel_count)]
        return Arrivals(np.repeat(np.stack((starts, ends), 1), np.repeat(counts, 2)), np.array(ids, np.int64))

    def span_ns(self, number: int) -> tuple[int, int] | None:
        """See `Index`: if chunks overlap, perhaps a longer span."""
        chunks = [chunk for chunk in self._chunks if chunk.channel_count.get(number)]
        if not chunks:
            return None
        early, late = nsmallest(2, chunks, key=_start), nlargest(2, chunks, key=_end)
        first, last = self._times(early[0], number), self._times(late[0], number)
        return (
            min([int(first.min()) if first.size else _start(early[0]), *map(_start, early[1:])]),
            max([int(last.max()) if last.size else _end(late[0]), *map(_end, late[1:])]),
        )

    def _times(self, chunk: ChunkInfo, number: int) -> NDArray[Any]:
        """The log times of the messages of a connection in a chunk."""
        size = _INDEX_HEAD.size + chunk.channel_count[number] * _ENTRY.itemsize
        return _read_index(self._path, [(chunk.message_index_offsets[number], size)]).entries["time"]


class SqliteIndex:
    """The index of a database."""

    def __init__(self, reader: Sqlite3Reader) -> None:
        assert reader.dbconn
        self._reader = reader
        self._connection = reader.dbconn
        self._spans: dict[int, tuple[int, int]] | None = None

    def arrivals(self) -> Arrivals:
        """See `Index`: all rows, or the first and last row, as if each topic had them.

        The latter if time goes forward with the rows and the recording is too short for a leap.
        """
        ids = [connection.id for connection in self._reader.connections if connection.msgcount]
        if not ids:
            return joined(())
        # From the index of times alone, and as one text: this takes a tenth of the time to open the file.
        query = "SELECT group_concat(rowid) FROM (SELECT rowid FROM messages ORDER BY timestamp)"
        ((rows,),) = self._connection.execute(query)
        start, end = self._reader.metadata.start_time, self._reader.metadata.end_time - 1
        if end - start <= LEAP_NS and (np.diff(np.fromstring(rows, np.int64, sep=",")) > 0).all():
            ends = np.array([start, end], np.int64)
            return Arrivals(np.repeat(ends, len(ids)), np.array(2 * ids, np.int64))
        rows = self._connection.execute("SELECT timestamp, topic_id FROM messages ORDER BY rowid")
        table = np.fromiter(chain.from_iterable(rows), np.int64).reshape(-1, 2)
        return Arrivals(table[:, 0], table[:, 1])

    def span_ns(self, number: int) -> tuple[int, int] | None:
        """See `Index`."""
        if self._spans is None:
            # One pass for all topics: a search for each would go through all rows for a topic with few messages.
            rows = self._connection.execute("SELECT topic_id, min(timestamp), max(timestamp) FROM messages GROUP BY 1")
            self._spans = {topic: (first, last) for topic, first, last in rows}
        return self._spans.get(number)


def joined(parts: Iterable[Arrivals]) -> Arrivals:
    """Several arrivals, concatenated."""
    none = np.empty(0, np.int64)
    times, channels = zip(Arrivals(none, none), *parts, strict=True)
    return Arrivals(np.concatenate(times), np.concatenate(channels))


def renumbered(arrivals: Arrivals, ids: Mapping[int, int]) -> Arrivals:
    """Arrivals with other ids of channels."""
    known, places = np.unique(arrivals.channels, return_inverse=True)
    return Arrivals(arrivals.times, np.array([ids[number] for number in known.tolist()], np.int64)[places])


def _goes_back_within(path: Path, chunks: Sequence[ChunkInfo]) -> bool:
    """Whether the clock goes back within a chunk, judged by the channel with the most messages there."""
    if len(chunks) > _MOST_CHUNKS:
        return False
    most = [max(chunk.channel_count.items(), key=itemgetter(1), default=(0, 0)) for chunk in chunks]
    index = _read_index(
        path,
        [
            (chunk.message_index_offsets[channel], _INDEX_HEAD.size + count * _ENTRY.itemsize)
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
    index = _read_index(
        path, [(chunk.chunk_start_offset + chunk.chunk_length, chunk.message_index_length) for chunk in chunks]
    )
    order = np.lexsort((index.entries["offset"], np.repeat(index.places, index.counts)))
    return Arrivals(index.entries["time"].astype(np.int64)[order], np.repeat(index.channels, index.counts)[order])


class _Records(NamedTuple):
    """For each record the index of its place, its channel and its number of entries; and all entries."""

    places: NDArray[np.int64]
    channels: NDArray[np.int64]
    counts: NDArray[np.int64]
    entries: NDArray[Any]


def _read_index(path: Path, places: Sequence[tuple[int, int]]) -> _Records:
    """The records of the indexes of chunks at some places, given as offset and size in bytes."""
    records: list[tuple[int, int, int]] = []
    bodies: list[bytes] = []
    with path.open("rb", buffering=0) as file:
        sizes = [size for _, size in places]
        if sum(sizes) > path.stat().st_size or min(sizes, default=0) < 0:
            raise RecordingError(f"{path}: the index of its chunks claims more than there is")
        for number, (start, size) in enumerate(places):
            file.seek(start)
            index = file.read(size)
            for channel, at, count in _records(index):
                records.append((number, channel, count))
                bodies.append(index[at : at + count * _ENTRY.itemsize])
    table = np.array(records, np.int64).reshape(-1, 3)
    return _Records(table[:, 0], table[:, 1], table[:, 2], np.frombuffer(b"".join(bodies), _ENTRY))


def _records(index: bytes) -> Iterator[tuple[int, int, int]]:
    """For each record of the index of a chunk: id of the channel, offset and number of entries. Raises struct.error."""
    at = 0
    while at < len(index):
        op, size, channel, length = _INDEX_HEAD.unpack_from(index, at)
        start = at + _INDEX_HEAD.size
        if op != _INDEX_OP or length % _ENTRY.itemsize or start + length > len(index):
            raise error(f"no record of an index at byte {at}")
        yield channel, start, length // _ENTRY.itemsize
        at += _RECORD_HEAD + size


def _start(chunk: ChunkInfo) -> int:
    return chunk.message_start_time


def _end(chunk: ChunkInfo) -> int:
    return chunk.message_end_time

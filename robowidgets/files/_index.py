"""The times and the order of messages, from the indexes of files that rosbags has opened.

No message is read: this takes a moment even for a large file.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from operator import itemgetter
from pathlib import Path
from struct import Struct, error
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag2.storage_mcap import ChunkInfo, McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from ..repair import JITTER_NS, LEAP_NS, Arrivals, RecordingError, joined, may_precede_clock

_MOST_CHUNKS = 1000
"""The maximum number of chunks of an MCAP file whose indexes are read: with more, a slow disk would take seconds."""

_INDEX_OP = 7
_INDEX_HEAD = Struct("<BQHI")
_ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
"""The entry of a message in the index of a chunk of an MCAP file; the entries of a channel follow a head."""


def arrivals_in_bag(reader: BagReader) -> Arrivals:
    """Return the order of arrival of all messages."""
    counts = [len(index) for index in reader.indexes.values()]
    entries = chain.from_iterable(chain.from_iterable(reader.indexes.values()))
    table = np.fromiter(entries, np.int64, 3 * sum(counts)).reshape(-1, 3)
    order = np.lexsort((table[:, 2], table[:, 1]))
    return Arrivals(table[order, 0], np.repeat(np.array(list(reader.indexes), np.int64), counts)[order])


def arrivals_in_mcap(reader: McapReader) -> Arrivals:
    """Return the order of arrival: first and last time in each chunk, as if each of its channels had messages then.

    All messages are used if time goes back between chunks or within a chunk, leaps within a chunk, or may have begun
    late.

    Raises:
        RecordingError: the contents of an index are impossible.
    """
    path, chunks = _chunks(reader)
    starts, ends = (np.array([chunk[i] for chunk in chunks], np.int64) for i in (0, 1))
    is_back = (starts[1:] < np.maximum.accumulate(ends)[:-1] - JITTER_NS).any()
    may_precede = len(chunks) > 0 and may_precede_clock(int(starts.min()), int(ends.max()))
    if is_back or may_precede or (ends - LEAP_NS > starts).any() or _goes_back_within(path, chunks):
        return _by_message(path, chunks)
    counts = np.array([len(chunk.channel_count) for chunk in chunks], np.int64)
    ids = [number for chunk in chunks for number in (*chunk.channel_count, *chunk.channel_count)]
    return Arrivals(np.repeat(np.stack((starts, ends), 1), np.repeat(counts, 2)), np.array(ids, np.int64))


def span_in_mcap(reader: McapReader, number: int) -> tuple[int, int] | None:
    """Return the log times of a connection's first and last message, or slightly wider times if chunks overlap.

    Return None if the connection has no messages. Raises as `arrivals_in_mcap`.
    """
    path, chunks = _chunks(reader)
    places = [_place(chunk, number) for chunk in chunks if chunk.channel_count.get(number)]
    if not places:
        return None
    first, last = (part.entries["time"] for part in _indexes(path, [places[0], places[-1]]))
    return int(first.min()), int(last.max())


def arrivals_in_database(reader: Sqlite3Reader) -> Arrivals:
    """Return the order of arrival of all messages.

    Raises:
        RecordingError: the index of times, by which rosbags reads, differs from the times of the messages.
    """
    assert reader.dbconn
    rows = reader.dbconn.execute("SELECT timestamp, topic_id FROM messages ORDER BY rowid")
    table = np.fromiter(chain.from_iterable(rows), np.int64).reshape(-1, 2)
    indexed = chain.from_iterable(reader.dbconn.execute("SELECT timestamp FROM messages ORDER BY timestamp"))
    if not np.array_equal(np.fromiter(indexed, np.int64), np.sort(table[:, 0])):
        raise RecordingError(f"{reader.path}: its index of times disagrees with its messages")
    return Arrivals(table[:, 0], table[:, 1])


def _goes_back_within(path: Path, chunks: Sequence[ChunkInfo]) -> bool:
    """Return True if the clock goes back within a chunk, judged by its channel with the most messages."""
    if len(chunks) > _MOST_CHUNKS:
        return False
    most = [(chunk, max(chunk.channel_count.items(), key=itemgetter(1), default=(0, 0))) for chunk in chunks]
    places = [_place(chunk, channel) for chunk, (channel, count) in most if count]
    return any((np.diff(part.by_arrival()[0]) < -JITTER_NS).any() for part in _indexes(path, places))


def _by_message(path: Path, chunks: Sequence[ChunkInfo]) -> Arrivals:
    places = [(chunk.chunk_start_offset + chunk.chunk_length, chunk.message_index_length) for chunk in chunks]
    return joined(part.by_arrival() for part in _indexes(path, places))


class _Index(NamedTuple):
    """The entries of messages in one chunk, and their channels, shape (N,) each."""

    entries: NDArray[Any]
    channels: NDArray[np.int64]

    def by_arrival(self) -> Arrivals:
        """Return the entries by arrival. An index lists channel after channel, and some writers sort these by time."""
        order = np.argsort(self.entries["offset"], kind="stable")
        return Arrivals(self.entries["time"].astype(np.int64)[order], self.channels[order])


def _chunks(reader: McapReader) -> tuple[Path, list[ChunkInfo]]:
    return Path(str(reader.path)), sorted(reader.chunks, key=lambda chunk: chunk.chunk_start_offset)


def _place(chunk: ChunkInfo, number: int) -> tuple[int, int]:
    """Return the offset and size in bytes of the index of a connection in a chunk."""
    return chunk.message_index_offsets[number], _INDEX_HEAD.size + chunk.channel_count[number] * _ENTRY.itemsize


def _indexes(path: Path, places: Sequence[tuple[int, int]]) -> Iterator[_Index]:
    """Yield the indexes at some places in a file, given as offset and size in bytes."""
    if sum(size for _, size in places) > path.stat().st_size:
        raise RecordingError(f"{path}: the index of its chunks is larger than the file")
    with path.open("rb", buffering=0) as file:
        for start, size in places:
            file.seek(start)
            records = list(_records(file.read(size)))
            ids, counts = [number for number, _ in records], [len(own) for _, own in records]
            entries = np.concatenate([np.empty(0, _ENTRY), *(own for _, own in records)])
            yield _Index(entries, np.repeat(np.array(ids, np.int64), counts))


def _records(index: bytes) -> Iterator[tuple[int, NDArray[Any]]]:
    """Yield the channels in the index of a chunk with their entries. Raises struct.error."""
    at = 0
    while at < len(index):
        op, _, channel, length = _INDEX_HEAD.unpack_from(index, at)
        at += _INDEX_HEAD.size
        if op != _INDEX_OP or length % _ENTRY.itemsize or at + length > len(index):
            raise error(f"no record of an index at byte {at}")
        yield channel, np.frombuffer(index, _ENTRY, length // _ENTRY.itemsize, at)
        at += length

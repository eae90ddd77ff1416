"""The times and the order of messages, from the indexes of files that rosbags has opened.

No message is read: this takes a moment even for a large file.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from struct import error
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from ..repair import JITTER_NS, LEAP_NS, Arrivals, RecordingError, joined, may_precede_clock
from ..repair.mcap_records import INDEX_ENTRY, INDEX_HEAD, MESSAGE_INDEX
from ._bag import BagInParts, BagReader
from ._mcap import IndexedMcapReader

_MOST_CHUNKS = 1000
"""The maximum number of chunks of an MCAP file whose indexes are read: with more, a slow disk would take seconds."""


def arrivals_in_bag(reader: BagReader) -> Arrivals:
    """Return the order of arrival of all messages."""
    counts = [len(index) for index in reader.indexes.values()]
    entries = chain.from_iterable(chain.from_iterable(reader.indexes.values()))
    table = np.fromiter(entries, np.int64, 3 * sum(counts)).reshape(-1, 3)
    order = np.lexsort((table[:, 2], table[:, 1]))
    return Arrivals(table[order, 0], np.repeat(np.array(list(reader.indexes), np.int64), counts)[order])


def arrivals_in_chunks(reader: IndexedMcapReader | BagInParts) -> Arrivals:
    """Return the order of arrival: first and last time in each chunk, as if each of its channels had messages then.

    All messages are used if time goes back between chunks or within a chunk, leaps within a chunk, or may have begun
    late.

    Raises:
        RecordingError: the contents of an index are impossible.
    """
    index = reader.index
    starts, ends = index.starts, index.ends
    is_back = (starts[1:] < np.maximum.accumulate(ends)[:-1] - JITTER_NS).any()
    may_precede = len(starts) > 0 and may_precede_clock(int(starts.min()), int(ends.max()))
    if is_back or may_precede or (ends - LEAP_NS > starts).any() or _goes_back_within(reader):
        if isinstance(reader, BagInParts) or reader.is_near:
            raise RecordingError(f"{reader.path}: its clock may have been set, and all of its indexes are needed")
        return _by_message(reader)
    chunk, channel = index.places[:2, index.places[3] != 0]
    counts = np.bincount(chunk, minlength=len(starts))
    times = np.repeat(np.stack((starts, ends), 1), np.repeat(counts, 2))
    twice = np.repeat(counts, 2)
    within = np.arange(len(times)) - np.repeat(np.cumsum(twice) - twice, twice)
    return Arrivals(times, channel[np.repeat(np.repeat(np.cumsum(counts) - counts, 2), twice) + within])


def span_in_mcap(reader: IndexedMcapReader, number: int) -> tuple[int, int] | None:
    """Return the log times of a connection's first and last message, or slightly wider times if chunks overlap.

    In a remote file, times that are far from others are the times of their chunks, so that few parts are fetched.
    Return None if the connection has no messages. Raises as `arrivals_in_chunks`.
    """
    rows = reader.index.by_channel.get(number)
    if rows is None:
        return None
    places = [_place(reader, rows[i]) for i in (0, -1)]
    if reader.is_near and not all(reader.is_near(*place) for place in places):
        first, last = reader.index.places[0, rows[[0, -1]]]
        return int(reader.index.starts[first]), int(reader.index.ends[last])
    first, last = (part.entries["time"] for part in _indexes(reader, places))
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


def _goes_back_within(reader: IndexedMcapReader | BagInParts) -> bool:
    """Return True if the clock goes back within a chunk, judged by its channel with the most messages."""
    places = reader.index.places
    if isinstance(reader, BagInParts) or reader.is_near or not 0 < len(reader.index.starts) <= _MOST_CHUNKS:
        return False
    most = np.lexsort((-places[3], places[0]))
    most = most[np.append(True, np.diff(places[0, most]) != 0)[: len(most)]]
    found = [_place(reader, row) for row in most if places[3, row]]
    return any((np.diff(part.by_arrival()[0]) < -JITTER_NS).any() for part in _indexes(reader, found))


def _by_message(reader: IndexedMcapReader) -> Arrivals:
    index = reader.index
    places = zip((index.offsets + index.lengths).tolist(), index.index_lengths.tolist(), strict=True)
    return joined(part.by_arrival() for part in _indexes(reader, list(places)))


class _Index(NamedTuple):
    """The entries of messages in one chunk, and their channels, shape (N,) each."""

    entries: NDArray[Any]
    channels: NDArray[np.int64]

    def by_arrival(self) -> Arrivals:
        """Return the entries by arrival. An index lists channel after channel, and some writers sort these by time."""
        order = np.argsort(self.entries["offset"], kind="stable")
        return Arrivals(self.entries["time"].astype(np.int64)[order], self.channels[order])


def _place(reader: IndexedMcapReader, row: int) -> tuple[int, int]:
    """Return the offset and size in bytes of the index of a connection in a chunk."""
    _, _, offset, count = reader.index.places[:, row].tolist()
    return offset, INDEX_HEAD.size + count * INDEX_ENTRY.itemsize


def _indexes(reader: IndexedMcapReader, places: Sequence[tuple[int, int]]) -> Iterator[_Index]:
    """Yield the indexes at some places in a file, given as offset and size in bytes."""
    assert reader.bio
    if sum(size for _, size in places) > reader.bio.seek(0, 2):
        raise RecordingError(f"{reader.path}: the index of its chunks is larger than the file")
    for start, size in places:
        reader.bio.seek(start)
        records = list(_records(reader.bio.read(size)))
        ids, counts = [number for number, _ in records], [len(own) for _, own in records]
        entries = np.concatenate([np.empty(0, INDEX_ENTRY), *(own for _, own in records)])
        yield _Index(entries, np.repeat(np.array(ids, np.int64), counts))


def _records(index: bytes) -> Iterator[tuple[int, NDArray[Any]]]:
    """Yield the channels in the index of a chunk with their entries. Raises struct.error."""
    at = 0
    while at < len(index):
        op, _, channel, length = INDEX_HEAD.unpack_from(index, at)
        at += INDEX_HEAD.size
        if op != MESSAGE_INDEX or length % INDEX_ENTRY.itemsize or at + length > len(index):
            raise error(f"no record of an index at byte {at}")
        yield channel, np.frombuffer(index, INDEX_ENTRY, length // INDEX_ENTRY.itemsize, at)
        at += length

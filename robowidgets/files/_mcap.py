"""MCAP files with an index, read by rosbags: opened by arrays instead of an object for each chunk, and read lazily."""

from __future__ import annotations

from collections.abc import Callable, Collection, Generator, Iterator
from heapq import heappop, heappush
from io import BytesIO
from pathlib import Path
from struct import Struct
from typing import Any, BinaryIO, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition, MessageDefinitionFormat
from rosbags.rosbag2.storage_mcap import (
    ChunkInfo,
    McapReader,
    Msg,
    Schema,
    Statistics,
    msgsrc,
    read_string,
)

from ..messages.channel import Channel
from ..repair import RecordingError
from ..repair import mcap_records as mcap

_MOST_SUMMARY = 1 << 29
"""Maximum bytes of a summary: it has some 300 bytes for each chunk."""
_FOOTER = Struct("<9sQQI8s")
_FOOTER_HEAD = b"\x02\x14" + bytes(7)
_END = 2**63 - 1
_COLUMNS = ("start", "end", "offset", "length", "index_length", "compressed", "size")
_MAP = 32
"""Bytes of the record of a chunk before its map of channels."""
_PLACES = np.dtype([("channel", "<u2"), ("offset", "<i8")])


IsNear = Callable[[int, int], bool]


class File(Protocol):
    """A remote file that is read in parts."""

    def exists(self) -> bool:
        """Return True if the file exists."""

    def open(self, mode: str) -> BinaryIO:
        """Open the file."""


class Chunks(NamedTuple):
    """The chunks of a file in the order of their offsets, as columns of shape (N,).

    ``places`` are the message indexes of all chunks, one after the other, in the order of their offsets: the number of
    the chunk, the channel, the offset, and the number of messages.
    """

    starts: NDArray[np.int64]
    ends: NDArray[np.int64]
    offsets: NDArray[np.int64]
    lengths: NDArray[np.int64]
    index_lengths: NDArray[np.int64]
    compressions: list[str]
    compressed: NDArray[np.int64]
    sizes: NDArray[np.int64]
    places: NDArray[np.int64]
    by_start: NDArray[np.int64]
    """The numbers of the chunks in the order of their start times."""
    by_channel: dict[int, NDArray[np.int64]]
    """The rows of ``places`` of each channel with a message."""

    def of(self, channels: Collection[int], start_ns: int | None, stop_ns: int | None) -> NDArray[np.int64]:
        """Return the numbers of the chunks with messages of some channels in a span, by their start times."""
        wanted = np.zeros(len(self.starts), np.bool_)
        for channel in channels:
            if channel in self.by_channel:
                wanted[self.places[0, self.by_channel[channel]]] = True
        if start_ns is not None:
            wanted &= self.ends >= start_ns
        if stop_ns is not None:
            wanted &= self.starts < stop_ns
        return self.by_start[wanted[self.by_start]]

    def spread(self, channels: Collection[int], most_bytes: int, most_chunks: int) -> NDArray[np.int64]:
        """Return the numbers of chunks with messages of some channels, evenly spread over their time.

        Args:
            channels: the ids of the channels.
            most_bytes: the maximum number of their bytes in the file.
            most_chunks: the maximum number of chunks.
        """
        numbers = self.of(channels, None, None)
        starts, count = self.starts[numbers], min(len(numbers), most_chunks)
        while count > 0:
            times = starts[0] + (np.arange(count) + 0.5) / count * (starts[-1] - starts[0])
            chosen: NDArray[np.int64] = numbers[np.unique(np.searchsorted(starts, times, "right") - 1)]
            size = int(self.lengths[chosen].sum())
            if size <= most_bytes:
                return chosen
            count = min(count - 1, count * most_bytes // size)
        return np.empty(0, np.int64)

    def counts(self) -> dict[int, int]:
        """Return the number of messages of each channel with a message."""
        return {channel: int(self.places[3, rows].sum()) for channel, rows in self.by_channel.items()}

    def info(self, number: int) -> ChunkInfo:
        """Return a chunk as rosbags describes it, without its message indexes."""
        columns = (self.starts, self.ends, self.offsets, self.lengths)
        start, end, offset, length = (int(column[number]) for column in columns)
        compressed, size = int(self.compressed[number]), int(self.sizes[number])
        compression = self.compressions[number]
        return ChunkInfo(
            start, end, offset, length, {}, int(self.index_lengths[number]), compression, compressed, size, {}
        )


class IndexedMcapReader(McapReader):
    """A reader of rosbags whose summary is parsed by NumPy, and whose chunks are opened when their time comes.

    For each chunk, rosbags keeps a dictionary of its channels, and prepares a generator for each request: with 27,000
    chunks these take 1 s and 0.1 s. ``chunks`` stays empty.

    Args:
        path: the file.
        is_near: for a remote file, returns True if some bytes at an offset may be read to make the times of a topic
            exact. Without an index such a file is not read, because that would take all of its bytes.
    """

    def __init__(self, path: Path | File, is_near: IsNear | None = None) -> None:
        super().__init__(path)  # type: ignore[arg-type]
        self.index = _chunks_from(b"", [])
        self.is_near = is_near
        self.named: dict[int, Channel] = {}
        """The channels in the summary by their ids, without the numbers of their messages."""

    def _open(self) -> None:
        """Read the index of a file with any profile; `McapReader` opens only files of ROS 2."""
        assert self.bio
        bio = self.bio
        bio.seek(len(mcap.MAGIC))
        _, size = mcap.RECORD_HEAD.unpack(bio.read(mcap.RECORD_HEAD.size))
        is_ros2 = read_string(bio) == "ros2"
        self.data_start = len(mcap.MAGIC) + mcap.RECORD_HEAD.size + size
        bio.seek(-_FOOTER.size, 2)
        head, summary, *_, magic = _FOOTER.unpack(bio.read(_FOOTER.size))
        if is_ros2 or not summary or (head, magic) != (_FOOTER_HEAD, mcap.MAGIC):
            bio.seek(0)
            super()._open()
            return
        self.data_end = summary
        self.read_index()
        if self.statistics is None:
            raise RecordingError(f"{self.path}: its summary has no statistics")
        count, *_, start, end, counts = self.statistics
        self.connections = [one._replace(msgcount=counts.get(one.id, 0)) for one in self.connections]
        self.metadata = self.metadata._replace(
            duration=end - start + 1 if count else 0,
            start_time=start if count else _END,
            end_time=end + 1 if count else 0,
            message_count=count,
        )

    def read_index(self) -> None:
        """Read the summary; `McapReader` parses the statistics."""
        assert self.bio
        bio, summary = self.bio, self.data_end
        size = bio.seek(0, 2) - summary
        if size > _MOST_SUMMARY:
            raise RecordingError(f"{self.path}: its summary has {size:,} bytes, more than any summary")
        bio.seek(summary)
        if (op := bio.read(1)[0]) not in _SUMMARY_OPS:
            raise RecordingError(f"{self.path}: its footer leads to a record of type {op} instead of its summary")
        bio.seek(summary)
        raw = bio.read(size)
        if len(raw) != size:
            raise RecordingError(f"{self.path}: its summary is cut off")
        rest, records = bytearray(), []
        schemas: dict[int, mcap.McapSchema] = {}
        channels: dict[int, mcap.McapChannel] = {}
        at = 0
        while (op := raw[at]) not in (mcap.FOOTER, mcap.SUMMARY_OFFSET):
            _, size = mcap.RECORD_HEAD.unpack_from(raw, at)
            start, end = at + mcap.RECORD_HEAD.size, at + mcap.RECORD_HEAD.size + size
            if op == mcap.CHUNK_INDEX:
                records.append((start, size))
            elif op == mcap.SCHEMA:
                schemas.setdefault(*mcap.parse_schema(raw[start:end]))
            elif op == mcap.CHANNEL:
                channels.setdefault(*mcap.parse_channel(raw[start:end]))
            else:
                rest += raw[at:end]
            at = end
        self.index = _chunks_from(raw, records)
        self._name(schemas, channels)
        self.bio, self.data_end = BytesIO(bytes(rest) + bytes([mcap.FOOTER])), 0
        try:
            super().read_index()
        finally:
            self.bio, self.data_end = bio, summary
        if self.statistics is None and len(self.index.starts):
            self.statistics = self._count()

    def _name(self, schemas: dict[int, mcap.McapSchema], channels: dict[int, mcap.McapChannel]) -> None:
        """Note the channels, with schemas in any language; rosbags knows the languages of ROS 2 only."""
        known = schemas or ({0: mcap.McapSchema()} if channels else {})
        self.schemas.update({number: Schema(number, *schema) for number, schema in known.items()})
        for number, channel in channels.items():
            missing = mcap.McapSchema("" if channel.schema == 0 else SCHEMALESS)
            schema = schemas.get(channel.schema, missing)
            self.named[number] = channel.with_schema(number, schema)
            nothing = MessageDefinition(MessageDefinitionFormat.NONE, "")
            extra = ConnectionExtRosbag2(channel.encoding, [])
            self.connections.append(Connection(number, channel.topic, schema.name, nothing, "", 0, extra, self))

    def meta_scan(self) -> None:
        """Read the whole file if that is allowed, and needed because the file has no index."""
        if self.is_near or len(self.index.starts):
            raise RecordingError(f"{self.path}: it has no complete index")
        super().meta_scan()

    def messages(
        self, connections: Collection[Connection], start: int | None = None, stop: int | None = None
    ) -> Generator[tuple[Connection, int, bytes], None, None]:
        """Yield messages in the order of `McapReader.messages`, but open each chunk only when its start time comes."""
        if not len(self.index.starts):
            yield from super().messages(connections, start, stop)
            return
        channels = {connection.id: connection for connection in connections}
        numbers = self.index.of(channels, start, stop).tolist()
        opened: list[tuple[int, int, Iterator[Msg], Msg]] = []
        while numbers or opened:
            while numbers and (not opened or self.index.starts[numbers[0]] <= opened[0][0]):
                _push(opened, self._messages_in(numbers.pop(0), channels, start, stop))
            if opened:
                time_ns, _, messages, message = heappop(opened)
                assert message.connection is not None
                assert message.data is not None
                yield message.connection, time_ns, message.data
                _push(opened, messages)

    def thinned(
        self, connections: Collection[Connection], most_bytes: int, most_chunks: int
    ) -> Iterator[list[tuple[Connection, int, bytes]]]:
        """Yield the messages in each of a few chunks; see `Chunks.spread`. A remote file gets one request for each."""
        channels = {connection.id: connection for connection in connections}
        for number in self.index.spread(channels, most_bytes, most_chunks).tolist():
            chunk = self.index.info(number)
            raw = self._read(chunk.chunk_start_offset, chunk.chunk_length)
            first, stop = chunk.message_start_time, chunk.message_end_time + 1
            messages = msgsrc(chunk._replace(chunk_start_offset=0), channels, first, stop, BytesIO(raw))
            next(messages)  # the start time of the chunk
            yield [
                (one.connection, one.timestamp, one.data) for one in messages if one.connection and one.data is not None
            ]

    def _read(self, start: int, size: int) -> bytes:
        """Return some bytes of the file. Of a remote file only these are fetched, instead of whole blocks."""
        assert self.bio is not None
        fetch: Callable[[int, int], bytes] | None = getattr(self.bio, "fetch", None)
        if fetch:
            return fetch(start, start + size)
        self.bio.seek(start)
        return self.bio.read(size)

    def _messages_in(
        self, number: int, channels: dict[int, Connection], start: int | None, stop: int | None
    ) -> Iterator[Msg]:
        assert self.bio is not None
        chunk = self.index.info(number)
        first = chunk.message_start_time if start is None else start
        last = chunk.message_end_time + 1 if stop is None else stop
        messages = msgsrc(chunk, channels, first, last, self.bio)
        next(messages)  # the start time of the chunk
        return messages

    def _count(self) -> Statistics:
        by_channel = self.index.counts()
        first, last = int(self.index.starts.min()), int(self.index.ends.max())
        return Statistics(
            sum(by_channel.values()),
            len(self.schemas),
            len(self.channels),
            0,
            0,
            len(self.index.starts),
            first,
            last,
            by_channel,
        )


_SUMMARY_OPS = frozenset((2, 3, 4, 8, 10, 11, 13, 14, 15))
"""The types of records that a summary, or the footer after an empty one, begins with."""


def _push(opened: list[tuple[int, int, Iterator[Msg], Msg]], messages: Iterator[Msg]) -> None:
    """Add the next message of a chunk, by its time and the offset of its chunk."""
    message = next(messages, None)
    if message is not None:
        heappush(opened, (message.timestamp, message.offset, messages, message))


def _chunks_from(raw: bytes, records: list[tuple[int, int]]) -> Chunks:
    """Return the chunks in a summary, from the offsets and the sizes of their records.

    Raises:
        ValueError: a record is damaged.
    """
    at, sizes = np.array(records, np.int64).reshape(-1, 2).T
    columns = np.empty((7, len(at)), np.int64)
    compressions = np.empty(len(at), object)
    chunk, channel, offset = [np.empty(0, np.int64)], [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    for rows, record in _alike(raw, at, sizes):
        columns[:, rows] = [record[name] for name in _COLUMNS]
        compressions[rows] = [name.decode() for name in record["compression"].tolist()]
        entries = record["map"]
        chunk.append(np.repeat(rows, entries.shape[1]))
        channel.append(entries["channel"].ravel().astype(np.int64))
        offset.append(entries["offset"].ravel())
    order = np.argsort(columns[2], kind="stable")
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    columns, compressions = columns[:, order], compressions[order]
    starts, ends, offsets, lengths, index_lengths = columns[:5]
    places = np.stack((rank[np.concatenate(chunk)], np.concatenate(channel), np.concatenate(offset)))
    if not ((np.diff(places[2]) > 0) & (np.diff(places[0]) >= 0)).all():
        places = places[:, np.lexsort((places[1], places[2], places[0]))]
    stops = (offsets + lengths + index_lengths)[places[0]]
    follows = places[0, 1:] == places[0, :-1]
    stops[:-1][follows] = places[2, 1:][follows]
    counts = (stops - places[2] - mcap.INDEX_HEAD.size) // mcap.INDEX_ENTRY.itemsize
    by_channel = np.argsort(places[1].astype(np.uint16), kind="stable")
    by_channel = by_channel[counts[by_channel] != 0]
    found, cuts = np.unique(places[1, by_channel], return_index=True)
    return Chunks(
        *(starts, ends, offsets, lengths, index_lengths, compressions.tolist(), columns[5], columns[6]),
        np.concatenate((places, counts[None])),
        np.lexsort((offsets, starts)),
        dict(zip(found.tolist(), np.split(by_channel, cuts[1:]), strict=False)),
    )


def _alike(
    raw: bytes, at: NDArray[np.int64], sizes: NDArray[np.int64]
) -> Iterator[tuple[NDArray[np.int64], NDArray[Any]]]:
    """Yield the records of chunks with the same layout: their numbers, and an array of them."""
    data = np.frombuffer(raw, np.uint8)
    lengths = _uint32_at(data, at + _MAP)
    names = _uint32_at(data, at + _MAP + 12 + lengths)
    if (lengths % _PLACES.itemsize).any() or (_MAP + 12 + lengths + 4 + names + 16 > sizes).any():
        raise ValueError("the record of a chunk in the summary is damaged")
    layouts, which = np.unique(np.stack((lengths, names), 1), axis=0, return_inverse=True)
    for number, (length, name) in enumerate(layouts.tolist()):
        rows = np.flatnonzero(which.ravel() == number)
        layout = np.dtype(
            [
                *(("start", "<i8"), ("end", "<i8"), ("offset", "<i8"), ("length", "<i8"), ("map_length", "<u4")),
                *(("map", _PLACES, (length // _PLACES.itemsize,)), ("index_length", "<i8"), ("name_length", "<u4")),
                *(("compression", f"S{name}"), ("compressed", "<i8"), ("size", "<i8")),
            ]
        )
        windows = np.lib.stride_tricks.sliding_window_view(data, layout.itemsize)
        yield rows, windows[at[rows]].view(layout)[:, 0]


def _uint32_at(data: NDArray[np.uint8], at: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the numbers at some offsets, or raise IndexError if one lies outside."""
    numbers: NDArray[np.int64] = data[at[:, None] + np.arange(4)].view("<u4")[:, 0].astype(np.int64)
    return numbers


def is_complete(reader: IndexedMcapReader) -> bool:
    """Return True if the index and the summary contain each channel with its schema, and each message."""
    index, total = reader.index, reader.metadata.message_count
    counts = index.counts()
    named = {connection.id: connection.msgcount for connection in reader.connections}
    return bool(
        (index.places[3] >= 0).all()
        and sum(counts.values()) == total
        and (total > 0 or not index.ends.any())
        and all(named.get(channel) == count for channel, count in counts.items())
        and all(connection.msgtype != SCHEMALESS for connection in reader.connections)
    )


SCHEMALESS = "__schemaless__"
"""The type that rosbags gives a channel whose schema it has not read."""


def has_messages(reader: IndexedMcapReader) -> bool:
    """Return True if the file has chunks or messages."""
    return bool(len(reader.index.starts) or reader.metadata.message_count)

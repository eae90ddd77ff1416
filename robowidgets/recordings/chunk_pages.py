"""The raw messages in chunks of MCAP files and of ROS 1 bags, a chunk at a time.

The index of the file says where they lie, and every word of it is checked against the chunk.
"""

from __future__ import annotations

from binascii import crc32
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from struct import Struct, error
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..repair._inflate import COMPRESSIONS, MAX_CHUNK, inflate
from ..repair.source import Channel, RecordingError
from .pages import Buffer, ChunkPage, Raws, Unpacked

_CHUNK_HEAD = Struct("<BQQQQII")
_RECORD_HEAD = Struct("<BQ")
_U64 = Struct("<Q")
_CHUNK, _INDEX, _MESSAGE = 6, 7, 5
INDEX_HEAD = Struct("<BQHI")
ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
"""Of a message in the index of a chunk of an MCAP file; before those of a channel stands the head."""
_HEAD = np.dtype([("op", "u1"), ("size", "<u8"), ("channel", "<u2"), ("n", "<u4"), ("time", "<u8"), ("sent", "<u8")])
_U32 = np.dtype("<u4")
_TIME = np.dtype([("seconds", "<u4"), ("nanoseconds", "<u4")])
_OF_MESSAGE = {b"op=\x02": None, b"conn=": 4, b"time=": 8}


@dataclass(frozen=True)
class McapPage(ChunkPage):
    """A chunk of an MCAP file. Called, it reads and decompresses; what it then gives finds the messages.

    Args:
        path: the file.
        start, size: where the record of the chunk lies, as the index has it, and the records of its own index after it.
        compression: how it is packed, as the index has it; empty when it is not.
        much: whether there is much to decompress in it and the others.
        channels: those that are wanted, by their ids in the file.

    Raises:
        RecordingError: when it is called, or what it gives is: the chunk is not as the index says.
    """

    path: Path
    start: int
    size: int
    compression: str
    much: bool
    channels: Mapping[int, Channel]

    @property
    def slow(self) -> bool:
        """See `pages.ChunkPage`: zstd and lz4 take long only where there is much."""
        return self.much

    def unpack(self) -> Unpacked:
        """See `pages.ChunkPage`: its data, and the records of its own index."""
        # A view, so that no part of it is copied.
        record = memoryview(read_part(self.path, self.start, self.size))
        try:
            op, outer, _, _, size, checksum, length = _CHUNK_HEAD.unpack_from(record)
            at = _CHUNK_HEAD.size
            compression = bytes(record[at : at + length]).decode("ascii", "replace")
            (packed,) = _U64.unpack_from(record, at + length)
        except error:
            raise self._damaged() from None
        at += length + _U64.size
        end = _RECORD_HEAD.size + outer
        if op != _CHUNK or end > len(record) or at + packed != end:
            raise self._damaged()
        raw = unpacked(compression, record[at:end], size)
        if raw is None or (checksum and crc32(raw) != checksum):
            raise self._damaged()
        return memoryview(raw), record[end:]

    def _messages(self, raw: Buffer, index: Buffer) -> list[Raws]:
        entries = self._entries(index)
        offsets = np.concatenate([np.empty(0, np.int64), *(entry["offset"].astype(np.int64) for _, entry in entries)])
        heads = gathered(raw, offsets, _HEAD)
        if heads is None:
            raise self._damaged()
        starts = offsets + _HEAD.itemsize
        ends = offsets + _RECORD_HEAD.size + heads["size"].astype(np.int64)
        times = np.concatenate([np.empty(0, np.uint64), *(entry["time"] for _, entry in entries)])
        ids = np.repeat([number for number, _ in entries], [len(entry) for _, entry in entries])
        whole = (heads["op"] == _MESSAGE) & (heads["channel"] == ids) & (heads["time"] == times)
        if not (whole & (starts <= ends) & (ends <= len(raw)) & (times < 2**63)).all():
            raise self._damaged()
        return in_order(raw, ids.astype(np.int64), times.astype(np.int64), starts, ends, self.channels)

    def _entries(self, index: Buffer) -> list[tuple[int, NDArray[Any]]]:
        """What the records of the chunk's own index say of the channels that are wanted."""
        try:
            return [
                (channel, np.frombuffer(index, ENTRY, count, start))
                for channel, start, count in index_records(index)
                if channel in self.channels
            ]
        except error:
            raise self._damaged() from None

    def _damaged(self) -> RecordingError:
        return _damaged(self.path, self.start)


@dataclass(frozen=True)
class BagPage(ChunkPage):
    """A chunk of a ROS 1 bag; as `McapPage`.

    Args:
        path: the file.
        start, size: where the data of the chunk lies.
        compression: how it is packed; empty when it is not.
        index: for each connection that is wanted, log times and offsets of its messages in the chunk.
        channels: by the numbers of connections.
    """

    path: Path
    start: int
    size: int
    compression: str
    index: Mapping[int, Sequence[tuple[int, int]]]
    channels: Mapping[int, Channel]

    def unpack(self) -> Unpacked:
        """See `pages.ChunkPage`: its data."""
        raw = unpacked(self.compression, read_part(self.path, self.start, self.size))
        if raw is None:
            raise _damaged(self.path, self.start)
        return (memoryview(raw),)

    def _messages(self, raw: Buffer) -> list[Raws]:
        ids = np.repeat(list(self.index), [len(entries) for entries in self.index.values()]).astype(np.int64)
        table = np.array([entry for entries in self.index.values() for entry in entries], np.int64).reshape(-1, 2)
        times, offsets = table[:, 0], table[:, 1]
        found = self._found(raw, ids, times, offsets)
        if found is None:
            raise _damaged(self.path, self.start)
        return in_order(raw, ids, times, *found, self.channels)

    def _found(self, raw: Buffer, *said: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
        """Starts and ends of the messages, if there are such as the index says."""
        ids, times, offsets = said
        sizes = gathered(raw, offsets, _U32)
        if sizes is None or (sizes != sizes[:1]).any():
            return None
        size = int(sizes[0]) if sizes.size else 0
        if size > len(raw):
            return None
        heads = gathered(raw, offsets + _U32.itemsize, np.dtype(("u1", (size,))))
        lengths = gathered(raw, offsets + _U32.itemsize + size, _U32)
        places = _places(heads[0].tobytes()) if heads is not None and len(heads) else {}
        if heads is None or lengths is None or (len(heads) and len(places) < len(_OF_MESSAGE)):
            return None
        for name, (at, value) in places.items():
            if (heads[:, at : at + len(name)] != np.frombuffer(name, np.uint8)).any():
                return None
            column = np.ascontiguousarray(heads[:, at + len(name) : at + len(name) + (value or 0)])
            if name == b"conn=" and (column.view(_U32)[:, 0] != ids).any():
                return None
            if name == b"time=":
                stamps = column.view(_TIME)[:, 0]
                if (stamps["seconds"].astype(np.int64) * 1_000_000_000 + stamps["nanoseconds"] != times).any():
                    return None
        starts = offsets + 2 * _U32.itemsize + size
        ends = starts + lengths
        return (starts, ends) if (ends <= len(raw)).all() else None


def index_records(index: Buffer) -> Iterator[tuple[int, int, int]]:
    """Of each record of the index of a chunk of an MCAP file: id of the channel, where its entries start, how many.

    Raises:
        struct.error: it is none.
    """
    at = 0
    while at < len(index):
        op, size, channel, length = INDEX_HEAD.unpack_from(index, at)
        start = at + INDEX_HEAD.size
        if op != _INDEX or length % ENTRY.itemsize or start + length > len(index):
            raise error(f"no record of an index at byte {at}")
        yield channel, start, length // ENTRY.itemsize
        at += _RECORD_HEAD.size + size


def _places(head: bytes) -> dict[bytes, tuple[int, int | None]]:
    """Where the fields of a message's header have their names, and how long their values are."""
    return {name: (head.find(name), value) for name, value in _OF_MESSAGE.items() if name in head}


def gathered(raw: Buffer, offsets: NDArray[np.int64], kind: np.dtype[Any]) -> NDArray[Any] | None:
    """What stands at some offsets, each of a kind; None where one reaches out of the bytes, or they overlap."""
    size = kind.itemsize
    if offsets.size * size > len(raw):
        return None
    if offsets.size and (int(offsets.min()) < 0 or int(offsets.max()) + size > len(raw)):
        return None
    if not size:
        return None
    rows = np.frombuffer(raw, np.uint8)[offsets[:, None] + np.arange(size)]
    column: NDArray[Any] = rows if kind.subdtype else rows.view(kind)[:, 0]
    return column


def in_order(
    raw: Buffer,
    ids: NDArray[np.int64],
    times: NDArray[np.int64],
    starts: NDArray[np.int64],
    ends: NDArray[np.int64],
    channels: Mapping[int, Channel],
) -> list[Raws]:
    """Messages in the order in which they lie, those that follow each other on one channel together."""
    order = np.argsort(starts, kind="stable")
    edges = np.flatnonzero(np.diff(ids[order])) + 1
    return [
        Raws(channels[int(ids[part[0]])], times[part], raw, starts[part], ends[part])
        for part in np.split(order, edges)
        if part.size
    ]


def read_part(path: Path, start: int, size: int) -> bytes:
    """Bytes of a file, all of them.

    Raises:
        RecordingError: they are not there, or more than a chunk may have.
    """
    try:
        if not 0 <= size <= MAX_CHUNK or start + size > path.stat().st_size:
            raise _damaged(path, start)
        # Opened anew each time, so that any thread may read, and nothing stays open.
        with path.open("rb", buffering=0) as file:
            file.seek(start)
            data = file.read(size)
    except OSError as failed:
        raise RecordingError(f"{path.name}: cannot be read: {failed.strerror or failed}") from None
    if len(data) != size:
        raise _damaged(path, start)
    return data


def unpacked(compression: str, data: Buffer, size: int | None = None) -> Buffer | None:
    """A chunk's data, decompressed into no more than it claims or a chunk may have; None if there is other."""
    if not compression:
        raw, whole = data, True
    elif compression not in COMPRESSIONS:
        return None
    else:
        raw, whole = inflate(compression, bytes(data), MAX_CHUNK if size is None else min(size, MAX_CHUNK))
    return raw if whole and (size is None or len(raw) == size) else None


def _damaged(path: Path, start: int) -> RecordingError:
    return RecordingError(f"{path.name}: the chunk at byte {start:,} is damaged, or not as the index says")

"""The raw messages in chunks of MCAP files and of ROS 1 bags, a chunk at a time."""

from __future__ import annotations

from binascii import crc32
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from struct import Struct, error

import numpy as np

from .pages import Raws
from .salvage.inflate import COMPRESSIONS, MAX_CHUNK, inflate
from .source import Channel, RecordingError

_MCAP_CHUNK = Struct("<BQQQQII")
_MCAP_RECORD = Struct("<BQ")
_MCAP_MESSAGE = Struct("<HIQQ")
_U32, _U64, _TIME = Struct("<I"), Struct("<Q"), Struct("<II")
_CHUNK, _MESSAGE = 6, 5
_BAG_MESSAGE = 2


@dataclass(frozen=True)
class McapPage:
    """A chunk of an MCAP file. Called, it gives the messages of some channels in it, in the order of the file.

    Args:
        path: the file.
        start, size: where the record of the chunk lies, as the index has it.
        channels: by their ids in the file.

    Raises:
        RecordingError: when it is called: the chunk is not as the index says.
    """

    path: Path
    start: int
    size: int
    channels: Mapping[int, Channel]

    def __call__(self) -> list[Raws]:
        """The messages."""
        record = read_part(self.path, self.start, self.size)
        try:
            op, _, _, _, size, checksum, length = _MCAP_CHUNK.unpack_from(record)
            at = _MCAP_CHUNK.size
            compression = record[at : at + length].decode("ascii", "replace")
            (packed,) = _U64.unpack_from(record, at + length)
        except error:
            raise _damaged(self.path, self.start) from None
        if op != _CHUNK:
            raise _damaged(self.path, self.start)
        at += length + _U64.size
        raw = unpacked(self.path, self.start, compression, record[at : at + packed], size)
        if checksum and crc32(raw) != checksum:
            raise _damaged(self.path, self.start)
        return self._messages(raw)

    def _messages(self, raw: bytes) -> list[Raws]:
        found: list[tuple[int, int, int, int]] = []
        at, end = 0, len(raw)
        try:
            while at < end:
                op, size = _MCAP_RECORD.unpack_from(raw, at)
                body = at + _MCAP_RECORD.size
                at = body + size
                if op == _MESSAGE:
                    channel, _, time_ns, _ = _MCAP_MESSAGE.unpack_from(raw, body)
                    if channel in self.channels:
                        found.append((channel, time_ns, body + _MCAP_MESSAGE.size, at))
        except error:
            raise _damaged(self.path, self.start) from None
        if at != end:
            raise _damaged(self.path, self.start)
        return runs(raw, found, self.channels)


@dataclass(frozen=True)
class BagPage:
    """A chunk of a ROS 1 bag; as `McapPage`.

    Args:
        path: the file.
        start, size: where the data of the chunk lies.
        compression: how it is packed; empty when it is not.
        channels: by the numbers of connections.
    """

    path: Path
    start: int
    size: int
    compression: str
    channels: Mapping[int, Channel]

    def __call__(self) -> list[Raws]:
        """The messages."""
        raw = unpacked(self.path, self.start, self.compression, read_part(self.path, self.start, self.size))
        found: list[tuple[int, int, int, int]] = []
        at, end = 0, len(raw)
        try:
            while at < end:
                (size,) = _U32.unpack_from(raw, at)
                head, body = at + _U32.size, at + _U32.size + size + _U32.size
                at = body + _U32.unpack_from(raw, head + size)[0]
                fields = _bag_fields(raw, head, head + size)
                if fields.get(b"op") == bytes([_BAG_MESSAGE]):
                    (number,) = _U32.unpack(fields[b"conn"])
                    if number in self.channels:
                        seconds, nanoseconds = _TIME.unpack(fields[b"time"])
                        found.append((number, seconds * 1_000_000_000 + nanoseconds, body, at))
        except (error, KeyError):
            raise _damaged(self.path, self.start) from None
        if at != end:
            raise _damaged(self.path, self.start)
        return runs(raw, found, self.channels)


def _bag_fields(raw: bytes, at: int, end: int) -> dict[bytes, bytes]:
    fields = {}
    while at < end:
        (size,) = _U32.unpack_from(raw, at)
        name, _, value = raw[at + 4 : min(at + 4 + size, end)].partition(b"=")
        fields[name] = value
        at += 4 + size
    return fields


def runs(raw: bytes, found: list[tuple[int, int, int, int]], channels: Mapping[int, Channel]) -> list[Raws]:
    """Messages (channel, log time, start, end) of a buffer, those that follow each other on one channel together."""
    if not found:
        return []
    try:
        table = np.array(found, np.int64)
    except OverflowError:
        raise RecordingError("a message bears a time that no clock has") from None
    edges = np.flatnonzero(np.diff(table[:, 0])) + 1
    return [
        Raws(channels[int(part[0, 0])], part[:, 1].copy(), raw, part[:, 2], part[:, 3])
        for part in np.split(table, edges)
    ]


def read_part(path: Path, start: int, size: int) -> bytes:
    """Bytes of a file, all of them.

    Raises:
        RecordingError: they are not there, or more than a chunk may have.
    """
    if not 0 <= size <= MAX_CHUNK or start + size > path.stat().st_size:
        raise _damaged(path, start)
    # Opened anew each time, so that any thread may read, and nothing stays open.
    with path.open("rb", buffering=0) as file:
        file.seek(start)
        data = file.read(size)
    if len(data) != size:
        raise _damaged(path, start)
    return data


def unpacked(path: Path, start: int, compression: str, data: bytes, size: int | None = None) -> bytes:
    """A chunk's data, decompressed into no more than it claims, and no more than a chunk may have.

    Raises:
        RecordingError: it is damaged, or is not as long as it claims.
    """
    if not compression:
        raw, whole = data, True
    elif compression not in COMPRESSIONS:
        raise RecordingError(f"{path.name}: a chunk is compressed by {compression!r}, which nobody here can read")
    else:
        raw, whole = inflate(compression, data, MAX_CHUNK if size is None else min(size, MAX_CHUNK))
    if not whole or (size is not None and len(raw) != size):
        raise _damaged(path, start)
    return raw


def _damaged(path: Path, start: int) -> RecordingError:
    return RecordingError(f"{path.name}: the chunk at byte {start:,} is damaged, or not as the index says")

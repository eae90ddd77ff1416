"""Files and folders of messages as rosbags reads them.

This module, `ros_arrivals`, `ros_ends` and `ros_types` are the only ones that know rosbags.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection, MessageDefinition, MessageDefinitionFormat
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1.reader import decompressors
from rosbags.rosbag2.reader import DirectoryReader
from rosbags.rosbag2.storage_mcap import DECOMPRESSORS, McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from ..repair._inflate import MAX_CHUNK, inflate
from ..repair.source import Arrivals, Channel, RecordingError
from .chunk_pages import BagPage, McapPage
from .pages import Page
from .ros_arrivals import bag_arrivals, folder_arrivals, mcap_arrivals, sqlite_arrivals
from .ros_ends import bag_last, folder_last, mcap_last, sqlite_last

ById = dict[int, Channel]
Pages = list[Page] | None

_NEVER = 2**63 - 1
_SLOW = 1 << 22
"""Bytes that take much longer to decompress, by zstd or lz4, than threads take to start."""


def _bounded(compression: str) -> Callable[..., bytes]:
    """What decompresses a chunk into no more bytes than it claims, or than a chunk may have."""

    def decompress(data: bytes, size: int = MAX_CHUNK) -> bytes:
        raw, whole = inflate(compression, data, min(size, MAX_CHUNK))
        if not whole:
            raise RecordingError(f"a chunk in {compression} is damaged, or larger than it claims")
        return raw

    return decompress


# As it comes, rosbags decompresses for as long as there is memory.
decompressors.update({name: _bounded(name) for name in ("bz2", "lz4")})
DECOMPRESSORS.update({name: _bounded(name) for name in ("zstd", "lz4")})


def open_bag(path: Path) -> RosSource:
    """A ``.bag`` of ROS 1. Raises whatever rosbags raises for a file that it cannot read."""
    reader = BagReader(path)
    return RosSource(reader, lambda reader: (reader.start_time, reader.end_time), bag_arrivals, bag_last, _bag_pages)


def open_mcap(path: Path) -> RosSource:
    """A ``.mcap`` with an index. Raises as `open_bag`, and RecordingError when there is no index."""
    source = RosSource(McapReader(path), _times, mcap_arrivals, mcap_last, _mcap_pages)
    if not source.indexed:
        source.close()
        raise RecordingError("without an index rosbags reads messages in one way only, from the start to the end")
    return source


def open_sqlite(path: Path) -> RosSource:
    """A ``.db3``. Raises as `open_bag`."""
    _check(path)
    return RosSource(Sqlite3Reader(path), _times, sqlite_arrivals, sqlite_last)


def open_folder(path: Path) -> RosSource:
    """A folder with a ``metadata.yaml``. Raises as `open_bag`."""
    _check(path)
    return RosSource(DirectoryReader(path), _times, folder_arrivals, folder_last, _folder_pages)


class RosSource:
    """A `Source` that rosbags reads."""

    def __init__(
        self,
        reader: Any,
        times: Callable[[Any], tuple[int, int]],
        arrivals: Callable[[Any], Arrivals],
        last: Callable[[Any, int], int | None],
        pages: Callable[[Any, ById], Pages] | None = None,
    ) -> None:
        reader.open()
        self._reader = reader
        self._arrivals = arrivals
        self._last = last
        self._pages = pages
        self._open = True
        self.problems: tuple[str, ...] = ()
        self._connections = {c.id: c for c in reader.connections}
        self.channels = tuple(_channel(c) for c in reader.connections)
        start, end = times(reader)
        empty = start == _NEVER or not any(c.count for c in self.channels)
        self.start_ns: int | None = None if empty else start
        self.end_ns: int | None = None if empty else end - 1

    @property
    def indexed(self) -> bool:
        """Whether an MCAP file has an index, or needs none."""
        return bool(self._reader.chunks) or self.start_ns is None

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[tuple[Channel, int, bytes]]:
        """See `Source`."""
        asked = {channel.id: channel for channel in channels}
        if asked:
            connections = [self._connections[i] for i in asked]
            for connection, time_ns, raw in self._reader.messages(connections, start_ns, stop_ns):
                yield asked[connection.id], time_ns, raw

    def pages(self, channels: Collection[Channel]) -> Pages:
        """See `pages.Paged`."""
        return self._pages(self._reader, {channel.id: channel for channel in channels}) if self._pages else None

    def arrivals(self) -> Arrivals:
        """See `Source`."""
        return self._arrivals(self._reader)

    def last_ns(self, channel: Channel) -> int | None:
        """See `Source`."""
        return self._last(self._reader, channel.id)

    def close(self) -> None:
        """See `Source`."""
        if self._open:
            self._open = False
            self._reader.close()


def _mcap_pages(reader: McapReader, channels: ById) -> Pages:
    wanted = [chunk for chunk in reader.chunks if any(chunk.channel_count.get(number) for number in channels)]
    wanted.sort(key=lambda chunk: chunk.chunk_start_offset)
    path = Path(str(reader.path))
    much = sum(chunk.uncompressed_size for chunk in wanted if chunk.compression) >= _SLOW
    return [
        McapPage(path, chunk.chunk_start_offset, size, chunk.compression, much, channels)
        for chunk in wanted
        for size in (chunk.chunk_length + chunk.message_index_length,)
    ]


def _bag_pages(reader: BagReader, channels: ById) -> Pages:
    names = {function: name for name, function in decompressors.items()}
    path = Path(str(reader.path))
    places: defaultdict[int, dict[int, list[tuple[int, int]]]] = defaultdict(dict)
    for number in channels:
        for entry in reader.indexes[number]:
            places[entry.chunk_pos].setdefault(number, []).append((entry.time, entry.offset))
    return [
        BagPage(path, chunk.datapos, chunk.datasize, names[chunk.decompressor].replace("none", ""), index, channels)
        for chunk, index in ((reader.chunks[at], index) for at, index in sorted(places.items()))
    ]


def _folder_pages(reader: DirectoryReader, channels: ById) -> Pages:
    mcaps = [storage for storage in reader.storages if isinstance(storage, McapReader) and storage.chunks]
    if len(mcaps) < len(reader.storages) or reader.metadata.compression_mode == "message":
        return None
    named = {(channel.topic, channel.type): channel for channel in channels.values()}
    pages: list[Page] = []
    for storage in mcaps:
        known = ((c.id, named.get((c.topic, c.msgtype))) for c in storage.connections)
        pages += _mcap_pages(storage, {number: channel for number, channel in known if channel}) or []
    return pages


def _check(path: Path) -> None:
    # rosbags makes a URI of the path to a database, in which these stand for something else: perhaps another file.
    if set("%?#") & set(str(path)):
        raise RecordingError(f"{path}: rosbags opens no database whose path holds %, ? or #")


def _times(reader: Any) -> tuple[int, int]:
    return reader.metadata.start_time, reader.metadata.end_time


def _channel(connection: Connection) -> Channel:
    return Channel(
        id=connection.id,
        topic=connection.topic,
        type=connection.msgtype,
        encoding=getattr(connection.ext, "serialization_format", "ros1"),
        definition=_text(connection.msgdef, connection.msgtype),
        count=connection.msgcount,
    )


def _text(definition: MessageDefinition, type_name: str) -> str:
    is_bare_idl = definition.format is MessageDefinitionFormat.IDL and not definition.data.startswith("=" * 80)
    return f"{'=' * 80}\nIDL: {type_name}\n{definition.data}" if is_bare_idl else definition.data

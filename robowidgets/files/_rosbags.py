"""Complete files and folders of messages, read by rosbags.

Only this folder reads files with rosbags.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import cached_property
from pathlib import Path
from typing import Any
from weakref import finalize

from rosbags.interfaces import Connection, MessageDefinition, MessageDefinitionFormat
from rosbags.rosbag2.metadata import dump_qos_v8
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from ..messages.channel import Channel, definition_text, full_type
from ..messages.compression import plain
from ..repair import Arrivals, Message, RecordingError, is_cut
from ..runtime.platform_fixes import bound_decompression
from ._bag import MAGIC, BagInParts, BagReader
from ._index import arrivals_in_bag, arrivals_in_chunks, arrivals_in_database, span_in_mcap
from ._mcap import File, IndexedMcapReader, IsNear, has_messages, is_complete

_NEVER = 2**63 - 1

bound_decompression()


def open_bag(path: Path) -> RosbagsSource:
    """Open a ``.bag`` of ROS 1. Raises whatever rosbags raises for a file that it cannot read."""
    return RosbagsSource(BagReader(path), arrivals_in_bag)


def open_in_parts(file: File, is_near: IsNear) -> RosbagsSource:
    """Open a remote ``.mcap``, or a ``.bag`` of ROS 1, to read it in parts. Raises as `open_mcap`."""
    with file.open("rb") as head:
        is_bag = head.read(len(MAGIC)) == MAGIC
    if is_bag:
        return RosbagsSource(BagInParts(file, is_near), arrivals_in_chunks, BagInParts.span_ns)
    return open_mcap(file, is_near)


def open_mcap(path: Path | File, is_near: IsNear | None = None) -> RosbagsSource:
    """Open a ``.mcap`` with an index. Raises as `open_bag`, and RecordingError if index or summary is not complete.

    Args:
        path: the file.
        is_near: for a remote file; see `IndexedMcapReader`.
    """
    reader = IndexedMcapReader(path, is_near)
    source = RosbagsSource(reader, arrivals_in_chunks, span_in_mcap)
    if has_messages(reader) and not is_complete(reader):
        source.close()
        raise RecordingError(f"{path}: rosbags leaves out what the summary of the file does not repeat")
    return source


def open_sqlite(path: Path) -> RosbagsSource:
    """Open a ``.db3``. Raises as `open_bag`, and RecordingError if rosbags would silently leave something out."""
    # rosbags makes a URI of the path, in which these characters have another meaning: it might open another file.
    if set("%?#") & set(str(path)):
        raise RecordingError(f"{path}: rosbags opens no database whose path contains %, ? or #")
    if is_cut(path):
        raise RecordingError(f"{path}: SQLite reads zeros at the end of a database that was cut off")
    reader = Sqlite3Reader(path)
    source = RosbagsSource(reader, arrivals_in_database)
    if reader.metadata.message_count > sum(channel.count for channel in source.channels):
        source.close()
        raise RecordingError(f"{path}: rosbags leaves out messages of topics that the database does not name")
    return source


class RosbagsSource:
    """A `Source` that rosbags reads.

    Args:
        reader: not yet open.
        arrivals_in: returns the order of arrival of the messages in the open reader, of all or of some, by its index.
        span_in: returns `Source.span_ns` in the open reader for the id of a channel, or None to use the arrivals, which
            then contain all messages.
    """

    problems: tuple[str, ...] = ()

    def __init__(
        self,
        reader: Any,
        arrivals_in: Callable[[Any], Arrivals],
        span_in: Callable[[Any, int], tuple[int, int] | None] | None = None,
    ) -> None:
        reader.open()
        self._close = finalize(
            self, reader.close
        )  # also if the source is never closed: Python would warn about the open file
        self._reader = reader
        self._arrivals_in, self._span_in = arrivals_in, span_in
        self._connections = {c.id: c for c in reader.connections}
        named: dict[int, Channel] = getattr(reader, "named", {})
        self.channels = tuple(
            named[c.id]._replace(count=c.msgcount) if c.id in named else _channel(c) for c in reader.connections
        )
        about = reader if isinstance(reader, BagReader) else reader.metadata
        empty = about.start_time == _NEVER or not any(c.count for c in self.channels)
        self.start_ns: int | None = None if empty else about.start_time
        self.end_ns: int | None = None if empty else about.end_time - 1

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[Message]:
        """See `Source`."""
        asked = {channel.id: channel for channel in channels}
        if asked:
            connections = [self._connections[i] for i in asked]
            for connection, time_ns, raw in self._reader.messages(connections, start_ns, stop_ns):
                yield asked[connection.id], time_ns, plain(raw)

    @cached_property
    def arrivals(self) -> Arrivals:
        """The order of arrival, of all messages or of some messages of each part."""
        return self._arrivals_in(self._reader)

    def span_ns(self, channel: Channel) -> tuple[int, int] | None:
        """See `Source`."""
        return self._span_in(self._reader, channel.id) if self._span_in else self.arrivals.span_ns(channel.id)

    def size_of(self, channels: Collection[Channel]) -> int:
        """See `Source`."""
        reader = self._reader
        if not isinstance(reader, (IndexedMcapReader, BagInParts)):
            return 0
        return int(reader.index.compressed[reader.index.of([channel.id for channel in channels], None, None)].sum())

    def thinned(self, channels: Collection[Channel], most_bytes: int, most_parts: int) -> Iterator[list[Message]]:
        """See `Source`."""
        if isinstance(self._reader, (IndexedMcapReader, BagInParts)):
            asked = {channel.id: channel for channel in channels}
            connections = [self._connections[i] for i in asked]
            for part in self._reader.thinned(connections, most_bytes, most_parts):
                yield [(asked[connection.id], time_ns, plain(raw)) for connection, time_ns, raw in part]

    def close(self) -> None:
        """See `Source`."""
        self._close()


def _channel(connection: Connection) -> Channel:
    return Channel(
        id=connection.id,
        topic=connection.topic,
        type=full_type(connection.msgtype),
        encoding=getattr(connection.ext, "serialization_format", "ros1"),
        definition=_text(connection.msgdef, connection.msgtype),
        count=connection.msgcount,
        callers=(caller,) if (caller := getattr(connection.ext, "callerid", None)) else (),
        metadata=_metadata(connection.ext),
    )


def _metadata(ext: Any) -> tuple[tuple[str, str], ...]:
    """Return `Channel.metadata` from what rosbags has of a connection."""
    if profiles := getattr(ext, "offered_qos_profiles", None):
        return (("offered_qos_profiles", dump_qos_v8(profiles)),)
    return (("latching", "1"),) if getattr(ext, "latching", None) == 1 else ()


def _text(definition: MessageDefinition, type_name: str) -> str:
    language = "ros2idl" if definition.format is MessageDefinitionFormat.IDL else "ros2msg"
    return definition_text(language, type_name, definition.data)

"""Writing of a source as an MCAP file that every tool reads: indexed, in chunks, on a clock that never goes back."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import BinaryIO, NamedTuple

from mcap.records import Attachment
from mcap.writer import CompressionType, Writer

from ..messages.channel import Channel, schema_of
from ..messages.decoding import definition_of
from ..notebook.in_browser import IN_BROWSER
from ..notebook.progress import Progress
from ..runtime.output_file import whole_file
from .source import Message, RecordingError, Source

_PROFILES = {"cdr": "ros2", "ros1": "ros1"}


class Written(NamedTuple):
    """A written file: its messages, seconds from the first to the last, bytes, and lines on missing parts."""

    messages: int
    seconds: float
    size: int
    problems: tuple[str, ...]


def write(source: Source, path: Path) -> Written:
    """Write all messages of a source into an MCAP file, in chunks that are compressed with zstd (not in a browser).

    The file is complete when it appears, and replaces an existing file. A definition that the source lacks is written
    if the type is known. If the source fails midway, the messages before are written.

    Raises:
        RecordingError: the file cannot be written, or no message can be read. The text gives the reason.
    """
    total = sum(channel.count for channel in source.channels)
    return write_messages(source, path, source.messages(source.channels), total)


def write_messages(
    source: Source,
    path: Path,
    messages: Iterable[Message],
    total: int | None,
    metadata: Iterable[tuple[str, Mapping[str, str]]] = (),
    attachments: Iterable[Attachment] = (),
) -> Written:
    """Write some messages of a source into an MCAP file with all its channels; see `write`.

    Args:
        source: the source.
        path: the file.
        messages: the messages, in the order of time.
        total: the number of messages for the progress bar, or None if it is unknown.
        metadata: names and contents of further records.
        attachments: files to attach.
    """
    if (source.start_ns or 0) < 0:
        raise RecordingError(
            f"{path}: cannot be written: the clock begins before 1970, and MCAP cannot store such times"
        )
    try:
        with whole_file(path) as file:
            writer = McapWriter(file, {channel.encoding for channel in source.channels})
            for channel in source.channels:
                writer.register(channel)
            for name, content in metadata:
                writer.add_metadata(name, content)
            for attachment in attachments:
                writer.attach(attachment)
            count, seconds = _write_messages(writer, messages, total, path.name)
            writer.finish()
            size = file.tell()
    except OSError as error:
        raise RecordingError(f"{path}: cannot be written: {error.strerror or error}") from None
    return Written(count, seconds, size, tuple(writer.problems))


class McapWriter:
    """A writer of MCAP: in chunks that are compressed with zstd (not in a browser), with each schema once.

    Args:
        file: a file that is open for writing; the caller closes it.
        encodings: the encodings of all messages that will be written.
    """

    def __init__(self, file: BinaryIO, encodings: Collection[str]) -> None:
        self._writer = Writer(file, compression=CompressionType.NONE if IN_BROWSER else CompressionType.ZSTD)
        profile = _PROFILES.get(next(iter(encodings)), "") if len(encodings) == 1 else ""
        self._writer.start(profile, "robowidgets")
        self._schemas: dict[tuple[str, str, bytes], int] = {}
        self._ids: dict[int, int] = {}
        self.problems: list[str] = []
        """Lines on parts that the file lacks."""

    def register(self, channel: Channel) -> None:
        """Add a channel before its messages, with its definition if the type is known."""
        key = name, encoding, data = schema_of(channel, definition_of(channel))
        if not data and channel.encoding not in _PROFILES:
            self.problems.append(
                f"{channel.topic}: its messages, encoded as {channel.encoding!r}, have no definition now"
            )
        if name and key not in self._schemas:
            self._schemas[key] = self._writer.register_schema(name, encoding, data)
        schema = self._schemas.get(key, 0)
        metadata = dict(channel.metadata)
        self._ids[channel.id] = self._writer.register_channel(channel.topic, channel.encoding, schema, metadata)

    def add(self, channel: Channel, time_ns: int, data: bytes) -> None:
        """Write a message of a channel."""
        self._writer.add_message(self._ids[channel.id], time_ns, data, time_ns)

    def add_metadata(self, name: str, content: Mapping[str, str]) -> None:
        """Write names and values under a name."""
        self._writer.add_metadata(name, dict(content))

    def attach(self, one: Attachment) -> None:
        """Attach a file."""
        self._writer.add_attachment(one.create_time, one.log_time, one.name, one.media_type, one.data)

    def flush(self) -> None:
        """Write the current chunk, so that an unfinished file contains it."""
        self._writer.flush()

    def finish(self) -> None:
        """Write the index."""
        self._writer.finish()


def _write_messages(writer: McapWriter, messages: Iterable[Message], total: int | None, name: str) -> tuple[int, float]:
    """Write the messages; return their number, and the seconds from the first to the last."""
    count = first_ns = last_ns = 0
    try:
        with Progress(total, f"Writing {name}") as bar:
            for channel, time_ns, data in messages:
                writer.add(channel, time_ns, data)
                first_ns, last_ns = first_ns if count else time_ns, time_ns
                count += 1
                bar.update(1)
    except RecordingError as error:
        if not count:
            raise
        writer.problems.append(f"the file can be read no further: {error}")
    return count, (last_ns - first_ns) / 1e9

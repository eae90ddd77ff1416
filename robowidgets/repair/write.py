"""Writing of a source as an MCAP file that every tool reads: indexed, in chunks, on a clock that never goes back."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import BinaryIO, NamedTuple

from mcap.writer import CompressionType, Writer

from ..messages.channel import Channel, is_idl
from ..messages.decoding import definition_of
from ..notebook.in_browser import IN_BROWSER
from ..notebook.progress import Progress
from ..runtime.output_file import whole_file
from .source import RecordingError, Source

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
    if (source.start_ns or 0) < 0:
        raise RecordingError(
            f"{path}: cannot be written: the clock begins before 1970, and MCAP cannot store such times"
        )
    try:
        with whole_file(path) as file:
            count, problems = _write_messages(source, file, path.name)
            size = file.tell()
    except OSError as error:
        raise RecordingError(f"{path}: cannot be written: {error.strerror or error}") from None
    return Written(count, ((source.end_ns or 0) - (source.start_ns or 0)) / 1e9, size, tuple(problems))


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
        self._schemas: dict[tuple[str, str, str], int] = {}
        self._ids: dict[int, int] = {}
        self.problems: list[str] = []
        """Lines on missing definitions."""

    def register(self, channel: Channel) -> None:
        """Add a channel before its messages, with its definition if the type is known."""
        name, encoding, text = channel.type, "", definition_of(channel)
        if channel.encoding == "ros1":
            name, encoding = name.replace("/msg/", "/"), "ros1msg"
        elif channel.encoding == "cdr" and text:
            encoding = "ros2idl" if is_idl(text) else "ros2msg"
        else:
            text = ""
        if channel.encoding not in _PROFILES:
            self.problems.append(
                f"{channel.topic}: its messages, encoded as {channel.encoding!r}, have no definition now"
            )
        key = name, encoding, text
        if name and key not in self._schemas:
            self._schemas[key] = self._writer.register_schema(name, encoding, text.encode())
        schema = self._schemas.get(key, 0)
        self._ids[channel.id] = self._writer.register_channel(channel.topic, channel.encoding, schema)

    def add(self, channel: Channel, time_ns: int, data: bytes) -> None:
        """Write a message of a channel."""
        self._writer.add_message(self._ids[channel.id], time_ns, data, time_ns)

    def flush(self) -> None:
        """Write the current chunk, so that an unfinished file contains it."""
        self._writer.flush()

    def finish(self) -> None:
        """Write the index."""
        self._writer.finish()


def _write_messages(source: Source, file: BinaryIO, name: str) -> tuple[int, list[str]]:
    """Write all messages; return their number, and lines on missing parts."""
    writer = McapWriter(file, {channel.encoding for channel in source.channels})
    for channel in source.channels:
        writer.register(channel)
    count, problems = 0, list(writer.problems)
    try:
        with Progress(sum(channel.count for channel in source.channels), f"Writing {name}") as bar:
            for channel, time_ns, data in source.messages(source.channels):
                writer.add(channel, time_ns, data)
                count += 1
                bar.update(1)
    except RecordingError as error:
        if not count:
            raise
        problems.append(f"the file can be read no further: {error}")
    writer.finish()
    return count, problems

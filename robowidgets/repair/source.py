"""The interface between the readers of files and a recording: messages from a file in any format."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Protocol

from ..messages.channel import Channel

Message = tuple[Channel, int, bytes]
"""Channel, log time in nanoseconds, and bytes."""


class RecordingError(Exception):
    """A recording cannot be opened or read. The text is one line for users: the file and the reason."""


class RemoteError(RecordingError):
    """A remote file cannot be read at the moment: its connection or its credentials fail, or it has changed.

    Nothing is wrong with its contents, so it is neither repaired nor read in part.
    """


class Source(Protocol):
    """The messages of one file or folder, as bytes, on a clock that never goes back and never leaps.

    Opening a source raises `RecordingError` if nothing can be read.
    """

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All channels that the file names, including channels without messages."""

    @property
    def problems(self) -> tuple[str, ...]:
        """The repairs, and the parts that could not be read so far, one line for each."""

    @property
    def start_ns(self) -> int | None:
        """Log time of the first message in nanoseconds since the epoch, or None without messages."""

    @property
    def end_ns(self) -> int | None:
        """Log time of the last message (inclusive) in nanoseconds since the epoch, or None without messages."""

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[Message]:
        """Yield the messages of these channels by log time, or in the order of arrival if the time is the same.

        Only messages logged at ``start_ns`` or later and before ``stop_ns`` are included; None means no limit. Several
        iterators may be in use at once.
        """

    def span_ns(self, channel: Channel) -> tuple[int, int] | None:
        """Return log times of the first and the last message of a channel, or a little before and after them.

        Return None if the index does not contain them.
        """

    def size_of(self, channels: Collection[Channel]) -> int:
        """Return the number of bytes to read for all messages of some channels, or 0 if it is unknown."""

    def thinned(self, channels: Collection[Channel], most_bytes: int, most_parts: int) -> Iterator[list[Message]]:
        """Yield the messages of some channels in a few parts of the file, evenly spread over its time.

        Nothing is yielded without an index of parts, or if each part takes more than ``most_bytes``.

        Args:
            channels: the channels.
            most_bytes: the maximum number of bytes to read in all.
            most_parts: the maximum number of parts. A part of a remote file takes one request.
        """

    def close(self) -> None:
        """Close the file; further calls do nothing."""

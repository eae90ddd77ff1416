"""The interface between the readers of files and a recording: a file of messages in any format."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Protocol

from ..messages.channel import Channel

Message = tuple[Channel, int, bytes]
"""Channel, log time in nanoseconds, and bytes."""


class RecordingError(Exception):
    """A recording that cannot be opened or read. The text is one line for a person: the file and the reason."""


class Source(Protocol):
    """The messages of one file or folder, as bytes, on a clock that never goes back and never leaps.

    Opening a source raises `RecordingError` if nothing can be read.
    """

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All channels that the file names, including those without a message."""

    @property
    def problems(self) -> tuple[str, ...]:
        """The repairs, and the parts that could not be read so far, one line each, for a person."""

    @property
    def start_ns(self) -> int | None:
        """Log time of the first message in nanoseconds since the epoch; None when there is no message."""

    @property
    def end_ns(self) -> int | None:
        """Log time of the last message (not one after it); None when there is no message."""

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[Message]:
        """The messages of these channels, by log time; those of the same time in the order of arrival.

        Messages logged at ``start_ns`` or later and before ``stop_ns``; None means no limit. Without channels there is
        no message. Several iterators may be in use at once.
        """

    def span_ns(self, channel: Channel) -> tuple[int, int] | None:
        """Log times of the first and the last message of a channel, or a little before and after them.

        None if the index does not contain them.
        """

    def close(self) -> None:
        """Close the file; doing it again does nothing."""

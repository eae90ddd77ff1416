"""The chunks of a topic from the raw messages of a file."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Generic, Protocol

from ..repair.source import Channel, RecordingError, Source
from .chunks import Chunk, merged
from .columns import Note
from .pages import Held, Page, Raws, by_time, pages_of


class Reader(Protocol[Chunk]):
    """Makes columns of the messages of one channel."""

    def read(self, raws: Raws, note: Note) -> list[Chunk]:
        """The chunks of some messages, in their order; those that cannot be shown are noted and left out."""


class RawFeed(Generic[Chunk]):
    """See `store.Feed`.

    Args:
        source: where the messages are.
        channels: those of one topic.
        columns: by the id of a channel, what makes columns of its messages.
        note: is told of a message that cannot be shown: channel, log time, error.
        stop: is told of an error after which nothing more can be read.
    """

    def __init__(
        self,
        source: Source,
        channels: Sequence[Channel],
        columns: Mapping[int, Reader[Chunk]],
        note: Callable[[Channel, int, Exception], None],
        stop: Callable[[RecordingError], None],
    ) -> None:
        self._source = source
        self._channels = channels
        self._columns: Mapping[int, Reader[Chunk]] = columns
        self._note = note
        self._stop = stop
        self._by_time = False
        self.name = channels[0].topic if channels else ""
        self.total = sum(channel.count for channel in channels)

    def pages(self) -> Iterator[Page]:
        """See `store.Feed`."""
        return (by_time if self._by_time else pages_of)(self._source, self._channels)

    def decode(self, page: Held) -> list[Chunk]:
        """See `store.Feed`."""
        return merged(
            [
                chunk
                for raws in page()
                for chunk in self._columns[raws.channel.id].read(
                    raws, lambda raws, i, error: self._note(raws.channel, int(raws.times[i]), error)
                )
            ]
        )

    def distrust(self, error: Exception) -> bool:
        """See `store.Feed`: the source may know a way past damage when it is asked for one message after the other."""
        if self._by_time:
            if not isinstance(error, RecordingError):
                raise error
            self._stop(error)
            return False
        self._by_time = True
        return True

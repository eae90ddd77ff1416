"""A file that looks complete but is damaged: a repaired source continues at the place where reading fails."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator

from ..messages.channel import Channel
from ..repair import Message, RecordingError, RemoteError, Source


class FallbackSource:
    """A `Source` that continues with a repaired source if the first one fails.

    Args:
        first: a source that may raise anything while it reads.
        open_repaired: opens a source for the same file when needed; raises RecordingError if it cannot.
    """

    def __init__(self, first: Source, open_repaired: Callable[[], Source]) -> None:
        self._first = first
        self._open_repaired = open_repaired
        self._repaired: Source | None = None
        self._closed = False
        self.channels = first.channels
        self.start_ns, self.end_ns = first.start_ns, first.end_ns

    @property
    def problems(self) -> tuple[str, ...]:
        """See `Source`."""
        return (self._repaired or self._first).problems

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[Message]:
        """See `Source`."""
        latest, given = start_ns, 0
        if self._repaired is None:
            try:
                for message in self._first.messages(channels, start_ns, stop_ns):
                    if message[1] != latest:
                        latest, given = message[1], 0
                    given += 1
                    yield message
                return
            except RemoteError:
                raise
            except Exception:  # rosbags raises anything; repair reports the damage
                if self._closed:
                    raise RecordingError("the recording is closed: open it again") from None
                # Another iterator may have found the damage meanwhile.
                self._repaired = self._repaired or self._open_repaired()
        yield from self._resume(self._repaired, channels, latest, stop_ns, given)

    def span_ns(self, channel: Channel) -> tuple[int, int] | None:
        """See `Source`."""
        try:
            return self._first.span_ns(channel)
        except RemoteError:
            raise
        except Exception:  # reading the messages will meet the same damage
            return None

    def size_of(self, channels: Collection[Channel]) -> int:
        """See `Source`."""
        return self._first.size_of(channels)

    def thinned(self, channels: Collection[Channel], most_bytes: int, most_parts: int) -> Iterator[list[Message]]:
        """See `Source`. A damaged part raises RecordingError: to repair the file, all of it would have to be read."""
        try:
            yield from self._first.thinned(channels, most_bytes, most_parts)
        except RecordingError:
            raise
        except Exception as error:  # rosbags raises anything
            raise RecordingError(f"a part of the file cannot be read: {error}") from None

    def close(self) -> None:
        """See `Source`."""
        self._closed = True
        self._first.close()
        if self._repaired:
            self._repaired.close()

    def _resume(
        self, source: Source, channels: Collection[Channel], latest: int | None, stop_ns: int | None, given: int
    ) -> Iterator[Message]:
        """Yield the messages after the last one; ``given`` messages with its time were yielded already."""
        ours = {(c.topic, c.type): c for c in channels}
        theirs = {c.id: ours[c.topic, c.type] for c in source.channels if (c.topic, c.type) in ours}
        wanted = [c for c in source.channels if c.id in theirs]
        for channel, time_ns, raw in source.messages(wanted, latest, stop_ns):
            if given and time_ns == latest:
                given -= 1
            else:
                yield theirs[channel.id], time_ns, raw

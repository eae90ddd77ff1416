"""Two readers of one file: a quick one, and a patient one that takes over where it fails."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator

from ..repair.source import Arrivals, Channel, Source
from .pages import Page, Paged


class Relay:
    """A quick source, and a patient one that goes on where the quick one meets damage.

    Args:
        quick: a source that may raise anything while it reads.
        patient: opens a source for the same file, when it is needed; RecordingError when it cannot.
    """

    def __init__(self, quick: Source, patient: Callable[[], Source]) -> None:
        self._quick = quick
        self._open_patient = patient
        self._patient: Source | None = None
        self.channels = quick.channels
        self.start_ns, self.end_ns = quick.start_ns, quick.end_ns

    @property
    def problems(self) -> tuple[str, ...]:
        """See `Source`."""
        return (*self._quick.problems, *(self._patient.problems if self._patient else ()))

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[tuple[Channel, int, bytes]]:
        """See `Source`."""
        latest, given = start_ns, 0
        if self._patient is None:
            try:
                for message in self._quick.messages(channels, start_ns, stop_ns):
                    if message[1] != latest:
                        latest, given = message[1], 0
                    given += 1
                    yield message
                return
            except Exception:  # whatever rosbags stumbles over, the reader made for damage has the word
                self._patient = self._open_patient()
        yield from self._resume(self._patient, channels, latest, stop_ns, given)

    def pages(self, channels: Collection[Channel]) -> Iterable[Page] | None:
        """See `pages.Paged`: those of the quick source, as long as nothing went wrong."""
        quick = self._quick
        return quick.pages(channels) if self._patient is None and isinstance(quick, Paged) else None

    def arrivals(self) -> Arrivals:
        """See `Source`: those of the quick source."""
        return self._quick.arrivals()

    def last_ns(self, channel: Channel) -> int | None:
        """See `Source`."""
        try:
            return self._quick.last_ns(channel)
        except Exception:  # what rosbags stumbles over is met again, and told, when the messages are read
            return None

    def close(self) -> None:
        """See `Source`."""
        self._quick.close()
        if self._patient:
            self._patient.close()

    def _resume(
        self, source: Source, channels: Collection[Channel], latest: int | None, stop_ns: int | None, given: int
    ) -> Iterator[tuple[Channel, int, bytes]]:
        """What follows the last message, of which ``given`` of the same time have gone out already."""
        ours = {(c.topic, c.type): c for c in channels}
        theirs = {c.id: ours[c.topic, c.type] for c in source.channels if (c.topic, c.type) in ours}
        wanted = [c for c in source.channels if c.id in theirs]
        for channel, time_ns, raw in source.messages(wanted, latest, stop_ns):
            if given and time_ns == latest:
                given -= 1
            else:
                yield theirs[channel.id], time_ns, raw

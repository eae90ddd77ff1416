"""Several sources as one: the files that a recorder split a recording into."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from heapq import merge
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..repair.source import Arrivals, Channel, RecordingError, SavedSource, Source, joined, latest
from .pages import Held, Page, pages_of


class Chain:
    """A `Source` over other sources.

    Channels of the same topic, type, encoding and definition become one. Problems carry the name of their source.

    Args:
        sources: a name, which may be empty, and a source, any number of times; closed with the chain.
        problems: lines that come before those of the sources.
        on_close: called when the chain is closed for the first time.
    """

    def __init__(
        self,
        sources: Sequence[tuple[str, Source]],
        problems: Sequence[str] = (),
        on_close: Callable[[], object] | None = None,
    ) -> None:
        self._named = tuple(sources)
        self._sources = [source for _, source in sources]
        self._problems = tuple(problems)
        self._on_close = on_close
        counts: dict[Channel, int] = {}
        for channel in (channel for source in self._sources for channel in source.channels):
            counts[_same(channel)] = counts.get(_same(channel), 0) + channel.count
        self._ids = {same: number for number, same in enumerate(counts)}
        self.channels = tuple(same._replace(id=number, count=counts[same]) for same, number in self._ids.items())

    @property
    def start_ns(self) -> int | None:
        """See `Source`."""
        return min((s.start_ns for s in self._sources if s.start_ns is not None), default=None)

    @property
    def end_ns(self) -> int | None:
        """See `Source`."""
        return max((s.end_ns for s in self._sources if s.end_ns is not None), default=None)

    @property
    def problems(self) -> tuple[str, ...]:
        """What could not be read so far: a source may meet damage as late as when it is read."""
        told = (f"{name}: {line}" if name else line for name, source in self._named for line in source.problems)
        return (*self._problems, *told)

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[tuple[Channel, int, bytes]]:
        """Channel, log time and bytes of the messages of these channels, by log time."""
        wanted = {channel.id: channel for channel in channels}
        each = (self._of(source, wanted, start_ns, stop_ns) for source in self._sources)
        return merge(*each, key=lambda message: message[1])

    def pages(self, channels: Collection[Channel]) -> Iterator[Page]:
        """See `pages.Paged`: those of one source after the other."""
        wanted = {channel.id: channel for channel in channels}
        for source in self._sources:
            mine = self._known(source, wanted)
            for page in pages_of(source, [channel for channel in source.channels if channel.id in mine]):
                yield partial(_renamed, page, mine)

    def arrivals(self) -> Arrivals:
        """See `Source`: those of one source after the other."""
        return joined(
            source.arrivals().renumbered({channel.id: self._ids[_same(channel)] for channel in source.channels})
            for source in self._sources
        )

    def last_ns(self, channel: Channel) -> int | None:
        """See `Source`."""
        mine = ((source, c) for source in self._sources for c in source.channels if _same(c) == _same(channel))
        return latest(source.last_ns(c) for source, c in mine if c.count)

    def retime(self, times: NDArray[np.int64], why: str) -> None:
        """See `SavedSource`. All of its sources are such."""
        ends = np.cumsum([len(source.arrivals().times) for source in self._sources])
        for source, part in zip(self._sources, np.split(times, ends[:-1]), strict=True):
            assert isinstance(source, SavedSource)
            source.retime(part, "")
        self._problems += (why,)

    def close(self) -> None:
        """Close every source; doing it again does nothing."""
        for source in self._sources:
            source.close()
        if self._on_close:
            self._on_close()
            self._on_close = None

    def _of(
        self, source: Source, wanted: dict[int, Channel], start_ns: int | None, stop_ns: int | None
    ) -> Iterator[tuple[Channel, int, bytes]]:
        mine = self._known(source, wanted)
        asked = [channel for channel in source.channels if channel.id in mine]
        for channel, time_ns, data in source.messages(asked, start_ns, stop_ns):
            yield mine[channel.id], time_ns, data

    def _known(self, source: Source, wanted: dict[int, Channel]) -> dict[int, Channel]:
        """By the ids of a source, the channels that are wanted of it."""
        ours = {channel.id: self._ids[_same(channel)] for channel in source.channels}
        return {theirs: wanted[number] for theirs, number in ours.items() if number in wanted}


def open_chain(paths: Sequence[Path], open_one: Callable[[Path], Source]) -> Chain:
    """The files at some paths as one source; those that cannot be opened are told in its problems.

    Args:
        paths: the files, at least one, in their order.
        open_one: what opens a single file; raises RecordingError when it cannot.

    Raises:
        RecordingError: none of the files can be opened; the text is that of the first.
    """
    opened = [(path.name, _attempt(path, open_one)) for path in paths]
    errors = [result for _, result in opened if isinstance(result, str)]
    sources = [(name, result) for name, result in opened if not isinstance(result, str)]
    if not sources:
        raise RecordingError(errors[0])
    return Chain(sources, errors)


def _attempt(path: Path, open_one: Callable[[Path], Source]) -> Source | str:
    try:
        return open_one(path)
    except RecordingError as error:
        return str(error)


def _renamed(page: Page, channels: dict[int, Channel]) -> Held:
    held = page()
    return lambda: [raws._replace(channel=channels[raws.channel.id]) for raws in held()]


def _same(channel: Channel) -> Channel:
    return channel._replace(id=0, count=0)

"""A source over the files of a recording: an index of their messages in memory, sorted by a repaired clock."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import ExitStack
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from ..messages.channel import Channel, merged
from ..messages.compression import plain
from ._clock import Arrivals, joined, repaired
from ._found_messages import Walk
from ._report import damage_lines, nothing_readable
from .source import Message


class IndexedSource:
    """A `Source` over one file, or over the files of one recording in their order.

    Channels are merged. With several files, problems begin with the name of the file.

    Args:
        walks: the walk through each file; closed with the source.
        problems: lines to put before all others.

    Attributes:
        unread: these lines, and one for each damaged file without a readable message.

    Raises:
        RecordingError: files are damaged, and no message can be read.
    """

    def __init__(self, walks: Sequence[Walk], problems: Sequence[str] = ()) -> None:
        self._walks = walks
        self.unread = tuple(problems)
        files = ExitStack()
        for walk in walks:
            files.callback(walk.close)
        self._close = finalize(self, files.close)  # also without close(): Python would warn of open files
        self._starts = np.cumsum([0, *(len(walk.times) for walk in walks)])
        channels, renumber = merged(walk.channels for walk in walks)
        arrivals = (Arrivals(np.asarray(walk.times, np.int64), np.asarray(walk.ids, np.int64)) for walk in walks)
        times, ids = joined(part.renumbered(numbers) for part, numbers in zip(arrivals, renumber, strict=True))
        named = np.flatnonzero(ids >= 0)
        times[named], about_clock = repaired(Arrivals(times[named], ids[named]))
        order = named[np.argsort(times[named], kind="stable")]
        self._order: NDArray[np.intp] = order
        self._times, self._ids = self._arrivals = Arrivals(times[order], ids[order])
        counts = np.bincount(self._ids, minlength=len(channels)).tolist()
        self.channels = tuple(channel._replace(count=counts[channel.id]) for channel in channels)
        self.start_ns = int(self._times[0]) if order.size else None
        self.end_ns = int(self._times[-1]) if order.size else None
        lines, damaged = [*problems], []
        for walk, start, end in zip(walks, self._starts, self._starts[1:], strict=False):
            inside = named[(named >= start) & (named < end)]
            walk.damage.unnamed = int(end - start) - len(inside)
            span_ns = int(np.ptp(times[inside])) if inside.size else 0
            own = (*damage_lines(walk.damage, len(inside), span_ns), *walk.problems)
            damaged += [walk] if own else []
            named_lines = [f"{walk.name}: {line}" if len(walks) > 1 else line for line in own]
            lines += named_lines
            if not inside.size:
                self.unread += (*named_lines[:1],)
        if damaged and not order.size:
            self.close()
            raise nothing_readable(damaged[0])
        self.problems = (*lines, about_clock) if about_clock else tuple(lines)

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[Message]:
        """See `Source`."""
        wanted = {channel.id: channel for channel in channels}
        first = 0 if start_ns is None else self._before(start_ns)
        stop = len(self._times) if stop_ns is None else self._before(stop_ns)
        for at in first + np.flatnonzero(np.isin(self._ids[first:stop], list(wanted))):
            number = int(self._order[at])
            part = int(np.searchsorted(self._starts, number, side="right")) - 1
            data = self._walks[part].read(number - int(self._starts[part]))
            yield wanted[int(self._ids[at])], int(self._times[at]), plain(data)

    def span_ns(self, channel: Channel) -> tuple[int, int] | None:
        """See `Source`."""
        return self._arrivals.span_ns(channel.id)

    def size_of(self, channels: Collection[Channel]) -> int:  # noqa: ARG002  # single messages are read
        """See `Source`."""
        return 0

    def thinned(self, channels: Collection[Channel], most_bytes: int, most_parts: int) -> Iterator[list[Message]]:
        """See `Source`."""
        del channels, most_bytes, most_parts  # single messages are read
        return iter(())

    def close(self) -> None:
        """See `Source`."""
        self._close()

    def _before(self, time_ns: int) -> int:
        """Return the number of messages before a log time."""
        limits = np.iinfo(np.int64)
        if time_ns > limits.max:
            return len(self._times)
        return int(np.searchsorted(self._times, max(time_ns, limits.min), side="left"))

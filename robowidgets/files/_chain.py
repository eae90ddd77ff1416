"""Several sources as one, for a recording that was split into files."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property
from heapq import merge
from operator import itemgetter

from ..messages.channel import Channel, merged
from ..repair import Arrivals, Message, joined
from ._rosbags import RosbagsSource

_Part = tuple[RosbagsSource, dict[int, int]]
"""A source, with the ids of its channels in the chain."""


class Chain:
    """A `Source` over other sources, whose channels are merged.

    Args:
        sources: one for each file, in their order. They are closed with the chain.
    """

    def __init__(self, sources: Sequence[RosbagsSource]) -> None:
        self._sources = sources
        self.problems: tuple[str, ...] = ()
        self.channels, self._ids = merged(source.channels for source in sources)
        self.start_ns = min((s.start_ns for s in sources if s.start_ns is not None), default=None)
        self.end_ns = max((s.end_ns for s in sources if s.end_ns is not None), default=None)

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[Message]:
        """See `Source`."""
        wanted = {channel.id: channel for channel in channels}
        for group in self._groups():
            each = (_messages(*part, wanted, start_ns, stop_ns) for part in group)
            yield from merge(*each, key=lambda message: message[1])

    @cached_property
    def arrivals(self) -> Arrivals:
        """The order of arrival, one file after the other."""
        return joined(s.arrivals.renumbered(ids) for s, ids in self._parts())

    def span_ns(self, channel: Channel) -> tuple[int, int] | None:
        """See `Source`."""
        parts = [(s, c) for s, ids in self._parts() for c in s.channels if c.count and ids[c.id] == channel.id]
        spans = [span for source, part in parts if (span := source.span_ns(part))]
        return (min(first for first, _ in spans), max(last for _, last in spans)) if spans else None

    def size_of(self, channels: Collection[Channel]) -> int:
        """See `Source`."""
        wanted = {channel.id for channel in channels}
        return sum(s.size_of([c for c in s.channels if ids[c.id] in wanted]) for s, ids in self._parts())

    def thinned(self, channels: Collection[Channel], most_bytes: int, most_parts: int) -> Iterator[list[Message]]:
        """See `Source`. Each file has a share of the bytes and the parts by its size."""
        wanted = {channel.id: channel for channel in channels}
        size = self.size_of(channels)
        for source, ids in self._parts():
            ours = [channel for channel in source.channels if ids[channel.id] in wanted]
            if own := source.size_of(ours):
                parts = source.thinned(ours, most_bytes * own // size, most_parts * own // size)
                for part in parts:
                    yield [(wanted[ids[channel.id]], time_ns, raw) for channel, time_ns, raw in part]

    def close(self) -> None:
        """See `Source`."""
        for source in self._sources:
            source.close()

    def _groups(self) -> Iterator[list[_Part]]:
        """Yield sources whose times overlap together, in the order of their times, so that each waits for its turn."""
        group: list[_Part] = []
        latest = 0
        spans = ((part[0].start_ns, part[0].end_ns, part) for part in self._parts())
        filled = [(start, end, part) for start, end, part in spans if start is not None and end is not None]
        for start, end, part in sorted(filled, key=itemgetter(0)):
            if group and start > latest:
                yield group
                group = []
            group.append(part)
            latest = max(latest, end)
        if group:
            yield group

    def _parts(self) -> Iterator[_Part]:
        return zip(self._sources, self._ids, strict=True)


def _messages(
    source: RosbagsSource,
    ids: Mapping[int, int],
    wanted: Mapping[int, Channel],
    start_ns: int | None,
    stop_ns: int | None,
) -> Iterator[Message]:
    """Yield the messages of a source that belong to some channels of the chain, with the ids of the chain."""
    ours = [channel for channel in source.channels if ids[channel.id] in wanted]
    for channel, time_ns, data in source.messages(ours, start_ns, stop_ns):
        yield wanted[ids[channel.id]], time_ns, data

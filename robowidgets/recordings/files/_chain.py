"""Several sources as one, for a recording that the recorder split into files."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from heapq import merge
from itertools import pairwise

from ...messages.channel import Channel
from ...repair import RESET_NS, Arrivals, Message
from ._index import joined, renumbered
from ._rosbags import RosbagsSource


class Chain:
    """A `Source` over other sources.

    Channels with the same topic, type, encoding and definition are merged.

    Args:
        sources: one for each file, in their order; closed with the chain.
    """

    def __init__(self, sources: Sequence[RosbagsSource]) -> None:
        self._sources = sources
        self.problems: tuple[str, ...] = ()
        counts: dict[Channel, int] = {}
        for source in sources:
            for channel in source.channels:
                counts[_same(channel)] = counts.get(_same(channel), 0) + channel.count
        self._ids = {same: number for number, same in enumerate(counts)}
        self.channels = tuple(same._replace(id=number, count=counts[same]) for same, number in self._ids.items())
        self.start_ns = min((s.start_ns for s in sources if s.start_ns is not None), default=None)
        self.end_ns = max((s.end_ns for s in sources if s.end_ns is not None), default=None)

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[Message]:
        """See `Source`."""
        wanted = {channel.id: channel for channel in channels}
        each = (self._messages(source, wanted, start_ns, stop_ns) for source in self._sources)
        return merge(*each, key=lambda message: message[1])

    def arrivals(self) -> Arrivals:
        """The order of arrival in one file after the other."""
        return joined(renumbered(s.arrivals(), {c.id: self._ids[_same(c)] for c in s.channels}) for s in self._sources)

    def follows_on(self) -> bool:
        """Whether each file has the topics of the previous one and starts where that ends."""
        topics = [{(c.topic, c.type) for c in source.channels} for source in self._sources]
        times = [times for s in self._sources if (times := s.arrivals().times).size]
        in_order = all(later[0] >= times[-1] - RESET_NS for times, later in pairwise(times))
        return in_order and all(some <= others or others <= some for some, others in pairwise(topics))

    def span_ns(self, channel: Channel) -> tuple[int, int] | None:
        """See `Source`."""
        parts = [(s, c) for s in self._sources for c in s.channels if c.count and _same(c) == _same(channel)]
        spans = [span for source, part in parts if (span := source.span_ns(part))]
        return (min(first for first, _ in spans), max(last for _, last in spans)) if spans else None

    def close(self) -> None:
        """See `Source`."""
        for source in self._sources:
            source.close()

    def _messages(
        self, source: RosbagsSource, wanted: dict[int, Channel], start_ns: int | None, stop_ns: int | None
    ) -> Iterator[Message]:
        ours = {c.id: wanted[self._ids[_same(c)]] for c in source.channels if self._ids[_same(c)] in wanted}
        for channel, time_ns, data in source.messages([c for c in source.channels if c.id in ours], start_ns, stop_ns):
            yield ours[channel.id], time_ns, data


def _same(channel: Channel) -> Channel:
    """The channel without its id and count, which merged channels have in common."""
    return channel._replace(id=0, count=0)

"""All chunks of a topic: found on one pass through the file, and decoded again when they are asked for."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, count, groupby, islice
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..._core.progress import Progress
from ...messages.channel import Channel
from ...repair import Message, RecordingError, Source
from ._decoders import Decoder
from ._memory import Memory
from .chunks import ScanChunk, compact, merged

PAGE_BYTES = 1 << 20
"""About how many bytes of messages are decoded together, and held in memory or not."""

_numbers = count()


class Page(NamedTuple):
    """Messages in a row: how they are found again.

    Log times of the first and the last; how many there are, after how many others of the first time.
    """

    first_ns: int
    last_ns: int
    messages: int
    skipped: int


class Place(NamedTuple):
    """Where a chunk is found again: the page and the number in it; what it holds, from which row on."""

    page: int
    number: int
    start: int
    rows: int
    rays: int


@dataclass
class _Index:
    """What a pass through the topic found."""

    id: int = field(default_factory=lambda: next(_numbers))
    pages: list[Page] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    times: list[NDArray[np.int64]] = field(default_factory=list)
    stamps: list[NDArray[np.int64]] = field(default_factory=list)
    rows: int = 0

    def add_page(self, page: Page, chunks: Sequence[Any]) -> list[Any]:
        """Take in the next page; its chunks with the numbers of their rows."""
        numbered = []
        for number, chunk in enumerate(chunks):
            rays = chunk.ranges.shape[1] if isinstance(chunk, ScanChunk) else 0
            self.places.append(Place(len(self.pages), number, self.rows, len(chunk), rays))
            self.times.append(chunk.times_ns)
            self.stamps.append(chunk.stamps_ns)
            numbered.append(replace(chunk, start=self.rows))
            self.rows += len(chunk)
        self.pages.append(page)
        return numbered

    def finish(self) -> None:
        """Join the times."""
        self.times, self.stamps = [_joined(self.times)], [_joined(self.stamps)]


class Store:
    """The chunks of a topic.

    Args:
        source: where the messages are.
        channels: those of the topic.
        decoders: by the id of a channel.
        memory: keeps the pages that were asked for last.
        note: is told of a message that cannot be shown: channel, log time, error.
        stop: is told of an error after which nothing more can be read.
    """

    def __init__(
        self,
        source: Source,
        channels: Sequence[Channel],
        decoders: Mapping[int, Decoder],
        memory: Memory,
        note: Callable[[Channel, int, Exception], None],
        stop: Callable[[RecordingError], None],
    ) -> None:
        self.topic = channels[0].topic
        self.memory = memory
        self._source = source
        self._channels = channels
        self._decoders = decoders
        self._note = note
        self._stop = stop
        self._index: _Index | None = None

    @property
    def places(self) -> list[Place]:
        """Where each chunk is found."""
        return self._known().places

    @property
    def times_ns(self) -> NDArray[np.int64]:
        """Log times, shape (N,), ascending."""
        return self._known().times[0]

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """The messages' own times, shape (N,); 0 where they have none."""
        return self._known().stamps[0]

    @property
    def is_known(self) -> bool:
        """Whether all of it was read once."""
        return self._index is not None

    def chunks(self, start: int = 0, stop: int | None = None) -> Iterator[Any]:
        """The chunks that hold the rows from ``start`` up to, not including, ``stop``, cut to these."""
        if self._index is None and start == 0 and stop is None:
            yield from self._first_pass()
            return
        index = self._known()
        stop = index.rows if stop is None else stop
        first_place = bisect_right(index.places, start, key=lambda place: place.start) - 1
        for place in index.places[max(first_place, 0) :]:
            if place.start >= stop:
                return
            first, end = max(start - place.start, 0), min(stop - place.start, place.rows)
            if first < end:
                chunk = self._page(index, place.page)[place.number]
                part = chunk if end - first == place.rows else chunk.part(slice(first, end))
                yield replace(part, start=place.start + first)

    def _known(self) -> _Index:
        if self._index is None:
            for _ in self._first_pass():
                pass
        assert self._index is not None
        return self._index

    def _first_pass(self) -> Iterator[Any]:
        index = _Index()
        total = sum(channel.count for channel in self._channels)
        with Progress(total, f"Reading {self.topic}") as bar:
            try:
                for page, messages in _pages(self._source.messages(self._channels)):
                    chunks = index.add_page(page, self._decode(messages))
                    self.memory.put((index.id, len(index.pages) - 1), chunks)
                    bar.update(len(messages))
                    yield from chunks
            except RecordingError as error:
                self._stop(error)
        index.finish()
        self._index = index

    def _page(self, index: _Index, number: int) -> Any:
        return self.memory.get((index.id, number), lambda: self._decode(self._read(index.pages[number])))

    def _read(self, page: Page) -> list[Message]:
        messages = self._source.messages(self._channels, page.first_ns, page.last_ns + 1)
        return list(islice(messages, page.skipped, page.skipped + page.messages))

    def _decode(self, messages: Sequence[Message]) -> list[Any]:
        chunks: list[Any] = []
        for number, group in groupby(messages, key=lambda message: message[0].id):
            run = list(group)
            times, raws = [message[1] for message in run], [message[2] for message in run]
            chunks += self._decoders[number].decode(raws, times, lambda i, error: self._note(*run[i][:2], error))  # noqa: B023  # called at once
        return [compact(chunk) for chunk in merged(chunks)]


def _pages(messages: Iterator[Message]) -> Iterator[tuple[Page, list[Message]]]:
    """Messages in pages of about `PAGE_BYTES`."""
    latest: int | None = None
    same = 0
    for first in messages:
        held: list[Message] = []
        size = 0
        skipped = same if first[1] == latest else 0
        for message in chain((first,), messages):
            same = same + 1 if message[1] == latest else 1
            latest = message[1]
            held.append(message)
            size += len(message[2])
            if size >= PAGE_BYTES:
                break
        yield Page(first[1], held[-1][1], len(held), skipped), held


def _joined(parts: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    column = np.concatenate([np.empty(0, np.int64), *parts])
    column.flags.writeable = False
    return column

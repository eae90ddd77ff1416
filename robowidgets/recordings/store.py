"""All chunks of a topic by number: found once from start to end, and read again when they are asked for."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Any, Generic, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .._core.progress import Progress
from .ahead import read_ahead
from .chunks import Chunk, ScanChunk, compact
from .memory import Memory
from .pages import ChunkPage

_numbers = count()

_SHARE = 8
"""The part of the memory's limit, an eighth, in which unpacked chunks may stand."""


class Feed(Protocol[Chunk]):
    """Where the chunks of a topic come from."""

    @property
    def name(self) -> str:
        """The topic."""

    @property
    def total(self) -> int:
        """About how many messages there are."""

    def pages(self) -> Iterator[Callable[[], Any]]:
        """The parts of the file in the order of arrival; each may be read again, and in any thread."""

    def decode(self, page: Any) -> list[Chunk]:
        """The chunks in what a page gave."""

    def distrust(self, error: Exception) -> bool:
        """Told that a page could not be read: whether there is another way, on which pages begin anew."""


class Place(NamedTuple):
    """Where a chunk is found again: the page and the number in it; what it holds, from which row on."""

    page: int
    number: int
    start: int
    rows: int
    rays: int


@dataclass
class Index:
    """What a walk through all pages found."""

    id: int = field(default_factory=lambda: next(_numbers))
    pages: list[Callable[[], Any]] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    starts: list[int] = field(default_factory=list)
    times: list[NDArray[np.int64]] = field(default_factory=list)
    stamps: list[NDArray[np.int64]] = field(default_factory=list)

    def add(self, number: int, chunk: Chunk) -> None:
        """Take in a chunk, the next of a page."""
        rays = chunk.ranges.shape[1] if isinstance(chunk, ScanChunk) else 0
        self.places.append(Place(len(self.pages) - 1, number, chunk.start, len(chunk), rays))
        self.starts.append(chunk.start)
        self.times.append(chunk.times_ns)
        self.stamps.append(chunk.stamps_ns)

    def finish(self) -> None:
        """Join the times."""
        self.times = [_joined(self.times)]
        self.stamps = [_joined(self.stamps)]


class Store(Generic[Chunk]):
    """The chunks of a topic.

    Args:
        feed: where they come from.
        memory: what keeps those that were asked for last.
    """

    def __init__(self, feed: Feed[Chunk], memory: Memory) -> None:
        self.feed: Feed[Chunk] = feed
        self.memory = memory
        self._index: Index | None = None

    @property
    def places(self) -> list[Place]:
        """Where each chunk is found."""
        return self._known().places

    @property
    def times_ns(self) -> NDArray[np.int64]:
        """Log times, shape (N,), in the order of arrival."""
        return self._known().times[0]

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """Times that the messages bear, shape (N,); 0 where they bear none."""
        return self._known().stamps[0]

    @property
    def is_known(self) -> bool:
        """Whether all of it was read once."""
        return self._index is not None

    def once(self) -> Iterator[Chunk]:
        """All chunks, of which none is kept: their columns are views of what was read."""
        yield from self._walk(keep=False)

    def chunks(self, start: int = 0, stop: int | None = None) -> Iterator[Chunk]:
        """The chunks that hold the rows from ``start`` up to, not including, ``stop``, cut to these."""
        if self._index is None and start == 0 and stop is None:
            yield from self._walk(keep=True)
            return
        index = self._known()
        stop = len(self.times_ns) if stop is None else stop
        for place in index.places[max(bisect_right(index.starts, start) - 1, 0) :]:
            if place.start >= stop:
                return
            first, end = max(start - place.start, 0), min(stop - place.start, place.rows)
            if first < end:
                chunk: Chunk = self._page(index, place.page)[place.number]
                part = chunk if end - first == place.rows else chunk.part(slice(first, end))
                yield replace(part, start=place.start + first)

    def _page(self, index: Index, number: int) -> Any:
        return self.memory.get((index.id, number), lambda: self._compact(self._kept(index.pages[number])()))

    def _kept(self, page: Callable[[], Any]) -> Callable[[], Any]:
        return _Kept(page, self.memory) if isinstance(page, ChunkPage) and page.compression else page

    def _compact(self, page: Any) -> list[Chunk]:
        return [compact(chunk) for chunk in self.feed.decode(page)]

    def _known(self) -> Index:
        if self._index is None:
            for _ in self._walk(keep=True):
                pass
        assert self._index is not None
        return self._index

    def _walk(self, keep: bool) -> Iterator[Chunk]:
        """All chunks, while it is noted where they are. Where one way breaks off, the next goes on."""
        given = 0
        with Progress(self.feed.total, f"Reading {self.feed.name}") as bar:
            while True:
                index = Index()
                try:
                    for chunk in self._chunks(index, keep):
                        end = chunk.start + len(chunk)
                        if end > given:
                            known = max(given - chunk.start, 0)
                            bar.update(end - given)
                            given = end
                            yield chunk.part(slice(known, None)) if known else chunk
                    break
                except _PageError as error:
                    if not self.feed.distrust(error.cause):
                        break
        index.finish()
        self._index = index

    def _chunks(self, index: Index, keep: bool) -> Iterator[Chunk]:
        def noted() -> Iterator[Callable[[], Any]]:
            for page in self.feed.pages():
                coming.append(page)
                yield self._kept(page)

        coming: deque[Callable[[], Any]] = deque()
        results = read_ahead(noted())
        row = 0
        while True:
            try:
                page = next(results)
                read: list[Chunk] = self._compact(page) if keep else self.feed.decode(page)
            except StopIteration:
                return
            except Exception as error:  # whatever the reader of a damaged file stumbles over: the feed is the judge
                raise _PageError(error) from error
            index.pages.append(coming.popleft())
            chunks = []
            for chunk in read:
                chunks.append(replace(chunk, start=row))
                row += len(chunk)
            if keep:
                self.memory.put((index.id, len(index.pages) - 1), chunks)
            for number, chunk in enumerate(chunks):
                index.add(number, chunk)
                yield chunk


@dataclass(frozen=True)
class _Kept:
    """A page that is decompressed once, while there is room: other topics lie in the same chunk."""

    page: ChunkPage
    memory: Memory

    @property
    def slow(self) -> bool:
        return self.page.slow

    def __call__(self) -> Any:
        return self.page.find(tuple(self.memory.get(self.page.key, self.page.unpack, share=_SHARE)))


class _PageError(Exception):
    """A page could not be read."""

    def __init__(self, cause: Exception) -> None:
        super().__init__(str(cause))
        self.cause = cause


def _joined(parts: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    column = np.concatenate([np.empty(0, np.int64), *parts])
    column.flags.writeable = False
    return column

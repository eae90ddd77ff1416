"""The raw messages of a topic, a page at a time: what can be read again by itself, and decoded in one go."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ..repair.source import Channel, Source

PAGE_BYTES = 1 << 22
"""About how many bytes of messages make a page where the file itself has no such parts."""

Buffer = bytes | memoryview


class Raws(NamedTuple):
    """Messages of one channel that came one after the other, as they lie in a buffer.

    ``times``: log times in nanoseconds, shape (n,). ``starts`` and ``ends``: where each lies in ``buffer``, shape (n,).
    """

    channel: Channel
    times: NDArray[np.int64]
    buffer: Buffer
    starts: NDArray[np.int64]
    ends: NDArray[np.int64]


Held = Callable[[], list[Raws]]
"""Finds the messages in what was read of a page, in the order in which they came."""

Page = Callable[[], Held]
"""Reads one page. May be called again, and in any thread."""


Unpacked = tuple[memoryview, ...]
"""What was read and decompressed of a page, for all channels."""


class ChunkPage(ABC):
    """A page that is a chunk of a file, in which other channels lie too. Called, it is unpacked.

    Attributes:
        path: the file.
        start: where the chunk lies in it.
        compression: how it is packed; empty when it is not.
    """

    path: Path
    start: int
    compression: str

    def __call__(self) -> Held:
        """The messages, to be found."""
        return self.find(self.unpack())

    @property
    def key(self) -> Hashable:
        """What all pages of the same chunk share."""
        return self.path, self.start

    @property
    def slow(self) -> bool:
        """Whether a thread should read it ahead: it takes long to decompress."""
        return bool(self.compression)

    @abstractmethod
    def unpack(self) -> Unpacked:
        """Read and decompress it."""

    def find(self, unpacked: Unpacked) -> Held:
        """The messages of the page's own channels in what was unpacked, to be found."""
        return partial(self._messages, *unpacked)

    @abstractmethod
    def _messages(self, *unpacked: Any, **none: Any) -> list[Raws]:
        """The same, found."""


@runtime_checkable
class Paged(Protocol):
    """A source that knows the parts of its file."""

    def pages(self, channels: Collection[Channel]) -> Iterable[Page] | None:
        """The pages that hold messages of these channels, in the order of arrival; None where there are no parts."""


def pages_of(source: Source, channels: Collection[Channel]) -> Iterator[Page]:
    """The pages of any source, in the order of arrival as far as the source knows it."""
    known = source.pages(channels) if isinstance(source, Paged) else None
    return by_time(source, channels) if known is None else iter(known)


def pack(messages: Iterable[tuple[Channel, int, bytes]]) -> list[Raws]:
    """Messages side by side in a buffer, those of one channel after the other."""
    packed = []
    for _, run in groupby(messages, key=lambda message: message[0].id):
        held = list(run)
        ends = np.cumsum([len(raw) for _, _, raw in held], dtype=np.int64)
        times = np.array([time_ns for _, time_ns, _ in held], np.int64)
        starts = np.concatenate((np.zeros(1, np.int64), ends[:-1]))
        packed.append(Raws(held[0][0], times, b"".join([raw for _, _, raw in held]), starts, ends))
    return packed


def by_time(source: Source, channels: Collection[Channel]) -> Iterator[Page]:
    """Pages of a source that reads by log time: each is found again by the time of its first message."""
    held: list[tuple[Channel, int, bytes]] = []
    size = same = skipped = 0
    latest: int | None = None
    for message in source.messages(channels):
        if held and size >= PAGE_BYTES:
            yield _Found(source, channels, held, skipped)
            held, size = [], 0
        same = same + 1 if message[1] == latest else 0
        latest = message[1]
        if not held:
            skipped = same
        held.append(message)
        size += len(message[2])
    if held:
        yield _Found(source, channels, held, skipped)


class _Found:
    """A page that gives what it was made of once, and then looks for it again."""

    def __init__(
        self, source: Source, channels: Collection[Channel], held: list[tuple[Channel, int, bytes]], skipped: int
    ) -> None:
        self._source, self._channels = source, channels
        self._held: list[tuple[Channel, int, bytes]] | None = held
        self._first, self._last, self._count, self._skipped = held[0][1], held[-1][1], len(held), skipped

    def __call__(self) -> Held:
        held, self._held = self._held, None
        return partial(pack, held if held is not None else list(self._again()))

    def _again(self) -> Iterator[tuple[Channel, int, bytes]]:
        messages = self._source.messages(self._channels, self._first, self._last + 1)
        for number, message in enumerate(messages):
            if number >= self._skipped + self._count:
                return
            if number >= self._skipped:
                yield message

"""All chunks of a topic: located in one pass through the file, and decoded again when they are read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, groupby, islice, pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...messages.channel import Channel
from ...notebook.progress import Progress
from ...repair import Message, RecordingError, Source
from ...samples.checks import frozen
from ._decoders import Decoder
from ._memory import Memory
from .chunks import ScanChunk, compact, merged

BATCH_BYTES = 1 << 20
"""Approximate bytes of messages that are decoded together, and kept in memory together."""


class Batch(NamedTuple):
    """Consecutive messages, with the numbers that are needed to read them again.

    ``first_ns`` and ``last_ns`` are the log times of the first and the last message, ``messages`` their number.
    ``skipped`` counts earlier messages with the log time ``first_ns``.
    """

    first_ns: int
    last_ns: int
    messages: int
    skipped: int


class Place(NamedTuple):
    """The place of a chunk: its batch, its number in the batch, its first row, and its size."""

    batch: int
    number: int
    start: int
    rows: int
    rays: int


@dataclass(eq=False)
class _Index:
    """The batches, places and times that a pass through the topic found."""

    batches: list[Batch] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    starts: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    """The first rows of the places."""
    times: list[NDArray[np.int64]] = field(default_factory=list)
    stamps: list[NDArray[np.int64]] = field(default_factory=list)
    rows: int = 0

    def add_batch(self, batch: Batch, chunks: Sequence[Any]) -> list[Any]:
        """Add the next batch, and return its chunks with their first rows set."""
        numbered = []
        for number, chunk in enumerate(chunks):
            rays = chunk.ranges.shape[1] if isinstance(chunk, ScanChunk) else 0
            self.places.append(Place(len(self.batches), number, self.rows, len(chunk), rays))
            self.times.append(chunk.times_ns)
            self.stamps.append(chunk.stamps_ns)
            numbered.append(replace(chunk, start=self.rows))
            self.rows += len(chunk)
        self.batches.append(batch)
        return numbered

    def finish(self) -> None:
        """Join the times, and collect the first rows."""
        self.starts = np.array([place.start for place in self.places], np.int64)
        for column in (self.times, self.stamps):
            column[:] = [frozen(np.concatenate([np.empty(0, np.int64), *column]))]


@dataclass(eq=False)
class Store:
    """The chunks of a topic.

    Args:
        source: the messages.
        channels: the channels of the topic.
        decoders: the decoder of each channel, by its id.
        memory: keeps the batches that were read last.
        note: called with the channel, the log time and the error of a message that cannot be shown.
        stop: called with an error after which nothing more can be read.
        span: the log times of the messages, the second not included; None means no limit.
    """

    source: Source
    channels: Sequence[Channel]
    decoders: Mapping[int, Decoder]
    memory: Memory
    note: Callable[[Channel, int, Exception], None]
    stop: Callable[[RecordingError], None]
    span: tuple[int | None, int | None] = (None, None)
    _index: _Index | None = field(default=None, init=False)

    def between(self, start_ns: int | None, stop_ns: int | None) -> Store:
        """Return a store of the messages from ``start_ns`` up to, not including, ``stop_ns``, with its own index."""
        return replace(self, span=(start_ns, stop_ns))

    @property
    def topic(self) -> str:
        """The name of the topic."""
        return self.channels[0].topic

    @property
    def places(self) -> list[Place]:
        """The places of all chunks."""
        return self._indexed().places

    @property
    def times_ns(self) -> NDArray[np.int64]:
        """Log times, shape (N,), ascending."""
        return self._indexed().times[0]

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """The stamps of the messages in nanoseconds, shape (N,); 0 for messages without one."""
        return self._indexed().stamps[0]

    @property
    def is_indexed(self) -> bool:
        """True if the first pass has reached the end."""
        return self._index is not None

    def chunks(self, rows: NDArray[np.int64] | None = None) -> Iterator[Any]:
        """Yield the chunks of some rows (None: all rows) in their order; ``start`` of a chunk counts within these."""
        if self._index is None and rows is None:
            yield from self._first_pass()
            return
        index = self._indexed()
        rows = np.arange(index.rows) if rows is None else rows
        numbers = np.searchsorted(index.starts, rows, side="right") - 1
        cuts = np.flatnonzero(np.diff(numbers, prepend=-1)).tolist()
        for first, stop in pairwise([*cuts, len(rows)]):
            place = index.places[numbers[first]]
            chunk = self._batch(index, place.batch)[place.number]
            own = rows[first:stop] - place.start
            whole = np.array_equal(own, np.arange(place.rows))
            yield replace(chunk, start=first) if whole else chunk.part(own, first)

    def thinned(self, most_bytes: int, most_parts: int) -> Iterator[list[Any]]:
        """Yield the chunks of a few parts of the file, part by part; see `Source.thinned`."""
        with Progress(None, f"Reading parts of {self.topic}", " parts") as bar:
            for messages in self.source.thinned(self.channels, most_bytes, most_parts):
                yield self._decode(messages)
                bar.update(1)

    def sample(self, row: int) -> Any:
        """Return the sample in one row."""
        index = self._indexed()
        place = index.places[int(np.searchsorted(index.starts, row, side="right")) - 1]
        return self._batch(index, place.batch)[place.number].sample(row - place.start)

    def _indexed(self) -> _Index:
        if self._index is None:
            for _ in self._first_pass():
                pass
        assert self._index is not None
        return self._index

    def _first_pass(self) -> Iterator[Any]:
        index = _Index()
        whole = self.span == (None, None)
        total = sum(channel.count for channel in self.channels) if whole else None
        with Progress(total, f"Reading {self.topic}") as bar:
            try:
                for batch, messages in _batches(self.source.messages(self.channels, *self.span)):
                    chunks = index.add_batch(batch, self._decode(messages))
                    self.memory.put((index, len(index.batches) - 1), chunks)
                    bar.update(len(messages))
                    yield from chunks
            except RecordingError as error:
                self.stop(error)
        index.finish()
        self._index = index

    def _batch(self, index: _Index, number: int) -> Any:
        return self.memory.get((index, number), lambda: self._decode(self._read(index.batches[number])))

    def _read(self, batch: Batch) -> list[Message]:
        messages = self.source.messages(self.channels, batch.first_ns, batch.last_ns + 1)
        return list(islice(messages, batch.skipped, batch.skipped + batch.messages))

    def _decode(self, messages: Sequence[Message]) -> list[Any]:
        chunks: list[Any] = []
        for number, group in groupby(messages, key=lambda message: message[0].id):
            run = list(group)
            times, raws = [message[1] for message in run], [message[2] for message in run]
            chunks += self.decoders[number].decode(raws, times, lambda i, error: self.note(*run[i][:2], error))  # noqa: B023  # called at once
        return [compact(chunk) for chunk in merged(chunks)]


def _batches(messages: Iterator[Message]) -> Iterator[tuple[Batch, list[Message]]]:
    """Group messages into batches of about `BATCH_BYTES` bytes."""
    latest: int | None = None
    same = 0
    for first in messages:
        batch: list[Message] = []
        size = 0
        skipped = same if first[1] == latest else 0
        for message in chain((first,), messages):
            same = same + 1 if message[1] == latest else 1
            latest = message[1]
            batch.append(message)
            size += len(message[2])
            if size >= BATCH_BYTES:
                break
        yield Batch(first[1], batch[-1][1], len(batch), skipped), batch

"""Columns of scans and speeds from raw messages, many at a time.

Messages alike but for their numbers (see `quick`) are laid one under the other, and each number is cut from all of them
in one go.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Generic

import numpy as np
from numpy.typing import NDArray

from ..repair.source import RecordingError
from ..samples import Touch
from .chunks import Chunk, ScanChunk, SpeedChunk, TouchChunk, merged, single_scan, single_speed
from .pages import Raws
from .quick import Alike, ScanReader, SpeedReader

Note = Callable[[Raws, int, Exception], None]
"""Is told of a message that cannot be shown: its number among the raw ones, and why."""

_FIRST_LOOK, _CAREFUL_LOOK = 1024, 32
_HEAD = 4
_STAMP = np.dtype([("seconds", "<i4"), ("nanoseconds", "<u4")])


class Columns(Generic[Chunk]):
    """Makes columns of the messages of one channel.

    Args:
        reader: reads one message, and learns what is alike in the next.
        alike: makes a chunk of messages that are alike.
        single: makes a chunk of one sample.
    """

    def __init__(
        self,
        reader: ScanReader | SpeedReader,
        alike: Callable[[Any, NDArray[np.int64], NDArray[np.uint8]], Chunk],
        single: Callable[[Any, int], Chunk],
    ) -> None:
        self._reader = reader
        self._alike: Callable[[Any, NDArray[np.int64], NDArray[np.uint8]], Chunk] = alike
        self._single: Callable[[Any, int], Chunk] = single
        # How many messages are compared at once: fewer where they have proved to differ.
        self._look = _FIRST_LOOK

    def read(self, raws: Raws, note: Note) -> list[Chunk]:
        """The chunks of some messages, in their order; those that cannot be shown are noted and left out."""
        return merged(self._chunks(raws, note))

    def _chunks(self, raws: Raws, note: Note) -> Iterator[Chunk]:
        at = 0
        sizes = raws.ends - raws.starts
        while at < len(raws.times):
            alike = self._reader.alike
            if alike and sizes[at] == alike.size:
                rows = _rows(raws, at, min(at + self._look, len(sizes)), sizes)
                count = _count_alike(alike, rows)
                self._look = 4 * self._look if count == len(rows) else _CAREFUL_LOOK
                if count:
                    yield self._alike(alike, raws.times[at : at + count], rows[:count])
                    at += count
                    continue
            try:
                raw = bytes(raws.buffer[raws.starts[at] : raws.ends[at]])
                yield self._single(self._reader(raw), int(raws.times[at]))
            except (RecordingError, TypeError, ValueError) as error:
                note(raws, at, error)
            at += 1


def scan_columns(reader: ScanReader) -> Columns[ScanChunk]:
    """What makes columns of scans."""
    return Columns(reader, _scans, single_scan)


def speed_columns(reader: SpeedReader) -> Columns[SpeedChunk]:
    """What makes columns of speeds."""
    return Columns(reader, _speeds, single_speed)


class TouchColumns:
    """Makes chunks of the messages of one channel of touches.

    Args:
        read: makes a touch of the bytes of a message.
    """

    def __init__(self, read: Callable[[bytes], Touch]) -> None:
        self._read = read

    def read(self, raws: Raws, note: Note) -> list[TouchChunk]:
        """See `Columns.read`."""
        rows: list[int] = []
        touches: list[Touch] = []
        before = None
        for i, (start, end) in enumerate(zip(raws.starts.tolist(), raws.ends.tolist(), strict=True)):
            raw = bytes(raws.buffer[start:end])
            if raw != before:
                before = None
                try:
                    touch = self._read(raw)
                except (RecordingError, TypeError, ValueError) as error:
                    note(raws, i, error)
                    continue
                before = raw
            rows.append(i)
            touches.append(touch)
        if not rows:
            return []
        column = np.empty(len(rows), object)
        column[:] = touches
        stamps = np.array([touch.stamp_ns or 0 for touch in touches], np.int64)
        return [TouchChunk(0, raws.times[rows], stamps, column)]


def _scans(alike: Alike, times: NDArray[np.int64], rows: NDArray[np.uint8]) -> ScanChunk:
    ranges = _cut(rows, alike.numbers, "<f4")
    intensities = _cut(rows, alike.more, "<f4") if alike.more else np.empty((len(rows), 0), np.float32)
    return ScanChunk(0, times, _stamps(rows), ranges, intensities, alike.sample)


def _speeds(alike: Alike, times: NDArray[np.int64], rows: NDArray[np.uint8]) -> SpeedChunk:
    stamps = _stamps(rows) if alike.stamped else np.zeros(len(rows), np.int64)
    return SpeedChunk(0, times, stamps, _cut(rows, alike.numbers, "<f8"), alike.sample.frame_id)


def _rows(raws: Raws, first: int, end: int, sizes: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Messages as long as the first, one under the other: without a copy where they lie at equal distances."""
    size = int(sizes[first])
    other = np.flatnonzero(sizes[first:end] != size)
    end = first + int(other[0]) if other.size else end
    starts = raws.starts[first:end]
    steps = np.diff(starts)
    if not steps.size or (steps == steps[0]).all():
        data = np.frombuffer(raws.buffer, np.uint8)
        strides = (int(steps[0]) if steps.size else size, 1)
        return np.lib.stride_tricks.as_strided(data[starts[0] :], (len(starts), size), strides, writeable=False)
    view = memoryview(raws.buffer)
    packed = b"".join([view[at : at + size] for at in starts.tolist()])
    return np.frombuffer(packed, np.uint8).reshape(len(starts), size)


def _count_alike(alike: Alike, rows: NDArray[np.uint8]) -> int:
    """How many of the rows, from the first on, are the same wherever no number stands."""
    same = np.ones(len(rows), bool)
    for part, expected in alike.fixed:
        same &= (rows[:, part] == np.frombuffer(expected, np.uint8)).all(axis=1)
    return len(rows) if same.all() else int(same.argmin())


def _cut(rows: NDArray[np.uint8], part: slice, kind: str) -> NDArray[Any]:
    # A view: who keeps it copies it, see `chunks.compact`.
    return rows[:, part].view(kind)


def _stamps(rows: NDArray[np.uint8]) -> NDArray[np.int64]:
    stamps = np.ascontiguousarray(rows[:, _HEAD : _HEAD + _STAMP.itemsize]).view(_STAMP)[:, 0]
    nanoseconds: NDArray[np.int64] = stamps["seconds"].astype(np.int64) * 1_000_000_000 + stamps["nanoseconds"]
    return nanoseconds

"""Some rows of a store: piece by piece, or as one array."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .chunks import Chunk
from .series import Rows
from .store import Store

_INSTEAD = (
    "take a part of it (series[a:b], series.between(start, end)), go through .chunks(), "
    "or set recording.memory higher, in bytes"
)


def chunks_of(store: Store[Chunk], rows: Rows | None) -> Iterator[Chunk]:
    """The chunks that hold some rows, in the order of the rows; ``start`` counts within these."""
    if rows is None:
        yield from store.chunks()
        return
    given = 0
    for start, stop, step in _stretches(rows):
        for chunk in store.chunks(start, stop):
            part = chunk if step == 1 else chunk.part(slice((start - chunk.start) % step, None, step))
            if len(part):
                yield replace(part, start=given)
                given += len(part)


def filled(
    store: Store[Chunk],
    chunks: Iterable[Chunk],
    shape: tuple[int, ...],
    kind: np.dtype[Any],
    column: Callable[[Chunk], Any],
    what: str,
) -> NDArray[Any]:
    """One array of a column of all chunks.

    Raises:
        RecordingError: it would be larger than the memory's limit.
    """
    size = int(np.prod(shape, dtype=object)) * kind.itemsize
    with store.memory.reserved(size, what, _INSTEAD):
        array = np.empty(shape, kind)
        for chunk in chunks:
            array[chunk.start : chunk.start + len(chunk)] = column(chunk)
    return array


def whole(store: Store[Chunk], kind: np.dtype[Any], column: Callable[[Chunk], NDArray[Any]]) -> NDArray[Any] | None:
    """One array of a column of all chunks, on the first way through the file; None where it is not to be had so.

    So it is where there is no chunk, where they differ in width, or where there may be too little memory.
    """
    array: NDArray[Any] | None = None
    given, fits = 0, True
    with ExitStack() as stack:
        for chunk in store.once():
            part = column(chunk)
            if array is None:
                shape = (store.feed.total, part.shape[1])
                size = shape[0] * shape[1] * kind.itemsize
                fits = size <= store.memory.limit
                array = np.empty(shape if fits else (0, 0), kind)
                stack.enter_context(store.memory.reserved(array.nbytes, "", ""))
            fits = fits and part.shape[1] == array.shape[1] and given + len(part) <= len(array)
            if fits:
                array[given : given + len(part)] = part
            given += len(part)
    return array[:given] if fits and array is not None else None


def _stretches(rows: Rows) -> Iterator[tuple[int, int, int]]:
    """Start, stop and step, above 0, of stretches that together are the rows, in their order."""
    if isinstance(rows, range) and rows.step > 0:
        if rows:
            yield rows[0], rows[-1] + 1, rows.step
        return
    every = np.asarray(rows, np.int64)
    for part in np.split(every, np.flatnonzero(np.diff(every) != 1) + 1):
        if part.size:
            yield int(part[0]), int(part[-1]) + 1, 1

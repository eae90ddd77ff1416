"""Where the scans of a scanogram lie, and what they share."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..samples import Scan

CHUNK_CELLS = 1 << 18
"""Ranges that are worked on at once: few enough to stay in the processor's cache."""


class Sweep(NamedTuple):
    """What all scans of a scanogram share: radians and metres as in `Scan`, and the number of rays.

    ``by_angle``: some had other rays, and stand where their angles are; so an index is not that of a program.
    """

    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    ray_count: int
    by_angle: bool = False

    @classmethod
    def of(cls, scan: Scan) -> Sweep:
        """That of one scan."""
        return cls(scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max, len(scan))


class Scans(Protocol):
    """N scans of R rays, which may lie in a file."""

    @property
    def times_ns(self) -> NDArray[np.int64]:
        """Times in nanoseconds since the epoch, shape (N,), in the order of arrival."""

    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """All ranges in metres, in arrays of shape (n, R)."""

    def read(self, start: int, stop: int) -> NDArray[np.float32]:
        """The ranges of the scans from one number up to, not including, another: shape (stop - start, R)."""


class Held:
    """Scans that are held in memory.

    Args:
        times_ns: shape (N,).
        pieces: ranges in metres, arrays of shape (n, R), N rows in all.
    """

    def __init__(self, times_ns: NDArray[np.int64], pieces: Sequence[NDArray[np.float32]]) -> None:
        self.times_ns = times_ns
        self._pieces = pieces
        self._starts = np.cumsum([0, *(len(piece) for piece in pieces[:-1])])

    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """See `Scans`."""
        return cut(self._pieces)

    def read(self, start: int, stop: int) -> NDArray[np.float32]:
        """See `Scans`."""
        first, last = np.searchsorted(self._starts, (start, max(start, stop - 1)), "right") - 1
        near = zip(self._starts[first : last + 1].tolist(), self._pieces[first : last + 1], strict=True)
        return np.concatenate([piece[max(0, start - at) : max(0, stop - at)] for at, piece in near])


def cut(pieces: Iterable[NDArray[np.float32]], width: int = 0) -> Iterator[NDArray[np.float32]]:
    """The same rows in arrays of about `CHUNK_CELLS`, each row counted as so many cells if it has fewer."""
    for piece in pieces:
        rows = max(1, CHUNK_CELLS // max(1, width, piece.shape[1]))
        for start in range(0, len(piece), rows):
            yield piece[start : start + rows]

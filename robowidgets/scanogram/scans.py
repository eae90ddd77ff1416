"""The scans of a scanogram, and the geometry that they share."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..samples import Scan

CHUNK_CELLS = 1 << 18
"""The number of ranges that are processed at once: few enough for the processor cache."""


class Sweep(NamedTuple):
    """The geometry that all scans of a scanogram share: radians and metres as in `Scan`, and the number of rays.

    ``by_angle``: some scans had other rays and are drawn by angle, so indices in the picture and in the scan differ.
    """

    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    ray_count: int
    by_angle: bool = False

    @classmethod
    def of(cls, scan: Scan) -> Sweep:
        """Return the geometry of a scan."""
        return cls(scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max, len(scan))


class ScanRanges(Protocol):
    """N scans of R rays, which may lie in a file."""

    @property
    def times_ns(self) -> NDArray[np.int64]:
        """Times in nanoseconds since the epoch, shape (N,), in the order of arrival."""

    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """Yield all ranges in metres, in arrays of shape (n, R)."""

    def read(self, start: int, stop: int) -> NDArray[np.float32]:
        """Return the ranges of the scans ``start`` to ``stop - 1``: shape (stop - start, R)."""


class ScansInMemory:
    """Scans in memory.

    Args:
        times_ns: shape (N,).
        pieces: ranges in metres, arrays of shape (n, R), N rows in all.
    """

    def __init__(self, times_ns: NDArray[np.int64], pieces: Sequence[NDArray[np.float32]]) -> None:
        self.times_ns = times_ns
        self._pieces = pieces
        self._starts = np.cumsum([0, *(len(piece) for piece in pieces[:-1])])

    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """See `ScanRanges`."""
        return cut(self._pieces)

    def read(self, start: int, stop: int) -> NDArray[np.float32]:
        """See `ScanRanges`."""
        first, last = np.searchsorted(self._starts, (start, max(start, stop - 1)), "right") - 1
        near = zip(self._starts[first : last + 1].tolist(), self._pieces[first : last + 1], strict=True)
        return np.concatenate([piece[max(0, start - at) : max(0, stop - at)] for at, piece in near])


def cut(pieces: Iterable[NDArray[np.float32]], width: int = 0) -> Iterator[NDArray[np.float32]]:
    """Yield the rows in arrays of about `CHUNK_CELLS` cells; a row counts as at least ``width`` cells."""
    for piece in pieces:
        rows = max(1, CHUNK_CELLS // max(1, width, piece.shape[1]))
        for start in range(0, len(piece), rows):
            yield piece[start : start + rows]

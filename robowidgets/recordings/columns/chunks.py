"""Columns of some samples in a row."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...samples import Scan, Speed

_SAMPLE_BYTES = 1000


@dataclass(frozen=True)
class ScanChunk:
    """Scans in a row with the same number of rays and the same geometry, as columns.

    Args:
        start: number of the first within its series.
        times_ns: log times in nanoseconds, shape (N,), int64.
        stamps_ns: the scanner's own times, shape (N,), int64; 0 where there is none.
        ranges: metres, shape (N, R), float32; NaN and infinities as in REP-117.
        intensities: device units, shape (N, R), float32; (N, 0) where there are none.
        like: one scan of these, for all that they share.
    """

    start: int
    times_ns: NDArray[np.int64]
    stamps_ns: NDArray[np.int64]
    ranges: NDArray[np.float32]
    intensities: NDArray[np.float32]
    like: Scan

    def __len__(self) -> int:
        return len(self.times_ns)

    @property
    def angle_min(self) -> float:
        """Radians, of ray 0."""
        return self.like.angle_min

    @property
    def angle_increment(self) -> float:
        """Radians from ray to ray."""
        return self.like.angle_increment

    @property
    def range_min(self) -> float:
        """Metres; see `Scan`."""
        return self.like.range_min

    @property
    def range_max(self) -> float:
        """Metres; see `Scan`."""
        return self.like.range_max

    @property
    def nbytes(self) -> int:
        """Bytes of its columns."""
        return self.times_ns.nbytes + self.stamps_ns.nbytes + self.ranges.nbytes + self.intensities.nbytes

    @property
    def key(self) -> tuple[Any, ...]:
        """What the scans of a chunk share."""
        s = self.like
        counts = (self.ranges.shape[1], self.intensities.shape[1])
        return (*counts, s.angle_min, s.angle_increment, s.range_min, s.range_max, s.frame_id, s.notes)

    def sample(self, i: int) -> Scan:
        """One of the scans."""
        ranges, intensities = self.ranges[i], self.intensities[i]
        return self.like.again(ranges, intensities, int(self.stamps_ns[i]) or None, keep=True)

    def part(self, rows: slice) -> ScanChunk:
        """Some of them."""
        columns = {name: getattr(self, name)[rows] for name in ("times_ns", "stamps_ns", "ranges", "intensities")}
        return replace(self, start=self.start + (rows.start or 0), **columns)


@dataclass(frozen=True)
class SpeedChunk:
    """Speeds in a row, as columns.

    Args:
        start: number of the first within its series.
        times_ns, stamps_ns: as in `ScanChunk`.
        values: shape (N, 6), float64, in the order of `AXES`: linear in m/s, angular in rad/s.
        frame_id: the frame they are expressed in.
    """

    start: int
    times_ns: NDArray[np.int64]
    stamps_ns: NDArray[np.int64]
    values: NDArray[np.float64]
    frame_id: str

    def __len__(self) -> int:
        return len(self.times_ns)

    @property
    def nbytes(self) -> int:
        """Bytes of its columns."""
        return self.times_ns.nbytes + self.stamps_ns.nbytes + self.values.nbytes

    @property
    def key(self) -> tuple[Any, ...]:
        """What the speeds of a chunk share."""
        return (self.frame_id,)

    def sample(self, i: int) -> Speed:
        """One of the speeds."""
        x, y, z, roll, pitch, yaw = self.values[i].tolist()
        return Speed((x, y, z), (roll, pitch, yaw), int(self.stamps_ns[i]) or None, self.frame_id)

    def part(self, rows: slice) -> SpeedChunk:
        """Some of them."""
        columns = {name: getattr(self, name)[rows] for name in ("times_ns", "stamps_ns", "values")}
        return replace(self, start=self.start + (rows.start or 0), **columns)


@dataclass(frozen=True)
class SampleChunk:
    """Samples of any kind in a row.

    Args:
        start: number of the first within its series.
        times_ns, stamps_ns: as in `ScanChunk`.
        samples: shape (N,), objects.
    """

    start: int
    times_ns: NDArray[np.int64]
    stamps_ns: NDArray[np.int64]
    samples: NDArray[np.object_]

    key = ()

    def __len__(self) -> int:
        return len(self.times_ns)

    @property
    def nbytes(self) -> int:
        """About how many bytes it takes."""
        return _SAMPLE_BYTES * len(self)

    def sample(self, i: int) -> Any:
        """One of them."""
        return self.samples[i]

    def part(self, rows: slice) -> SampleChunk:
        """Some of them."""
        columns = {name: getattr(self, name)[rows] for name in ("times_ns", "stamps_ns", "samples")}
        return replace(self, start=self.start + (rows.start or 0), **columns)


Chunk = TypeVar("Chunk", ScanChunk, SpeedChunk, SampleChunk)


def merged(chunks: Iterable[Chunk]) -> list[Chunk]:
    """Chunks that follow each other and share all they can as one."""
    return [join(list(run)) for _, run in groupby(chunks, key=lambda chunk: chunk.key)]


def join(chunks: list[Chunk]) -> Chunk:
    """Chunks with the same key as one."""
    first = chunks[0]
    if len(chunks) == 1:
        return first
    names = [name for name, value in vars(first).items() if isinstance(value, np.ndarray)]
    columns: Any = {name: np.concatenate([getattr(chunk, name) for chunk in chunks]) for name in names}
    return replace(first, **columns)


def compact(chunk: Chunk) -> Chunk:
    """The chunk with read-only columns; those that are small parts of the messages they were cut from are copied."""
    columns: Any = {}
    for name, value in vars(chunk).items():
        if isinstance(value, np.ndarray):
            columns[name] = value.copy() if _keeps_alive_more(value) else value.view()
            columns[name].flags.writeable = False
    return replace(chunk, **columns)


def _keeps_alive_more(column: NDArray[Any]) -> bool:
    """Whether a view keeps alive a buffer of which most is not in it."""
    base: Any = column
    while isinstance(base, np.ndarray) and base.base is not None:
        base = base.base
    return 2 * column.nbytes < memoryview(base).nbytes


def single_scan(scan: Scan, time_ns: int) -> ScanChunk:
    """A chunk of one scan."""
    times, stamps = np.array([[time_ns], [scan.stamp_ns or 0]], np.int64)
    return ScanChunk(0, times, stamps, scan.ranges[None], scan.intensities[None], scan)


def single_speed(speed: Speed, time_ns: int) -> SpeedChunk:
    """A chunk of one speed."""
    times, stamps = np.array([[time_ns], [speed.stamp_ns or 0]], np.int64)
    return SpeedChunk(0, times, stamps, np.array([speed.values], np.float64), speed.frame_id)

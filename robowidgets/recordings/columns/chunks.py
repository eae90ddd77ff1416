"""Chunks: the columns of consecutive samples."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...samples import Pose, Scan, Speed
from ...samples.checks import frozen

if TYPE_CHECKING:
    from typing_extensions import Self

_SAMPLE_BYTES = 1000


@dataclass(frozen=True)
class Chunk:
    """Consecutive samples, which share everything but the columns.

    Args:
        start: index of the first sample in its series.
        times_ns: log times in nanoseconds, shape (N,), int64.
        stamps_ns: stamps of the messages in nanoseconds, shape (N,), int64; 0 for messages without one.
    """

    start: int
    times_ns: NDArray[np.int64]
    stamps_ns: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.times_ns)

    @property
    def nbytes(self) -> int:
        """Bytes of its columns."""
        return sum(column.nbytes for column in self.columns().values())

    @property
    def key(self) -> tuple[Any, ...]:
        """The properties that the samples of a chunk share."""
        return ()

    def columns(self) -> dict[str, NDArray[Any]]:
        """Return the columns by name."""
        return {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}

    def sample(self, i: int) -> Any:
        """Return one of the samples."""
        raise NotImplementedError

    def part(self, rows: NDArray[np.int64] | slice, start: int) -> Self:
        """Return the chunk of some rows, with another start."""
        columns: Any = {name: frozen(column[rows]) for name, column in self.columns().items()}
        return replace(self, start=start, **columns)


@dataclass(frozen=True)
class ScanChunk(Chunk):
    """Consecutive scans with the same number of rays and the same geometry.

    Args:
        ranges: metres, shape (N, R), float32; NaN and infinities as in REP-117.
        intensities: device units, shape (N, R), float32; (N, 0) without intensities.
        like: one of the scans, for the properties that all share.
        echoes: the echoes of each scan of a scanner with several echoes, shape (N, 1), objects; (N, 0) for others.
    """

    ranges: NDArray[np.float32]
    intensities: NDArray[np.float32]
    like: Scan
    echoes: NDArray[np.object_]

    @property
    def angle_min(self) -> float:
        """Angle of ray 0 in radians."""
        return self.like.angle_min

    @property
    def angle_increment(self) -> float:
        """Angle from one ray to the next in radians."""
        return self.like.angle_increment

    @property
    def frame_id(self) -> str:
        """The frame of the scanner."""
        return self.like.frame_id

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
        """See `Chunk`."""
        return super().nbytes + sum(int(one.nbytes) for one in self.echoes.flat)

    @property
    def key(self) -> tuple[Any, ...]:
        """See `Chunk`."""
        s = self.like
        counts = (self.ranges.shape[1], self.intensities.shape[1], self.echoes.shape[1])
        return (
            *counts,
            s.angle_min,
            s.angle_increment,
            s.range_min,
            s.range_max,
            s.frame_id,
            s.header_problems,
            s.mount,
        )

    def sample(self, i: int) -> Scan:
        """See `Chunk`."""
        ranges, intensities = self.ranges[i], self.intensities[i]
        scan = self.like.again(ranges, intensities, int(self.stamps_ns[i]) or None)
        return scan.with_echoes(self.echoes[i, 0]) if self.echoes.shape[1] else scan


@dataclass(frozen=True)
class SpeedChunk(Chunk):
    """Consecutive speeds.

    Args:
        values: shape (N, 6), float64, in the order of `AXES`: linear in m/s, angular in rad/s.
        poses: shape (N, 3), float64: x, y in metres and yaw in radians, of odometry; (N, 0) without.
        frame_id: the frame in which they are expressed.
        steering: shape (N, 1), float64: steering angles in radians; (N, 0) without.
    """

    values: NDArray[np.float64]
    poses: NDArray[np.float64]
    frame_id: str
    steering: NDArray[np.float64]

    @property
    def key(self) -> tuple[Any, ...]:
        """See `Chunk`."""
        return (self.frame_id, self.poses.shape[1], self.steering.shape[1])

    def sample(self, i: int) -> Speed:
        """See `Chunk`."""
        x, y, z, roll, pitch, yaw = self.values[i].tolist()
        pose = Pose(*self.poses[i].tolist()) if self.poses.shape[1] else None
        steering = float(self.steering[i, 0]) if self.steering.shape[1] else None
        return Speed((x, y, z), (roll, pitch, yaw), int(self.stamps_ns[i]) or None, self.frame_id, pose, steering)


@dataclass(frozen=True)
class SampleChunk(Chunk):
    """Consecutive samples of any kind.

    Args:
        samples: shape (N,), objects.
    """

    samples: NDArray[np.object_]

    @property
    def nbytes(self) -> int:
        """Estimated size in bytes."""
        return _SAMPLE_BYTES * len(self)

    def sample(self, i: int) -> Any:
        """See `Chunk`."""
        return self.samples[i]


AnyChunk = TypeVar("AnyChunk", bound=Chunk)


def merged(chunks: Iterable[AnyChunk]) -> list[AnyChunk]:
    """Return the chunks, with consecutive ones of the same key joined."""
    return [join(list(run)) for _, run in groupby(chunks, key=lambda chunk: chunk.key)]


def join(chunks: list[AnyChunk]) -> AnyChunk:
    """Join several chunks with the same key."""
    first = chunks[0]
    if len(chunks) == 1:
        return first
    columns: Any = {name: np.concatenate([getattr(chunk, name) for chunk in chunks]) for name in first.columns()}
    return replace(first, **columns)


def compact(chunk: AnyChunk) -> AnyChunk:
    """Return the chunk with read-only columns; a column that is a small part of its buffer is copied."""
    columns: Any = {}
    for name, value in chunk.columns().items():
        columns[name] = value.copy() if _keeps_alive_more(value) else value.view()
        columns[name].flags.writeable = False
    return replace(chunk, **columns)


def _keeps_alive_more(column: NDArray[Any]) -> bool:
    """Return True if a column is a view that keeps a much larger buffer in memory."""
    base: Any = column
    while isinstance(base, np.ndarray) and base.base is not None:
        base = base.base
    return 2 * column.nbytes < memoryview(base).nbytes


def single_scan(scan: Scan, time_ns: int) -> ScanChunk:
    """Return a chunk of one scan."""
    times, stamps = np.array([[time_ns], [scan.stamp_ns or 0]], np.int64)
    echoes = np.empty((1, 1 if scan.echoes else 0), object)
    echoes[:] = scan.echoes
    return ScanChunk(0, times, stamps, scan.ranges[None], scan.intensities[None], scan, echoes)


def single_speed(speed: Speed, time_ns: int) -> SpeedChunk:
    """Return a chunk of one speed."""
    times, stamps = np.array([[time_ns], [speed.stamp_ns or 0]], np.int64)
    angle = () if speed.steering is None else (speed.steering,)
    values, poses, steering = (np.array([numbers], np.float64) for numbers in (speed.values, speed.pose or (), angle))
    return SpeedChunk(0, times, stamps, values, poses, speed.frame_id, steering)

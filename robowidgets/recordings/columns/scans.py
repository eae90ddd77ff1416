"""Scans as columns."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...kinds import Kind
from ...messages.channel import Channel
from ...repair import RecordingError
from ...samples import Scan
from ...samples.distances import distances, ray_distances
from ...samples.sector import ALL_ROUND, SectorLike
from ...samples.spread import readings, spread_of
from ..times import span_ns
from . import tables
from ._decoders import ScanDecoder
from .chunks import ScanChunk
from .series import Series

if TYPE_CHECKING:
    from typing_extensions import Self


class Scans(Series[Scan]):
    """The scans of a topic as columns; see `Series` for the ways to select from them.

    If the scanner changes its number of rays, ``ranges`` raises an error, and `groups` returns one series for each
    number.

    Examples:
        >>> scans = recording.scans("/scan")  # doctest: +SKIP
        >>> scans.between(20, 25).distances("front").min()  # doctest: +SKIP
    """

    @staticmethod
    def decoder(channel: Channel, _kind: Kind) -> ScanDecoder:
        """See `Series`."""
        return ScanDecoder(channel)

    @cached_property
    def ray_counts(self) -> dict[int, int]:
        """The number of scans for each number of rays, in the order of their first scans."""
        rays, first, counts = np.unique(self._rays, return_index=True, return_counts=True)
        return {int(rays[i]): int(counts[i]) for i in np.argsort(first)}

    @property
    def groups(self) -> tuple[Self, ...]:
        """A series for each number of rays, in the order of their first scans."""
        if len(self.ray_counts) < 2:
            return (self,)
        rays = self._rays
        return tuple(self._with(self._row_numbers[rays == count]) for count in self.ray_counts)

    @property
    def ray_count(self) -> int:
        """R, the number of rays of each scan.

        Raises:
            RecordingError: the number changes.
        """
        if len(self.ray_counts) > 1:
            counts = ", ".join(f"{scans:,} with {rays:,} rays" for rays, scans in self.ray_counts.items())
            raise RecordingError(
                f"{self.topic}: its scans do not form one array, because their number of rays changes: {counts}; "
                ".groups has one series for each number"
            )
        return next(iter(self.ray_counts), 0)

    @property
    def ranges(self) -> NDArray[np.float32]:
        """Metres as the scanner sent them, shape (N, R), a row for each scan; NaN, infinities and codes such as 0.0.

        Their minimum is not the distance to the nearest obstacle: see `distances` and `ray_distances`.

        Raises:
            RecordingError: the number of rays changes, or the array would be larger than `Recording.memory`.
        """
        return self._of_rays("ranges", self.ray_count, lambda chunk: chunk.ranges)

    def distances(self, sector: SectorLike = ALL_ROUND, *, percentile: float | None = None) -> NDArray[np.float32]:
        """Return `Scan.distance` of each scan, shape (N,): metres, inf nothing in range, 0 too close, NaN unknown.

        Args:
            sector: as in `Scan.distance`.
            percentile: as in `Scan.distance`.

        Raises:
            TypeError: as in `Scan.distance`.
            ValueError: as in `Scan.distance`.
        """
        parts = [distances(chunk.ranges, chunk.like, sector, percentile) for chunk in self.chunks()]
        return np.concatenate([np.empty(0, np.float32), *parts])

    @property
    def ray_distances(self) -> np.ma.MaskedArray[Any, np.dtype[np.float32]]:
        """The distance of each ray as in `Scan.distance`, shape (N, R); masked if unknown, as for NaN and codes.

        ``ray_distances[:, rays].min(axis=1)`` is the distance within some of the rays.

        Raises:
            RecordingError: as `ranges`.
        """
        away = self._of_rays("ray_distances", self.ray_count, lambda chunk: ray_distances(chunk.ranges, chunk.like))
        return np.ma.masked_array(away, np.isnan(away), fill_value=np.nan)

    def spread(self) -> NDArray[np.float32]:
        """Return the scatter of the readings of each ray over these scans: metres, shape (R,); see `samples.spread`.

        Raises:
            RecordingError: as `ranges`.

        Examples:
            >>> recording.scans("/scan")[-50:].spread()  # doctest: +SKIP
        """
        columns = self._of_rays("spread", self.ray_count, lambda chunk: readings(chunk.ranges, chunk.like))
        return spread_of(columns)

    @property
    def intensities(self) -> NDArray[np.float32]:
        """Intensities in device units, shape (N, R), or (N, 0) if no scan has any; NaN for scans without intensities.

        Raises:
            RecordingError: as `ranges`.
        """
        rays = self.ray_count
        sent = any(chunk.intensities.shape[1] for chunk in self.chunks())
        return self._of_rays("intensities", rays if sent else 0, lambda chunk: chunk.intensities)

    @property
    def angle_min(self) -> NDArray[np.float64]:
        """Angle of ray 0 in radians, shape (N,)."""
        return self._setting("angle_min")

    @property
    def angle_increment(self) -> NDArray[np.float64]:
        """Angle from one ray to the next in radians, shape (N,)."""
        return self._setting("angle_increment")

    @property
    def range_min(self) -> NDArray[np.float64]:
        """Metres, shape (N,); see `Scan`."""
        return self._setting("range_min")

    @property
    def range_max(self) -> NDArray[np.float64]:
        """Metres, shape (N,); see `Scan`."""
        return self._setting("range_max")

    @property
    def angles(self) -> NDArray[np.float64]:
        """Angles of all rays in radians, shape (R,).

        Raises:
            RecordingError: the geometry changes from scan to scan.
        """
        rays = self.ray_count
        kinds = {(chunk.angle_min, chunk.angle_increment) for chunk in self.chunks()}
        if len(kinds) > 1:
            raise RecordingError(
                f"{self.topic}: its scans have no common angles, because their geometry changes ({len(kinds)} kinds): "
                "see .angle_min and .angle_increment, or the angles of each scan"
            )
        angle_min, increment = next(iter(kinds), (0.0, 0.0))
        return np.asarray(angle_min + np.arange(rays) * increment, np.float64)

    def between(self, start: float | None = None, end: float | None = None) -> Self:
        """See `Series`. If the topic was not read yet, only these scans are read."""
        if self._rows is not None or self.is_read or (start is None and end is None):
            return super().between(start, end)
        part = type(self)(self._store.between(*span_ns(self._start_ns, start, end)), self._start_ns)
        len(part)  # reads now, so that the scans in memory stay available after the recording is closed
        return part

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Return times, ranges and intensities by name."""
        return {**super().to_numpy(), "ranges": self.ranges, "intensities": self.intensities}

    def to_pandas(self) -> Any:
        """See `Series`: the ranges, with a column for each ray."""
        return tables.rays_to_pandas(self.to_numpy())

    @property
    def _rays(self) -> NDArray[np.int64]:
        places = self._store.places
        every = np.repeat([place.rays for place in places], [place.rows for place in places]).astype(np.int64)
        return self._picked(every)

    def _setting(self, name: str) -> NDArray[np.float64]:
        parts = [np.full(len(chunk), getattr(chunk, name)) for chunk in self.chunks()]
        return np.concatenate([np.empty(0), *parts])

    def _of_rays(self, name: str, rays: int, column: Callable[[ScanChunk], NDArray[np.float32]]) -> NDArray[np.float32]:
        return self._array(
            name,
            rays,
            np.float32,
            lambda chunk: values if (values := column(chunk)).shape[1] == rays else np.float32(np.nan),
        )

    def _title(self) -> str:
        rays = " or ".join(f"{count:,}" for count in self.ray_counts)
        return f"{super()._title()}{f' of {rays} rays' if rays else ''}"

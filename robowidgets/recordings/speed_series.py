"""Speeds as columns."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..samples import AXES, Speed
from .chunks import SpeedChunk
from .rows import chunks_of, filled
from .series import Rows, Series
from .store import Store

if TYPE_CHECKING:
    from typing_extensions import Self


class Speeds(Series[Speed]):
    """The speeds of a topic as columns; see `Series` for how to pick some of them.

    Example:
        >>> speeds = recording.speeds("/odom")  # doctest: +SKIP
        >>> speeds.linear[:, 0].max()  # doctest: +SKIP
    """

    def __init__(self, store: Store[SpeedChunk], start_ns: int, rows: Rows | None = None) -> None:
        self._store = store
        self._start_ns = start_ns
        self._rows = rows

    @property
    def topic(self) -> str:
        """The name of the topic."""
        name: str = self._store.feed.name
        return name

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """The times that the messages bear, in nanoseconds, shape (N,); 0 where they bear none."""
        return self._picked(self._store.stamps_ns)

    @property
    def values(self) -> NDArray[np.float64]:
        """All six numbers, shape (N, 6), in the order of `AXES`; NaN where there is no value.

        Raises:
            RecordingError: the array would be larger than `Recording.memory`.
        """
        return filled(
            self._store,
            self.chunks(),
            (len(self), len(AXES)),
            np.dtype(np.float64),
            lambda chunk: chunk.values,
            f"{self.topic}: the array of all speeds",
        )

    @property
    def linear(self) -> NDArray[np.float64]:
        """X forward, y left, z up, in m/s, shape (N, 3)."""
        return self.values[:, :3]

    @property
    def angular(self) -> NDArray[np.float64]:
        """About x, y and z (yaw, counter-clockwise), in rad/s, shape (N, 3)."""
        return self.values[:, 3:]

    def chunks(self) -> Iterator[SpeedChunk]:
        """The columns piece by piece; ``start`` of a piece counts within this series."""
        yield from chunks_of(self._store, self._rows)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Times, and the six numbers by the names in `AXES`."""
        times = {"times_ns": self.times_ns, "seconds": self.seconds, "stamps_ns": self.stamps_ns}
        return {**times, **dict(zip(AXES, self.values.T, strict=True))}

    @property
    def _all_times(self) -> NDArray[np.int64]:
        return self._store.times_ns

    def _with(self, rows: Rows) -> Self:
        return type(self)(self._store, self._start_ns, rows)

    def _sample(self, row: int) -> Speed:
        return next(self._store.chunks(row, row + 1)).sample(0)

    def _samples(self) -> Iterator[tuple[int, Speed]]:
        for chunk in self.chunks():
            for i, time_ns in enumerate(chunk.times_ns.tolist()):
                yield time_ns, chunk.sample(i)

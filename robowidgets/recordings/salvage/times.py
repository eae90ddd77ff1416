"""Which messages there are, by time."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Times:
    """The log times of messages and what channel each belongs to, sorted by time; equal times keep their order.

    Args:
        times: M log times in nanoseconds, any order.
        channels: M ids of channels.
        known: the channels that count; messages of others are left out.

    """

    def __init__(self, times: ArrayLike, channels: ArrayLike, known: Collection[int]) -> None:
        times, channels = np.asarray(times, np.int64), np.asarray(channels, np.int64)
        order = np.argsort(times, kind="stable")
        self._order: NDArray[np.intp] = order[np.isin(channels[order], list(known))]
        self._times: NDArray[np.int64] = times[self._order]
        self._channels: NDArray[np.int64] = channels[self._order]

    def __len__(self) -> int:
        return int(self._times.size)

    @property
    def start_ns(self) -> int | None:
        """Log time of the first message; None when there is none."""
        return int(self._times[0]) if self._times.size else None

    @property
    def end_ns(self) -> int | None:
        """Log time of the last message; None when there is none."""
        return int(self._times[-1]) if self._times.size else None

    def counts(self) -> dict[int, int]:
        """How many messages each channel has."""
        ids, counts = np.unique(self._channels, return_counts=True)
        return dict(zip(ids.tolist(), counts.tolist(), strict=True))

    def rows(
        self, channels: Collection[int], start_ns: int | None, stop_ns: int | None
    ) -> Iterator[tuple[int, int, int]]:
        """Row, channel and log time of the messages of some channels within some time, by time."""
        first = 0 if start_ns is None else self._before(start_ns)
        stop = self._times.size if stop_ns is None else self._before(stop_ns)
        wanted = first + np.flatnonzero(np.isin(self._channels[first:stop], list(channels)))
        for at in wanted:
            yield int(self._order[at]), int(self._channels[at]), int(self._times[at])

    def stretches(self, channels: Collection[int], sizes: Sequence[int], most: int) -> Iterator[list[int]]:
        """The rows of the messages of some channels, in the order of the file, in parts of about so many bytes."""
        rows = np.sort(self._order[np.isin(self._channels, list(channels))])
        parts = np.cumsum(np.asarray(sizes, np.int64)[rows]) // most
        for part in np.split(rows, np.flatnonzero(np.diff(parts)) + 1):
            if part.size:
                yield part.tolist()

    def _before(self, time_ns: int) -> int:
        """How many messages were logged before a time."""
        limits = np.iinfo(np.int64)
        if time_ns > limits.max:
            return int(self._times.size)
        return int(np.searchsorted(self._times, max(time_ns, limits.min), side="left"))

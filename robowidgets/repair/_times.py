"""Which messages there are, by time and in the order of arrival."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .source import Arrivals


class Times:
    """The log times of messages and what channel each belongs to, sorted by time; equal times keep their order.

    Args:
        times: M log times in nanoseconds, in the order of arrival.
        channels: M ids of channels.
        known: the channels that count; messages of others are left out.

    """

    def __init__(self, times: ArrayLike, channels: ArrayLike, known: Collection[int]) -> None:
        self._all_times: NDArray[np.int64] = np.asarray(times, np.int64)
        self._all_channels: NDArray[np.int64] = np.asarray(channels, np.int64)
        self._known = np.isin(self._all_channels, list(known))
        self._sort()

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

    def arrivals(self) -> Arrivals:
        """Of every message that counts."""
        return Arrivals(self._all_times[self._known], self._all_channels[self._known])

    def last(self, channel: int) -> int | None:
        """The last log time of a channel; None when it has none."""
        times = self._times[self._channels == channel]
        return int(times[-1]) if times.size else None

    def retime(self, times: NDArray[np.int64]) -> None:
        """Take other times for all `arrivals`."""
        self._all_times = self._all_times.copy()
        self._all_times[self._known] = times
        self._sort()

    def of(self, row: int) -> int:
        """The log time of one of the M messages."""
        return int(self._all_times[row])

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

    def _sort(self) -> None:
        order = np.argsort(self._all_times, kind="stable")
        self._order: NDArray[np.intp] = order[self._known[order]]
        self._times: NDArray[np.int64] = self._all_times[self._order]
        self._channels: NDArray[np.int64] = self._all_channels[self._order]

    def _before(self, time_ns: int) -> int:
        """How many messages were logged before a time."""
        limits = np.iinfo(np.int64)
        if time_ns > limits.max:
            return int(self._times.size)
        return int(np.searchsorted(self._times, max(time_ns, limits.min), side="left"))

"""What sources have in common that know each of their messages."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._records import Damage
from ._report import problems
from ._times import Times
from .source import Arrivals, Channel


class Known:
    """Part of a `SavedSource`.

    Args:
        times: M log times in nanoseconds, in the order of arrival.
        ids: M ids of channels.
        channels: every channel that is named, counts not yet known; messages of others are left out.
        damage: what was wrong.
    """

    def __init__(self, times: ArrayLike, ids: ArrayLike, channels: Collection[Channel], damage: Damage) -> None:
        self._times = Times(times, ids, {channel.id for channel in channels})
        self._damage = damage
        self._more: tuple[str, ...] = ()
        counts = self._times.counts()
        self.channels = tuple(channel._replace(count=counts.get(channel.id, 0)) for channel in channels)
        damage.unnamed = np.size(times) - len(self._times)

    @property
    def start_ns(self) -> int | None:
        """See `Source`."""
        return self._times.start_ns

    @property
    def end_ns(self) -> int | None:
        """See `Source`."""
        return self._times.end_ns

    @property
    def problems(self) -> tuple[str, ...]:
        """See `Source`."""
        span_ns = (self.end_ns or 0) - (self.start_ns or 0)
        return (*problems(self._damage, len(self._times), span_ns), *self._more)

    def arrivals(self) -> Arrivals:
        """See `Source`: every message."""
        return self._times.arrivals()

    def last_ns(self, channel: Channel) -> int | None:
        """See `Source`."""
        return self._times.last(channel.id)

    def retime(self, times: NDArray[np.int64], why: str) -> None:
        """See `SavedSource`."""
        self._times.retime(times)
        self._more += (why,) if why else ()

"""The chunks of columns of a CARMEN log."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from ..recordings.chunks import ScanChunk, SpeedChunk, merged, single_scan, single_speed
from ..recordings.timeline import Moment
from ..samples import Scan, Speed

_PAGE = 500


class CarmenFeed:
    """See `store.Feed`: chunks of the lines of one name.

    Args:
        name: the topic.
        places: which lines of the log.
        read: the moment in a line; None when it cannot be shown.
    """

    def __init__(self, name: str, places: Sequence[int], read: Callable[[int], Moment | None]) -> None:
        self.name = name
        self.total = len(places)
        self._places = places
        self._read = read

    def pages(self) -> Iterator[Callable[[], list[int]]]:
        """See `store.Feed`. The lines are in memory: there is nothing to read ahead."""
        for at in range(0, len(self._places), _PAGE):
            yield partial(list, self._places[at : at + _PAGE])

    def decode(self, page: list[int]) -> list[ScanChunk] | list[SpeedChunk]:
        """See `store.Feed`."""
        moments = [moment for place in page if (moment := self._read(place))]
        scans = [single_scan(m.sample, m.time_ns) for m in moments if isinstance(m.sample, Scan)]
        speeds = [single_speed(m.sample, m.time_ns) for m in moments if isinstance(m.sample, Speed)]
        return merged(scans) or merged(speeds)

    def distrust(self, error: Exception) -> bool:
        """See `store.Feed`: nothing is read any more, so nothing can fail for the disk's sake."""
        raise error

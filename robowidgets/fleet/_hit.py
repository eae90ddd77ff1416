"""One result of a search through many recordings."""

from __future__ import annotations

from datetime import datetime
from typing import NamedTuple

from ._fleet_table import date_of


class Hit(NamedTuple):
    """A span in which the condition was true: the recording, the topics that were read, and the fields of a `Span`."""

    file: str
    topic: str
    start: float
    end: float
    seconds: float
    start_ns: int
    end_ns: int
    silent: tuple[str, ...] = ()
    nearest: float | None = None
    index: int | None = None  # type: ignore[assignment]  # as ROS calls it; it hides tuple.index
    angle: float | None = None
    nearest_ns: int | None = None
    value: float | None = None
    value_ns: int | None = None

    @property
    def date(self) -> datetime | None:
        """Date and time of its start, in UTC, or None if the clock of the recording has no date."""
        return date_of(self.start_ns)

    @property
    def moment(self) -> float:
        """The shown time in seconds: the first in the span with the nearest reading or the value, or else the start."""
        at_ns = self.value_ns if self.nearest_ns is None else self.nearest_ns
        # A sample that came before the span holds from its start on.
        return self.start if at_ns is None else self.start + max(0, at_ns - self.start_ns) / 1e9

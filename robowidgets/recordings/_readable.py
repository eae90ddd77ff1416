"""The interface of a recording for readers in this part, which `RecordingData` imports."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Protocol

from ..repair import Source
from .columns._fields import Fields
from .columns.scans import Scans
from .columns.speeds import Speeds
from .columns.touches import Touches
from .events import Events
from .topics import Moment, TimedMessage, Topic


class ReadableRecording(Protocol):
    """The part of `RecordingData` that other modules of this part read; see there for each member."""

    @property
    def path(self) -> Path:
        """The file or the folder."""

    @property
    def source(self) -> Source:
        """The messages as the file has them."""

    @property
    def start_ns(self) -> int | None:
        """The time of the first message."""

    @property
    def duration(self) -> float:
        """Seconds from the first message to the last."""

    @property
    def topics(self) -> tuple[Topic, ...]:
        """The topics."""

    def samples(
        self, topics: str | Iterable[str] | None = None, start: float | None = None, end: float | None = None
    ) -> Iterator[Moment]:
        """Yield the samples, one by one."""

    def messages(self, topic: str, start: float | None = None, end: float | None = None) -> Iterator[TimedMessage]:
        """Yield the messages of a topic, one by one."""

    def events(
        self,
        *topics: str,
        level: str | int | None = None,
        text: str | None = None,
        start: float | None = None,
        end: float | None = None,
    ) -> Events:
        """Return the events as a table."""

    def scans(self, topic: str | None = None) -> Scans:
        """Return the scans of a topic as columns."""

    def speeds(self, topic: str | None = None) -> Speeds:
        """Return the speeds of a topic as columns."""

    def touches(self, topic: str | None = None) -> Touches:
        """Return the touches of a topic as columns."""

    def fields(self, topic: str) -> Fields:
        """Return the fields of the messages of a topic as columns."""

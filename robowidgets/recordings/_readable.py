"""A recording, for what reads it within this part: `RecordingData`, before that class is there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Protocol

from .columns._fields import Fields
from .columns.scans import Scans
from .columns.speeds import Speeds
from .columns.touches import Touches
from .events import Events
from .topics import Moment, TimedMessage, Topic


class ReadableRecording(Protocol):
    """See `RecordingData`, which describes each of these."""

    @property
    def path(self) -> Path:
        """The file or the folder."""

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
        """The samples, one by one."""

    def messages(self, topic: str, start: float | None = None, end: float | None = None) -> Iterator[TimedMessage]:
        """The messages of a topic, one by one."""

    def events(
        self,
        *topics: str,
        level: str | int | None = None,
        text: str | None = None,
        start: float | None = None,
        end: float | None = None,
    ) -> Events:
        """What happened, as a table."""

    def scans(self, topic: str | None = None) -> Scans:
        """The scans of a topic as columns."""

    def speeds(self, topic: str | None = None) -> Speeds:
        """The speeds of a topic as columns."""

    def touches(self, topic: str | None = None) -> Touches:
        """The touches of a topic as columns."""

    def fields(self, topic: str) -> Fields:
        """The fields of the messages of a topic as columns."""

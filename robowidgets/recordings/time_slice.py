"""A slice: the samples of a recording within a span."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from ..samples.time_span import time_span
from ._readable import ReadableRecording
from .columns._fields import Fields
from .columns.scans import Scans
from .columns.speeds import Speeds
from .columns.touches import Touches
from .cut import cut
from .events import Events
from .span import Span
from .times import span_ns
from .topics import Moment, TimedMessage, Topic

_MOMENT = 1e-9


class TimeSlice:
    """The samples of a recording within a span, read one by one: ``recording[start:end]``.

    Iterating over it yields the samples as `samples` does, any number of times.

    Args:
        recording: the recording.
        which: a slice of seconds from the start as in ``recording[2:5]``, a `ScanogramWidget.selection`, or a span of
            `Recording.find`. A span of 0 seconds selects the samples at that moment. A selection or a span that lasts
            to the end of the recording includes its last sample.

    ``start`` and ``end`` are seconds from the start, the end not included, or None if the slice is open. ``rays`` is a
    slice of the selected rays, or of all rays without a selection: ``scan.ranges[part.rays]``. The samples themselves
    keep all their rays, so that an index always means the same.

    Raises:
        TypeError: ``which`` has another type. ValueError: it is not a span of time.
    """

    def __init__(self, recording: ReadableRecording, which: Any) -> None:
        self._recording = recording
        self.rays = slice(None)
        self.start: float | None
        self.end: float | None
        if isinstance(which, slice) and which.step is None:
            self.start, self.end = which.start, which.stop
            span_ns(recording.start_ns, self.start, self.end)  # raises
            return
        if isinstance(which, Span):
            self.start, end = which.start, max(which.end, which.start + _MOMENT)
        elif isinstance(which, (tuple, list)):
            self.start, end, *rays = time_span("recording[...]", which, rays=True)
            if rays:
                self.rays = slice(*rays)
        else:
            raise TypeError(f"recording[...]: expected seconds, as [2:5], a selection or a span; got {which!r}")
        self.end = None if end >= recording.duration else end

    @property
    def recording(self) -> ReadableRecording:
        """The whole recording."""
        return self._recording

    def samples(self, topics: str | Iterable[str] | None = None) -> Iterator[Moment]:
        """Yield the samples in the span, as in `Recording.samples`."""
        return self._recording.samples(topics, self.start, self.end)

    def scans(self, topic: str | None = None) -> Scans:
        """Return the scans in the span as columns, as in `Recording.scans`."""
        return self._recording.scans(topic).between(self.start, self.end)

    def speeds(self, topic: str | None = None) -> Speeds:
        """Return the speeds in the span as columns, as in `Recording.speeds`."""
        return self._recording.speeds(topic).between(self.start, self.end)

    def touches(self, topic: str | None = None) -> Touches:
        """Return the touches in the span as columns, as in `Recording.touches`."""
        return self._recording.touches(topic).between(self.start, self.end)

    def messages(self, topic: str) -> Iterator[TimedMessage]:
        """Yield the messages of a topic of any type in the span, as in `Recording.messages`."""
        return self._recording.messages(topic, self.start, self.end)

    def events(self, *topics: str, level: str | int | None = None, text: str | None = None) -> Events:
        """Return the events in the span as a table, as in `Recording.events`."""
        return self._recording.events(*topics, level=level, text=text, start=self.start, end=self.end)

    @property
    def topics(self) -> tuple[Topic, ...]:
        """The topics of the recording, also those without a sample in the span."""
        return self._recording.topics

    def fields(self, topic: str) -> Fields:
        """Return the messages of a topic of any type in the span as columns, as in `Recording.fields`."""
        return self._recording.fields(topic).between(self.start, self.end)

    def to_mcap(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write the slice as an MCAP file for any tool, with the messages of all topics unchanged.

        Before them, at the start, come the messages that still hold there: /tf_static, and the last one of each latched
        topic, map, robot description and program. The file appears once it is complete.

        Args:
            path: the file, such as ``"cut.mcap"``.
            overwrite: True to replace an existing file.

        Returns:
            The path of the file.

        Raises:
            FileExistsError: the file exists. TypeError, ValueError: the path does not name an MCAP file, or the slice
                has no message. OSError, RecordingError: the file cannot be written, or the recording is closed.

        Examples:
            >>> recording[2:5].to_mcap("cut.mcap")  # doctest: +SKIP
        """
        recording = self._recording
        span = span_ns(recording.start_ns, self.start, self.end)
        return cut(recording.source, recording.path, "to_mcap", path, span, overwrite)

    def __iter__(self) -> Iterator[Moment]:
        return self.samples()

    def __repr__(self) -> str:
        start = 0.0 if self.start is None else self.start
        end = self._recording.duration if self.end is None else self.end
        return f"{self._recording.path.name} from {start:.2f} to {end:.2f} s"

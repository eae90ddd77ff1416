"""The events of a recording in its player: all rows at once, and the marks of errors and warnings."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from math import nan

from ..events_widget import MOST_CHARACTERS, MOST_TEXT, EventsWidget
from ..kinds.choice import WidgetChoice
from ..messages.event import LOG_TYPES, SEVERE_TYPES
from ..recordings import RecordingData
from ..recordings.events import mark_text
from ..recordings.program_log import PROGRAM, STATES
from ..runtime.text import many
from ..samples.event import Level
from ..samples.event_log import EventLog, EventRow, shortened, thinned
from ..touch.marks import Mark, joined
from ..touch.row import TOUCH
from ..tracks import BEFORE
from ..widget.timed_frame import FRAME_HEADER, TimedFrame

MOST_ROWS = 5000
"""The maximum number of rows of a recording that the page gets."""

MOST_LINES = 50_000
"""The approximate maximum number of log lines below a warning that are read; of more, evenly chosen ones."""

MARKED = Level.WARN
"""The lowest level that is marked when a player begins, so that the bar stays readable."""


class EventFrames:
    """A `Track` of the events of a recording. The page has all rows, so each frame contains only a time.

    In addition to the requested topics it has the touches of the robot, and the events of its program.
    """

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: EventsWidget) -> None:
        self._widget = widget
        if not widget.shows_whole:
            rows, notes = _rows_of(recording, choice.topics)
            widget.show_whole(rows, recording.duration, notes)
        self._times = [row.seconds for row in widget.rows]

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        first, stop = bisect_right(self._times, start), bisect_right(self._times, end)
        before = self._times[first - 1] if first else BEFORE
        for seconds in (before, *self._times[first:stop]):
            about, frame = self._widget.frame_at(max(seconds, start))
            yield TimedFrame(seconds, about, FRAME_HEADER.pack(0.0, nan, 0, 0.0) + frame)

    def seek(self, seconds: float) -> None:
        """See `Track`."""
        self._widget.show_moment(seconds)


def event_marks(recording: RecordingData) -> list[Mark]:
    """Return start, end and text of the errors and warnings, in seconds from the start."""
    topics = [topic.name for topic in recording.topics if topic.type in SEVERE_TYPES and not topic.problem]
    marks = []
    for at_ns, event in recording.timed_events(topics, every_line=0) if topics else ():
        if event.level >= MARKED:
            seconds = (at_ns - (recording.start_ns or 0)) / 1e9
            marks.append((seconds, seconds, mark_text(event.level, event.source, event.text)))
    return joined(marks)


def _rows_of(recording: RecordingData, topics: Sequence[str]) -> tuple[Sequence[EventRow], list[str]]:
    """Return the rows for the page, and notes on the rows that are left out."""
    also = [topic.name for topic in recording.topics if topic.widget == TOUCH.name or _is_of_program(topic.name)]
    log, notes = EventLog(None, MOST_TEXT, None), []
    start_ns = recording.start_ns or 0
    lines = sum(topic.count for topic in recording.topics if topic.name in topics and topic.type in LOG_TYPES)
    every = -(-lines // MOST_LINES) or 1
    for at_ns, event in recording.timed_events(dict.fromkeys((*topics, *also)), every_line=every):
        log.add(event, (at_ns - start_ns) / 1e9)
    if every > 1:
        left = f"1 of {every} lines below a warning in {lines:,}, and all others"
        notes.append(f"{left}; recording.events() has all")
    rows = sorted(log.rows, key=lambda row: row.seconds)
    kept = thinned(rows, MOST_ROWS)
    if len(kept) < len(rows):
        left = f"{len(kept):,} of {many(len(rows), 'row')}: errors and warnings first, the others evenly chosen"
        notes.append(f"{left}; recording.events() has all")
    return shortened(kept, 2 * MOST_CHARACTERS), notes


def _is_of_program(topic: str) -> bool:
    return topic == PROGRAM or topic.startswith(STATES)


def marks_of(*kinds: Iterable[Mark]) -> list[Mark]:
    """Return marks of several kinds in the order of time."""
    return sorted(mark for marks in kinds for mark in marks)

"""The touches of the robot, as the marks with which a player begins."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ..recordings import RecordingData
from ..runtime.text import listed
from ..scanogram.of_recording import touched

MOST_READ = 20_000
"""The maximum number of touch messages that are read, because that takes time. With more, a player has no such marks.
"""

MOST = 200
"""The maximum number of marks; of more, the closest are joined."""

_MOST_NAMES = 6
"""The maximum number of names in the text of a mark; of more, the number is given."""

_APART = 0.5
"""Seconds between two marks: a touch that follows sooner is part of the same bump."""

Mark = tuple[float, float, str]


def touch_marks(recording: RecordingData, topics: Sequence[str]) -> list[Mark]:
    """Return start, end, and the names of the sensors of each bump, in seconds from the start.

    Args:
        recording: the recording.
        topics: its topics with touches.
    """
    if sum(topic.count for topic in recording.topics if topic.name in topics) > MOST_READ:
        return []
    return joined(span for topic in topics for span in touched(recording.touches(topic), recording.duration))


def joined(marks: Iterable[Mark]) -> list[Mark]:
    """Return marks in which marks that follow each other closely are joined."""
    spans, apart = sorted(marks), _APART
    while len(found := list(_bumps(spans, apart))) > MOST:
        apart *= 2
    return found


def _bumps(spans: Sequence[Mark], apart: float) -> Iterator[Mark]:
    """Yield the spans; spans that overlap or follow each other within so many seconds are joined."""
    start = end = 0.0
    names: dict[str, None] = {}
    for first, last, name in spans:
        if names and first - end > apart:
            yield start, end, listed(list(names), _MOST_NAMES)
            names = {}
        start, end = (start, max(end, last)) if names else (first, last)
        names[name] = None
    if names:
        yield start, end, listed(list(names), _MOST_NAMES)

"""The events of a recording as a table: log lines, changes of status, pressed buttons, and touches."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import inf
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from ..kinds import kind_of_class
from ..messages.event import REPEATED_TYPES, SAID_TYPES, EventReader
from ..runtime.tables import HasTable, Table
from ..runtime.text import many
from ..samples import Touch
from ..samples.event import Event, Level
from .columns.tables import Columns
from .program_log import PROGRAM, STATES, version_of
from .topics import TimedMessage, Topic

_SHOWN = 20
_LONGEST = 100
"""Characters of a text in the printed table."""


class RecordedEvent(NamedTuple):
    """An event of a recording: its time in seconds from the start and by the clock, its source and its text.

    ``stamp_ns`` is the time in the message in nanoseconds, or 0 if it has none.
    """

    seconds: float
    level: Level
    source: str
    text: str
    topic: str
    time_ns: int
    stamp_ns: int


class Events(HasTable, Columns, Sequence[RecordedEvent]):
    """A table of events. Printed, it shows the first ones.

    Args:
        events: the events in the order of time.
        about: the filters, for the heading.
    """

    def __init__(self, events: Sequence[RecordedEvent], about: str = "") -> None:
        self._events = tuple(events)
        self._about = about

    @property
    def marks(self) -> list[tuple[float, float, str]]:
        """Start, end and text of a mark for each event, for ``player.marks``."""
        return [(one.seconds, one.seconds, mark_text(one.level, one.source, one.text)) for one in self]

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Return the columns by name; times as ``times_ns``, ``seconds`` and ``stamps_ns``, levels as words."""
        texts = {
            "level": [one.level.name for one in self],
            "source": [one.source for one in self],
            "text": [one.text for one in self],
            "topic": [one.topic for one in self],
        }
        columns: dict[str, NDArray[Any]] = {
            "times_ns": np.array([one.time_ns for one in self], np.int64),
            "seconds": np.array([one.seconds for one in self], np.float64),
            "stamps_ns": np.array([one.stamp_ns for one in self], np.int64),
        }
        for name, values in texts.items():
            columns[name] = np.empty(len(self), object)
            columns[name][:] = values
        return columns

    def __len__(self) -> int:
        return len(self._events)

    @overload
    def __getitem__(self, which: int) -> RecordedEvent: ...
    @overload
    def __getitem__(self, which: slice) -> Events: ...
    def __getitem__(self, which: int | slice) -> RecordedEvent | Events:
        return Events(self._events[which], self._about) if isinstance(which, slice) else self._events[which]

    def __iter__(self) -> Iterator[RecordedEvent]:
        return iter(self._events)

    def _table(self) -> Table:
        rows = [
            (f"{one.seconds:.2f}", one.level.name, one.source, one_line(one.text, _LONGEST), one.topic)
            for one in self._events[:_SHOWN]
        ]
        more = [f"  ... and {len(self) - _SHOWN:,} more"] if len(self) > _SHOWN else []
        heading = f"{many(len(self), 'event')}{self._about}"
        return Table(heading, ("seconds", "level", "source", "text", "topic"), rows, right=[0], notes=more)


def one_line(text: str, most: int) -> str:
    """Return a text as one line, cut after so many characters."""
    line = " ".join(text[: 4 * most].split())
    return line if len(line) <= most and len(text) <= 4 * most else f"{line[: most - 1]}…"


def mark_text(level: Level, source: str, text: str) -> str:
    """Return the text of the mark of an event."""
    return ": ".join(filter(None, (level.name if level >= Level.WARN else "", source, one_line(text, 80))))


def has_events(topic: Topic, *, by_name: bool = False) -> bool:
    """Return True if a topic has events. A topic that repeats itself counts only if the user names it."""
    types = SAID_TYPES if by_name else SAID_TYPES - REPEATED_TYPES
    return not topic.problem and (topic.type in types or topic.widget == kind_of_class(Touch).name)


def read_events(messages: Iterable[TimedMessage], note: Any = None, ends: bool = True) -> Iterator[tuple[int, Event]]:
    """Yield the events in messages of several topics, each with its time; the end of a touch comes a moment late.

    Args:
        messages: in the order of time.
        note: called with the topic, the time and the error of a message that cannot be understood, or None to raise the
            error.
        ends: True if touches that have not ended end after the last message.
    """
    readers: dict[str, EventReader] = {}
    states: dict[str, str] = {}
    for moment in messages:
        topic = moment.topic
        try:
            if topic == PROGRAM:
                version = version_of(moment.seconds, moment.message.data)
                text = f"version {version.number}" if version.number else "another version"
                yield moment.time_ns, Event(text, source=version.name, topic=topic)
            elif topic.startswith(STATES):
                name = moment.message.data
                if name and states.get(topic) != name:
                    source = topic.removeprefix(STATES).replace("/", " › ")
                    yield moment.time_ns, Event(f"→ {name}", source=source, topic=topic)
                states[topic] = name
            else:
                reader = readers.get(topic) or readers.setdefault(topic, EventReader(topic))
                yield from reader.read(moment.message, moment.time_ns)
        except (TypeError, ValueError) as error:
            if note is None:
                raise
            note(topic, moment.time_ns, error)
    if ends:
        for reader in readers.values():
            yield from reader.due(inf)

"""Events as rows of a list: equal ones that follow each other are one row, and the oldest are forgotten."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import inf
from typing import NamedTuple

from .event import Event, Level

_LONGEST_NAME = 200
"""Characters of the names of sources and topics that are kept."""


_SHORT = 60
"""Characters to which texts below a warning are cut before those of errors and warnings are."""


class EventRow(NamedTuple):
    """A row of a list: an event, from its first time to its last, in seconds, and how often it came.

    ``number`` counts rows from 0 on. ``length`` is that of the whole text, of which ``text`` may be the beginning.
    """

    number: int
    seconds: float
    until: float
    level: Level
    source: str
    text: str
    topic: str
    count: int  # type: ignore[assignment]  # hides tuple.count, which a row does not need
    length: int


class EventLog:
    """The newest events, as rows.

    Args:
        most_rows: rows that are kept; older ones are forgotten. None: all.
        most_text: characters of a text that are kept.
        most_characters: characters of all texts that are kept. None: all.

    Attributes:
        count: the number of events so far.
        first: the number of the first row that is kept.
    """

    def __init__(self, most_rows: int | None, most_text: int, most_characters: int | None) -> None:
        self._most_text = most_text
        self._most_characters = inf if most_characters is None else most_characters
        self._rows: deque[EventRow] = deque(maxlen=most_rows)
        self.count = 0
        self._made = self._characters = 0

    @property
    def first(self) -> int:
        """The number of the first row that is kept: so many were forgotten."""
        return self._made - len(self._rows)

    @property
    def rows(self) -> Sequence[EventRow]:
        """The rows, oldest first."""
        return self._rows

    @property
    def stop(self) -> int:
        """The number that the next row will have."""
        return self._made

    def add(self, event: Event, seconds: float) -> None:
        """Add an event; one that repeats the last row makes that longer."""
        self.count += 1
        text, source, topic = event.text[: self._most_text], event.source[:_LONGEST_NAME], event.topic[:_LONGEST_NAME]
        said = (event.level, source, text, topic)
        last = self._rows[-1] if self._rows else None
        if (
            last is not None
            and (last.level, last.source, last.text, last.topic) == said
            and last.length == len(event.text)
        ):
            self._rows[-1] = last._replace(until=seconds, count=last.count + 1)
            return
        row = EventRow(self._made, seconds, seconds, *said, 1, len(event.text))
        if len(self._rows) == self._rows.maxlen:
            self._forget()
        self._rows.append(row)
        self._made += 1
        self._characters += len(text)
        while self._characters > self._most_characters and len(self._rows) > 1:
            self._forget()

    def clear(self) -> None:
        """Forget all rows; their numbers go on."""
        self._rows.clear()
        self._characters = 0

    def _forget(self) -> None:
        self._characters -= len(self._rows.popleft().text)


def thinned(rows: Sequence[EventRow], most: int) -> list[EventRow]:
    """At most so many rows, those that matter most; of a level of which not all have room some, evenly chosen."""
    kept: list[EventRow] = []
    for level in sorted(Level, reverse=True):
        own = [row for row in rows if row.level == level]
        left = most - len(kept)
        kept += own if len(own) <= left else [own[i * len(own) // left] for i in range(left)]
    return sorted(kept)


def shortened(rows: Sequence[EventRow], most_characters: int) -> list[EventRow]:
    """The rows with texts so short that together they have at most so many characters, errors and warnings last."""
    most = severe = max((len(row.text) for row in rows), default=0)
    while sum(min(severe if row.level >= Level.WARN else most, len(row.text)) for row in rows) > most_characters:
        if most > _SHORT:
            most //= 2
        else:
            severe //= 2
            most = min(most, severe)
    return [row._replace(text=row.text[: severe if row.level >= Level.WARN else most]) for row in rows]

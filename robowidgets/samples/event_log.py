"""Events as rows of a list: consecutive equal events share a row, and the oldest rows are dropped."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import inf
from typing import NamedTuple

from .event import Event, Level

_LONGEST_NAME = 200
"""Characters kept of the name of a source or a topic."""


_SHORT = 60
"""Texts below a warning are cut to this many characters before the texts of warnings and errors are cut."""


class EventRow(NamedTuple):
    """A row of a list: an event, its first and last time in seconds, and its count.

    ``number`` counts rows from 0. ``length`` is the length of the whole text; ``text`` may be only its beginning.
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
        most_rows: rows to keep, or None for all; older rows are dropped.
        most_text: characters to keep of each text.
        most_characters: characters to keep of all texts together, or None for all.

    Attributes:
        count: the number of events so far.
        first: the number of the first row that is kept.
    """

    def __init__(self, most_rows: int | None, most_text: int, most_characters: int | None) -> None:
        self._most_text = most_text
        self._most_characters = inf if most_characters is None else most_characters
        self._rows: deque[EventRow] = deque(maxlen=most_rows)
        self.count = 0
        self._last_text = ""
        self._made = self._characters = 0

    @property
    def first(self) -> int:
        """The number of the first row that is kept, which is the number of rows that were dropped."""
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
        """Add an event; if it repeats the last row, extend that row."""
        self.count += 1
        text, source, topic = event.text[: self._most_text], event.source[:_LONGEST_NAME], event.topic[:_LONGEST_NAME]
        said = (event.level, source, text, topic)
        last = self._rows[-1] if self._rows else None
        if (
            last is not None
            and (last.level, last.source, last.text, last.topic) == said
            and self._last_text == event.text  # the row may have only its beginning
        ):
            self._rows[-1] = last._replace(until=seconds, count=last.count + 1)
            return
        self._last_text = event.text
        row = EventRow(self._made, seconds, seconds, *said, 1, len(event.text))
        if len(self._rows) == self._rows.maxlen:
            self._forget()
        self._rows.append(row)
        self._made += 1
        self._characters += len(text)
        while self._characters > self._most_characters and len(self._rows) > 1:
            self._forget()

    def clear(self) -> None:
        """Drop all rows; numbering goes on."""
        self._rows.clear()
        self._characters = 0

    def _forget(self) -> None:
        self._characters -= len(self._rows.popleft().text)


def thinned(rows: Sequence[EventRow], most: int) -> list[EventRow]:
    """Return at most that many rows, the most severe first to be kept; a level that does not fit is thinned evenly."""
    kept: list[EventRow] = []
    for level in sorted(Level, reverse=True):
        own = [row for row in rows if row.level == level]
        left = most - len(kept)
        kept += own if len(own) <= left else [own[i * len(own) // left] for i in range(left)]
    return sorted(kept)


def shortened(rows: Sequence[EventRow], most_characters: int) -> list[EventRow]:
    """Return the rows with texts cut to at most that many characters in total; warnings and errors are cut last."""
    most = severe = max((len(row.text) for row in rows), default=0)
    while sum(min(severe if row.level >= Level.WARN else most, len(row.text)) for row in rows) > most_characters:
        if most > _SHORT:
            most //= 2
        else:
            severe //= 2
            most = min(most, severe)
    return [row._replace(text=row.text[: severe if row.level >= Level.WARN else most]) for row in rows]

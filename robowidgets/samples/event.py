"""Something that happened: a line of a log, a status that changed, a press of a button."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from numbers import Integral
from typing import Any

from .age import HasAge


class Level(IntEnum):
    """The severity of an event, with the numbers of ROS 2 and Python's logging."""

    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50

    @classmethod
    def at_most(cls, number: int) -> Level:
        """Return the highest level that a number reaches, or the lowest level for a smaller number."""
        return max((level for level in cls if level <= number), default=cls.DEBUG)


_ALSO = {"WARNING": Level.WARN, "CRITICAL": Level.FATAL, "OK": Level.INFO}


@dataclass(frozen=True)
class Event(HasAge):
    """Something that happened.

    Args:
        text: the whole text, as sent.
        level: its severity.
        source: the node, device or machine that reports it; may be empty.
        topic: the topic on which it came; may be empty.
        stamp_ns: the time in the message in nanoseconds, or None if the message has none.
    """

    text: str
    level: Level = Level.INFO
    source: str = ""
    topic: str = ""
    stamp_ns: int | None = None


def to_level(name: str, given: Any) -> Level:
    """Return the level that a user names: ``"WARN"``, a `Level`, or its number.

    Raises:
        TypeError: the value is neither text nor a whole number. ValueError: it does not name a level.
    """
    if isinstance(given, str):
        word = given.strip().upper()
        found = Level.__members__.get(word) or _ALSO.get(word)
    elif isinstance(given, Integral) and not isinstance(given, bool):
        found = next((level for level in Level if level == given), None)
    else:
        raise TypeError(f"{name}: expected a level such as 'WARN', got {given!r}")
    if found is None:
        raise ValueError(f"{name}: expected one of {', '.join(Level.__members__)}, got {given!r}")
    return found


def to_words(name: str, given: Any) -> str:
    """Return a search text, or an empty text for None.

    Raises:
        TypeError: the value is not text.
    """
    if given is not None and not isinstance(given, str):
        raise TypeError(f"{name}: expected words as text, got {given!r}")
    return given or ""


def holds(event: Event, level: Level | None, words: str) -> bool:
    """Return True if an event has at least this level and contains the words in its text or source, in any case."""
    if level is not None and event.level < level:
        return False
    wanted = words.casefold()
    return wanted in event.text.casefold() or wanted in event.source.casefold()

"""Something that happened: a line of a log, a status that changed, a press of a button."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from numbers import Integral
from typing import Any

from .age import HasAge


class Level(IntEnum):
    """How much an event matters; the numbers are those of ROS 2 and of Python's logging."""

    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50

    @classmethod
    def at_most(cls, number: int) -> Level:
        """The highest level that a number reaches; of numbers below all, the lowest."""
        return max((level for level in cls if level <= number), default=cls.DEBUG)


_ALSO = {"WARNING": Level.WARN, "CRITICAL": Level.FATAL, "OK": Level.INFO}


@dataclass(frozen=True)
class Event(HasAge):
    """Something that happened.

    Args:
        text: what happened, in full, as it was sent.
        level: how much it matters.
        source: the node, the device or the machine that tells it; may be empty.
        topic: the topic on which it came; may be empty.
        stamp_ns: the time in the message in nanoseconds; None without one.
    """

    text: str
    level: Level = Level.INFO
    source: str = ""
    topic: str = ""
    stamp_ns: int | None = None


def to_level(name: str, given: Any) -> Level:
    """The level that a person names: ``"WARN"``, a `Level`, or its number.

    Raises:
        TypeError: it is neither text nor a whole number. ValueError: there is no such level.
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
    """Words that a text must hold, in any case; empty for None.

    Raises:
        TypeError: it is no text.
    """
    if given is not None and not isinstance(given, str):
        raise TypeError(f"{name}: expected words as text, got {given!r}")
    return given or ""


def holds(event: Event, level: Level | None, words: str) -> bool:
    """Whether an event is of a level or a higher one, and has words in its text or its source, in any case."""
    if level is not None and event.level < level:
        return False
    wanted = words.casefold()
    return wanted in event.text.casefold() or wanted in event.source.casefold()

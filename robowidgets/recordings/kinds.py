"""The topics of a kind: how they are called, and which one is meant where none is named."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..kinds import Widget
from ..repair.source import UnknownTopicError, UnnamedTopicError
from .timeline import Topic

WORDS: Mapping[Widget | None, str] = {"laser": "laser scans", "speed": "speeds", "touch": "touch sensors"}
"""What the topics are of that a widget shows."""


def named(topics: Iterable[Topic], widget: Widget) -> list[str]:
    """The names of the topics that a widget shows."""
    return [topic.name for topic in topics if topic.widget == widget]


def only(name: str, topics: Iterable[Topic], widget: Widget) -> str:
    """The one topic of a kind; of speeds, the one that is measured.

    Args:
        name: what the recording is called, for errors.
        topics: those among which it is.
        widget: what shows it.

    Raises:
        UnknownTopicError: there is none, or, as `UnnamedTopicError`, not just one.
    """
    topics = list(topics)
    there = named(topics, widget)
    for some in (there, named((topic for topic in topics if not topic.commanded), widget)):
        if len(some) == 1:
            return some[0]
    if not there:
        raise UnknownTopicError(f"{name} has no {WORDS[widget]}")
    raise UnnamedTopicError(f"{name} has several topics of {WORDS[widget]} ({', '.join(there)})", there, widget)

"""The topics of a recording that a widget shows, and what is said of others."""

from __future__ import annotations

from collections.abc import Iterable

from ..repair.source import UnknownTopicError
from .timeline import Topic


def shown(topics: Iterable[Topic]) -> dict[str, Topic]:
    """By name those that a widget shows."""
    return {topic.name: topic for topic in topics if topic.widget}


def check(name: str, topics: Iterable[Topic], file: str) -> None:
    """See `Recording.check`."""
    if not isinstance(name, str):
        raise TypeError(f"expected the name of a topic as text, got {name!r}")
    can = shown(topics)
    if name in can:
        return
    there = ", ".join(can) or "none"
    known = next((topic for topic in topics if topic.name == name), None)
    if known is None:
        raise UnknownTopicError(f"{file} has no topic {name!r}: those that a widget shows are {there}")
    why = known.problem or f"no widget shows {known.type}"
    raise UnknownTopicError(f"{file}: topic {name!r} cannot be shown ({why}): those that can are {there}")

"""The topics of a feed, and decoding their messages."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from ..kinds import KINDS, counts_every_message, is_standard, is_undecided, kind_of_message, kind_of_type, widgets_of
from ..messages.brief import brief
from ..runtime.tables import Table
from ..runtime.text import many
from .middleware import EVENTS, Advert

_HEADS = ("topic", "type", "published", "heard", "widget")
_MANY = 12

YOURS = " (your program)"
"""Suffix of the topic on which a program drives a recording."""


class FeedTopic(NamedTuple):
    """A topic of a running robot.

    ``type`` is written as ``sensor_msgs/msg/LaserScan``; several types are joined by a comma, and an unknown type is
    empty. ``widget`` is the kind of the widget that shows the topic, or None. ``commanded`` is True for a commanded
    speed, False for a measured one. ``offered`` is True if another node publishes it, ``wanted`` if another node
    subscribes to it, or None if unknown.
    """

    name: str
    type: str
    widget: str | None
    commanded: bool
    offered: bool
    wanted: bool | None


def unlisted(name: str) -> FeedTopic:
    """Return a topic with a known name and nothing else."""
    return FeedTopic(name, "", None, False, True, None)


def is_open(topic: FeedTopic) -> bool:
    """Return True if only a message can decide the widget, because the type is unknown or has several kinds."""
    if topic.widget or not topic.offered or not topic.type:
        return False
    return is_undecided(topic.type) or not is_standard(topic.type)


def decided(topic: FeedTopic, message: Any) -> FeedTopic:
    """Return the topic with the widget that can show its messages, if any."""
    kind = kind_of_message(message, topic.type)
    if kind is None:
        return topic
    return topic._replace(widget=kind.name, commanded=kind.is_command(topic.name, topic.type))


def sample_of(message: Any, topic: FeedTopic) -> Any:
    """Return the sample in a message of a topic, or the message itself if no widget shows it.

    Raises:
        TypeError, ValueError: the message cannot be read.
    """
    widget = topic.widget or (decided(topic, message).widget if is_open(topic) or not topic.type else None)
    return message if widget is None else KINDS[widget].read(message)


def brief_of(message: Any, topic: FeedTopic | None) -> str:
    """Return a short text for a message, or for the sample in it."""
    try:
        return brief(message if topic is None else sample_of(message, topic))
    except (TypeError, ValueError):
        return brief(message)


def queue_length(type_name: str) -> int:
    """Return the length of a queue of messages, which is 1 unless every message of the type counts."""
    return EVENTS if counts_every_message(type_name) else 1


def topics_of(adverts: Iterable[Advert]) -> dict[str, FeedTopic]:
    """Return the topics that a middleware lists, by name, in its order."""
    by_name: dict[str, list[Advert]] = {}
    for advert in adverts:
        by_name.setdefault(advert.name, []).append(advert)
    return {name: _topic(name, same) for name, same in by_name.items()}


def _topic(name: str, adverts: Sequence[Advert]) -> FeedTopic:
    types = list(dict.fromkeys(a.type for a in adverts if a.type and a.offered)) or [a.type for a in adverts][:1]
    kind = None if any(map(is_undecided, types)) else next(filter(None, map(kind_of_type, types)), None)
    wanted = [a.wanted for a in adverts if a.wanted is not None]
    return FeedTopic(
        name,
        ", ".join(types),
        kind.name if kind else None,
        kind is not None and any(kind.is_command(name, type_name) for type_name in types or [""]),
        any(a.offered for a in adverts),
        any(wanted) if wanted else None,
    )


def table_of(where: str, topics: Sequence[FeedTopic], status: str, *notes: str) -> Table:
    """Return a table of the topics of a feed, with the status of the connection, and notes, some of them empty."""
    heading = f"{where}: {many(len(topics), 'topic')}"
    rows = [_cells(topic) for topic in topics]
    return Table(heading, _HEADS, rows, notes=[*filter(None, notes)], problems=[status] if status else ())


def _cells(topic: FeedTopic) -> tuple[str, ...]:
    yes_no = {True: "yes", False: "no", None: "?"}
    shown = widgets_of(topic.widget, topic.type, topic.commanded)
    return topic.name, topic.type or "?", yes_no[topic.offered], yes_no[topic.wanted], shown


def no_such(name: str, there: Iterable[str]) -> str:
    """Return a text for a topic that does not exist, with the existing topics."""
    names = list(there)
    if not names:
        return f"no topic {name} yet; no topics are known"
    near = difflib.get_close_matches(name, names)
    hint = f"; did you mean {' or '.join(near)}?" if near else ""
    rest = ", …" if len(names) > _MANY else ""
    return f"no such topic {name}; there are {', '.join(names[:_MANY])}{rest}{hint}"


def check_name(topic: Any) -> None:
    """Raise TypeError or ValueError unless it is the name of a topic."""
    if not isinstance(topic, str):
        raise TypeError(f"expected the name of a topic as text, got {topic!r}")
    if not topic:
        raise ValueError("expected the name of a topic, got an empty text")

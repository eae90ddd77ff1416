"""The kind of a topic whose type has several kinds: its first message decides."""

from __future__ import annotations

from typing import Any

from ..kinds import is_standard, is_undecided, kind_of_message
from ._topics import Topic


def is_open(topic: Topic) -> bool:
    """Whether only a message can decide the widget of a topic."""
    if topic.widget or not topic.offered or not topic.type:
        return False
    return is_undecided(topic.type) or not is_standard(topic.type)


def decided(topic: Topic, message: Any) -> Topic:
    """The topic with the widget that shows its messages, if one does."""
    kind = kind_of_message(message, topic.type)
    if kind is None:
        return topic
    return topic._replace(widget=kind.name, commanded=kind.is_command(topic.name))

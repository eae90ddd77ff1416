"""The choice of a topic in a recording that has several of a kind, if the user names none."""

from __future__ import annotations

from collections.abc import Collection
from fnmatch import fnmatchcase

from ..recordings import RecordingData
from ..recordings.topics import Topic, UnknownTopicError, likeliest, shown


def chosen_of(recording: RecordingData, patterns: Collection[str]) -> list[str]:
    """Return the chosen topic of each kind with several topics.

    Raises:
        UnknownTopicError: no topic fits one of the patterns.
    """
    topics = recording.topics
    for pattern in patterns:
        if not any(_fits(topic, (pattern,)) for topic in topics):
            there = ", ".join(topic.name for topic in topics if topic.widget) or "none"
            raise UnknownTopicError(f"{recording.path.name} has no topic {pattern!r}; topics with a widget: {there}")
    chosen = []
    for kind in dict.fromkeys(topic.widget for topic in topics if topic.widget):
        fitting = [topic for topic in topics if topic.widget == kind and topic.count]
        asked = [topic for topic in fitting if _fits(topic, patterns)]
        if len(fitting) > 1:
            chosen.append(likeliest(asked or fitting).name)
    return chosen


def looked_at(recording: RecordingData, patterns: Collection[str]) -> list[str]:
    """Return the topics that a function may read: topics with a widget, and topics that fit one of the patterns.

    A topic that cannot be read is included only if it is named in full: then reading it raises an error.
    """
    can = shown(recording.topics)
    asked = [topic for topic in recording.topics if _fits(topic, patterns)]
    return [
        *can,
        *(topic.name for topic in asked if topic.name not in can and (not topic.problem or topic.name in patterns)),
    ]


def _fits(topic: Topic, patterns: Collection[str]) -> bool:
    return any(fnmatchcase(topic.name, pattern) for pattern in patterns)

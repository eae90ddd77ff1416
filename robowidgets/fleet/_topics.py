"""Which topic of a recording is meant, where it has several of a kind and nobody names one."""

from __future__ import annotations

from collections.abc import Collection
from fnmatch import fnmatchcase

from ..recordings import RecordingData
from ..recordings.topics import UnknownTopicError, likeliest


def chosen_of(recording: RecordingData, patterns: Collection[str]) -> list[str]:
    """The topic that is meant of each kind of which there are several.

    Raises:
        UnknownTopicError: no topic fits one of the patterns.
    """
    topics = recording.topics
    for pattern in patterns:
        if not any(fnmatchcase(topic.name, pattern) for topic in topics):
            there = ", ".join(topic.name for topic in topics if topic.widget) or "none"
            raise UnknownTopicError(
                f"{recording.path.name} has no topic {pattern!r}: those that a widget shows are {there}"
            )
    chosen = []
    for kind in dict.fromkeys(topic.widget for topic in topics if topic.widget):
        fitting = [topic for topic in topics if topic.widget == kind and topic.count]
        asked = [topic for topic in fitting if any(fnmatchcase(topic.name, pattern) for pattern in patterns)]
        if len(fitting) > 1:
            chosen.append(likeliest(asked or fitting).name)
    return chosen

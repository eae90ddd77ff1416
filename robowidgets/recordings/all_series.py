"""The series of a recording, each made when it is first asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from .._kinds import Widget
from .memory import Memory
from .scan_series import Scans
from .source import UnknownTopicError
from .speed_series import Speeds
from .store import Store
from .timeline import Timeline, Topic
from .touch_series import Touches

AnySeries = TypeVar("AnySeries", Scans, Speeds, Touches)


class AllSeries:
    """The series of a recording.

    Args:
        name: what the recording is called, for errors.
        timeline: what it reads.
    """

    def __init__(self, name: str, timeline: Timeline) -> None:
        self.memory = Memory()
        self._name = name
        self._timeline = timeline
        self._made: dict[str, Scans | Speeds | Touches] = {}

    def of(self, topic: Topic, widget: Widget, kind: type[AnySeries]) -> AnySeries:
        """The series of a topic.

        Raises:
            UnknownTopicError: the topic is of another kind.
        """
        if topic.widget != widget:
            there = ", ".join(_named(self._timeline.topics, widget)) or "none"
            raise UnknownTopicError(
                f"{self._name}: {topic.name!r} is a topic of {topic.widget}: those of {widget} are {there}"
            )
        series = self._made.get(topic.name)
        if not isinstance(series, kind):
            series = kind(Store(self._timeline.feed(topic.name), self.memory), self._timeline.start_ns or 0)
            self._made[topic.name] = series
        return series

    def only(self, widget: Widget) -> str:
        """The one topic of a kind; of speeds, the one that is measured.

        Raises:
            UnknownTopicError: there is not just one.
        """
        topics = _named(self._timeline.topics, widget)
        for some in (topics, {name: topic for name, topic in topics.items() if not topic.commanded}):
            if len(some) == 1:
                return next(iter(some))
        if not topics:
            raise UnknownTopicError(f"{self._name} has no topic of {widget}")
        raise UnknownTopicError(f"{self._name} has several topics of {widget}, name one: {', '.join(topics)}")

    def clear(self) -> None:
        """Let go of all of them."""
        self._made.clear()


def _named(topics: tuple[Topic, ...], widget: Widget) -> Mapping[str, Topic]:
    return {topic.name: topic for topic in topics if topic.widget == widget}

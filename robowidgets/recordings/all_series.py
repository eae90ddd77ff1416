"""The series of a recording, each made when it is first asked for."""

from __future__ import annotations

from typing import Any, TypeVar

from ..kinds import Widget
from ..repair.source import UnknownTopicError
from .clocks import Clock, about_clocks, clock_of
from .kinds import WORDS, named, only
from .memory import Memory
from .scan_series import Scans
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
        self._steady: dict[str, Store[Any]] = {}
        """Of topics that are not silent for long in a sound recording."""
        self._clocks: dict[str, Clock] = {}

    @property
    def problems(self) -> tuple[str, ...]:
        """What is wrong with the clocks of scans and measured speeds that were read from start to end."""
        self._note_clocks()
        return about_clocks(self._clocks)

    def of(self, topic: Topic, widget: Widget, kind: type[AnySeries]) -> AnySeries:
        """The series of a topic.

        Raises:
            UnknownTopicError: the topic is of another kind.
        """
        if topic.widget != widget:
            there = ", ".join(named(self._timeline.topics, widget)) or "none"
            raise UnknownTopicError(
                f"{self._name}: {topic.name!r} is a topic of {WORDS[topic.widget]}: "
                f"those of {WORDS[widget]} are {there}"
            )
        series = self._made.get(topic.name)
        if not isinstance(series, kind):
            store: Store[Any] = Store(self._timeline.feed(topic.name), self.memory)
            series = kind(store, self._timeline.start_ns or 0)
            self._made[topic.name] = series
            if widget != "touch" and not topic.commanded:
                self._steady[topic.name] = store
        return series

    def only(self, widget: Widget) -> str:
        """See `kinds.only`."""
        return only(self._name, self._timeline.topics, widget)

    def clear(self) -> None:
        """Let go of all of them, but not of what is wrong with their clocks."""
        self._note_clocks()
        self._made.clear()
        self._steady.clear()

    def _note_clocks(self) -> None:
        for name, store in list(self._steady.items()):
            if store.is_known and name not in self._clocks:
                self._clocks[name] = clock_of(store.times_ns, self._timeline.start_ns or 0)

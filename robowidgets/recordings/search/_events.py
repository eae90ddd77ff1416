"""Conditions on events: ``event("/rosout", level="WARN", text="lost")``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...samples.event import Event, holds, to_level, to_words
from ...samples.verdict import Verdict
from ..events import has_events
from ..topics import UnknownTopicError, check_known
from ._steps import NO, YES, Steps, steps
from .base import Condition

if TYPE_CHECKING:
    from .. import RecordingData
    from ._search import Search


class EventCondition(Condition):
    """The condition that an event happened. It is true only at that moment.

    Args:
        topic: the topic of the event, or None for any topic with events.
        level: the lowest level, or None for any.
        text: a text to find in its text or source, or None for any.
    """

    def __init__(self, topic: str | None, level: Any, text: Any) -> None:
        if topic is not None and not isinstance(topic, str):
            raise TypeError(f"topic: expected the name of a topic, got {topic!r}")
        self._topic = topic
        self._level = None if level is None else to_level("level", level)
        self._words = to_words("text", text)

    def topics(self, recording: RecordingData, asked: Any) -> list[str]:  # noqa: ARG002
        """See `Condition`."""
        if self._topic is not None:
            return [check_known(self._topic, recording.topics, recording.path.name).name]
        found = [topic.name for topic in recording.topics if has_events(topic)]
        if not found:
            raise UnknownTopicError(f"{recording.path.name} has no topic with events")
        return found

    def steps(self, search: Search) -> Steps:
        """See `Condition`."""
        recording, times = search.recording, []
        try:
            for time_ns, event in recording.timed_events(self.topics(recording, None)):
                if search.is_cut and time_ns > search.end_ns:
                    break
                search.looked_at(1)
                if holds(event, self._level, self._words):
                    times.append(time_ns)
        except KeyboardInterrupt:
            search.cut(times[-1] if times else recording.start_ns or 0)
        # True at its moment, but not after it.
        told = [(at, value) for at in sorted(set(times)) for value in (YES, NO)]
        before = [(recording.start_ns or 0, NO)]
        found = sorted([*before, *told], key=lambda one: one[0])
        return steps([at for at, _ in found], [value for _, value in found])

    def judge(self, moment: Any) -> Verdict:
        """See `Condition`. The moment is an `Event`, or has one as ``moment.event``."""
        event = moment if isinstance(moment, Event) else getattr(moment, "event", None)
        if event is None:
            return Verdict(None)
        if not isinstance(event, Event):
            raise TypeError(f"{self}: expected an event, got a {type(event).__name__.lower()}")
        value = holds(event, self._level, self._words) and self._topic in (None, event.topic)
        return Verdict(value, " ".join(event.text[:80].split()) if value else "")

    @property
    def reads(self) -> frozenset[str]:
        """See `Condition`."""
        return frozenset({"event"})

    def __str__(self) -> str:
        what = f"{self._level.name} or more" if self._level else "event"
        where = f" on {self._topic}" if self._topic else ""
        return what + (f" with {self._words!r}" if self._words else "") + where

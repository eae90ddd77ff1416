"""The poses of a robot and of its sensors on it, for the widgets that need them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any

from ..messages.standard import ODOMETRY
from ..poses.live_frames import TakesFrames, TakesTopics
from ..poses.transforms import STATIC, TRANSFORMS
from ..runtime.coalesced_call import CoalescedCall
from ._subscription import Target
from ._subscriptions import Subscriptions
from ._topics import FeedTopic
from .middleware import FeedError

_WATCHED = ("trail", "overlay", "_lasers")
"""Traits of widgets that determine which poses they need."""


class FrameTopics:
    """The subscriptions of widgets that need the odometry and tf of their robot. See `TakesFrames`.

    Attributes:
        look: attaches the topics that widgets need now and detaches the others, in one thread at a time.
    """

    def __init__(self, connection: Subscriptions) -> None:
        self._connection = connection
        self._attached: dict[TakesFrames, list[tuple[str, Target]]] = {}
        self._observed: set[Any] = set()
        self.look = CoalescedCall(self._look)

    def _look(self) -> None:
        connection = self._connection
        widgets: tuple[Any, ...] = () if connection.is_closed else connection.widgets
        there = {widget for widget in widgets if hasattr(widget, "frame_topics")}
        for widget in there - self._observed:
            widget.observe(self._on_trait, _WATCHED)
        for widget in self._observed - there:
            widget.unobserve(self._on_trait, _WATCHED)
        self._observed = there
        for widget in there | self._attached.keys():
            wanted = _wanted(connection.topics, widget) if widget in there else []
            before = self._attached.pop(widget, [])
            if wanted and [topic for topic, _ in before] == [topic for topic, _ in wanted]:
                self._attached[widget] = before
                continue
            for topic, target in before:
                connection.detach(topic, target)
            with suppress(FeedError):  # the connection was closed in the meantime, and calls this again
                if wanted:
                    self._attached[widget] = [(topic, connection.attach(topic, take, _miss)) for topic, take in wanted]

    def _on_trait(self, _change: Any) -> None:
        self.look()


def _wanted(topics: Iterable[FeedTopic], widget: TakesFrames) -> list[tuple[str, Callable[[Any], object]]]:
    """Return the topics that a widget needs in addition to its topics, with the methods that get their messages."""
    by, there = widget.frame_topics, list(topics)
    odometry = sorted(topic.name for topic in there if topic.type == ODOMETRY and topic.widget)[:1]
    frames = sorted(topic.name for topic in there if topic.type in TRANSFORMS)
    names = {"both": [*odometry, *frames], "odometry": odometry or frames, "tf": frames, "": []}[by]
    wanted: list[tuple[str, Callable[[Any], object]]] = [
        (name, widget.take_static_frames if name.rpartition("/")[2] == STATIC else widget.take_frames) for name in names
    ]
    if isinstance(widget, TakesTopics):
        wanted += widget.topics_beside({topic.name: topic.type for topic in there})
    return wanted


def _miss(_count: int) -> None:
    """Ignore missed messages, because the next message contains the pose."""

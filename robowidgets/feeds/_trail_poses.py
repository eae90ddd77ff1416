"""Where the robot of a feed is, for the trails of its lasers."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol

from ..kinds import ODOMETRY_TYPES, TRANSFORM_TYPES
from ..laser_widget import LaserWidget
from ._subscription import Target
from ._topics import FeedTopic


class Attaching(Protocol):
    """A connection, as this knows it."""

    @property
    def topics(self) -> tuple[FeedTopic, ...]:
        """The topics that are known."""

    @property
    def widgets(self) -> Sequence[Any]:
        """The widgets that are connected."""

    def attach(
        self, topic: str, take: Callable[[Any], object], on_missed: Callable[[int], object] | None = None
    ) -> Target:
        """Pass the messages of a topic to a function."""

    def detach(self, topic: str, target: Target) -> None:
        """End that."""


class TrailPoses:
    """Gives each laser with a trail the odometry of its robot, of several topics the first; without any, its tf."""

    def __init__(self, connection: Attaching) -> None:
        self._connection = connection
        self._lock = threading.RLock()
        self._attached: dict[LaserWidget, list[tuple[str, Target]]] = {}
        self._observed: set[LaserWidget] = set()

    def look(self, _change: Any = None) -> None:
        """Attach what lasers need now, and detach what they need no longer."""
        connection = self._connection
        with self._lock:
            lasers = {widget for widget in connection.widgets if isinstance(widget, LaserWidget)}
            for laser in lasers - self._observed:
                laser.observe(self.look, "trail")
            for laser in self._observed - lasers:
                laser.unobserve(self.look, "trail")
            self._observed = lasers
            for laser in lasers | self._attached.keys():
                wanted = _wanted(connection.topics) if laser in lasers and laser.needs_poses else []
                before = self._attached.pop(laser, [])
                if wanted and [topic for topic, _ in before] == wanted:
                    self._attached[laser] = before
                    continue
                for topic, target in before:
                    connection.detach(topic, target)
                if wanted:
                    self._attached[laser] = [
                        (topic, connection.attach(topic, laser.take_pose, _miss)) for topic in wanted
                    ]

    def close(self) -> None:
        """Observe no laser any more."""
        with self._lock:
            for laser in self._observed:
                laser.unobserve(self.look, "trail")
            self._observed = set()


def _wanted(topics: Iterable[FeedTopic]) -> list[str]:
    there = list(topics)
    odometry = sorted(topic.name for topic in there if topic.type in ODOMETRY_TYPES and topic.widget)
    return odometry[:1] or sorted(topic.name for topic in there if topic.type in TRANSFORM_TYPES)


def _miss(_count: int) -> None:
    """The next message says where the robot is then."""

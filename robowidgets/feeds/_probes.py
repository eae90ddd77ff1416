"""Topics whose widget is decided by their first message."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any

from ._subscription import Target
from ._subscriptions import Subscriptions
from ._topics import FeedTopic, is_open


class Probes:
    """Subscriptions to topics for the message that decides their widget. Each ends with its first message.

    Args:
        connection: the connection of the feed, which lists the decided widgets.
    """

    def __init__(self, connection: Subscriptions) -> None:
        self._connection = connection
        self._targets: dict[str, Target] = {}
        self._decided: set[str] = set()

    @property
    def topics(self) -> frozenset[str]:
        """The names of the topics that are or were probed."""
        return frozenset(self._targets)

    def waits_for(self, topic: str) -> bool:
        """Return True while the widget of a topic waits for a message."""
        return topic in self._targets and topic not in self._decided

    def add(self, topics: Iterable[FeedTopic]) -> None:
        """Probe each topic that is open, once."""
        for topic in topics:
            if topic.name not in self._targets and is_open(topic):
                # Known before the first message, which may come from another thread at once.
                self._targets[topic.name] = target = Target(partial(self._decide, topic), None)
                self._connection.attach_target(topic.name, target)

    def close(self) -> None:
        """Stop waiting for messages."""
        targets, self._targets = self._targets, {}
        for name, target in targets.items():
            self._connection.detach(name, target)

    def _decide(self, topic: FeedTopic, message: Any) -> None:
        if target := self._targets.get(topic.name):  # otherwise it was closed in the meantime
            self._decided.add(topic.name)
            self._connection.detach(topic.name, target)
            self._connection.decide(topic, message)

"""A listener that records the reports of a middleware, each change once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

from robowidgets.feeds.middleware import Advert


class Ears:
    """The reports of a middleware, in order; ``then`` is called with each message."""

    def __init__(self) -> None:
        self.connected = 0
        self.lost: list[str] = []
        self.nobody = ""
        self.pauses: list[float] = []
        self.topics: list[Advert] | None = None
        self.messages: list[tuple[str, Any]] = []
        """Samples for callers that take the newest."""
        self.replaced: list[tuple[str, Any]] = []
        """Samples only for callers that take each."""
        self.missed: Counter[str] = Counter()
        self.came: Counter[str] = Counter()
        """The number of received messages, including those that newer ones replaced."""
        self.troubles: dict[str, str] = {}
        self.said: list[str] = []
        self.unheard: dict[str, str] = {}
        self.then: Callable[[str, Any], object] = lambda *_: None

    def on_connected(self) -> None:
        self.connected += 1

    def on_lost(self, reason: str, again_in: float) -> None:
        self.pauses.append(again_in)
        self.lost.append(reason)

    def on_nobody(self, reason: str) -> None:
        self.nobody = reason

    def on_topics(self, topics: Sequence[Advert]) -> None:
        self.topics = list(topics)

    def on_message(
        self, topic: str, message: Any, *, newest: bool = True, each: bool = True, replaced: int = 0
    ) -> None:
        self.came[topic] += newest + replaced
        assert newest or each
        (self.messages if newest else self.replaced).append((topic, message))
        if newest:
            self.then(topic, message)

    def on_missed(self, topic: str, count: int) -> None:
        self.missed[topic] += count

    def on_trouble(self, topic: str, reason: str) -> None:
        if self.troubles.get(topic, "") != reason:
            self.troubles[topic] = reason
            self.said.append(reason)

    def on_unheard(self, topic: str, reason: str) -> None:
        self.unheard[topic] = reason

    def words(self, topic: str) -> str:
        """The present problems of a topic."""
        return self.troubles.get(topic, "") or self.unheard.get(topic, "")

    def of(self, topic: str) -> list[Any]:
        return [message for name, message in self.messages if name == topic]

"""A listener that keeps what a middleware reports, each change once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from robowidgets.feeds.middleware import Advert


class Recorder:
    """See `Listener`."""

    def __init__(self) -> None:
        self.connected = 0
        self.lost: list[tuple[str, float]] = []
        self.topics: list[Advert] = []
        self.messages: list[tuple[str, Any]] = []
        self.troubles: list[tuple[str, str]] = []
        self._last: dict[tuple[str, str], str] = {}
        self.then: Callable[[], None] = lambda: None

    def on_connected(self) -> None:
        self.connected += 1

    def on_lost(self, reason: str, again_in: float) -> None:
        self.lost.append((reason, again_in))

    def on_topics(self, topics: Sequence[Advert]) -> None:
        self.topics = list(topics)

    def on_message(self, topic: str, message: Any) -> None:
        self.messages.append((topic, message))
        self.then()

    def on_trouble(self, topic: str, reason: str) -> None:
        self._note("trouble", topic, reason)

    def on_unheard(self, topic: str, reason: str) -> None:
        self._note("unheard", topic, reason)

    def _note(self, kind: str, topic: str, reason: str) -> None:
        if self._last.get((kind, topic), "") != reason:
            self._last[kind, topic] = reason
            self.troubles.append((topic, reason))

    def words(self, topic: str) -> str:
        """What is wrong with a topic now."""
        return next((words for name, words in reversed(self.troubles) if name == topic), "")

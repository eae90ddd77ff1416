"""Reading the messages of one topic as samples."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..kinds import KINDS
from ._topics import Topic, decided, is_open


class SampleReader:
    """Makes samples of the messages of one topic. Messages that no widget shows stay as they are."""

    def __init__(self) -> None:
        self._known: tuple[str, Callable[[Any], Any]] | None = None
        """The kind of the messages, and the function that reads them."""

    def read(self, message: Any, topic: Topic) -> Any:
        """The sample of a message. TypeError or ValueError if it cannot be read."""
        widget = topic.widget or (decided(topic, message).widget if is_open(topic) or not topic.type else None)
        if widget is None:
            return message
        if self._known is None or self._known[0] != widget:
            self._known = widget, KINDS[widget].reader()
        return self._known[1](message)

"""The wires of a recording: its topics, and the nodes that published them, if their names are known."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from itertools import islice

from ..message_widget import MessageWidget
from ..messages.brief import brief
from ..messages.fields import get
from ..messages.infrastructure import is_infrastructure, is_large
from ..recordings.data import RecordingData
from ..recordings.topics import Topic, UnknownTopicError
from ..wires_widget import Wire, Wiring

_LOGS = ("rcl_interfaces/msg/Log", "rosgraph_msgs/msg/Log")
_MOST_LINES = 2000
"""Lines of a log that are searched for names of nodes."""


class RecordedWires:
    """The wires of a recording for its widget: see `robowidgets.wires_widget.WiresSource`. They never change.

    Args:
        recording: the recording, which is read once.
    """

    status = robot = ""

    def __init__(self, recording: RecordingData) -> None:
        self._recording = recording
        self.name = recording.path.name

    @cached_property
    def wiring(self) -> Wiring:
        """See `WiresSource`."""
        publishers = self._recording.publishers
        wires = tuple(self._wire(topic, publishers.get(topic.name, ())) for topic in self._recording.topics)
        tells = any(wire.publishers for wire in wires)
        note = "the recording has no names of nodes: it shows only topics" if not tells else ""
        return Wiring(wires, (), tells, note)

    def look(self, is_seen: bool) -> None:
        """See `WiresSource`."""

    def show(self, topic: str, widget: MessageWidget) -> None:
        """See `WiresSource`."""
        last = self._recording.message_at(topic, self._recording.duration)
        if last is not None:
            widget.update(last)

    def hide(self, topic: str, widget: MessageWidget) -> None:
        """See `WiresSource`."""

    def observe(self, on_change: Callable[[], None]) -> None:
        """See `WiresSource`."""

    def unobserve(self, on_change: Callable[[], None]) -> None:
        """See `WiresSource`."""

    def _wire(self, topic: Topic, publishers: tuple[str, ...]) -> Wire:
        return Wire(
            topic.name,
            topic.type,
            tuple(sorted({*publishers, *self._writers(topic)})),
            offered=topic.count > 0,
            rate=None if topic.rate is None else round(topic.rate, 2),
            value=self._last(topic),
            count=topic.count,
            is_infrastructure=is_infrastructure(topic.name),
            note=topic.problem,
        )

    def _writers(self, topic: Topic) -> set[str]:
        """Return the nodes that wrote the lines of a log. Their names are the names of their loggers in ROS 2."""
        if topic.type not in _LOGS:
            return set()
        try:
            lines = islice(self._recording.messages(topic.name), _MOST_LINES)
            names = {str(get(line.message, "name", "")).strip("/") for line in lines}
        except UnknownTopicError:
            return set()
        return {f"/{name.replace('.', '/')}" for name in names if name}

    def _last(self, topic: Topic) -> str:
        """Return the last message, or the sample in it, in a few words, or an empty text for large ones."""
        if not topic.count or topic.problem or is_large(topic.type):
            return ""
        try:
            read = self._recording.at if topic.widget else self._recording.message_at
            found = read(topic.name, self._recording.duration)
        except UnknownTopicError:
            return ""
        return "" if found is None else brief(found.sample)

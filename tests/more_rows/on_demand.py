"""Widgets of topics on request: of any message, of one type, and of fields of several topics."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from robowidgets import kinds
from robowidgets.kinds import ON_DEMAND, OnDemandWidget
from robowidgets.messages.fields import get, type_name
from robowidgets.samples import HasAge
from robowidgets.widget.robot_widget import RobotWidget


class Came(HasAge):
    """The messages that a widget has, by topic."""

    def __init__(self, messages: Mapping[str, Any]) -> None:
        self.messages = messages
        super().__post_init__()


class AnyWidget(RobotWidget[Came]):
    """The newest message, whatever its type."""

    _esm, _css = "export default {}", ""

    def update(self, message: Any) -> None:
        """Show a message."""
        self._show(Came({"": message}), self.frame_of(message)[0])

    @property
    def message(self) -> Any:
        """The message on show."""
        return self._newest.sample and self._newest.sample.messages[""]

    def frame_of(self, sample: Any) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`."""
        return {"type": "" if sample is None else type_name(sample)}, b""

    def _pack(self, sample: Came) -> bytes:  # noqa: ARG002
        return b""


class WordsWidget(RobotWidget[Came]):
    """The newest text of each topic, and how many came."""

    _esm, _css = "export default {}", ""
    came: Sequence[tuple[str, str]] = ()
    missed = 0

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.came = []

    def update(self, topic: str, message: Any) -> None:
        """Show a text of a topic."""
        self.came = [*self.came, (topic, message and get(message, "data"))]
        self._show(Came({topic: message}), {})

    def miss(self, count: int) -> None:
        """See `RobotWidget`."""
        self.missed += count

    def frame_of(self, sample: Mapping[str, Any]) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`."""
        return {"texts": {topic: message and message.data for topic, message in sample.items()}}, b""

    def _pack(self, sample: Came) -> bytes:  # noqa: ARG002
        return b""


class FieldsWidget(WordsWidget):
    """The newest number of each field."""

    fields: tuple[str, ...] = ()
    numbers: Mapping[str, float] = {}
    column = "wide"
    _unnamed = 8
    """As many fields may be given by position."""

    def __init__(self, *fields: str, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.fields, self.numbers = fields, {}

    def update(self, topic: str, message: Any) -> None:
        """Show the fields of a topic in its message."""
        if message is not None:
            self.numbers = {**self.numbers, **self._of(topic, message)}
        self._show(Came({topic: message}), {})

    def frame_of(self, sample: Mapping[str, Any]) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`."""
        numbers = {k: v for topic, message in sample.items() if message for k, v in self._of(topic, message).items()}
        return {"names": list(numbers)}, struct.pack(f"<{len(numbers)}d", *numbers.values())

    def _of(self, topic: str, message: Any) -> dict[str, float]:
        own = [field for field in self.fields if field.startswith(f"{topic}.")]
        return {field: float(get(message, field[len(topic) + 1 :])) for field in own}


ANY = OnDemandWidget(name="anything", widget=lambda: AnyWidget)
WORDS = OnDemandWidget(
    name="words",
    types=frozenset({"std_msgs/msg/String"}),
    widget=lambda: WordsWidget,
    shared=True,
    every_message=True,
    goes_stale=False,
)
FIELDS = OnDemandWidget(name="lines", widget=lambda: FieldsWidget, shared=True, plots_fields=True)


@contextmanager
def added() -> Iterator[None]:
    """Add these rows to the table for a while, without any other on-demand rows."""
    before = dict(ON_DEMAND)
    ON_DEMAND.clear()
    try:
        for row in (ANY, WORDS, FIELDS):
            kinds.add(row)
        yield
    finally:
        ON_DEMAND.clear()
        ON_DEMAND.update(before)

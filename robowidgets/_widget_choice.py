"""Which widgets a set of topics gets."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import takewhile
from typing import Any, NamedTuple, Protocol

from .kinds import Widget
from .laser_widget import LaserWidget
from .speed_widget import SpeedWidget
from .touch_widget import TouchWidget

_ORDER = ("laser", "speed", "touch")


class Shown(Protocol):
    """What is to be known of a topic to pick its widget."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def widget(self) -> Widget | None:
        """The widget that shows it; None when none does."""

    @property
    def commanded(self) -> bool:
        """Whether it is a speed that was asked for, not measured."""


class Pick(NamedTuple):
    """A widget for a topic; a measured speed goes with the topic of the commanded one, if there is any.

    ``commanded`` marks a commanded speed that has a widget of its own.
    """

    widget: Widget
    topic: str
    command: str = ""
    commanded: bool = False

    def make(self) -> Any:
        """The widget, with its titles."""
        if self.widget == "laser":
            return LaserWidget(title=self.topic)
        if self.widget == "touch":
            return TouchWidget(title=self.topic)
        bars = "commanded" if self.commanded else "measured"
        return SpeedWidget(title=self.topic, command_title=self.command, bars=bars)


def picks(topics: Iterable[Shown]) -> tuple[Pick, ...]:
    """Lasers, then speeds, then touches. A measured speed gets the first of the commanded ones of its robot."""
    shown = sorted(((t.widget, t) for t in topics if t.widget), key=lambda pair: _ORDER.index(pair[0]))
    speeds = [topic for widget, topic in shown if widget == "speed"]
    command_of = _paired([t.name for t in speeds if not t.commanded], [t.name for t in speeds if t.commanded])
    return tuple(
        Pick(widget, topic.name, command_of.get(topic.name, ""), topic.commanded)
        for widget, topic in shown
        if topic.name not in command_of.values()
    )


def _paired(measured: list[str], commands: list[str]) -> dict[str, str]:
    """By measured speed its command: that with which it shares most of its namespace, unless another shares more."""
    command_of = {}
    for name in measured:
        best = max(commands, key=lambda command: shared(name, command), default="")
        if best and shared(name, best) == max(shared(other, best) for other in measured):
            command_of[name] = best
    return command_of


def shared(one: str, other: str) -> int:
    """How many parts of their namespace two topics share."""
    parts = zip(one.strip("/").split("/")[:-1], other.strip("/").split("/")[:-1], strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], parts))

"""Which widgets a set of topics gets."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple, Protocol

from ._kinds import Widget
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
    """A widget for a topic; a measured speed goes with the topic of the commanded one, if there is any."""

    widget: Widget
    topic: str
    command: str = ""

    def make(self) -> Any:
        """The widget, with its titles."""
        if self.widget == "laser":
            return LaserWidget(title=self.topic)
        if self.widget == "touch":
            return TouchWidget(title=self.topic)
        return SpeedWidget(title=self.topic, command_title=self.command)


def picks(topics: Iterable[Shown]) -> tuple[Pick, ...]:
    """Lasers, then speeds, then touches. The first commanded speed goes to the measured ones, if there are any."""
    shown = sorted(((t.widget, t) for t in topics if t.widget), key=lambda pair: _ORDER.index(pair[0]))
    measured = any(widget == "speed" and not topic.commanded for widget, topic in shown)
    command = next((topic.name for _, topic in shown if topic.commanded), "") if measured else ""
    return tuple(
        Pick(widget, topic.name, command if widget == "speed" and not topic.commanded else "")
        for widget, topic in shown
        if topic.name != command
    )

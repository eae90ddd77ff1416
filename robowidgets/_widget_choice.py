"""The choice of widgets for a set of topics."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import takewhile
from typing import Any, NamedTuple, Protocol

from .kinds import KINDS, Kind, TopicWidget, load


class Shown(Protocol):
    """The properties of a topic that decide its widget."""

    @property
    def name(self) -> str:
        """The name of the topic."""

    @property
    def type(self) -> str:
        """Its message type; several are joined by a comma."""

    @property
    def widget(self) -> str | None:
        """The name of its kind; None if no widget shows it."""

    @property
    def commanded(self) -> bool:
        """Whether its samples are commanded, not measured."""


class WidgetChoice(NamedTuple):
    """A widget for a topic, and the commanded topic that goes with a measured one, if there is any.

    ``commanded`` marks a commanded topic that has a widget of its own. ``second`` is None for the widget of the kind.
    """

    kind: Kind
    topic: str
    command: str = ""
    commanded: bool = False
    second: TopicWidget | None = None

    @property
    def shown(self) -> TopicWidget:
        """The row with the widget, and with what a player shows in it."""
        return self.second or self.kind

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics that the widget shows, its own first."""
        return (self.topic, self.command) if self.command else (self.topic,)

    def make(self) -> Any:
        """The widget, with its titles."""
        widget = load(self.shown.widget)
        if self.second:
            return widget(title=self.topic)
        if not self.kind.commands:
            return widget(title=self.topic, **self.kind.options)
        bars = "commanded" if self.commanded else "measured"
        return widget(title=self.topic, command_title=self.command, bars=bars, **self.kind.options)


def choose_widgets(topics: Iterable[Shown]) -> tuple[WidgetChoice, ...]:
    """A choice for each topic of a kind, in the order of the kinds, without those that go with a measured topic.

    A measured topic gets the first commanded one of its robot. The second widgets of topics come last.
    """
    chosen: list[WidgetChoice] = []
    listed = list(topics)
    for kind in KINDS.values():
        shown = [topic for topic in listed if topic.widget == kind.name]
        command_of = _paired([t.name for t in shown if not t.commanded], [t.name for t in shown if t.commanded])
        chosen.extend(
            WidgetChoice(kind, topic.name, command_of.get(topic.name, ""), topic.commanded)
            for topic in shown
            if topic.name not in command_of.values()
        )
    types = {topic.name: topic.type for topic in listed}
    more = [
        WidgetChoice(choice.kind, choice.topic, second=second)
        for choice in chosen
        if not choice.commanded
        for second in choice.kind.second_widgets(types[choice.topic])
    ]
    return (*chosen, *more)


def _paired(measured: list[str], commands: list[str]) -> dict[str, str]:
    """The commanded topic of each measured one: the one with most of its namespace, unless another shares more."""
    command_of = {}
    for name in measured:
        best = max(commands, key=lambda command: shared(name, command), default="")
        if best and shared(name, best) == max(shared(other, best) for other in measured):
            command_of[name] = best
    return command_of


def shared(one: str, other: str) -> int:
    """The number of parts of the namespace that two topics share."""
    parts = zip(one.strip("/").split("/")[:-1], other.strip("/").split("/")[:-1], strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], parts))

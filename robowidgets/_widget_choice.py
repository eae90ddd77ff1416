"""The choice of widgets for a set of topics."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import takewhile
from typing import NamedTuple, Protocol

from ._core.sample_widget import SampleWidget
from .kinds import KINDS, Kind, Role, TopicWidget, by_namespace, load, namespace_of, title_of


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
    """A widget, and the topics that it shows in their roles: those in its first role, then those that go with them.

    Where a widget shows another role alone, that is its first. ``second`` is None for the widget of the kind.
    """

    kind: Kind
    parts: tuple[tuple[Role, str], ...]
    second: TopicWidget | None = None

    @property
    def shown(self) -> TopicWidget:
        """The row with the widget, and with what a player shows in it."""
        return self.second or self.kind

    @property
    def role(self) -> Role:
        """The first role."""
        return self.parts[0][0]

    @property
    def topic(self) -> str:
        """The first topic."""
        return self.parts[0][1]

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics that the widget shows, the first one first."""
        return tuple(topic for _, topic in self.parts)

    @property
    def own(self) -> tuple[str, ...]:
        """Those in its first role."""
        return tuple(topic for role, topic in self.parts if role is self.role)

    @property
    def titles(self) -> tuple[str, ...]:
        """What it shows, for a person: its topics, or the namespace of several that share it, the first one first."""
        return (title_of(self.own), *self.topics[len(self.own) :])

    def is_like(self, other: WidgetChoice) -> bool:
        """Whether the widget of another choice is the one for this, too: not all of its topics are the same."""
        return self._place == other._place

    @property
    def _place(self) -> tuple[TopicWidget, Role, str]:
        return self.shown, self.role, namespace_of(self.topic) if self.role.each else self.topic

    def method(self, role: Role) -> str:
        """The method of the widget that takes the messages of a role."""
        return "update" if role is self.role else role.take

    def make(self) -> SampleWidget:
        """The widget, with its titles."""
        widget: Callable[..., SampleWidget] = load(self.shown.widget)
        if self.second:
            return widget(title=self.titles[0])
        titles = {f"{role.take}_title": topic for role, topic in self.parts if role is not self.role}
        return widget(title=self.titles[0], **titles, **self.kind.options, **(self.role.alone or {}))


def choose_widgets(topics: Iterable[Shown]) -> tuple[WidgetChoice, ...]:
    """The widgets for topics, in the order of the kinds; second widgets come last.

    There is one for each topic in the first role of its kind, or for all of its namespace, and one for each topic in
    another role that goes with none of these, where the role may be alone.
    """
    listed = list(topics)
    chosen = [choice for kind in KINDS.values() for choice in _of_kind(kind, listed)]
    types = {topic.name: topic.type for topic in listed}
    more = [
        WidgetChoice(choice.kind, tuple((choice.role, name) for name in choice.own), second)
        for choice in chosen
        if not choice.role.commanded
        for second in choice.kind.second_widgets(types[choice.topic])
    ]
    return (*chosen, *more)


def _of_kind(kind: Kind, listed: list[Shown]) -> list[WidgetChoice]:
    """The widgets of one kind, in the order in which their first topics are listed."""
    first, *others = kind.roles
    own = _in_role(kind, first, listed)
    groups = by_namespace(own).values() if first.each else [[name] for name in own]
    parts = {group[0]: [(first, name) for name in group] for group in groups}
    alone: list[WidgetChoice] = []
    for role in others:
        there = _in_role(kind, role, listed)
        goes_with = _paired(list(parts), there)
        for name, other in goes_with.items():
            parts[name].append((role, other))
        if role.required:
            parts = {name: some for name, some in parts.items() if name in goes_with}
        if role.alone is not None:
            alone += [WidgetChoice(kind, ((role, name),)) for name in there if name not in goes_with.values()]
    chosen = [*(WidgetChoice(kind, tuple(some)) for some in parts.values()), *alone]
    place = {topic.name: i for i, topic in enumerate(listed)}
    return sorted(chosen, key=lambda choice: place[choice.topic])


def _in_role(kind: Kind, role: Role, listed: list[Shown]) -> list[str]:
    return [t.name for t in listed if t.widget == (role.kind or kind.name) and t.commanded == role.commanded]


def _paired(own: list[str], others: list[str]) -> dict[str, str]:
    """The topic that goes with each: the one with most of its namespace, unless another shares more with that."""
    goes_with = {}
    for name in own:
        best = max(others, key=lambda other: shared(name, other), default="")
        if best and shared(name, best) == max(shared(one, best) for one in own):
            goes_with[name] = best
    return goes_with


def shared(one: str, other: str) -> int:
    """The number of parts of the namespace that two topics share."""
    parts = zip(one.strip("/").split("/")[:-1], other.strip("/").split("/")[:-1], strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], parts))

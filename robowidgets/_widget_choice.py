"""The choice of widgets for a set of topics."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import takewhile
from typing import NamedTuple, Protocol

from ._core.sample_widget import SampleWidget
from .kinds import (
    ASKED,
    KINDS,
    Asked,
    Kind,
    Role,
    TopicWidget,
    asked_of_fields,
    asked_of_type,
    by_namespace,
    load,
    namespace_of,
    title_of,
    topic_and_field,
)

FEW = 4
"""Most widgets of those that are asked for, where nobody asked and no topic has another."""


_ALONG = Role(name="along", take="put")
"""Of what joins or completes the topics that a widget gathers."""


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

    Where a widget shows another role alone, that is its first. ``second`` is None for the widget of the kind. Of a
    widget of fields, ``fields`` are those that it shows, as they were asked for.
    """

    kind: Kind | Asked
    parts: tuple[tuple[Role, str], ...]
    second: TopicWidget | None = None
    fields: tuple[str, ...] = ()

    @property
    def shown(self) -> TopicWidget:
        """The row with the widget, and with what a player shows in it."""
        return self.second or self.kind

    @property
    def takes_messages(self) -> bool:
        """Whether the widget takes messages as they are, and not samples."""
        return isinstance(self.kind, Asked)

    @property
    def gathers(self) -> bool:
        """Whether the widget has all topics that it is asked for."""
        return isinstance(self.kind, Asked) and self.kind.gathers

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
        if self.gathers:
            return (", ".join(self.own),)
        return (title_of(self.own), *self.topics[len(self.own) :])

    def is_like(self, other: WidgetChoice) -> bool:
        """Whether the widget of another choice is the one for this, too: not all of its topics are the same."""
        return self._place == other._place

    @property
    def _place(self) -> tuple[TopicWidget, Role, str]:
        if self.gathers:
            return self.shown, self.role, ", ".join(self.fields)
        return self.shown, self.role, namespace_of(self.topic) if self.role.each else self.topic

    def method(self, role: Role) -> str:
        """The method of the widget that takes the messages of a role."""
        return "update" if role is self.role else role.take

    def make(self) -> SampleWidget:
        """The widget, with its titles."""
        widget: Callable[..., SampleWidget] = load(self.shown.widget)
        if self.second:
            return widget(title=self.titles[0])
        if isinstance(self.kind, Asked):
            return widget(*self.fields, title=self.titles[0], **self.kind.options)
        titles = {f"{role.take}_title": topic for role, topic in self.parts if role is not self.role}
        return widget(title=self.titles[0], **titles, **self.kind.options, **(self.role.alone or {}))


def choose_widgets(
    topics: Iterable[Shown], names: Sequence[str] = (), can_show: Callable[[str], bool] = lambda _: True
) -> tuple[WidgetChoice, ...]:
    """The widgets for topics, in the order of the kinds; then second widgets, then those that are asked for.

    There is one for each topic in the first role of its kind, or for all of its namespace, and one for each topic in
    another role that goes with none of these, where the role may be alone.

    Args:
        topics: those there are.
        names: what is asked for: names of topics, or of fields, ``"/odom.twist.twist.linear.x"``. None: all topics that
            have a kind; where none has one, a few widgets that show what there is.
        can_show: whether a topic without a kind is one of those few.
    """
    listed = list(topics)
    if not names:
        return _by_kind(listed) or _asked_for([(one.name, "") for one in listed if can_show(one.name)], listed)[:FEW]
    wanted = [topic_and_field(name, [topic.name for topic in listed]) for name in names]
    whole = {name for name, field in wanted if not field}
    chosen = _by_kind([topic for topic in listed if topic.name in whole])
    asked = _asked_for(wanted, listed)
    gathering = {choice.shown: choice for choice in asked if choice.gathers}
    joining = [choice for choice in chosen if choice.second in gathering]
    for choice in joining:
        row = gathering[choice.shown]
        gathering[choice.shown] = row._replace(parts=(*((row.role, name) for name in choice.own), *row.parts))
    return (
        *(choice for choice in chosen if choice not in joining),
        *(gathering.get(choice.shown, choice) for choice in asked),
    )


def _by_kind(listed: list[Shown]) -> tuple[WidgetChoice, ...]:
    """The widgets of topics that have a kind, and their second ones."""
    chosen = [choice for kind in KINDS.values() for choice in _of_kind(kind, listed)]
    types = {topic.name: topic.type for topic in listed}
    more = [
        WidgetChoice(choice.kind, tuple((choice.role, name) for name in choice.own), second)
        for choice in chosen
        if not choice.role.commanded and isinstance(choice.kind, Kind)
        for second in choice.kind.second_widgets(types[choice.topic])
    ]
    return (*chosen, *more)


def _asked_for(wanted: Iterable[tuple[str, str]], listed: list[Shown]) -> tuple[WidgetChoice, ...]:
    """The widgets of topics without a kind, and of fields: the most useful first."""
    there = {topic.name: topic for topic in listed}
    wanted = list(dict.fromkeys(wanted))
    found: dict[str, list[str]] = {}
    for name, field in wanted:
        topic = there.get(name)
        row = None
        if topic is not None and (field or not topic.widget):
            row = asked_of_fields() if field else asked_of_type(topic.type)
        if row is not None and name not in found.setdefault(row.name, []):
            found[row.name].append(name)
    fields = tuple(f"{name}.{field}" for name, field in wanted if field)  # of topics that are not there yet, too
    choices: list[WidgetChoice] = []
    for row in sorted((row for row in ASKED.values() if row.name in found), key=lambda row: not row.types):
        names = found[row.name]
        groups = [names] if row.gathers else [[name] for name in names]
        for group in groups:
            others = [one.name for one in listed if one.name not in group and row.takes_along(one.type)]
            parts = (*((row.roles[0], name) for name in group), *((_ALONG, name) for name in others))
            choices.append(WidgetChoice(row, parts, fields=fields if row.of_fields else ()))
    return tuple(choices)


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

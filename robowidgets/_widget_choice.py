"""The choice of widgets for a set of topics."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import takewhile
from typing import Any, NamedTuple, Protocol

from ._core.sample_widget import SampleWidget
from ._layout import added_classes
from .kinds import (
    ASKED,
    KINDS,
    LASER,
    SCAN,
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

AS = " as "
"""Between a topic and the name of the widget that is to show it."""


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
    def asked(self) -> tuple[str, ...]:
        """The topics that it is there for: without those that it only takes along."""
        return self.own if self.gathers else self.topics

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
            classes = added_classes(widget.column)  # type: ignore[attr-defined]  # of the class
            return widget(*self.fields, title=self.titles[0], _dom_classes=classes, **self.kind.options)
        titles = {f"{role.take}_title": topic for role, topic in self.parts if role is not self.role}
        return widget(title=self.titles[0], **titles, **self.kind.options, **(self.role.alone or {}))


Entry = str | Sequence[str]
"""What is asked for: a topic, a field, either with the widget that is to show it, ``"/scan as message"``, or the fields
that share a widget."""


class AskedFor(NamedTuple):
    """A name that was asked for: its topic, its field or empty, and the name of the row or empty."""

    topic: str
    field: str = ""
    row: str = ""


def wish_of(name: str, known: Collection[str]) -> AskedFor:
    """The topics that a name requests, among those that exist."""
    shown, by, row = name.rpartition(AS)
    if name not in known and by and row in _rows():
        return AskedFor(*topic_and_field(shown, known), row)
    return AskedFor(*topic_and_field(name, known))


def why_no_plot(wish: AskedFor, types: str) -> str:
    """Return why the widget that is asked for shows nothing of a topic: it needs a field; empty if it shows some."""
    row = ASKED.get(wish.row)
    if row is None or not row.of_fields or wish.field or row.fields_of(types):
        return ""
    return f"'{wish.topic}{AS}{wish.row}' names no field of its messages to show; name one, as '{wish.topic}.FIELD'"


def wishes(entries: Iterable[Entry], known: Collection[str]) -> list[AskedFor]:
    """What each of some entries asks for."""
    return [wish_of(name, known) for entry in entries for name in ([entry] if isinstance(entry, str) else entry)]


def choose_widgets(topics: Iterable[Shown], entries: Sequence[Entry] | None = None) -> tuple[WidgetChoice, ...]:
    """The widgets for topics, in the order of the kinds; then second widgets, then those that are asked for.

    There is one for each topic in the first role of its kind, or for all of its namespace, and one for each topic in
    another role that goes with none of these, where the role may be alone.

    Args:
        topics: those there are.
        entries: what is asked for; None: all topics that have a kind.
    """
    listed = list(topics)
    if entries is None:
        return _by_kind(listed)
    # Of several types under one name, that which is shown.
    known = {topic.name: topic for topic in listed} | {topic.name: topic for topic in listed if topic.widget}
    asked = wishes([entry for entry in entries if isinstance(entry, str)], known)
    whole = {wish.topic for wish in asked if not wish.field and not wish.row}
    chosen = list(_by_kind([topic for topic in listed if topic.name in whole]))
    for wish in asked:
        if wish.row not in ("", *ASKED) and wish.topic in known:
            there = [choice for choice in _by_kind([known[wish.topic]]) if choice.shown.name == wish.row]
            chosen += [choice for choice in there if choice not in chosen]
    more = _asked_for(asked, known)
    for entry in entries:
        if not isinstance(entry, str):
            fields = [one for wish in wishes(entry, known) for one in (_fields_of(wish, known) or [wish])]
            more += [choice for choice in _asked_for(fields, known) if choice not in more]
    gathering = {choice.shown: choice for choice in more if choice.gathers and not choice.fields}
    joining = [choice for choice in chosen if choice.second in gathering]
    for choice in joining:
        row = gathering[choice.shown]
        own = tuple((row.role, name) for name in choice.own if name not in row.topics)
        gathering[choice.shown] = row._replace(parts=(*own, *row.parts))
    return (
        *(choice for choice in chosen if choice not in joining),
        *(choice if choice.fields else gathering.get(choice.shown, choice) for choice in more),
    )


def choose_instead(topics: Iterable[Shown], can_show: Callable[[str], bool]) -> list[str]:
    """The few topics that are shown where none has a kind, the most useful first."""
    known = {topic.name: topic for topic in topics if asked_of_type(topic.type) and can_show(topic.name)}
    return [name for choice in _asked_for([AskedFor(name) for name in known], known)[:FEW] for name in choice.topics]


class OnShow:
    """What a view shows: what it was asked for, and what a person has added and taken off since.

    Args:
        entries: what it was asked for; none: all topics that have a kind, or a few where none has.
    """

    def __init__(self, entries: Sequence[Entry] = ()) -> None:
        self._asked = self._base = _frozen(entries)
        self._more: list[Entry] = []
        self._off: set[Entry] = set()

    def keep(self, earlier: OnShow) -> None:
        """Take over what was changed in the view of an earlier run of the cell, if it asked for the same."""
        if self._asked == earlier._asked:
            self._base, self._more, self._off = list(earlier._base), list(earlier._more), set(earlier._off)

    def arrange(self, entries: Sequence[Entry]) -> None:
        """Show these in place of all others."""
        self._base, self._more, self._off = _frozen(entries), [], set()

    def entries(self, topics: Sequence[Shown], can_show: Callable[[str], bool]) -> list[Entry]:
        """What is to be shown of the topics that there are.

        Args:
            topics: those there are.
            can_show: whether a topic without a kind is one of the few that are shown where none has one.
        """
        base: list[Entry] = list(self._base) or [topic.name for topic in topics if topic.widget]
        base = base or [*choose_instead(topics, can_show)]
        every = [*base, *(entry for entry in self._more if entry not in base)]
        return [entry for entry in every if entry not in self._off]

    def add(self, entry: Entry) -> None:
        """Show a topic or a field, too, or fields together."""
        self._off.discard(entry)
        if entry not in self._more:
            self._more.append(entry)

    def take_off(self, entries: Iterable[Entry]) -> None:
        """Show these no more."""
        for entry in entries:
            if entry in self._more:
                self._more.remove(entry)
            self._off.add(entry)

    def toggle(self, entry: Entry) -> None:
        """Show a topic that was added no more, else show it, too."""
        if entry in self._more and entry not in self._off:
            self.take_off([entry])
        else:
            self.add(entry)


def of_topic(topic: str, entries: Iterable[Entry], known: Collection[str]) -> list[Entry]:
    """Those entries that ask for a topic, or for a field of it."""
    return [entry for entry in entries if any(wish.topic == topic for wish in wishes([entry], known))]


def _frozen(entries: Iterable[Entry]) -> list[Entry]:
    return [entry if isinstance(entry, str) else tuple(entry) for entry in entries]


def checked_arrangement(value: Any) -> list[Entry]:
    """What `arrangement` of a view was, as a program gives it again.

    Raises:
        TypeError: it is no list of names, and of lists of them.
    """
    each: list[Any] = [None] if isinstance(value, str) or not isinstance(value, Sequence) else list(value)
    for entry in each:
        names = [entry] if isinstance(entry, str) else entry
        if not isinstance(names, Sequence) or not names or not all(isinstance(name, str) and name for name in names):
            raise TypeError(
                "arrangement: expected a list of topics and fields, and of lists of fields that share a plot, as "
                f"view.arrangement returns it, got {value!r}"
            )
    return _frozen(each)


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


def _row_of(wish: AskedFor, topic: Shown) -> Asked | None:
    """Return the row of the widget that a topic without a kind, or a field, has; None if it has another widget."""
    if wish.row == LASER.name and not SCAN.types.isdisjoint(topic.type.split(", ")):
        return SCAN
    if wish.row:
        return ASKED.get(wish.row)
    if wish.field:
        return asked_of_fields()
    return None if topic.widget else asked_of_type(topic.type)


def _fields_of(wish: AskedFor, known: Mapping[str, Shown]) -> list[AskedFor]:
    """Return the fields that are shown of a topic that is asked for by its name alone; empty for another widget."""
    topic = known.get(wish.topic)
    row = _row_of(wish, topic) if topic is not None and not wish.field else None
    if topic is None or row is None or not row.of_fields:
        return []
    return [AskedFor(topic.name, field) for field in row.fields_of(topic.type)]


def _asked_for(asked: Sequence[AskedFor], known: Mapping[str, Shown]) -> list[WidgetChoice]:
    """The widgets of topics without a kind, and of fields: the most useful first."""
    found: dict[str, list[str]] = {}
    plots: list[WidgetChoice] = []
    for wish in dict.fromkeys(asked):
        topic = known.get(wish.topic)
        row = None if topic is None else _row_of(wish, topic)
        if row is None:
            continue
        if row.of_fields and not wish.field:
            if fields := tuple(f"{one.topic}.{one.field}" for one in _fields_of(wish, known)):
                plots.append(WidgetChoice(row, ((row.roles[0], wish.topic),), fields=fields))
        elif wish.topic not in found.setdefault(row.name, []):
            found[row.name].append(wish.topic)
    # Of topics that are not there yet, too.
    fields = tuple(dict.fromkeys(f"{wish.topic}.{wish.field}" for wish in asked if wish.field))
    choices: list[WidgetChoice] = []
    for row in sorted(ASKED.values(), key=lambda row: not row.types):
        names = found.get(row.name, [])
        for group in ([names] if names else []) if row.gathers else [[name] for name in names]:
            others = [one.name for one in known.values() if one.name not in group and row.takes_along(one.type)]
            parts = (*((row.roles[0], name) for name in group), *((_ALONG, name) for name in others))
            choices.append(WidgetChoice(row, parts, fields=fields if row.of_fields else ()))
        choices += [one for one in dict.fromkeys(plots) if one.kind is row and one not in choices]
    return choices


def _rows() -> set[str]:
    """The names of all widgets of topics."""
    seconds = (second.name for kind in KINDS.values() for second in kind.also)
    return {*KINDS, *ASKED, *seconds}


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

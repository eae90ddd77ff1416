"""The choice of widgets for a set of topics."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import takewhile
from typing import Any, NamedTuple, Protocol

from ..widget.cards import checked_cards, topics_of
from ..widget.sample_widget import SampleWidget
from . import (
    KINDS,
    ON_DEMAND,
    Kind,
    OnDemandWidget,
    Role,
    TopicWidget,
    by_namespace,
    namespace_of,
    on_demand_for_fields,
    on_demand_for_type,
    title_of,
    topic_and_field,
)

FEW = 4
"""The most on-demand widgets that are shown by default if no topic has another widget."""

AS = " as "
"""The separator between a topic and the name of a widget for it."""


_COMPANION = Role(name="companion", take="put")
"""The role of topics that connect or complete the topics of a shared widget."""


ROW_COLUMNS = ("wide", "map")
"""Columns whose widgets get a row of their own when they are added."""


class ListedTopic(Protocol):
    """A topic in a list, with the properties that decide its widget."""

    @property
    def name(self) -> str:
        """The name of the topic."""

    @property
    def type(self) -> str:
        """Its message type. Several types are joined by commas."""

    @property
    def widget(self) -> str | None:
        """The name of its kind, or None if no widget shows it."""

    @property
    def commanded(self) -> bool:
        """True if its samples are commanded, not measured."""


class WidgetChoice(NamedTuple):
    """A widget, and its topics with their roles: the topics in its first role, then the topics that go with them.

    If a widget shows only another role, that is its first. ``second`` is None for the widget of the kind. ``fields``
    are the requested fields, for a widget of fields.
    """

    kind: Kind | OnDemandWidget
    parts: tuple[tuple[Role, str], ...]
    second: TopicWidget | None = None
    fields: tuple[str, ...] = ()

    @property
    def shown(self) -> TopicWidget:
        """The row with the widget, and with its frames in a player."""
        return self.second or self.kind

    @property
    def takes_messages(self) -> bool:
        """True if the widget takes messages unchanged, and not samples."""
        return isinstance(self.kind, OnDemandWidget)

    @property
    def shared(self) -> bool:
        """True if one widget shows all topics for which it is requested."""
        return isinstance(self.kind, OnDemandWidget) and self.kind.shared

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
        """All topics of the widget, the first one first."""
        return tuple(topic for _, topic in self.parts)

    @property
    def own(self) -> tuple[str, ...]:
        """The topics in its first role."""
        return tuple(topic for role, topic in self.parts if role is self.role)

    @property
    def card_name(self) -> str:
        """The name of its widget in an arrangement by hand, which no other widget of the view has."""
        if self.fields:
            return ", ".join(self.fields)
        return f"{self.topic}{AS}{self.shown.name}" if self.second or self.takes_messages else self.topic

    @property
    def requested(self) -> tuple[str, ...]:
        """The topics for which the widget exists, without topics that only complete them."""
        return self.own if self.shared else self.topics

    @property
    def titles(self) -> tuple[str, ...]:
        """Its titles: its topics, or the namespace of several topics that share it, the first one first."""
        if self.shared:
            return (", ".join(self.own),)
        return (title_of(self.own), *self.topics[len(self.own) :])

    def is_like(self, other: WidgetChoice) -> bool:
        """Return True if another choice means the same widget, although not all topics may be the same."""
        return self._place == other._place

    @property
    def _place(self) -> tuple[TopicWidget, Role, str]:
        if self.shared:
            return self.shown, self.role, ", ".join(self.fields)
        return self.shown, self.role, namespace_of(self.topic) if self.role.combine else self.topic

    def method(self, role: Role) -> str:
        """Return the method of the widget that takes the messages of a role."""
        return "update" if role is self.role else role.take

    def make(self) -> SampleWidget:
        """Return the widget, with its titles."""
        assert self.shown.widget is not None  # only such rows are chosen
        widget_class = self.shown.widget()
        widget: Callable[..., SampleWidget] = widget_class
        if self.second:
            return widget(title=self.titles[0])
        if isinstance(self.kind, OnDemandWidget):
            classes = _added_classes(widget_class.column)
            return widget(*self.fields, title=self.titles[0], _dom_classes=classes, **self.kind.options)
        titles = {f"{role.take}_title": topic for role, topic in self.parts if role is not self.role}
        named = {trait: title for trait, title in titles.items() if hasattr(widget_class, trait)}
        return widget(title=self.titles[0], **named, **self.kind.options, **(self.role.standalone_options or {}))


Entry = str | Sequence[str]
"""A request: a topic or a field, optionally with the name of a widget, as in ``"/scan as message"``; or the fields that
share a widget."""


class TopicRequest(NamedTuple):
    """A requested name: its topic, its field or empty, and the name of a row or empty."""

    topic: str
    field: str = ""
    row: str = ""


def parse_request(name: str, known: Collection[str]) -> TopicRequest:
    """Return the request in a name, given the known topics."""
    shown, by, row = name.rpartition(AS)
    if name not in known and by and row in _rows():
        return TopicRequest(*topic_and_field(shown, known), row)
    return TopicRequest(*topic_and_field(name, known))


def why_no_plot(request: TopicRequest, types: str) -> str:
    """Return why a requested widget can show nothing of a topic without a field, or empty if it can."""
    row = ON_DEMAND.get(request.row)
    if row is None or not row.plots_fields or request.field or row.default_fields(types):
        return ""
    name = f"{request.topic}{AS}{request.row}"
    return f"{name!r} names no field of its messages to show; name one, as '{request.topic}.FIELD'"


def parse_requests(entries: Iterable[Entry], known: Collection[str]) -> list[TopicRequest]:
    """Return the requests in entries."""
    return [parse_request(name, known) for entry in entries for name in ([entry] if isinstance(entry, str) else entry)]


def choose_widgets(topics: Iterable[ListedTopic], entries: Sequence[Entry] | None = None) -> tuple[WidgetChoice, ...]:
    """Return the widgets for topics, in the order of the kinds; then second widgets, then requested widgets.

    Each topic in the first role of its kind gets a widget, or each namespace of such topics. A topic in another role
    without such a partner gets a widget if the role can stand alone.

    Args:
        topics: the available topics.
        entries: the requests; by default all topics that have a kind.
    """
    listed = list(topics)
    if entries is None:
        return _by_kind(listed)
    # If a name has several types, prefer the type with a widget.
    known = {topic.name: topic for topic in listed} | {topic.name: topic for topic in listed if topic.widget}
    requests = parse_requests([entry for entry in entries if isinstance(entry, str)], known)
    whole = {request.topic for request in requests if not request.field and not request.row}
    chosen = list(_by_kind([topic for topic in listed if topic.name in whole]))
    for request in requests:
        if request.row not in ("", *ON_DEMAND) and request.topic in known:
            there = [choice for choice in _by_kind([known[request.topic]]) if choice.shown.name == request.row]
            chosen += [choice for choice in there if choice not in chosen]
    has_widget = {topic for choice in chosen for topic in choice.topics}
    more = _on_demand_choices([one for one in requests if one[1:] != ("", "") or one.topic not in has_widget], known)
    for entry in entries:
        if not isinstance(entry, str):
            fields = [
                one for request in parse_requests(entry, known) for one in (_fields_of(request, known) or [request])
            ]
            more += [choice for choice in _on_demand_choices(fields, known) if choice not in more]
    sharing = {choice.shown: choice for choice in more if choice.shared and not choice.fields}
    joining = [choice for choice in chosen if choice.second in sharing]
    for choice in joining:
        row = sharing[choice.shown]
        own = tuple((row.role, name) for name in choice.own if name not in row.topics)
        sharing[choice.shown] = row._replace(parts=(*own, *row.parts))
    return (
        *(choice for choice in chosen if choice not in joining),
        *(choice if choice.fields else sharing.get(choice.shown, choice) for choice in more),
    )


def choose_instead(topics: Iterable[ListedTopic], can_show: Callable[[str], bool]) -> list[str]:
    """Return the few topics to show if no topic has a kind, the most useful first."""
    known = {topic.name: topic for topic in topics if on_demand_for_type(topic.type) and can_show(topic.name)}
    return [
        name
        for choice in _on_demand_choices([TopicRequest(name) for name in known], known)[:FEW]
        for name in choice.topics
    ]


class TopicSelection:
    """The selection of a view: the requested entries, and the changes of the user since.

    Args:
        entries: the requests. If empty, all topics that have a kind, or a few if no topic has one.
    """

    def __init__(self, entries: Sequence[Entry] = ()) -> None:
        self._requested = self._base = _frozen(entries)
        self._more: list[Entry] = []
        self._off: set[Entry] = set()

    def keep(self, earlier: TopicSelection) -> None:
        """Take over the user's changes from the view of an earlier run of the cell, if the requests are the same."""
        if self._requested == earlier._requested:
            self._base, self._more, self._off = list(earlier._base), list(earlier._more), set(earlier._off)

    def arrange(self, entries: Sequence[Entry]) -> None:
        """Show only these entries."""
        self._base, self._more, self._off = _frozen(entries), [], set()

    def entries(self, topics: Sequence[ListedTopic], can_show: Callable[[str], bool]) -> list[Entry]:
        """Return the entries to show.

        Args:
            topics: the available topics.
            can_show: returns True for a topic without a kind that may be shown if no topic has a kind.
        """
        base: list[Entry] = list(self._base) or [topic.name for topic in topics if topic.widget]
        base = base or [*choose_instead(topics, can_show)]
        every = [*base, *(entry for entry in self._more if entry not in base)]
        return [entry for entry in every if entry not in self._off]

    def add(self, entry: Entry) -> None:
        """Add a topic, a field, or fields that share a widget."""
        self._off.discard(entry)
        if entry not in self._more:
            self._more.append(entry)

    def take_off(self, entries: Iterable[Entry]) -> None:
        """Remove entries."""
        for entry in entries:
            if entry in self._more:
                self._more.remove(entry)
            self._off.add(entry)

    def toggle(self, entry: Entry) -> None:
        """Remove an entry that was added before, else add it."""
        if entry in self._more and entry not in self._off:
            self.take_off([entry])
        else:
            self.add(entry)


def of_topic(topic: str, entries: Iterable[Entry], known: Collection[str]) -> list[Entry]:
    """Return the entries that request a topic, or a field of it."""
    return [entry for entry in entries if any(request.topic == topic for request in parse_requests([entry], known))]


def _frozen(entries: Iterable[Entry]) -> list[Entry]:
    return [entry if isinstance(entry, str) else tuple(entry) for entry in entries]


def checked_arrangement(value: Any) -> list[Entry]:
    """Return the checked topics of an `arrangement` of a view, which a program sets again.

    Raises:
        TypeError, ValueError: its topics are not a list of names and of lists of names, or its cards are wrong.
    """
    checked_cards(value)
    value = topics_of(value)
    each: list[Any] = [None] if isinstance(value, str) or not isinstance(value, Sequence) else list(value)
    for entry in each:
        names = [entry] if isinstance(entry, str) else entry
        if not isinstance(names, Sequence) or not names or not all(isinstance(name, str) and name for name in names):
            raise TypeError(
                "arrangement: expected a list of topics and fields, and of lists of fields that share a plot, as "
                f"view.arrangement returns it, got {value!r}"
            )
    return _frozen(each)


def _by_kind(listed: list[ListedTopic]) -> tuple[WidgetChoice, ...]:
    """Return the widgets of topics that have a kind, and their second widgets."""
    chosen = [choice for kind in KINDS.values() for choice in _of_kind(kind, listed)]
    types = {topic.name: topic.type for topic in listed}
    more = [
        WidgetChoice(choice.kind, tuple((choice.role, name) for name in choice.own), second)
        for choice in chosen
        if not choice.role.commanded and isinstance(choice.kind, Kind)
        for second in choice.kind.second_widgets(types[choice.topic])
    ]
    return (*chosen, *more)


def _row_of(request: TopicRequest, topic: ListedTopic) -> OnDemandWidget | None:
    """Return the row of the widget for a topic without a kind, or for a field; None if it has another widget."""
    if request.row:
        types = {*topic.type.split(", ")}
        others = (row for row in ON_DEMAND.values() if row.instead_of == request.row and row.types & types)
        return next(others, ON_DEMAND.get(request.row))
    if request.field:
        return on_demand_for_fields()
    has_own = topic.widget and KINDS[topic.widget].widget
    return None if has_own else on_demand_for_type(topic.type)


def _fields_of(request: TopicRequest, known: Mapping[str, ListedTopic]) -> list[TopicRequest]:
    """Return the default fields of a topic that is requested without a field; empty for another widget."""
    topic = known.get(request.topic)
    row = _row_of(request, topic) if topic is not None and not request.field else None
    if topic is None or row is None or not row.plots_fields:
        return []
    return [TopicRequest(topic.name, field) for field in row.default_fields(topic.type)]


def _on_demand_choices(requests: Sequence[TopicRequest], known: Mapping[str, ListedTopic]) -> list[WidgetChoice]:
    """Return the widgets of topics without a kind, and of fields, the most useful first."""
    found: dict[str, list[str]] = {}
    plots: list[WidgetChoice] = []
    for request in dict.fromkeys(requests):
        topic = known.get(request.topic)
        row = None if topic is None else _row_of(request, topic)
        if row is None:
            continue
        if row.plots_fields and not request.field:
            if fields := tuple(f"{one.topic}.{one.field}" for one in _fields_of(request, known)):
                plots.append(WidgetChoice(row, ((row.roles[0], request.topic),), fields=fields))
        elif request.topic not in found.setdefault(row.name, []):
            found[row.name].append(request.topic)
    # Including fields of topics that do not exist yet.
    fields = tuple(dict.fromkeys(f"{request.topic}.{request.field}" for request in requests if request.field))
    choices: list[WidgetChoice] = []
    for row in sorted(ON_DEMAND.values(), key=lambda row: not row.types):
        names = found.get(row.name, [])
        for group in ([names] if names else []) if row.shared else [[name] for name in names]:
            others = [one.name for one in known.values() if one.name not in group and row.is_companion(one.type)]
            parts = (*((row.roles[0], name) for name in group), *((_COMPANION, name) for name in others))
            choices.append(WidgetChoice(row, parts, fields=fields if row.plots_fields else ()))
        choices += [one for one in dict.fromkeys(plots) if one.kind is row and one not in choices]
    return choices


def _rows() -> set[str]:
    """Return the names of all widgets of topics."""
    seconds = (second.name for kind in KINDS.values() for second in kind.also)
    return {*KINDS, *ON_DEMAND, *seconds}


def _of_kind(kind: Kind, listed: list[ListedTopic]) -> list[WidgetChoice]:
    """Return the widgets of one kind, in the order of their first topics."""
    if kind.widget is None:
        return []
    first, *others = kind.roles
    own = _in_role(kind, first, listed)
    groups = by_namespace(own).values() if first.combine else [[name] for name in own]
    parts = {group[0]: [(first, name) for name in group] for group in groups}
    alone: list[WidgetChoice] = []
    for role in others:
        there = _in_role(kind, role, listed)
        goes_with = _paired(list(parts), there)
        for name, other in goes_with.items():
            parts[name].append((role, other))
        if role.standalone_options is not None:
            alone += [WidgetChoice(kind, ((role, name),)) for name in there if name not in goes_with.values()]
    chosen = [*(WidgetChoice(kind, tuple(some)) for some in parts.values()), *alone]
    place = {topic.name: i for i, topic in enumerate(listed)}
    return sorted(chosen, key=lambda choice: place[choice.topic])


def _in_role(kind: Kind, role: Role, listed: list[ListedTopic]) -> list[str]:
    name = (role.kind or kind).name
    return [t.name for t in listed if t.widget == name and t.commanded == role.commanded]


def _paired(own: list[str], others: list[str]) -> dict[str, str]:
    """Return the partner of each topic: the one that shares most of its namespace and no more with another topic."""
    goes_with = {}
    for name in own:
        best = max(others, key=lambda other: shared_depth(name, other), default="")
        if best and shared_depth(name, best) == max(shared_depth(one, best) for one in own):
            goes_with[name] = best
    return goes_with


def shared_depth(one: str, other: str) -> int:
    """Return the number of parts of a topic that are in the namespace of another: 1 for /gas and /gas/status."""
    parts = zip(one.strip("/").split("/"), other.strip("/").split("/")[:-1], strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], parts))


def _added_classes(column: str) -> list[str]:
    """Return the classes of a widget that is added to a screen.

    It needs them from the start: in the page, the view of a new widget misses changes soon after its creation.
    """
    return ["rw-added", *(["rw-added-row"] if column in ROW_COLUMNS else [])]

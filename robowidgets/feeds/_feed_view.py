"""A running robot on one screen: Stop, the widgets of its topics and its program, and a status line."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, Protocol

from ..behaviors.machine import Machine
from ..events_widget import EventsWidget
from ..kinds import on_demand_for_type
from ..kinds.choice import (
    Entry,
    TopicSelection,
    WidgetChoice,
    checked_arrangement,
    choose_widgets,
    of_topic,
    parse_requests,
    why_no_plot,
)
from ..lines_widget import LinesWidget
from ..machine_widget import MachineWidget
from ..message_widget import MessageWidget
from ..notebook.cells import predecessor
from ..program_widget import ProgramWidget
from ..runtime.clock import Threads
from ..runtime.coalesced_call import CoalescedCall
from ..screen_widget import ScreenWidget
from ..screens.layout import ScreenPlaces, on_one_screen
from ..speed_widget import SpeedWidget
from ..stop_widget import StopWidget
from ..topics_widget import TopicNow, TopicRow, TopicsWidget
from ..widget.cards import as_arrangement, as_entries, checked_cards
from ..widget.freezing import freeze_together
from ..widget.sample_widget import SampleWidget
from ..wires_widget import WiresWidget
from ._connection import Connection
from ._listening import TopicStats
from ._probes import Probes
from ._topics import FeedTopic, brief_of
from ._wires import FeedWires
from .middleware import FeedError


class ViewedFeed(Protocol):
    """The part of a feed that its view uses."""

    @property
    def connection(self) -> Connection:
        """Its connection."""

    def room_view(self) -> Any:
        """Return a widget that shows the room of a simulated robot, or None for any other robot."""


class FeedView(ScreenWidget):
    """The widgets of a feed: of each topic, its program and its state machine. They are added when these appear.

    They share the height of the window. The bar with Stop stays in view, and freezes all of them. A simulated robot is
    shown in its room, which also shows the path. `Feed.show` returns this view. `close` removes all of it from the
    page; the feed stays open.

    Args:
        feed: the feed.
        topics: names of topics, or of fields such as ``"/odom.twist.twist.linear.x"``. Without names: all topics that
            have a widget, the program, and the room of a simulated robot. If no topic has a widget, a few widgets show
            the fields of messages.
        beside: True to open it next to the notebook, with only a bar with Stop in the cell.

    Attributes:
        program, machine: the widgets of the program and of its state machine, or None before the first one.
        lines: the widget of the program's lines, folded to one line at first, or None before the first program.
        room: the view of a simulated robot, or None for any other robot.
        wires: the nodes and topics as a graph while the list of topics shows it, or None.
        refresh: makes widgets for topics that have appeared, and shows the status. The feed calls it. No thread of the
            feed waits for it, because some of them send speeds.
    """

    def __init__(
        self,
        feed: ViewedFeed,
        topics: Sequence[str] = (),
        *,
        beside: bool = False,
        arrangement: Any = None,
    ) -> None:
        self._feed: ViewedFeed | None = feed
        self._connection = feed.connection
        self._names = [*topics, *([] if arrangement is None else checked_arrangement(arrangement))]
        self.on_show = TopicSelection(self._names)
        self._known: dict[str, FeedTopic] = {}
        self._shown: dict[WidgetChoice, SampleWidget] = {}
        self._probes = Probes(self._connection)
        self._closed = False
        self._looked_at: tuple[str, ...] = ()
        self.refresh = CoalescedCall(
            self._refresh, thread="robowidgets-changes", scheduler=Threads(self._connection.clock)
        )
        self._screen: ScreenPlaces = {}
        self.topic_list = TopicsWidget(self._on_toggle, on_look=self._on_look, clock=self._connection.clock)
        self.topic_list.observe(self._on_wires, "wires")
        self._stop = StopWidget(feed)
        self.program: ProgramWidget | None = None
        self.machine: MachineWidget | None = None
        self.lines: LinesWidget | None = None
        self.room = None if self._names else feed.room_view()
        self.wires: WiresWidget | None = None
        super().__init__("feed", self._everything, arrangement)
        self._stop.stand_in(self.model_id)
        self._bar = StopWidget(feed) if beside else None
        if self._bar is not None:
            self._bar.stand_in(self.model_id, opens=True)
        earlier = predecessor(self, FeedView)
        if earlier is not None:
            self.on_show.keep(earlier.on_show)
            self.topic_list.keep(earlier.topic_list)
            self.keep_cards(earlier)
        self.refresh.here()
        self._connection.observe(self.refresh)
        self.refresh()  # for changes in the meantime

    def _in_words(self) -> str:
        """Return one line on what the view shows, for its repr."""
        shown = dict.fromkeys(choice.titles[0] for choice in self._shown)
        return f"<FeedView: {', '.join(shown) or 'no topics'}>"

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        """Return the output of a cell: all of the view, or the bar that opens it next to the notebook."""
        shown: Any = super() if self._bar is None else self._bar
        return shown._repr_mimebundle_(**kwargs)

    @property
    def widgets(self) -> dict[str, Any]:
        """The visible widgets, by topic. A topic with two widgets has the first; one may show a whole namespace."""
        firsts: dict[str, Any] = {}
        for choice, widget in self._shown.items():
            for topic in choice.own:
                firsts.setdefault(topic, widget)
        return firsts

    def close(self) -> None:
        """Remove it from the page. Calling it again does nothing."""
        if self._closed:
            return  # ipywidgets calls it, too, when Python exits and can no longer import
        self._connection.unobserve(self.refresh)
        self._connection.listening.look(self._on_update, None)
        self._closed = True
        self.refresh()
        more = (self.program, self.machine, self.lines, self.room, self.wires)
        for widget in (self._bar, self._stop, *more, self.topic_list):
            if widget is not None:
                widget.close()
        super().close()
        self._feed = None  # a feed is deleted if only closed views refer to it

    def _refresh(self) -> None:
        topics = list(self._connection.topics)
        for topic in topics:
            known = self._known.get(topic.name)
            if topic.widget or known is None or not known.widget:  # a topic that disappears keeps its widget
                self._known[topic.name] = topic
        try:
            if self._closed:
                self._probes.close()
            else:
                names = {request.topic for request in parse_requests(self._names, [topic.name for topic in topics])}
                self._probes.add(topic for topic in topics if not names or topic.name in names)
            wanted = () if self._closed else choose_widgets(self._known.values(), self._visible_entries())
            if self._add_program() or set(wanted) != self._shown.keys():
                self._set_widgets(wanted)
        except FeedError:
            if not self._connection.is_closed:  # a feed that was closed in the meantime connects no widgets
                raise
        self.topic_list.set_rows(map(_row, topics))
        self._show_status()

    @property
    def arrangement(self) -> Any:
        """The visible topics and fields, in the form for `Feed.show`. A list contains fields that share a plot.

        If the user has arranged the cards, a dictionary with these topics and the cards. It can be stored as JSON, and
        set again or passed to `Feed.show`.
        """
        return as_arrangement(self._cards, self._visible_entries())

    @arrangement.setter
    def arrangement(self, entries: Any) -> None:
        names, cards = checked_arrangement(entries), checked_cards(entries)
        self._names = names
        self.on_show.arrange(names)
        self._cards = cards
        self.refresh()

    def card_name(self, widget: Any, kind: str) -> str:
        """Return the name of a widget in an arrangement by hand: its topics, or the name of its kind."""
        named = next((choice.card_name for choice, shown in self._shown.items() if shown is widget), None)
        return named or kind

    def _visible_entries(self) -> list[Entry]:
        """Return the entries to show. Topics without a known kind wait until no other topic can have a widget."""

        def can_show(topic: str) -> bool:
            return self._connection.is_settled and not self._probes.waits_for(topic)

        return self.on_show.entries([*self._known.values()], can_show)

    def _plot_field(self, topic: str, path: str) -> None:
        """Show a plot of a field for the user."""
        self._on_toggle(f"{topic}.{path}", True)

    def _on_toggle(self, topic: str, on: bool) -> None:
        """Show a topic, or remove it with its fields, for the user."""
        if on:
            self.on_show.add(topic)
        else:
            self.on_show.take_off(of_topic(topic, self._visible_entries(), self._known))
        self.refresh()

    def _on_wires(self, change: Any) -> None:
        """Show or remove the graph of nodes and topics below the rest, for the user."""
        before, self.wires = self.wires, None
        if change["new"]:
            self.wires = WiresWidget(FeedWires(self._connection))
            self.wires.on_open(self._toggle_messages)
        self.place(self._everything)
        if before is not None:
            before.close()

    @property
    def _everything(self) -> ScreenPlaces:
        """The places of all widgets."""
        foot = [widget for widget in (self.lines, self.wires) if widget is not None]
        return {"bar": [self._stop], "topics": [self.topic_list], **self._screen, "foot": foot}

    def _toggle_messages(self, topic: str) -> None:
        """Show or remove the messages of a topic field by field, for the user."""
        self.on_show.toggle(f"{topic} as message")
        self.refresh()

    def _on_look(self, names: Sequence[str]) -> None:
        """Follow the topics that a page shows in the list, or stop if the page shows none."""
        if not self._closed:
            self._looked_at = tuple(names)
            self._connection.listening.look(self._on_update, (lambda: self._looked_at) if names else None)

    def _on_update(self, is_seen: bool) -> None:
        """Report the newest values and rates of the topics in the list. It runs in the thread of timers."""
        listening = self._connection.listening
        stats = {name: one for name in self._looked_at if (one := listening.of(name)) is not None}
        now = {name: _now(self._connection.topic_of(name), one, listening.now) for name, one in stats.items()}
        self.topic_list.tell_now(now if is_seen else None)

    def _add_program(self) -> bool:
        """Make the widgets of the program and of its state machine if these exist. Return True if it made one."""
        program, shown, feed = self._connection.programs.current, (self.program, self.machine), self._feed
        if program is None or feed is None or self._names or self._closed:
            return False
        if self.program is None:
            self.program, self.lines = ProgramWidget(feed), LinesWidget(feed, folded=True)
            self.place(self._everything)
        if self.machine is None and isinstance(program.version.function, Machine):
            self.machine = MachineWidget(feed)
        return (self.program, self.machine) != shown

    def _set_widgets(self, wanted: Sequence[WidgetChoice]) -> None:
        there = dict(self._shown)
        shown: dict[WidgetChoice, SampleWidget] = {}
        for choice in wanted:
            before = choice if choice in there else next((one for one in there if one.is_like(choice)), None)
            if before is None:
                widget = choice.make()
                if isinstance(widget, MessageWidget):
                    widget.offer_plots(partial(self._plot_field, choice.topic))
                if isinstance(widget, SpeedWidget):
                    widget.show_used_axes()
                if isinstance(widget, EventsWidget):
                    widget.follow(self._connection)
            else:
                widget = there.pop(before)
                if widget.title == before.titles[0]:  # otherwise the user has changed it
                    widget.title = choice.titles[0]
            shown[choice] = widget
            self._change_topics(widget, before, choice)
        for choice, widget in there.items():
            self._change_topics(widget, choice, None)
            widget.close()
        self._shown = shown
        sensors = list(shown.values())
        more = [widget for widget in (self.machine, self.lines, self.room) if widget is not None]
        group = freeze_together([*sensors, *more])
        self._stop.freeze_with(group if sensors else "", self._connection.page_name)
        for widget in more:
            widget.freeze_with_robot()
        self._arrange(sensors)

    def _arrange(self, sensors: Sequence[SampleWidget]) -> None:
        """Place all widgets except the closed ones."""
        if self._closed:
            return
        sensors = _on_page(sensors)
        # The room shows the path; it is still needed for the trail of a laser.
        maps = _on_page([self.room]) or [widget for widget in sensors if widget.column == "map"]
        wide = [widget for widget in sensors if widget.column == "wide"]
        small = [widget for widget in sensors if widget.column not in ("map", "wide")]
        main = _on_page([self.program, self.machine])
        # A state machine takes the place of the map.
        main, wide = (main, [*maps, *wide]) if self.machine in main else ([*maps, *main], wide)
        added = [widget for widget in sensors if widget in self._added and widget not in main]
        self._screen = on_one_screen(
            main,
            [widget for widget in wide if widget not in added],
            [widget for widget in small if widget not in added],
            added,
        )
        self.place(self._everything)
        self.topic_list.show(self._shown)
        self._entries = as_entries(self._visible_entries())

    @property
    def _added(self) -> list[SampleWidget]:
        """The widgets that were requested."""
        return [widget for choice, widget in self._shown.items() if choice.takes_messages]

    def _change_topics(self, widget: SampleWidget, before: WidgetChoice | None, after: WidgetChoice | None) -> None:
        """Connect a widget to the topics of another choice, each in its role."""
        old, new = (
            {} if one is None else {name: one.method(role) for role, name in one.parts} for one in (before, after)
        )
        for topic in [topic for topic in old if topic not in new]:
            self._connection.disconnect(topic, getattr(widget, old[topic]))
        for topic in [topic for topic in new if topic not in old]:
            self._connection.connect(topic, getattr(widget, new[topic]))

    def _show_status(self) -> None:
        """Show the status of the topics without a widget. A widget shows the status of its topic itself."""
        there = {topic.name: topic for topic in self._connection.topics}
        shown = {name for choice in self._shown for name in choice.topics}
        requests = parse_requests(self._names, [*there])
        missing = [request.topic for request in requests if request.topic not in shown]
        fieldless = {
            request.topic: why
            for request in requests
            if request.topic in there and (why := why_no_plot(request, there[request.topic].type))
        }
        if self._connection.status:
            lines = [self._connection.status] if missing or not shown else []
        elif missing:
            lines = [
                fieldless.get(name, _not_shown(there[name])) if name in there else self._connection.status_of(name)
                for name in missing
            ]
        elif troubles := [
            trouble for name in self._probes.topics - shown if (trouble := self._connection.trouble_of(name))
        ]:
            lines = troubles
        elif shown or any(topic.widget for topic in self._known.values()):
            lines = []  # or the user has removed all widgets
        elif there:
            lines = [f"no widget can show any of these topics: {', '.join(there)}"]
        elif self._connection.is_listed:
            lines = [f"connected to {self._connection.where}, which has no topics yet"]
        else:
            lines = [f"connected to {self._connection.where}, waiting for its topics; connect() accepts any name"]
        self.note([*lines, *self._connection.black_box_troubles])
        for bar in filter(None, (self._stop, self._bar)):
            bar.show_black_box(self._connection.black_box)


def _on_page(widgets: Sequence[Any]) -> list[Any]:
    """Return the widgets that exist and are not closed."""
    return [widget for widget in widgets if widget is not None and widget.comm is not None]


def _row(topic: FeedTopic) -> TopicRow:
    """Return a topic for the list."""
    on_demand = on_demand_for_type(topic.type)
    row = topic.widget or (on_demand.name if on_demand else "")
    return TopicRow(topic.name, topic.type, widget=row, problem="" if row else _not_shown(topic))


def _now(topic: FeedTopic, stats: TopicStats, now: float) -> TopicNow:
    """Return the newest value of a topic, for the list."""
    if not stats.count:
        return TopicNow("" if stats.is_probed else "nothing yet")
    count = None if stats.is_probed else stats.count
    age = stats.age(now) if stats.shows_silence else None
    return TopicNow(brief_of(stats.message, topic), stats.rate, count, age)


def _not_shown(topic: FeedTopic) -> str:
    return f"no widget shows {topic.name}, a {topic.type}" if topic.type else f"{topic.name} is of an unknown type"

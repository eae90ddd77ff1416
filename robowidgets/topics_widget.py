"""The list of all topics of a recording or a robot, next to their widgets."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import traitlets

from .runtime.clock import Clock, scheduler
from .runtime.platform_fixes import route_by_message
from .samples.staleness import LISTED, SEEN_FOR
from .widget.front_end import FrontEndWidget, bundle
from .widget.traits import Flag

MOST_LOOKED_AT = 100
"""The most topics whose values are sent. A page cannot show more at once."""

WIRES = "the wires"
"""Stands for the wires in requests of a page for a topic. Names of topics have no spaces."""

log = logging.getLogger("robowidgets")


class TopicRow(NamedTuple):
    """A topic in the list.

    ``messages`` and ``rate`` are None while they are unknown. ``widget`` is the name of the row that shows it, empty
    without one; ``problem`` says why it cannot be shown, else it is empty.
    """

    name: str
    type: str
    messages: int | None = None
    rate: float | None = None
    widget: str = ""
    problem: str = ""


class TopicNow(NamedTuple):
    """The current value of a topic of a running robot, as text, and its rate.

    ``rate``, ``messages`` and ``age``, the seconds since the last message, are None while they are unknown.
    """

    value: str
    rate: float | None = None
    messages: int | None = None
    age: float | None = None

    @property
    def told(self) -> dict[str, Any]:
        """The rate and the count for the page, and the seconds for which a silent topic has been silent."""
        told: dict[str, Any] = {"rate": self.rate, "messages": self.messages}
        if self.rate and self.age is not None and self.age > LISTED.after(1 / self.rate):
            told |= {"rate": 0.0, "silent": round(self.age)}
        return told


class ShownBy(Protocol):
    """A widget on show, with the properties that the list needs."""

    @property
    def requested(self) -> tuple[str, ...]:
        """Its topics."""

    @property
    def titles(self) -> tuple[str, ...]:
        """Its titles, starting with the title of the card."""


class TopicsWidget(FrontEndWidget):
    """A list of topics: a click shows one, or removes it.

    Each row has the name, the type, the rate or count, and the value if known. Topics with the same first part of their
    names form groups, which fold. Unreadable topics are last, with the reason. Arrow keys walk, space shows, enter goes
    to the card, `/` searches by name and type. The list folds away. Only showing and removing need the kernel, which
    does this during a running cell if it receives messages of the page then, else when the cell ends.

    Args:
        on_toggle: called with the name of a topic and True to show it or False to remove it, perhaps in another thread.
        values_of: returns the values of topics as texts, if they are known.
        on_look: for a robot. Called every ten seconds with the names of the topics in view on a page, and with no names
            when the page is gone. In between, the robot's view calls `tell_now`.
        clock: the clock for pages that do not report their topics any more.
        folded: True to show only a rail of it; by default if there is little room.
    """

    _esm, _css = bundle("topics_widget")

    folded = Flag(
        None, allow_none=True, help="True if it is folded away, or None to decide by the room. The view writes it."
    ).tag(sync=True)
    wires = Flag(False, help="True to show the wires of all topics below the rest. Settable.").tag(
        sync=True, echo_update=False
    )
    _rows = traitlets.List(traitlets.Dict(), help="Name, type, count, rate, widget and problem of each topic.").tag(
        sync=True, echo_update=False
    )
    _shown = traitlets.Dict(help="Names of the topics on show, with the titles of their widgets.").tag(
        sync=True, echo_update=False
    )
    _fixed = Flag(False, help="True if nothing can be shown or removed, in a page without a kernel.").tag(sync=True)
    _error = traitlets.Unicode(help="Why a topic could not be shown.").tag(sync=True, echo_update=False)

    def __init__(
        self,
        on_toggle: Callable[[str, bool], None] | None = None,
        values_of: Callable[[Sequence[str]], Mapping[str, str]] | None = None,
        on_look: Callable[[Sequence[str]], object] | None = None,
        clock: Clock = scheduler.clock,
        **kwargs: Any,
    ) -> None:
        self._now = clock.now
        self._on_toggle, self._values_of, self._on_look = on_toggle, values_of, on_look
        self._looked_at: list[str] = []
        self._looks: dict[str, tuple[float, list[str]]] = {}
        """The topics in each view of a page, and the time until which this holds, by the name of the view."""
        self._seconds: float | None = None
        super().__init__(**kwargs)
        self.on_msg(self._on_page)
        self.add_class("rw-topics-cell")

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm)

    def keep(self, earlier: TopicsWidget) -> None:
        """Take over the user's settings from the list of an earlier run of the cell."""
        self.folded, self.wires = earlier.folded, earlier.wires

    def set_rows(self, rows: Iterable[TopicRow]) -> None:
        """List topics."""
        self._rows = [row._asdict() for row in rows]

    def show(self, choices: Iterable[ShownBy]) -> None:
        """Mark the topics of the widgets on show."""
        titles: dict[str, dict[str, None]] = {}
        for choice in choices:
            for topic in choice.requested:
                titles.setdefault(topic, {})[choice.titles[0]] = None
        self._shown = {name: [*found] for name, found in titles.items()}

    def tell_values(self, seconds: float | None = None) -> None:
        """Send the values of the topics in view, current ones or at a time."""
        self._seconds = seconds
        if self._looked_at and self._values_of is not None:
            self.send({"values": self._values_of(self._looked_at), "at": seconds})

    def tell_now(self, topics: Mapping[str, TopicNow] | None) -> None:
        """Send the current values of topics, or None if the feed does not listen to them any more."""
        if self.comm is not None:
            values = {name: topic.value for name, topic in (topics or {}).items()}
            self.send({"values": values, "now": {name: topic.told for name, topic in (topics or {}).items()}})

    def close(self) -> None:
        """Remove the widget from the page."""
        self._on_toggle = self._values_of = self._on_look = None
        super().close()

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Show or remove a topic. Called in the main thread or in a subshell's."""
        looked_at = content.get("look") if isinstance(content, dict) else None
        if isinstance(looked_at, list):
            before = self._looked_at
            self._note_look(str(content.get("view")), [name for name in looked_at if isinstance(name, str)])
            if self._on_look is not None:
                self._on_look(self._looked_at)
            elif before != self._looked_at:
                self.tell_values(self._seconds)
            return
        more = content.get("more") if isinstance(content, dict) else None
        if isinstance(more, list) and self._values_of is not None:
            missing = [name for name in more if name in self._looked_at]
            self.send({"values": self._values_of(missing), "at": self._seconds})
            return
        name = content.get("toggle") if isinstance(content, dict) else None
        if not isinstance(name, str) or self._on_toggle is None:
            return
        try:
            if name == WIRES:
                self.wires = bool(content.get("on"))
            else:
                self._on_toggle(name, bool(content.get("on")))
        except Exception as error:
            log.exception("robowidgets: %s could not be shown", name)
            self._error = f"{name}: {error}"
        else:
            self._error = ""
        self.send({"done": name})

    def _note_look(self, view: str, names: list[str]) -> None:
        """Note the topics in a view of the list. There may be several views, on two pages or in one."""
        now = self._now()
        others = {name: look for name, look in self._looks.items() if name != view and look[0] > now}
        self._looks = {view: (now + SEEN_FOR, names[:MOST_LOOKED_AT]), **others}
        self._looked_at = [*dict.fromkeys(name for _, seen in self._looks.values() for name in seen)]
        del self._looked_at[MOST_LOOKED_AT:]

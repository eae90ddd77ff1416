"""The list of all topics of a recording or a robot, beside what is shown of them."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import traitlets

from ._core.clock import Clock, scheduler
from ._core.front_end import FrontEndWidget, bundle
from ._core.platform_fixes import route_by_message
from ._core.traits import Flag
from .samples.staleness import LISTED, SEEN_FOR

MOST_LOOKED_AT = 100
"""Topics of which values are sent at most: a page shows no more at once."""

WIRES = "the wires"
"""What a page asks for in place of a topic: no topic has a name with a space."""

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
    """What a topic of a running robot says now, in words, and how often.

    ``rate`` and ``messages`` are None while they are unknown, ``age``, the seconds since the last message, too.
    """

    value: str
    rate: float | None = None
    messages: int | None = None
    age: float | None = None

    @property
    def told(self) -> dict[str, Any]:
        """Rate and count as the page shows them, and for how long the topic is silent where it is."""
        told: dict[str, Any] = {"rate": self.rate, "messages": self.messages}
        if self.rate and self.age is not None and self.age > LISTED.after(1 / self.rate):
            told |= {"rate": 0.0, "silent": round(self.age)}
        return told


class ShownBy(Protocol):
    """A widget on show, as the list knows it."""

    @property
    def asked(self) -> tuple[str, ...]:
        """Its topics."""

    @property
    def titles(self) -> tuple[str, ...]:
        """Its titles, that of the card first."""


class TopicsWidget(FrontEndWidget):
    """A list of topics: a click shows one, or takes it off.

    Each row has name, type, rate or count, and its value where that is known. Topics with the same first part of their
    names are groups, which fold; what cannot be read stands last, with the reason. Arrow keys walk, space shows, enter
    goes to the card, `/` searches by name and type. It folds away. None of it but to show and to take off needs the
    kernel, which does both beside a running cell where it hears the page then, else when the cell ends.

    Args:
        on_toggle: called with the name of a topic and whether it is to be shown, perhaps in another thread.
        values_of: what some topics say, in words; None: nobody knows.
        on_look: called with the names of the topics that a page looks at, every ten seconds, and with none when it does
            so no longer: then `tell_now` is called while it does. None: it is no robot.
        clock: by which a page that says nothing any more looks no longer.
        folded: whether only a rail of it is there; None: as the room allows.
    """

    _esm, _css = bundle("topics_widget")

    folded = Flag(None, allow_none=True, help="Whether it is folded away; None: by the room. The view writes it.").tag(
        sync=True
    )
    wires = Flag(False, help="Whether the wires of all topics are on show below the rest. Settable.").tag(
        sync=True, echo_update=False
    )
    _rows = traitlets.List(traitlets.Dict(), help="Name, type, count, rate, widget and problem of each topic.").tag(
        sync=True, echo_update=False
    )
    _shown = traitlets.Dict(help="Names of the topics on show, with the titles of their widgets.").tag(
        sync=True, echo_update=False
    )
    _fixed = Flag(False, help="Whether nothing can be shown or taken off: in a page without a kernel.").tag(sync=True)
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
        """By the name of a view of a page, until when it looks at which topics."""
        self._seconds: float | None = None
        super().__init__(**kwargs)
        self.on_msg(self._on_page)
        self.add_class("rw-topics-cell")

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm)

    def keep(self, earlier: TopicsWidget) -> None:
        """Take over what a person did to the list of an earlier run of the cell."""
        self.folded, self.wires = earlier.folded, earlier.wires

    def set_rows(self, rows: Iterable[TopicRow]) -> None:
        """List topics."""
        self._rows = [row._asdict() for row in rows]

    def show(self, choices: Iterable[ShownBy]) -> None:
        """Mark the topics of the widgets on show."""
        titles: dict[str, dict[str, None]] = {}
        for choice in choices:
            for topic in choice.asked:
                titles.setdefault(topic, {})[choice.titles[0]] = None
        self._shown = {name: [*found] for name, found in titles.items()}

    def tell_values(self, seconds: float | None = None) -> None:
        """Have the page show what the topics that it looks at say now, or at a time."""
        self._seconds = seconds
        if self._looked_at and self._values_of is not None:
            self.send({"values": self._values_of(self._looked_at), "at": seconds})

    def tell_now(self, topics: Mapping[str, TopicNow] | None) -> None:
        """Have the page show what topics say now; None: nobody listens to them any more."""
        if self.comm is not None:
            values = {name: topic.value for name, topic in (topics or {}).items()}
            self.send({"values": values, "now": {name: topic.told for name, topic in (topics or {}).items()}})

    def close(self) -> None:
        """Remove it from the page."""
        self._on_toggle = self._values_of = self._on_look = None
        super().close()

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Show a topic or take it off. In the main thread or a subshell's."""
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
        """Note what one view of the list shows, beside others: of two pages, or of two places in one."""
        now = self._now()
        others = {name: look for name, look in self._looks.items() if name != view and look[0] > now}
        self._looks = {view: (now + SEEN_FOR, names[:MOST_LOOKED_AT]), **others}
        self._looked_at = [*dict.fromkeys(name for _, seen in self._looks.values() for name in seen)]
        del self._looked_at[MOST_LOOKED_AT:]

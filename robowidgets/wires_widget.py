"""The nodes and topics of a robot as a graph, and the notebook's own part in it."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import ipywidgets
import traitlets

from ._core.front_end import bundle
from ._core.platform_fixes import route_by_message
from ._core.robot_widget import RobotWidget
from ._core.text import many
from .message_widget import MessageWidget


class Wire(NamedTuple):
    """A topic, as what connects nodes.

    ``type`` is empty where it is unknown. ``publishers`` and ``subscribers`` are the names of nodes; ``offered`` and
    ``wanted`` tell whether anybody publishes it, and whether anybody subscribes to it (None: unknown), also where the
    names are not known. ``rate`` is in messages per second, None while it is not known; ``value`` is the last message
    in a few words, ``age`` the seconds since it came. ``count`` is the number of messages in a recording. ``is_heard``
    tells whether its messages come here, ``is_glanced_at`` whether they do now and then alone, as those of a large
    topic, so that no age of it is a silence. ``is_infrastructure`` marks what every node has, such as /rosout. ``note``
    is a line about a problem of it.
    """

    name: str
    type: str = ""
    publishers: tuple[str, ...] = ()
    subscribers: tuple[str, ...] = ()
    offered: bool = True
    wanted: bool | None = None
    rate: float | None = None
    value: str = ""
    age: float | None = None
    count: int | None = None  # type: ignore[assignment]  # hides tuple.count, which nobody asks of a wire
    is_heard: bool = False
    is_glanced_at: bool = False
    is_infrastructure: bool = False
    note: str = ""


class NotebookPart(NamedTuple):
    """A part of the notebook that takes topics or publishes them.

    ``kind`` is ``function``, ``condition``, ``program``, ``speeds`` (what is sent to the robot) or ``widget``.
    ``reads`` and ``writes`` are names of topics; ``drives`` tells whether it asks for speeds. ``runs`` is how often it
    ran, ``got`` and ``gave`` what it got and gave last, in a few words; ``problem`` is a line about it.
    """

    kind: str
    name: str
    reads: tuple[str, ...] = ()
    writes: tuple[str, ...] = ()
    drives: bool = False
    runs: int | None = None
    got: str = ""
    gave: str = ""
    problem: str = ""


class Wiring(NamedTuple):
    """The wires of a robot at one time, with the notebook's part in them.

    ``tells_nodes`` tells whether the robot names any node; ``note`` is a line about what is not known, or not yet.
    """

    wires: tuple[Wire, ...] = ()
    parts: tuple[NotebookPart, ...] = ()
    tells_nodes: bool = False
    note: str = ""

    @property
    def nodes(self) -> tuple[str, ...]:
        """The names of the nodes that publish or subscribe, sorted."""
        return tuple(sorted({node for wire in self.wires for node in (*wire.publishers, *wire.subscribers)}))

    def __repr__(self) -> str:
        nodes = f"{many(len(self.nodes), 'node')}, " if self.tells_nodes else ""
        return f"<{nodes}{many(len(self.wires), 'topic')}, {many(len(self.parts), 'part')} of the notebook>"


_DRAWN = ("rate", "value", "age", "count", "note", "offered", "wanted")


class WiresSource(Protocol):
    """What is wired: a running robot, or a recording."""

    @property
    def name(self) -> str:
        """What it is, for a person."""

    @property
    def robot(self) -> str:
        """The name by which the page knows the widgets of a robot; empty for a recording."""

    @property
    def wiring(self) -> Wiring:
        """The wires as they are now."""

    @property
    def status(self) -> str:
        """Why nothing comes; empty while all is well."""

    def look(self, is_seen: bool) -> None:
        """Somebody looks, or nobody any more: while nobody does, the robot is asked nothing for it."""

    def show(self, topic: str, widget: MessageWidget) -> None:
        """Show the messages of a topic in a widget: live ones, or the last one of a recording."""

    def hide(self, topic: str, widget: MessageWidget) -> None:
        """Show them there no longer."""

    def observe(self, on_change: Callable[[], None]) -> None:
        """Call a function when the wires have changed."""

    def unobserve(self, on_change: Callable[[], None]) -> None:
        """Call it no more."""


class WiresWidget(RobotWidget[Wiring]):
    """The nodes and topics of a robot as a graph, with the rate and the last value of each topic.

    Beside them stands the notebook's own part: which topic goes into which function, condition, program and widget,
    and which speeds come out, each with how often it ran and what it last got and gave. It stands in the `WiresView`
    that `Feed.wires` and `Recording.wires` return. What every node has is folded, and so are namespaces where there is
    much. Pointing at something shows its wires; a click keeps them. The wheel with Ctrl zooms, dragging moves, ``/``
    filters by name.

    While no page shows it, the robot is asked nothing for it.

    Args:
        source: a robot or a recording, as `Feed.wires` gives it.
        title: for the header; empty: the name of the robot.
        filter: text that the names on show contain; empty: all. The view writes it too.
        unfolded: namespaces that are shown whole though there is much, as ``"topics /camera"`` and ``"nodes /camera"``.
            The view writes it too.
        infrastructure: whether what every node has is shown, such as /rosout. The view writes it too.
        paused: whether the picture is frozen.
        history: seconds for which the page keeps earlier values to go back through, 0 (none) to 600.
        header, footer: whether they are there.

    Raises:
        TypeError: an unknown keyword, or a source that is none.
        traitlets.TraitError: a value out of its range.

    Examples:
        >>> from robowidgets import feeds
        >>> with feeds.simulator(wander=False) as robot:
        ...     widget = robot.wires().wires
        ...     [wire.name for wire in widget.wait().wires]
        ['/scan', '/odom', '/cmd_vel', '/bumper']
    """

    _esm, _css = bundle("wires_widget")
    _unnamed = 1

    column = "wide"
    sample_name = "wiring"
    goes_stale = False
    has_rate = False
    beats = True
    send_interval = 0.25

    filter = traitlets.Unicode("", help="Text that the names on show contain. Python and the view write it.").tag(
        sync=True
    )
    infrastructure = traitlets.Bool(
        False, help="Whether what every node has is shown, such as /rosout. Python and the view write it."
    ).tag(sync=True)

    unfolded = traitlets.List(
        traitlets.Unicode(), help='Namespaces that were unfolded, as "topics /camera". Python and the view write it.'
    ).tag(sync=True)

    _can_open = traitlets.Bool(False, help="Whether somebody shows the messages of a topic that is asked for.").tag(
        sync=True, echo_update=False
    )

    def __init__(self, source: WiresSource, **kwargs: Any) -> None:
        if not hasattr(source, "wiring"):
            raise TypeError(f"WiresWidget(): expected what feed.wires() or recording.wires() gives it, got {source!r}")
        self._wired = source
        self._openers: list[Callable[[str], object]] = []
        super().__init__(**{**kwargs, "title": kwargs.get("title") or source.name})
        self._robot = source.robot
        self._together = source.robot
        source.observe(self._on_wiring)
        self.on_msg(self._on_page)
        source.look(True)
        self._on_wiring()

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm)

    def on_open(self, opens: Callable[[str], object]) -> None:
        """Call a function with the name of a topic whose messages a person wants to see: who shows them in a card."""
        self._openers.append(opens)
        self._can_open = True

    def close(self) -> None:
        """Remove the widget from the page, and ask the robot nothing any more."""
        if "_wired" in vars(self):  # else the constructor raised before it had it
            self._wired.unobserve(self._on_wiring)
            self._wired.look(False)
            self._openers.clear()
            super().close()

    def _describe(self) -> str:
        sample = self._newest.sample
        return "" if sample is None else repr(sample).strip("<>")

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """In the main thread or a subshell's."""
        if not isinstance(content, dict):
            return
        if isinstance(content.get("look"), bool):
            self._wired.look(content["look"])
        topic = content.get("open")
        if isinstance(topic, str) and topic in {wire.name for wire in self._wired.wiring.wires}:
            for opens in list(self._openers):
                opens(topic)

    def _on_wiring(self) -> None:
        """Store what is wired now, for the pacer. In the thread of timers, as a rule."""
        self.set_source({"robot": self._robot, "status": self._wired.status})
        self._show(self._wired.wiring)

    def _pack(self, sample: Wiring) -> bytes:
        names = {name: i for i, name in enumerate(sample.nodes)}
        told = {
            "nodes": list(names),
            "tells": sample.tells_nodes,
            "note": sample.note,
            "wires": [_plain(wire, names) for wire in sample.wires],
            "parts": [{key: value for key, value in part._asdict().items() if value} for part in sample.parts],
        }
        return json.dumps(told, separators=(",", ":")).encode()


class WiresView(ipywidgets.VBox):  # type: ignore[misc]  # ipywidgets has no types
    """The wires, and below them the messages of the topics that were opened.

    Args:
        source: a robot or a recording.
        **options: keywords of `WiresWidget`.

    Attributes:
        wires: the picture.
        messages: the widgets with messages, by topic.
    """

    def __init__(self, source: WiresSource, **options: Any) -> None:
        self._wired = source
        self.wires = WiresWidget(source, **options)
        self.messages: dict[str, MessageWidget] = {}
        super().__init__([self.wires])
        self.wires.on_open(self.toggle)

    def toggle(self, topic: str) -> None:
        """Show the messages of a topic, or show them no longer."""
        shown = self.messages.pop(topic, None)
        if shown is None:
            self.messages[topic] = widget = MessageWidget(title=topic)
            self._wired.show(topic, widget)
        self.children = [self.wires, *self.messages.values()]
        if shown is not None:
            self._wired.hide(topic, shown)
            shown.close()

    def close(self) -> None:
        """Remove it from the page, and ask the robot nothing any more."""
        if "messages" in vars(self):  # else the constructor raised before it had them
            for topic in list(self.messages):
                self.toggle(topic)
            self.wires.close()
        super().close()

    def __repr__(self) -> str:
        shown = f", messages of {', '.join(self.messages)}" if self.messages else ""
        return f"<WiresView: {self.wires!r}{shown}>"


def _plain(wire: Wire, names: dict[str, int]) -> dict[str, Any]:
    """A wire as the page reads it; what it has not is left out."""
    told: dict[str, Any] = {
        "name": wire.name,
        "type": wire.type,
        "from": [names[node] for node in wire.publishers],
        "to": [names[node] for node in wire.subscribers],
        "heard": wire.is_heard,
        "plumbing": wire.is_infrastructure,
        **({"glanced": True} if wire.is_glanced_at else {}),
    }
    told.update({key: value for key in _DRAWN if (value := getattr(wire, key)) not in (None, "")})
    return told

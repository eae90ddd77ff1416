"""The nodes and topics of a robot as a graph, with the parts of the notebook."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import ipywidgets
import traitlets

from .message_widget import MessageWidget
from .runtime.platform_fixes import route_by_message
from .runtime.text import many
from .widget.front_end import bundle
from .widget.in_words import InWords
from .widget.robot_widget import RobotWidget


class Wire(NamedTuple):
    """A topic that connects nodes.

    ``type`` is empty if it is unknown. ``publishers`` and ``subscribers`` are the names of nodes. ``offered`` is True
    if the topic has a publisher, and ``wanted`` if it has a subscriber (None if unknown), even if the names are
    unknown. ``rate`` is in messages per second, or None while it is unknown; ``value`` is a short text of the last
    message, ``age`` the seconds since it came. ``count`` is the number of messages in a recording. ``is_heard`` is True
    if its messages are received here, ``is_glanced_at`` if only a few of them are, such as of a large topic, so that
    its age does not mean silence. ``is_infrastructure`` marks topics of every node, such as /rosout. ``note`` is a line
    about a problem.
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
    count: int | None = None  # type: ignore[assignment]  # hides tuple.count, which wires do not need
    is_heard: bool = False
    is_glanced_at: bool = False
    is_infrastructure: bool = False
    note: str = ""


class NotebookPart(NamedTuple):
    """A part of the notebook that reads or publishes topics.

    ``kind`` is ``function``, ``condition``, ``program``, ``speeds`` (sent to the robot) or ``widget``. ``reads`` and
    ``writes`` are names of topics; ``drives`` is True if it requests speeds. ``runs`` is the number of its runs,
    ``got`` and ``gave`` are short texts of its last input and output; ``problem`` is a line about a problem.
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
    """The wires of a robot at one time, with the parts of the notebook.

    ``tells_nodes`` is True if the robot reports its nodes; ``note`` is a line about missing information.
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
    """A source of wires: a running robot, or a recording."""

    @property
    def name(self) -> str:
        """Its name for the user."""

    @property
    def robot(self) -> str:
        """The name of the group of a robot's widgets in the page; empty for a recording."""

    @property
    def wiring(self) -> Wiring:
        """The current wires."""

    @property
    def status(self) -> str:
        """The reason why nothing comes, or empty."""

    def look(self, is_seen: bool) -> None:
        """Note if a page shows the wires. If not, the robot is not queried for them."""

    def show(self, topic: str, widget: MessageWidget) -> None:
        """Show the messages of a topic in a widget: live ones, or the last one of a recording."""

    def hide(self, topic: str, widget: MessageWidget) -> None:
        """Stop showing the messages of a topic in a widget."""

    def observe(self, on_change: Callable[[], None]) -> None:
        """Call a function when the wires have changed."""

    def unobserve(self, on_change: Callable[[], None]) -> None:
        """Stop calling a function."""


class WiresWidget(RobotWidget[Wiring]):
    """The nodes and topics of a robot as a graph, with the rate and the last value of each topic.

    The parts of the notebook are next to them: the topics that go into each function, condition, program and widget,
    and the speeds that come out, each with the number of runs and the last input and output. It is part of the
    `WiresView` that `Feed.wires` and `Recording.wires` return. Topics of every node are folded, and so are large
    namespaces. Pointing at something shows its wires; a click keeps them. The wheel with Ctrl zooms, dragging moves,
    ``/`` filters by name.

    While no page shows it, the robot is not queried for it.

    Args:
        source: a robot or a recording, from `Feed.wires` or `Recording.wires`.
        title: title in the header; by default the name of the robot.
        filter: text that the names on show contain, or empty for all. The view writes it, too.
        unfolded: large namespaces that are unfolded, such as ``"topics /camera"`` and ``"nodes /camera"``. The view
            writes it, too.
        infrastructure: True to show topics of every node, such as /rosout. The view writes it, too.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps earlier values to go back through, 0 (none) to 600.
        header, footer: False to hide them.

    Raises:
        TypeError: an unknown keyword, or not such a source.
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
        False, help="True to show topics of every node, such as /rosout. Python and the view write it."
    ).tag(sync=True)

    unfolded = traitlets.List(
        traitlets.Unicode(), help='Unfolded namespaces, such as "topics /camera". Python and the view write it.'
    ).tag(sync=True)

    _can_open = traitlets.Bool(False, help="True if a view can show the messages of a topic on request.").tag(
        sync=True, echo_update=False
    )

    def __init__(self, source: WiresSource, **kwargs: Any) -> None:
        if not hasattr(source, "wiring"):
            raise TypeError(
                f"WiresWidget(): expected the source that feed.wires() or recording.wires() uses, got {source!r}"
            )
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
        """Call a function with the name of a topic when the user wants to see its messages in a card."""
        self._openers.append(opens)
        self._can_open = True

    def close(self) -> None:
        """Remove the widget from the page, and stop querying the robot."""
        if "_wired" in vars(self):  # else the constructor raised before it set it
            self._wired.unobserve(self._on_wiring)
            self._wired.look(False)
            self._openers.clear()
            super().close()

    def _describe(self) -> str:
        sample = self._newest.sample
        return "" if sample is None else repr(sample).strip("<>")

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Handle a message of the page. Called in the main thread or in a subshell's."""
        if not isinstance(content, dict):
            return
        if isinstance(content.get("look"), bool):
            self._wired.look(content["look"])
        topic = content.get("open")
        if isinstance(topic, str) and topic in {wire.name for wire in self._wired.wiring.wires}:
            for opens in list(self._openers):
                opens(topic)

    def _on_wiring(self) -> None:
        """Store the current wires for the pacer. The timer thread usually calls this."""
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


class WiresView(InWords, ipywidgets.VBox):  # type: ignore[misc]  # ipywidgets has no types
    """The wires, and below them the messages of opened topics.

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
        """Show or hide the messages of a topic."""
        shown = self.messages.pop(topic, None)
        if shown is None:
            self.messages[topic] = widget = MessageWidget(title=topic)
            self._wired.show(topic, widget)
        self.children = [self.wires, *self.messages.values()]
        if shown is not None:
            self._wired.hide(topic, shown)
            shown.close()

    def close(self) -> None:
        """Remove the view from the page, and stop querying the robot."""
        if "messages" in vars(self):  # else the constructor raised before it set them
            for topic in list(self.messages):
                self.toggle(topic)
            self.wires.close()
        super().close()

    def __repr__(self) -> str:
        shown = f", messages of {', '.join(self.messages)}" if self.messages else ""
        return f"<WiresView: {self.wires!r}{shown}>"


def _plain(wire: Wire, names: dict[str, int]) -> dict[str, Any]:
    """Return a wire for the page, without unset fields."""
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

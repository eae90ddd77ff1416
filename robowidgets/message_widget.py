"""The message widget: any message as a tree of its fields, with live values."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import traitlets

from .message import Tree, pack, read
from .messages.any_message import names_in, value_at, why_no_value
from .messages.fields import stamp_ns, type_name, unwrap
from .samples import HasAge
from .widget.front_end import bundle
from .widget.robot_widget import RobotWidget
from .widget.timed_frame import FRAME_HEADER
from .widget.traits import Flag

MOST_FIELDS = 32
"""The most fields that are shown alone, or over time."""

_MOST_KEPT, _MOST_KEPT_BYTES = 600, 32_000_000
"""The number and the approximate bytes of the sent messages that the page may step back to."""


class Received:
    """A message with a hint to its type, and its definition."""

    __slots__ = ("hint", "message", "schema")

    def __init__(self, message: Any, hint: str = "", schema: Any = None) -> None:
        self.message, self.hint, self.schema = message, hint, schema

    @property
    def type(self) -> str:
        """The type in the usual form, without ``/msg/``."""
        return self.hint.replace("/msg/", "/") if isinstance(self.message, dict) else type_name(self.message)

    @property
    def stamp_ns(self) -> int | None:
        """The stamp of its header."""
        return stamp_ns(self.message)


_NONE = Received(None)
"""Stands for the time before the first message of a recording."""


class MessageWidget(RobotWidget[Received]):
    """Any live message: a tree of its fields, or some of them alone and large.

    The widget shows each field under its name in the program, with its value, and its unit if its definition or REP-103
    has one. A number with a name in the definition is shown with it, ``OK 0``. Changes since the message before have a
    bar on the left. An array is folded to its length, its minimum, its maximum and the number of missing values (NaN),
    which are never shown as 0. The joints of a JointState, the cells of a BatteryState and the parts of a
    DiagnosticArray are rows with bars. Each field can be copied as the code that reads it, and watched over the last
    seconds. Space freezes; all this works without the kernel. The page has only a part of a large message, and gets the
    rest when it is unfolded. If a message cannot be read, the last picture stays, with the reason above it.

    Args:
        title: title in the header; usually the name of the topic.
        fields: paths of the fields to show alone, such as ``"pose.pose.position.x"`` or ``"ranges[0]"``; by default
            all.
        over_time: paths of numbers to draw also over the last seconds. The view writes it, too.
        rows: True to show joints, cells and diagnostics as rows with bars, not as a tree. The view writes it, too.
        type: the type of messages that do not contain it, such as ``"sensor_msgs/msg/Imu"`` for dictionaries.
        folds: True for an unfolded message or array, False for a folded one, by path. Others are unfolded if they are
            small. The view writes it, too.
        changes: True to mark changes since the message before. The view writes it, too.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps messages to step back through while frozen, 0 (none) to 600.
        header, footer: False to hide them.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Source: REP-103, and the definition of the message.

    Examples:
        >>> battery = MessageWidget(title="battery", fields=["percentage", "voltage"])
        >>> battery.update({"voltage": 16.21, "percentage": 0.867})
        >>> battery["voltage"]
        16.21
    """

    _esm, _css = bundle("message_widget")
    _meant: ClassVar = {"field": "fields", "topic": "title", "watch_fields": "over_time", "tree": "rows"}
    _instead: ClassVar = {"values": 'widget["pose.position.x"]', "msg": "widget.message"}
    sample_name = "message"
    frame_traits = ("fields", "_wanted")
    send_interval = 0.1

    fields = traitlets.List(traitlets.Unicode(), help="Paths of the fields that are shown alone; all by default.").tag(
        sync=True
    )
    over_time = traitlets.List(
        traitlets.Unicode(), help="Paths of numbers drawn over the last seconds. Python and the view write it."
    ).tag(sync=True)
    rows = Flag(True, help="True to show joints, cells and diagnostics as rows. Python and the view write it.").tag(
        sync=True
    )
    type = traitlets.Unicode(help="Type of messages that do not contain it: sensor_msgs/msg/Imu.").tag(sync=True)
    folds = traitlets.Dict(
        key_trait=traitlets.Unicode(),
        value_trait=Flag(),
        help="True for unfolded parts, False for folded ones, by path. Python and the view write it.",
    ).tag(sync=True)
    changes = Flag(True, help="True to mark changes. Python and the view write it.").tag(sync=True)

    _plots = Flag(False, help="True if a view can show a plot of a field.").tag(sync=True)
    _wanted = traitlets.List(traitlets.Unicode(), help="Paths of large parts that the page requests.").tag(
        sync=True, echo_update=False
    )

    def __init__(self, **kwargs: Any) -> None:
        self._schemas: dict[Any, Any] = {}
        self._plain: set[type] = set()
        """Classes of messages that need no conversion."""
        self._nodes: list[dict[str, Any]] = []
        """The nodes of the last tree. Most messages have the same nodes, which are sent once."""
        self._tree: tuple[Received, Tree] | None = None
        self._kept: deque[tuple[bytes, Received, int]] = deque()
        """The last packed bytes, each with its message and its approximate size."""
        self._kept_bytes = 0
        self._on_plot: Callable[[str], None] | None = None
        super().__init__(**kwargs)
        self.on_msg(self._on_page)

    def update(self, message: Any) -> None:
        """Show a message in the next animation frame.

        It only stores the message, and may be called from any thread at any rate. The message is not copied: do not
        change it afterwards, unless it is a dictionary.

        Args:
            message: a message of any type of rclpy, rospy, rosbags or rosbridge, a dictionary, a dataclass, or another
                object with fields; a sample of robowidgets; or a moment of a recording.

        Raises:
            TypeError: not a message. ValueError: it has none of the `fields`. A callback (another thread; a task, timer
                or button of a notebook) raises nothing; the widget and the log show the error.
        """
        if message is None and self.driven_by_player:
            self._show(_NONE)
            return
        try:
            received = self._received(message)
            missing = self._wrong_fields(received.message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
            return
        self._show(received, {"notes": [missing]} if missing else {})

    @property
    def message(self) -> Any:
        """The message on show: the frozen one while paused, or None before the first.

        While paused it is also None if the page has stepped back to a message that is no longer kept in Python, which
        keeps about 32 MB.
        """
        shown = self._sample_on_show()
        return shown.message if shown else None

    @property
    def frozen(self) -> Any:
        """The message on show while frozen, which may be stepped back to; None while live."""
        return self.message if self.paused else None

    def __getitem__(self, path: str) -> Any:
        """Return the value of a field of the message on show.

        Raises:
            KeyError: no message has come, or it has no such field. The text has similar names.
        """
        message = self.message
        if message is None:
            raise KeyError(f"{path!r}: no message has come yet; update(...) shows one")
        try:
            return value_at(message, path)
        except ValueError as error:
            raise KeyError(str(error)) from None

    def offer_plots(self, on_plot: Callable[[str], None]) -> None:
        """Show a button on each number to plot it: it calls the function with the path of the number."""
        self._on_plot, self._plots = on_plot, True

    def close(self) -> None:
        """Remove the widget from the page."""
        self._on_plot = None
        super().close()

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Plot a field at the request of the user."""
        path = content.get("plot") if isinstance(content, dict) else None
        if self._on_plot is None or not isinstance(path, str):
            return
        try:
            self._on_plot(path)
        except Exception as error:  # a view may raise anything for a name from the page
            self._refuse(ValueError(f"{path} could not be plotted: {error}"))

    def frame_of(self, sample: Any) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`. The sample is a message."""
        if sample is None:
            return {}, pack(Tree([], [], b"", 0))
        received = sample if isinstance(sample, Received) else self._received(sample)
        tree = self._read(received)
        return self._about_tree(received, tree), pack(tree)

    def _received(self, message: Any) -> Received:
        """Return a message with its hint and its definition, or raise TypeError if it is not a message."""
        hint = self.type or str(self._source.get("type", ""))
        if type(message) in self._plain:
            return Received(message, hint, self._schema(message, hint))
        given, message = message, unwrap(message)
        if isinstance(message, tuple) and hasattr(message, "time_ns") and hasattr(message, "sample"):
            message = message.sample  # a moment of a recording
        if isinstance(message, Mapping):
            message = dict(message)
        if not names_in(message) and isinstance(message, (type(None), str, int, float, bytes, Sequence, Mapping)):
            raise TypeError(f"expected a message with fields, such as {{'speed': 0.3}}, got {message!r:.80}")
        if isinstance(message, HasAge):  # a sample of this package has other fields than the messages of its topic
            hint = ""
        elif message is given:
            self._plain.add(type(message))
        return Received(message, hint, self._schema(message, hint))

    def _schema(self, message: Any, hint: str) -> Any:
        """Return the definition of a type of messages, which is searched once for each type."""
        kind = type(message)
        is_ros = not hint and not hasattr(kind, "__msgtype__") and not hasattr(kind, "_full_text")
        if is_ros and "msg" not in kind.__module__.split("."):
            return None
        key = (kind, hint)
        if key not in self._schemas:
            # Imported lazily: rosbags takes longer to import than everything else.
            from .messages.schema import schema_of

            self._schemas[key] = schema_of(message, hint)
        return self._schemas[key]

    def _wrong_fields(self, message: Any) -> str:
        """Return the problem with the `fields`, or empty. Raise ValueError if the message has none of them."""
        wrong = [why for path in self.fields if (why := why_no_value(message, path))]
        if wrong and len(wrong) == len(self.fields):
            raise ValueError(wrong[0])
        return wrong[0] if wrong else ""

    def _read(self, received: Received) -> Tree:
        tree = read(received.message, received.schema, self._asked_for(), self.fields)
        if tree.nodes == self._nodes:
            return tree._replace(nodes=self._nodes)
        self._nodes = tree.nodes
        return tree

    def _asked_for(self) -> set[str]:
        """Return the paths of large parts that are read nevertheless."""
        return {*self._wanted, *(path for path, is_unfolded in self.folds.items() if is_unfolded)}

    def _about_tree(self, received: Received, tree: Tree) -> dict[str, Any]:
        about = {"tree": tree.nodes, "type": received.type, "keyed": isinstance(received.message, dict)}
        frame_id = getattr(getattr(received.message, "header", None), "frame_id", None)
        return {**about, "frame_id": frame_id} if isinstance(frame_id, str) and len(frame_id) < 100 else about

    def _about_sample(self, sample: Received) -> dict[str, Any]:
        self._tree = sample, self._read(sample)
        return self._about_tree(*self._tree) if sample.message is not None else {}

    def _pack(self, sample: Received) -> bytes:
        known, self._tree = self._tree, None
        tree = known[1] if known and known[0] is sample else self._read(sample)
        packed = pack(tree)
        if not self.driven_by_player:
            self._keep(packed, sample, tree.size + len(packed))
        return packed

    def _keep(self, packed: bytes, sample: Received, size: int) -> None:
        self._kept.append((packed, sample, size))
        self._kept_bytes += size
        while len(self._kept) > _MOST_KEPT or (len(self._kept) > 1 and self._kept_bytes > _MOST_KEPT_BYTES):
            self._kept_bytes -= self._kept.popleft()[2]

    def _unpack(self, frame: bytes) -> Received | None:  # type: ignore[override]  # the message may be dropped
        packed = frame[FRAME_HEADER.size :]
        return next((received for raw, received, _ in reversed(self._kept) if raw == packed), None)

    def _describe(self) -> str:
        newest = self._newest.sample
        return f"{newest.type}, {len(names_in(newest.message))} fields" if newest else ""

    def _newest_measured(self) -> Any:
        newest = self._newest.sample
        return None if newest is None else newest.message

    def _to_judge(self, shown: Any) -> Any:
        return None if shown is None else shown.message

    @traitlets.observe("fields", "folds", "_wanted")
    def _read_again(self, _change: Any) -> None:
        if self.driven_by_player:
            self._renew_frames()
        else:
            self._say_more()

    @traitlets.validate("fields", "over_time")
    def _few(self, proposal: Any) -> Any:
        name, paths = proposal["trait"].name, list(dict.fromkeys(proposal["value"]))
        if len(paths) > MOST_FIELDS:
            raise traitlets.TraitError(f"{name}: expected the paths of at most {MOST_FIELDS} fields, got {len(paths)}")
        return paths

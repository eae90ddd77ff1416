"""The table of kinds: a row for each kind of sensor, with its messages, its sample, its columns and its widget.

Recordings, players, searches, feeds, Rerun and the command find in these rows what they can read and show. Each room
has its rows in its module ``row``, and `robowidgets.rooms` adds them. A row imports its classes when they are first
used. So reading a recording imports no widget.
"""

from __future__ import annotations

import logging
import re
from collections import UserDict
from collections.abc import Callable, Iterable, Mapping, Sequence, ValuesView
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from ..messages.fields import MessageShape, unwrap
from ..messages.standard import CAMERA_INFO, ToMessage

if TYPE_CHECKING:
    from ..simulator.offers import MakeOffers
    from ..widget.sample_widget import SampleWidget

log = logging.getLogger("robowidgets")

ROOMS = "robowidgets.rooms"
"""The module that adds the rows of this package, and the group of entry points with the rows of other packages."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Role:
    """The role of a topic in a widget: the topic that it shows, or another topic that goes with it.

    Args:
        name: the name of its samples, which is their keyword for the frames of a player. With `combine`, the name in
            programs of the sample of all topics.
        take: the method of the widget that takes a message. For a method other than ``update``, the widget may have a
            trait with the title of the topic, such as ``command_title`` for the method ``command``.
        kind: for roles other than the first. The kind of its topics, if it is not the kind of the row: the status of a
            gas sensor has samples of its own. `add` adds it with the row.
        commanded: True if its samples are commanded, not measured.
        combine: for the first role of a widget that all topics of a namespace share. A function that makes one sample
            of the newest ones. It gets the samples and the seconds at which they came, both by the names of their
            sensors. The method takes the name of the sensor before the message. If None, each topic has a widget of its
            own.
        standalone_options: for roles other than the first. Keywords of a widget that shows such a topic by ``update``
            if it goes with no topic in the first role. If None, such a topic gets no widget.
    """

    name: str
    take: str = "update"
    kind: Kind | None = None
    commanded: bool = False
    combine: Callable[[Mapping[str, Any], Mapping[str, float]], Any] | None = None
    standalone_options: Mapping[str, Any] | None = None


class Gathered(Protocol):
    """Collects the messages for a step of a program, if the newest message is not enough."""

    def add(self, sample: Any) -> None:
        """Add the next sample."""

    def take(self) -> Any:
        """Return the value for a step."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TopicWidget:
    """A widget for the topics of some message types.

    Args:
        name: the name of the widget and its bundle, such as ``"path"``.
        types: message types of its topics, in the form of recordings: ``sensor_msgs/msg/LaserScan``.
        widget: imports and returns the widget class; it takes ``title`` and has ``update(sample)``. Only a kind may be
            without one: its topics are shown in a role of another kind's widget, or as messages.
        nothing: the sample that a player shows before the first of a topic.
        frames: imports and returns the class of the frames of a topic for the player of a recording, a
            `robowidgets.tracks.Track`. If None, a player shows the last sample, or the last message, at each time.
        roles: the roles of its topics. ``update`` takes messages of topics in the first role. A topic in another role
            goes with the topic in the first role that shares most of its namespace.
        options: keywords of the widget for topics, which replace the defaults of the widget.
        goes_stale: True if a sample is no longer valid once the topic is silent. The state of a touch sensor stays
            valid.
        every_message: True if each message counts, such as each event. For other rows the newest is enough.
    """

    name: str
    types: frozenset[str]
    widget: Callable[[], type[SampleWidget]] | None
    nothing: Any
    frames: Callable[[], Callable[..., Any]] | None = None
    roles: tuple[Role, ...] = (Role(name="sample"),)
    options: Mapping[str, Any] = field(default_factory=dict)
    goes_stale: bool = True
    every_message: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class OnDemandWidget(TopicWidget):
    """An on-demand widget: requested by name or in the list of topics, or shown if no topic has another widget.

    It takes unchanged messages, of topics that have no kind.

    Args:
        types: message types of its topics. If empty, any type that no other row names.
        nothing: the argument for its `frame_of` in a player before the first message.
        shared: True if one widget shows all requested topics. Its ``update`` takes the name of the topic before the
            message.
        rerun: as in a `Kind`.
        instead_of: the name of another row whose widget it also shows. A request for that widget of a topic of these
            `types` is a request for this row.
        companion_types: for shared widgets only. Topics of these types are passed to ``put`` even if not requested,
            such as tf for a map.
        plots_fields: for shared widgets only. True if it shows single fields of topics, such as
            ``"/odom.twist.twist.linear.x"``. The widget class takes them as positional arguments.
        fields: for widgets of fields only. The default fields of a topic that is requested without a field, by message
            type. Such a topic has a widget of its own. `types` are the keys.
    """

    types: frozenset[str] = frozenset()
    nothing: Any = None
    rerun: Callable[[], type[Any]] | None = None
    instead_of: str = ""
    shared: bool = False
    companion_types: frozenset[str] = frozenset()
    plots_fields: bool = False
    fields: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def is_companion(self, types: str) -> bool:
        """Return True if its widget takes a topic of a type without a request. Several types are joined by commas."""
        return not self.companion_types.isdisjoint(types.split(", "))

    def default_fields(self, types: str) -> tuple[str, ...]:
        """Return the default fields of a topic. Several types are joined by commas."""
        return next((self.fields[name] for name in types.split(", ") if name in self.fields), ())


@dataclass(frozen=True, eq=False, kw_only=True)
class Kind(TopicWidget):
    """A kind of sensor, with the widget of its topics. It has the name of the widget.

    Args:
        sample_name: the name of one sample in programs: ``moment.scan``, ``--scan``.
        noun: the plural in messages to the user: ``"laser scans"``.
        sample: the class of a sample, derived from `samples.HasAge`.
        read: converts a message to a sample. It raises TypeError for a message of another kind, and ValueError for bad
            numbers.
        has_shape: returns True if a message of an unknown type with these fields is of this kind. If None, only `types`
            are.
        undecided: the part of `types` that other kinds also have; the first message of a topic decides.
        columns: imports and returns the class of its columns, a `robowidgets.recordings.columns.series.Series`. If
            None, its columns are samples.
        rerun: imports and returns the class that logs the topics to Rerun, a
            `robowidgets.in_rerun.rerun_log.TopicLog`. If None, Rerun leaves them out.
        to_message: called for each recorded topic, returns a converter from its samples to messages of ROS 2. If None,
            a feed of samples without messages cannot record them.
        gathered: makes a collector of the messages between two steps of a program, which gets the newest one by
            default.
        simulated: returns the topics of the simulated robot for such a sensor. If None, the robot has no such sensor.
        also: second widgets for the same samples.
        command_types: the part of `types` whose messages are commands, independent of the name of their topic.
    """

    sample_name: str
    noun: str
    sample: type
    read: Callable[[Any], Any]
    widget: Callable[[], type[SampleWidget]] | None = None
    has_shape: Callable[[MessageShape], bool] | None = None
    undecided: frozenset[str] = frozenset()
    columns: Callable[[], type[Any]] | None = None
    rerun: Callable[[], type[Any]] | None = None
    to_message: Callable[[], ToMessage] | None = None
    gathered: Callable[[], Gathered] | None = None
    simulated: MakeOffers | None = None
    also: tuple[TopicWidget, ...] = ()
    command_types: frozenset[str] = frozenset()

    @property
    def commands(self) -> bool:
        """True if its topics may contain commands, not measurements."""
        return any(role.commanded for role in self.roles)

    @property
    def parameter(self) -> str:
        """The name of the newest sample of its widget in programs."""
        return self.roles[0].name if self.roles[0].combine else self.sample_name

    def is_command(self, topic: str, type_name: str) -> bool:
        """Return True if samples on a topic of a type are commanded, not measured."""
        return self.commands and (type_name in self.command_types or is_command(topic))

    def second_widgets(self, types: str) -> tuple[TopicWidget, ...]:
        """Return the second widgets of a measuring topic of this kind. Several types are joined by commas."""
        return tuple(second for second in self.also if not second.types.isdisjoint(types.split(", ")))


Row = TypeVar("Row", Kind, OnDemandWidget)


class RowTable(UserDict[str, Row]):
    """Rows by name. The first use imports the rows of this package, which a single widget does not need."""

    def __init__(self) -> None:
        self._rows: dict[str, Row] = {}

    @property
    def data(self) -> dict[str, Row]:  # type: ignore[override]
        """The rows, with the rows of this package."""
        __import__(ROOMS)  # costs a fraction of import_module, once it is there
        return self._rows

    def values(self) -> ValuesView[Row]:
        """Return the rows in their order."""
        return self.data.values()


KINDS: RowTable[Kind] = RowTable()
"""The kinds by name, in the order of their widgets on a page. `add` appends another."""

ON_DEMAND: RowTable[OnDemandWidget] = RowTable()
"""On-demand widgets by name, the most useful first. `add` appends another."""

_RESERVED = ("time_ns", "seconds", "topic")
"""Names that are already attributes of a moment."""
_TYPE = re.compile(r"\w+/msg/\w+")

_STANDARD = frozenset(
    (
        *("actionlib_msgs", "action_msgs", "builtin_interfaces", "diagnostic_msgs", "geometry_msgs", "lifecycle_msgs"),
        *("map_msgs", "nav_msgs", "rcl_interfaces", "rosgraph_msgs", "sensor_msgs", "shape_msgs", "std_msgs"),
        *("stereo_msgs", "tf", "tf2_msgs", "trajectory_msgs", "unique_identifier_msgs", "visualization_msgs"),
    )
)


def add(row: Kind | OnDemandWidget, *, replace: bool = False) -> None:
    """Add a kind of sensor, or an on-demand widget, for all recordings and feeds that are opened afterwards.

    A row that is in the table stays. The kinds of its roles are added, too.

    Args:
        row: the row.
        replace: True to replace the row of the same name, so that the cell that adds a kind can run again.

    Raises:
        TypeError: it is not a row, or it has a class where it needs a function that imports the class.
        ValueError: a name is taken or not an identifier, or a type is not like ``sensor_msgs/msg/Range``.
    """
    if not isinstance(row, (Kind, OnDemandWidget)):
        raise TypeError(f"row: expected a kinds.Kind or a kinds.OnDemandWidget, got {row!r}")
    if row in (*KINDS.values(), *ON_DEMAND.values()):
        return
    for key in ("widget", "frames", "columns", "rerun"):
        given = getattr(row, key, None)
        if isinstance(given, type) or not (given is None or callable(given)):
            raise TypeError(f"{key}: expected a function that imports and returns the class, got {given!r}")
    if isinstance(row, OnDemandWidget):
        _check_on_demand(row, replace=replace)
    else:
        _check_kind(row, replace=replace)
    for type_name in row.types | (row.undecided if isinstance(row, Kind) else frozenset()):
        if not _TYPE.fullmatch(type_name):
            raise ValueError(f"types: expected message types such as 'sensor_msgs/msg/Range', got {type_name!r}")
    for role in row.roles:
        if role.kind is not None:
            add(role.kind, replace=replace)
    if isinstance(row, Kind):
        KINDS[row.name] = row
    else:
        ON_DEMAND[row.name] = row


def _check_kind(kind: Kind, *, replace: bool) -> None:
    others = [other for other in KINDS.values() if not (replace and other.name == kind.name)]
    for key in ("name", "sample_name", "parameter"):
        name = getattr(kind, key)
        alike = ("name",) if key == "name" else ("sample_name", "parameter")
        taken = tuple(dict.fromkeys((*_RESERVED, *(getattr(other, one) for other in others for one in alike))))
        if not name.isidentifier() or name in taken:
            hint = "; replace=True replaces a row" if key == "name" else ""
            raise ValueError(f"{key}: expected an identifier other than {', '.join(taken)}, got {name!r}{hint}")


def _check_on_demand(row: OnDemandWidget, *, replace: bool) -> None:
    taken = [name for name in (*KINDS, *ON_DEMAND) if not (replace and name == row.name and name in ON_DEMAND)]
    if not row.name.isidentifier() or row.name in taken:
        raise ValueError(
            f"name: expected an identifier other than {', '.join(taken)}, got {row.name!r}; replace=True replaces a row"
        )
    if row.widget is None:
        raise TypeError("widget: expected a function that imports and returns the class, got None")
    if row.plots_fields and not row.shared:
        raise ValueError(f"shared: expected True, because {row.name} shows fields of several topics")
    if row.plots_fields and row.types != row.fields.keys():
        raise ValueError(f"fields: expected fields for each of the types {sorted(row.types)}, got {sorted(row.fields)}")


@cache
def add_installed() -> None:
    """Add the rows of installed packages, the entry points of the group `ROOMS`, once in a process.

    A row that cannot be added is logged and skipped.
    """
    for point in entry_points(group=ROOMS):
        _add_point(point)


def _add_point(point: EntryPoint) -> None:
    try:
        add(point.load())
    except Exception as error:  # code of another package
        log.warning(
            "the room %r of %s is left out, update its package: %s: %s",
            point.name,
            point.value,
            type(error).__name__,
            error,
        )


def on_demand_for_type(types: str) -> OnDemandWidget | None:
    """Return the on-demand widget of a topic without a kind. Several types are joined by commas.

    Returns None if its type is unknown, or if no row shows it.
    """
    if not types:
        return None
    # A row that a user adds for a type has priority over the plot of its numbers.
    rows = sorted(ON_DEMAND.values(), key=lambda row: row.plots_fields)
    of_type = (row for row in rows if not row.types.isdisjoint(types.split(", ")))
    return next(of_type, next((row for row in rows if not row.types and not row.plots_fields), None))


def on_demand_for_fields() -> OnDemandWidget | None:
    """Return the on-demand widget that shows single fields of topics, if any."""
    return next((row for row in ON_DEMAND.values() if row.plots_fields), None)


def on_demand_row(widget: type) -> OnDemandWidget | None:
    """Return the row of an on-demand widget, or None for another widget."""
    return next((row for row in ON_DEMAND.values() if _shows(row, widget)), None)


def _shows(row: TopicWidget, widget: type) -> bool:
    """Return True if a widget class is the class of a row, or derived from it."""
    try:
        return row.widget is not None and issubclass(widget, row.widget())
    except ImportError:  # of a package that is not complete: so there is no widget of this class
        return False


def kinds_of_type(type_name: str) -> tuple[Kind, ...]:
    """Return the kinds that read messages of a type, in the order of the table."""
    return tuple(kind for kind in KINDS.values() if type_name in kind.types)


def kind_of_type(type_name: str) -> Kind | None:
    """Return the kind of all messages of a type; None if no kind reads it, or if the message decides."""
    kinds = kinds_of_type(type_name)
    return kinds[0] if kinds and not is_undecided(type_name) else None


def is_undecided(type_name: str) -> bool:
    """Return True if the kind of a topic of this type depends on its messages."""
    return any(type_name in kind.undecided for kind in kinds_of_type(type_name))


def is_standard(type_name: str) -> bool:
    """Return True if a type belongs to a ROS package whose types are all known, so that its fields do not count.

    For example, a geometry_msgs/Accel has the fields of a Twist but is not a speed.
    """
    return type_name.split("/")[0] in _STANDARD


def kind_of_shape(shape: MessageShape) -> Kind | None:
    """Return the kind of messages with these fields, for a type that no row names."""
    return next((kind for kind in KINDS.values() if kind.has_shape and kind.has_shape(shape)), None)


def kind_of_message(message: Any, type_name: str = "") -> Kind | None:
    """Return the kind that reads a message, by its type or, if no kind knows the type, by its fields.

    The message may also be a sample, or an object that holds one.
    """
    of_sample = [kind] if (kind := kind_of_sample(unwrap(message))) else []
    for kind in of_sample or kinds_of_type(type_name) or [kind for kind in KINDS.values() if kind.has_shape]:
        try:
            kind.read(message)
        except TypeError:
            continue
        except ValueError:
            # A message of an undecided type is of another kind; else it is of this kind, with bad numbers.
            if type_name in kind.undecided:
                continue
        return kind
    return None


def kind_of_class(sample: type) -> Kind:
    """Return the kind whose samples are of a class of this package."""
    return next(kind for kind in KINDS.values() if kind.sample is sample)


def kind_of_sample(sample: Any) -> Kind | None:
    """Return the kind of a sample, or None for anything else."""
    return next((kind for kind in KINDS.values() if isinstance(sample, kind.sample)), None)


def sample_names() -> tuple[str, ...]:
    """Return the attributes of a moment: the only sample of a kind, and the samples of all topics of a namespace."""
    return tuple(dict.fromkeys(name for kind in KINDS.values() for name in (kind.sample_name, kind.parameter)))


def kind_of_parameter(name: str) -> Kind | None:
    """Return the kind whose samples have this name in programs, or None."""
    return next((kind for kind in KINDS.values() if kind.parameter == name), None)


def role_of(widget: type, method: str) -> Role | None:
    """Return the role of the topics whose messages a method of a widget takes, or None if no row has it."""
    roles = (role for kind in KINDS.values() if _shows(kind, widget) for role in kind.roles)
    return next((role for role in roles if role.take == method), None)


def counts_every_message(type_name: str) -> bool:
    """Return True if each message of a type counts, such as an event. For other types the newest is enough."""
    return any(kind.every_message for kind in kinds_of_type(type_name))


def topic_and_field(name: str, known: Iterable[str]) -> tuple[str, str]:
    """Return the topic in a name, which may contain points, and the field: ``"/odom"``, ``"twist.twist.linear.x"``.

    The field is empty if the name is a topic.
    """
    there = sorted(known, key=len, reverse=True)
    topic = next((one for one in there if name == one or name.startswith(f"{one}.")), name.partition(".")[0])
    return topic, name[len(topic) + 1 :]


def namespace_of(topic: str) -> str:
    """Return the namespace of a topic: ``"/sonar"`` for ``"/sonar/left"``."""
    return topic.rpartition("/")[0] or "/"


def info_of(topic: str, topics: Mapping[str, str]) -> str:
    """Return the topic with the calibration of a camera, or empty without one.

    Args:
        topic: the topic of its pictures.
        topics: the types of all topics, by name.
    """
    space = namespace_of(topic)
    # "/camera/image_raw/compressed" has one part more.
    near = [name for name, kind in topics.items() if kind == CAMERA_INFO]
    return next((name for beside in (space, namespace_of(space)) for name in near if namespace_of(name) == beside), "")


def sensor_of(topic: str) -> str:
    """Return the sensor of a topic that shares its widget with its namespace: ``"left"`` for ``"/sonar/left"``."""
    return topic.rpartition("/")[2]


def title_of(topics: Sequence[str]) -> str:
    """Return the title of a widget of one topic, or of several topics of a namespace."""
    return topics[0] if len(topics) == 1 else namespace_of(topics[0])


def by_namespace(topics: Iterable[str]) -> dict[str, list[str]]:
    """Group topics by their namespaces, in the given order."""
    found: dict[str, list[str]] = {}
    for topic in topics:
        found.setdefault(namespace_of(topic), []).append(topic)
    return found


def is_command(topic: str) -> bool:
    """Return True if samples on a topic are commanded, not measured: its name contains ``cmd`` or ``command``."""
    return "cmd" in topic.lower() or "command" in topic.lower()


def widgets_of(kind_name: str | None, types: str, commanded: bool) -> str:
    """Return the widgets of a topic for a table: ``"speed, path"``, ``"speed (commanded)"``, or empty without any."""
    if kind_name is None or commanded:
        return f"{kind_name} (commanded)" if kind_name else ""
    if KINDS[kind_name].widget is None:
        return ", ".join(kind.name for kind in KINDS.values() for role in kind.roles if role.kind is KINDS[kind_name])
    return ", ".join((kind_name, *(second.name for second in KINDS[kind_name].second_widgets(types))))

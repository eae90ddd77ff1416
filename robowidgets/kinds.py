"""One row for each kind of sensor: its messages, its sample, its columns and its widget.

Recordings, players, searches, feeds, Rerun and the command take from these rows what they can read and show. A row
names what lies in the layers above it as entry points do, ``"module:name"``: reading a recording imports no widget.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from math import nan
from typing import Any, Protocol

import numpy as np

from .messages import to_range, to_scan, to_speed, to_touch
from .messages.cloud import CLOUD_TYPES
from .messages.event import SAID_TYPES
from .messages.fields import MessageShape, unwrap
from .messages.image import IMAGE_TYPES
from .messages.standard import CAMERA_INFO, ContactMessages, ToMessage, range_message, scan_message, speed_message
from .messages.touch import TOUCH_TYPES
from .samples import Cloud, Image, Pose, Problem, Range, Ranges, Scan, Speed, Touch
from .samples.touch_tracker import TouchesBetween

_SAMPLE_FRAMES = "robowidgets.player._frames:SampleFrames"
_MESSAGE_FRAMES = "robowidgets.player._frames:MessageFrames"


@dataclass(frozen=True, eq=False, kw_only=True)
class Role:
    """What a topic is for a widget: the one that it shows, or another that goes with that one.

    Args:
        name: of its samples: the keyword under which the frames of a player get them; of a role with `each`, what
            programs call the sample of all topics.
        take: the method of the widget that takes a message. One other than ``update`` has a title of its own, which the
            widget takes as ``command_title`` where the method is ``command``.
        kind: the kind of its topics; empty: that of the row.
        commanded: whether its samples are what was asked for, not what was measured.
        required: whether there is no widget without such a topic.
        each: of the first role, makes one sample of the newest ones of all topics of a namespace, which share a widget:
            of the samples and of the seconds at which each came, both by the names of their sensors. The method takes
            the name of the sensor before the message. None: each topic has a widget of its own.
        alone: of another role than the first, the keywords of a widget that shows a topic in it by ``update`` because
            none in the first role goes with it; None: there is no such widget.
    """

    name: str
    take: str = "update"
    kind: str = ""
    commanded: bool = False
    required: bool = False
    each: Callable[[Mapping[str, Any], Mapping[str, float]], Any] | None = None
    alone: Mapping[str, Any] | None = None


class Gathered(Protocol):
    """What a program gets of the messages that came since its last step, where the newest one is not all."""

    def add(self, sample: Any) -> None:
        """Take the next sample."""

    def take(self) -> Any:
        """What a step gets."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TopicWidget:
    """A widget for the topics of some message types.

    Args:
        name: of the widget and its bundle: ``"path"``.
        types: message types of the topics that have it, as recordings name them, ``sensor_msgs/msg/LaserScan``.
        widget: the widget class; it takes ``title`` and has ``update(sample)``.
        nothing: the sample that a player shows before the first of a topic.
        frames: what the player of a recording shows of a topic at each time, a `robowidgets.player._frames.Track`.
        roles: what the topics of the widget are for it. The first is that of the topic that it shows, whose messages
            ``update`` takes; topics in the others go with the one of the first that shares most of their namespace.
        options: keywords of the widget where a topic gets it, in place of the widget's own defaults.
        goes_stale: whether a sample says nothing any more once the topic is silent. What a touch sensor said holds.
        every_message: whether each message counts, as an event does; of other rows the newest is enough.
    """

    name: str
    types: frozenset[str]
    widget: str
    nothing: Any
    frames: str = _SAMPLE_FRAMES
    roles: tuple[Role, ...] = (Role(name="sample"),)
    options: Mapping[str, Any] = field(default_factory=dict)
    goes_stale: bool = True
    every_message: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Asked(TopicWidget):
    """A widget that topics have where it is asked for: by name, in the list of topics, or where no topic has a widget.

    It takes messages as they are, of topics that have no kind.

    Args:
        types: message types of the topics that it shows; none: any type, for which no other row asks.
        nothing: what a player gives its `frame_of` before the first message.
        gathers: whether one widget has all topics that it is asked for. Its ``update`` takes the name of the topic
            before the message.
        rerun: as of a `Kind`.
        along: of one that gathers, types of topics that it takes along by its method ``put``, asked for or not: what
            joins or completes the others.
        of_fields: of one that gathers, whether it shows single fields of topics, ``"/odom.twist.twist.linear.x"``. The
            widget class takes them as positional arguments.
        fields: of one of fields, the fields that it shows of a topic that is asked for by its name alone, by message
            type. Such a topic has a widget of its own. `types` are the keys.
    """

    types: frozenset[str] = frozenset()
    nothing: Any = None
    frames: str = _MESSAGE_FRAMES
    rerun: str = ""
    gathers: bool = False
    along: frozenset[str] = frozenset()
    of_fields: bool = False
    fields: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def takes_along(self, types: str) -> bool:
        """Whether its widget takes along a topic of a type; several types are joined by a comma."""
        return not self.along.isdisjoint(types.split(", "))

    def fields_of(self, types: str) -> tuple[str, ...]:
        """Return the fields that it shows of a topic by default; several types are joined by a comma."""
        return next((self.fields[name] for name in types.split(", ") if name in self.fields), ())


@dataclass(frozen=True, eq=False, kw_only=True)
class Kind(TopicWidget):
    """A kind of sensor, with the widget that its topics have. Its name is that of the widget.

    Args:
        sample_name: what programs call one sample: ``moment.scan``, ``--scan``.
        noun: the plural for messages to a person: ``"laser scans"``.
        sample: the class of a sample, derived from `samples.HasAge`.
        read: makes a sample of a message; TypeError for a message of another kind, ValueError for bad numbers.
        has_shape: whether a message of an unknown type with these fields is of this kind; None: only `types` are.
        undecided: those of `types` of which some messages only are of this kind: the first message of a topic decides.
        columns: the series class of `Recording.series`.
        rerun: what logs the topics to Rerun, a `robowidgets.in_rerun.rerun_log.TopicLog`; empty: Rerun leaves them out.
        to_message: called for each topic that is recorded, makes what turns its samples into messages of ROS 2; None:
            a feed that has samples, not messages, cannot record them.
        gathered: makes what a program gets of the messages between two steps; None: the newest one.
        simulated: what the simulated robot sends of it, a `robowidgets.simulator.offers.MakeOffers`; empty: nothing.
        also: second widgets for the same samples.
        command_types: those of `types` whose messages are commands, whatever the name of their topic.
    """

    sample_name: str
    noun: str
    sample: type
    read: Callable[[Any], Any]
    has_shape: Callable[[MessageShape], bool] | None = None
    undecided: frozenset[str] = frozenset()
    columns: str = "robowidgets.recordings.columns.series:Samples"
    rerun: str = ""
    to_message: Callable[[], ToMessage] | None = None
    gathered: Callable[[], Gathered] | None = None
    simulated: str = ""
    also: tuple[TopicWidget, ...] = ()
    command_types: frozenset[str] = frozenset()

    @property
    def commands(self) -> bool:
        """Whether its topics may hold what was asked for, not measured."""
        return any(role.commanded for role in self.roles)

    @property
    def parameter(self) -> str:
        """What programs call the newest sample of its widget."""
        return self.roles[0].name if self.roles[0].each else self.sample_name

    def is_command(self, topic: str, type_name: str) -> bool:
        """Whether samples on this topic, of messages of a type, were asked for, not measured."""
        return self.commands and (type_name in self.command_types or is_command(topic))

    def second_widgets(self, types: str) -> tuple[TopicWidget, ...]:
        """The second widgets of a topic of this kind that measures; several types are joined by a comma."""
        return tuple(second for second in self.also if not second.types.isdisjoint(types.split(", ")))


_NUMBERS = ("float32", "float64")
_SCAN_LIMITS = ("angle_min", "angle_increment", "range_min", "range_max")


def _is_scan(shape: MessageShape) -> bool:
    limits = all(shape.get(name) in _NUMBERS for name in _SCAN_LIMITS)
    return limits and shape.get("ranges") in ("float32[]", "float64[]")


def _has_twist(shape: MessageShape) -> bool:
    twist: Any = shape
    while isinstance(twist, Mapping):
        if all(_is_vector(twist.get(part)) for part in ("linear", "angular")):
            return True
        twist = twist.get("twist")
    return False


def _is_vector(shape: Any) -> bool:
    return isinstance(shape, Mapping) and all(shape.get(axis) in _NUMBERS for axis in "xyz")


LASER = Kind(
    name="laser",
    sample_name="scan",
    noun="laser scans",
    sample=Scan,
    read=to_scan,
    types=frozenset({"sensor_msgs/msg/LaserScan", "sensor_msgs/msg/MultiEchoLaserScan"}),
    widget="robowidgets.laser_widget:LaserWidget",
    nothing=Scan(
        np.empty(0, np.float32),
        0.0,
        0.0,
        0.0,
        10.0,
        header_problems=(Problem("no scan up to this time of the recording", ""),),
    ),
    has_shape=_is_scan,
    columns="robowidgets.recordings.columns.scans:Scans",
    frames="robowidgets.player._frames:ScanFrames",
    rerun="robowidgets.in_rerun.rerun_log:ScanLog",
    to_message=lambda: scan_message,
    simulated="robowidgets.simulator.offers:scans",
    # A room is much smaller than what many scanners can see.
    options={"view_range": "auto"},
)
TRANSFORM_TYPES = frozenset({"tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"})
ODOMETRY_TYPES = frozenset({"nav_msgs/msg/Odometry"})
PATH = Asked(
    name="path",
    types=TRANSFORM_TYPES
    | {f"geometry_msgs/msg/Pose{suffix}" for suffix in ("", "Stamped", "WithCovariance", "Array", "2D")}
    | {f"geometry_msgs/msg/{name}" for name in ("PoseWithCovarianceStamped", "PointStamped", "TransformStamped")}
    | {"nav2_msgs/msg/Costmap", "sensor_msgs/msg/NavSatFix", "gps_msgs/msg/GPSFix", "gps_common/msg/GPSFix"}
    | {"turtlesim/msg/Pose"}
    | {f"nav_msgs/msg/{name}" for name in ("Odometry", "Path", "OccupancyGrid")},
    widget="robowidgets.path_widget:PathWidget",
    nothing=Speed((nan, nan, nan), (nan, nan, nan), pose=Pose(nan, nan, nan)),
    frames="robowidgets.player._map_frames:path_track",
    gathers=True,
    along=TRANSFORM_TYPES | {"sensor_msgs/msg/LaserScan"},
    # Each message of tf may be of other frames.
    every_message=True,
)
"""Odometry also says where the robot is: it has a path. What else has a place is asked for, on one map."""
_STEERED = frozenset({"ackermann_msgs/msg/AckermannDrive", "ackermann_msgs/msg/AckermannDriveStamped"})
SPEED = Kind(
    name="speed",
    sample_name="speed",
    noun="speeds",
    sample=Speed,
    read=to_speed,
    types=frozenset(
        (
            *(f"geometry_msgs/msg/Twist{suffix}" for suffix in ("", "Stamped", "WithCovariance")),
            "geometry_msgs/msg/TwistWithCovarianceStamped",
            "nav_msgs/msg/Odometry",
            *_STEERED,
        )
    ),
    widget="robowidgets.speed_widget:SpeedWidget",
    nothing=Speed((nan, nan, nan), (nan, nan, nan)),
    has_shape=_has_twist,
    columns="robowidgets.recordings.columns.speeds:Speeds",
    frames="robowidgets.player._frames:SpeedFrames",
    rerun="robowidgets.in_rerun.rerun_log:SpeedLog",
    roles=(
        Role(name="measured"),
        Role(name="commanded", take="command", commanded=True, alone={"bars": "commanded"}),
    ),
    to_message=lambda: speed_message,
    simulated="robowidgets.simulator.offers:speeds",
    # No topic says how fast its robot may be.
    options={"linear_limits": None, "angular_limits": None},
    also=(PATH,),
    command_types=_STEERED,
)
TOUCH = Kind(
    name="touch",
    sample_name="touch",
    noun="touch sensors",
    sample=Touch,
    read=to_touch,
    # The last is of the simulator, and in no message.
    types=TOUCH_TYPES | {"robowidgets/msg/Touch"},
    undecided=frozenset({"sensor_msgs/msg/Range"}),
    widget="robowidgets.touch_widget:TouchWidget",
    nothing=Touch({}),
    columns="robowidgets.recordings.columns.touches:Touches",
    frames="robowidgets.player._frames:TouchFrames",
    rerun="robowidgets.in_rerun.rerun_log:TouchLog",
    to_message=ContactMessages,
    simulated="robowidgets.simulator.offers:touches",
    gathered=TouchesBetween,
    goes_stale=False,
    every_message=True,
)
SONAR = Kind(
    name="sonar",
    sample_name="sonar",
    noun="sonars",
    sample=Range,
    read=to_range,
    types=frozenset({"sensor_msgs/msg/Range"}),
    # Of those whose limits are equal it is no distance that they tell, but a touch.
    undecided=frozenset({"sensor_msgs/msg/Range"}),
    widget="robowidgets.sonar_widget:SonarWidget",
    nothing=Range(nan),
    columns="robowidgets.recordings.columns.distances:Distances",
    frames="robowidgets.player._frames:SonarFrames",
    roles=(Role(name="sonars", each=Ranges),),
    to_message=lambda: range_message,
    simulated="robowidgets.simulator.offers:sonars",
)

KINDS: dict[str, Kind] = {kind.name: kind for kind in (LASER, SPEED, TOUCH, SONAR)}
"""By name, in the order in which widgets stand on a page. `add` appends another."""

EVENTS = Asked(
    name="events",
    types=SAID_TYPES,
    widget="robowidgets.events_widget:EventsWidget",
    frames="robowidgets.player._event_frames:EventFrames",
    gathers=True,
    every_message=True,
    goes_stale=False,
)
IMAGE = Asked(
    name="image",
    types=IMAGE_TYPES,
    widget="robowidgets.image_widget:ImageWidget",
    nothing=Image(np.zeros((1, 1), np.uint8), "mono8"),
    frames="robowidgets.player._image_frames:ImageFrames",
    rerun="robowidgets.in_rerun.image_log:ImageLog",
)
"""Asked for, as all cameras of a robot together would fill a network."""
CLOUD = Asked(
    name="cloud",
    types=CLOUD_TYPES,
    widget="robowidgets.cloud_widget:CloudWidget",
    frames="robowidgets.player._cloud_frames:CloudFrames",
    rerun="robowidgets.in_rerun.rerun_log:CloudLog",
    nothing=Cloud(np.empty(0, [(axis, np.float32) for axis in "xyz"])),
)
SCAN = Asked(
    name="scan",
    types=CLOUD_TYPES | IMAGE_TYPES,
    widget="robowidgets.laser_widget:LaserWidget",
    nothing=LASER.nothing,
    frames="robowidgets.player._image_frames:MadeScanFrames",
    options=LASER.options,
)
"""A band of heights of a cloud, or rows of a depth image, as a laser scan: "/points as scan", or "as laser"."""
MESSAGE = Asked(
    name="message",
    widget="robowidgets.message_widget:MessageWidget",
    frames="robowidgets.player._frames:TreeFrames",
)
"""Of any type: what is left has at least this."""

_XYZ = ("x", "y", "z")
_ON_THE_FLOOR = ("linear.x", "linear.y", "angular.z")
_FORCES = (*(f"force.{axis}" for axis in _XYZ), *(f"torque.{axis}" for axis in _XYZ))
_WHOLE_NUMBERS = (f"{sign}{bits}" for sign in ("Int", "UInt") for bits in (8, 16, 32, 64))
PLOTTED: dict[str, tuple[str, ...]] = {
    **{f"std_msgs/msg/{name}": ("data",) for name in ("Float32", "Float64", *_WHOLE_NUMBERS)},
    "sensor_msgs/msg/Imu": ("angular_velocity.z", "linear_acceleration.x", "linear_acceleration.y"),
    "sensor_msgs/msg/MagneticField": tuple(f"magnetic_field.{axis}" for axis in _XYZ),
    "sensor_msgs/msg/Illuminance": ("illuminance",),
    "sensor_msgs/msg/FluidPressure": ("fluid_pressure",),
    "sensor_msgs/msg/Temperature": ("temperature",),
    "sensor_msgs/msg/RelativeHumidity": ("relative_humidity",),
    "geometry_msgs/msg/Point": _XYZ,
    "geometry_msgs/msg/Vector3": _XYZ,
    "geometry_msgs/msg/Vector3Stamped": tuple(f"vector.{axis}" for axis in _XYZ),
    "geometry_msgs/msg/Accel": _ON_THE_FLOOR,
    "geometry_msgs/msg/AccelStamped": tuple(f"accel.{name}" for name in _ON_THE_FLOOR),
    "geometry_msgs/msg/Wrench": _FORCES,
    "geometry_msgs/msg/WrenchStamped": tuple(f"wrench.{name}" for name in _FORCES),
}
"""The fields that a plot shows of a topic that is asked for by its name alone: the numbers that are looked at most."""

PLOT = Asked(
    name="plot",
    types=frozenset(PLOTTED),
    widget="robowidgets.plot_widget:PlotWidget",
    frames="robowidgets.player._plot_frames:PlotFrames",
    gathers=True,
    of_fields=True,
    fields=PLOTTED,
    goes_stale=False,
    every_message=True,
)

ASKED: dict[str, Asked] = {row.name: row for row in (PATH, EVENTS, IMAGE, CLOUD, SCAN, MESSAGE, PLOT)}
"""By name, the most useful first: widgets that topics have where they are asked for. `add` appends another."""

_RESERVED = ("time_ns", "seconds", "topic")
"""Names that a moment has already."""
_TYPE = re.compile(r"\w+/msg/\w+")
_REFERENCE = re.compile(r"\w+(\.\w+)*:\w+")

_STANDARD = frozenset(
    (
        *("actionlib_msgs", "action_msgs", "builtin_interfaces", "diagnostic_msgs", "geometry_msgs", "lifecycle_msgs"),
        *("map_msgs", "nav_msgs", "rcl_interfaces", "rosgraph_msgs", "sensor_msgs", "shape_msgs", "std_msgs"),
        *("stereo_msgs", "tf", "tf2_msgs", "trajectory_msgs", "unique_identifier_msgs", "visualization_msgs"),
    )
)


def add(kind: Kind | Asked, *, replace: bool = False) -> None:
    """Add a kind of sensor, or a widget that is asked for, for all recordings and feeds that are opened from now on.

    Args:
        kind: its row.
        replace: whether it takes the place of the row with its name: a cell that adds a kind may be run again.

    Raises:
        ValueError: a name is taken or no identifier, a type is not such as ``sensor_msgs/msg/Range``, or a reference is
            not ``"module:name"``.
    """
    if isinstance(kind, Asked):
        _add_asked(kind, replace=replace)
        return
    others = [other for other in KINDS.values() if not (replace and other.name == kind.name)]
    for key in ("name", "sample_name", "parameter"):
        name = getattr(kind, key)
        alike = ("name",) if key == "name" else ("sample_name", "parameter")
        taken = tuple(dict.fromkeys((*_RESERVED, *(getattr(other, one) for other in others for one in alike))))
        if not name.isidentifier() or name in taken:
            hint = "; replace=True replaces a row" if key == "name" else ""
            raise ValueError(f"{key}: expected an identifier other than {', '.join(taken)}, got {name!r}{hint}")
    _check_texts(kind, (*kind.types, *kind.undecided), ("widget", "columns", "frames", "rerun", "simulated"))
    KINDS[kind.name] = kind


def _add_asked(row: Asked, *, replace: bool) -> None:
    """See `add`."""
    taken = [name for name in (*KINDS, *ASKED) if not (replace and name == row.name and name in ASKED)]
    if not row.name.isidentifier() or row.name in taken:
        raise ValueError(
            f"name: expected an identifier other than {', '.join(taken)}, got {row.name!r}; replace=True replaces a row"
        )
    if row.of_fields and not row.gathers:
        raise ValueError(f"gathers: expected True, as {row.name} shows fields of several topics")
    if row.of_fields and row.types != row.fields.keys():
        raise ValueError(f"fields: expected those of each of the types {sorted(row.types)}, got {sorted(row.fields)}")
    _check_texts(row, row.types, ("widget", "frames", "rerun"))
    ASKED[row.name] = row


def _check_texts(row: TopicWidget, types: Iterable[str], keys: Iterable[str]) -> None:
    for type_name in types:
        if not _TYPE.fullmatch(type_name):
            raise ValueError(f"types: expected message types such as 'sensor_msgs/msg/Range', got {type_name!r}")
    for key in keys:
        reference = getattr(row, key)
        if not _REFERENCE.fullmatch(reference) and (reference or key not in ("rerun", "simulated")):
            raise ValueError(f"{key}: expected 'module:name', got {reference!r}")


def asked_of_type(types: str) -> Asked | None:
    """The widget that a topic without a kind has where it is asked for; several types are joined by a comma.

    None: its type is unknown, or no row shows it.
    """
    if not types:
        return None
    # A row that somebody adds for a type comes before the plot of its numbers.
    rows = sorted(ASKED.values(), key=lambda row: row.of_fields)
    of_type = (row for row in rows if not row.types.isdisjoint(types.split(", ")))
    return next(of_type, next((row for row in rows if not row.types and not row.of_fields), None))


def asked_of_fields() -> Asked | None:
    """The widget that shows single fields of topics, if there is one."""
    return next((row for row in ASKED.values() if row.of_fields), None)


def asked_of_widget(widget: type) -> Asked | None:
    """The row of a widget that topics have where it is asked for; None for a widget of another row."""
    names = {f"{base.__module__}:{base.__qualname__}" for base in widget.__mro__}
    return next((row for row in ASKED.values() if row.widget in names), None)


def kinds_of_type(type_name: str) -> tuple[Kind, ...]:
    """The kinds that read messages of a type, in the order of the table."""
    return tuple(kind for kind in KINDS.values() if type_name in kind.types)


def kind_of_type(type_name: str) -> Kind | None:
    """The kind of all messages of a type; None where none reads it, or only a message tells."""
    kinds = kinds_of_type(type_name)
    return kinds[0] if kinds and not is_undecided(type_name) else None


def is_undecided(type_name: str) -> bool:
    """Whether only a message tells the kind of a topic of this type."""
    return any(type_name in kind.undecided for kind in kinds_of_type(type_name))


def is_standard(type_name: str) -> bool:
    """Whether a type belongs to a ROS package whose types are all known: its fields need no look.

    A geometry_msgs/Accel, say, has the fields of a Twist and is no speed.
    """
    return type_name.split("/")[0] in _STANDARD


def kind_of_shape(shape: MessageShape) -> Kind | None:
    """The kind of messages with these fields, of a type that no row names."""
    return next((kind for kind in KINDS.values() if kind.has_shape and kind.has_shape(shape)), None)


def kind_of_message(message: Any, type_name: str = "") -> Kind | None:
    """The kind that reads a message: of those that know its type, or, where none does, of those that know its fields.

    It may be a sample, or what holds one.
    """
    of_sample = [kind] if (kind := kind_of_sample(unwrap(message))) else []
    for kind in of_sample or kinds_of_type(type_name) or [kind for kind in KINDS.values() if kind.has_shape]:
        try:
            kind.read(message)
        except TypeError:
            continue
        except ValueError:
            # Of an undecided type it is a message of another kind; else one of this kind, with bad numbers.
            if type_name in kind.undecided:
                continue
        return kind
    return None


def kind_of_sample(sample: Any) -> Kind | None:
    """The kind of a sample; None for anything else."""
    return next((kind for kind in KINDS.values() if isinstance(sample, kind.sample)), None)


def sample_names() -> tuple[str, ...]:
    """What one may ask of a moment: the only sample of a kind, and that of all topics of a namespace."""
    return tuple(dict.fromkeys(name for kind in KINDS.values() for name in (kind.sample_name, kind.parameter)))


def kind_of_parameter(name: str) -> Kind | None:
    """The kind whose samples a program calls so; None without any."""
    return next((kind for kind in KINDS.values() if kind.parameter == name), None)


def role_of(widget: type, method: str) -> Role | None:
    """What the topics are whose messages a method of a widget takes; None where no row says it."""
    names = {f"{base.__module__}:{base.__qualname__}" for base in widget.__mro__}
    roles = (role for kind in KINDS.values() if kind.widget in names for role in kind.roles)
    return next((role for role in roles if role.take == method), None)


def counts_every_message(type_name: str) -> bool:
    """Whether each message of a type counts, as an event that no later one repeats; of others the newest is enough."""
    return any(kind.every_message for kind in kinds_of_type(type_name))


def topic_and_field(name: str, known: Iterable[str]) -> tuple[str, str]:
    """The topic of a name, which may have points itself, and the field: ``"/odom"``, ``"twist.twist.linear.x"``.

    The field is empty where the name is that of a topic.
    """
    there = sorted(known, key=len, reverse=True)
    topic = next((one for one in there if name == one or name.startswith(f"{one}.")), name.partition(".")[0])
    return topic, name[len(topic) + 1 :]


def namespace_of(topic: str) -> str:
    """The namespace of a topic: ``"/sonar"`` of ``"/sonar/left"``."""
    return topic.rpartition("/")[0] or "/"


def info_of(topic: str, topics: Mapping[str, str]) -> str:
    """The topic with the calibration of a camera, beside that of its pictures; empty without one.

    Args:
        topic: of the pictures.
        topics: the type of each topic there is.
    """
    space = namespace_of(topic)
    # "/camera/image_raw/compressed" has another part.
    near = [name for name, kind in topics.items() if kind == CAMERA_INFO]
    return next((name for beside in (space, namespace_of(space)) for name in near if namespace_of(name) == beside), "")


def sensor_of(topic: str) -> str:
    """The sensor of a topic that shares its widget with all of its namespace: ``"left"`` of ``"/sonar/left"``."""
    return topic.rpartition("/")[2]


def title_of(topics: Sequence[str]) -> str:
    """The title of a widget of one topic, or of several of a namespace."""
    return topics[0] if len(topics) == 1 else namespace_of(topics[0])


def by_namespace(topics: Iterable[str]) -> dict[str, list[str]]:
    """Topics by their namespaces, in the order given."""
    found: dict[str, list[str]] = {}
    for topic in topics:
        found.setdefault(namespace_of(topic), []).append(topic)
    return found


def is_command(topic: str) -> bool:
    """Whether a sample on this topic was asked for, not measured: its name holds ``cmd`` or ``command``."""
    return "cmd" in topic.lower() or "command" in topic.lower()


def widgets_of(kind_name: str | None, types: str, commanded: bool) -> str:
    """The widgets of a topic, for a table: ``"speed, path"``, ``"speed (commanded)"``; empty without any."""
    if kind_name is None or commanded:
        return f"{kind_name} (commanded)" if kind_name else ""
    return ", ".join((kind_name, *(second.name for second in KINDS[kind_name].second_widgets(types))))


def load(reference: str) -> Any:
    """The object behind ``"module:name"``."""
    module, _, name = reference.partition(":")
    return getattr(import_module(module), name)

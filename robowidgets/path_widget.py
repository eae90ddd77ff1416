"""The map: the path of a robot over time, on layers such as maps of its floor."""

from __future__ import annotations

import struct
import time
from collections.abc import Iterable, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from math import isfinite, nan
from typing import Any, ClassVar

import numpy as np
import traitlets
from numpy.typing import NDArray

from .messages import to_pose
from .messages.fields import frame_id, get, stamp_ns, unwrap
from .messages.map_item import to_map_item
from .messages.pose import pose_of
from .path.layers import MOST_LAYERS, Layers, TooManyLayersError, frames_in
from .path.packing import PackedGrid, pack_grids, pack_layers, pack_tracks, unpack_layers
from .path.placing import Placed, pose_of_frame
from .poses.path import Path
from .poses.recent import RecentPoses
from .poses.transforms import Transform, transforms_of
from .runtime.error_routing import called_from_cell
from .runtime.text import many
from .samples import HasAge, MapGrid, Pose
from .samples.age import arrival_of, note_arrival
from .samples.checks import finite, to_radians
from .samples.map_item import MapItem
from .shapes.drawing import Drawable, DrawsShapes
from .shapes.forms import short_text
from .widget.base_widget import check_given, refuse_unnamed
from .widget.front_end import bundle
from .widget.pacer import pacer
from .widget.timed_frame import FRAME_HEADER
from .widget.traits import Flag, bytes_trait

Floats = NDArray[np.float64]

_FRAME = struct.Struct("<4d")
"""After the header: time in seconds, x and y in metres, yaw in radians."""

_SPACING = 0.25
"""The shortest time in seconds between two sends of the path. The newest pose is sent with each frame."""

_BY_NAME = "update(x=1.0, y=0.5, yaw=0.2, time=3.0)"


@dataclass(frozen=True)
class PathPoint(HasAge):
    """A pose of a robot at a time: seconds, x and y in metres, yaw in radians counter-clockwise from x."""

    time: float
    x: float
    y: float
    yaw: float
    stamp_ns: int | None = None
    frame_id: str = ""
    layers: tuple[Placed, ...] | None = field(default=None, compare=False, repr=False)
    """The layers of the map at that time, or None for the current ones."""


class PathWidget(DrawsShapes[PathPoint]):
    """The path of a robot to scale from above, with its current pose; with layers a map.

    The widget shows the way up to the moment on show as a dark line from a hollow dot, the rest of a recording as a
    faint one, and the robot with its heading; x to the right and y up, in the odometry frame. Hovering over the path,
    or walking along it with the arrow keys, shows the time, the pose and the length of the way at that point; space
    freezes. All this works without the kernel. If a message cannot be shown, the last picture stays, with the reason
    above it.

    The whole way is kept in at most 1000 points. They are 2 cm apart at first, and twice as far each time there are
    more. Heights are left out. If the pose jumps farther than a robot can drive in the time, for example after a reset
    of odometry, a new stroke begins, and the length of the way does not grow.

    `put` adds layers by name: other poses with their ways, planned paths, grids, scans; `ground` is a map below them.
    All are drawn in one frame, each by the transforms of tf at its stamp. A layer without a transform to that frame is
    on a map of its own, in the root of its frames. The list of layers shows it, and a click there, or `frame`, shows
    that map.

    Args:
        title: title in the header; usually the topic.
        frame: the coordinate frame of the map; by default "map" if tf leads there, else the root of the frames of the
            first layer. The view writes it, too.
        hidden: names of layers that are not drawn. The view writes it, too.
        follow: True to keep the robot in the middle. The view writes it, too.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: False to hide them.

    Raises:
        TypeError: an unknown keyword.

    Source: nav_msgs/Odometry, REP-105; Campusano and Fabry, "From Robots to Humans: Visualizations for Robot Sensor
    Data": x and y over time make more sense as a map.

    Examples:
        >>> path = PathWidget(title="/odom")
        >>> for i in range(5):
        ...     path.update(x=0.1 * i, y=0.0, yaw=0.0, time=0.5 * i)
        >>> path.pose.x, path.points.shape
        (0.4, (5, 5))
    """

    _esm, _css = bundle("path_widget")
    _instead: ClassVar = {"add": "path.put(name, message)", "layers": "path.names", "map": "path.ground"}
    column = "map"
    sample_name = "pose"
    beats = True
    frame_traits = ("frame", "_edition")
    send_interval = 0.1

    frame = traitlets.Unicode("", help="The frame of the map, found by tf if empty. Python and the view write it.").tag(
        sync=True
    )
    hidden = traitlets.List(traitlets.Unicode(), help="Names of layers not drawn. Python and the view write it.").tag(
        sync=True
    )
    follow = Flag(False, help="True to keep the robot in the middle. Python and the view write it.").tag(sync=True)
    _path = bytes_trait(echo_update=False)
    _tracks = bytes_trait(echo_update=False)
    _grids = bytes_trait(echo_update=False)
    _map = traitlets.Dict(help="The layers, and the possible frames of the map.").tag(sync=True, echo_update=False)

    whole_map: Any = None
    """The whole map of a recording, which its player keeps."""

    def __init__(self, **kwargs: Any) -> None:
        self._layers = Layers()
        self._placed: tuple[Placed, ...] = ()
        self._grids_now: list[PackedGrid] = []
        self._grids_sent: list[PackedGrid] = []
        self._own = ""
        """The layer of the poses from `update`; empty without other layers."""
        self._map_edition = self._map_listing = 0
        self._left_out: set[str] = set()
        """Names of layers that do not fit."""
        self._shape_frames: dict[str, str] = {}
        self._ground: MapGrid | None = None
        self._whole_tracks: list[tuple[int, Floats]] = []
        self._whole_grids: list[tuple[int, float, PackedGrid]] = []
        self._track = Path()
        self._recent = RecentPoses()
        self._began: float | None = None
        self._is_path_new = False
        self._path_due = 0.0
        super().__init__(**kwargs)

    def update(self, message: Any = None, *unnamed: Any, **fields: Any) -> None:
        """Show a pose in the next animation frame, and add it to the path.

        It only stores the pose, and may be called from any thread at any rate.

        Args:
            message: a nav_msgs/Odometry or a geometry_msgs/Pose, PoseStamped or PoseWithCovariance(Stamped) of rclpy,
                rospy or rosbags, a rosbridge dictionary, or a `Speed` that came with odometry.
            *unnamed: a message after the name of its layer, as for `put`, which feeds use. Others raise an error with
                the call that takes numbers by name.
            **fields: instead of a message, x and y in metres and yaw in radians or as "20deg". With either, the time in
                seconds; by default the time of a moment of a recording, else the seconds since the first pose.

        Raises:
            TypeError: not such a message, or an unknown field. ValueError: a number that is not finite, or a time
                before the last one. A callback (another thread; a task, timer or button of a notebook) raises nothing;
                the widget and the log show the error.
        """
        if isinstance(message, str) and len(unnamed) == 1 and not fields and not self._is_own(message, unnamed[0]):
            self.put(message, unnamed[0])
            return
        try:
            if isinstance(message, str) and len(unnamed) == 1:
                self._own, (message,), unnamed = message, unnamed, ()
            refuse_unnamed("update", unnamed, _BY_NAME)
            with self._newest.lock:
                point = self._to_point(message, fields)
                if not self.driven_by_player:
                    pose = Pose(point.x, point.y, point.yaw)
                    if self._track.add(point.time, pose, self._measured_at(point, message, fields)):
                        self._path_due = 0.0  # without the jump, the page would draw a way
                    self._recent.add(pose, arrival_of(point), point.stamp_ns)
                    self._is_path_new = True
                    if self._layers:
                        self._put_own(point, message)
                self._show(point, {"frame_id": point.frame_id})
        except (TypeError, ValueError) as error:
            self._refuse(error)

    def clear(self) -> None:
        """Start a new path with the next pose."""
        with self._newest.lock:
            self._track, self._recent, self._began, self._is_path_new = Path(), RecentPoses(), None, True
            self._layers, self._own, self._map_edition, self._map_listing = Layers(), "", -1, -1
            self._left_out.clear()
            self._layers.choose(self.frame)
            if self._ground is not None:
                self._put("ground", MapItem("grid", self._ground.frame_id, grid=self._ground), 0.0)
        pacer.mark(self)

    # -- layers --------------------------------------------------------------------------------------------------------

    def put(self, name: str, message: Any = None, *, time: float | None = None) -> None:
        """Show a message as the layer of this name, or a frame of tf. Earlier poses of the layer become its way.

        It only stores the message, and may be called from any thread at any rate.

        Args:
            name: 1 to 60 characters, usually the topic. ``"map->base_link"`` is the second frame in the first, moved by
                the messages of tf, without a message.
            message: a nav_msgs/Odometry, Path or OccupancyGrid; a geometry_msgs/Pose, PoseStamped,
                PoseWithCovarianceStamped (with its ellipse, which holds 95 %), PoseArray or Pose2D; a
                nav2_msgs/Costmap; a sensor_msgs/LaserScan, of which the newest is shown, or NavSatFix, in metres east
                and north of the first fix; a `MapGrid`, a `Scan`; or a tf2_msgs/TFMessage, which is not a layer, but
                connects the frames of all. Objects of rclpy, rospy or rosbags, rosbridge dictionaries, moments of a
                recording.
            time: seconds; by default the time of a moment of a recording, else the time since the first message.

        Raises:
            TypeError: not such a message. ValueError: an impossible number or name, or more than 30 layers. A callback
                raises nothing; the widget and the log show the error.

        Examples:
            >>> path = PathWidget()
            >>> pose = {"position": {"x": 1, "y": 2}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}
            >>> path.put("goal", {"header": {"frame_id": "map"}, "pose": pose})
            >>> path.names
            ('goal',)
            >>> feed.connect("/amcl_pose", path)  # doctest: +SKIP
        """
        try:
            short_text("name", name)
            if message is None and frames_in(name) is None:
                raise TypeError(f'put({name!r}) needs a message, or a name of two frames, such as "map->base_link"')
            with self._newest.lock:
                seconds = self._seconds(message, {} if time is None else {"time": time})
                if message is None:
                    self._adopt()
                    self._layers.show_frame(name)
                else:
                    self._put(name, message, seconds)
                last = self._newest.sample
                if last is None or self.driven_by_player:
                    last = PathPoint(seconds, nan, nan, nan)
                self._show(replace(last, time=max(seconds, last.time) if isfinite(last.time) else seconds))
        except TooManyLayersError as error:
            self._leave_out(name, error)
        except (TypeError, ValueError) as error:
            self._refuse(error)

    def remove(self, name: str) -> None:
        """Remove a layer. Raise KeyError if no layer has this name."""
        with self._newest.lock:
            if name not in self._layers.names:
                raise KeyError(f"remove({name!r}): the layers are {', '.join(self._layers.names) or 'none'}")
            self._layers.remove(name)
            self._left_out.clear()
            self._newest.changed = True
        pacer.mark(self)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the layers, in the order in which they came."""
        with self._newest.lock:
            return self._layers.names

    @property
    def ground(self) -> MapGrid | None:
        """A map below all layers, from `robowidgets.load_map` or an OccupancyGrid, or None.

        Raises:
            TypeError: something else is assigned.
        """
        return self._ground

    @ground.setter
    def ground(self, ground: Any) -> None:
        item = None if ground is None else to_map_item(ground)
        if item is not None and item.grid is None:
            raise TypeError(f"ground: expected a map from robowidgets.load_map(path), got {ground!r}")
        self._ground = item.grid if item else None
        if item is not None:
            self.put("ground", item)
        elif "ground" in self.names:
            self.remove("ground")

    def join(self, parent: str, child: str, pose: Sequence[Any]) -> None:
        """Set the pose of a frame in another if tf lacks it: ``path.join("base_link", "laser", (0.1, 0, 0))``.

        Args:
            parent: the name of a frame.
            child: the name of the frame with this pose.
            pose: x and y in metres, and yaw in radians or as "20deg".

        Raises:
            TypeError: not a pose. ValueError: it is not finite.
        """
        try:
            x, y, yaw = pose
        except (TypeError, ValueError):
            raise TypeError(f"pose: expected x, y and yaw, got {pose!r}") from None
        x, y = finite("x", x, "metres"), finite("y", y, "metres")
        half = finite("yaw", to_radians("yaw", yaw), "radians") / 2
        turn = (0.0, 0.0, float(np.sin(half)), float(np.cos(half)))
        one = Transform(parent.lstrip("/"), child.lstrip("/"), 0, 0, (x, y, 0.0, *turn), static=True)
        with self._newest.lock:
            self._layers.add_frames(iter([one]), 0.0)
            self._newest.changed = True
        pacer.mark(self)

    def distance(self, name: str, other: str) -> tuple[Floats, Floats]:
        """Return the distance of a way from another, or from the planned path, over time.

        Args:
            name: the layer of the robot's way.
            other: a layer with planned paths, for the distance to the newest one at each time; or with poses, for the
                distance to the pose at the same time.

        Returns:
            Seconds, and metres, of each point of the way that the widget keeps. NaN while the other layer is unknown,
            or if tf does not connect both.

        Raises:
            KeyError: no layer has one of the names.

        Examples:
            >>> plot.set_line("off the plan", *path.distance("/odom", "/plan"))  # doctest: +SKIP
        """
        with self._newest.lock:
            for one in (name, other):
                if one not in self._layers.names:
                    raise KeyError(f"distance({one!r}): the layers are {', '.join(self._layers.names) or 'none'}")
            return self._layers.distance(name, other)

    def draw(  # type: ignore[override]  # without a function, since it is drawn in the frame of a map
        self,
        name: str,
        shape: Drawable | None,
        *,
        frame: str = "",
        color: str | None = None,
        lifetime: float | None = None,
    ) -> None:
        """Draw a shape on the map, under a name. It replaces an earlier shape of this name.

        It only stores the shape, and may be called from any thread at any rate.

        Args:
            name: 1 to 60 characters, shown next to the shape.
            shape: a shape, several, or None to remove the shape of this name. Positions are x and y in metres in the
                frame.
            frame: the coordinate frame of the shape, which moves with it; by default the frame of the map.
            color: a colour like "#12854a" or "green"; by default the colour of all shapes of programs.
            lifetime: seconds after which it disappears unless it is drawn again, or None to keep it.

        Raises:
            TypeError: not a shape, a text or a number. ValueError: an impossible name, colour or lifetime, or too many
                shapes. A callback raises nothing; the widget and the log show the error.

        Examples:
            >>> from robowidgets import Line, PathWidget
            >>> path = PathWidget()
            >>> path.draw("door 2", Line((5.0, -0.6), (6.0, -0.6)), frame="odom")
        """
        try:
            if callable(shape):
                raise TypeError(f"draw({name!r}): a map takes the shape itself; draw it again when it moves")
            if not isinstance(frame, str):
                raise TypeError(f"frame: expected the name of a coordinate frame, got {frame!r}")
        except TypeError as error:
            if called_from_cell():
                raise
            self._refuse(error)
            return
        with self._newest.lock:
            self._shape_frames[name] = frame.lstrip("/")
        super().draw(name, shape, color=color, lifetime=lifetime)

    def _put(self, name: str, message: Any, seconds: float) -> None:
        """Store a message of a layer, or of tf. Called with the lock of the samples."""
        inner = getattr(message, "message", message)
        time_ns = time.monotonic_ns()
        transforms = get(inner, "transforms", None)
        if transforms is not None:
            try:
                self._layers.add_frames(transforms_of(inner, name, time_ns), seconds)
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from None
            return
        self._adopt()
        self._layers.put(name, to_map_item(message), seconds, time_ns)

    def _leave_out(self, name: str, error: TooManyLayersError) -> None:
        """Show that a layer does not fit, as long as that is true, but log it once."""
        if called_from_cell():
            raise error
        with self._newest.lock:
            is_known = name in self._left_out
            self._left_out.add(name)
            self._newest.changed = True
        if not is_known:
            pacer.mark(self)
            self._log_once(f"a map has at most {MOST_LAYERS} layers; remove(name) removes one")

    def _is_own(self, name: str, message: Any) -> bool:
        """Return True if a message is a pose of the path, which is of the first topic with poses before any layer."""
        if self.driven_by_player or self._own not in ("", name) or (self._layers and not self._own):
            return False
        inner = unwrap(message)
        return pose_of(inner) is not None and (self._own == name or "goal" not in name.lower())

    def _adopt(self) -> None:
        """Make a layer of the poses from `update` when the first other layer comes."""
        point = self._newest.sample
        if self._layers or point is None or not len(self._track.points):
            return
        self._put_own(point, None)
        own = next(iter(self._layers))
        own.track = deepcopy(self._track)

    def _put_own(self, point: PathPoint, message: Any) -> None:
        """Show a pose from `update` as one of the layers."""
        self._own = self._own or self.title or "robot"
        item = MapItem("pose", point.frame_id.lstrip("/"), point.stamp_ns, Pose(point.x, point.y, point.yaw))
        if message is not None:
            told = to_map_item(message)
            item = replace(item, scatter=told.scatter, child_frame_id=told.child_frame_id)
        self._layers.put(self._own, item, point.time, time.monotonic_ns())

    @traitlets.observe("frame")
    def _on_frame(self, change: Any) -> None:
        with self._newest.lock:
            self._layers.choose(change["new"].lstrip("/"))
            self._newest.changed = True
        pacer.mark(self)

    # -- the pose on show ----------------------------------------------------------------------------------------------

    @property
    def pose(self) -> PathPoint | None:
        """The pose on show: the frozen one while paused, else the newest; None before the first from `update`."""
        return self._sample_on_show()

    @property
    def frozen(self) -> PathPoint | None:
        """The pose on show while frozen, which may be stepped back to; None while live and before the first."""
        return self.pose if self.paused else None

    @property
    def points(self) -> Floats:
        """The path: seconds, x and y in metres, yaw in radians and the length of the way in metres, shape (N, 5).

        In the player of a recording it is the path of the whole recording.
        """
        with self._newest.lock:
            return self._track.points

    def robot_at(self, sample: HasAge) -> Pose | None:
        """Return the pose of the robot at the time of a recent sample, or None if it is unknown."""
        with self._newest.lock:
            return self._recent.at(arrival_of(sample), getattr(sample, "stamp_ns", None))

    def within(self, start: float, end: float) -> dict[str, Any]:
        """See `RobotWidget`. It keeps the points in this part and the point before, which has the length of the way."""
        tracks = [(number, _part(track, start, end)) for number, track in self._whole_tracks]
        grids = [
            packed
            for i, (number, seconds, packed) in enumerate(self._whole_grids)
            if seconds <= end and not any(n == number and s <= start for n, s, _ in self._whole_grids[i + 1 :])
        ]
        path = _part(self.points, start, end).tobytes()
        return {"_path": path, "_tracks": pack_tracks(tracks), "_grids": pack_grids(grids)}

    def show_whole(self, path: Path) -> None:
        """Show the path of a recording. A player then shows one moment of it."""
        self._track = path
        self._path = path.points.tobytes()

    def show_map(
        self, about: dict[str, Any], tracks: list[tuple[int, Floats]], grids: list[tuple[int, float, PackedGrid]]
    ) -> None:
        """Show the layers of a recording, with all of their ways, and their large grids with their start times."""
        self._whole_tracks, self._whole_grids = tracks, grids
        self._map, self._tracks = about, pack_tracks(tracks)
        self._grids = pack_grids(packed for _, _, packed in grids)

    def show_moment(self, point: PathPoint, about: dict[str, Any]) -> None:
        """Show a moment of the map of a recording."""
        with self._newest.lock:
            self._show(point, about)

    def frame_of(self, sample: PathPoint) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`."""
        return {"frame_id": sample.frame_id, **self._drawn_on(sample)}, self._pack(sample)

    def _to_point(self, message: Any, fields: dict[str, Any]) -> PathPoint:
        named = [name for name in fields if name != "time"]
        if named:
            check_given("update", message, named, f"or {_BY_NAME}", ("x", "y", "yaw"))
        if message is None and not {"x", "y"} <= fields.keys():
            raise TypeError(f"update() needs a message, or x and y in metres, as {_BY_NAME}")
        if message is None:
            x, y = (finite(name, fields[name], "metres") for name in "xy")
            pose = Pose(x, y, to_radians("yaw", fields.get("yaw", nan)))
        else:
            pose = to_pose(message)
        seconds = self._seconds(message, fields)
        inner = unwrap(message)
        stamp = getattr(inner, "stamp_ns", None) or stamp_ns(inner)
        return PathPoint(seconds, pose.x, pose.y, pose.yaw, stamp, frame_id(inner))

    def _seconds(self, message: Any, fields: dict[str, Any]) -> float:
        """Return the seconds of a message: as given, of a moment of a recording, or since the first message."""
        now = time.monotonic()
        self._began = now if self._began is None else self._began
        return finite("time", fields.get("time", getattr(message, "seconds", now - self._began)), "seconds")

    def _measured_at(self, point: PathPoint, message: Any, fields: dict[str, Any]) -> float | None:
        """Return the seconds at which a pose was measured, or None if only its arrival is known."""
        if point.stamp_ns:
            return point.stamp_ns / 1e9
        return point.time if "time" in fields or hasattr(message, "seconds") else None

    def _describe(self) -> str:
        at = self.pose
        return f"x {at.x:.2f} m, y {at.y:.2f} m at {at.time:.2f} s" if at else ""

    def get_state(self, key: str | Iterable[str] | None = None, drop_defaults: bool = False) -> dict[str, Any]:
        """See `RobotWidget`. The whole state includes the whole ways."""
        if key is None and "_path_due" in vars(self):
            self._path_due = 0.0
        return super().get_state(key, drop_defaults)

    def _texts_now(self) -> dict[str, Any]:
        """See `RobotWidget`. The texts are the shapes with the poses of their frames, and why layers are missing."""
        texts = super()._texts_now()
        if self.driven_by_player:
            return texts
        placed, missing = self._layers.show_placed()
        self._placed, self._grids_now = tuple(placed), self._layers.grids()
        if not self._layers and "shapes" not in texts:
            return texts
        shapes = []
        for form in texts.pop("shapes", []):
            at = self._at(self._shape_frames.get(form["name"], ""))
            if at is None:
                missing[form["name"]] = f"not drawn: no transform to {self._layers.frame}"
            else:
                shapes.append({**form, "from": at})
        told = {"frame_id": self._layers.frame, "shapes": shapes, "missing": missing}
        return {**texts, **{key: value for key, value in told.items() if value}}

    def _about_sample(self, sample: PathPoint) -> dict[str, Any]:  # noqa: ARG002
        """See `RobotWidget`."""
        notes = [] if self.driven_by_player else self._layers.notes()
        if self._left_out:
            notes.append(f"{many(len(self._left_out), 'layer')} not drawn: a map has {MOST_LAYERS} at most")
        return {"notes": notes} if notes else {}

    def _at(self, frame: str) -> list[float] | None:
        """Return the current pose of a frame in the frame of the map, or None if tf does not connect them."""
        world = self._layers.frame
        if not frame or not world or frame == world:
            return [0.0, 0.0, 0.0]
        pose = pose_of_frame(self._layers.frames, frame, world, time.monotonic_ns(), None)
        return None if pose is None else list(pose)

    def _pack(self, sample: PathPoint) -> bytes:
        layers = self._placed if sample.layers is None else sample.layers
        return _FRAME.pack(sample.time, sample.x, sample.y, sample.yaw) + pack_layers(layers)

    def _unpack(self, frame: bytes) -> PathPoint:
        _, _, stamp_ns, arrived = FRAME_HEADER.unpack_from(frame)
        seconds, x, y, yaw = _FRAME.unpack_from(frame, FRAME_HEADER.size)
        layers = tuple(unpack_layers(frame[FRAME_HEADER.size + _FRAME.size :]))
        point = PathPoint(seconds, x, y, yaw, stamp_ns or None, self._frozen_about.get("frame_id", ""), layers)
        note_arrival(point, arrived)
        return point

    def _bring_up_to_date(self) -> None:
        """Send the path with the newest pose, unless it was sent just before."""
        super()._bring_up_to_date()
        with self._newest.lock:
            layers = self._layers
            values: dict[str, Any] = {}
            if layers.listing != self._map_listing and not self.driven_by_player:
                # At once, because frames refer to layers by number.
                self._map_listing = layers.listing
                about = [{**one.about, "number": one.number} for one in layers]
                values = {"_map": {"layers": about, "frames": layers.known_frames}}
            if self._grids_now != self._grids_sent:
                # At once, because frames refer to grids by version.
                self._grids_sent = self._grids_now
                values["_grids"] = pack_grids(self._grids_now)
            is_map_new = layers.edition != self._map_edition and not self.driven_by_player
            now = time.monotonic()
            if (self._is_path_new or is_map_new) and now < self._path_due:
                pacer.mark_at(self, self._path_due)
            elif self._is_path_new or is_map_new:
                self._is_path_new, self._path_due = False, now + _SPACING * max(1, len(layers.names) // 3)
                self._map_edition = layers.edition
                values["_path"] = b"" if layers else self._track.points.tobytes()
                if is_map_new:
                    values["_tracks"] = pack_tracks(layers.tracks())
            # Without sending them at once, as setting the traits would.
            changed = [name for name, value in values.items() if self._trait_values.get(name) != value]
            self._trait_values.update(values)
            self._unsent.update(changed)


def _part(points: Floats, start: float, end: float) -> Floats:
    """Return the points of a way in a part of a recording, and the point before, which has the length of the way."""
    first, stop = np.searchsorted(points[:, 0], (start, end), "right")
    return points[max(0, first - 1) : stop]

"""The path view: where a robot was over time, as a map."""

from __future__ import annotations

import struct
import time
from dataclasses import dataclass
from math import inf, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core.base_widget import check_given, refuse_unnamed
from ._core.front_end import bundle
from ._core.pacer import pacer
from ._core.robot_widget import RobotWidget
from ._core.timed_frame import FRAME_HEADER
from ._core.traits import bytes_trait
from .messages import to_pose
from .messages.fields import frame_id, stamp_ns, unwrap
from .poses.path import Path
from .poses.recent import RecentPoses
from .samples import HasAge, Pose
from .samples.age import arrival_of, note_arrival
from .samples.checks import finite, to_radians

_FRAME = struct.Struct("<4d")
"""After the head: time in seconds, x and y in metres, yaw in radians."""

_SPACING = 0.25
"""Seconds between two paths that are sent, at least. The newest pose is sent with each frame."""

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


class PathWidget(RobotWidget[PathPoint]):
    """Where a robot was over time: its path to scale from above, with its pose now.

    The reader sees the way up to the moment on show as a dark line from a hollow dot, the rest of a recording as a
    faint one, and the robot with its heading; x to the right and y up, in the frame of odometry. Hovering the path, or
    walking along it with the arrow keys, tells time, pose and way of that place; space freezes. None of it needs the
    kernel. A message that cannot be shown leaves the last picture and says why above it.

    The whole way is kept in at most 1000 points: they lie 2 cm apart at first, and twice as far each time there are
    more. Heights are left out. Where the pose jumps farther than a robot can drive until then, as odometry does that
    was set back, a new stroke begins, and the way does not grow.

    Args:
        title: what is shown, for the header; usually the topic.
        paused: whether the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: whether they are there.

    Raises:
        TypeError: an unknown keyword.

    Source: nav_msgs/Odometry, REP-105; Campusano and Fabry, "From Robots to Humans: Visualizations for Robot Sensor
    Data": x and y over time make more sense as a map.

    Example:
        >>> path = PathWidget(title="/odom")
        >>> for i in range(5):
        ...     path.update(x=0.1 * i, y=0.0, yaw=0.0, time=0.5 * i)
        >>> path.pose.x, path.points.shape
        (0.4, (5, 5))
    """

    _esm, _css = bundle("path_widget")
    column = "map"
    sample_name = "pose"
    beats = True

    _path = bytes_trait(echo_update=False)

    def __init__(self, **kwargs: Any) -> None:
        self._track = Path()
        self._recent = RecentPoses()
        self._began: float | None = None
        self._complete_until = inf
        self._is_path_new = False
        self._path_due = 0.0
        super().__init__(**kwargs)

    def update(self, message: Any = None, *unnamed: Any, **fields: Any) -> None:
        """Show a pose in the next animation frame, and add it to the path.

        It only stores, and may be called from any thread at any rate.

        Args:
            message: a nav_msgs/Odometry or a geometry_msgs/Pose, PoseStamped or PoseWithCovariance(Stamped) of rclpy,
                rospy or rosbags, a rosbridge dictionary, or a `Speed` that came with odometry.
            *unnamed: refused, with the call that takes numbers by name.
            **fields: instead of a message, x and y in metres and yaw in radians or as "20deg". With either, the time in
                seconds; without it, that of a moment of a recording, else the seconds since the first pose came.

        Raises:
            TypeError: no such message, or an unknown field. ValueError: a number that is not finite, or a time before
                the last one. In a callback (another thread; a task, timer or button of a notebook) nothing is raised;
                widget and log say it.
        """
        try:
            refuse_unnamed("update", unnamed, _BY_NAME)
            with self._newest.lock:
                point = self._to_point(message, fields)
                if not self.driven_by_player:
                    pose = Pose(point.x, point.y, point.yaw)
                    if self._track.add(point.time, pose, self._measured_at(point, message, fields)):
                        self._path_due = 0.0  # until the page has the jump, it would draw a way
                    self._recent.add(pose, arrival_of(point), point.stamp_ns)
                    self._is_path_new = True
                self._show(point, {"frame_id": point.frame_id})
        except (TypeError, ValueError) as error:
            self._refuse(error)

    def clear(self) -> None:
        """Start a new path: the poses so far go, and the next one is the first."""
        with self._newest.lock:
            self._track, self._recent, self._began, self._is_path_new = Path(), RecentPoses(), None, True
        pacer.mark(self)

    @property
    def pose(self) -> PathPoint | None:
        """The pose on show: the frozen one while paused, else the newest; None before the first."""
        return self._sample_on_show()

    @property
    def frozen(self) -> PathPoint | None:
        """The pose on show while frozen, which may be stepped back to; None while live and before the first."""
        return self.pose if self.paused else None

    @property
    def points(self) -> NDArray[np.float64]:
        """The path: seconds, x and y in metres, yaw in radians and metres of the way so far, shape (N, 5).

        In the player of a recording it is that of the whole recording.
        """
        with self._newest.lock:
            return self._track.points

    def robot_at(self, sample: HasAge) -> Pose | None:
        """Where the robot was at the time of a sample that came just now; None while that is unknown."""
        with self._newest.lock:
            return self._recent.at(arrival_of(sample), getattr(sample, "stamp_ns", None))

    def within(self, start: float, end: float) -> dict[str, Any]:
        """See `RobotWidget`: the points there, with the one before, which tells how far the robot had come."""
        points = self.points
        first, stop = np.searchsorted(points[:, 0], (start, end), "right")
        return {"_path": points[max(0, first - 1) : stop].tobytes()}

    def show_whole(self, path: Path, until: float = inf) -> None:
        """Show a recording's path, of which a player then shows one moment; complete up to a time in seconds."""
        self._track, self._complete_until = path, until
        self._path = path.points.tobytes()

    def frame_of(self, sample: PathPoint) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`."""
        about: dict[str, Any] = {"frame_id": sample.frame_id}
        if sample.time > self._complete_until:
            about["notes"] = [f"no path after {self._complete_until:.0f} s: reading all of it takes long"]
        return about, self._pack(sample)

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
        now = time.monotonic()
        self._began = now if self._began is None else self._began
        seconds = fields.get("time", getattr(message, "seconds", now - self._began))
        inner = unwrap(message)
        stamp = getattr(inner, "stamp_ns", None) or stamp_ns(inner)
        return PathPoint(finite("time", seconds, "seconds"), pose.x, pose.y, pose.yaw, stamp, frame_id(inner))

    def _measured_at(self, point: PathPoint, message: Any, fields: dict[str, Any]) -> float | None:
        """Seconds at which a pose was measured; None where only its arrival is known."""
        if point.stamp_ns:
            return point.stamp_ns / 1e9
        return point.time if "time" in fields or hasattr(message, "seconds") else None

    def _describe(self) -> str:
        at = self.pose
        return f"x {at.x:.2f} m, y {at.y:.2f} m at {at.time:.2f} s" if at else ""

    def _pack(self, sample: PathPoint) -> bytes:
        return _FRAME.pack(sample.time, sample.x, sample.y, sample.yaw)

    def _unpack(self, frame: bytes) -> PathPoint:
        _, _, stamp_ns, arrived = FRAME_HEADER.unpack_from(frame)
        seconds, x, y, yaw = _FRAME.unpack_from(frame, FRAME_HEADER.size)
        point = PathPoint(seconds, x, y, yaw, stamp_ns or None, self._frozen_about.get("frame_id", ""))
        note_arrival(point, arrived)
        return point

    def _bring_up_to_date(self) -> None:
        """Have the path sent with the newest pose, unless it was sent just now."""
        super()._bring_up_to_date()
        with self._newest.lock:
            if not self._is_path_new:
                return
            now = time.monotonic()
            if now < self._path_due:
                pacer.mark_at(self, self._path_due)
                return
            self._is_path_new, self._path_due = False, now + _SPACING
            # Without sending it at once, as setting the trait would.
            self._trait_values["_path"] = self._track.points.tobytes()
            self._unsent.add("_path")

"""A widget with a simulated robot in its room, seen from above."""

from __future__ import annotations

import struct
import threading
import weakref
from collections import deque
from collections.abc import Iterable
from math import hypot
from typing import Any

import numpy as np
import traitlets

from ..runtime.platform_fixes import route_by_message
from ..samples import Validity
from ..samples.checks import finite
from ..widget.freezing import FreezableWidget
from ..widget.front_end import bundle
from ..widget.heartbeat import BeatingWidget
from ..widget.pacer import pacer
from ..widget.traits import Flag, bytes_trait
from .robot import Robot

HEADER = struct.Struct("<14d")
"""Time, robot (x, y, yaw, radius), scan (x, y, yaw of the robot, angle_min, angle_increment, range_max), and the
numbers of rays, of places on the path, and of obstacles. After the header come the ranges, and triples (time, x, y)
and (x, y, radius), all as float32."""

PATH_SECONDS = 30.0
_PATH_STEP = 0.05
_PUT_RADIUS = 0.2
_MOST_OBSTACLES = 200


class View(BeatingWidget, FreezableWidget):
    """A simulated robot in its room, from above and to scale, with its readings and the path of the last 30 s.

    For a feed, it also shows the shapes that programs draw on the laser widgets of the feed.

    On the page, the user drags the robot and obstacles, turns the robot by its handle, and adds and removes obstacles,
    by pointer, touch or keys (``n`` next thing, arrows, ``[`` ``]``, ``o``, Delete). A thing without room stays at its
    old place. While a cell computes, the picture goes on if the simulation does. Edits of the page are made as soon as
    the kernel handles messages: at once with ipykernel 7, otherwise when the cell ends.

    It is frozen together with the other widgets of its feed. A press on it ends this, so that the user never drags
    things from an outdated place.

    Args:
        robot: a `Robot`, or a feed of `robowidgets.feeds.simulator`.
        title: text for the header.
        paused: True while the picture is frozen.
        header, footer: True to show them.

    Raises:
        TypeError: not a robot or such a feed, or an unknown keyword.

    Examples:
        >>> from robowidgets.simulator import Robot, View, room
        >>> view = View(Robot(room("maze")))
        >>> view
        <View simulator: robot at x 0.90, y 6.30 m, no obstacles>
    """

    _esm, _css = bundle("simulator_widget")
    _unnamed = 1
    beats = True
    sample_name = "room"
    send_interval = 1 / 30
    """The shortest time in seconds between two pictures."""

    footer = Flag(True, help="True to show coordinates below the picture.").tag(sync=True)
    _walls = bytes_trait(echo_update=False)
    _drops = bytes_trait(echo_update=False)
    _shapes: traitlets.List[Any] = traitlets.List().tag(sync=True, echo_update=False)
    _status = traitlets.Unicode().tag(sync=True, echo_update=False)

    def __init__(self, robot: Any, **kwargs: Any) -> None:
        simulated = robot if isinstance(robot, Robot) else getattr(robot, "robot", None)
        if not isinstance(simulated, Robot):
            raise TypeError(f"View(): expected a robot of robowidgets.simulator, or its feed, got {robot!r}")
        self._robot, self._feed = simulated, weakref.ref(robot)
        self._connection = getattr(robot, "connection", None)
        self._shown_walls: Any = None
        self._send_lock = threading.RLock()
        self._path: deque[tuple[float, float, float]] = deque()
        super().__init__(**{"title": "simulator", **kwargs})
        self.freeze_with_robot()
        self._sent = self._frame, self._shapes, self._status  # by `get_state`, for the first page
        self.on_msg(self._on_page)
        simulated.observe(self._on_step)
        if self._connection is not None:
            self._connection.observe(self._on_step)  # also when it is closed
        pacer.mark(self)  # for the first beat

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm)

    def freeze_with_robot(self) -> None:
        """Freeze it on the page together with all widgets of the robot of its feed."""
        self._together = self._connection.page_name if self._connection is not None else ""

    def close(self) -> None:
        """Remove the widget from the page. The robot goes on."""
        if "_robot" in vars(self):
            self._robot.unobserve(self._on_step)
            if self._connection is not None:
                self._connection.unobserve(self._on_step)
            with self._send_lock:
                super().close()
                pacer.forget(self)

    def _summary(self) -> str:
        (x, y, _), count = self._robot.pose, len(self._robot.world.obstacles)
        return f"robot at x {x:.2f}, y {y:.2f} m, {count or 'no'} obstacle{'' if count == 1 else 's'}"

    # -- to the page ---------------------------------------------------------------------------------------------------

    def _on_step(self) -> None:
        """Extend the path, and request a picture. Runs in the thread that steps or moves the robot."""
        robot, path = self._robot, self._path
        x, y, _ = robot.pose
        if not path or hypot(x - path[-1][1], y - path[-1][2]) >= _PATH_STEP:
            path.append((robot.time, x, y))
        while path and path[0][0] < robot.time - PATH_SECONDS:
            path.popleft()
        pacer.mark(self)

    def send_newest(self) -> int:
        """Send the newest picture to the page. Return the number of bytes sent. The pacer calls it."""
        with self._send_lock:
            if self.comm is None:
                return 0
            self._bring_up_to_date()
            before, self._sent = self._sent, (self._frame, self._shapes, self._status)
            names = ("_frame", "_shapes", "_status")
            changed = [name for name, old, new in zip(names, before, self._sent, strict=True) if old != new]
            changed += self._due_beat()
            if changed:
                super().send_state(changed)
            return len(self._frame) if "_frame" in changed else 0

    def get_state(self, key: str | Iterable[str] | None = None, drop_defaults: bool = False) -> dict[str, Any]:
        """Return the synced traits with the newest picture, for a new view, a reload and a saved notebook."""
        if key is None and "_robot" in vars(self):
            with self._send_lock:
                self._bring_up_to_date()
        state: dict[str, Any] = super().get_state(key, drop_defaults)
        return state

    def _bring_up_to_date(self) -> None:
        """Pack the newest picture without sending it. Setting the traits would send it."""
        world = self._robot.world
        if world.walls is not self._shown_walls:
            self._shown_walls, self._walls = world.walls, world.walls.astype("<f4").tobytes()
            self._drops = world.drops.astype("<f4").tobytes()
        self._trait_values |= {"_frame": self._pack(), "_shapes": self._drawn(), "_status": self._said()}

    def _drawn(self) -> list[Any]:
        feed: Any = self._feed()
        return feed.drawn() if hasattr(feed, "drawn") else []

    def _said(self) -> str:
        if self._connection is not None and self._connection.is_closed:
            return "the feed is closed"
        return "the robot is over an edge: drag it back" if self._robot.has_fallen else ""

    def _pack(self) -> bytes:
        robot, path = self._robot, np.array([*self._path], "<f4")
        # The angles are relative to the robot, like the angles of shapes that programs draw.
        scan, (x, y, yaw) = robot.scan(), robot.scan_pose.offset(0.0, 0.0, -robot.scanner.mount[2])
        is_met = scan.validity == Validity.READING
        # A code that also stands for failed measurements does not mean that the way is free.
        scanner = robot.scanner
        is_nothing = (scan.ranges == np.float32(scanner.nothing)) & (scanner.nothing not in scanner.failed)
        ranges = np.where(is_met, scan.ranges, np.where(is_nothing, np.inf, np.nan))
        obstacles = robot.world.obstacles.astype("<f4")
        geometry = (scan.angle_min, scan.angle_increment, scan.range_max)
        counts = (len(ranges), len(path), len(obstacles))
        header = HEADER.pack(robot.time, *robot.pose, robot.radius, x, y, yaw, *geometry, *counts)
        return header + ranges.astype("<f4").tobytes() + path.tobytes() + obstacles.tobytes()

    # -- from the page -------------------------------------------------------------------------------------------------

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Make an edit of the page, and answer it. Runs in the main thread or in the thread of a subshell."""
        refused = ""
        try:
            self._edit(content)
        except (TypeError, ValueError, KeyError, IndexError) as error:
            refused = str(error)
            self._log_once(f"an edit of the page was not made: {error}")
        self.send({"edit": content.get("edit") if isinstance(content, dict) else None, "refused": refused})
        self._on_step()

    def _edit(self, content: Any) -> None:
        """Make an edit; TypeError, ValueError, KeyError or IndexError if it cannot be made."""
        if not isinstance(content, dict):
            raise TypeError(f"expected an edit, got {repr(content)[:60]}")
        robot, act = self._robot, content["act"]
        if act == "reset":
            getattr(self._feed(), "reset", robot.reset)()
            return
        if act == "robot":
            robot.move_to(content["x"], content["y"], content["yaw"])
            return
        obstacles = robot.world.obstacles.tolist()
        if act == "remove":
            obstacles.pop(_index(content["index"], obstacles))
        elif act in ("put", "move"):
            place = [finite(name, content[name], "metres") for name in "xy"]
            if act == "move":
                obstacles[_index(content["index"], obstacles)][:2] = place
            elif len(obstacles) < _MOST_OBSTACLES:
                obstacles.append([*place, _PUT_RADIUS])
            else:
                raise ValueError(f"expected at most {_MOST_OBSTACLES} obstacles")
        else:
            raise ValueError(f"act: expected robot, put, move, remove or reset, got {act!r}")
        robot.world = robot.world.with_obstacles(obstacles)


def _index(index: Any, obstacles: list[Any]) -> int:
    if type(index) is not int or not 0 <= index < len(obstacles):
        raise IndexError(f"index: expected an obstacle, 0 to {len(obstacles) - 1}, got {index!r}")
    return index

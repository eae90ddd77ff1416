"""The built-in simulated robot in real time: a feed without any middleware."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import Any

from ..messages import to_speed
from ..messages.standard import TWIST
from ..samples.checks import finite
from ..shapes.drawing import DrawsShapes
from ..simulator import Robot, Scanner, World
from ..simulator import room as room_of
from ..simulator import wander as wander_about
from ._threaded import ThreadedMiddleware
from .feed import Feed
from .middleware import Advert, FeedError, Listener

TOPICS = (
    Advert("/scan", "sensor_msgs/msg/LaserScan", wanted=False),
    Advert("/odom", "nav_msgs/msg/Odometry", wanted=False),
    Advert("/cmd_vel", TWIST, offered=False, wanted=True),
)

LET_GO = 3.0
"""Seconds without a speed on ``/cmd_vel`` after which the robot wanders again."""

_LATEST = 1.0


class Simulated(ThreadedMiddleware):
    """A simulated robot as a `Middleware`: it runs in real time, in a thread of its own.

    While speeds come on ``/cmd_vel``, it obeys them. Else it wanders about and backs off from obstacles, or stands
    still.

    Args:
        robot: the robot; nothing else may use it meanwhile.
        hz: rate of its speeds and bumpers, per second. Scans come at the rate of its scanner, or at this one if that is
            lower.
        wander: whether it wanders while nobody drives it.
    """

    def __init__(self, robot: Robot, hz: float, wander: bool = True) -> None:
        super().__init__()
        self._robot = robot
        self._step = 1 / hz
        self._wanders = wander
        self._driven: tuple[float, float, float] | None = None if wander else (0.0, 0.0, 0.0)
        self._driven_at = 0.0

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return "the simulated robot"

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        listener.on_connected()
        has_bumpers = bool(self._robot.model.touch_type)
        bumper = Advert("/bumper", self._robot.model.touch_type, wanted=False)
        listener.on_topics((*TOPICS, bumper) if has_bumpers else TOPICS)
        self._start("robowidgets-simulator", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:  # noqa: ARG002
        """See `Middleware`. It takes every message with a speed."""
        if topic != "/cmd_vel":
            raise FeedError(f"the simulated robot listens to /cmd_vel, not to {topic}")
        speed = to_speed(message)
        if self._closed.is_set():
            raise FeedError("the simulated robot is closed")
        self._driven_at = time.monotonic()
        self._driven = (speed.linear[0], speed.angular[2], speed.linear[1])

    def _run(self, listener: Listener) -> None:
        ways = wander_about(self._robot)
        scan = None
        due = time.monotonic()
        while not self._closed.wait(max(0.0, due - time.monotonic())):
            # Catches up with time that a busy cell took from this thread, up to `_LATEST` seconds.
            due = max(due + self._step, time.monotonic() - _LATEST)
            ways = self._steer(ways)
            self._robot.step(self._step)
            samples: dict[str, Any] = {"/odom": self._robot.speed(), "/cmd_vel": self._robot.command()}
            if "/bumper" in self._wanted:
                samples["/bumper"] = self._robot.model.to_message(self._robot.touch())
            if "/scan" in self._wanted and self._robot.scan() is not scan:
                scan = samples["/scan"] = self._robot.scan()
            for topic in self._wanted & samples.keys():
                listener.on_message(topic, samples[topic])

    def _wake(self) -> None:
        """Nothing to do: each step looks at the wanted topics."""

    def _steer(self, ways: Iterator[None]) -> Iterator[None]:
        driven = self._driven
        if driven is None:
            next(ways)
            return ways
        if not self._wanders or time.monotonic() - self._driven_at < LET_GO:
            self._robot.drive(*driven)
            return ways
        self._driven = None
        return wander_about(self._robot)


class SimulatorFeed(Feed):
    """A feed of the built-in robot.

    Args:
        robot, hz, wander: as `simulator` takes them.

    Attributes:
        robot: the simulated robot, for `robowidgets.simulator.View`.
    """

    def __init__(self, robot: Robot, hz: float, wander: bool) -> None:
        self.robot = robot
        super().__init__(Simulated(robot, hz, wander))

    def drawn(self) -> list[dict[str, Any]]:
        """What programs draw on the laser widgets that are connected, as the page reads it."""
        widgets = [widget for widget in self.connection.widgets if isinstance(widget, DrawsShapes)]
        return [form for widget in widgets for form in widget.forms()]


def simulator(
    robot: Robot | str | None = None,
    *,
    scanner: Scanner | str | None = None,
    room: str | World | None = None,
    hz: float = 10.0,
    seed: int = 1,
    wander: bool = True,
) -> SimulatorFeed:
    """A feed of the built-in robot, which needs no middleware: it wanders about a house until it is driven.

    Its topics are /scan, /odom, /cmd_vel and, where it has bumpers, /bumper.

    Args:
        robot: "turtlebot3", "kobuki", "create3" or "pr2"; or a robot of `robowidgets.simulator`; None: a plain one.
        scanner: "utm30lx", "lds01", "rplidar_a1", "urg04lx" or "neato", or a `Scanner`; None: that of the robot.
        room: "house", "corridor", "office" or "maze"; or a `robowidgets.simulator.World`. None: the house, or the world
            of the robot.
        hz: steps of the robot per second, above 0, at most 1000.
        seed: the seed of everything random: of that robot, and of the maze.
        wander: whether it wanders while nobody drives it; False: it stands still.

    Raises:
        TypeError: robot is no robot, room neither a name nor a world, hz or seed no number, or wander neither True nor
            False; a `Robot` is given with room or scanner. ValueError: hz is out of range, or nothing has this name.

    Example:
        >>> from robowidgets import feeds
        >>> with feeds.simulator(room="maze", seed=3) as feed:
        ...     view = feed.show()
        >>> sorted(view.widgets)
        ['/bumper', '/odom', '/scan']
    """
    if robot is not None and not isinstance(robot, (Robot, str)):
        raise TypeError(f"robot: expected a name such as 'turtlebot3', or a Robot, got {robot!r}")
    if isinstance(robot, Robot) and (room is not None or scanner is not None):
        raise TypeError("simulator: expected a Robot, which has its world and scanner, or room= and scanner=; got both")
    if not 0 < finite("hz", hz, "steps a second") <= 1000:
        raise ValueError(f"hz: expected steps a second, above 0 and at most 1000, got {hz!r}")
    if not isinstance(wander, bool):
        raise TypeError(f"wander: expected True or False, got {wander!r}")
    if not isinstance(robot, Robot):
        world = room if isinstance(room, World) else room_of("house" if room is None else room, seed)
        robot = Robot(world, scanner=scanner, seed=seed, model="plain" if robot is None else robot)
    return SimulatorFeed(robot, hz, wander)

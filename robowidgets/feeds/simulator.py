"""The built-in simulated robot in real time: a feed without any middleware."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ..behaviors.program import ENDED
from ..driving.command_watchdog import Velocity
from ..kinds import KINDS
from ..laser_widget import LaserWidget
from ..messages import to_speed
from ..notebook import in_browser
from ..runtime.clock import Clock
from ..samples.checks import finite
from ..simulator import Robot, Scanner, World
from ..simulator import room as room_of
from ..simulator.offers import MakeOffers, cameras
from ..simulator.real_time import RealTime
from ..simulator.robot_process import RobotProcess
from ..simulator.view import View
from ._guard.link import GuardLink
from ._threaded import ThreadedMiddleware
from .feed import Feed
from .middleware import Advert, FeedError, Listener, NotConnectedYetError

_SELF = ("/simulated_robot",)
"""The name of the node that would publish its topics."""

GUARD = "robowidgets.feeds._guard.process:guard_robot"
HELD = 3600.0
"""Seconds for which the process of a robot holds a speed, unless the kernel ends it or is silent."""


class Simulated(ThreadedMiddleware):
    """A simulated robot as a `Middleware`. It runs in real time, in a thread.

    Args:
        robot, hz, wander: as for `RealTime`.
        process: True to run the robot in a separate process. If the process ends, it is started again with the robot in
            its last state.
        clock: as for `ThreadedMiddleware`.
    """

    def __init__(self, robot: Robot, hz: float, wander: bool, process: bool, clock: Clock | None = None) -> None:
        super().__init__(clock)
        self._robot = robot
        offers: list[MakeOffers] = [*(kind.simulated for kind in KINDS.values() if kind.simulated), cameras]
        self._topics = [
            Advert(
                *(offer.topic, offer.type),
                wanted=offer.obeyed,
                publishers=None if offer.obeyed else _SELF,
                subscribers=_SELF if offer.obeyed else (),
            )
            for make in offers
            for offer in make(robot)
        ]
        self.guard = GuardLink(self.where) if process and os.name == "posix" else None
        """The guard in the process of the robot, or None without a process."""
        self._live: RealTime | RobotProcess
        if not process:
            self._live = RealTime(robot, hz, wander, offers, self._clock)
        elif self.guard is None:
            self._live = RobotProcess(robot, hz, wander, offers)
        else:
            self._live = RobotProcess(robot, hz, wander, offers, GUARD, self._listen)

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return "the simulated robot"

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        self._listener = listener
        if isinstance(self._live, RealTime):
            listener.on_connected()  # at once, because the next line of a cell may drive
        listener.on_topics(self._topics)
        self._start_thread("robowidgets-simulator", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:  # noqa: ARG002
        """See `Middleware`. It accepts every message with a speed."""
        if topic != "/cmd_vel":
            raise FeedError(
                f"the simulated robot listens to /cmd_vel, not to {topic}: leave topic out of feeds.Driving"
            )
        speed = to_speed(message)
        if speed.linear[1] and not self._robot.motors.max_lateral:
            raise FeedError("the simulated robot does not move sideways; feeds.simulator('pr2') does")
        if self._closed.is_set():
            raise FeedError("the simulated robot is closed: open the feed again")
        try:
            if self.guard is None:
                self._live.drive(speed.linear[0], speed.angular[2], speed.linear[1])
            else:
                velocity = Velocity(speed.linear[0], speed.angular[2], speed.linear[1])
                self.guard.send(0, topic, velocity, time.monotonic() + HELD, ())
        except ConnectionRefusedError as error:
            raise NotConnectedYetError(str(error)) from None
        except OSError as error:
            raise FeedError(str(error)) from None
        self._listener.on_message(topic, speed)

    def stand(self, stands: bool) -> None:
        """Stand still instead of wandering, or wander again some seconds later."""
        self._live.stand(stands)

    def _listen(self, process: socket.socket) -> None:
        """Read the messages of the guard in the process of the robot, while it runs."""
        with process:
            if self.guard is not None:
                self.guard.listen(process, "open", "robot", {})

    def _run_session(self, listener: Listener) -> str:
        if isinstance(self._live, RealTime):
            self._live.run(listener.on_message)
            return ""

        def on_start() -> None:
            self._backoff.reset()
            listener.on_connected()

        return self._live.run(listener.on_message, on_start, listener.on_missed)

    def _wake_session(self) -> None:
        if self._closed.is_set():
            if self.guard is not None:
                self.guard.close()
            self._live.end()
        else:
            self._live.want(self._wanted, self._each)


class SimulatorFeed(Feed):
    """A feed of the built-in robot.

    Args:
        robot, hz, wander, process: as for `simulator`.

    Attributes:
        robot: the simulated robot, for `robowidgets.simulator.View`.
    """

    def __init__(self, robot: Robot, hz: float, wander: bool, process: bool) -> None:
        self.robot = robot
        self._wanders = wander
        simulated = Simulated(robot, hz, wander, process)
        super().__init__(simulated)
        watchdog = self.watchdog
        watchdog.observe(lambda: simulated.stand(watchdog.stopped))  # without the feed, which the user may delete
        self.driving = replace(self.driving, max_lateral=min(robot.motors.max_lateral, self.driving.max_linear))

    @property
    def idle_motion(self) -> str:
        """See `Feed`."""
        return "the simulation wanders by itself" if self._wanders else ""

    def room_view(self) -> View:
        """See `Feed`."""
        return View(self)

    def reset(self) -> None:
        """Restart the simulation: robot and obstacles at their initial places, variables with their first values.

        The program restarts: in its initial state, with an empty ``state``.
        """
        self.robot.reset()
        self.variables.take_first_values()
        program = self.programs.current
        if program is not None and program.mode != ENDED:
            program.restart(self.robot.odometry)

    def drawn(self) -> list[dict[str, Any]]:
        """Return the drawings of programs on connected laser widgets, in the form for the page.

        ``turned`` is the angle in radians that a widget adds to the angles of the scanner.
        """
        widgets = [widget for widget in self.connection.widgets if isinstance(widget, LaserWidget)]
        return [{**form, "turned": widget.angle_offset} for widget in widgets for form in widget.forms()]


def simulator(
    robot: Robot | str | None = None,
    *,
    scanner: Scanner | str | None = None,
    room: str | World | None = None,
    hz: float = 10.0,
    seed: int = 1,
    wander: bool = True,
    process: bool = False,
    camera: bool = False,
) -> SimulatorFeed:
    """Open a feed of the built-in robot, which needs no middleware. It wanders around a house until it is driven.

    Its topics are /scan, /odom, /cmd_vel, /bumper if it has bumpers, and a topic below /sonar for each of its sonars;
    with a camera also /camera/image_raw, /camera/depth/image_rect_raw, /camera/camera_info and /tf.

    Args:
        robot: "turtlebot3", "kobuki", "create3", "pioneer" or "pr2"; or a robot of `robowidgets.simulator`. The default
            is a plain robot.
        scanner: "utm30lx", "lds01", "rplidar_a1", "urg04lx" or "neato", or a `Scanner`. The default is the robot's
            scanner.
        room: "house", "corridor", "office" or "maze"; or a `robowidgets.simulator.World`. The default is the house, or
            the world of the robot.
        hz: steps of the robot per second, above 0, at most 1000.
        seed: the seed of everything random, in the robot and in the maze.
        wander: True to wander while it is not driven, False to stand still.
        process: True to run it in a separate process, so that its time continues while a cell keeps Python busy.
        camera: True for a camera that looks ahead.

    Raises:
        TypeError: robot is not a robot; room is neither a name nor a world; hz or seed is not a number; wander, process
            or camera is neither True nor False; or a `Robot` is given with room, scanner or camera.
        ValueError: hz is out of range, or a name is unknown.

    Examples:
        >>> from robowidgets import feeds
        >>> with feeds.simulator(room="maze", seed=3) as feed:
        ...     view = feed.show()
        >>> sorted(view.widgets)
        ['/bumper', '/odom', '/scan']
    """
    if robot is not None and not isinstance(robot, (Robot, str)):
        raise TypeError(f"robot: expected a name such as 'turtlebot3', or a Robot, got {robot!r}")
    if isinstance(robot, Robot) and (room is not None or scanner is not None or camera):
        raise TypeError(
            "simulator: expected a Robot, which has its world, scanner and camera, or room=, scanner= and camera=; "
            "got both"
        )
    if not 0 < finite("hz", hz, "steps a second") <= 1000:
        raise ValueError(f"hz: expected steps a second, above 0 and at most 1000, got {hz!r}")
    for name, value in (("wander", wander), ("process", process), ("camera", camera)):
        if not isinstance(value, bool):
            raise TypeError(f"{name}: expected True or False, got {value!r}")
    if process and in_browser.IN_BROWSER:
        raise ValueError("process: expected False, because Python in a browser starts no processes, got True")
    if not isinstance(robot, Robot):
        world = room if isinstance(room, World) else room_of("house" if room is None else room, seed)
        model = "plain" if robot is None else robot
        robot = Robot(world, scanner=scanner, seed=seed, model=model, camera=camera)
    return SimulatorFeed(robot, hz, wander, process)

"""The robot: a round body on wheels, with a scanner, bumpers and cliff sensors."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import cos, hypot, inf, pi, sin
from typing import Any

import numpy as np

from ..samples import Image, Pose, Range, Scan, Speed, Touch, TouchMode
from ..samples.checks import finite
from ..widget.observed import Observed
from ._contact import PRESSED_WITHIN, contact_angles, over_drop, pressed, push_out
from ._models import WHEELS, model_of
from ._scanners import scanner_of
from .camera import Camera
from .motors import BodyVelocity, Motors
from .scanner import Scanner
from .sonars import Sonars
from .world import World, to_pose

_LONGEST_STEP = 60.0
_SUBSTEP_NS = 10_000_000
_NANOSECOND = 1e-9
_FAR = 1.0
"""Metres from the body beyond which walls are ignored."""
_WAY_OFF, _TURN_OFF = 0.02, 0.03
"""The largest relative errors of odometry for distances and turns."""
_BEND = 0.02
"""The largest error of odometry in radians per metre on a straight path."""
_MOVING = (
    "_pose", "_odometry", "_command", "_speeds", "_time_ns", "_scan_number", "_scan_ns", "_next_scan_ns", "_scan_pose",
)  # fmt: skip
"""The attributes of a robot that change as time passes."""
_STANDS_ON = {"middle": (0.0, 0.0), **WHEELS}
_EXACT = 1e-6
"""Metres that a body may overlap with a wall or an obstacle by rounding."""


class Robot(Observed):
    """A round robot with a laser scanner and, as a rule, a differential drive and bumpers.

    It obeys `drive` within the limits of its motors. It slides along a wall or an obstacle that it hits at an angle,
    and stops at a wall that it hits head on. With its middle or a wheel over a drop, it stands still until it is moved.
    Time passes only in `step`, so it runs in real time or at any other speed. The same seed and the same calls give the
    same bytes.

    Args:
        world: the world in which it drives.
        pose: the start pose (x, y, yaw) in metres and radians within ±2 pi, or None for the start of the world.
        scanner: its laser scanner: a `Scanner`, "utm30lx", "lds01", "rplidar_a1", "urg04lx" or "neato", or None for the
            scanner of the model.
        motors: the limits of its motors, or None for the limits of the model.
        radius: the radius of the body in metres, or None for the radius of the model.
        seed: the seed of all random numbers, a whole number of 0 or more.
        model: "plain", "turtlebot3", "kobuki", "create3", "pioneer" or "pr2": typical size and limits, bumpers, sonars
            and a scanner.
        sonars: its ring of sonars, or None for the sonars of the model.
        camera: its camera, True for a usual camera that looks forward, or None for no camera.

    Raises:
        TypeError: something is not a number, or a world, scanner, motors or camera of another type.
        ValueError: a value is out of range, or the body does not fit at the pose.

    Examples:
        >>> robot = Robot(World.rooms(), seed=1)
        >>> robot.drive(0.5, 0.0)
        >>> robot.step(0.1)
        >>> round(robot.speed().linear[0], 3)
        0.1
    """

    def __init__(
        self,
        world: World,
        pose: Sequence[float] | None = None,
        *,
        scanner: Scanner | str | None = None,
        motors: Motors | None = None,
        radius: float | None = None,
        seed: int = 0,
        model: str = "plain",
        sonars: Sonars | None = None,
        camera: Camera | bool | None = None,
    ) -> None:
        self._model_name, self.model = model, model_of(model)
        if isinstance(scanner, str):
            scanner = replace(scanner_of(scanner), mount=self.model.scanner.mount)
        self.scanner = self.model.scanner if scanner is None else scanner
        self.motors = self.model.motors if motors is None else motors
        self.sonars = self.model.sonars if sonars is None else sonars
        self.camera = Camera() if camera is True else camera or None
        for name, value, kind in (
            ("world", world, World),
            ("scanner", self.scanner, Scanner),
            ("motors", self.motors, Motors),
            ("sonars", self.sonars, Sonars),
            ("camera", self.camera, (Camera, type(None))),
            ("seed", seed, int),
        ):
            if not isinstance(value, kind):
                expected = getattr(kind, "__name__", "Camera, True or None")
                raise TypeError(f"{name}: expected {expected}, got {value!r}")
        if seed < 0:
            raise ValueError(f"seed: expected 0 or more, got {seed}")
        self._world = world
        self._lock = threading.Lock()
        """Held while the robot moves and measures, because a page may move it at the same time."""
        super().__init__()
        self._known_room = (world, 0.0, 0.0, -inf)
        """A world, a place, and a lower limit in metres for the distance to the nearest thing."""
        self.radius = finite("radius", self.model.radius if radius is None else radius, "metres")
        if self.radius <= 0:
            raise ValueError(f"radius: expected metres above 0, got {radius!r}")
        self._pose = self._fitting(*to_pose("pose", world.start if pose is None else pose))
        self._start = world, self._pose
        self.resets = 0
        """The number of calls of `reset`."""
        self._command: BodyVelocity = (0.0, 0.0, 0.0)
        self._speeds: BodyVelocity = (0.0, 0.0, 0.0)
        self._time_ns = 0
        self._seed = seed
        self._odometry = self._pose
        off = np.random.default_rng((seed, 0, 2)).uniform(-1, 1, 3)
        self._wheels: list[float] = (off * (_WAY_OFF, _TURN_OFF, _BEND)).tolist()
        self._scan_number = 0
        self._scan_ns, self._next_scan_ns = 0, self._scan_period_ns()
        self._scan_pose = self._pose
        self._scan: Scan | None = None
        self._ranges: dict[str, tuple[int, Range]] = {}
        """By sonar: the number of its newest reading, and the reading."""
        self._pictures: tuple[int, Image, Image] | None = None
        """Number, picture and depth image of the newest shot of the camera."""
        shortest_way_through = self.radius / 2
        fastest = hypot(self.motors.max_linear, self.motors.max_lateral)
        self._substep_ns = max(1, min(_SUBSTEP_NS, int(shortest_way_through / fastest * 1e9)))

    @property
    def time(self) -> float:
        """Simulated seconds since the start."""
        return self._time_ns / 1e9

    @property
    def pose(self) -> Pose:
        """The true pose of the robot."""
        return self._pose

    @property
    def has_fallen(self) -> bool:
        """True while its middle or a wheel is over a drop. It stands still until `move_to` moves it away."""
        return self._falls_at(self._pose)

    @property
    def odometry(self) -> Pose:
        """The pose computed from the turns of the wheels, which drifts from the true pose.

        It begins at the start pose. The wheels differ from their nominal size, which changes each distance and turn by
        a few percent, and from each other, which bends a straight path. The seed determines the errors.
        """
        return self._odometry

    @property
    def scan_pose(self) -> Pose:
        """The pose of the scanner when it took the newest scan."""
        return Pose(*self.scanner.placed(*self._scan_pose))

    @property
    def world(self) -> World:
        """The world in which it drives. It may be replaced by another world with room at the pose of the robot.

        Raises:
            TypeError: not a world. ValueError: a wall or an obstacle of the new world overlaps with the robot.
        """
        return self._world

    @world.setter
    def world(self, world: World) -> None:
        if not isinstance(world, World):
            raise TypeError(f"world: expected World, got {world!r}")
        with self._lock:
            self._check_room(world, self._pose.x, self._pose.y, self.radius - _EXACT)
            self._world = world
        self._call_observers()

    def move_to(self, x: float, y: float, yaw: float) -> None:
        """Move the robot to another pose, metres and radians within ±2 pi. It keeps its speed.

        Raises:
            TypeError: something is not a number. ValueError: it is out of range, or the body does not fit at the pose.
        """
        pose = self._fitting(*to_pose("pose", (x, y, yaw)))
        with self._lock:
            self._pose = pose
        self._call_observers()

    def place(self, world: World, pose: Pose, *, odometry: Pose | None = None) -> None:
        """Move the robot to a pose in a world. It keeps its speed.

        Args:
            world: the world.
            pose: the pose in it.
            odometry: the new pose of the odometry, or None to keep its pose.

        Raises:
            ValueError: the body does not fit at the pose.
        """
        with self._lock:
            self._check_room(world, pose.x, pose.y, self.radius - _EXACT)
            self._world, self._pose = world, pose
            if odometry is not None:
                self._odometry = odometry
        self._call_observers()

    def reset(self) -> None:
        """Reset the robot, its odometry, and the obstacles and walls of its world to the start. Time goes on."""
        self.resets += 1
        self.place(*self._start, odometry=self._start[1])

    def drive(self, linear: float, angular: float, lateral: float = 0.0) -> None:
        """Command a speed, m/s forward, rad/s counter-clockwise and m/s to the left, until the next call.

        Raises:
            TypeError, ValueError: not a finite number, or a lateral speed without ``max_lateral`` of the motors.
        """
        command = (
            finite("linear", linear, "m/s"),
            finite("angular", angular, "rad/s"),
            finite("lateral", lateral, "m/s"),
        )
        if lateral and not self.motors.max_lateral:
            raise ValueError(f"lateral: {lateral:g} m/s, but this robot does not move sideways; model='pr2' does")
        self._command = command

    def step(self, dt: float) -> None:
        """Simulate dt seconds, above 0 and at most 60."""
        if not 0 < finite("dt", dt, "seconds") <= _LONGEST_STEP:
            raise ValueError(f"dt: expected seconds, above 0 and at most {_LONGEST_STEP:g}, got {dt!r}")
        end = self._time_ns + max(1, round(dt * 1e9))
        while self._time_ns < end:
            nanoseconds = min(end - self._time_ns, self._next_scan_ns - self._time_ns, self._substep_ns)
            with self._lock:
                self._move(nanoseconds / 1e9)
                self._time_ns += nanoseconds
                if self._time_ns == self._next_scan_ns:
                    self._scan_number += 1
                    self._scan_ns = self._time_ns
                    self._next_scan_ns += self._scan_period_ns()
                    self._scan_pose = self._pose
                    self._scan = None
        self._call_observers()

    def run(
        self,
        until: float | Callable[[], object],
        *,
        behavior: Iterator[object] | None = None,
        period: float = 0.1,
        limit: float = 3600.0,
    ) -> None:
        """Simulate as fast as possible, for tests of programs.

        `robowidgets.behaviors.simulate` runs a program or a state machine in this way.

        Args:
            until: simulated seconds since the start, or a function that returns true to end the run.
            behavior: an iterator such as `wander`, advanced before each step. It commands speeds, then yields.
            period: the duration of a step in seconds.
            limit: the longest run in simulated seconds if ``until`` is a function.

        Raises:
            TypeError: until is neither a number nor a function. ValueError: a number is out of range.
            TimeoutError: the limit has passed.

        Examples:
            >>> from robowidgets.simulator import room, wander
            >>> robot = Robot(room("maze"))
            >>> robot.run(until=lambda: any(robot.touch().touched.values()), behavior=wander(robot))
            >>> robot.time < 20
            True
        """
        end = self.time + finite("limit", limit, "seconds")
        is_enough = until
        if not callable(is_enough):
            end = finite("until", until, "seconds")
        while True:
            if is_enough() if callable(is_enough) else self.time >= end - _NANOSECOND:
                return
            if self.time >= end:
                raise TimeoutError(f"run: until was not true within {limit:g} s of simulated time")
            if behavior is not None:
                next(behavior)
            self.step(min(period, max(end - self.time, _NANOSECOND)))

    def scan(self) -> Scan:
        """Return the newest scan, with angles of the robot; the same object until the scanner takes the next scan."""
        with self._lock:
            if self._scan is None:
                rng = np.random.default_rng((self._seed, self._scan_number))
                measured = self.scanner.measure(self.world, *self._scan_pose, rng, self._scan_ns)
                self._scan = measured.mounted(self.scanner.stands)
            return self._scan

    def sonar(self, name: str) -> Range:
        """Return the newest reading of a sonar; the same object until its next turn. KeyError for an unknown sonar."""
        with self._lock:
            number = self.sonars.number_at(name, self._time_ns)
            if name not in self._ranges or self._ranges[name][0] != number:
                rng = np.random.default_rng((self._seed, number, 3, *name.encode()))
                measured = self.sonars.measure(self.world, self._pose, name, rng, self._time_ns)
                self._ranges[name] = number, measured
            return self._ranges[name][1]

    def image(self) -> Image:
        """Return the newest picture; the same object until the next picture. ValueError without a camera."""
        return self._see()[1]

    def depth_image(self) -> Image:
        """Return the depth image of the same moment as `image`, in millimetres. Otherwise like `image`."""
        return self._see()[2]

    def speed(self) -> Speed:
        """Return the speed measured by the wheels, with the pose of `odometry`."""
        return self._as_speed(*self._speeds, self._odometry)

    def command(self) -> Speed:
        """Return the last speed that `drive` commanded, which may exceed the limits of the motors."""
        return self._as_speed(*self._command)

    def touch(self) -> Touch:
        """Return the states of bumpers, cliff sensors and wheel drops. The latter are True if the floor is missing."""
        x, y, yaw = self._pose
        is_free = self._has_room(x, y, PRESSED_WITHIN)
        angles = [] if is_free else contact_angles(self._around(x, y), x, y, yaw, self.radius)
        states = pressed(angles, self.model.bumpers)
        states |= over_drop(self.world, self._pose, self.radius, self.model.drop_sensors)
        return Touch(states, TouchMode.LEVEL, tuple(states), self._time_ns, "robowidgets.simulator")

    def snapshot(self) -> dict[str, Any]:
        """Return its present state, except its world, for `restore`."""
        with self._lock:
            return {name: getattr(self, name) for name in _MOVING}

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Take over the state of another robot, such as a copy of this robot in another process."""
        with self._lock:
            if snapshot["_scan_number"] != self._scan_number:
                self._scan = None
            vars(self).update(snapshot)
        self._call_observers()

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in ("_lock", "_observers", "model")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state, _lock=threading.Lock(), _observers=[], model=model_of(state["_model_name"]))

    def _see(self) -> tuple[int, Image, Image]:
        if self.camera is None:
            raise ValueError("the robot has no camera; Robot(..., camera=True) has one")
        with self._lock:
            number = int(self._time_ns * self.camera.rate / 1e9)
            if self._pictures is None or self._pictures[0] != number:
                self._pictures = number, *self.camera.see(self.world, self._pose, self._time_ns)
            return self._pictures

    def _as_speed(self, linear: float, angular: float, lateral: float, pose: Pose | None = None) -> Speed:
        return Speed((linear, lateral, 0.0), (0.0, 0.0, angular), self._time_ns, "base_link", pose)

    def _scan_period_ns(self) -> int:
        return self.scanner.period_ns((self._seed, self._scan_number, 1))

    def _fitting(self, x: float, y: float, yaw: float) -> Pose:
        self._check_room(self.world, x, y, self.radius)
        pose = Pose(x, y, _wrapped(yaw))
        if self._falls_at(pose):
            raise ValueError(f"pose: expected floor below the robot and its wheels, got ({x:g}, {y:g}) over a drop")
        return pose

    def _falls_at(self, pose: Pose) -> bool:
        return any(over_drop(self.world, pose, self.radius, _STANDS_ON).values())

    def _check_room(self, world: World, x: float, y: float, radius: float) -> None:
        room = world.clearance(x, y)
        if room < radius:
            raise ValueError(
                f"pose: expected a place with {self.radius:g} m of room, got ({x:g}, {y:g}), "
                f"{room:.3f} m from the nearest wall or obstacle"
            )

    def _has_room(self, x: float, y: float, more: float = 0.0) -> bool:
        """Return True if nothing is nearer than the radius of the body plus some metres.

        The room at one place also limits the room at places near it, which saves most checks of the walls.
        """
        world, known_x, known_y, room = self._known_room
        least = self.radius + more
        if world is not self._world or room - hypot(x - known_x, y - known_y) <= least:
            world = self._world
            room = min(world.near(x, y, least + _FAR).clearance(x, y), least + _FAR)
            self._known_room = (world, x, y, room)
            return room > least
        return True

    def _around(self, x: float, y: float) -> World:
        """Return the part of the world that the body may touch. Pushing it out moves it by less than its size."""
        return self.world.near(x, y, 2 * self.radius)

    def _move(self, dt: float) -> None:
        if self.has_fallen:
            self._speeds = (0.0, 0.0, 0.0)
            return
        linear, angular, lateral = self.motors.toward(self._speeds, self._command, dt)
        (x, y, yaw), turned = self._pose, angular * dt
        wanted = _moved(self._pose, linear * dt, lateral * dt, turned)
        place = wanted[:2]
        if not self._has_room(*place):
            place = push_out(self._around(*place), *place, self.radius) or (x, y)
        if place != wanted[:2]:
            dx, dy, heading = place[0] - x, place[1] - y, yaw + turned / 2
            linear = _slowed(linear, dx * cos(heading) + dy * sin(heading), dt)
            lateral = _slowed(lateral, dy * cos(heading) - dx * sin(heading), dt)
        self._speeds, self._pose = (linear, angular, lateral), Pose(*place, wanted.yaw)
        way_off, turn_off, bend = self._wheels
        ahead, left = linear * dt * (1 + way_off), lateral * dt * (1 + way_off)
        self._odometry = _moved(self._odometry, ahead, left, turned * (1 + turn_off) + ahead * bend)


def _moved(pose: Pose, ahead: float, left: float, turned: float) -> Pose:
    """Return the pose after a path in metres and a turn in radians. The path has the heading halfway in the turn."""
    heading = pose.yaw + turned / 2
    return Pose(
        pose.x + ahead * cos(heading) - left * sin(heading),
        pose.y + ahead * sin(heading) + left * cos(heading),
        _wrapped(pose.yaw + turned),
    )


def _slowed(speed: float, travelled: float, dt: float) -> float:
    """Return the speed of a body that a wall let travel this distance: at most its old speed, and never backward."""
    low, high = sorted((0.0, speed))
    return max(low, min(high, travelled / dt))


def _wrapped(angle: float) -> float:
    return (angle + pi) % (2 * pi) - pi

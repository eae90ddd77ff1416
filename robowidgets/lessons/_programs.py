"""The tasks of the lesson on programs, which drive the simulated robot as fast as the computer can."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from math import cos, dist, inf, nan, pi, radians, remainder, sin
from typing import Any

import numpy as np

from ..behaviors.drive import NoDriveError
from ..behaviors.machine import Machine
from ..behaviors.simulation import simulate
from ..samples import Scan
from ..samples.state_span import spelled
from ..simulator import Robot, Scanner, World
from ._bounded import BrokenError, WrongError, beyond, shown
from ._case import MOTORS, Answer, Case, check_rest, nearest_in, touches, why_hit
from ._texts import say

_WALL_AHEAD = (2.5, -4.0, 2.5, 4.0)


# -- see the array -----------------------------------------------------------------------------------------------------


def wall_ahead() -> Sequence[Case]:
    """Return the cases for the metres to the nearest thing within 20 degrees of forward."""
    world = World([_WALL_AHEAD])
    left, right = (World([_WALL_AHEAD, (-1.0, y, 2.5, y)]) for y in (0.4, -0.4))
    inside = [World([_WALL_AHEAD], [_post(angle)]) for angle in (19, -19)]
    outside = World([_WALL_AHEAD], [_post(21), _post(-21)])
    fine = Scanner(720, 2 * pi)
    failing = Scanner(dropout=0.2)
    circle = Scanner(360, 2 * pi)
    ahead = partial(nearest_in, ("-20deg", "20deg"))
    no_farther = say("Look 20 degrees to both sides, and no farther")
    return [
        ahead(say("a wall ahead"), Robot(world, seed=11).scan(), say("Take the nearest of all rays there")),
        ahead(say("a wall close on the left"), Robot(left, seed=11).scan(), no_farther),
        ahead(say("a wall close on the right"), Robot(right, seed=11).scan(), no_farther),
        ahead(
            say("a chair leg on the left"),
            Robot(inside[0], scanner=fine, seed=11).scan(),
            say("One ray is not enough: take a sector"),
        ),
        ahead(
            say("a chair leg on the right"),
            Robot(inside[1], scanner=fine, seed=11).scan(),
            say("One ray is not enough: take a sector"),
        ),
        ahead(say("chair legs beyond 20 degrees"), Robot(outside, scanner=fine, seed=11).scan(), no_farther),
        ahead(
            say("rays that fail"),
            Robot(world, scanner=failing, seed=11).scan(),
            say("Take the nearest of all rays there"),
        ),
        ahead(
            say("another scanner"),
            Robot(world, scanner=circle, seed=11).scan(),
            say("Ask for angles, not for a slice"),
        ),
    ]


def _post(angle: float) -> tuple[float, float, float]:
    """Return an obstacle 1.2 m away, at an angle in degrees, that covers less than one degree."""
    return 1.2 * cos(radians(angle)), 1.2 * sin(radians(angle)), 0.01


# -- stop before a wall ------------------------------------------------------------------------------------------------


def stop_before_wall() -> Sequence[Case]:
    """Return the cases for stopping 0.5 m before the wall ahead."""
    beside, other = (1.0, 0.3, 2.5, 0.3), (1.0, -0.3, 2.5, -0.3)
    left, right = (1.5, 0.05, 0.02), (1.5, -0.05, 0.02)
    return [
        _stop(say("a wall ahead"), World([_WALL_AHEAD]), _WALL_AHEAD[0]),
        _stop(say("a wall ahead and one close on the left"), World([_WALL_AHEAD, beside]), _WALL_AHEAD[0]),
        _stop(say("a wall ahead and one close on the right"), World([_WALL_AHEAD, other]), _WALL_AHEAD[0]),
        _stop(say("a chair leg ahead, to the left"), World([_WALL_AHEAD], [left]), left[0] - left[2]),
        _stop(say("a chair leg ahead, to the right"), World([_WALL_AHEAD], [right]), right[0] - right[2]),
        _blind(say("a covered scanner, which sends only NaN")),
    ]


def _stop(title: str, world: World, ahead: float) -> Case:
    def judge(answer: Answer) -> None:
        robot = Robot(world, motors=MOTORS, seed=12)
        start = robot.pose
        for _ in _steps(answer, robot, 25):
            if touches(robot):
                why = why_hit(robot, say("return Drive() if something is near ahead"))
                raise WrongError("it hit what is ahead at {seconds:.1f} s: {why}", seconds=robot.time, why=why)
        check_rest(robot, start, ahead, 0.4, 0.6)

    return Case(title, Robot(world, seed=12).scan(), judge)


class _Covered(Robot):
    """A robot whose scanner can be covered, so that it sends only NaN."""

    is_covered = False

    def scan(self) -> Scan:
        scan = super().scan()
        return scan.again(np.full(len(scan), nan), None, scan.stamp_ns) if self.is_covered else scan


def _blind(title: str, seconds: float = 0.0) -> Case:
    """Return a case that expects a standstill while the scanner is covered, after some seconds of driving."""
    world = World([_WALL_AHEAD])

    def covered() -> _Covered:
        robot = _Covered(world, motors=MOTORS, seed=13)
        robot.is_covered = not seconds
        return robot

    def judge(answer: Answer) -> None:
        robot = covered()
        for _ in _steps(answer, robot, seconds + 2):
            robot.is_covered = robot.time >= seconds
            if robot.time > (seconds + 1 if seconds else 0) and abs(robot.speed().linear[0]) > 0.02:
                raise WrongError(
                    "at {seconds:.1f} s it drives blind. Drive while the distance is greater: no comparison with NaN "
                    "is true"
                    if seconds
                    else "it drives blind. Drive while the distance is greater: no comparison with NaN is true",
                    seconds=robot.time,
                )

    return Case(title, covered().scan(), judge)


# -- follow it ---------------------------------------------------------------------------------------------------------


def follow_wall() -> Sequence[Case]:
    """Return the cases for driving to the wall, turning left, and driving on with the wall on the right."""
    room = [(-2.5, -2.5, 2.5, -2.5), (2.5, -2.5, 2.5, 2.5), (2.5, 2.5, -2.5, 2.5), (-2.5, 2.5, -2.5, -2.5)]
    return [
        _follow(say("a wall ahead"), World([(2.5, -4.0, 2.5, 9.0)]), 30),
        _follow(say("the corners of a room"), World(room), 60),
        _blind(say("a covered scanner, which sends only NaN")),
        _blind(say("a scanner that is covered on the way"), 20),
    ]


def _follow(title: str, world: World, seconds: float) -> Case:
    def judge(answer: Answer) -> None:
        robot = Robot(world, motors=MOTORS, seed=14)
        way, before, arrived = 0.0, robot.pose, inf
        for _ in _steps(answer, robot, seconds):
            distance = world.clearance(*robot.pose[:2])
            way, before = way + dist(before[:2], robot.pose[:2]), robot.pose
            if touches(robot):
                raise WrongError("it hit the wall at {seconds:.1f} s: turn left sooner", seconds=robot.time)
            if distance < 0.7 and arrived == inf:
                arrived, way = robot.time, 0.0
            if robot.time > arrived + 5 and not 0.3 <= distance <= 0.7:
                raise WrongError(
                    "at {seconds:.1f} s the wall is {away} m away, not 0.3 to 0.7 m: turn right when it is far"
                    if distance > 0.7
                    else "at {seconds:.1f} s the wall is {away} m away, not 0.3 to 0.7 m: turn left when it is near",
                    seconds=robot.time,
                    away=beyond(distance, 0.3, 0.7),
                )
        if arrived == inf:
            raise WrongError(
                "after {seconds:g} s it has not reached the wall: drive on while there is room ahead", seconds=seconds
            )
        expected = 0.1 * (seconds - arrived)
        if way < expected:
            shown = beyond(way, low=round(expected, 1), least=1)
            raise WrongError(
                "it went {way} m along the wall, not {expected:.1f} m or more: turn left, and drive on",
                way=shown,
                expected=expected,
            )
        if not robot.scan().distance("right") < 0.8:
            raise WrongError("the wall is not on its right: turn left at the wall")

    return Case(title, Robot(world, seed=14).scan(), judge)


# -- back off when bumped ----------------------------------------------------------------------------------------------


def back_off() -> Sequence[Case]:
    """Return the cases for driving back after a bump, turning, and driving on."""
    hall = World([(4.0, -4.0, 4.0, 4.0)])
    return [
        _bump(say("a low box ahead"), hall, (1.2, 0.0, 0.1)),
        _bump(say("a low box a little to the left"), hall, (1.2, 0.12, 0.1)),
        _bump(say("a low box a little to the right"), hall, (1.2, -0.12, 0.1)),
    ]


_TURNED = 0.3
"""Radians from the direction of the bump, after which a robot has turned away from a box."""
_WENT_ON = 1.0
"""Metres forward after which a robot has driven on."""


class _Overlooked(Robot):
    """A robot whose scanner looks over an obstacle, which is lower."""

    def __init__(self, world: World, obstacle: tuple[float, float, float]) -> None:
        super().__init__(world.with_obstacles([obstacle]), motors=MOTORS, seed=15)
        self._eyes = Robot(world, seed=15)

    def scan(self) -> Scan:
        self._eyes.move_to(*self.pose)
        self._eyes.step(1 / self.scanner.rate)
        return self._eyes.scan()


def _bump(title: str, world: World, box: tuple[float, float, float]) -> Case:
    def judge(answer: Answer) -> None:
        robot = _Overlooked(world, box)
        touched_at, bumped_yaw, bumps, was_touched = inf, 0.0, 0, False
        turned, went, before = 0.0, 0.0, robot.pose
        for _ in _steps(answer, robot, 30):
            touched, pose = touches(robot), robot.pose
            if bumps and not touched:
                turned = max(turned, abs(remainder(pose.yaw - bumped_yaw, 2 * pi)))
                forward = (pose.x - before.x) * cos(pose.yaw) + (pose.y - before.y) * sin(pose.yaw)
                went += max(forward, 0.0) if turned > _TURNED else 0.0
            before = pose
            if touched and not was_touched:
                touched_at, bumps, bumped_yaw = robot.time, bumps + 1, robot.pose.yaw
            was_touched = touched
            if touched and robot.time > touched_at + 1:
                raise WrongError(
                    "it still pushes 1 s after it bumped into the box at {seconds:.1f} s: drive back",
                    seconds=touched_at,
                )
            if bumps > 3:
                break
        if not bumps:
            raise WrongError("it did not reach the box within 30 s: drive on while there is room ahead")
        if turned < _TURNED:
            raise WrongError("it did not turn after it bumped into the box: drive back, then turn, then drive on")
        if bumps > 3:
            raise WrongError("it bumped into the same box for the fourth time: after driving back, turn for longer")
        if went < _WENT_ON:
            raise WrongError(
                "after it turned it drove only {way:.1f} m forward: after driving back and turning, drive on", way=went
            )
        if dist(robot.pose[:2], box[:2]) < 0.8:
            raise WrongError("after 30 s it is still next to the box: after driving back, turn, and drive on")

    return Case(title, _Overlooked(world, box).scan(), judge)


# -- all of them -------------------------------------------------------------------------------------------------------


def _steps(program: Any, robot: Robot, seconds: float) -> Iterator[None]:
    """Run a program on a robot step by step; `BrokenError` if it is not a program, or never drives."""
    start, states = robot.pose, set[str]()
    machine = getattr(program, "__wrapped__", program)  # the machine inside the wrapper of `Bounded.of`
    try:
        for step in simulate(program, robot, seconds):
            states.update(machine.active if isinstance(machine, Machine) else step.active)
            yield
    except NoDriveError as error:
        raise BrokenError(
            "expected a step to return Drive(linear, angular), or None to keep the speed, got {answer}",
            answer=shown(error.result),
        ) from None
    except (TypeError, ValueError) as error:
        raise BrokenError("{error}", error=error) from None
    if robot.pose == start and seconds > 10 and len(states) == 1:
        raise BrokenError(
            "it did not move in {seconds:g} s: it begins in the state {state}, the first in its class, and never left "
            "this state",
            seconds=seconds,
            state=spelled(states.pop()),
        )
    if robot.pose == start and seconds > 10:
        raise BrokenError("it did not move in {seconds:g} s: does it return a Drive with a speed?", seconds=seconds)

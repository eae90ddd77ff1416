"""The five tasks of the lesson from picture to code: the cases that test an answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import cos, inf, isfinite, nan, pi, radians, sin

import numpy as np

from ..samples import Scan, Touch, TouchMode
from ..simulator import Robot, Scanner, World
from ._bounded import WrongError, call, number, pair, yes_or_no
from ._case import MOTORS, Answer, Case, check_rest, nearest_in, touches, why_hit
from ._texts import say

_STEP_S = 0.1
_SPEED_OFF = 0.015
"""The tolerance of a required speed in m/s."""

_FASTEST, _FASTEST_TURN = 2.0, 2 * pi
"""The highest plausible speeds of a small robot in m/s and rad/s."""


# -- nearest on the left -----------------------------------------------------------------------------------------------


def nearest_on_the_left() -> Sequence[Case]:
    """Return the cases for the metres to the nearest thing in the quarter of the circle on the left."""
    hall = Robot(World.rooms(), (-3.0, -0.8, 0.6), seed=3).scan()
    near_right = Robot(World.rooms(), (1.6, 0.4, 1.57), seed=4).scan()
    circle = Robot(World.rooms(), (4.6, -2.0, 0.0), scanner=Scanner(360, 2 * pi), seed=5).scan()
    zeros = replace(hall, ranges=np.where(np.arange(len(hall)) % 3 == 0, np.float32(0), hall.ranges))
    free = Robot(World([(2.0, -4.0, 2.0, 1.5)]), seed=6).scan()
    on_the_left = partial(nearest_in, "left")
    look = say('Look only on the left, as scan.distance("left") does')
    return [
        on_the_left(say("a hall"), hall, say('scan.distance("left") takes the nearest of all rays there')),
        on_the_left(
            say("something near on the right"),
            near_right,
            look,
        ),
        on_the_left(say("posts just before and just behind the left"), _posts(42, 138), look),
        on_the_left(say("a post at the front end of the left"), _posts(48), look),
        on_the_left(say("a post at the rear end of the left"), _posts(132), look),
        on_the_left(
            say("a scanner that counts clockwise"),
            _clockwise(circle),
            say("Its left has other indices: ask for angles, not for a slice"),
        ),
        on_the_left(
            say("a scanner that sends 0.0 for nothing"), zeros, say("0.0 is its code for nothing seen, not a distance")
        ),
        on_the_left(say("nothing on the left"), free, say("The minimum of no distances is inf: there is room")),
    ]


def _posts(*angles: float) -> Scan:
    """Return the scan of posts 0.7 m away, at angles in degrees, in a room."""
    room = [(-2.0, -2.0, 2.0, -2.0), (2.0, -2.0, 2.0, 2.0), (2.0, 2.0, -2.0, 2.0), (-2.0, 2.0, -2.0, -2.0)]
    posts = [(0.7 * cos(radians(angle)), 0.7 * sin(radians(angle)), 0.02) for angle in angles]
    return Robot(World(room, posts), scanner=Scanner(720, 2 * pi), seed=18).scan()


def _clockwise(scan: Scan) -> Scan:
    """Return the same scan by a scanner that counts clockwise."""
    return Scan(
        scan.ranges[::-1],
        angle_min=float(scan.angles[-1]),
        angle_increment=-scan.angle_increment,
        range_min=scan.range_min,
        range_max=scan.range_max,
        frame_id=scan.frame_id,
    )


# -- a gap of 0.6 m ----------------------------------------------------------------------------------------------------


def fits_through() -> Sequence[Case]:
    """Return the cases for a wall 1 m ahead, with or without a gap of at least 0.6 m."""
    widths = {
        say("a gap of 0.9 m"): (0.9, 0.0),
        say("a gap of 0.4 m"): (0.4, 0.0),
        say("a gap of 0.75 m, to the right"): (0.75, -0.4),
        say("a gap of 0.5 m, to the left"): (0.5, 0.5),
        say("a gap of 0.62 m, to the left"): (0.62, 0.4),
        say("a gap of 0.62 m, to the right"): (0.62, -0.4),
        say("a gap of 0.57 m, to the left"): (0.57, 0.4),
        say("a gap of 0.57 m, to the right"): (0.57, -0.4),
        say("no gap"): (0.0, 0.0),
    }
    return [_gap(title, *gap) for title, gap in widths.items()]


def _gap(title: str, width: float, centre: float) -> Case:
    right, left = centre - width / 2, centre + width / 2
    posts = [(1.0, -2.0, 1.0, right), (1.0, left, 1.0, 2.0)] if width else [(1.0, -2.0, 1.0, 2.0)]
    scan = Robot(World([*posts, (3.0, -4.0, 3.0, 4.0)]), seed=7).scan()

    def judge(answer: Answer) -> None:
        if yes_or_no(call(answer, scan)) != (width >= 0.6):
            raise WrongError(
                "you returned True, and the robot would get stuck. How far apart are the readings on both sides of the "
                "gap?"
                if width < 0.6
                else "you returned False, and the robot would fit. How far apart are the readings on both sides of the "
                "gap?"
            )

    return Case(title, scan, judge)


# -- stop at 0.4 m -----------------------------------------------------------------------------------------------------


def stop_at_wall() -> Sequence[Case]:
    """Return the cases for the speed forward that stops the robot 0.4 m before the wall ahead."""
    ahead = (2.5, -3.0, 2.5, 3.0)
    beside, other = (0.5, 0.26, 2.5, 0.26), (0.5, -0.26, 2.5, -0.26)
    covered = Robot(World([ahead]), seed=8).scan()
    covered = replace(covered, ranges=np.full(len(covered), nan, np.float32))

    def blind(answer: Answer) -> None:
        speed = number(call(answer, covered), say("speed forward in m/s"))
        if speed != 0:
            raise WrongError(
                "you returned {speed:.4g} m/s, and the robot drives blind. Drive while the distance is greater than a "
                "limit: no comparison with NaN is true",
                speed=speed,
            )

    left, right = (1.5, 0.05, 0.02), (1.5, -0.05, 0.02)  # no single ray sees both
    return [
        _stop(say("a wall ahead"), World([ahead]), ahead[0]),
        _stop(say("a wall ahead and one close on the left"), World([ahead, beside]), ahead[0]),
        _stop(say("a wall ahead and one close on the right"), World([ahead, other]), ahead[0]),
        _stop(say("a chair leg ahead, to the left"), World([ahead], [left]), left[0] - left[2]),
        _stop(say("a chair leg ahead, to the right"), World([ahead], [right]), right[0] - right[2]),
        Case(say("a covered scanner, which sends only NaN"), covered, blind),
    ]


def _drive(robot: Robot, answer: Answer) -> None:
    speed = number(call(answer, robot.scan()), say("speed forward in m/s"))
    if not isfinite(speed):
        raise WrongError(
            "at {seconds:.1f} s it returned {speed:g} m/s: a distance is inf if nothing is in range, and nan if it is "
            "unknown. Return a limited speed for inf, and 0 for nan",
            seconds=robot.time,
            speed=speed,
        )
    robot.drive(speed, 0.0)
    robot.step(_STEP_S)


def _stop(title: str, world: World, ahead: float) -> Case:
    def judge(answer: Answer) -> None:
        robot = Robot(world, motors=MOTORS, seed=9)
        start = robot.pose
        while robot.time < 25:
            _drive(robot, answer)
            if touches(robot):
                why = why_hit(robot, say("slow down earlier"))
                raise WrongError("it hit what is ahead at {seconds:.1f} s: {why}", seconds=robot.time, why=why)
        check_rest(robot, start, ahead, 0.35, 0.45)

    return Case(title, Robot(world, seed=9).scan(), judge)


# -- bumper reflex -----------------------------------------------------------------------------------------------------


def bumper_reflex() -> Sequence[Case]:
    """Return the cases for speed and turn: forward if nothing is touched, back from a touch, 0 if it is unknown."""

    def free(linear: float, turn: float) -> str:
        return "" if linear > 0 and turn == 0 else say("nothing is touched: drive forward, and do not turn")

    def left(linear: float, turn: float) -> str:
        return "" if linear < 0 and turn < 0 else say("back up and turn right: the turn is below 0 (clockwise)")

    def right(linear: float, turn: float) -> str:
        return "" if linear < 0 and turn > 0 else say("back up and turn left: the turn is above 0 (counter-clockwise)")

    def centre(linear: float, _turn: float) -> str:
        return "" if linear < 0 else say("back up: the speed forward is below 0")

    def unknown(linear: float, turn: float) -> str:
        return (
            ""
            if linear == turn == 0
            else say("None means unknown, not released: stand still until the bumper is known")
        )

    return [
        _reflex(say("nothing touched"), (False, False, False), free),
        _reflex(say("the left one touched"), (True, False, False), left),
        _reflex(say("the right one touched"), (False, False, True), right),
        _reflex(say("the center one touched"), (False, True, False), centre),
        _reflex(say("the left and the right one touched"), (True, False, True), centre),
        _reflex(say("the left one unknown"), (None, False, False), unknown),
        _reflex(say("the center one unknown"), (False, None, False), unknown),
        _reflex(say("the right one unknown"), (False, False, None), unknown),
        _reflex(say("the left one unknown, the right one touched"), (None, False, True), unknown),
        _reflex(say("the right one unknown, the left one touched"), (True, False, None), unknown),
        _reflex(say("all unknown"), (None, None, None), unknown),
    ]


def _reflex(title: str, states: tuple[bool | None, ...], rule: Callable[[float, float], str]) -> Case:
    sensors = ("left", "center", "right")
    touch = Touch(dict(zip(sensors, states, strict=True)), TouchMode.LEVEL, sensors)

    def judge(answer: Answer) -> None:
        linear, turn = pair(call(answer, touch), say("speed forward and turn"))
        wrong = _no_speed(linear, turn) or rule(linear, turn)
        if wrong:
            raise WrongError(
                "you returned {linear:g} m/s and {turn:g} rad/s; {wrong}", linear=linear, turn=turn, wrong=wrong
            )

    return Case(title, touch, judge)


def _no_speed(linear: float, turn: float) -> str:
    """Return why these speeds are implausible for a robot of this size, or an empty text."""
    if not (isfinite(linear) and isfinite(turn)):
        return say("a speed is a finite number")
    if abs(turn) > _FASTEST_TURN:
        return say(
            "{turn:g} rad/s are {turns:.1f} turns per second. Is this number in degrees? math.radians({turn:g}) is "
            "{radians:.2f}",
            turn=turn,
            turns=abs(turn) / (2 * pi),
            radians=radians(turn),
        )
    if abs(linear) > _FASTEST:
        return say(
            "{linear:g} m/s are {fast:.0f} km/h. Is this number in centimetres? The speed is in m/s",
            linear=linear,
            fast=abs(linear) * 3.6,
        )
    return ""


# -- slow in a doorway -------------------------------------------------------------------------------------------------


def slow_in_doorway() -> Sequence[Case]:
    """Return the cases for the speed forward: 0.5 m/s in the open, 0.2 m/s between things on both sides."""
    room = [(-4.0, 2.0, 4.0, 2.0), (-4.0, -2.0, 4.0, -2.0)]
    # Two faces of a wall, and its ends: a wall without thickness is invisible from the doorway.
    faces = [(x, side * 0.5, x, side * 2.0) for x in (-0.05, 0.05) for side in (-1, 1)]
    door = [*faces, (-0.05, -0.5, 0.05, -0.5), (-0.05, 0.5, 0.05, 0.5)]
    left, right = (-4.0, 0.4, 4.0, 0.4), (-4.0, -0.4, 4.0, -0.4)
    return [
        _doorway(say("through a door"), World([*room, *door]), has_door=True),
        _doorway(say("along a wall on the left"), World([*room, left]), has_door=False),
        _doorway(say("along a wall on the right"), World([*room, right]), has_door=False),
    ]


def _doorway(title: str, world: World, *, has_door: bool) -> Case:
    at_door = Robot(world, (0.0, 0.0, 0.0), seed=10).scan()

    def judge(answer: Answer) -> None:
        robot = Robot(world, (-3.0, 0.0, 0.0), motors=MOTORS, seed=10)
        slowest_inside, fastest_inside, slowest_outside = (inf, 0), (0.0, 0), (inf, 0)
        """Each with the number of its call."""
        while robot.pose.x < 2.5:
            if robot.time > 40:
                way = robot.pose.x + 3
                raise WrongError("after 40 s it has come only {way:.1f} m of 5.5 m: drive on", way=way)
            _drive(robot, answer)
            x, reading = robot.pose.x, (robot.speed().linear[0], round(robot.time / _STEP_S))
            if has_door and abs(x) < 0.05:
                slowest_inside, fastest_inside = min(slowest_inside, reading), max(fastest_inside, reading)
            if (abs(x) > 1.0 or not has_door) and robot.time > 1.0:
                slowest_outside = min(slowest_outside, reading)
        speed, step = slowest_inside if slowest_inside[0] < 0.2 - _SPEED_OFF else fastest_inside
        if step and abs(speed - 0.2) > _SPEED_OFF:
            raise WrongError(
                "it drives through the door at {speed:.2f} m/s: the task asks for 0.2 m/s", speed=speed, step=step
            )
        speed, step = slowest_outside
        if speed < 0.5 - 2 * _SPEED_OFF:
            raise WrongError(
                "in the open it drives at {speed:.2f} m/s: the task asks for 0.5 m/s"
                if has_door
                else "next to a single wall it drives at {speed:.2f} m/s: the task asks for 0.5 m/s",
                speed=speed,
                step=step,
            )

    return Case(title, at_door, judge)

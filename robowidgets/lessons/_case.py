"""The cases of a task."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import degrees, isinf, isnan, sin
from typing import Any, NamedTuple

import numpy as np

from ..driving.command_watchdog import MAX_ANGULAR, MAX_LINEAR
from ..samples import Pose, Scan
from ..samples.sector import SectorLike, to_sector
from ..simulator import Motors, Robot
from ._bounded import WrongError, beyond, call, number
from ._texts import say

Answer = Callable[..., Any]

MOTORS = Motors(max_linear=MAX_LINEAR, max_angular=MAX_ANGULAR)
"""The motors of the robots that answers drive. They limit the speed as a live robot does."""

_EXACT_M = 0.02
_SAME_M = 0.001
"""Metres within which a distance counts as the distance of a ray."""
_EDGE_RAD = 0.001
"""Radians from the edge of a sector within which a ray may count or not."""
_BESIDE_M = 0.1
"""Metres beyond the required distance within which a robot may have stopped for something next to its path."""


class Case(NamedTuple):
    """One case of a task: its title, a sample to look at, and a judge that raises `WrongError` for a wrong answer."""

    title: str
    sample: Any
    judge: Callable[[Answer], None]


def nearest_in(sector: SectorLike, title: str, scan: Scan, hint: str) -> Case:
    """Return a case that expects the distance of the nearest thing in a sector, in metres.

    Args:
        sector: the sector.
        title: the title of the case.
        scan: the sample of the case.
        hint: advice for an answer that used another ray.
    """
    expected, ray = scan.distance(sector), scan.nearest(sector)
    right = _with_and_without_edges(scan, sector)

    def judge(answer: Answer) -> None:
        given = number(call(answer, scan), say("distance in metres"))
        if not any(given == one or abs(given - one) <= _EXACT_M for one in right):
            origin, advice = _origin(given, scan, sector, hint)
            if ray is None:
                raise WrongError(
                    "you returned {given:.4g}; nothing is in range, so the distance is inf{origin}",
                    given=given,
                    origin=origin,
                    advice=advice,
                )
            raise WrongError(
                "you returned {given:.4g}; it is {expected:.2f} m, at ranges[{index}]{origin}",
                given=given,
                expected=expected,
                index=ray.index,
                origin=origin,
                advice=advice,
            )

    return Case(title, scan, judge)


def _with_and_without_edges(scan: Scan, sector: SectorLike) -> set[float]:
    """Return the nearest distances in a sector with and without the rays on its edges, which depend on rounding."""
    between = to_sector(sector)
    return {
        scan.distance((between.start + start, between.end + end))
        for start, end in product((-_EDGE_RAD, 0.0, _EDGE_RAD), repeat=2)
    }


def _origin(given: float, scan: Scan, sector: SectorLike, hint: str) -> tuple[str, str]:
    """Return the likely source of a wrong distance in the scan, and advice."""
    if isnan(given):
        return "", hint if scan.nearest(sector) is None else say("nan is not a distance: scan.distance() ignores it")
    if isinf(given):
        return "", say("inf means that nothing is in range")
    found = np.flatnonzero(np.abs(scan.ranges - np.float32(given)) <= _SAME_M)
    if not found.size:
        is_mm = (np.abs(scan.ranges - np.float32(given / 1000)) <= _SAME_M).any()
        asked = say("Is it in millimetres? The answer is in metres") if is_mm else say("Is it computed from the scan?")
        return say(". No ray has the range {given:.4g}", given=given), asked
    inside = np.intersect1d(found, scan.indices(sector))
    index = int(inside[0] if inside.size else found[0])
    angle = round(degrees(scan[index].angle))  # a whole number: -0.2 would be shown as -0
    return say(". That is ranges[{index}], at {angle:.0f}°", index=index, angle=angle), hint


def touches(robot: Robot) -> bool:
    """Return True if any bumper of a robot is touched."""
    return any(robot.touch().touched.values())


def why_hit(robot: Robot, else_: str) -> str:
    """Return why a robot hit an obstacle: the ray straight ahead missed it, or the given other reason."""
    scan = robot.scan()
    ahead, near = scan.at(0.0), scan.nearest(("-90deg", "90deg"))
    if ahead and near and ahead.range > near.range + 0.3:
        return say(
            "it is at {angle:.0f}°, and the ray straight ahead misses it: one ray is not enough, take a sector as wide "
            "as the robot",
            angle=degrees(near.angle),
        )
    return else_


def check_rest(robot: Robot, start: Pose, ahead: float, low: float, high: float) -> None:
    """Raise `WrongError` unless a robot stands between two distances from an obstacle ahead, at an x in metres."""
    left, speed = ahead - robot.pose.x, robot.speed().linear[0]
    if robot.pose == start:
        raise WrongError(
            "it did not move in {seconds:.0f} s: return a speed above 0 while there is room ahead", seconds=robot.time
        )
    if abs(speed) > 0.02:
        shown = beyond(speed, -0.02, 0.02)
        raise WrongError(
            "after {seconds:.0f} s it still drives at {speed} m/s, {left:.2f} m from what is ahead",
            seconds=robot.time,
            speed=shown,
            left=left,
        )
    if not low <= left <= high:
        why = say("it needs a few centimetres to stop, so stop earlier")
        if left > high:
            near = robot.scan().nearest("front")
            why = say("drive closer")
            if near is not None and near.range <= high + _BESIDE_M and abs(sin(near.angle)) * near.range > robot.radius:
                why = say(
                    "drive closer; or, if it stopped for something at {angle:.0f}°, next to its path, take a narrower "
                    "sector",
                    angle=degrees(near.angle),
                )
        shown = beyond(left, low, high)
        raise WrongError(
            "it stands {left} m from what is ahead, not {low:g} to {high:g} m: {why}",
            left=shown,
            low=low,
            high=high,
            why=why,
        )

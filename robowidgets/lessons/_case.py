"""The cases of a task."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from ..samples import Scan
from ..samples.sector import Asked
from ..simulator import Robot
from ._bounded import WrongError, call, number

Answer = Callable[..., Any]

_EXACT_M = 0.02


class Case(NamedTuple):
    """One case of a task: its title, a sample to look at, and what raises `WrongError` for a wrong answer."""

    title: str
    sample: Any
    judge: Callable[[Answer], None]


def nearest_in(sector: Asked, title: str, scan: Scan, hint: str = "") -> Case:
    """Whether an answer is the distance of the nearest thing in a sector, in metres."""
    expected, ray = scan.distance(sector), scan.nearest(sector)

    def judge(answer: Answer) -> None:
        given = number(call(answer, scan), "distance in metres")
        if given != expected and not abs(given - expected) <= _EXACT_M:
            what = f"it is {expected:.2f} m, at ranges[{ray.index}]" if ray else "nothing is met there, which is inf"
            raise WrongError(f"you returned {given:.4g}; {what}{hint}")

    return Case(title, scan, judge)


def touches(robot: Robot) -> bool:
    """Whether any bumper of a robot is touched."""
    return any(robot.touch().touched.values())

"""Wall followers with one wrong line each: the lines show it, and with this line mended the robot follows the wall."""

from __future__ import annotations

import itertools
import linecache
from collections.abc import Callable
from math import hypot
from typing import Any, NamedTuple

import pytest

from robowidgets.behaviors import Drive
from robowidgets.behaviors.lines.shown import LineValues, lines_of
from robowidgets.behaviors.lines.watch import LineWatch
from robowidgets.behaviors.simulation import ProgramRun
from robowidgets.simulator import Robot, World

ROOM = """
    ################
    #..............#
    #..............#
    #..............#
    #..............#
    #>.............#
    #..............#
    ################
"""
RIGHT = """\
def follow(scan):
    front = scan.distance("front")
    right = scan.distance(("-100deg", "-80deg"))
    if front < 0.8:
        return Drive(0, 0.8)
    error = 0.6 - right
    turn = max(-0.6, min(0.6, 1.5 * error))
    return Drive(0.3, turn)
"""
FRONT, SIDE, IS_NEAR, TURN_AWAY, ERROR, TURN, GO_ON = range(1, 8)
"""The lines by number, the line of `def` being 0."""
RATE = 10
NUMBERS = itertools.count()

Step = dict[int, LineValues]


class Run(NamedTuple):
    """One run: the values of each step, by line, and the way of the robot."""

    steps: list[Step]
    driven: float
    has_touched: bool
    to_wall: list[float]

    @property
    def follows(self) -> bool:
        """True if the robot drove along the wall, without touching it, from the sixth second on."""
        along = self.to_wall[6 * RATE :]
        return self.driven > 8 and not self.has_touched and min(along) > 0.4 and max(along) < 1.0


def function_of(text: str) -> Callable[..., Any]:
    file = f"<follower {next(NUMBERS)}>"
    linecache.cache[file] = len(text), None, text.splitlines(keepends=True), file
    namespace: dict[str, Any] = {"Drive": Drive}
    exec(compile(text, file, "exec", dont_inherit=True), namespace)
    made: Callable[..., Any] = namespace["follow"]
    return made


def drive(text: str, seconds: int = 40) -> Run:
    """Drive a simulated robot by a program, and keep what its lines show."""
    robot, run = Robot(World.from_text(ROOM, cell=0.5), seed=1), ProgramRun(function_of(text))
    run.lines = LineWatch()
    watched = run.lines.add_view()
    steps, to_wall, driven, has_touched = list[Step](), list[float](), 0.0, False
    for i in range(seconds * RATE):
        scan, before = robot.scan(), robot.pose
        command = run.step(i / RATE, {"scan": lambda scan=scan: scan})  # type: ignore[misc]
        (call,) = watched.popleft().calls
        steps.append({line.number: line for line in lines_of(call)})
        robot.drive(command.linear, command.angular)
        robot.step(1 / RATE)
        driven += hypot(robot.pose.x - before.x, robot.pose.y - before.y)
        has_touched |= any(robot.touch().touched.values())
        to_wall.append(scan.distance(("-100deg", "-80deg")))
    return Run(steps, driven, has_touched, to_wall)


def level(step: Step, line: int) -> float:
    found = step[line].level
    assert found is not None
    return found


def turns_from_a_far_wall(steps: list[Step]) -> bool:
    """The wall on the right is farther than wanted, and yet the robot turns to its left."""
    return any(TURN in step and level(step, SIDE) > 0.65 and level(step, TURN) > 0 for step in steps)


def reads_rays_on_the_left(steps: list[Step]) -> bool:
    """The lit rays are those after the middle of the scan, which is ahead."""
    ahead = 270
    return all(first > ahead for rays in steps[0][SIDE].rays for first, _ in [rays.runs])


def goes_on_never(steps: list[Step]) -> bool:
    """The test is true in each step, also at several metres, and the last line is not reached."""
    return all(step[IS_NEAR].value == "True" and GO_ON not in step for step in steps)


def turns_away_never(steps: list[Step]) -> bool:
    """The wall ahead is near, and the test is false."""
    is_near = [step for step in steps if level(step, FRONT) < 0.7]
    return bool(is_near) and all(step[IS_NEAR].value == "False" for step in is_near)


def turns_always_the_same(steps: list[Step]) -> bool:
    """The error changes, and the turn that is computed from it does not."""
    pairs = [(step[ERROR].value, step[TURN].value) for step in steps if TURN in step]
    return len({error for error, _ in pairs}) > 5 and len({turn for _, turn in pairs}) == 1


FAULTS = {
    "a wrong sign": (ERROR, "error = right - 0.6", turns_from_a_far_wall),
    "the wrong side": (SIDE, 'right = scan.distance(("80deg", "100deg"))', reads_rays_on_the_left),
    "centimetres": (IS_NEAR, "if front < 80:", goes_on_never),
    "equality of numbers": (IS_NEAR, "if front == 0.8:", turns_away_never),
    "limits in the wrong order": (TURN, "turn = max(0.6, min(-0.6, 1.5 * error))", turns_always_the_same),
}


@pytest.fixture(scope="module")
def right() -> Run:
    return drive(RIGHT)


@pytest.mark.parametrize("fault", FAULTS)
def test_the_lines_show_the_fault_of_a_wall_follower(fault: str, right: Run) -> None:
    line, wrong, is_seen = FAULTS[fault]
    texts = RIGHT.split("\n")
    texts[line] = "    " + wrong
    run = drive("\n".join(texts))
    assert not run.follows
    assert is_seen(run.steps)
    assert right.follows, "the same program with this line mended"
    assert not is_seen(right.steps)

"""The machines of the notebook of nine state machines, each on the simulated robot."""

from __future__ import annotations

import json
from itertools import pairwise
from math import hypot, pi
from pathlib import Path
from typing import Any

import pytest

from robowidgets.behaviors import Drive, Variables, simulate
from robowidgets.behaviors.simulation import Step
from robowidgets.simulator import Robot, World

NOTEBOOK = Path(__file__).parents[3] / "notebooks" / "nine_state_machines.ipynb"
HALL = [(-3.0, -3.0, 3.0, -3.0), (3.0, -3.0, 3.0, 3.0), (3.0, 3.0, -3.0, 3.0), (-3.0, 3.0, -3.0, -3.0)]


@pytest.fixture(scope="module")
def programs() -> dict[str, Any]:
    """The names of the cells that define classes."""
    names: dict[str, Any] = {"__name__": __name__, "Drive": Drive}
    for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        if source.startswith("class "):
            exec(source.partition("\nrobot.program(")[0], names)
    return names


def changes(steps: list[Step]) -> list[tuple[float, str]]:
    """The times at which the innermost active state changed, and the new states."""
    found: list[tuple[float, str]] = []
    for step in steps:
        if not found or found[-1][1] != step.active[-1]:
            found.append((round(step.time, 1), step.active[-1]))
    return found


def hall(*pose: float, obstacles: Any = ()) -> Robot:
    return Robot(World(HALL, obstacles), pose or (0.0, 0.0, 0.0), seed=1)


def test_escapement(programs: dict[str, Any]) -> None:
    steps = list(simulate(programs["Escapement"], hall(), 1.8))
    assert changes(steps) == [(0.0, "tick"), (0.5, "tock"), (1.0, "tick"), (1.5, "tock")]


def test_stopwatch(programs: dict[str, Any]) -> None:
    variables = Variables()
    variables.start = variables.reset = False
    active = []
    for step in simulate(programs["Stopwatch"], hall(), 6.0, variables=variables):
        variables.start = 1.0 <= step.time < 4.95
        variables.reset = variables.reset or abs(step.time - 3.0) < 0.01
        active.append((round(step.time, 1), step.active[-1]))
    by_time = dict(active)
    assert (by_time[0.9], by_time[1.2], by_time[1.7]) == ("waiting", "tick", "tock")
    assert variables.reset is False
    assert by_time[5.5] == "waiting"


def test_nested(programs: dict[str, Any]) -> None:
    inner = [name for _, name in changes(list(simulate(programs["Nested"], hall(), 3.0, rate=20)))]
    assert inner == ["r1.n1.n1n2", "r1.n1.rest", "r1.n2.n2n3", "r1.n2.rest", "r1.n3", "r2", "r1.n1.n1n2", "r1.n1.rest"]


def test_concurrency(programs: dict[str, Any]) -> None:
    steps = list(simulate(programs["Concurrency"], hall(), 6.0))
    assert {step.active for step in steps} >= {("m.s", "n.a"), ("m.t", "n.a"), ("m.t", "n.b"), ("m.s", "n.b")}


def test_simple_avoid(programs: dict[str, Any]) -> None:
    variables = Variables()
    variables.stop = False
    robot = hall()
    names = []
    for step in simulate(programs["SimpleAvoid"], robot, 40.0, rate=20, variables=variables):
        names.append(step.active[-1])
        assert robot.world.clearance(*robot.pose[:2]) > robot.radius
        variables.stop = step.time > 30
    assert {"forward", "avoid.turn"} <= set(names)
    assert names[-1] == "stop"
    assert robot.speed().linear[0] == 0.0


def test_bump_and_turn(programs: dict[str, Any]) -> None:
    robot = hall(1.5, 0.0, 0.0, obstacles=[(2.3, 0.16, 0.2)])
    found = [name for _, name in changes(list(simulate(programs["BumpAndTurn"], robot, 8.0, rate=20)))]
    assert found[:4] == ["forward", "avoid.backward", "avoid.decide", "avoid.turn_right"]
    assert found[4:6] == ["avoid.finish", "forward"]


def test_maze(programs: dict[str, Any]) -> None:
    robot = hall(0.0, -2.2, -0.5)
    steps = list(simulate(programs["Maze"], robot, 20.0, rate=20))
    assert [name for _, name in changes(steps)][:5] == [
        "forward",
        "back",
        "avoid.turn_right",
        "avoid.ready",
        "forward",
    ]


def test_square(programs: dict[str, Any]) -> None:
    variables = Variables()
    variables.stop = False
    robot, corners, last = hall(), [], ""
    for step in simulate(programs["Square"], robot, 43.0, rate=50, variables=variables):
        if step.active[-1] == "turn" and last == "forward":
            corners.append(robot.pose)
        last = step.active[-1]
    assert len(corners) >= 4
    for before, after in pairwise(corners):
        assert hypot(after.x - before.x, after.y - before.y) == pytest.approx(0.5, abs=0.05)
        assert (after.yaw - before.yaw) % (2 * pi) == pytest.approx(pi / 2, abs=0.1)


def test_follower(programs: dict[str, Any]) -> None:
    robot = hall(0.0, 0.0, 0.3, obstacles=[(1.6, 0.0, 0.2)])
    steps = list(simulate(programs["Follower"], robot, 15.0))
    assert steps[-1].active == ("follow",)
    assert robot.scan().distance("front") == pytest.approx(0.6, abs=0.08)
    away = list(simulate(programs["Follower"], Robot(World(), seed=1), 2.0))
    assert away[-1].active == ("idle",)

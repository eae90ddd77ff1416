"""The program from the page on programs that drives sideways to a door, on the simulated PR2."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from robowidgets import feeds
from robowidgets.behaviors import simulate
from robowidgets.simulator import Robot, Scanner, World

from ..waiting import wait_for

PAGE = (Path(__file__).parents[3] / "docs" / "programs.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def names() -> dict[str, Any]:
    """The names in the block that defines the program, and its rooms."""
    (block,) = re.findall(r"^```python\n([^`]*?^class Door.*?)^pr2 = ", PAGE, re.MULTILINE | re.DOTALL)
    found: dict[str, Any] = {"__name__": __name__}
    exec(f"from robowidgets.behaviors import Drive\n{block}", found)
    return found


def through(door: Any, robot: Robot) -> list[str]:
    """Drive, and return its states in order; fail if it touches a wall."""
    states: list[str] = []
    for step in simulate(door, robot, 120.0, until=lambda: states[-1:] == ["beyond"] and not any(robot.speed().values)):
        assert robot.world.clearance(*robot.pose[:2]) > robot.radius, "it touches a wall"
        if step.active[-1:] != tuple(states[-1:]):
            states.append(step.active[-1])
    return states


def test_it_goes_sideways_until_the_door_is_ahead_and_through_it(names: dict[str, Any]) -> None:
    robot = Robot(names["rooms"], model="pr2", seed=1)
    y = robot.pose.y
    assert through(names["Door"], robot) == ["left", "through", "beyond"]
    assert robot.pose.x > 4.5
    assert robot.pose.y > y + 1
    assert robot.pose.yaw == 0.0


def test_where_the_door_is_on_the_other_side_it_turns_back_at_the_wall(names: dict[str, Any]) -> None:
    robot = Robot(names["rooms"], (1.75, 3.2, 0.0), model="pr2", seed=2)
    assert through(names["Door"], robot) == ["left", "right", "through", "beyond"]


def test_it_goes_nowhere_on_the_word_of_a_covered_scanner(names: dict[str, Any]) -> None:
    robot = Robot(World(), model="pr2", scanner=Scanner(dropout=1.0), seed=3)
    assert {step.active for step in simulate(names["Door"], robot, 3.0)} == {("left",)}


def test_on_a_feed_the_pr2_runs_it_and_a_robot_with_two_wheels_says_why_it_stands(names: dict[str, Any]) -> None:
    with feeds.simulator("pr2", room=names["rooms"], wander=False) as feed:
        feed.program(names["Door"])
        wait_for(lambda: feed.robot.speed().linear[1] > 0.1, "it slides to the left")
    with feeds.simulator("turtlebot3", room=names["rooms"], wander=False) as feed:
        door = feed.program(names["Door"])
        refused = "cannot drive: lateral is 0.15 m/s, but this robot is not known to move sideways"
        wait_for(lambda: refused in door.waiting, "it says why")
        assert not any(feed.robot.speed().values)

"""Drops: a robot with a wheel over the edge stands, and sensors that look at the floor report it."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from robowidgets import feeds
from robowidgets.messages import to_touch
from robowidgets.simulator import Robot, View, World, wander

from ..waiting import wait_for

LANDING = """
    ############
    #..........#
    #.>.....===#
    #.......===#
    #..........#
    ############
"""


def test_drops_of_a_text_are_rectangles_next_to_which_a_robot_starts() -> None:
    world = World.from_text(LANDING, cell=1.0)
    assert world.drops.tolist() == [[8.0, 2.0, 11.0, 4.0]]
    assert world.walls.tolist() == World.from_text(LANDING.replace("=", "."), cell=1.0).walls.tolist()
    assert [world.has_drop(x, 3.0) for x in (7.9, 8.1, 10.9, 11.1)] == [False, True, True, False]
    split = World.from_text("==.\n===\n.==", cell=1.0).drops.tolist()
    assert sorted(split) == [[0, 1, 3, 2], [0, 2, 2, 3], [1, 0, 3, 1]]
    free = World.from_text("#####\n#===#\n#===#\n#===#\n#.  #\n#####", cell=1.0)
    assert free.start == (2.5, 1.5, 0.0), "the middle of the floor has no floor"
    assert World(drops=[(2, 3, 1, -1)]).has_drop(1.5, 0.0), "in any order of the corners"


@pytest.mark.parametrize(("drops", "words"), [
    ([(0, 0, 1)], "drops: expected rows of (x1, y1, x2, y2) in metres"),
    ([(0, 0, 1, 0)], "drops[0]: expected two opposite corners, got [0.0, 0.0, 1.0, 0.0]"),
])  # fmt: skip
def test_words_for_drops_that_cannot_be(drops: Any, words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        World(drops=drops)


def test_a_robot_stands_over_the_edge_until_it_is_put_elsewhere() -> None:
    robot = Robot(World.from_text(LANDING))
    scan = Robot(World.from_text(LANDING.replace("=", "."))).scan()
    assert robot.scan().ranges.tobytes() == scan.ranges.tobytes(), "a scanner does not see it"
    robot.drive(0.5, 0.0)
    robot.run(until=lambda: robot.has_fallen, limit=20)
    place = robot.pose
    assert 4.0 <= place.x < 4.01, "its middle is over the edge"
    for angular in (0.0, 1.0):
        robot.drive(-0.5, angular)
        robot.step(1.0)
    assert (robot.pose, robot.speed().linear[0]) == (place, 0.0)
    robot.world = robot.world.with_obstacles([(1.0, 1.0, 0.1)])
    assert robot.has_fallen
    with pytest.raises(ValueError, match=r"pose: expected floor below the robot and its wheels, got \(4.5, 1.5\)"):
        robot.move_to(4.5, 1.5, 0.0)
    with pytest.raises(ValueError, match="expected floor below"):
        Robot(robot.world, (3.9, 1.5, 1.57))  # with its right wheel over the edge
    robot.move_to(2.0, 1.5, 0.0)
    robot.step(1.0)
    assert not robot.has_fallen
    assert robot.pose.x < 2.0


@pytest.mark.parametrize(("name", "place", "sensor"), [
    ("kobuki", (0.087, 0.136), "cliff left"), ("kobuki", (0.156, 0), "cliff center"),
    ("kobuki", (0.087, -0.136), "cliff right"), ("create3", (0.06, 0.145), "cliff side left"),
    ("create3", (0.16, 0.045), "cliff front left"), ("create3", (0.16, -0.045), "cliff front right"),
    ("create3", (0.06, -0.145), "cliff side right"), ("kobuki", (0, 0.115), "wheel left"),
    ("kobuki", (0, -0.115), "wheel right"), ("create3", (0, 0.1165), "wheel left"),
    ("create3", (0, -0.1165), "wheel right"),
])  # fmt: skip
def test_a_drop_below_a_sensor_is_reported_in_the_messages_of_the_robot(
    name: str, place: tuple[float, float], sensor: str
) -> None:
    robot = Robot(World(), model=name)
    x, y = place
    robot.world = World(drops=[(x - 0.01, y - 0.01, x + 0.01, y + 0.01)])
    for touch in (robot.touch(), to_touch(robot.model.to_message(robot.touch()))):
        assert [name for name, state in touch.touched.items() if state] == [sensor]
    assert robot.has_fallen == sensor.startswith("wheel")


@pytest.mark.parametrize("model", ["kobuki", "create3"])
def test_a_robot_with_cliff_sensors_wanders_without_falling(model: str) -> None:
    robot = Robot(World.from_text(LANDING), model=model)
    edges = []
    for _ in wander(robot):
        robot.step(0.1)
        edges.append(any(state for name, state in robot.touch().touched.items() if "cliff" in name))
        if robot.time > 80:
            break
    assert sum(np.diff(edges)) > 3, "it came to the edge more than once"
    assert not robot.has_fallen


def test_the_view_shows_drops_and_says_that_the_robot_has_fallen() -> None:
    robot = Robot(World.from_text(LANDING))
    view = View(robot)
    assert np.frombuffer(view.get_state()["_drops"], "<f4").tolist() == [4.0, 1.0, 5.5, 2.0]
    assert view.get_state()["_status"] == ""
    robot.drive(1.0, 0.0)
    robot.run(5)
    assert view.get_state()["_status"] == "the robot is over an edge: drag it back"


@pytest.mark.slow
def test_in_a_process_of_its_own_a_fallen_robot_can_be_put_back_and_given_obstacles() -> None:
    with feeds.simulator(room=World.from_text(LANDING), process=True, wander=False, hz=20) as feed:
        robot = feed.robot
        wait_for(lambda: robot.time > 0, "it runs")
        robot.world = World(drops=[(robot.pose.x - 1, 0, robot.pose.x + 1, 9)])
        time = robot.time + 0.5
        wait_for(lambda: robot.time > time, "it goes on")
        robot.world = world = robot.world.with_obstacles([(9.0, 9.0, 0.2)])
        time = robot.time + 0.5
        wait_for(lambda: robot.time > time, "it goes on")
        assert robot.has_fallen
        assert robot.world is world, "the other process has accepted it"
        robot.move_to(9.0, 1.0, 0.0)
        wait_for(lambda: robot.time > time + 0.5, "it goes on")
        assert not robot.has_fallen

"""A simulated robot at full speed, and its odometry."""

from __future__ import annotations

import time
from math import hypot

import pytest

from robowidgets.behaviors import Drive, simulate
from robowidgets.simulator import Robot, Scanner, World, room, wander


def test_it_runs_to_a_time_to_the_nanosecond() -> None:
    robot = Robot(World())
    robot.drive(0.5, 0.0)
    robot.run(until=1.25)
    assert robot.time == 1.25
    robot.run(until=1.0)
    assert robot.time == 1.25


def test_it_runs_until_something_is_true() -> None:
    robot = Robot(World([(1.0, -2.0, 1.0, 2.0)]))
    robot.run(until=lambda: robot.touch().touched["center"], behavior=wander(robot))
    assert robot.pose.x == pytest.approx(1.0 - robot.radius, abs=0.01)
    with pytest.raises(TimeoutError, match=r"run: until was not true within 2 s of simulated time"):
        robot.run(until=lambda: False, limit=2.0)
    assert robot.time < 10
    with pytest.raises(TypeError, match="until: expected a number, got 'noon'"):
        robot.run(until="noon")  # type: ignore[arg-type]


def test_a_program_is_simulated_until_something_is_true() -> None:
    robot = Robot(room("corridor"))
    steps = list(simulate(lambda: Drive(0.3), robot, 60.0, until=lambda: robot.pose.x > 2))
    assert 2 < robot.pose.x < 2.1
    assert len(steps) < 100


def test_it_is_many_times_faster_than_time() -> None:
    scanner = Scanner(ray_count=1040, field_of_view="260deg", rate=40.0, range_max=30.0)
    robot = Robot(room("house"), scanner=scanner)
    began = time.process_time()
    robot.run(until=lambda: robot.scan() is None or robot.time >= 5.0, behavior=wander(robot), period=0.025)
    # Measured: 65. Other work on the machine makes it slower.
    assert 5.0 / (time.process_time() - began) > 20


def test_odometry_drifts_from_the_true_pose_as_the_seed_decides() -> None:
    def off(seed: int) -> tuple[float, float, float]:
        robot = Robot(room("house"), seed=seed)
        assert robot.odometry == robot.pose
        robot.run(until=2.0, behavior=wander(robot))
        early = hypot(robot.odometry.x - robot.pose.x, robot.odometry.y - robot.pose.y)
        robot.run(until=60.0, behavior=wander(robot))
        late = hypot(robot.odometry.x - robot.pose.x, robot.odometry.y - robot.pose.y)
        return early, late, robot.odometry.yaw

    early, late, _ = off(1)
    assert 0 < early < 0.1
    assert 0.1 < late < 5
    assert off(1) == off(1) != off(2)


def test_odometry_of_a_robot_that_stands_stays() -> None:
    robot = Robot(World(), (1.0, 2.0, 0.5))
    robot.step(5.0)
    assert robot.odometry == robot.pose

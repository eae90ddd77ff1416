"""A simple behaviour: wander about and turn away from obstacles."""

from __future__ import annotations

from collections.abc import Iterator

from .robot import Robot


def wander(robot: Robot, linear: float = 0.5, angular: float = 1.2) -> Iterator[None]:
    """Drive forward; at a bump or an edge, stop, back up, turn away and drive on, forever.

    It commands speeds, then yields to its caller, which steps the robot.

    Args:
        robot: the robot to drive.
        linear: speed forward, m/s; in a world with drops limited to 0.3, so that the robot stops in time.
        angular: speed of a turn, rad/s.

    Examples:
        >>> from robowidgets.simulator import Robot, World
        >>> robot = Robot(World.rooms())
        >>> for _ in wander(robot):
        ...     robot.step(0.05)
        ...     if robot.time > 10:
        ...         break
    """
    linear = min(linear, 0.3) if len(robot.world.drops) else linear
    turn_time = 1.0
    while True:
        robot.drive(linear, 0.0)
        while not _is_blocked(robot):
            yield

        # The last word of a sensor's name is its side: "right", "front right", "cliff side right".
        sides = {name.split()[-1] for name, is_touched in robot.touch().touched.items() if is_touched}
        turn = angular if "right" in sides and "left" not in sides else -angular

        robot.drive(0.0, 0.0)
        yield from _wait(robot, 0.4)
        robot.drive(-linear / 2, 0.0)
        yield from _wait(robot, 1.0)
        robot.drive(0.0, turn)
        yield from _wait(robot, turn_time)
        turn_time = 0.8 + turn_time % 1.1  # turns of different lengths, so that it does not run in a circle


def _is_blocked(robot: Robot) -> bool:
    """Return True if a bumper is pressed, or if the scanner of a robot without bumpers sees a near thing."""
    touched = robot.touch().touched
    return any(touched.values()) if touched else robot.scan().distance("front") < robot.radius + 0.3


def _wait(robot: Robot, seconds: float) -> Iterator[None]:
    end = robot.time + seconds
    while robot.time < end:
        yield

"""What the simulated robot sends: the topics of each kind of sensor, whose row in the table of kinds names them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

from ..messages.standard import LASER_SCAN, ODOMETRY, RANGE
from ..messages.twist import TWIST
from .robot import Robot


class Offer(NamedTuple):
    """A topic of the simulated robot.

    Attributes:
        topic: its name.
        type: the type of its messages.
        read: returns the newest sample; the same object as before where there is no newer one.
        to_message: makes a message of the robot's model of it; None: the sample is sent.
        obeyed: whether the robot does what others send on it, which is not sent again then.
    """

    topic: str
    type: str
    read: Callable[[], Any]
    to_message: Callable[[Any], Any] | None = None
    obeyed: bool = False

    def message(self, sample: Any) -> Any:
        """What is sent of a sample."""
        return sample if self.to_message is None else self.to_message(sample)


MakeOffers = Callable[[Robot], Sequence[Offer]]
"""The topics of a robot with one kind of sensor. It is called in the process that simulates the robot, too."""


def scans(robot: Robot) -> list[Offer]:
    """The scans, at the rate of the scanner."""
    return [Offer("/scan", LASER_SCAN, robot.scan)]


def speeds(robot: Robot) -> list[Offer]:
    """Odometry, and the speed that is commanded."""
    return [Offer("/odom", ODOMETRY, robot.speed), Offer("/cmd_vel", TWIST, robot.command, obeyed=True)]


def touches(robot: Robot) -> list[Offer]:
    """The bumpers, as messages of the robot's model."""
    model = robot.model
    return [Offer("/bumper", model.touch_type, robot.touch, model.to_message)] if model.touch_type else []


def sonars(robot: Robot) -> list[Offer]:
    """Each sonar, when it is its turn."""
    return [Offer(f"/sonar/{name}", RANGE, partial(robot.sonar, name)) for name in robot.sonars.poses]

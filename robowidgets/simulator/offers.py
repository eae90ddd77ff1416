"""What the simulated robot sends: the topics of each kind of sensor, whose row in the table of kinds names them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from ..messages.standard import LASER_SCAN, ODOMETRY, TWIST
from .robot import Robot


class Offer(NamedTuple):
    """A topic of the simulated robot.

    Attributes:
        topic: its name.
        type: the type of its messages.
        read: returns what is to be sent now, a sample or a message; None: nothing new.
        obeyed: whether the robot does what others send on it, which is not sent again then.
    """

    topic: str
    type: str
    read: Callable[[], Any]
    obeyed: bool = False


MakeOffers = Callable[[Robot], Sequence[Offer]]
"""The topics of a robot with one kind of sensor. It is called in the process that simulates the robot."""


def scans(robot: Robot) -> list[Offer]:
    """The scans, each once."""
    last = None

    def read() -> Any:
        nonlocal last
        before, last = last, robot.scan()
        return None if last is before else last

    return [Offer("/scan", LASER_SCAN, read)]


def speeds(robot: Robot) -> list[Offer]:
    """Odometry, and the speed that is commanded."""
    return [Offer("/odom", ODOMETRY, robot.speed), Offer("/cmd_vel", TWIST, robot.command, obeyed=True)]


def touches(robot: Robot) -> list[Offer]:
    """The bumpers, as messages of the robot's model."""
    model = robot.model
    return [Offer("/bumper", model.touch_type, lambda: model.to_message(robot.touch()))] if model.touch_type else []

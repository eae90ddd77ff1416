"""The parts of a robot that a program needs. A feed provides them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from ..samples import Pose

GIVEN = ("time", "state", "variables")
"""The parameters that every program may have in addition to samples."""

ODOMETRY = POSE, DRIVEN, TURNED = "pose", "driven", "turned"
"""The parameters for odometry: the `Pose`, and the metres and radians since the program began."""


class NotReadyError(Exception):
    """A sample that a program asks for is missing or too old; the text says which."""


class Inputs(Protocol):
    """The newest samples that a program asks for."""

    def choose(self, wanted: Mapping[str, str | None], on: str | None) -> None:
        """Choose the topic of each parameter; None stands for the topic with that kind of sample.

        Samples that have already come stay. With ``on``, each message of that topic wakes the program.
        """

    def take(self) -> dict[str, Any]:
        """Return the newest samples, by parameter; NotReadyError if a sample is missing or too old to drive by."""

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics found for the chosen samples, and the topic whose messages wake the program."""

    def why_silent(self, on: str) -> str:
        """Return the reason why no message of the topic ``on`` comes."""

    def put_to(self, pose: Pose) -> None:
        """Do not count the movement to a pose to which odometry was set."""

    def close(self) -> None:
        """Take no more messages."""


@dataclass(frozen=True)
class DrivenRobot:
    """A robot, as a program sees it. Its functions do not block.

    Attributes:
        where: its name, for messages to the user.
        is_gone: returns True if nothing outside refers to the robot any more.
        is_stopped: returns True while stop is latched.
        listen: makes inputs that call a function on each message of the topic ``on``, in the transport's thread.
        drive: sends a speed in m/s forward, rad/s counter-clockwise and m/s to the left; returns why it was not sent,
            or an empty text if it was.
        halt: sends zero at once if a program drives.
        is_guarded: returns True while a guard can stop the robot when this process cannot.
    """

    where: str
    is_gone: Callable[[], bool]
    is_stopped: Callable[[], bool]
    listen: Callable[[Callable[[], None]], Inputs]
    drive: Callable[[float, float, float], str]
    halt: Callable[[], object]
    is_guarded: Callable[[], bool] = bool

"""What a program needs of a robot, which a feed gives it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

GIVEN = ("time", "state", "variables")
"""The parameters that every program may have, beside samples."""

ODOMETRY = POSE, DRIVEN, TURNED = "pose", "driven", "turned"
"""The parameters that a program may have where odometry comes: the `Pose`, and metres and radians since it began."""


class NotReadyError(Exception):
    """A sample that a program asks for is missing or too old; the text says which."""


class Inputs(Protocol):
    """The newest samples that a program asks for."""

    def choose(self, wanted: Mapping[str, str | None], on: str | None) -> None:
        """Choose the samples, by parameter: of a topic, or, for None, of the topic with that kind of sample.

        Samples that are there already stay. With ``on``, each message of that topic wakes the program.
        """

    def take(self) -> dict[str, Any]:
        """The newest samples, by parameter. NotReadyError if one is missing or too old to drive by."""

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics of the chosen samples, as far as they are found, and the one whose messages wake."""

    def why_silent(self, on: str) -> str:
        """Why no message of the topic ``on`` comes."""

    def close(self) -> None:
        """Take no more messages."""


@dataclass(frozen=True)
class DrivenRobot:
    """A robot, as a program sees it. No function waits.

    Attributes:
        where: its name, for a person.
        is_gone: returns whether nothing outside refers to it any more.
        is_stopped: returns whether stop is latched.
        listen: makes inputs that call a function on each message of the topic ``on``, in the transport's thread.
        drive: sends a speed, m/s forward, rad/s counter-clockwise and m/s to the left; returns why it was not sent,
            empty if it was.
        halt: sends zero at once, if a program drives.
        is_guarded: returns whether a guard stops the robot while this process cannot.
    """

    where: str
    is_gone: Callable[[], bool]
    is_stopped: Callable[[], bool]
    listen: Callable[[Callable[[], None]], Inputs]
    drive: Callable[[float, float, float], str]
    halt: Callable[[], object]
    is_guarded: Callable[[], bool] = bool

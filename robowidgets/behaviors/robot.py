"""What a program needs of a robot, which a feed gives it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

GIVEN = ("time", "state", "variables")
"""The parameters that every program may have, beside samples."""


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

    def why_silent(self, on: str) -> str:
        """Why no message of the topic ``on`` comes."""

    def close(self) -> None:
        """Take no more messages."""


class Robot(Protocol):
    """A robot, as a program sees it. No method waits."""

    @property
    def where(self) -> str:
        """Its name, for a person."""

    @property
    def is_gone(self) -> bool:
        """Whether nothing outside refers to it any more."""

    @property
    def stopped(self) -> bool:
        """Whether stop is latched."""

    def listen(self, wake: Callable[[], None]) -> Inputs:
        """Inputs that call `wake` on each message of the topic ``on``, in the transport's thread."""

    def drive(self, linear: float, angular: float) -> str:
        """Send a speed; returns why it was not sent, empty if it was."""

    def halt(self) -> None:
        """Send zero at once, if a program drives."""

"""The connection of a feed, for what it is made of: its driver, and what takes the messages of its topics."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from .._core.clock import Clock
from ..driving.command_watchdog import Velocity
from ..samples import Speed
from ._subscription import Target
from ._topics import FeedTopic
from .middleware import Advert


class TopicLink(Protocol):
    """The connection, for what takes the messages of its topics. See `Connection`, which describes each of these."""

    @property
    def status(self) -> str:
        """Why no message comes on any topic; empty while messages can come."""

    @property
    def topics(self) -> tuple[FeedTopic, ...]:
        """The known topics."""

    def check_open(self, *topics: Any) -> None:
        """FeedError unless the feed is open."""

    def topic_of(self, name: str) -> FeedTopic:
        """A topic as it is known now."""

    def status_of(self, topic: str) -> str:
        """The problems of a topic."""

    def mounted(self, sample: Any) -> Any:
        """A scan with the angles of the robot, if it is known how its scanner stands; another sample as it is."""

    def attach(
        self, topic: str, take: Callable[[Any], object], on_missed: Callable[[int], object] | None = None
    ) -> Target:
        """Pass on the messages of a topic."""

    def attach_target(self, topic: str, target: Target) -> None:
        """Do so for a target that is known before its first message."""

    def detach(self, topic: str, target: Target) -> None:
        """End that."""

    def decide(self, topic: FeedTopic, message: Any) -> None:
        """List the widget that shows the messages of a topic."""


class DriveLink(Protocol):
    """The connection, for its driver. See `Connection`, which describes each of these."""

    clock: Clock
    adverts: tuple[Advert, ...]
    nobody: str

    @property
    def where(self) -> str:
        """What the feed is connected to."""

    @property
    def status(self) -> str:
        """Why no message comes on any topic; empty while messages can come."""

    @property
    def is_listed(self) -> bool:
        """Whether the topics are listed."""

    @property
    def is_settled(self) -> bool:
        """Whether they are known, as far as they are discovered a moment after opening."""

    def check_open(self, *topics: Any) -> None:
        """FeedError unless the feed is open."""

    def wait_until(self, condition: Callable[[], bool], seconds: float) -> None:
        """Wait until a condition is true, for some seconds at most."""

    def await_subscriber(self, topic: str) -> None:
        """Wait, on a feed that was just opened, for a subscriber."""

    def list_driven(self, topic: str) -> None:
        """List a topic on which only this feed publishes."""

    def show_sent(self, topic: str, speed: Speed) -> None:
        """Show a speed that was sent."""

    def show_beside(self, topic: str, velocity: Velocity) -> None:
        """Show a speed that another feed of this process has sent."""

    def on_unheard(self, topic: str, reason: str) -> None:
        """Note why a subscriber does not receive speeds."""

    def on_driving(self) -> None:
        """Show other settings of driving."""

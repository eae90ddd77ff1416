"""The connection of a feed, as its parts see it: its driver, and the receivers of its messages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from ..driving.command_watchdog import Velocity
from ..runtime.clock import Clock
from ..samples import Speed
from ._subscription import Target
from ._topics import FeedTopic
from .middleware import Advert


class TopicLink(Protocol):
    """The connection, for receivers of messages. See `Connection`, which describes each method."""

    @property
    def status(self) -> str:
        """The reason why no message can come on any topic, or empty."""

    @property
    def topics(self) -> tuple[FeedTopic, ...]:
        """The known topics."""

    def check_open(self, *topics: Any) -> None:
        """Raise FeedError unless the feed is open."""

    def topic_of(self, name: str) -> FeedTopic:
        """Return a topic as it is known now."""

    def status_of(self, topic: str) -> str:
        """Return the problems of a topic."""

    def mounted(self, sample: Any) -> Any:
        """Return a scan with the angles of the robot if the mount of its scanner is known, or any sample unchanged."""

    def attach(
        self, topic: str, take: Callable[[Any], object], on_missed: Callable[[int], object] | None = None
    ) -> Target:
        """Pass on the messages of a topic."""

    def attach_target(self, topic: str, target: Target) -> None:
        """Attach a target that the caller knows before its first message."""

    def detach(self, topic: str, target: Target) -> None:
        """End an `attach`."""

    def decide(self, topic: FeedTopic, message: Any) -> None:
        """List the widget that shows the messages of a topic."""


class DriveLink(Protocol):
    """The connection, for its driver. See `Connection`, which describes each method."""

    clock: Clock
    adverts: tuple[Advert, ...]
    nobody: str

    @property
    def where(self) -> str:
        """The address or name that the feed is connected to."""

    @property
    def status(self) -> str:
        """The reason why no message can come on any topic, or empty."""

    @property
    def is_listed(self) -> bool:
        """True once the topics are listed."""

    @property
    def is_settled(self) -> bool:
        """True once the topics are listed and there was time to discover them after opening."""

    def check_open(self, *topics: Any) -> None:
        """Raise FeedError unless the feed is open."""

    def wait_until(self, condition: Callable[[], bool], seconds: float) -> None:
        """Wait for at most some seconds until a condition is true."""

    def await_subscriber(self, topic: str) -> None:
        """Wait on a newly opened feed for a subscriber."""

    def list_driven(self, topic: str) -> None:
        """List a topic on which only this feed publishes."""

    def show_sent(self, topic: str, speed: Speed) -> None:
        """Show a speed that was sent."""

    def show_beside(self, topic: str, velocity: Velocity) -> None:
        """Show a speed that another feed of this process has sent."""

    def on_unheard(self, topic: str, reason: str) -> None:
        """Note the reason why a subscriber does not receive speeds."""

    def on_driving(self) -> None:
        """Show changed settings of driving."""

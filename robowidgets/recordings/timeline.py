"""What a recording is made of, whatever file it came from: the seam between a `Recording` and what it reads."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from ..kinds import Widget
from ..samples import Scan, Speed, Touch

if TYPE_CHECKING:
    from ..poses.transforms import Joint
    from .store import Feed

Sample = Scan | Speed | Touch


class Topic(NamedTuple):
    """One topic of a recording.

    ``type`` is the message type as the file names it. ``count`` is the number of messages. ``rate`` is messages a
    second on average over the whole recording, None where that says nothing. ``widget`` is the widget that shows it,
    None when none does. ``commanded`` marks a speed that was asked for, not measured: its name holds ``cmd`` or
    ``command``. ``problem`` says in a line why the topic cannot be read; empty when it can.
    """

    name: str
    type: str
    count: int  # type: ignore[assignment]  # hides tuple.count, which nobody asks of a topic
    rate: float | None
    widget: Widget | None
    commanded: bool
    problem: str


class Moment(NamedTuple):
    """One sample of a recording: its topic, its time in nanoseconds since the epoch, and what was measured.

    ``seconds`` is the same time from the start of the recording, as `Recording.at` and a player's `seek` take it.
    """

    topic: str
    time_ns: int
    sample: Sample
    seconds: float


class Timeline(Protocol):
    """The samples of a recording in the order of their times."""

    @property
    def topics(self) -> tuple[Topic, ...]:
        """Every topic that the file names."""

    @property
    def problems(self) -> tuple[str, ...]:
        """What could not be read so far, one line each, for a person."""

    @property
    def start_ns(self) -> int | None:
        """Time of the first message in nanoseconds since the epoch; None when there is no message."""

    @property
    def end_ns(self) -> int | None:
        """Time of the last message (not one after it); None when there is no message."""

    def moments(self, topics: Collection[str], start_ns: int | None, stop_ns: int | None) -> Iterator[Moment]:
        """The samples of these topics from ``start_ns`` up to, not including, ``stop_ns``; None means no limit."""

    def last(self, topic: str, time_ns: int) -> Moment | None:
        """The last sample of a topic at or before a time; None when there is none."""

    def feed(self, topic: str) -> Feed[Any]:
        """The chunks of columns of a topic that a widget shows."""

    def joints(self) -> Iterator[Joint]:
        """Where frames were in each other, as far as odometry and tf tell, in the order of arrival."""

    def close(self) -> None:
        """Close the file; doing it again does nothing."""

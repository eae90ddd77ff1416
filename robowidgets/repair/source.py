"""What a file of messages is, whoever reads it: the seam between the readers and a `Recording`."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray


class RecordingError(Exception):
    """A recording that cannot be opened or read. The text is one line for a person: which file, and why."""


class UnknownTopicError(RecordingError, KeyError):
    """A topic that a recording does not have, or that no widget shows."""

    __str__ = Exception.__str__


class UnnamedTopicError(UnknownTopicError):
    """No topic was named, and there is not just one that can be meant.

    Args:
        there: what there is, for a person.
        topics: those that can be named.
        widget: what shows them; None: any.
        how: how one is named.
    """

    def __init__(self, there: str, topics: Sequence[str], widget: str | None, how: str = "") -> None:
        super().__init__(f"{there}: {how or f'name the topic, as in topic={topics[0]!r}'}")
        self.there = there
        self.topics = tuple(topics)
        self.widget = widget


class Channel(NamedTuple):
    """One stream of messages of one type.

    ``id`` is unique within a source, and only there. ``type`` is written as ``sensor_msgs/msg/LaserScan``, for ROS 1
    too. ``encoding`` is ``"ros1"`` or ``"cdr"``; messages in any other encoding are listed but cannot be read.
    ``definition`` is the text of the message definition in ROS's ``.msg`` syntax with its dependencies after lines of
    80 ``=``; or in IDL, after such a line and ``IDL: `` with the type; empty when the file holds none. ``count`` is the
    number of messages.
    """

    id: int
    topic: str
    type: str
    encoding: str
    definition: str
    count: int  # type: ignore[assignment]  # hides tuple.count, which nobody asks of a channel


class Arrivals(NamedTuple):
    """Log times of messages in nanoseconds and the ids of their channels, both of shape (N,), as they were written."""

    times: NDArray[np.int64]
    channels: NDArray[np.int64]

    def renumbered(self, ids: Mapping[int, int]) -> Arrivals:
        """The same with other ids of channels."""
        known, places = np.unique(self.channels, return_inverse=True)
        return Arrivals(self.times, np.array([ids[number] for number in known.tolist()], np.int64)[places])


def joined(parts: Iterable[Arrivals]) -> Arrivals:
    """Arrivals one after the other."""
    none = np.empty(0, np.int64)
    times, channels = zip(Arrivals(none, none), *parts, strict=True)
    return Arrivals(np.concatenate(times), np.concatenate(channels))


def latest(times: Iterable[int | None]) -> int | None:
    """The last of some times; None where one of them is not known, or there is none."""
    known: list[int] = []
    for time in times:
        if time is None:
            return None
        known.append(time)
    return max(known, default=None)


class Source(Protocol):
    """The messages of one file or folder, as bytes.

    Opening one raises `RecordingError` when nothing at all can be read.
    """

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Every channel that the file names, also those without a message."""

    @property
    def problems(self) -> tuple[str, ...]:
        """What could not be read beside the rest, one line each, for a person."""

    @property
    def start_ns(self) -> int | None:
        """Log time of the first message in nanoseconds since the epoch; None when there is no message."""

    @property
    def end_ns(self) -> int | None:
        """Log time of the last message (not one after it); None when there is no message."""

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[tuple[Channel, int, bytes]]:
        """Channel, log time and bytes of the messages of these channels, by log time where the file is indexed.

        Those logged at ``start_ns`` or later and before ``stop_ns``; None means no limit. No channel, no message. May
        be called again and again, also while an earlier iterator is in use.
        """

    def arrivals(self) -> Arrivals:
        """What the index of the file tells about the order of arrival: of every message, or of some of each part."""

    def last_ns(self, channel: Channel) -> int | None:
        """Log time of the last message of a channel, or a little later; None where the index does not tell."""

    def close(self) -> None:
        """Close the file; doing it again does nothing."""


@runtime_checkable
class SavedSource(Source, Protocol):
    """A source that knows every message in the order of arrival."""

    def retime(self, times: NDArray[np.int64], why: str) -> None:
        """Bear other log times, those of all `arrivals`, and tell why among the problems."""

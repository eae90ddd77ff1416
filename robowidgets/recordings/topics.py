"""The topics of a recording, and the errors for missing and ambiguous names."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from difflib import get_close_matches
from typing import Any, NamedTuple

from ..kinds import KINDS
from ..repair import RecordingError

_MADE = re.compile(r"filter|merged|multi|combined|fused|throttle|downsampled|cropped|relay|repub", re.IGNORECASE)
"""Parts of the names of topics that are derived from other topics."""


UPDATES = "_updates"
"""The end of the name of a topic with partial updates of the grid on the topic of the same name without it."""

_UPDATE_TYPE = "map_msgs/msg/OccupancyGridUpdate"


class Topic(NamedTuple):
    """One topic of a recording.

    ``type`` is the message type as the file names it. ``count`` is the number of messages. ``rate`` is the mean number
    of messages per second from its first message to its last, or None if there are only a few within a second.
    ``widget`` is the kind of the widget that shows it, or None. ``commanded`` is True for a commanded speed, as opposed
    to a measured one: its name contains ``cmd`` or ``command``. ``problem`` is a line with the reason why it cannot be
    read, or empty.
    """

    name: str
    type: str
    count: int  # type: ignore[assignment]  # hides tuple.count, which a topic does not need
    rate: float | None
    widget: str | None
    commanded: bool
    problem: str


class Moment(NamedTuple):
    """One sample of a recording: its topic, its time in nanoseconds since the epoch, and the sample itself.

    ``seconds`` is the same time from the start of the recording, as `Recording.at` and a player's `seek` take it.
    """

    topic: str
    time_ns: int
    sample: Any
    seconds: float


class TimedMessage(Moment):
    """One message of any type: its topic, its time, and the message itself, in ``message`` and ``sample``."""

    @property
    def message(self) -> Any:
        """The message, with the fields of its definition: ``message.linear_acceleration.x``."""
        return self.sample


class UnknownTopicError(RecordingError, KeyError):
    """The recording has no such topic, or no widget shows it."""

    __str__ = Exception.__str__


class UnnamedTopicError(UnknownTopicError):
    """No topic was named, and there is not exactly one that fits.

    Args:
        there: a text for the topics that fit.
        topics: the topics that can be named.
        widget: the kind of widget that shows them, or None for any.
        how: a text for the way to name one.
    """

    def __init__(self, there: str, topics: Sequence[str], widget: str | None, how: str = "") -> None:
        super().__init__(f"{there}: {how or f'name the topic, as in topic={topics[0]!r}'}")
        self.there = there
        self.topics = tuple(topics)
        self.widget = widget


def shown(topics: Iterable[Topic]) -> dict[str, Topic]:
    """Return the topics that a widget shows, by name."""
    return {topic.name: topic for topic in topics if topic.widget}


def wanted(topics: Iterable[Topic], names: Collection[str]) -> list[Topic]:
    """Return the topics of these names; without names, all topics with messages."""
    return [topic for topic in topics if (topic.name in names if names else topic.count)]


def named(topics: Iterable[Topic], widget: str) -> list[str]:
    """Return the names of the topics that a kind of widget shows."""
    return [topic.name for topic in topics if topic.widget == widget]


def check(name: str, topics: Sequence[Topic], file: str) -> None:
    """See `Recording.check`."""
    known = check_known(name, topics, file)
    can = shown(topics)
    if name in can:
        return
    there = ", ".join(can) or "none"
    if known.problem:
        raise UnknownTopicError(f"{file}: topic {name!r} cannot be shown ({known.problem}): topics that can: {there}")
    raise UnknownTopicError(
        f"{file}: topic {name!r} cannot be shown (no widget shows {known.type}): topics that can: {there}; "
        f"recording.messages({name!r}) and recording.fields({name!r}) read its messages"
    )


def check_known(name: str, topics: Sequence[Topic], file: str) -> Topic:
    """Return the topic of a name.

    Raises:
        UnknownTopicError: the recording has no topic of this name. TypeError: the name is not a text.
    """
    if not isinstance(name, str):
        raise TypeError(f"expected the name of a topic as text, got {name!r}")
    known = next((topic for topic in topics if topic.name == name), None)
    if known is None:
        near = get_close_matches(name, [topic.name for topic in topics])
        hint = f"; did you mean {' or '.join(map(repr, near))}?" if near else ""
        there = ", ".join(shown(topics)) or "none"
        raise UnknownTopicError(f"{file} has no topic {name!r}; topics with a widget: {there}{hint}")
    return known


def only(name: str, topics: Iterable[Topic], widget: str, preferred: Collection[str] = ()) -> str:
    """Return the only topic of a kind (for speeds, the only measured one). Topics without messages are the last resort.

    If there are several, topics that are derived from others, such as ``/scan_filtered`` and ``/scan_merged``, do not
    count.

    Args:
        name: the name of the recording, for errors.
        topics: all topics.
        widget: the kind of widget that shows the topic.
        preferred: names of topics that are preferred if there are several.

    Raises:
        UnknownTopicError: the recording has no such topic. `UnnamedTopicError`: there are several.
    """
    topics = list(topics)
    there = named(wanted(topics, ()), widget) or named(topics, widget)
    measured = named((topic for topic in topics if not topic.commanded), widget)
    sources = [topic for topic in there if topic in measured and not _MADE.search(topic)]
    for some in ([topic for topic in there if topic in preferred], there, measured, sources):
        if len(some) == 1:
            return some[0]
    noun = KINDS[widget].noun
    if not there:
        raise UnknownTopicError(f"{name} has no {noun}")
    raise UnnamedTopicError(f"{name} has several topics of {noun} ({', '.join(there)})", there, widget)


def updates_in(topics: Iterable[Topic]) -> dict[str, int]:
    """Return the topics of grids that other messages change, with the numbers of these messages."""
    updates = {topic.name: topic.count for topic in topics if topic.type == _UPDATE_TYPE and topic.count}
    return {name.removesuffix(UPDATES): count for name, count in updates.items() if name.endswith(UPDATES)}


def likeliest(topics: Iterable[Topic]) -> Topic:
    """Return the likeliest topic of one kind if the user names none.

    Measured topics precede commanded ones, and these precede topics that are derived from others, such as
    ``/scan_merged``. Then the topic with most messages comes first, then the one with the shortest name.
    """

    def rank(topic: Topic) -> tuple[Any, ...]:
        return topic.commanded, bool(_MADE.search(topic.name)), -topic.count, len(topic.name), topic.name

    return min(topics, key=rank)

"""The topics of a recording, and how one of them is named."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from ..kinds import KINDS
from ..repair import RecordingError


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
    widget: str | None
    commanded: bool
    problem: str


class Moment(NamedTuple):
    """One sample of a recording: its topic, its time in nanoseconds since the epoch, and what was measured.

    ``seconds`` is the same time from the start of the recording, as `Recording.at` and a player's `seek` take it.
    """

    topic: str
    time_ns: int
    sample: Any
    seconds: float


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


def shown(topics: Iterable[Topic]) -> dict[str, Topic]:
    """By name those that a widget shows."""
    return {topic.name: topic for topic in topics if topic.widget}


def named(topics: Iterable[Topic], widget: str) -> list[str]:
    """The names of the topics that a widget shows."""
    return [topic.name for topic in topics if topic.widget == widget]


def check(name: str, topics: Iterable[Topic], file: str) -> None:
    """See `Recording.check`."""
    if not isinstance(name, str):
        raise TypeError(f"expected the name of a topic as text, got {name!r}")
    can = shown(topics)
    if name in can:
        return
    there = ", ".join(can) or "none"
    known = next((topic for topic in topics if topic.name == name), None)
    if known is None:
        raise UnknownTopicError(f"{file} has no topic {name!r}: those that a widget shows are {there}")
    why = known.problem or f"no widget shows {known.type}"
    raise UnknownTopicError(f"{file}: topic {name!r} cannot be shown ({why}): those that can are {there}")


def only(name: str, topics: Iterable[Topic], widget: str) -> str:
    """The one topic of a kind; of speeds, the one that is measured.

    Args:
        name: what the recording is called, for errors.
        topics: those among which it is.
        widget: what shows it.

    Raises:
        UnknownTopicError: there is none, or, as `UnnamedTopicError`, not just one.
    """
    topics = list(topics)
    there = named(topics, widget)
    for some in (there, named((topic for topic in topics if not topic.commanded), widget)):
        if len(some) == 1:
            return some[0]
    noun = KINDS[widget].noun
    if not there:
        raise UnknownTopicError(f"{name} has no {noun}")
    raise UnnamedTopicError(f"{name} has several topics of {noun} ({', '.join(there)})", there, widget)

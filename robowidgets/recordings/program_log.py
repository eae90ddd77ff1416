"""The programs in a recording: their versions, and the states of their state machines.

`Feed.record` writes them as ``std_msgs/String``: the text of each version on one topic, and the active state of each
machine on a separate topic. Tools that plot text over time show these topics as bands.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

from ..samples.state_span import StateSpan

TEXT = "std_msgs/msg/String"
PROGRAM = "/robowidgets/program"
ASSISTANT = "/robowidgets/assistant"
"""The topic with the commands of assistants."""

STATES = "/robowidgets/states/"
"""The start of the topic names, followed by the path of a machine such as ``Walker/avoid``; an empty text means not
active."""

_HEAD = re.compile(r"# (.*), version (\d+)\n")


class ProgramVersion(NamedTuple):
    """A version of a program: its first time in seconds from the start of the recording, and its text."""

    seconds: float
    name: str
    number: int
    text: str


def program_text(name: str, number: int, text: str) -> str:
    """Return the message for a version of a program."""
    return f"# {name}, version {number}\n{text}"


def state_topic(machine: str) -> str:
    """Return the topic with the states of a machine."""
    return STATES + machine.replace(".", "/")


def version_of(seconds: float, message: str) -> ProgramVersion:
    """Return the version in a message of `program_text`."""
    head = _HEAD.match(message)
    if head is None:
        return ProgramVersion(seconds, "", 0, message)
    return ProgramVersion(seconds, head[1], int(head[2]), message[head.end() :])


def spans_of(said: Iterable[tuple[str, float, str]], end: float) -> tuple[StateSpan, ...]:
    """Return the spans of states in messages: topic, seconds and text of each, in the order of time."""
    spans: list[StateSpan] = []
    active: dict[str, tuple[float, str]] = {}

    def close(machine: str, at: float) -> None:
        start, name = active.pop(machine, (at, ""))
        if name:
            spans.append(StateSpan(start, at, f"{machine}.{name}"))

    for topic, seconds, name in said:
        machine = topic.removeprefix(STATES).replace("/", ".")
        if active.get(machine, (0.0, ""))[1] != name:
            close(machine, seconds)
            active[machine] = seconds, name
    for machine in list(active):
        close(machine, end)
    return tuple(sorted(spans))

"""A recording of a program, written for a test: scans, the states of its machines, and its versions."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from robowidgets.messages.channel import Channel
from robowidgets.messages.encoding import encode
from robowidgets.recordings.program_log import PROGRAM, TEXT, program_text, state_topic
from robowidgets.repair.write import McapWriter

from .sweeps import START_NS, TYPE, scan

STATES = (
    *((0, "Walker", "forward"), (4, "Walker", "avoid"), (4, "Walker.avoid", "stop"), (5, "Walker.avoid", "turn_left")),
    *((7, "Walker.avoid", ""), (7, "Walker", "forward")),
)
"""Seconds, machine, and its state from then on."""


def write(path: Path, states: Iterable[tuple[float, str, str]] = STATES, seconds: int = 10) -> Path:
    """A file with ten scans a second, these states, and two versions of a program."""
    messages = [(i / 10, "/scan", TYPE, scan(START_NS, [1.0 + i % 20 / 10] * 11)) for i in range(10 * seconds + 1)]
    texts = [(at, state_topic(machine), name) for at, machine, name in states]
    texts += [(at, PROGRAM, program_text("Walker", n, f"class Walker:\n    v = {n}\n")) for n, at in ((1, 0), (2, 3))]
    messages += [(at, topic, TEXT, encode("cdr", TEXT, {"data": text})) for at, topic, text in texts]
    channels: dict[str, Channel] = {}
    with path.open("wb") as file:
        writer = McapWriter(file, {"cdr"})
        for at, topic, type_name, data in sorted(messages, key=lambda message: message[0]):
            if topic not in channels:
                channels[topic] = Channel(len(channels), topic, type_name, "cdr", "", 0)
                writer.register(channels[topic])
            writer.add(channels[topic], START_NS + round(at * 1e9), data)
        writer.finish()
    return path

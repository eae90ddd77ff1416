"""A recording of a program, written for a test: scans, the states of its machines, and its versions."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from robowidgets.recordings.program_log import PROGRAM, TEXT, program_text, state_topic

from . import recorded
from .sweeps import START_NS, TYPE, scan

STATES = (
    *((0, "Walker", "forward"), (4, "Walker", "avoid"), (4, "Walker.avoid", "stop"), (5, "Walker.avoid", "turn_left")),
    *((7, "Walker.avoid", ""), (7, "Walker", "forward")),
)
"""Seconds, machine, and its state from then on."""


def write(folder: Path, states: Iterable[tuple[float, str, str]] = STATES, seconds: int = 10) -> Path:
    """A folder with ten scans a second, these states, and two versions of a program."""
    texts = [(at, state_topic(machine), name) for at, machine, name in states]
    texts += [(at, PROGRAM, program_text("Walker", n, f"class Walker:\n    v = {n}\n")) for n, at in ((1, 0), (2, 3))]
    messages: list[tuple[float, str, Any]] = [
        *((i / 10, "/scan", scan(START_NS, [1.0 + i % 20 / 10] * 11)) for i in range(10 * seconds + 1)),
        *((at, topic, {"data": text}) for at, topic, text in texts),
    ]
    types = {topic: TYPE if topic == "/scan" else TEXT for _, topic, _ in messages}
    return recorded.write(folder, types, sorted(messages, key=lambda message: message[0]))

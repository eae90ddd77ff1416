"""Recordings with several topics of a kind, written for a test: any times, any values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from . import recorded, sweeps

_BUMP = "kobuki_ros_interfaces/msg/BumperEvent"
_TWIST = "geometry_msgs/msg/Twist"


def write(folder: Path, topics: Mapping[str, Iterable[tuple[float, float]]]) -> Path:
    """A folder with times, in seconds after the start, and values of topics, whose names decide their types.

    With "scan": scans of one ray with that range; with "bump": 1 as the left one is pressed, 0 as it is released; all
    others: speeds forward.
    """
    types = {topic: sweeps.TYPE if "scan" in topic else _BUMP if "bump" in topic else _TWIST for topic in topics}
    messages = [
        (at, topic, _message(types[topic], value)) for topic, samples in topics.items() for at, value in samples
    ]
    return recorded.write(folder, types, messages)


def every(seconds: float, start: float, stop: float, value: float) -> Sequence[tuple[float, float]]:
    """Times at this distance, all with one value."""
    return [(start + i * seconds, value) for i in range(round((stop - start) / seconds))]


def _message(type_name: str, value: float) -> dict[str, Any] | bytes:
    if type_name == sweeps.TYPE:
        return sweeps.scan(sweeps.START_NS, [value])
    return {"state": int(value)} if type_name == _BUMP else {"linear": {"x": value}}

"""A recording of numbers: a depth as Float64, and a level as the text of a String."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..unit.recordings import recorded
from ..unit.recordings.recorded import START_NS, stamped

COUNT = 50
STEP = 0.1

_STRING = "std_msgs/msg/String"


def write(folder: Path) -> Path:
    """Five seconds at 10 Hz: number i of /depth is i / 10, of /level 2 m - i cm as a text; /name has other words."""
    types = {"/depth": "std_msgs/msg/Float64", "/level": _STRING, "/name": _STRING, "/cliff": "sensor_msgs/msg/Range"}
    return recorded.write(folder, types, _messages())


def _messages() -> Iterator[tuple[float, str, dict[str, Any]]]:
    for i in range(COUNT):
        seconds = i * STEP
        header = stamped(START_NS + round(seconds * 1e9), "front")
        yield seconds, "/depth", {"data": i / 10}
        yield seconds, "/level", {"data": f"{2 - i / 100:.2f} m"}
        yield seconds, "/name", {"data": "tank 2"}
        yield seconds, "/cliff", {"header": header, "min_range": 0.3, "max_range": 0.3, "range": float("inf")}

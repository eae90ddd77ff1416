"""A recording of numbers: a depth as Float64, and how far something is as Range."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..unit.recordings import recorded
from ..unit.recordings.recorded import START_NS, stamped

COUNT = 50
STEP = 0.1

_RANGE = "sensor_msgs/msg/Range"


def write(folder: Path) -> Path:
    """Five seconds at 10 Hz: number i of /depth is i / 10, of /sonar 2 m - i cm; /cliff says that nothing is there."""
    return recorded.write(folder, {"/depth": "std_msgs/msg/Float64", "/sonar": _RANGE, "/cliff": _RANGE}, _messages())


def _messages() -> Iterator[tuple[float, str, dict[str, Any]]]:
    for i in range(COUNT):
        seconds = i * STEP
        header = stamped(START_NS + round(seconds * 1e9), "front")
        yield seconds, "/depth", {"data": i / 10}
        yield seconds, "/sonar", {"header": header, "min_range": 0.1, "max_range": 4.0, "range": 2.0 - i / 100}
        yield seconds, "/cliff", {"header": header, "min_range": 0.3, "max_range": 0.3, "range": float("inf")}

"""The content of a scanogram, and the data for the page in addition to its cells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from .levels import Levels
from .scan_times import ScanTimes, Thinned
from .strips import SpeedStrip, TouchStrip


@dataclass(frozen=True)
class Picture:
    """The content of a scanogram: the scans in their levels of detail, and the strips under them."""

    levels: Levels
    clock: ScanTimes
    start_ns: int
    duration: float
    begin: float = 0.0
    speed: SpeedStrip | None = None
    touch: TouchStrip | None = None
    thinned: Thinned | None = None

    def facts(self) -> dict[str, Any]:
        """Return the plain values that the page needs for the cells and the strips."""
        levels, clock, speed, touch = self.levels, self.clock, self.speed, self.touch
        facts: dict[str, Any] = {
            **levels.sweep._asdict(),
            "far": levels.far,
            "scan_count": len(clock),
            "begin": self.begin,
            "duration": self.duration,
            "pause": clock.pause,
            "class_counts": levels.counts.tolist(),
            "colors": levels.color_range,
        }
        if self.thinned:
            facts["drive_scans"] = self.thinned.of
        if speed:
            facts["speed"] = {
                "title": speed.title, "axes": speed.axes, "limits": speed.limits, "gap": speed.clock.gap
            }  # fmt: skip
        if touch:
            facts["touch"] = {"title": touch.title, "sensors": touch.sensors}
        return facts

    def speeds(self, start: float, end: float) -> dict[str, NDArray[Any]]:
        """Return the arrays of the speeds within a span of seconds, or nothing without speeds."""
        if self.speed is None:
            return {}
        part = self.speed.part(start, end)
        return {"speed_starts": part.starts, "speeds": part.extremes}

    def strips(self) -> dict[str, NDArray[Any]]:
        """Return the arrays of all strips."""
        touches = {} if self.touch is None else {"touches": self.touch.spans}
        return self.speeds(self.begin, self.duration) | touches

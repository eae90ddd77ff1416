"""The strips under a scanogram, on the same time axis: speeds, and the spans of touches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..samples import AXES
from ..widget.limit_traits import is_past
from .scan_times import ScanTimes

MOST_SPEEDS = 4_000
"""The maximum number of points of the speeds that a page gets at once."""

MOST_TOUCHES = 2_000
"""The maximum number of spans of touches that a page gets; of more, the closest are joined."""

SIDEWAYS = 0.05
"""Metres per second; slower sideways speeds count as noise of a robot that cannot move sideways."""

FAST = 1.0
"""m/s or rad/s; other axes are shown if they are faster."""

_ALWAYS = ("linear.x", "angular.z")


class SpeedPart(NamedTuple):
    """M points of the speeds: start in seconds (M,), and the least and greatest values of each axis (A, 2, M)."""

    starts: NDArray[np.float64]
    extremes: NDArray[np.float32]


class SpeedStrip:
    """The speeds of the shown axes: linear x, angular z, linear y if used, and axes that are fast or past limits.

    Args:
        title: the name of the topic.
        clock: the times of the speeds.
        values: shape (M, 6), in the order of `AXES`; NaN for missing values.
        limits: (min, max) by axis; axes that are left out have no limits.
    """

    def __init__(
        self, title: str, clock: ScanTimes, values: NDArray[np.float64], limits: dict[str, tuple[float, float]]
    ) -> None:
        self.title, self.clock = title, clock
        known = np.nan_to_num(values)
        ends = {
            axis: (column.min(initial=0), column.max(initial=0)) for axis, column in zip(AXES, known.T, strict=True)
        }
        over = {
            axis for axis in AXES if any(is_past(float(end), limits.get(axis, (-FAST, FAST))) for end in ends[axis])
        }
        if max(np.abs(ends["linear.y"])) > SIDEWAYS:
            over.add("linear.y")
        shown = [i for i, axis in enumerate(AXES) if axis in _ALWAYS or axis in over]
        with np.errstate(over="ignore"):  # from damaged numbers
            self._values = np.ascontiguousarray(values[:, shown].T, np.float32)
        self.axes = [AXES[i] for i in shown]
        self.limits = [limits.get(axis) for axis in self.axes]

    def part(self, start: float, end: float) -> SpeedPart:
        """Return the speeds between two times in seconds, and one more at either end; of too many, the extremes."""
        first, stop = self.clock.between(start, end)
        first, stop = max(0, first - 1), min(len(self.clock), stop + 1)
        every = max(1, -(-(stop - first) // MOST_SPEEDS))
        at = np.arange(first, stop, every)
        values = self._values[:, first:stop]
        if not at.size:
            return SpeedPart(np.empty(0), np.empty((len(self.axes), 2, 0), np.float32))
        extremes = [reduce.reduceat(values, at - first, axis=1) for reduce in (np.fmin, np.fmax)]
        return SpeedPart(self.clock.starts[at], np.stack(extremes, axis=1))


class TouchStrip:
    """The spans of touches.

    Args:
        title: the name of the topic, or several.
        sensors: the names of the sensors.
        spans: (start, end, index of the sensor), in seconds, ordered by start.
    """

    def __init__(self, title: str, sensors: Sequence[str], spans: NDArray[np.float64]) -> None:
        self.title, self.sensors = title, list(sensors)
        self.spans = _joined(spans)


def _joined(spans: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the spans, at most `MOST_TOUCHES`: the closest spans of a sensor are joined."""
    closeness = 0.0
    while len(spans) > MOST_TOUCHES:
        closeness = max(2 * closeness, 0.05)
        kept: list[NDArray[np.float64]] = []
        for sensor in np.unique(spans[:, 2]):
            own = spans[spans[:, 2] == sensor]
            ends = np.maximum.accumulate(own[:, 1])
            firsts = np.flatnonzero(np.append(True, own[1:, 0] - ends[:-1] > closeness))
            lasts = np.append(firsts[1:], len(own)) - 1
            kept.append(np.column_stack((own[firsts, 0], ends[lasts], own[firsts, 2])))
        spans = np.concatenate(kept)
        spans = spans[np.argsort(spans[:, 0], kind="stable")]
    return spans

"""Where a robot went: its poses one after the other, thinned so that a long drive stays small."""

from __future__ import annotations

from math import hypot, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..samples import Pose

MOST_POINTS = 1000
"""Points of a path. When there are more, every second one is dropped, and from then on they lie twice as far apart."""

STEP = 0.02
"""Metres from one point to the next, at first."""

LEAST_JUMP = 0.3
"""Metres: a shorter jump is drawn as a way."""

SPEEDUP = 5.0
"""Metres per second: no robot is twice as fast as before, and this much more, from one pose to the next."""


class Path:
    """The poses of a robot with their times, oldest first; the last point is always the newest pose.

    The last point moves with the robot until it lies `step` metres from the one before. So standing still adds no
    points, and all of a long way is kept, with fewer points to the metre.

    Where it jumps farther than a robot can drive from one pose to the next, as odometry does that was set back, a new
    stroke begins: its first point is as many metres along the way as the last one before the jump.
    """

    def __init__(self) -> None:
        self.step = STEP
        self._points: list[tuple[float, float, float, float, float]] = []
        self._clock: float | None = None
        self._velocity = (0.0, 0.0)
        """Of the newest pose: when it was measured, and how fast the robot went there, also by a jump."""
        self._jumped = False

    def add(self, time: float, pose: Pose, clock: float | None = None) -> bool:
        """Add the newest pose at a time in seconds; one without a place is left out.

        Args:
            time: seconds.
            pose: where the robot was.
            clock: seconds at which it was measured; None: unknown, and then no jump is seen.

        Returns:
            Whether it begins a new stroke, after a jump.

        Raises:
            ValueError: the time lies before that of the last point.
        """
        points = self._points
        if points and time < points[-1][0]:
            raise ValueError(f"time: expected {points[-1][0]:g} s or later, got {time:g}; clear() starts a new path")
        if not (isfinite(pose.x) and isfinite(pose.y)):
            return False
        jumps = self._jumps(pose, clock)
        moves = len(points) > 1 and points[-1][4] - points[-2][4] < self.step and not _is_gap(points[-2], points[-1])
        if moves and not jumps:
            points.pop()
        way = points[-1][4] if points else 0.0
        if points and not jumps:
            way += hypot(pose.x - points[-1][1], pose.y - points[-1][2])
        points.append((time, *pose, way))
        if len(points) > MOST_POINTS:
            self._points = points[::2] if len(points) % 2 else [*points[::2], points[-1]]
            self.step *= 2
        return jumps

    def _jumps(self, pose: Pose, clock: float | None) -> bool:
        """Whether no robot drives to a pose from the newest one until then; a clock that was set back gives no time."""
        before, self._clock = self._clock, clock
        (ahead, aside), jumped = self._velocity, self._jumped
        self._velocity, self._jumped = (0.0, 0.0), False
        if not self._points or before is None or clock is None:
            return False
        _, x, y, _, _ = self._points[-1]
        seconds, (x_step, y_step) = max(0.0, clock - before), (pose.x - x, pose.y - y)
        if seconds:
            self._velocity = x_step / seconds, y_step / seconds
        self._jumped = bool(is_jump(hypot(x_step, y_step), seconds, 0.0 if jumped else hypot(ahead, aside)))
        if self._jumped and jumped:
            # A fast car that comes into view goes on as it came; odometry does not jump twice alike.
            self._jumped = bool(is_jump(hypot(x_step - ahead * seconds, y_step - aside * seconds), seconds, 0.0))
        return self._jumped

    @property
    def points(self) -> NDArray[np.float64]:
        """Seconds, x and y in metres, yaw in radians, and metres of the way so far, of each point, shape (N, 5)."""
        return np.array(self._points, np.float64).reshape(-1, 5)


def is_jump(metres: Any, seconds: Any, speed: Any) -> Any:
    """Whether poses lie farther apart than a robot of a speed can drive in a time, as where odometry was set back."""
    return metres > LEAST_JUMP + seconds * (2 * speed + SPEEDUP)


def _is_gap(start: tuple[float, ...], end: tuple[float, ...]) -> bool:
    """Whether a robot jumped from one point of a path to the next."""
    return hypot(end[1] - start[1], end[2] - start[2]) > end[4] - start[4] + LEAST_JUMP / 2

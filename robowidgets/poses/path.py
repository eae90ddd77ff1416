"""Where a robot went: its poses one after the other, thinned so that a long drive stays small."""

from __future__ import annotations

from math import hypot, isfinite

import numpy as np
from numpy.typing import NDArray

from ..samples import Pose

MOST_POINTS = 1000
"""Points of a path. When there are more, every second one is dropped, and from then on they lie twice as far apart."""

STEP = 0.02
"""Metres from one point to the next, at first."""


class Path:
    """The poses of a robot with their times, oldest first; the last point is always the newest pose.

    The last point moves with the robot until it lies `step` metres from the one before. So standing still adds no
    points, and all of a long way is kept, with fewer points to the metre.
    """

    def __init__(self) -> None:
        self.step = STEP
        self._points: list[tuple[float, float, float, float, float]] = []

    def add(self, time: float, pose: Pose) -> None:
        """Add the newest pose at a time in seconds; one without a place is left out.

        Raises:
            ValueError: the time lies before that of the last point.
        """
        points = self._points
        if points and time < points[-1][0]:
            raise ValueError(f"time: expected {points[-1][0]:g} s or later, got {time:g}; clear() starts a new path")
        if not (isfinite(pose.x) and isfinite(pose.y)):
            return
        if len(points) > 1 and points[-1][4] - points[-2][4] < self.step:
            points.pop()
        way = points[-1][4] + hypot(pose.x - points[-1][1], pose.y - points[-1][2]) if points else 0.0
        points.append((time, *pose, way))
        if len(points) > MOST_POINTS:
            self._points = points[::2] if len(points) % 2 else [*points[::2], points[-1]]
            self.step *= 2

    @property
    def points(self) -> NDArray[np.float64]:
        """Seconds, x and y in metres, yaw in radians, and metres of the way so far, of each point, shape (N, 5)."""
        return np.array(self._points, np.float64).reshape(-1, 5)

"""The path of a robot: its poses over time, thinned so that a long drive stays small."""

from __future__ import annotations

from math import hypot, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..samples import Pose

MOST_POINTS = 1000
"""The most points of a path. With more, every second point is dropped, and the step between points doubles."""

STEP = 0.02
"""Metres from one point to the next at the start."""

LEAST_JUMP = 0.3
"""Metres. A shorter jump is drawn as driving."""

SPEEDUP = 5.0
"""Metres per second. Between two poses no robot exceeds twice its last speed plus this."""


class Path:
    """The poses of a robot with their times, oldest first; the last point is always the newest pose.

    The last point moves with the robot until it has driven `step` metres from the point before. So a robot that stands
    still adds no points, and a long path is kept in full, with fewer points per metre. The metres driven count the way
    from each pose to the next, also of poses that leave no point.

    If a pose is farther away than a robot can drive, for example because odometry was reset, a new stroke begins. The
    jump adds nothing to the length of the path.
    """

    def __init__(self) -> None:
        self.step = STEP
        self._points: list[tuple[float, float, float, float, float]] = []
        self._clock: float | None = None
        self._velocity = (0.0, 0.0)
        """The velocity between the last two poses, also in a jump."""
        self._jumped = False

    def add(self, time: float, pose: Pose, clock: float | None = None) -> bool:
        """Add the newest pose; a pose without a place is ignored.

        Args:
            time: seconds.
            pose: the pose of the robot.
            clock: seconds at which the pose was measured, or None if unknown; then jumps are not detected.

        Returns:
            True if the pose begins a new stroke after a jump.

        Raises:
            ValueError: the time lies before the time of the last point.
        """
        points = self._points
        if points and time < points[-1][0]:
            raise ValueError(f"time: expected {points[-1][0]:g} s or later, got {time:g}; clear() starts a new path")
        if not (isfinite(pose.x) and isfinite(pose.y)):
            return False
        jumps = self._jumps(pose, clock)
        moves = len(points) > 1 and points[-1][4] - points[-2][4] < self.step and not _is_gap(points[-2], points[-1])
        way = points[-1][4] if points else 0.0
        if points and not jumps:
            way += hypot(pose.x - points[-1][1], pose.y - points[-1][2])
        if moves and not jumps:
            points.pop()  # after its way was counted: a chord between kept points is shorter
        points.append((time, *pose, way))
        if len(points) > MOST_POINTS:
            self._points = points[::2] if len(points) % 2 else [*points[::2], points[-1]]
            self.step *= 2
        return jumps

    def _jumps(self, pose: Pose, clock: float | None) -> bool:
        """Return True if no robot can drive from the newest pose to this one in time; negative times count as 0."""
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
            # After the first pose of a fast car the velocity goes on; odometry does not repeat the same jump.
            self._jumped = bool(is_jump(hypot(x_step - ahead * seconds, y_step - aside * seconds), seconds, 0.0))
        return self._jumped

    @property
    def points(self) -> NDArray[np.float64]:
        """Seconds, x and y in metres, yaw in radians, and metres driven so far, for each point, shape (N, 5)."""
        return np.array(self._points, np.float64).reshape(-1, 5)


def is_jump(metres: Any, seconds: Any, speed: Any) -> Any:
    """Return True if a robot with this speed cannot drive so many metres in this time, as when odometry is reset."""
    return metres > LEAST_JUMP + seconds * (2 * speed + SPEEDUP)


def _is_gap(start: tuple[float, ...], end: tuple[float, ...]) -> bool:
    """Return True if there is a jump between two points of a path."""
    return hypot(end[1] - start[1], end[2] - start[2]) > end[4] - start[4] + LEAST_JUMP / 2

"""The last poses of a robot, and its pose at the time of another sample."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import isfinite, nan

import numpy as np
from numpy.typing import NDArray

from ..samples import Pose

KEPT = 500
FARTHEST = 1.0
"""The most seconds from a sample to the nearest pose; beyond this the pose of the robot is unknown."""


def poses_at(
    seconds: float | NDArray[np.float64], times: NDArray[np.float64], poses: Sequence[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return the poses of a robot at some times, interpolated; NaN where no pose is near.

    Args:
        seconds: times, shape (M,), or one number.
        times: seconds of the poses in order, shape (N,).
        poses: x and y in metres and yaw in radians without jumps, shape (N,) each.

    Returns:
        X, y and yaw, shape (3, M).
    """
    after = np.searchsorted(times, seconds)
    apart = np.abs(times.take([after - 1, after], mode="clip") - seconds).min(axis=0)
    return np.where(apart <= FARTHEST, [np.interp(seconds, times, column) for column in poses], np.nan)


class RecentPoses:
    """The last poses of a robot, oldest first, each with its time of arrival and its stamp.

    Args:
        most: the number of poses to keep, or None for all.
    """

    def __init__(self, most: int | None = KEPT) -> None:
        self._rows: deque[tuple[float, ...]] = deque(maxlen=most)
        self._columns: NDArray[np.float64] | None = None
        """The rows as an array, shape (5, N), the yaw without jumps, or None if they have changed."""

    def add(self, pose: Pose, arrived: float, stamp_ns: int | None) -> None:
        """Add the newest pose. A pose that is not finite is ignored; if time goes back, earlier poses are dropped."""
        row = (arrived, stamp_ns / 1e9 if stamp_ns else nan, *pose)
        if not all(map(isfinite, pose)):
            return
        if self._rows and (row[0] < self._rows[-1][0] or row[1] < self._rows[-1][1]):
            self._rows.clear()
        self._rows.append(row)
        self._columns = None

    def at(self, arrived: float, stamp_ns: int | None) -> Pose | None:
        """Return the pose of the robot at the time of a sample, interpolated, or None if no pose is near.

        Times are compared by stamps if the sample and all poses have stamps of the same clock, else by arrival.
        """
        if not self._rows:
            return None
        if self._columns is None:
            self._columns = np.array(self._rows).T
            self._columns[-1] = np.unwrap(self._columns[-1])
        arrivals, stamps, *pose = self._columns
        for times, time in ((stamps, stamp_ns / 1e9 if stamp_ns else nan), (arrivals, arrived)):
            if np.isfinite(times).all() and np.isfinite(at := poses_at(time, times, pose)).all():
                return Pose(*at.tolist())
        return None

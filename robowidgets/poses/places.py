"""Search of the poses of a robot by place."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..samples import Pose
from ..samples.checks import finite, to_radians

WITHIN = 0.5
"""The largest distance between two poses of the same place, as in `Places`."""


class Places:
    """The poses of a robot at some times, to search by place.

    The distance of two poses includes metres and the difference of headings in radians: a robot that drives back
    through a corridor is at other places.

    Args:
        seconds: times in order, shape (N,).
        poses: x and y in metres and yaw in radians, shape (N, 3); NaN where unknown.
    """

    def __init__(self, seconds: NDArray[np.float64], poses: NDArray[np.float64]) -> None:
        self.seconds, self.poses = seconds, poses
        x, y, yaw = poses.T
        # Points whose Euclidean distances are the distances of the poses.
        self._points = np.array([x, y, np.cos(yaw), np.sin(yaw)])

    def seen_from(self, origin: Pose) -> Places:
        """Return the same places in another frame, in which ``origin`` is the pose of their frame."""
        return Places(self.seconds, np.stack(origin.offset(*self.poses.T), axis=1))

    def nearest(self, to: Places) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the times at which the robot was nearest to each of some places, and its distances; NaN if unknown.

        If several times are equally near, the first counts. Drives of an hour take some seconds to compute.
        """
        seconds, apart = np.full((2, len(to.seconds)), np.nan)
        known = np.isfinite(self._points).all(axis=0)
        points, times = self._points.compress(known, axis=1), self.seconds[known]
        for i in np.flatnonzero(np.isfinite(to._points).all(axis=0) & known.any()):
            squares = ((points - to._points[:, i, None]) ** 2).sum(axis=0)
            row = squares.argmin()
            seconds[i], apart[i] = times[row], np.sqrt(squares[row])
        return seconds, apart


def to_place(name: str, value: Any) -> Pose:
    """Return a pose from three numbers; raise TypeError or ValueError for anything else."""
    try:
        x, y, yaw = value
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected x and y in metres and yaw in radians, got {repr(value)[:60]}") from None
    x, y = finite(name, x, "metres"), finite(name, y, "metres")
    return Pose(x, y, finite(name, to_radians(name, yaw), "radians"))

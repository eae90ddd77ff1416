"""An item of a map from one message: a pose, poses, a path, a scan or a grid."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite, nan
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .age import HasAge
from .map_grid import MapGrid
from .pose import Pose

MapKind = Literal["pose", "goal", "poses", "path", "scan", "cone", "grid"]

SENSED = ("scan", "cone")
"""Items that a robot senses. They say less about the frame of the floor than items with a place on it."""

NOWHERE = Pose(nan, nan, nan)


NO_FIX = (nan, nan, nan)


class Scatter(NamedTuple):
    """The uncertainty of a place: the covariance of x and y, in square metres."""

    xx: float
    xy: float
    yy: float


@dataclass(frozen=True, eq=False)
class MapItem(HasAge):
    """The content of one message on a map, in the frame that the message names.

    Args:
        kind: the kind of item.
        frame_id: its coordinate frame, or empty if the message does not name one.
        stamp_ns: nanoseconds since the epoch, or None.
        pose: for a pose, the pose; for a cone, the pose of its sensor. NaN if unknown, or if the cone met nothing.
        scatter: for a pose, its uncertainty, or None if unknown.
        points: for a path or a scan, x and y in metres, shape (N, 2); for a cone, its sensor and then its arc; for
            poses, x, y and yaw, shape (N, 3).
        grid: for a grid, the grid.
        fix: for a satellite receiver, latitude and longitude in degrees and altitude in metres, or `NO_FIX` while it
            has no fix.
        child_frame_id: for odometry, the frame that the pose belongs to, or empty if the message does not name one.
    """

    kind: MapKind
    frame_id: str = ""
    stamp_ns: int | None = None
    pose: Pose = NOWHERE
    scatter: Scatter | None = None
    points: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
    grid: MapGrid | None = None
    fix: tuple[float, float, float] | None = None
    child_frame_id: str = ""

    @property
    def is_nowhere(self) -> bool:
        """True for an unknown pose: its frame says nothing about a map."""
        return self.kind == "pose" and not (isfinite(self.pose.x) and isfinite(self.pose.y))

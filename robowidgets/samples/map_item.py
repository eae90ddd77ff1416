"""What a map shows of one message: a pose, poses, a path, a scan or a grid."""

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
"""What is seen from a robot: it tells less of the frame of the floor than what has a place on it."""

NOWHERE = Pose(nan, nan, nan)


NO_FIX = (nan, nan, nan)


class Scatter(NamedTuple):
    """How sure a place is: the covariance of x and y, in square metres."""

    xx: float
    xy: float
    yy: float


@dataclass(frozen=True, eq=False)
class MapItem(HasAge):
    """What a map shows of one message, in the frame that it names.

    Args:
        kind: what it is.
        frame_id: its coordinate frame; empty: the message names none.
        stamp_ns: nanoseconds since the epoch, or None.
        pose: of a pose, that; of a cone, where its sensor is; NaN where it is not known, or the cone met nothing.
        scatter: of a pose, how sure it is; None: not known.
        points: shape (N, 2), of a path or a scan: x and y in metres; of a cone, its sensor
            and then its arc; (N, 3) of poses: their yaw, too.
        grid: of a grid, that.
        fix: of a satellite receiver, its latitude and longitude in degrees and its altitude in metres; `NO_FIX` while
            it has none.
        child_frame_id: of odometry, the frame whose pose it is; empty: the message names none.
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
        """True for a pose that is not known: its frame says nothing about a map."""
        return self.kind == "pose" and not (isfinite(self.pose.x) and isfinite(self.pose.y))

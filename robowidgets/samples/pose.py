"""Where a robot is on the floor."""

from __future__ import annotations

from math import cos, sin
from typing import Any, NamedTuple

import numpy as np


class Pose(NamedTuple):
    """A pose on the floor: metres in the frame of a world, yaw in radians, counter-clockwise from x, within +-pi.

    NaN means that there is no value.
    """

    x: float
    y: float
    yaw: float

    def offset(self, forward: float, left: float, turn: float) -> Pose:
        """The pose so many metres ahead of this one and to its left, turned by radians; the yaw is not wrapped."""
        ahead_x, ahead_y = cos(self.yaw), sin(self.yaw)
        x = self.x + forward * ahead_x - left * ahead_y
        return Pose(x, self.y + forward * ahead_y + left * ahead_x, self.yaw + turn)


def yaw_of(x: Any, y: Any, z: Any, w: Any) -> Any:
    """Radians by which quaternions of any length turn on the floor; NaN for those of length 0. Numbers or arrays."""
    with np.errstate(over="ignore", invalid="ignore"):  # of damaged numbers, which turn into NaN
        yaw = np.arctan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)
        return np.where(x * x + y * y + z * z + w * w > 0, yaw, np.nan)

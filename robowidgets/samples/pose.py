"""The pose of a robot on the floor."""

from __future__ import annotations

from math import cos, sin
from typing import Any, NamedTuple

import numpy as np


class Pose(NamedTuple):
    """A pose on the floor: metres in a fixed frame, yaw in radians, counter-clockwise from x, within +-pi.

    NaN means no value.
    """

    x: float
    y: float
    yaw: float

    def offset(self, forward: float, left: float, turn: float) -> Pose:
        """Return this pose moved forward and left by metres, and turned by radians; the yaw is not wrapped."""
        ahead_x, ahead_y = cos(self.yaw), sin(self.yaw)
        x = self.x + forward * ahead_x - left * ahead_y
        return Pose(x, self.y + forward * ahead_y + left * ahead_x, self.yaw + turn)


def yaw_of(x: Any, y: Any, z: Any, w: Any) -> Any:
    """Return the yaw of quaternions of any length in radians, or NaN for length 0. Takes numbers or arrays."""
    with np.errstate(over="ignore", invalid="ignore"):  # damaged numbers become NaN
        yaw = np.arctan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)
        return np.where(x * x + y * y + z * z + w * w > 0, yaw, np.nan)

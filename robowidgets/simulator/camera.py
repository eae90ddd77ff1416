"""What a camera on the simulated robot sees: walls and obstacles in plain colours."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..camera import CameraModel
from ..samples import CameraInfo, Pose
from ._raycast import cast_rays
from .world import World

WALL, OBSTACLE = 1.2, 0.6
"""Metres; how high walls and obstacles are."""

_FLOOR, _SKY = (176, 168, 156), (226, 232, 238)
_OF_WALLS, _OF_OBSTACLES = np.array([214.0, 206.0, 192.0]), np.array([92.0, 140.0, 178.0])

_FADES = 6.0
"""Metres at which colours are half as bright."""


def picture(world: World, pose: Pose, camera_info: CameraInfo, height: float = 0.3) -> NDArray[np.uint8]:
    """What a level camera sees of a room, shape (rows, columns, 3), red, green and blue.

    Args:
        world: the room.
        pose: where the camera is, and where it looks.
        camera_info: its calibration. It sees without distortion.
        height: metres above the floor.

    Raises:
        ValueError: the camera is not calibrated.

    Examples:
        >>> from robowidgets.simulator import picture, room
        >>> info = CameraInfo(64, 48, [50, 0, 31.5, 0, 50, 23.5, 0, 0, 1])
        >>> picture(room("house"), Pose(2.0, 2.0, 0.0), info).shape
        (48, 64, 3)
    """
    model = CameraModel(camera_info, rectified=True)
    width, rows = model.size
    aside = (np.arange(width) - model.middle[0]) / model.focus[0]
    row = np.arange(rows)[:, None]
    shown = np.where(row[..., None] > model.middle[1], np.array(_FLOOR), np.array(_SKY)).astype(np.float64)
    shown = np.broadcast_to(shown, (rows, width, 3)).copy()
    walls, obstacles = cast_rays(world, pose.x, pose.y, pose.yaw - np.arctan(aside))
    for far, top, color in ((walls, WALL, _OF_WALLS), (obstacles, OBSTACLE, _OF_OBSTACLES)):
        ahead = np.maximum(far / np.hypot(1.0, aside), 1e-3)
        nearer = far < walls if top == OBSTACLE else np.isfinite(far)
        with np.errstate(all="ignore"):
            upper = model.middle[1] - model.focus[1] * (top - height) / ahead
            lower = model.middle[1] + model.focus[1] * height / ahead
        bright: Any = 1.0 / (1.0 + ahead / _FADES)
        is_in = (row >= upper) & (row <= lower) & nearer
        shown = np.where(is_in[..., None], color * bright[:, None], shown)
    return shown.astype(np.uint8)

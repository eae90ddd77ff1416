"""The camera of the simulated robot, with pictures of walls and obstacles in plain colours, and depth images."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, radians, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..camera import CameraModel
from ..samples import CameraInfo, Image, Pose
from ..samples.checks import finite, to_radians
from ._raycast import cast_rays
from .world import World, to_pose

WALL, OBSTACLE = 1.2, 0.6
"""The heights of walls and obstacles in metres."""

SCANNER_UP = 0.2
"""The height of the scanner above the floor in metres, on a robot with a camera."""

_FLOOR, _SKY = (176, 168, 156), (226, 232, 238)
_OF_WALLS, _OF_OBSTACLES = np.array([214.0, 206.0, 192.0]), np.array([92.0, 140.0, 178.0])

_FADES = 6.0
"""The distance in metres at which colours are half as bright."""

_MOST_ACROSS = 4096
_FARTHEST = 65.5
"""The largest distance in metres that fits in a depth image in millimetres."""


@dataclass(frozen=True)
class Camera:
    """A level camera on the robot, with pictures and depth images without noise.

    Args:
        width, height: the size of its pictures in pixels.
        field_of_view: radians from the left of a picture to its right, or degrees as text (``"70deg"``).
        mount: (x, y, yaw) of the camera on the robot, metres and radians.
        up: the height above the floor in metres.
        rate: pictures per second.
        frame_id: the optical frame of the camera.

    Raises:
        TypeError: something is not a number.
        ValueError: a value is out of range.

    Examples:
        >>> round(Camera(field_of_view="90deg").info.k[0])
        160
    """

    width: int = 320
    height: int = 240
    field_of_view: float = radians(70)
    mount: tuple[float, float, float] = (0.0, 0.0, 0.0)
    up: float = 0.3
    rate: float = 5.0
    frame_id: str = "camera_optical_frame"

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            value = getattr(self, name)
            if not isinstance(value, int):
                raise TypeError(f"{name}: expected a whole number of pixels, got {value!r}")
            if not 2 <= value <= _MOST_ACROSS:
                raise ValueError(f"{name}: expected 2 to {_MOST_ACROSS} pixels, got {value}")
        opening = finite("field_of_view", to_radians("field_of_view", self.field_of_view), "radians")
        object.__setattr__(self, "field_of_view", opening)
        if not 0 < opening < pi:
            raise ValueError(f"field_of_view: expected radians above 0 and below pi, got {opening!r}")
        object.__setattr__(self, "mount", to_pose("mount", self.mount))
        if finite("up", self.up, "metres") <= 0:
            raise ValueError(f"up: expected metres above 0, got {self.up!r}")
        if not 0 < finite("rate", self.rate, "pictures per second") <= 1000:
            raise ValueError(f"rate: expected pictures per second, above 0 and at most 1000, got {self.rate!r}")

    @property
    def info(self) -> CameraInfo:
        """Its calibration, without distortion."""
        focus = self.width / 2 / tan(self.field_of_view / 2)
        k = np.array([focus, 0, (self.width - 1) / 2, 0, focus, (self.height - 1) / 2, 0, 0, 1])
        p = np.insert(k.reshape(3, 3), 3, 0, axis=1)
        return CameraInfo(self.width, self.height, k, np.zeros(5), np.eye(3), p, "plumb_bob", frame_id=self.frame_id)

    def see(self, world: World, robot: Pose, stamp_ns: int | None = None) -> tuple[Image, Image]:
        """Return the picture and the depth image in millimetres, taken with the robot at a pose."""
        colors, metres = _seen(world, robot.offset(*self.mount), self.info, self.up)
        depth = np.round(1000 * np.where(metres < _FARTHEST, metres, 0.0)).astype(np.uint16)
        return (
            Image(colors, "rgb8", stamp_ns, self.frame_id, step=3 * self.width),
            Image(depth, "16UC1", stamp_ns, self.frame_id, depth_scale=0.001, step=2 * self.width),
        )


def picture(world: World, pose: Pose, camera_info: CameraInfo, height: float = 0.3) -> NDArray[np.uint8]:
    """Return the picture of a room by a level camera, shape (rows, columns, 3), red, green and blue.

    Args:
        world: the room.
        pose: the position of the camera, and the direction in which it looks.
        camera_info: its calibration. Distortion is ignored.
        height: the height of the camera above the floor in metres.

    Raises:
        ValueError: the camera is not calibrated.

    Examples:
        >>> from robowidgets.simulator import picture, room
        >>> info = CameraInfo(64, 48, [50, 0, 31.5, 0, 50, 23.5, 0, 0, 1])
        >>> picture(room("house"), Pose(2.0, 2.0, 0.0), info).shape
        (48, 64, 3)
    """
    return _seen(world, pose, camera_info, height)[0]


def _seen(
    world: World, pose: Pose, camera_info: CameraInfo, height: float
) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """Return the colours of all pixels, and their depths in metres along the direction of view, inf for the sky."""
    model = CameraModel(camera_info, rectified=True)
    width, rows = model.size
    aside = (np.arange(width) - model.middle[0]) / model.focus[0]
    row = np.arange(rows)[:, None]
    below = (row - model.middle[1]) / model.focus[1]
    is_floor = below > 0
    shown: Any = np.where(is_floor[..., None], np.array(_FLOOR), np.array(_SKY)).astype(np.float64)
    shown = np.broadcast_to(shown, (rows, width, 3))
    metres = np.broadcast_to(np.where(is_floor, height / np.where(is_floor, below, 1.0), np.inf), (rows, width))
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
        metres = np.where(is_in, ahead, metres)
    return shown.astype(np.uint8), metres

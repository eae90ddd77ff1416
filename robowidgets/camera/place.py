"""The poses of the sensors of a robot in the frame of its camera."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..poses.frame_tree import Poses
from ..poses.live_frames import Frames, joined
from ..poses.mounts import ROBOT
from ..samples.checks import finite, in_radians

FIXED = "odom"
"""The fixed frame in which the robot moves without jumps (REP-105)."""

GROUND = tuple(reversed(ROBOT))
"""Frames whose z is taken as 0 on the ground, base_footprint first (REP-120)."""

_OPTICAL = np.array([[-0.5, 0.5, -0.5, 0.5]])
"""The orientation of an optical frame, with z ahead, in a body frame, with x ahead."""


class NoTransformError(ValueError):
    """No transform joins two frames."""


def place_in_camera(
    frames: Frames, frame: str, camera: str, *, when: tuple[int, int | None], then: tuple[int, int | None]
) -> Poses:
    """Return the pose of a sensor's frame in the frame of a camera.

    If both are joined to odom, each pose is taken at its own time, so that driving between both times is corrected.

    Args:
        frames: the frames of the robot.
        frame: the frame of the sensor.
        camera: the optical frame of the camera.
        when: log time and stamp of the measurement in nanoseconds.
        then: log time and stamp of the picture in nanoseconds.

    Raises:
        NoTransformError: no transform joins the two frames; the text names them.
    """
    for name, what in ((frame, "sensor"), (camera, "picture")):
        if not name:
            raise NoTransformError(f"no tf for a {what} without a frame_id; set it in the driver")
    world = FIXED if FIXED in frames.chain(frame) and FIXED in frames.chain(camera) else None
    sensor = joined(frames, frame, world or camera, *_times(*when))
    if sensor is None:
        raise NoTransformError(f"no tf from {frame} to {camera}")
    if world is None:
        return sensor
    return frames.poses(camera, world, *_times(*then)).inverse().of(sensor)


def ground_frame(frames: Frames, frame: str) -> str:
    """Return the frame of the ground above another frame, or an empty text if tf has none."""
    chain = frames.chain(frame)
    return next((name for name in GROUND if name in chain), "")


def pose_by_hand(pose: Sequence[Any]) -> Poses:
    """Return the pose of a sensor's frame in the frame of a camera, from the camera's pose that the user measured.

    Args:
        pose: the camera in the frame of the sensor: x, y and z in metres, then roll, pitch and yaw in radians or as
            "20deg", for a camera that looks along x; a pitch above 0 looks down (REP-103).

    Raises:
        TypeError: these are not six numbers. ValueError: one is not finite.
    """
    if isinstance(pose, (str, bytes)) or not isinstance(pose, Sequence) or len(pose) != 6:
        raise TypeError(f"camera_pose: expected x, y, z, roll, pitch and yaw, got {pose!r}")
    place = [finite(f"camera_pose {name}", value, "metres") for name, value in zip("xyz", pose, strict=False)]
    names = ("roll", "pitch", "yaw")
    roll, pitch, yaw = (in_radians(f"camera_pose {n}", v) / 2 for n, v in zip(names, pose[3:], strict=True))
    turns = [
        Poses(np.zeros((1, 3)), np.array([[*(np.sin(half) * np.eye(3)[axis]), np.cos(half)]]))
        for axis, half in ((2, yaw), (1, pitch), (0, roll))
    ]
    body = Poses(np.array([place]), np.array([[0.0, 0.0, 0.0, 1.0]]))
    for turn in turns:
        body = body.of(turn)
    return body.of(Poses(np.zeros((1, 3)), _OPTICAL)).inverse()


def _times(time_ns: int, stamp_ns: int | None) -> tuple[Any, Any]:
    return np.array([time_ns], np.int64), np.array([stamp_ns or 0], np.int64)

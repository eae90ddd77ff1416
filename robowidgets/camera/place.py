"""Where the sensors of a robot are, seen from its camera."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..poses.frame_tree import Poses
from ..poses.live_frames import Frames, joined
from ..poses.mounts import ROBOT
from ..samples.checks import finite, in_radians

FIXED = "odom"
"""The frame that stands still while the robot moves, without jumps (REP-105)."""

GROUND = tuple(reversed(ROBOT))
"""Frames whose z is 0 on the ground, the one that lies there first (REP-120)."""

_OPTICAL = np.array([[-0.5, 0.5, -0.5, 0.5]])
"""How a camera's frame, with z ahead, is turned in a body's, with x ahead."""


class NoTransformError(ValueError):
    """Nothing joins two frames."""


def place_in_camera(
    frames: Frames, frame: str, camera: str, *, when: tuple[int, int | None], then: tuple[int, int | None]
) -> Poses:
    """The pose of a sensor's frame in that of a camera.

    If both are joined to odometry, each is where it was at its own time, however far the robot drove between both.

    Args:
        frames: the frames of the robot.
        frame: of the sensor.
        camera: of the camera, the optical one.
        when: log time and stamp in nanoseconds at which the sensor measured.
        then: those of the picture.

    Raises:
        NoTransformError: nothing joins the two; the text names them.
    """
    for name, what in ((frame, "sensor"), (camera, "picture")):
        if not name:
            raise NoTransformError(f"no tf for a {what} without a frame_id")
    world = FIXED if FIXED in frames.chain(frame) and FIXED in frames.chain(camera) else None
    sensor = joined(frames, frame, world or camera, *_times(*when))
    if sensor is None:
        raise NoTransformError(f"no tf from {frame} to {camera}")
    if world is None:
        return sensor
    return frames.poses(camera, world, *_times(*then)).inverse().of(sensor)


def ground_frame(frames: Frames, frame: str) -> str:
    """The frame of the ground above another one; empty: tf has none."""
    chain = frames.chain(frame)
    return next((name for name in GROUND if name in chain), "")


def pose_by_hand(pose: Sequence[Any]) -> Poses:
    """The pose of a sensor's frame in that of a camera, of the camera's place as a person measures it.

    Args:
        pose: the camera in the frame of the sensor: x, y and z in metres, then roll, pitch and yaw in radians or as
            "20deg", of a camera that looks along x; a pitch above 0 looks down (REP-103).

    Raises:
        TypeError: not six numbers. ValueError: one is not finite.
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

"""The poses of sensors on a robot, by its transforms."""

from __future__ import annotations

from collections.abc import Iterable
from math import acos

import numpy as np

from ..samples import Mount, Pose, yaw_of
from ..samples.mount import MOST_TILT
from .frame_tree import Poses
from .live_frames import Frames
from .transforms import Transform

ROBOT = ("base_link", "base_footprint")
"""Names of the robot's frame, the usual one first (REP-105)."""

ODOM = "odom"
"""The fixed frame in which a robot moves without jumps (REP-105)."""


_AHEAD = Poses(np.zeros((1, 3)), np.array([[0.5, -0.5, 0.5, 0.5]]))
"""The pose of a frame with x ahead in the optical frame of a camera, which has z ahead (REP-103)."""


def robot_frame(frames: Frames, frame: str) -> str:
    """Return the robot's frame above the frame of a sensor: by name, else the frame below odom, else an empty text.

    Names of frames may begin with the namespace of a robot: ``"robot1/base_link"``.
    """
    above = frames.chain(frame)[1:]
    plain = [name.rpartition("/")[2] for name in above]
    named = next((name for name in (*ROBOT, ODOM) if name in plain), "")
    at = plain.index(named) if named else 0
    return (above[at] if named in ROBOT else above[at - 1] if at else "") if named else ""


def scanner_mount(frames: Frames, frame_id: str, time_ns: int = 0, stamp_ns: int | None = None) -> Mount | None:
    """Return the mount of a scanner by tf, or None if tf does not contain it.

    Args:
        frames: the frames of the robot.
        frame_id: the frame of the scanner.
        time_ns: the log time of the scan.
        stamp_ns: the stamp of the scan.
    """
    frame = frame_id.lstrip("/")
    if not frame:
        return None
    if len(frames.chain(frame)) == 1:
        # Scans from a depth image are in the camera's frame with x ahead, which tf may not have.
        optical = (f"{frame}_optical", frame.replace("_frame", "_optical_frame"))
        frame = next((name for name in optical if len(frames.chain(name)) > 1), frame)
    if frame.rpartition("/")[2] in ROBOT:
        return Mount()
    base = robot_frame(frames, frame)
    if not base:
        return None
    at = frames.poses(frame, base, np.array([time_ns], np.int64), np.array([stamp_ns or 0], np.int64))
    at = at.of(_AHEAD) if "_optical" in frame else at
    return mount_of(*at.orientations[0].tolist())


def mount_of(x: float, y: float, z: float, w: float) -> Mount:
    """Return the mount of a scanner by its orientation on the robot, a quaternion of length 1."""
    up = max(-1.0, min(1.0, 1 - 2 * (x * x + y * y)))
    tilt = acos(abs(up))
    if tilt > MOST_TILT:
        return Mount(tilt=tilt)
    return Mount(float(yaw_of(x, y, z, w)), up < 0, tilt=tilt)


def mounts_of(transforms: Iterable[Transform]) -> dict[str, Pose]:
    """Return the pose on the robot, seen from above, of each frame that static transforms join to the robot.

    Args:
        transforms: transforms of the robot. Only static ones count, and the last one of each frame.
    """
    parents = {one.child: (one.parent, _seen_from_above(one)) for one in transforms if one.static}
    found = {child: _get_pose(child, parents) for child in parents}
    return {child: pose for child, pose in found.items() if pose is not None}


def _get_pose(frame: str, parents: dict[str, tuple[str, Pose]]) -> Pose | None:
    """Return the pose of a frame in the robot's frame, or None if the latter is not an ancestor."""
    robot = next((name for name in ROBOT if name in _get_ancestry(frame, parents)), None)
    if robot is None:
        return None
    pose = Pose(0.0, 0.0, 0.0)
    while frame != robot:
        frame, mount = parents[frame]
        pose = mount.offset(*pose)
    return pose


def _get_ancestry(frame: str, parents: dict[str, tuple[str, Pose]]) -> list[str]:
    line = [frame]
    while frame in parents and parents[frame][0] not in line:
        frame = parents[frame][0]
        line.append(frame)
    return line


def _seen_from_above(one: Transform) -> Pose:
    x, y, _, *orientation = one.pose
    return Pose(x, y, float(yaw_of(*orientation)))

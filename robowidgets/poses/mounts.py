"""Where the sensors of a robot are mounted, by its static transforms."""

from __future__ import annotations

from collections.abc import Iterable

from ..samples import Pose, yaw_of
from .transforms import Transform

ROBOT = ("base_link", "base_footprint")
"""Names of the frame of the robot, the usual one first (REP-105)."""


def mounts_of(transforms: Iterable[Transform]) -> dict[str, Pose]:
    """The pose of each frame on the robot, seen from above; without those that no static transforms lead to.

    Args:
        transforms: those of the robot; only static ones count, of each frame the last one.
    """
    parents = {one.child: (one.parent, _seen_from_above(one)) for one in transforms if one.static}
    found = {child: _pose_of(child, parents) for child in parents}
    return {child: pose for child, pose in found.items() if pose is not None}


def _pose_of(frame: str, parents: dict[str, tuple[str, Pose]]) -> Pose | None:
    """The pose of a frame in that of the robot; None if none of its parents is one, or they lead in a circle."""
    robot = next((name for name in ROBOT if name in _line_of(frame, parents)), None)
    if robot is None:
        return None
    pose = Pose(0.0, 0.0, 0.0)
    while frame != robot:
        frame, mount = parents[frame]
        pose = mount.offset(*pose)
    return pose


def _line_of(frame: str, parents: dict[str, tuple[str, Pose]]) -> list[str]:
    line = [frame]
    while frame in parents and parents[frame][0] not in line:
        frame = parents[frame][0]
        line.append(frame)
    return line


def _seen_from_above(one: Transform) -> Pose:
    x, y, _, *orientation = one.pose
    return Pose(x, y, float(yaw_of(*orientation)))

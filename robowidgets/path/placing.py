"""The place of messages in the frame of a map."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import cos, isfinite, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..poses.frame_tree import Poses
from ..poses.live_frames import Frames, are_joined, joined
from ..poses.local_plane import LocalPlane
from ..samples import MapGrid, Pose, yaw_of
from ..samples.map_item import NOWHERE, SENSED, MapItem, Scatter

Floats = NDArray[np.float64]

EAST_NORTH = "east, north of the first fix"
"""The frame of satellite receivers, which tf does not join to others."""

MAP = "map"
"""The frame of the floor (REP-105), which may have the parent "earth"."""

MOST_POINTS = 2000
"""The most points to draw of a path, a scan or an array of poses; of more, every second, third, and so on."""


class Placed(NamedTuple):
    """The content of a layer at a time, in the frame of the map.

    ``pose`` is the pose, or the corner of a grid, or NaN for other items. ``points`` have shape (N, 2), or (N, 3) with
    yaw, and are every ``total / N``-th point of the ``total`` points in the message. ``version`` is the version of a
    large grid, which the page gets once, or 0.
    """

    number: int
    seconds: float
    pose: Pose
    scatter: Scatter | None
    points: Floats
    total: int
    grid: MapGrid | None
    version: int = 0


def place(frames: Frames, world: str, item: MapItem, time_ns: int, number: int, seconds: float) -> Placed | None:
    """Return an item in the frame ``world``, by the transform at its stamp, or None if no transform joins both.

    An item without a frame is taken as in ``world``.
    """
    count = len(item.points)
    points = item.points[:: -(-count // MOST_POINTS)] if count > MOST_POINTS else item.points
    if len(points) < count and item.kind == "path":
        points = np.vstack([points[:-1], item.points[-1:]])
    pose = item.grid.origin if item.grid else item.pose
    if not item.frame_id or item.frame_id == world:
        return Placed(number, seconds, pose, item.scatter, points, count, item.grid)
    at = _joined(frames, item.frame_id, world, time_ns, item.stamp_ns)
    if at is None:
        return None
    return Placed(
        number, seconds, _moved(at, pose), _turned(at, item.scatter), _all_moved(at, points), count, item.grid
    )


def pose_of_frame(frames: Frames, frame: str, world: str, time_ns: int, stamp_ns: int | None) -> Pose | None:
    """Return the pose of a frame in another, or None if no transform joins them."""
    at = _joined(frames, frame, world, time_ns, stamp_ns)
    return None if at is None else _moved(at, Pose(0.0, 0.0, 0.0))


def _joined(frames: Frames, frame: str, world: str, time_ns: int, stamp_ns: int | None) -> Poses | None:
    return joined(frames, frame, world, np.array([time_ns], np.int64), np.array([stamp_ns or 0], np.int64))


def poses_in(
    frames: Frames, frame: str, world: str, times_ns: NDArray[np.int64], stamps_ns: NDArray[np.int64], poses: Floats
) -> Floats | None:
    """Return poses, shape (N, 3), in the frame of a map, each by its stamp, or None if no transform joins both."""
    if not frame or frame == world:
        return poses
    at = joined(frames, frame, world, times_ns, stamps_ns)
    return None if at is None else _moved_each(at, poses)


def by_plane(item: MapItem, plane: LocalPlane | None) -> tuple[MapItem, LocalPlane | None]:
    """Return a fix in metres east and north of the first fix, and the plane at that; other items stay as they are."""
    if item.fix is None:
        return item, plane
    if not isfinite(item.fix[0]):
        return replace(item, frame_id=EAST_NORTH), plane
    plane = plane or LocalPlane(*item.fix)
    return replace(item, frame_id=EAST_NORTH, pose=Pose(*plane.east_north(*item.fix), NOWHERE.yaw)), plane


def frame_of_map(frames: Frames, items: Iterable[MapItem]) -> str:
    """Return the frame of a map: "map" if it is above the first grid, else above the first layer, else the root."""
    found = list(items)
    named = [item for item in found if item.frame_id and item.frame_id != EAST_NORTH]
    if len(named) < len(found) and all(item.frame_id == EAST_NORTH for item in found if item.kind not in SENSED):
        return EAST_NORTH
    # A sensed item, such as a scan, says less about the frame of the floor than a pose, a path or a grid.
    first = min(named, key=lambda item: (item.kind in SENSED, item.kind != "grid"), default=None)
    if first is None:
        return ""
    chain = frames.chain(first.frame_id)
    return MAP if MAP in chain else chain[-1]


def worlds_of_map(frames: Frames, items: Iterable[MapItem], asked: str = "") -> list[str]:
    """Return the frames of separate maps: first the requested or found frame of the main map.

    Then come the roots of items that no transform joins to the frames before. Sensed items do not make a map.
    """
    found = list(items)
    worlds = [asked or frame_of_map(frames, found)]
    for item in found:
        if item.kind not in SENSED and world_of(frames, worlds, item.frame_id) is None:
            worlds.append(frames.chain(item.frame_id)[-1])
    return worlds


def world_of(frames: Frames, worlds: Sequence[str], frame: str) -> str | None:
    """Return the first of the maps' frames that a frame is joined to, or None. An empty frame counts as the first."""
    if not frame:
        return worlds[0]
    return next((world for world in worlds if are_joined(frames, frame, world)), None)


def _moved(at: Poses, pose: Pose) -> Pose:
    (row,) = _moved_each(at, np.array([pose]))
    return Pose(*row.tolist())


def _all_moved(at: Poses, points: Floats) -> Floats:
    if not len(points):
        return points
    n, columns = points.shape
    rows = points if columns == 3 else np.column_stack([points, np.zeros(n)])
    return _moved_each(Poses(*(np.repeat(column, n, axis=0) for column in at)), rows)[:, :columns]


def _moved_each(at: Poses, rows: Floats) -> Floats:
    """Return poses x, y and yaw, shape (N, 3), each moved by the pose of the same index; an unknown yaw stays NaN."""
    yaw = rows[:, 2]
    zero = np.zeros(len(rows))
    half = np.nan_to_num(yaw) / 2
    inner = Poses(np.column_stack([rows[:, :2], zero]), np.column_stack([zero, zero, np.sin(half), np.cos(half)]))
    positions, turns = at.of(inner)
    return np.column_stack([positions[:, :2], np.where(np.isnan(yaw), yaw, yaw_of(*turns.T))])


def _turned(at: Poses, scatter: Scatter | None) -> Scatter | None:
    if scatter is None:
        return None
    yaw = float(yaw_of(*at.orientations[0]))
    turn = np.array([[cos(yaw), -sin(yaw)], [sin(yaw), cos(yaw)]])
    (xx, xy), (_, yy) = turn @ np.array([[scatter.xx, scatter.xy], [scatter.xy, scatter.yy]]) @ turn.T
    return Scatter(float(xx), float(xy), float(yy))

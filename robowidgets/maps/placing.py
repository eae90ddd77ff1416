"""Where what a message tells is in the frame of a map."""

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
"""The frame of what a satellite receiver tells: nothing in tf joins it."""

MAP = "map"
"""The frame of the floor (REP-105), which may have a parent: the earth."""

MOST_POINTS = 2000
"""Points of a path, a scan or an array of poses that are drawn; of more, every second, every third, and so on."""


class Placed(NamedTuple):
    """What a layer shows at a time, in the frame of the map.

    ``pose`` is that of a pose, or of the corner of a grid; NaN where there is none. ``points`` have shape (N, 2), or
    (N, 3) with their yaw; of ``total`` points of the message every ``total / N``-th is there. ``version`` is that of a
    large grid, which the page gets once; 0: it has none.
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
    """An item in the frame ``world``, by the transform at its own stamp; None: nothing joins both.

    One that names no frame is taken as of ``world``.
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
    """Where a frame is in another one; None: nothing joins them."""
    at = _joined(frames, frame, world, time_ns, stamp_ns)
    return None if at is None else _moved(at, Pose(0.0, 0.0, 0.0))


def _joined(frames: Frames, frame: str, world: str, time_ns: int, stamp_ns: int | None) -> Poses | None:
    return joined(frames, frame, world, np.array([time_ns], np.int64), np.array([stamp_ns or 0], np.int64))


def poses_in(
    frames: Frames, frame: str, world: str, times_ns: NDArray[np.int64], stamps_ns: NDArray[np.int64], poses: Floats
) -> Floats | None:
    """Poses of a frame, shape (N, 3), in the frame of a map, each at its own stamp; None: nothing joins them."""
    if not frame or frame == world:
        return poses
    at = joined(frames, frame, world, times_ns, stamps_ns)
    return None if at is None else _moved_each(at, poses)


def by_plane(item: MapItem, plane: LocalPlane | None) -> tuple[MapItem, LocalPlane | None]:
    """A fix as metres east and north of the first one, which it is where there was none; other items as they are."""
    if item.fix is None:
        return item, plane
    if not isfinite(item.fix[0]):
        return replace(item, frame_id=EAST_NORTH), plane
    plane = plane or LocalPlane(*item.fix)
    return replace(item, frame_id=EAST_NORTH, pose=Pose(*plane.east_north(*item.fix), NOWHERE.yaw)), plane


def frame_of_map(frames: Frames, items: Iterable[MapItem]) -> str:
    """The frame in which a map is drawn: of those above the first grid, else the first layer, "map", else the root."""
    found = list(items)
    named = [item for item in found if item.frame_id and item.frame_id != EAST_NORTH]
    if len(named) < len(found) and all(item.frame_id == EAST_NORTH for item in found if item.kind not in SENSED):
        return EAST_NORTH
    # A scan or a costmap that rolls along with the robot tells less than what names the frame of the floor.
    first = min(named, key=lambda item: (item.kind in SENSED, item.kind != "grid"), default=None)
    if first is None:
        return ""
    chain = frames.chain(first.frame_id)
    return MAP if MAP in chain else chain[-1]


def worlds_of_map(frames: Frames, items: Iterable[MapItem], asked: str = "") -> list[str]:
    """The frames in which a map is drawn, each a map of its own: first the one asked for, or found.

    Then come the roots of the frames of what nothing joins to those before. What is sensed alone is no map.
    """
    found = list(items)
    worlds = [asked or frame_of_map(frames, found)]
    for item in found:
        if item.kind not in SENSED and world_of(frames, worlds, item.frame_id) is None:
            worlds.append(frames.chain(item.frame_id)[-1])
    return worlds


def world_of(frames: Frames, worlds: Sequence[str], frame: str) -> str | None:
    """The first of the frames of a map to which a frame is joined; None: none is. No name is taken as the first."""
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
    """Poses x, y and yaw, shape (N, 3), each moved by one of as many; a yaw that is not known stays so."""
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

"""Ray casting: distances to walls and obstacles, for all rays at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .world import World

Floats = NDArray[np.float64]
_TOUCH = 1e-9
"""Metres by which a ray may miss the end of a wall and still hit it, so that corners have no gap."""


def cast_rays(world: World, x: float, y: float, angles: Floats) -> tuple[Floats, Floats]:
    """Distance to the nearest wall and to the nearest obstacle along each ray.

    Args:
        world: the walls and obstacles.
        x: start of the rays, metres.
        y: start of the rays, metres.
        angles: R directions in the world's frame, radians.

    Returns:
        Two arrays of shape (R,), metres; inf if nothing is hit, 0 for an obstacle that contains the start. A wall
        seen exactly edge-on has no width and is not hit.
    """
    directions = np.vstack((np.cos(angles), np.sin(angles)))
    with np.errstate(divide="ignore"):
        walls = 1.0 / _nearness_of_walls(world, x, y, directions)
        obstacles = 1.0 / _nearness_of_obstacles(world, x, y, directions)
    return walls, obstacles


def _nearness_of_walls(world: World, x: float, y: float, directions: Floats) -> Floats:
    """1 / distance to each wall: along a ray d the line n.p = c has the distance c / n.d, and products are cheap.

    A ray hits the wall, and not only its line, if it points between the two ends.
    """
    start, end = world.walls[:, :2] - (x, y), world.walls[:, 2:] - (x, y)
    away = start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]
    turn = np.where(away < 0, -1.0, 1.0)
    edge = (end - start) * turn[:, None]
    length = np.hypot(edge[:, 0], edge[:, 1])
    seen = np.abs(away) > _TOUCH * length
    normal_over_distance = _across(edge)[seen] / np.abs(away[seen])[:, None]
    after_start = (-_across(start) * turn[:, None])[seen] @ directions
    before_end = (_across(end) * turn[:, None])[seen] @ directions
    between = np.minimum(after_start, before_end) >= -_TOUCH
    nearness = np.where(between, normal_over_distance @ directions, 0.0)
    return np.asarray(nearness.max(axis=0, initial=0.0))


def _nearness_of_obstacles(world: World, x: float, y: float, directions: Floats) -> Floats:
    """1 / distance to the near side of each disc, from the equation |t d - c| = r."""
    centre, radius = world.obstacles[:, :2] - (x, y), world.obstacles[:, 2]
    outside = (centre**2).sum(axis=1) - radius**2
    if (outside <= 0).any():
        return np.full(directions.shape[1], np.inf)
    ahead = centre @ directions
    under_root = ahead**2 - outside[:, None]
    hit = (ahead > 0) & (under_root >= 0)
    nearness = np.where(hit, (ahead + np.sqrt(np.maximum(under_root, 0.0))) / outside[:, None], 0.0)
    return np.asarray(nearness.max(axis=0, initial=0.0))


def _across(vectors: Floats) -> Floats:
    """Each vector (x, y) as (y, -x), so that a product with a direction d is the cross product d x vector."""
    return np.column_stack((vectors[:, 1], -vectors[:, 0]))

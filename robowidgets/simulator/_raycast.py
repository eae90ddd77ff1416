"""Ray casting: distances to walls and obstacles, for all rays at once."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from .world import World

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

_TOUCH = 1e-9
"""Radians by which a ray may miss the end of a wall and still hit it, so that corners have no gaps."""


def cast_rays(world: World, x: float, y: float, angles: Floats) -> tuple[Floats, Floats]:
    """Return the distances to the nearest wall and to the nearest obstacle along each ray.

    Args:
        world: the walls and obstacles.
        x: start of the rays, metres.
        y: start of the rays, metres.
        angles: R directions in the world's frame, radians.

    Returns:
        Two arrays of shape (R,), metres; inf if nothing is hit, 0 for an obstacle that contains the start. A wall
        seen exactly edge-on is not hit.
    """
    rays = _Rays(angles)
    with np.errstate(divide="ignore"):
        return 1.0 / _nearness_of_walls(world, x, y, rays), 1.0 / _nearness_of_obstacles(world, x, y, rays)


class _Rays:
    """Rays from one point, sorted by angle, so that each wall or obstacle is tested only with the rays that may hit it.

    This makes maps with thousands of short walls possible. Nearness is 1 / distance, or 0 if nothing is hit.
    """

    def __init__(self, angles: Floats) -> None:
        self.cos, self.sin = np.cos(angles), np.sin(angles)
        self._zero = angles[0] if angles.size else 0.0
        turned = (angles - self._zero) % (2 * pi)
        self._order = np.argsort(turned, kind="stable")
        self._sorted = turned[self._order]

    def between(self, first: Floats, width: Floats) -> tuple[Indices, Indices]:
        """Return all pairs of a thing and a ray within its angles, as two arrays of indices.

        Args:
            first: the angle at which each thing begins, radians.
            width: the angle that it spans counter-clockwise, radians, at most pi.
        """
        start = (first - self._zero) % (2 * pi)
        end = start + width
        # A thing that lies across the direction of ray 0 has rays at both ends of the order.
        low = self._sorted.searchsorted(np.concatenate((start, start - 2 * pi)) - _TOUCH, "left")
        high = self._sorted.searchsorted(np.concatenate((end, end - 2 * pi)) + _TOUCH, "right")
        counts = high - low
        thing = np.repeat(np.tile(np.arange(first.size), 2), counts)
        ray = self._order[np.arange(thing.size) + np.repeat(low - (counts.cumsum() - counts), counts)]
        return thing, ray

    def nearest(self, ray: Indices, nearness: Floats) -> Floats:
        """Return the greatest nearness for each ray."""
        result = np.zeros(self.cos.size)
        np.maximum.at(result, ray, nearness)
        return result


def _nearness_of_walls(world: World, x: float, y: float, rays: _Rays) -> Floats:
    """Return 1 / distance to walls: along a ray d, the line n.p = c is at c / n.d. The inverse needs only products."""
    x1, y1, x2, y2 = world.walls.T - [[x], [y], [x], [y]]
    away = x1 * y2 - y1 * x2
    seen = np.flatnonzero(np.abs(away) > _TOUCH * np.hypot(x2 - x1, y2 - y1))
    x1, y1, x2, y2, away = (each[seen] for each in (x1, y1, x2, y2, away))
    is_start = away > 0
    first = np.arctan2(np.where(is_start, y1, y2), np.where(is_start, x1, x2))
    wall, ray = rays.between(first, np.arctan2(np.abs(away), x1 * x2 + y1 * y2))
    normal_x, normal_y = (y2 - y1) / away, (x1 - x2) / away
    return rays.nearest(ray, normal_x[wall] * rays.cos[ray] + normal_y[wall] * rays.sin[ray])


def _nearness_of_obstacles(world: World, x: float, y: float, rays: _Rays) -> Floats:
    """Return 1 / distance to the near side of discs, from the equation |t d - c| = r."""
    centre_x, centre_y, radius = world.obstacles.T - [[x], [y], [0.0]]
    distance = np.hypot(centre_x, centre_y)
    outside = distance**2 - radius**2
    if (outside <= 0).any():
        return np.full(rays.cos.size, np.inf)
    half = np.arcsin(radius / distance)
    disc, ray = rays.between(np.arctan2(centre_y, centre_x) - half, 2 * half)
    ahead = centre_x[disc] * rays.cos[ray] + centre_y[disc] * rays.sin[ray]
    under_root = np.maximum(ahead**2 - outside[disc], 0.0)
    return rays.nearest(ray, (ahead + np.sqrt(under_root)) / outside[disc])

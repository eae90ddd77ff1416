"""Contacts between the round body of the robot and walls or obstacles, and the floor below it."""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, pi, sin

import numpy as np

from ..samples import Pose
from .world import World

PlacesOnBody = Mapping[str, tuple[float, float]]
"""Places on a body by name: radians counter-clockwise from forward, and the share of the radius from the middle."""

PRESSED_WITHIN = 0.002
"""The largest distance in metres from the body at which a wall or an obstacle presses a bumper."""

_EXACT = 1e-9
_ROUNDS = 20


def push_out(world: World, x: float, y: float, radius: float) -> tuple[float, float] | None:
    """Return the place of a body after walls and obstacles have pushed it out, or None if it finds no free place.

    The wall or obstacle with the deepest overlap pushes first, repeatedly, so that a body slides along walls and comes
    to rest in corners. For None, the body is stuck and should stay at its old place.
    """
    for _ in range(_ROUNDS):
        points = world.nearest_points(x, y)
        if not len(points):
            return x, y
        off_x, off_y = x - points[:, 0], y - points[:, 1]
        distances = np.hypot(off_x, off_y)
        nearest = int(distances.argmin())
        distance = float(distances[nearest])
        if distance >= radius - _EXACT:
            return x, y
        if distance == 0:
            return None
        x = float(points[nearest, 0] + off_x[nearest] * (radius / distance))
        y = float(points[nearest, 1] + off_y[nearest] * (radius / distance))
    return None


def contact_angles(world: World, x: float, y: float, yaw: float, radius: float) -> list[float]:
    """Return the angles of all contacts on the rim of the body: radians counter-clockwise from forward, within +-pi."""
    points = world.nearest_points(x, y) - (x, y)
    touching = points[np.hypot(points[:, 0], points[:, 1]) <= radius + PRESSED_WITHIN]
    angles = np.arctan2(touching[:, 1], touching[:, 0]) - yaw
    return [float(angle) for angle in (angles + pi) % (2 * pi) - pi]


def pressed(angles: list[float], bumpers: Mapping[str, tuple[float, float]]) -> dict[str, bool]:
    """Map the name of each bumper to True if one of these contacts presses it."""
    return {
        name: any((angle - low) % (2 * pi) <= high - low for angle in angles) for name, (low, high) in bumpers.items()
    }


def over_drop(world: World, pose: Pose, radius: float, places: PlacesOnBody) -> dict[str, bool]:
    """Map the name of each of these places of a body to True if the floor is missing below it."""
    x, y, yaw = pose
    return {
        name: world.has_drop(x + share * radius * cos(yaw + angle), y + share * radius * sin(yaw + angle))
        for name, (angle, share) in places.items()
    }

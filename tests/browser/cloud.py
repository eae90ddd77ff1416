"""Cells with clouds, for the tests of their widget."""

from __future__ import annotations

ROOM = """
import numpy as np
from robowidgets import CloudWidget

def room(rings=32, columns=900):
    "What a scanner with several rings sees in a room with a box and a pillar; the window is not measured."
    up = np.radians(np.linspace(15, -25, rings))[:, None]
    turn = np.linspace(np.pi, -np.pi, columns, endpoint=False)[None]
    ray = np.stack(np.broadcast_arrays(np.cos(up) * np.cos(turn), np.cos(up) * np.sin(turn), np.sin(up)), -1)
    away = np.full(ray.shape[:2], np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        for axis, walls in ((0, (-3.0, 5.0)), (1, (-2.5, 3.5)), (2, (-0.6, 1.9))):
            for wall in walls:
                hit = wall / ray[..., axis]
                away = np.where((hit > 0) & (hit < away), hit, away)
        for low, high in (((1.2, 0.6, -0.6), (1.9, 1.6, 0.35)), ((2.4, -1.6, -0.6), (2.7, -1.3, 1.9))):
            sides = np.stack([np.array(low) / ray, np.array(high) / ray])
            first, last = sides.min(0).max(-1), sides.max(0).min(-1)
            away = np.where((first > 0) & (first < last) & (first < away), first, away)
    away[:, 200:230] = np.nan
    points = np.zeros(away.shape, [(n, "<f4") for n in "xyz"] + [("intensity", "<f4"), ("ring", "<u2"), ("t", "<f8")])
    for i, axis in enumerate("xyz"):
        points[axis] = away * ray[..., i]
    points["intensity"] = np.round(100 / (1 + away) * (1 + 0.3 * np.sin(8 * turn)), 1)
    points["ring"] = np.arange(rings)[::-1, None]
    points["t"] = np.linspace(0, 0.1, columns)[None]
    return points

clouds = CloudWidget(title="/velodyne_points")
clouds.update(room())
clouds
"""
MANY = """
many = CloudWidget(title="/map")
_rng = np.random.default_rng(1)
many.update(np.float32(_rng.normal((5, 0, 1), (8, 4, 0.5), (450_000, 3))))
many
"""
FEW = """
few = CloudWidget(title="radar", color_by="speed")
_few = np.array([(4.0, 1.0, 0.1, -1.5), (6.5, -2.0, 0.3, 0.25), (9.0, 0.5, 0.2, 3.0)],
                [(n, "<f4") for n in ("x", "y", "z", "speed")])
few.update(_few)
few
"""
EMPTY = """
empty = CloudWidget(title="/points")
empty
"""
NOTHING = """
nothing = CloudWidget(title="/points")
nothing.update(np.full((100, 3), np.nan))
nothing
"""

from math import atan2, cos, hypot, inf, pi, sin, sqrt

import numpy as np
import pytest

from robowidgets.simulator import World
from robowidgets.simulator._raycast import cast_rays

ALL_ROUND = np.linspace(-pi, pi, 721)


def slow_wall(wall, x, y, angle):
    """One ray and one wall, by solving the two equations with Cramer's rule."""
    x1, y1, x2, y2 = wall
    dx, dy, ex, ey = cos(angle), sin(angle), x2 - x1, y2 - y1
    determinant = ex * dy - ey * dx
    if abs(determinant) < 1e-12:
        return inf
    distance = (ex * (y1 - y) - ey * (x1 - x)) / determinant
    along = (dx * (y1 - y) - dy * (x1 - x)) / determinant
    return distance if distance > 0 and 0 <= along <= 1 else inf


def slow_obstacle(obstacle, x, y, angle):
    """One ray and one disc, by the distance at which the ray passes its centre."""
    cx, cy, radius = obstacle
    distance, bearing = hypot(cx - x, cy - y), atan2(cy - y, cx - x) - angle
    beside = distance * sin(bearing)
    if abs(beside) > radius or cos(bearing) < 0:
        return inf
    return distance * cos(bearing) - sqrt(radius**2 - beside**2)


def test_a_square_room_is_as_far_as_trigonometry_says():
    room = World(walls=[(-2, -2, 2, -2), (2, -2, 2, 2), (2, 2, -2, 2), (-2, 2, -2, -2)])
    walls, obstacles = cast_rays(room, 0.0, 0.0, ALL_ROUND)
    expected = 2 / np.maximum(np.abs(np.cos(ALL_ROUND)), np.abs(np.sin(ALL_ROUND)))
    assert np.abs(walls - expected).max() < 1e-12
    assert np.isinf(obstacles).all()


def test_a_disc_is_hit_between_its_two_tangents():
    _, obstacles = cast_rays(World(obstacles=[(3.0, 0.0, 1.0)]), 0.0, 0.0, ALL_ROUND)
    tangent = np.arcsin(1 / 3)
    assert (np.isfinite(obstacles) == (np.abs(ALL_ROUND) <= tangent)).all()
    assert obstacles[360] == pytest.approx(2.0, abs=1e-12)


def test_behind_the_robot_is_not_in_front_of_it():
    walls, obstacles = cast_rays(World([(-1, -1, -1, 1)], [(-3, 0, 0.5)]), 0.0, 0.0, np.array([0.0, pi]))
    assert walls.tolist() == [inf, pytest.approx(1.0)]
    assert obstacles.tolist() == [inf, pytest.approx(2.5)]


def test_no_ray_slips_through_the_corner_of_two_walls():
    rng = np.random.default_rng(3)
    for _ in range(200):
        corner = rng.uniform(1, 5, 2)
        world = World(walls=[(*corner, corner[0], -9), (-9, corner[1], *corner)])
        x, y = rng.uniform(-1, 0.5, 2)
        walls, _ = cast_rays(world, x, y, np.array([np.arctan2(corner[1] - y, corner[0] - x)]))
        assert walls[0] == pytest.approx(np.hypot(*(corner - (x, y))), abs=1e-6)


def test_the_house_looks_the_same_as_ray_by_ray():
    house, rng = World.rooms(), np.random.default_rng(1)
    angles = np.linspace(-2.3, 2.4, 181)
    for _ in range(12):
        x, y = rng.uniform((-6.9, -4.4), (6.9, 4.4))
        if house.clearance(x, y) <= 0:
            continue
        walls, obstacles = cast_rays(house, x, y, angles)
        assert walls == pytest.approx([min(slow_wall(w, x, y, a) for w in house.walls) for a in angles], abs=1e-9)
        expected = [min(slow_obstacle(o, x, y, a) for o in house.obstacles) for a in angles]
        assert obstacles == pytest.approx(expected, abs=1e-6)


def test_rays_that_start_in_an_obstacle_have_no_way_to_go():
    _, obstacles = cast_rays(World(obstacles=[(0.0, 0.0, 1.0)]), 0.2, 0.0, ALL_ROUND)
    assert (obstacles == 0).all()


def test_a_wall_seen_edge_on_is_not_hit_and_an_empty_world_neither():
    assert cast_rays(World(walls=[(1, 0, 2, 0)]), 0.0, 0.0, np.zeros(1))[0].tolist() == [inf]
    assert [a.tolist() for a in cast_rays(World(), 0.0, 0.0, np.zeros(2))] == [[inf, inf], [inf, inf]]

"""Scans of other geometries on the rays of one scan."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from robowidgets.scanogram.by_angle import keeps_indices, on_rays, rays_at
from robowidgets.scanogram.scans import Sweep


def sweep(angle_min: float, increment: float, count: int) -> Sweep:
    return Sweep(angle_min, increment, 0.1, 30.0, count)


@pytest.mark.parametrize("increment", [0.1, -0.1])
def test_rays_of_the_same_geometry_keep_their_indices(increment: float) -> None:
    one = sweep(0.5, increment, 60)
    assert rays_at(one, one).tolist() == list(range(60))
    jittered = sweep(0.5 + 0.02, 1.0001 * increment, 60)
    assert keeps_indices(rays_at(jittered, one))


def test_a_shorter_sweep_has_no_ray_outside_its_angles() -> None:
    rays = rays_at(sweep(-0.5, 0.1, 8), sweep(-0.5, 0.1, 10))
    assert rays.tolist() == [0, 1, 2, 3, 4, 5, 6, 7, -1, -1]
    assert keeps_indices(rays)
    assert rays_at(sweep(-0.3, 0.1, 3), sweep(-0.5, 0.1, 10)).tolist() == [-1, -1, 0, 1, 2, -1, -1, -1, -1, -1]


def test_every_ray_of_a_coarser_scan_stands_where_its_angle_is() -> None:
    on = sweep(0.0, 2 * pi / 460, 460)
    for count in (450, 455, 459, 230):
        of = sweep(0.0, 2 * pi / count, count)
        rays = rays_at(of, on)
        assert set(rays.tolist()) == set(range(count)), "no ray is left out, and none is missing"
        off = np.abs(rays * of.angle_increment - np.arange(460) * on.angle_increment)
        assert np.minimum(off, 2 * pi - off).max() <= of.angle_increment / 2 + 1e-9
        assert not keeps_indices(rays)


def test_a_circle_that_starts_elsewhere_or_runs_the_other_way_is_the_same_circle() -> None:
    on = sweep(-pi, pi / 180, 360)
    assert rays_at(sweep(0.0, pi / 180, 360), on).tolist() == [*range(180, 360), *range(180)]
    assert rays_at(sweep(0.0, -pi / 180, 360), on).tolist() == [*range(180, -1, -1), *range(359, 180, -1)]


def test_a_circle_that_repeats_its_end_ray_keeps_its_indices() -> None:
    on = sweep(0.0, pi / 180, 361)
    assert keeps_indices(rays_at(sweep(1e-4, pi / 180, 361), on))


def test_a_single_ray_stands_where_it_points() -> None:
    assert rays_at(sweep(0.0, 0.0, 1), sweep(-0.2, 0.1, 5)).tolist() == [-1, -1, 0, -1, -1]
    assert rays_at(sweep(0.5, 0.0, 1), sweep(0.5, 0.0, 1)).tolist() == [0]


def test_if_there_is_no_ray_there_is_no_measurement() -> None:
    ranges = np.array([[1.0, np.inf], [2.0, 3.0]], np.float32)
    put = on_rays(ranges, np.array([-1, 0, 1, 1]))
    assert put.dtype == np.float32
    assert np.array_equal(put, [[np.nan, 1, np.inf, np.inf], [np.nan, 2, 3, 3]], equal_nan=True)
    assert np.isnan(on_rays(np.empty((3, 0), np.float32), np.full(4, -1))).all()

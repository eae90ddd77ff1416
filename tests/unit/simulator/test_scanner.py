from math import inf, nan, pi, radians

import numpy as np
import pytest

from robowidgets import Validity
from robowidgets.simulator import Scanner, World

EXACT = {"noise": 0.0, "resolution": 0.0, "dropout": 0.0}
WALL = World(walls=[(2.0, -50.0, 2.0, 50.0)])


def measure(scanner, world=WALL, x=0.0, y=0.0, yaw=0.0, seed=0):
    return scanner.measure(world, x, y, yaw, np.random.default_rng(seed))


def test_without_noise_a_wall_is_exact_at_every_angle():
    scan = measure(Scanner(**EXACT, range_max=100.0, field_of_view=radians(170)))
    assert np.abs(scan.ranges - 2 / np.cos(scan.angles)).max() < 1e-5
    assert scan.ranges.dtype == np.float32


def test_rays_run_counter_clockwise_and_the_middle_one_looks_forward():
    scan = measure(Scanner(ray_count=5, field_of_view=pi, **EXACT), World(obstacles=[(0.0, 2.0, 0.5)]))
    assert scan.angles.tolist() == pytest.approx([-pi / 2, -pi / 4, 0, pi / 4, pi / 2])
    assert [ray.index for ray in scan if ray.validity is Validity.READING] == [4]


def test_the_scan_turns_with_the_robot():
    scan = measure(Scanner(ray_count=5, field_of_view=pi, **EXACT), x=1.0, yaw=-pi / 2)
    assert scan.ranges.tolist() == pytest.approx([inf, inf, inf, np.sqrt(2), 1.0])


def test_a_full_circle_stops_one_step_before_it_closes():
    scan = measure(Scanner(ray_count=360, field_of_view=2 * pi))
    assert scan.angle_min == pytest.approx(-pi)
    assert scan.angles[-1] == pytest.approx(pi - radians(1))


def test_one_single_ray_looks_forward():
    scan = measure(Scanner(ray_count=1, field_of_view=0.0, **EXACT))
    assert (scan.angles.tolist(), scan.ranges.tolist()) == ([0.0], [2.0])


def test_too_close_nothing_in_range_and_the_limits_themselves():
    scanner = Scanner(ray_count=1, field_of_view=0.0, range_min=0.5, range_max=3.0, **EXACT)
    got = [measure(scanner, x=2 - distance).ranges[0] for distance in (0.499, 0.5, 3.0, 3.001)]
    assert got == [-inf, 0.5, 3.0, inf]
    assert measure(scanner, x=-1.0).counts[Validity.READING] == 1


def test_noise_has_the_spread_it_was_given_and_no_bias():
    flat = Scanner(ray_count=20_000, field_of_view=1e-6, noise=0.05, resolution=0.0, dropout=0.0)
    ranges = measure(flat).ranges.astype(np.float64)
    assert ranges.std() == pytest.approx(0.05, rel=0.03)
    assert ranges.mean() == pytest.approx(2.0, abs=0.002)


def test_readings_are_multiples_of_the_resolution():
    ranges = measure(Scanner(resolution=0.05, range_max=100.0, dropout=0.0, field_of_view=2.0)).ranges
    assert np.abs(ranges / 0.05 - np.round(ranges / 0.05)).max() < 1e-4
    assert len(np.unique(ranges)) > 5


def test_dropouts_are_as_many_as_asked_for_and_come_over_everything():
    scan = measure(Scanner(ray_count=20_000, dropout=0.1))
    assert scan.counts[Validity.NO_MEASUREMENT] / 20_000 == pytest.approx(0.1, rel=0.1)
    assert measure(Scanner(dropout=1.0)).counts[Validity.NO_MEASUREMENT] == 541
    assert measure(Scanner(dropout=0.0)).counts[Validity.NO_MEASUREMENT] == 0


def test_intensities_tell_walls_from_obstacles_and_fade_with_distance():
    scanner = Scanner(ray_count=3, field_of_view=pi / 2, intensities=True, **EXACT)
    world = World(walls=[(4.0, -50.0, 4.0, 50.0)], obstacles=[(3.0, 3.0, 0.5)])
    scan = measure(scanner, world)
    assert scan.intensities[1] == 100.0
    assert scan.intensities[2] == round(80 / (1 + (np.sqrt(18) - 0.5) ** 2 / 16))
    assert measure(scanner, World()).intensities.tolist() == [0.0, 0.0, 0.0]
    assert measure(Scanner(**EXACT)).intensities.size == 0


def test_the_same_generator_gives_the_same_scan_and_another_one_another():
    first, again, other = (measure(Scanner(), seed=seed).ranges.tobytes() for seed in (1, 1, 2))
    assert first == again != other


@pytest.mark.parametrize(
    ("settings", "error", "text"),
    [
        ({"ray_count": 0}, ValueError, "ray_count: expected 1 to 1,000,000, got 0"),
        ({"ray_count": 2_000_000}, ValueError, "ray_count: expected 1 to 1,000,000, got 2,000,000"),
        ({"ray_count": 3.5}, TypeError, "ray_count: expected a whole number, got 3.5"),
        ({"ray_count": True}, TypeError, "ray_count: expected a whole number, got True"),
        ({"field_of_view": 7.0}, ValueError, "field_of_view: expected 0 to 2 pi radians, got 7.0"),
        ({"field_of_view": 270}, ValueError, 'got 270.0; degrees are written as "270deg"'),
        ({"field_of_view": 0.0}, ValueError, "field_of_view: expected radians above 0 for 541 rays, got 0"),
        ({"range_min": -1.0}, ValueError, "range_min: expected metres, 0 or more, got -1.0"),
        ({"range_max": 0.05}, ValueError, r"range_max: expected metres above range_min \(0.1\), got 0.05"),
        ({"range_max": inf}, ValueError, "range_max: expected a finite number of metres, got inf"),
        ({"noise": nan}, ValueError, "noise: expected a finite number of metres, got nan"),
        ({"resolution": "fine"}, TypeError, "resolution: expected a number, got 'fine'"),
        ({"dropout": 1.5}, ValueError, "dropout: expected a share from 0 to 1, got 1.5"),
        ({"rate": 0.0}, ValueError, "rate: expected scans per second, above 0 and at most 1000, got 0.0"),
    ],
)
def test_a_scanner_that_cannot_be_is_refused(settings, error, text):
    with pytest.raises(error, match=text):
        Scanner(**settings)


def test_a_field_of_view_may_be_in_degrees():
    assert Scanner(field_of_view="180deg") == Scanner(field_of_view=pi)

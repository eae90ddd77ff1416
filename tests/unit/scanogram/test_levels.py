from __future__ import annotations

import numpy as np
import pytest

from robowidgets.samples import Scan
from robowidgets.scanogram._codes import CLOSEST, FARTHEST, encode, fold, fold_median
from robowidgets.scanogram.levels import Levels
from robowidgets.scanogram.scans import ScansInMemory, Sweep

from .pictures import get_size

GEOMETRY = (-1.0, 0.01, 0.1, 30.0)


def made(ranges: np.ndarray, budget: int | None = None, range_max: float = 30.0) -> Levels:
    ranges = ranges.astype(np.float32)
    scans = ScansInMemory(np.arange(len(ranges)) * 100_000_000, [ranges[:700], ranges[700:]])
    sweep = Sweep.of(Scan(ranges[0], *GEOMETRY[:-1], range_max))
    return Levels(scans, sweep) if budget is None else Levels(scans, sweep, budget)


@pytest.fixture
def ranges() -> np.ndarray:
    return np.random.default_rng(3).uniform(0.2, 29.0, (3001, 90))


@pytest.mark.parametrize("budget", [1 << 28, 300_000, 40_000])
def test_every_level_holds_the_least_of_its_scans_whatever_the_budget(ranges: np.ndarray, budget: int) -> None:
    levels = made(ranges, budget)
    codes = encode(ranges.astype(np.float32), 0.1, 30.0)
    for level in range(levels.last + 1):
        expected = fold(codes, 1 << level)
        assert (levels.codes(level, 0, len(expected)) == expected).all()
        assert (levels.codes(level, 3, 7) == expected[3:7]).all()


@pytest.mark.parametrize("budget", [300_000, 40_000])
def test_the_levels_keep_to_the_budget(ranges: np.ndarray, budget: int) -> None:
    levels = made(ranges, budget)
    for pixel in ("nearest", "median", "nearest"):
        levels.codes(levels.last, 0, 1, pixel)
        assert get_size(levels) <= 1.1 * budget


def test_one_near_reading_among_a_million_is_seen_at_every_level() -> None:
    ranges = np.full((5000, 200), 20.0)
    ranges[1234, 56] = 0.5
    levels = made(ranges)
    near = encode(np.array([0.5], np.float32), 0.1, 30.0)[0]
    for level in range(levels.last + 1):
        assert levels.codes(level, 1234 >> level, (1234 >> level) + 1)[0, 56] == near


@pytest.mark.parametrize("range_max", [600.0, 1e5, np.inf])
def test_distances_are_as_exact_whatever_the_scanner_claims_to_see(range_max: float) -> None:
    ranges = np.random.default_rng(1).uniform(0.2, 29.0, (1000, 90))
    ranges[3, :4] = np.inf, np.nan, -np.inf, 0.05
    levels = made(ranges, range_max=range_max)
    assert levels.far == (pytest.approx(29.0, abs=0.01) if range_max > 650 else range_max)
    metres = 0.1 + (levels.codes(0, 0, 1000) - CLOSEST + 0.5) * (levels.far - 0.1) / (FARTHEST - CLOSEST)
    read = np.isfinite(ranges) & (ranges > 0.1)
    assert np.abs(metres - ranges)[read].max() < 0.006
    assert levels.counts.tolist() == [90_000 - 4, 1, 1, 1, 1]


def test_without_a_limit_and_without_a_reading_there_is_a_scale_all_the_same() -> None:
    levels = made(np.full((10, 8), np.inf), range_max=np.inf)
    assert levels.far == pytest.approx(650.1)


def test_what_is_too_close_does_not_count_as_a_reading_of_the_scale() -> None:
    ranges = np.full((100, 90), 3.0)
    ranges[:, :9] = -np.inf
    assert made(ranges).color_range == pytest.approx((3.0, 3.0), abs=0.01)


def test_the_classes_are_counted() -> None:
    ranges = np.full((10, 8), 5.0)
    ranges[:, 0], ranges[:, 1], ranges[:3, 2], ranges[0, 3] = np.inf, np.nan, -np.inf, 0.0
    assert made(ranges).counts.tolist() == [80 - 24, 3, 10, 10, 1]


@pytest.mark.parametrize(("budget", "first"), [(1 << 28, 0), (300_000, 3)])
def test_medians_are_of_the_scans_or_of_their_first_medians(ranges: np.ndarray, budget: int, first: int) -> None:
    levels = made(ranges, budget)
    codes = encode(ranges.astype(np.float32), 0.1, 30.0)
    for level in range(levels.last + 1):
        expected = fold_median(codes, 1 << level)
        if level > first > 0:
            expected = fold_median(fold_median(codes, 1 << first), 1 << (level - first))
        assert (levels.codes(level, 0, len(expected), "median") == expected).all()
    assert levels.codes(0, 0, 1).tolist() == codes[:1].tolist()


def test_colors_are_fitted_to_all_readings_without_the_extreme_hundredths_however_long_the_drive() -> None:
    drive = np.full((100, 90), 3.0)
    drive[50:] = 5.0
    drive[0, :3], drive[1, :6] = (0.2, 9.0, 29.0), (np.inf, np.nan, -np.inf, 0.0, 50.0, 2.0)
    once, often = made(drive).color_range, made(np.tile(drive, (60, 1))).color_range
    assert once == (pytest.approx(3.0, abs=0.01), pytest.approx(5.0, abs=0.01))
    assert once == often
    assert made(np.full((5, 90), np.inf)).color_range == pytest.approx((0.1, 30.0))

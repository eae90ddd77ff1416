"""The nearest distances as whole columns: equal to the distances of one scan at a time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import RecordingError, conditions
from robowidgets.samples.sector import ALL_ROUND

from . import sweeps
from .sweeps import START_NS

NAN, INF = float("nan"), float("inf")
VALUES = [0.5, 2.0, 30.0, 30.5, -INF, INF, NAN, NAN, 0.0, 0.0, 0.001, 0.05]
SECTORS: list[Any] = [ALL_ROUND, "front", "back", (0.2, 0.5)]


def open_rows(folder: Path, rows: Any, **more: Any) -> robowidgets.Recording:
    scans = ((i, sweeps.scan(START_NS + i, row, **more)) for i, row in enumerate(rows))
    return robowidgets.open(sweeps.write(folder / "sweeps", scans))


def mixtures() -> list[list[float]]:
    """300 scans of 1 to 11 rays; limits are 0.1 to 30 m."""
    random = np.random.default_rng(5)
    return [random.choice(VALUES, random.integers(1, 12)).tolist() for _ in range(300)]


@pytest.mark.parametrize("sector", SECTORS)
@pytest.mark.parametrize("percentile", [None, 0, 30, 100])
def test_a_column_says_what_each_scan_says(tmp_path: Path, sector: Any, percentile: float | None) -> None:
    scans = open_rows(tmp_path, mixtures()).scans()
    each = [moment.sample.distance(sector, percentile=percentile) for moment in scans]
    assert len({str(value) for value in each}) >= (1 if sector == "back" else 4)
    for some in (slice(None), slice(7, 200, 3), slice(0, 0)):
        column = scans[some].distances(sector, percentile=percentile)
        assert column.dtype == np.float32
        np.testing.assert_array_equal(column, np.array(each[some], np.float32))


@pytest.mark.parametrize("sector", SECTORS)
def test_a_condition_judges_as_each_scan_does(tmp_path: Path, sector: Any) -> None:
    recording = open_rows(tmp_path, mixtures())
    below, others = (
        {i for span in recording.find(held) for i in range(round(span.start), round(span.end))}
        for held in (conditions.nearest_below(0.6, sector), ~conditions.nearest_below(0.6, sector))
    )
    distances = [moment.sample.distance(sector) for moment in recording.scans()][:-1]
    assert below == {i for i, distance in enumerate(distances) if distance < 0.6}
    assert others == {i for i, distance in enumerate(distances) if distance >= 0.6}


def test_a_column_of_rays_has_the_distance_among_any_of_them(tmp_path: Path) -> None:
    rows = np.random.default_rng(6).choice(VALUES, (200, 11))
    scans = open_rows(tmp_path, rows).scans()
    rays = scans.ray_distances
    assert rays.shape == (200, 11)
    np.testing.assert_array_equal(np.ma.filled(rays.min(axis=1), NAN), scans.distances())
    some = np.flatnonzero((scans.angles > 0.19) & (scans.angles < 0.51))
    np.testing.assert_array_equal(np.ma.filled(rays[:, some].min(axis=1), NAN), scans.distances((0.2, 0.5)))
    np.testing.assert_array_equal(np.isnan(np.asarray(rays)), np.ma.getmaskarray(rays))


def test_what_a_user_writes_first_finds_what_is_near_and_nothing_else(tmp_path: Path) -> None:
    rows = [[0.0, 2.0], [-INF, 2.0], [NAN, 0.2], [NAN, NAN], [INF, INF], [0.0, 0.0], [0.2, 0.0], [0.05, 9.0]]
    scans = open_rows(tmp_path, rows).scans()
    for near in (scans.ray_distances.min(axis=1) < 0.3, scans.distances() < 0.3):
        np.testing.assert_array_equal(scans[near].seconds, [1, 2, 6, 7])
    for free in (scans.ray_distances.min(axis=1) > 0.3, scans.distances() > 0.3):
        np.testing.assert_array_equal(scans[free].seconds, [0, 4])


def test_the_zeros_of_a_neato_are_not_near(tmp_path: Path) -> None:
    rows = [[0.0] * 300 + [1.0 + i / 100] * 61 for i in range(152)]
    scans = open_rows(tmp_path, rows, increment=0.0175).scans()
    assert (scans.ranges.min(axis=1) < 0.3).sum() == 152
    assert (scans.distances() < 0.3).sum() == (scans.ray_distances.min(axis=1) < 0.3).sum() == 0
    np.testing.assert_allclose(scans.distances(), 1 + np.arange(152) / 100, rtol=1e-6)


def test_a_scanner_that_changes_its_number_of_rays_has_distances_but_no_column_of_rays(tmp_path: Path) -> None:
    scans = open_rows(tmp_path, [[1.0, 2.0], [3.0], [0.0, 4.0]]).scans()
    np.testing.assert_array_equal(scans.distances(), [1, 3, 4])
    with pytest.raises(RecordingError, match="its scans do not form one array"):
        _ = scans.ray_distances
    np.testing.assert_array_equal([group.ray_distances.min() for group in scans.groups], [1, 3])


@pytest.mark.parametrize("more", [{"sector": "frnt"}, {"percentile": 101}])
def test_what_is_asked_is_checked(tmp_path: Path, more: Any) -> None:
    with pytest.raises(ValueError, match="expected"):
        open_rows(tmp_path, [[1.0]]).scans().distances(**more)


def test_a_condition_names_its_sector() -> None:
    assert str(conditions.nearest_below(0.3, "front")) == "nearest below 0.3 m in front"
    assert str(conditions.nearest_below(0.3, (-0.5, 0.5))) == "nearest below 0.3 m between -28.65° and 28.65°"
    with pytest.raises(ValueError, match=r"expected front, left, back, right or two angles, .* got 'ahead'"):
        conditions.nearest_below(0.3, "ahead")


def test_the_codes_of_real_scanners_are_not_near(data: Path) -> None:
    """A Hokuyo that sends 0.001 for nothing, and one with zeros and error codes from 0.006 to 0.015."""
    for name, zeros in (("good/tilt_laser.bag", 178), ("good/urg_681.bag", 312)):
        with robowidgets.open(data / name) as recording:
            scans = recording.scans()
            assert (scans.ranges.min(axis=1) < 0.3).sum() == zeros
            readings = np.where(scans.ranges >= scans.range_min[:, None], scans.ranges, INF)
            np.testing.assert_array_equal(scans.distances(), readings.min(axis=1))

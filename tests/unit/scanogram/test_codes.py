from __future__ import annotations

import numpy as np
import pytest

from robowidgets.samples import Scan, Validity
from robowidgets.scanogram._codes import (
    CLOSEST,
    FARTHEST,
    NO_MEASUREMENT,
    NOTHING_IN_RANGE,
    OUTSIDE_LIMITS,
    TOO_CLOSE,
    WITHOUT_READING,
    encode,
    fold,
    fold_median,
)


def test_the_five_classes_stay_apart() -> None:
    ranges = np.array([0.1, 4.0, -np.inf, np.inf, np.nan, 0.0, 4.1], np.float32)
    expected = [CLOSEST, FARTHEST, TOO_CLOSE, NOTHING_IN_RANGE, NO_MEASUREMENT, OUTSIDE_LIMITS, OUTSIDE_LIMITS]
    assert encode(ranges, 0.1, 4.0).tolist() == expected


def test_every_ray_has_the_class_that_its_scan_gives_it() -> None:
    random = np.random.default_rng(1)
    ranges = random.choice([0.0, 0.5, 1.0, 59.9, 60.0, 61.0, np.nan, np.inf, -np.inf], (50, 40)).astype(np.float32)
    kinds = np.array([Scan(row, -1.0, 0.01, 0.5, 60.0).validity for row in ranges])
    codes = encode(ranges, 0.5, 60.0)
    assert (((codes >= CLOSEST) & (codes <= FARTHEST)) == (kinds == Validity.READING)).all()
    for kind, code in zip(list(Validity)[1:], WITHOUT_READING, strict=True):
        assert ((codes == code) == (kinds == kind)).all()


def test_a_code_tells_a_distance_to_a_thousandth_of_60_metres() -> None:
    ranges = np.linspace(0.02, 60.0, 5000, dtype=np.float32)
    metres = 0.02 + (encode(ranges, 0.02, 60.0) - CLOSEST + 0.5) * (60.0 - 0.02) / (FARTHEST - CLOSEST)
    assert np.abs(metres - ranges).max() < 0.001


def test_of_several_rays_the_nearest_is_kept_which_may_be_too_close_to_measure() -> None:
    column = np.array([[np.inf], [np.nan], [9.0], [2.0], [0.5], [0.1], [-np.inf]], np.float32)
    codes = encode(column, 0.1, 4.0)
    assert [fold(codes[:i], 7)[0, 0] for i in range(1, 8)] == [
        NOTHING_IN_RANGE, NO_MEASUREMENT, OUTSIDE_LIMITS, codes[3, 0], codes[4, 0], CLOSEST, TOO_CLOSE
    ]  # fmt: skip


@pytest.mark.parametrize("count", [1, 2, 3, 8])
def test_the_last_cell_may_stand_for_fewer(count: int) -> None:
    codes = np.random.default_rng(2).integers(0, 1000, (11, 4)).astype(np.uint16)
    expected = [codes[i : i + count].min(axis=0).tolist() for i in range(0, 11, count)]
    assert fold(codes, count).tolist() == expected


@pytest.mark.parametrize("count", [1, 2, 3, 8])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_median_is_one_of_its_codes_and_of_an_even_number_the_lesser(count: int, axis: int) -> None:
    codes = np.random.default_rng(2).integers(0, 65_536, (11, 11)).astype(np.uint16)
    by_row = codes if axis == 0 else codes.T
    groups = [np.sort(by_row[i : i + count], axis=0) for i in range(0, 11, count)]
    expected = np.array([group[(len(group) - 1) // 2] for group in groups])
    assert (fold_median(codes, count, axis) == (expected if axis == 0 else expected.T)).all()
    assert fold_median(codes[:0], 2).shape == (0, 11)

"""`Scan.again`: the next sweep of a scanner, without checking unchanged values again."""

from __future__ import annotations

import numpy as np
import pytest

from robowidgets import Scan, Validity
from robowidgets.samples import Problem

ODD = (Problem("odd", "even"),)


def scan_of(ranges: list[float], intensities: list[int], stamp_ns: int) -> Scan:
    return Scan(
        ranges,
        -0.5,
        0.5,
        0.1,
        30.0,
        intensities=intensities,
        stamp_ns=stamp_ns,
        frame_id="laser",
        header_problems=ODD,
    )


@pytest.fixture
def scan() -> Scan:
    return scan_of([1.0, 2.0, np.inf], [1, 2, 3], 5)


def sent(*values: float) -> np.ndarray:
    return np.frombuffer(np.array(values, np.float32).tobytes(), np.float32)


def test_only_what_is_given_differs(scan: Scan) -> None:
    after = scan.again(sent(3.0, np.nan, 0.05), sent(4, 5, 6), 7)
    whole = scan_of([3.0, np.nan, 0.05], [4, 5, 6], 7)
    assert repr(after) == repr(whole)
    assert after.validity.tolist() == whole.validity.tolist()
    assert after.nearest() == whole.nearest()
    assert after.angles is scan.angles


def test_nothing_that_was_worked_out_of_other_ranges_is_kept(scan: Scan) -> None:
    assert (scan.counts[Validity.READING], scan.nearest().range) == (2, 1.0)  # type: ignore[union-attr]
    after = scan.again(sent(np.inf, np.inf, 9.0), None, None)
    assert (after.counts[Validity.READING], after.nearest().range) == (1, 9.0)  # type: ignore[union-attr]
    assert after.again(sent(7.0, 8.0, 9.0), None, None).counts[Validity.READING] == 3


def test_without_intensities_they_stay(scan: Scan) -> None:
    assert scan.again(sent(1, 2, 3), None, None).intensities.tolist() == [1, 2, 3]


def test_arrays_that_could_change_are_copied_and_others_kept(scan: Scan) -> None:
    frozen, loose = sent(1, 2, 3), np.array([1, 2, 3], np.float32)
    assert scan.again(frozen, None, None).ranges is frozen
    after = scan.again(loose, None, None)
    loose[0] = 9
    assert after.ranges.tolist() == [1, 2, 3]
    assert scan.again(np.array([1.0, 2.0, 3.0]), None, None).ranges.dtype == np.float32


def test_another_number_of_rays_is_refused(scan: Scan) -> None:
    with pytest.raises(ValueError, match="ranges: expected 3 values as in the scan before, got 2"):
        scan.again(sent(1, 2), None, None)
    with pytest.raises(ValueError, match="intensities: expected 3 values as in the scan before, got 1"):
        scan.again(sent(1, 2, 3), sent(1), None)


def test_what_is_masked_is_not_a_measurement(scan: Scan) -> None:
    masked = np.ma.masked_greater([1, 2, 3], 2)
    for after in (scan.again(masked, None, None), Scan(masked, -0.5, 0.5, 0.1, 30.0)):
        assert after.validity.tolist() == [Validity.READING, Validity.READING, Validity.NO_MEASUREMENT]
    assert masked.dtype.kind == "i"

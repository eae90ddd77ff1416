from __future__ import annotations

import numpy as np

from robowidgets.scanogram.scan_times import ScanTimes, Thinned

SECOND = 1_000_000_000


def clock(*seconds: float) -> ScanTimes:
    return ScanTimes((np.array(seconds) * SECOND).astype(np.int64), 0)


def test_a_scan_lasts_until_the_next_but_not_over_a_gap() -> None:
    even = clock(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 20, 21)
    assert even.ends.tolist() == [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 21, 22]
    assert even.notes == ()


def test_the_last_scan_of_a_part_lasts_as_long_as_others_however_near_the_next_part_is() -> None:
    times = (np.array([0, 1, 2, 4, 5, 6]) * SECOND).astype(np.int64)
    thinned = Thinned(np.array([2, 5]), 0.5, 100)
    assert ScanTimes(times, 0).ends.tolist() == [1, 2, 4, 5, 6, 7]
    assert ScanTimes(times, 0, thinned).ends.tolist() == [1, 2, 3, 5, 6, 7]
    alone = ScanTimes(times[::3], 0, Thinned(np.array([0, 1]), 0.5, 100))
    assert (alone.ends.tolist(), alone.pause, alone.notes) == ([0.5, 4.5], 0.5, ())


def test_between_two_times_are_all_scans_on_show() -> None:
    even = clock(0, 1, 2, 3, 4)
    assert even.between(1.5, 3.0) == (1, 3)
    assert even.between(1.0, 1.5) == (1, 2)
    assert even.between(7.0, 9.0) == (5, 5)


def test_a_clock_that_goes_back_is_reported_and_the_order_of_arrival_stays() -> None:
    back = clock(0, 1, 2, 1.5, 3)
    assert back.starts.tolist() == [0, 1, 2, 2, 3]
    assert back.notes == ("the clock goes back once: shown in the order of arrival",)


def test_a_clock_that_stands_still_is_reported() -> None:
    assert clock(1, 1, 1).notes == ("the clock stands still: all 3 scans have the same time",)
    assert clock(1).notes == ()
    assert clock(3, 2, 1).notes == ("the clock goes back 2 times: shown in the order of arrival",)


def test_a_cell_lasts_from_its_first_scan_to_the_end_of_its_last() -> None:
    starts, ends = clock(0, 1, 2, 3, 4).cells(1, 0, 3)
    assert starts.tolist() == [0, 2, 4]
    assert ends.tolist() == [2, 4, 5]

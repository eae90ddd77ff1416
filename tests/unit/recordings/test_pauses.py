"""The known state of a topic that falls silent."""

from __future__ import annotations

import numpy as np
import pytest

from robowidgets.recordings.search._silence import mark_stale
from robowidgets.recordings.search._steps import NO, UNKNOWN, YES, Steps, steps
from robowidgets.samples.staleness import RECORDED, usual_step

S = 1_000_000_000


@pytest.mark.parametrize(
    ("times", "usual"),
    [([], 0), ([5], 0), ([5, 5], 0), ([0, 1, 2, 100], 1), ([0, 0, 0, 3, 3, 3, 6], 3)],
)
def test_the_usual_step_is_the_median_of_the_continuing_ones(times: list[int], usual: int) -> None:
    assert usual_step(np.array(times, np.int64)) == usual


def test_a_pause_is_two_seconds_or_two_steps() -> None:
    assert [RECORDED.after(usual, S) for usual in (0, S // 10, 3 * S)] == [2 * S, 2 * S, 6 * S]


def aged(held: Steps, *topics: tuple[list[int], list[bool]], end: int) -> list[tuple[int, int]]:
    told = [(np.array(times, np.int64) * S, np.array(depends, bool)) for times, depends in topics]
    result = mark_stale(held, told, end * S)
    return list(zip((result.times // S).tolist(), result.values.tolist(), strict=True))


def test_what_is_old_is_unknown_from_a_step_after_the_last_sample_on() -> None:
    times = [0, 1, 2, 9, 10]
    held = steps(np.array(times) * S, [YES, NO, YES, YES, NO])
    told = (times, [True] * 5)
    assert aged(held, told, end=12) == [(0, YES), (1, NO), (2, YES), (3, UNKNOWN), (9, YES), (10, NO)]
    assert aged(held, told, end=13)[-2:] == [(10, NO), (11, UNKNOWN)]


def test_a_lone_sample_holds_at_its_moment() -> None:
    held = steps([0], [YES])
    assert aged(held, ([0], [True]), end=2) == [(0, YES)]
    assert aged(held, ([0], [True]), end=3) == [(0, YES), (0, UNKNOWN)]


def test_of_no_samples_nothing_is_old() -> None:
    assert aged(steps([], []), ([], []), end=9) == []
    assert aged(steps([0], [YES]), ([], [False]), end=9) == [(0, YES)]


def test_only_what_depends_on_an_old_sample_is_unknown() -> None:
    slow, fast = [0, 1, 6, 7], list(range(8))
    held = steps(np.array(fast) * S, [YES] * 8)
    depends = [True, True, True, True, False, False, True, True]
    assert [value for _, value in aged(held, (slow, depends), (fast, [True] * 8), end=7)] == [
        *(YES, YES, UNKNOWN, UNKNOWN, UNKNOWN),  # the state known a step after 1 s, and the results at 2 and 3 s
        *(YES, YES, YES, YES),
    ]
    depends = [True, False, False, False, False, False, True, True]
    assert {value for _, value in aged(held, (slow, depends), end=7)} == {YES}

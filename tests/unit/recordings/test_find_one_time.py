"""Finding among samples that share a time: two scans of one timestamp, or a clock that was set back and is held."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.recordings.search._steps import NO, UNKNOWN, YES, combined, inverted, spans, steps
from robowidgets.recordings.search.instant import together

from . import sweeps

NEAR = conditions.nearest_below(0.3)


def near(moment: Any) -> bool:
    return bool(moment.scan.nearest().range < 0.3)


def find(folder: Path, scans: Sequence[tuple[float, float]], condition: Any) -> list[tuple[float, float]]:
    """The spans of a condition, from scans with a time and a range each."""
    rows = ((seconds, sweeps.scan(sweeps.START_NS, [seen])) for seconds, seen in scans)
    with robowidgets.open(sweeps.write(folder / "x", rows)) as recording:
        return [(span.start, span.end) for span in recording.find(condition)]


@pytest.mark.parametrize("condition", [NEAR, near, NEAR & near, NEAR | near, ~~NEAR])
class TestOfTwoScansAtOneTime:
    def test_the_first_is_found_at_that_moment(self, tmp_path: Path, condition: Any) -> None:
        assert find(tmp_path, [(0, 5), (1, 0.2), (1, 5), (2, 5)], condition) == [(1, 1)]

    def test_the_last_is_found_until_the_next(self, tmp_path: Path, condition: Any) -> None:
        assert find(tmp_path, [(0, 5), (1, 5), (1, 0.2), (2, 5)], condition) == [(1, 2)]

    def test_one_that_is_far_cuts_no_span_in_two(self, tmp_path: Path, condition: Any) -> None:
        assert find(tmp_path, [(0, 0.2), (1, 5), (1, 0.2), (2, 5)], condition) == [(0, 2)]
        assert find(tmp_path / "2", [(0, 0.2), (1, 0.2), (1, 5), (2, 5)], condition) == [(0, 1)]

    def test_the_first_of_the_last_is_found(self, tmp_path: Path, condition: Any) -> None:
        assert find(tmp_path, [(0, 5), (1, 0.2), (1, 5)], condition) == [(1, 1)]


@pytest.mark.parametrize("condition", [NEAR, near])
def test_what_was_held_after_the_clock_was_set_back_is_found(tmp_path: Path, condition: Any) -> None:
    scans = [(4.0, 5), (5.0, 5), (1.0, 5), (2.0, 0.2), (3.0, 5), (6.0, 5)]
    assert find(tmp_path, scans, condition) == [(1, 1)]


def test_each_of_two_scans_counts_for_its_opposite_too(tmp_path: Path) -> None:
    scans = [(0, 0.2), (1, 5), (1, 0.2), (2, 0.2)]
    assert find(tmp_path, scans, ~NEAR) == [(1, 1)]
    assert find(tmp_path / "2", scans, lambda moment: not near(moment)) == [(1, 1)]


class TestSteps:
    TWICE = steps([0, 10, 10, 20], [NO, YES, NO, NO])

    def test_of_several_values_at_a_time_any_may_go_with_any_of_another(self) -> None:
        other = steps([10, 10], [NO, YES])
        assert spans(combined([self.TWICE, other], np.min), 30) == [(10, 10)]
        assert spans(combined([self.TWICE, inverted(other)], np.min), 30) == [(10, 10)]
        assert spans(combined([self.TWICE, steps([5], [UNKNOWN])], np.min), 30) == []
        assert spans(combined([self.TWICE, steps([5], [YES])], np.min), 30) == [(10, 10)]

    def test_what_comes_of_several_is_joined_further(self) -> None:
        both = combined([self.TWICE, steps([0, 15], [YES, NO])], np.min)
        assert spans(both, 30) == [(10, 10)]
        assert spans(inverted(both), 30) == [(0, 30)]
        assert spans(combined([both, inverted(both)], np.max), 30) == [(0, 30)]

    def test_a_value_of_its_own_time_is_not_joined_with_the_one_before(self) -> None:
        # At 10 one begins as the other ends.
        one, other = steps([0, 10, 10], [NO, YES, YES]), steps([0, 10], [YES, NO])
        assert spans(combined([one, other], np.min), 30) == []


def test_a_function_sees_topics_of_one_time_together() -> None:
    topics = {"a": [(0, "a0"), (1, "a1"), (1, "a2")], "b": [(1, "b1"), (2, "b2")], "c": []}
    grouped = together({topic: iter(samples) for topic, samples in topics.items()})  # type: ignore[arg-type, misc]
    assert list(grouped) == [(0, {"a": "a0"}), (1, {"a": "a1", "b": "b1"}), (1, {"a": "a2"}), (2, {"b": "b2"})]

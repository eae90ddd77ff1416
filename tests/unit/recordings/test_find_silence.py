"""Finding around the silence of a topic: a condition that held is not known to continue."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

import robowidgets
from robowidgets import conditions

from . import sweeps, topics
from .topics import every

Samples = Sequence[tuple[float, float]]
Find = Callable[..., list[tuple[float, float]]]

NEAR = conditions.nearest_below(0.3)
FAST = conditions.speed_above(0.2)


def near(moment: Any) -> bool:
    return bool(moment.scan.nearest().range < 0.3)


def fast(moment: Any) -> bool:
    return bool(moment.speed.linear[0] > 0.2)


CLOCK = every(1, 0, 41, 0)
"""Commands that make the recording 40 s long."""


@pytest.fixture
def find(tmp_path: Path) -> Find:
    def found(written: Mapping[str, Samples], condition: Any, **more: Any) -> list[tuple[float, float]]:
        folder = tmp_path / str(len(list(tmp_path.iterdir())))
        with robowidgets.open(topics.write(folder, written)) as recording:
            return [(round(span.start, 6), round(span.end, 6)) for span in recording.find(condition, **more)]

    return found


@pytest.mark.parametrize("condition", [NEAR, near, NEAR & near, NEAR | near, ~~NEAR])
class TestScans:
    def test_hold_one_step_into_a_silence_and_are_unknown_until_the_next(self, find: Find, condition: Any) -> None:
        scans = [*every(0.5, 0, 10, 0.2), *every(0.5, 30, 40, 0.2), (40, 9)]
        assert find({"/scan": scans}, condition) == [(0, 10), (30, 40)]
        assert find({"/scan": scans, "/cmd_vel": CLOCK}, condition) == [(0, 10), (30, 40)]

    def test_hold_one_step_past_the_last(self, find: Find, condition: Any) -> None:
        assert find({"/scan": every(0.5, 0, 20, 0.2), "/cmd_vel": CLOCK}, condition) == [(0, 20)]

    def test_hold_through_a_pause_that_is_usual(self, find: Find, condition: Any) -> None:
        assert find({"/scan": [*every(5, 0, 20, 0.2), (25, 9)]}, condition) == [(0, 25)]
        assert find({"/scan": [*every(0.1, 0, 1, 0.2), (2.9, 9)]}, condition) == [(0, 2.9)]

    def test_hold_to_the_end_that_comes_soon(self, find: Find, condition: Any) -> None:
        assert find({"/scan": every(0.5, 0, 39, 0.2), "/cmd_vel": CLOCK}, condition) == [(0, 40)]

    def test_hold_at_their_moment_if_there_is_one(self, find: Find, condition: Any) -> None:
        assert find({"/scan": [(7, 0.2)], "/cmd_vel": CLOCK}, condition) == [(7, 7)]

    def test_of_one_time_count_as_one(self, find: Find, condition: Any) -> None:
        written = {"/scan": [(0, 9), (7, 0.2), (7, 9), (7, 0.2)], "/cmd_vel": CLOCK}
        assert find(written, condition) == [(7, 14)]

    def test_of_a_clock_that_stands_still_hold_until_it_goes_on(self, find: Find, condition: Any) -> None:
        scans = [(3 * (i // 9), 0.2) for i in range(90)]
        assert find({"/scan": scans, "/cmd_vel": CLOCK}, condition) == [(0, 30)]


@pytest.mark.parametrize("condition", [FAST, fast, FAST & fast])
def test_speeds_hold_one_step_into_a_silence(find: Find, condition: Any) -> None:
    speeds = [*every(0.1, 0, 5, 0.5), *every(0.1, 3605, 3610, 0.5)]
    assert find({"/odom": speeds}, condition) == [(0, 5), (3605, 3609.9)]


def test_touches_hold_until_a_message_says_otherwise(find: Find) -> None:
    written = {"/bumper": [(1, 0), (2, 1), (2.1, 1), (30, 0)], "/cmd_vel": CLOCK}
    assert find(written, conditions.touched()) == [(2, 30)]
    assert find(written, lambda moment: moment.touch.touched["left"]) == [(2, 30)]


def test_a_gap_is_as_long_as_the_silence(find: Find) -> None:
    assert find({"/scan": [*every(0.5, 0, 10, 0.2), (30, 0.2)]}, conditions.gap(2)) == [(9.5, 30)]


class TestJoined:
    WRITTEN: Mapping[str, Samples] = {"/scan": every(0.5, 0, 20, 0.2), "/odom": every(0.5, 0, 40, 0.5)}

    def test_an_unknown_value_is_neither_true_nor_false(self, find: Find) -> None:
        assert find(self.WRITTEN, NEAR & FAST) == [(0, 20)]
        assert find(self.WRITTEN, NEAR | FAST) == [(0, 39.5)]
        assert find(self.WRITTEN, ~NEAR) == []
        assert find(self.WRITTEN, ~NEAR & FAST) == []

    def test_a_function_knows_what_depends_on_no_silent_topic(self, find: Find) -> None:
        assert find(self.WRITTEN, lambda moment: near(moment) and fast(moment)) == [(0, 20)]
        assert find(self.WRITTEN, lambda moment: fast(moment) or near(moment)) == [(0, 39.5)]
        assert find(self.WRITTEN, lambda moment: moment.seconds > 5) == [(5.5, 39.5)]
        assert find(self.WRITTEN, lambda moment: moment.seconds > 5 and near(moment)) == [(5.5, 20)]
        assert find(self.WRITTEN, lambda moment: moment.seconds > 30 or near(moment)) == [(0, 20), (30.5, 39.5)]


def test_a_silence_is_seen_across_the_pieces_in_which_a_file_is_read(tmp_path: Path) -> None:
    scans = [
        (i / 10 + (i >= 450) * 60, sweeps.scan(sweeps.START_NS, [0.2 if i >= 440 else 9.0] * (1000 + i // 450)))
        for i in range(900)
    ]
    with robowidgets.open(sweeps.write(tmp_path / "x", scans)) as recording:
        assert len(list(recording.scans().chunks())) > 2
        for condition in (NEAR, near):
            spans = recording.find(condition)
            assert [(span.start, span.end) for span in spans] == [(44, 45), (105, pytest.approx(149.9))]

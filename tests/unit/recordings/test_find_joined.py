"""The nearest reading and the number of spans of joined conditions, against plain loops over the samples in force."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import robowidgets
from robowidgets import Recording, conditions
from robowidgets.recordings.search.base import Condition

from . import recorded, sweeps

NEAR = conditions.nearest_below(0.3, topic="/scan")
TURNS = abs(conditions.field("/odom.twist.twist.angular.z")) > 0.3
LEFT = conditions.when(lambda moment: moment["/odom"].angular[2] > 0)
FAST = conditions.speed_above(0.2, topic="/odom")

Row = tuple[float, float, float | None, float | None]
"""Start and end of a span in seconds, its nearest distance, and its number."""


class Sampled(NamedTuple):
    """Samples of a topic: nanoseconds and a number each, and how long the last before a silence is in force."""

    times: NDArray[np.int64]
    numbers: NDArray[np.float64]
    usual: int

    @classmethod
    def of(cls, times: NDArray[np.int64], numbers: NDArray[Any]) -> Sampled:
        return cls(times, np.asarray(numbers, np.float64), round(float(np.median(np.diff(times)))))

    def edges(self, end_ns: int) -> list[int]:
        return [*self.times.tolist(), *(self.stale_from(i, end_ns) for i in range(len(self.times)))]

    def stale_from(self, i: int, end_ns: int) -> int:
        until = int(self.times[i + 1]) if i + 1 < len(self.times) else end_ns
        length = until - int(self.times[i])
        return int(self.times[i]) + self.usual if length > max(2e9, 2 * self.usual) else until + 1

    def at(self, time_ns: int, end_ns: int) -> float | None:
        i = int(np.searchsorted(self.times, time_ns, side="right")) - 1
        return None if i < 0 or time_ns >= self.stale_from(i, end_ns) else float(self.numbers[i])


Test = Callable[[Any, Any], tuple[Any, bool, bool]]
"""From a distance and a number in force: is it true, and does it rest on the distance, and on the number?"""


def plain(recording: Recording, scans: Sampled, numbers: Sampled, test: Test) -> list[Row]:
    """The spans by a plain loop over all times at which a sample comes or is stale."""
    start_ns, end_ns = recording.start_ns or 0, recording.end_ns or 0
    edges = sorted({*scans.edges(end_ns), *numbers.edges(end_ns), end_ns})
    edges = [edge for edge in edges if edge <= end_ns]
    rows: list[tuple[float, float, float | None, float | None]] = []
    was_true = False
    for begin, end in zip(edges, [*edges[1:], end_ns], strict=True):
        distance, number = scans.at(begin, end_ns), numbers.at(begin, end_ns)
        is_true, by_distance, by_number = test(distance, number)
        if is_true:
            first, _, nearest, most = rows.pop() if was_true else ((begin - start_ns) / 1e9, 0.0, None, None)
            if by_distance and distance is not None:
                nearest = distance if nearest is None else min(nearest, distance)
            if by_number and number is not None:
                most = abs(number) if most is None else max(most, abs(number))
            rows.append((first, (end - start_ns) / 1e9, nearest, most))
        was_true = bool(is_true)
    return rows


def found(recording: Recording, condition: Condition) -> list[Row]:
    return [(span.start, span.end, span.nearest, span.value) for span in recording.find(condition)]


def check(recording: Recording, condition: Condition, scans: Sampled, numbers: Sampled, test: Test) -> list[Row]:
    # Of samples with one time, a plain loop sees the last; the others make spans of 0 s.
    expected = [row for row in plain(recording, scans, numbers, test) if row[1] > row[0]]
    spans = [span for span in recording.find(condition) if span.seconds]
    assert [(span.start, span.end) for span in spans] == [row[:2] for row in expected]
    for span, (*_, nearest, number) in zip(spans, expected, strict=True):
        assert (span.nearest is None, span.value is None) == (nearest is None, number is None), span
        assert span.nearest is None or span.nearest == pytest.approx(nearest, abs=1e-6), span
        if len(np.unique(numbers.times)) < len(numbers.times):
            continue
        assert span.value is None or span.value == pytest.approx(number), span
        for of, time_ns, given in ((scans, span.nearest_ns, nearest), (numbers, span.value_ns, number)):
            if time_ns is not None:
                in_force = of.at(time_ns, recording.end_ns or 0)
                assert in_force is not None
                assert abs(in_force) == pytest.approx(given, abs=1e-6), "the time of its sample"
                assert time_ns < max(span.end_ns, span.start_ns + 1) or span.end_ns == recording.end_ns
    return expected


def is_near(distance: float | None) -> bool | None:
    return None if distance is None else bool(distance < np.float32(0.3))


def turns(number: float | None) -> bool | None:
    return None if number is None else abs(number) > 0.3


def is_left(number: float | None) -> bool | None:
    return None if number is None else number > 0


CASES: dict[str, tuple[Condition, Test]] = {
    "and": (NEAR & TURNS, lambda d, n: (is_near(d) and turns(n), True, True)),
    "or": (NEAR | TURNS, lambda d, n: (is_near(d) or turns(n), bool(is_near(d)), bool(turns(n)))),
    "and not": (~NEAR & TURNS, lambda d, n: (is_near(d) is False and turns(n), False, True)),
    "not and": (
        ~(NEAR & TURNS),
        lambda d, n: (is_near(d) is False or turns(n) is False, False, False),
    ),
    "not not": (~(~NEAR) & TURNS, lambda d, n: (is_near(d) and turns(n), True, True)),
    "not or not": (~(~NEAR | ~TURNS), lambda d, n: (is_near(d) and turns(n), True, True)),
    "or and": (
        LEFT | (NEAR & TURNS),
        lambda d, n: (
            is_left(n) or (is_near(d) and turns(n)),
            bool(is_near(d) and turns(n)),
            bool(is_near(d) and turns(n)),
        ),
    ),
}


@pytest.fixture
def drive(tmp_path: Path) -> Recording:
    """Scans three times a second and speeds at other times, with silences of both, from 8 and from 16 s on."""
    rows: list[tuple[float, str, Any]] = []
    for i in range(70):
        at = i * 0.33 + (4 if i > 24 else 0)
        rows.append((at, "/scan", sweeps.scan(sweeps.START_NS, [2.0, 0.15 + (i * 7 % 10) / 40, 3.0])))
    for i in range(200):
        at = 0.05 + i * 0.12 + (4 if i > 130 else 0)
        twist = {"angular": {"z": (i * 5 % 9 - 4) / 9}}
        rows.append((at, "/odom", {"child_frame_id": "base_link", "twist": {"twist": twist}}))
    topics = {"/scan": sweeps.TYPE, "/odom": "nav_msgs/msg/Odometry"}
    return robowidgets.open(recorded.write(tmp_path / "drive", topics, sorted(rows, key=lambda row: row[0])))


def samples(recording: Recording) -> tuple[Sampled, Sampled]:
    scans, odom = recording.scans("/scan"), recording.fields("/odom")
    return Sampled.of(scans.times_ns, scans.distances()), Sampled.of(
        odom.times_ns, np.asarray(odom["twist.twist.angular.z"])
    )


@pytest.mark.parametrize("name", CASES)
def test_a_span_has_the_nearest_and_the_greatest_of_the_samples_in_force_that_made_it_true(
    drive: Recording, name: str
) -> None:
    condition, test = CASES[name]
    scans, numbers = samples(drive)
    expected = check(drive, condition, scans, numbers, test)
    assert len(expected) > 5


def test_conditions_over_time_keep_the_samples_of_their_spans(drive: Recording) -> None:
    both = NEAR & TURNS
    rows = found(drive, both)
    assert found(drive, both.first_of_drive()) == rows[:1]
    assert found(drive, both.for_longer(0.2)) == [row for row in rows if round((row[1] - row[0]) * 1e9) > 200_000_000]
    assert found(drive, NEAR.within(0.001, after=~NEAR | NEAR) & TURNS) == rows


def test_functions_join_as_conditions_do(drive: Recording) -> None:
    near = conditions.when(lambda moment: moment["/scan"].distance() < 0.3)
    assert [row[:3] for row in found(drive, near & TURNS)] == [row[:3] for row in found(drive, NEAR & TURNS)]
    assert [row[:3] for row in found(drive, TURNS & ~near)] == [row[:3] for row in found(drive, TURNS & ~NEAR)]


SEEN = ((0, 0.1), (1, 0.25), (1, 0.2), (2, 0.22))
"""Seconds and metres."""


def test_a_sample_that_ended_at_the_start_of_a_span_is_not_of_it(tmp_path: Path) -> None:
    rows = [
        *((at, "/scan", sweeps.scan(sweeps.START_NS, [near])) for at, near in SEEN),
        *((at, "/on", {"data": at in (1.0, 1.5)}) for at in (0.0, 1.0, 1.2, 1.5, 1.8)),
    ]
    topics = {"/scan": sweeps.TYPE, "/on": "std_msgs/msg/Bool"}
    written = recorded.write(tmp_path / "x", topics, sorted(rows, key=lambda row: row[0]))
    on = conditions.field("/on.data") == True  # noqa: E712  # a condition
    with robowidgets.open(written) as recording:
        spans = recording.find(NEAR & on)
    assert [(span.start, span.end) for span in spans] == [(1.0, 1.2), (1.5, 1.8)]
    assert [span.nearest for span in spans] == pytest.approx([0.2, 0.2])
    assert [span.nearest_ns for span in spans] == [recorded.START_NS + 10**9] * 2


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("path", ["good/turtlebot3_gazebo.bag", "good/neato_fsm"])
def test_they_equal_plain_loops_over_real_recordings(data: Path, path: str, name: str) -> None:
    condition, test = CASES[name]
    with robowidgets.open(data / path) as recording:
        scans, numbers = samples(recording)
        check(recording, condition, scans, numbers, test)


def test_a_real_bump_has_the_speed_before_it(data: Path) -> None:
    with robowidgets.open(data / "good" / "neato_fsm") as recording:
        near = conditions.nearest_below(0.25, topic="/scan")
        values = [span.value for span in recording.find(FAST & near)]
    assert values
    assert None not in values

"""Conditions over time: for longer, within some seconds after another, the first of a drive, and several times."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import robowidgets
from robowidgets import Recording, conditions, fleet
from robowidgets.recordings.search.base import Condition

from . import recorded, sweeps

Spans = list[tuple[float, float]]


def found(recording: Recording, condition: Condition) -> Spans:
    return [(span.start, span.end) for span in recording.find(condition)]


@pytest.fixture
def drive(tmp_path: Path) -> Recording:
    """Flags at 10 Hz for 20 s: /a is true in the spans of `ALL`, /b from 2.5 to 3 s."""
    spans_of_a = [(1.0, 1.5), (3.0, 6.0), (7.0, 7.2), (7.5, 8.0), (18.0, 99.0)]
    rows: list[tuple[float, str, dict[str, Any]]] = []
    for i in range(201):
        at = i / 10
        rows.append((at, "/a", {"data": any(start <= at < end for start, end in spans_of_a)}))
        rows.append((at, "/b", {"data": 2.5 <= at < 3.0}))
    topics = dict.fromkeys(("/a", "/b"), "std_msgs/msg/Bool")
    return robowidgets.open(recorded.write(tmp_path / "drive", topics, rows))


A, B = conditions.field("/a.data") == True, conditions.field("/b.data") == True  # noqa: E712  # conditions
ALL = [(1.0, 1.5), (3.0, 6.0), (7.0, 7.2), (7.5, 8.0), (18.0, 20.0)]


def test_each_condition_over_time_chooses_spans(drive: Recording) -> None:
    assert found(drive, A) == ALL
    assert found(drive, A.for_longer(0.5)) == [(3, 6), (18, 20)], "0.5 s is not longer than 0.5 s"
    assert found(drive, A.for_longer(0.49)) == [ALL[0], ALL[1], ALL[3], ALL[4]]
    assert found(drive, A.first_of_drive()) == ALL[:1]
    assert found(drive, A.for_longer(1).first_of_drive()) == ALL[1:2]
    assert found(drive, A.first_of_drive().for_longer(1)) == []
    assert found(drive, A.count(2, within=1)) == ALL[2:4]
    assert found(drive, A.count(3, within=4.5)) == ALL[1:4]
    assert found(drive, A.count(3, within=4.4)) == []
    assert found(drive, A.count(5, within=17)) == ALL
    assert found(drive, A.count(6, within=100)) == []
    assert found(drive, A.within(2, after=B)) == [(3, 5)], "2 s after the end of the other, and while it is true"
    assert found(drive, B.within(1.5, after=A)) == [(2.5, 3)]
    assert found(drive, A.within(0.5, after=A)) == ALL
    assert found(drive, A.within(10, after=B)) == ALL[1:4]


def test_a_moment_counts_for_exactly_as_long_as_it_is_said(drive: Recording) -> None:
    of_a, of_b = conditions.event("/a"), conditions.event("/b")
    assert found(drive, of_b)[-1] == (3, 3)
    assert found(drive, of_a.within(3, after=of_b)) == [(3, 3), (6, 6)], "6 s is at most 3 s after 3 s"
    assert found(drive, B)[-1] == (2.5, 3)
    assert found(drive, of_a.within(3, after=B)) == [(3, 3), (6, 6)], "a span that ends at 3 s, too"


def test_they_join_with_others_and_their_opposites(drive: Recording) -> None:
    assert found(drive, A.for_longer(2) & ~A.first_of_drive()) == ALL[1:2]
    assert found(drive, B | A.for_longer(2)) == [(2.5, 6)]
    short = ~A.for_longer(1) & A
    assert found(drive, short) == [ALL[0], ALL[2], ALL[3]]
    pressed = conditions.when(lambda moment: any(moment["/b"].touched.values()))
    assert found(drive, pressed.within(1.2, after=A)) == [(2.5, 2.7)]
    assert str((A.for_longer(2) & ~B.first_of_drive()).of_moment) == str(A & ~B), "for the picture of a moment"


def test_an_unknown_time_ends_a_span_and_stays_unknown(tmp_path: Path) -> None:
    near = sweeps.write(
        tmp_path / "x",
        ((at, sweeps.scan(sweeps.START_NS, [0.2])) for at in (0, 0.1, 0.2, 0.3, 0.4, 9.0, 9.1, 9.2, 9.3, 9.4)),
    )
    recording = robowidgets.open(near)
    condition = conditions.nearest_below(0.3)
    plain = found(recording, condition)
    assert len(plain) == 2, "a silence lies between"
    assert found(recording, condition.for_longer(1)) == []
    for made in (condition.for_longer(1), condition.first_of_drive()):
        for start, end in found(recording, ~made):
            assert not start <= 5.0 < end, "during the silence nothing is known"


def test_they_equal_plain_loops_over_the_spans_of_real_recordings(data: Path) -> None:
    loops: list[tuple[Callable[[Condition], Condition], Callable[[Spans], Spans]]] = [
        (lambda one: one.for_longer(2), lambda spans: [span for span in spans if span[1] - span[0] > 2]),
        (lambda one: one.first_of_drive(), lambda spans: spans[:1]),
        (
            lambda one: one.count(3, within=20),
            lambda spans: [
                span
                for i, span in enumerate(spans)
                if any(j >= 0 and j + 2 < len(spans) and spans[j + 2][0] - spans[j][0] <= 20 for j in (i - 2, i - 1, i))
            ],
        ),
    ]
    for path in ("good/turtlebot3_gazebo.bag", "good/neato_fsm", "topics/scitos_amcl.bag"):
        with robowidgets.open(data / path) as recording:
            for plain in (conditions.speed_above(0.05), conditions.speed_above(0.1, "angular.z")):
                spans = found(recording, plain)
                for make, loop in loops:
                    assert found(recording, make(plain)) == loop(spans), (path, str(make(plain)))


def test_an_index_loses_none_of_them_and_keeps_the_results(tmp_path: Path) -> None:
    drives = fleet.index(robowidgets.SAMPLE, output=tmp_path / "drives.parquet")
    near, fast = conditions.nearest_below(0.3), conditions.speed_above(0.1)
    for condition in (
        near.for_longer(0.5),
        ~near.for_longer(0.5),
        near.first_of_drive(),
        near.count(2, within=10),
        near.within(3, after=conditions.touched()),
        near.for_longer(0.2) & fast,
    ):
        plain = [tuple(span)[:2] for span in robowidgets.open(robowidgets.SAMPLE).find(condition)]
        assert plain
        for _ in range(2):  # the second time as they were stored
            assert [(hit.start, hit.end) for hit in drives.find(condition)] == plain, condition
    assert drives.candidates(conditions.nearest_below(0.01).for_longer(1)) == []


def test_wrong_numbers_are_refused_and_one_moment_does_not_decide(drive: Recording) -> None:
    for make, error, text in (
        (lambda: A.for_longer(0), ValueError, "for_longer: expected seconds above 0, got 0"),
        (lambda: A.for_longer("2"), TypeError, "for_longer: expected a number"),
        (lambda: A.within(-1, after=B), ValueError, "within: expected seconds above 0"),
        (lambda: A.within(1, after=3), TypeError, "condition: expected a function"),
        (lambda: A.count(1, within=2), ValueError, "times: expected 2 or more, got 1"),
        (lambda: A.count(2.5, within=2), TypeError, "times: expected a whole number, got 2.5"),
        (lambda: A.count(2, within=float("nan")), ValueError, "within: expected seconds above 0"),
    ):
        with pytest.raises(error, match=text):
            make()
    for condition in (A.for_longer(1), A.first_of_drive(), A.count(2, within=1), A.within(1, after=B)):
        with pytest.raises(TypeError, match=r"one moment does not decide it, so only Recording\.find finds it"):
            condition.judge(drive)
        with pytest.raises(TypeError, match="one moment does not decide it"):
            condition.reads  # noqa: B018

"""Finding the times at which a condition held in a recording."""

from __future__ import annotations

import gc
import itertools
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import RecordingError, conditions
from robowidgets.behaviors import Drive
from robowidgets.behaviors.simulation import ProgramRun
from robowidgets.kinds import KINDS
from robowidgets.laser.row import LASER
from robowidgets.reasons.look import Reasons
from robowidgets.recordings import UnknownTopicError
from robowidgets.recordings.search import _stops, base
from robowidgets.recordings.search._search import Search
from robowidgets.recordings.search._steps import NO, UNKNOWN, YES, Steps, combined, inverted, spans, steps
from robowidgets.recordings.search.base import FunctionCondition
from robowidgets.recordings.search.instant import Now
from robowidgets.recordings.search.spans import Spans
from robowidgets.recordings.span import Span
from robowidgets.samples.sector import ALL_ROUND

from ...conftest import ROOT
from ..pages import display_html
from . import hazards, recorded, robot, sweeps
from .sweeps import START_NS

INF, NAN = float("inf"), float("nan")


@pytest.fixture
def drive(tmp_path: Path) -> robowidgets.Recording:
    """See `robot.write`: scan i sees 1 + i / 100 m, the speed is i / 100 m/s, the left bumper is down at 2 and 6 s."""
    return robowidgets.open(robot.write(tmp_path / "drive"))


def found(recording: robowidgets.Recording, condition: Any, **more: Any) -> list[tuple[float, float]]:
    return [(span.start, span.end) for span in recording.find(condition, **more)]


class TestSteps:
    def test_two_hold_where_both_do_and_unknown_is_neither(self) -> None:
        a = Steps(np.array([0, 10, 20]), np.array([YES, NO, YES], np.int8))
        b = Steps(np.array([5, 15]), np.array([YES, NO], np.int8))
        both, either = combined([a, b], np.min), combined([a, b], np.max)
        assert both.times.tolist() == either.times.tolist() == [0, 5, 10, 15, 20]
        assert both.values.tolist() == [UNKNOWN, YES, NO, NO, NO]
        assert either.values.tolist() == [YES, YES, YES, NO, YES]
        assert inverted(both).values.tolist() == [UNKNOWN, NO, YES, YES, YES]

    def test_spans_end_with_the_next_step_or_the_end(self) -> None:
        held = steps([0, 1, 2, 3, 4], [YES, YES, NO, UNKNOWN, YES])
        assert spans(held, end_ns=9) == [(0, 2), (4, 9)]
        assert spans(steps([], []), end_ns=9) == []


class TestReadyMade:
    def test_touched(self, drive: robowidgets.Recording) -> None:
        assert found(drive, conditions.touched()) == [(2, 3), (6, 7)]
        assert found(drive, conditions.touched("left", topic="/bumper")) == [(2, 3), (6, 7)]
        assert found(drive, conditions.touched("right")) == []
        with pytest.raises(ValueError, match="label: /bumper has no sensor 'nose'; it has 'left', 'center', 'right'"):
            drive.find(conditions.touched("nose"))

    def test_nearest_below(self, drive: robowidgets.Recording) -> None:
        assert found(drive, conditions.nearest_below(1.105)) == [(0, 1.1)]
        assert found(drive, ~conditions.nearest_below(1.905)) == [(9.1, 10)]

    @pytest.mark.parametrize(
        ("sector", "held"),
        [
            (ALL_ROUND, [(0, 3)]),
            ((-0.55, -0.45), [(0, 1)]),
            ((-0.1, 0.05), [(1, 2)]),
            ((-0.5, -0.1), [(0, 1)]),
            ((0.45, 5.0), [(2, 3)]),
            ((0.4, -0.4), [(0, 1), (2, 3)]),
            ((-3.2, 3.2), [(0, 3)]),
            ((0.1, 0.2), []),
        ],
    )
    @pytest.mark.filterwarnings("ignore:sector .* covers 314.2")  # which is the meaning
    def test_within_a_sector(self, tmp_path: Path, sector: Any, held: Any) -> None:
        # Rays at -0.5, -0.4 ... 0.5 rad; the first, the middle and the last meet something near, one after the other.
        rows = [[0.2 if i == near else 5.0 for i in range(11)] for near in (0, 5, 10, 11)]
        scans = ((i, sweeps.scan(START_NS, row)) for i, row in enumerate(rows))
        recording = robowidgets.open(sweeps.write(tmp_path / "x", scans))
        assert found(recording, conditions.nearest_below(0.3, sector)) == held

    def test_what_is_not_a_reading_is_not_near_but_too_close_is(self, tmp_path: Path) -> None:
        rows = [0.0, 0.05, NAN, INF, -INF, 0.1]
        scans = ((i, sweeps.scan(START_NS, [row])) for i, row in enumerate(rows))
        recording = robowidgets.open(sweeps.write(tmp_path / "x", scans))
        assert found(recording, conditions.nearest_below(0.3)) == [(1, 2), (4, 5)]
        assert found(recording, ~conditions.nearest_below(0.3)) == [(3, 4)], "NaN and 0.0 alone leave it unknown"

    @pytest.mark.parametrize("limit", [0.3, 0.7])  # as float32 one is larger than as float64, the other smaller
    def test_a_limit_is_not_below_itself(self, tmp_path: Path, limit: float) -> None:
        # Both arguments are float32: with a Python number, NumPy 1 gives the next float64, which rounds to the limit.
        below = np.nextafter(np.float32(limit), np.float32(0))
        scans = ((i, sweeps.scan(START_NS, [row])) for i, row in enumerate((limit, below, 9)))
        recording = robowidgets.open(sweeps.write(tmp_path / "x", scans))
        assert found(recording, conditions.nearest_below(limit)) == [(1, 2)]

    def test_speed_above(self, drive: robowidgets.Recording) -> None:
        assert found(drive, conditions.speed_above(0.905)) == [(9.1, 10)]
        assert found(drive, conditions.speed_above(0.905, topic="/cmd_vel")) == [(9.1, 10)]
        assert found(drive, conditions.speed_above(0, axis="angular.z")) == []

    def test_gap(self, tmp_path: Path) -> None:
        times = [1.0, 1.1, 1.2, 4.0, 4.1]
        recording = robowidgets.open(sweeps.write(tmp_path / "x", ((t, sweeps.scan(START_NS, [1.0])) for t in times)))
        assert found(recording, conditions.gap(1)) == [(pytest.approx(0.2), pytest.approx(3.0))]
        assert found(recording, conditions.gap(3)) == []

    def test_silence_before_the_first_and_after_the_last_is_a_gap(self, drive: robowidgets.Recording) -> None:
        assert found(drive, conditions.gap(4, topic="/cmd_vel")) == [(0, 5)]
        assert found(drive, conditions.gap(2.5, topic="/bumper")) == [(3, 6), (7, 10)]
        assert found(drive, conditions.gap(0.5)) == []  # a command may be silent

    def test_a_release_without_a_message_ends_no_silence(self, tmp_path: Path) -> None:
        touches = {0.0: True, 2.0: True, 3.0: False}  # released at 0.15 s and 2.15 s by themselves
        recording = robowidgets.open(hazards.write(tmp_path / "x", touches))
        assert found(recording, conditions.gap(1.9, topic="/hazard_detection")) == [(0, 2)]

    def test_an_empty_list_of_contacts_says_that_nothing_touches(self, tmp_path: Path) -> None:
        messages = [(second, "/contacts", {"states": []}) for second in range(4)]
        recorded.write(tmp_path / "x", {"/contacts": "gazebo_msgs/msg/ContactsState"}, messages)
        recording = robowidgets.open(tmp_path / "x")
        assert [span[:2] for span in recording.find(~conditions.touched())] == [(0, 3)]
        assert len(recording.find(conditions.touched())) == 0

    def test_a_gap_of_nothing_is_refused_by_the_names_of_all_that_it_looked_for(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        recording = robowidgets.open(hazards.write(tmp_path / "x", {0.0: True, 2.0: True}))
        there = "x has no laser scans, measured speeds"
        with pytest.raises(UnknownTopicError, match=f"{there} or sonars: name the topic, as in topic="):
            recording.find(conditions.gap(1))
        monkeypatch.setitem(KINDS, "battery", replace(LASER, name="battery", noun="voltages"))
        with pytest.raises(UnknownTopicError, match=f"{there}, sonars or voltages: name the topic, as in topic="):
            recording.find(conditions.gap(1))

    def test_joined(self, drive: robowidgets.Recording) -> None:
        near, touched = conditions.nearest_below(1.255), conditions.touched()
        assert found(drive, near & touched) == [(2, 2.6)]
        assert found(drive, near | touched) == [(0, 3), (6, 7)]
        assert found(drive, touched & ~near) == [(2.6, 3), (6, 7)]
        assert found(drive, ~touched) == [(3, 6), (7, 10)]  # unknown until its first event
        assert found(drive, touched & (lambda moment: moment.seconds > 5)) == [(6, 7)]
        assert found(drive, (lambda moment: moment.seconds > 5) & touched) == [(6, 7)]
        assert str(near & ~touched) == "(nearest below 1.255 m & ~anything touched)"

    @pytest.mark.parametrize(
        ("make", "error", "text"),
        [
            (lambda: conditions.nearest_below(0), ValueError, "distance: expected metres above 0, got 0.0"),
            (lambda: conditions.nearest_below("1"), TypeError, "distance: expected a number, got '1'"),
            (
                lambda: conditions.nearest_below(1, (0, NAN)),
                ValueError,
                "sector: expected a finite number of radians, got nan",
            ),
            (
                lambda: conditions.nearest_below(1, (-30, 30)),
                ValueError,
                r"sector: expected radians within ±2 pi, got -30.0; math.radians\(\) makes them",
            ),
            (lambda: conditions.nearest_below(1, 0.5), TypeError, "sector: expected two angles, .* got 0.5"),
            (lambda: conditions.speed_above(-1), ValueError, "limit: expected a speed, 0 or more, got -1.0"),
            (lambda: conditions.speed_above(1, "x"), ValueError, "axis: expected one of linear.x, .*, got 'x'"),
            (lambda: conditions.gap(0), ValueError, "seconds: expected a time above 0, got 0.0"),
            (lambda: conditions.touched(3), TypeError, "label: expected the name of a sensor, got 3"),
            (lambda: bool(conditions.gap(1)), TypeError, "neither true nor false by itself: join conditions with &"),
            (lambda: conditions.gap(1) & 5, TypeError, "expected a function of one moment, or one of .*, got 5"),
        ],
    )
    def test_what_makes_no_sense_is_refused(self, make: Any, error: type[Exception], text: str) -> None:
        with pytest.raises(error, match=text):
            make()

    def test_what_there_is_not_cannot_be_found(self, tmp_path: Path) -> None:
        recording = robowidgets.open(sweeps.write(tmp_path / "x", sweeps.numbered(3)))
        with pytest.raises(UnknownTopicError, match="x has no touch sensors"):
            recording.find(conditions.touched())


class TestFunctions:
    def test_see_the_last_sample_of_each_topic(self, drive: robowidgets.Recording) -> None:
        seen = {}

        def note(moment: Any) -> bool:
            seen[moment.seconds] = (
                float(moment.scan.ranges[0]),
                moment.speed.linear[0],
                moment["/cmd_vel"].linear[0],
                moment.touch.touched["left"],
            )
            return False

        assert found(drive, note) == []
        assert min(seen) == 5.0  # no command before
        assert seen[6.5] == (pytest.approx(1.65), 0.65, 0.65, True)
        assert seen[7.0][3] is False

    def test_hold_until_they_do_not(self, drive: robowidgets.Recording) -> None:
        assert found(drive, lambda moment: moment.scan.nearest().range < 1.105) == [(0, 1.1)]
        assert found(drive, lambda moment: moment.touch.touched["left"]) == [(2, 3), (6, 7)]
        assert found(drive, lambda moment: moment.seconds >= 9.5) == [(9.5, 10)]

    def test_are_called_again_only_for_what_they_looked_at(self, drive: robowidgets.Recording) -> None:
        calls = []
        drive.find(lambda moment: calls.append(moment.touch))
        assert len(calls) == 4
        calls.clear()
        drive.find(lambda moment: calls.append(moment.scan), topics="/scan")
        assert len(calls) == 100

    def test_what_goes_wrong_is_reported_with_its_time(self, drive: robowidgets.Recording) -> None:
        def inverse(moment: Any) -> bool:
            return bool(1 / (moment.scan.ranges[0] - np.float32(1.55)) or 1 / 0) and moment.seconds > 3 and 1 / 0 > 1

        with pytest.raises(
            RecordingError, match=r"the condition inverse failed at 3\.10 s: ZeroDivisionError: division by zero"
        ) as caught:
            drive.find(inverse)
        assert isinstance(caught.value.__cause__, ZeroDivisionError)
        with pytest.raises(RecordingError, match="'Scan' object has no attribute 'distanc'"):
            drive.find(lambda scan: scan.distanc("front"))

    def test_a_topic_that_is_not_looked_at_is_named(self, drive: robowidgets.Recording) -> None:
        with pytest.raises(RecordingError, match="topic '/odom' is not read here; topics that are read: /scan"):
            drive.find(lambda moment: moment["/odom"], topics=["/scan"])
        with pytest.raises(RecordingError, match="drive has no touch sensors among the topics that are read"):
            drive.find(lambda moment: moment.touch, topics=["/scan"])
        with pytest.raises(UnknownTopicError, match="no topic '/scam'"):
            drive.find(conditions.when(bool), topics="/scam")

    def test_are_not_asked_of_a_closed_recording(self, drive: robowidgets.Recording) -> None:
        drive.close()
        with pytest.raises(RecordingError, match="is closed: open it again"):
            drive.find(bool)

    def test_what_it_reads_is_kept_once_and_not_for_each_sample(self, drive: robowidgets.Recording) -> None:
        def sets() -> int:
            gc.collect()
            return sum(type(one) is frozenset and one == {"/scan"} for one in gc.get_objects())

        kept = []

        def far(scan: Any) -> bool:
            if not kept and scan.ranges[0] > 1.895:
                kept.append(sets())
            return bool(scan.ranges[0] > 1.5)

        # Recordings of other tests may still hold theirs.
        before = sets()
        assert found(drive, far) == [(5.1, 10)]
        assert kept[0] <= before + 1

    def test_what_is_not_a_condition_is_refused(self, drive: robowidgets.Recording) -> None:
        with pytest.raises(TypeError, match=r"condition: expected a function of one moment, or one of .*, got 'bump'"):
            drive.find("bump")  # type: ignore[arg-type]


class TestWhatWasMet:
    @pytest.mark.parametrize("condition", [conditions.nearest_below(1.0), lambda scan: scan.distance() < 1.0])
    def test_in_the_last_scan_counts_where_the_span_lasts_to_the_end(self, tmp_path: Path, condition: Any) -> None:
        seen = [0.9, 0.5, 0.1]
        scans = ((i, sweeps.scan(START_NS, [2.0] * i + [near])) for i, near in enumerate(seen))
        with robowidgets.open(sweeps.write(tmp_path / "x", scans)) as recording:
            (span,) = recording.find(condition)
        assert (span.start, span.end, span.nearest, span.index) == (0, 2, 0.1, 2)

    def test_in_the_last_scan_is_not_of_a_span_that_it_ends(self, tmp_path: Path) -> None:
        scans = ((i, sweeps.scan(START_NS, [near])) for i, near in enumerate([0.9, 0.5, 0.1]))
        with robowidgets.open(sweeps.write(tmp_path / "x", scans)) as recording:
            (span,) = recording.find(conditions.nearest_below(1.0) & (lambda scan: scan.ranges[0] > 0.2))
        assert (span.start, span.end, span.nearest) == (0, 2, 0.5)

    def test_in_the_last_scan_before_an_interrupt_counts(self, tmp_path: Path) -> None:
        def stopped(scan: Any) -> bool:
            if scan.ranges[0] < 0.2:
                raise KeyboardInterrupt
            return bool(scan.distance() < 1.0)

        scans = ((i, sweeps.scan(START_NS, [near])) for i, near in enumerate([0.9, 0.5, 0.1]))
        with robowidgets.open(sweeps.write(tmp_path / "x", scans)) as recording:
            (span,) = recording.find(stopped)
        assert (span.start, span.end, span.nearest) == (0, 1, 0.5)


def near(moment: Any) -> bool:
    return bool(moment.scan.distance("front") < 10)


def stands(scan: Any) -> Drive:
    return Drive(0 * len(scan))


def test_a_condition_and_a_function_meet_the_same_distance_and_angle(tmp_path: Path) -> None:
    """A circle from 0 to 2 pi; the obstacle at 300 degrees comes too close to measure: -inf, or below the limit."""
    for near in (-np.inf, 0.05):
        rows = [[3.0] * 300 + [0.5 if i < 5 else near] + [3.0] * 59 for i in range(10)]
        scans = [
            (i / 10, sweeps.scan(START_NS, row, angle_min=0.0, increment=2 * np.pi / 360)) for i, row in enumerate(rows)
        ]
        recording = robowidgets.open(sweeps.write(tmp_path / f"near{near}", scans))
        for given in (
            conditions.nearest_below(0.6),
            lambda scan: scan.distance() < 0.6,
            lambda scan: scan.nearest().range < 0.6,
            lambda scan: scan.ranges[290:310].min() < 0.6,
        ):
            (span,) = recording.find(given)
            assert (span.nearest, span.index) == (0.0, 300)
            assert span.angle == pytest.approx(np.radians(-60))


def test_a_function_that_returns_nan_is_neither_true_nor_false(tmp_path: Path) -> None:
    scans = ((i, sweeps.scan(START_NS, [1.0])) for i in range(5))
    recording = robowidgets.open(sweeps.write(tmp_path / "x", scans))
    unknown = conditions.when(lambda scan: np.nan if scan else False)
    assert (len(recording.find(unknown)), len(recording.find(~unknown))) == (0, 0)


@pytest.mark.parametrize(("result", "got"), [(0.83, "0.83: compare it"), (INF, "inf: compare it"), ("no", "'no'")])
def test_a_distance_that_was_not_compared_is_not_true(drive: robowidgets.Recording, result: object, got: str) -> None:
    with pytest.raises(RecordingError, match=rf"failed at 0\.00 s: TypeError: expected True, False or None, got {got}"):
        drive.find(lambda scan: result if scan else None)
    if isinstance(result, float):
        with pytest.raises(RecordingError, match="expected True, False or None"):
            drive.find(lambda scan: np.float32(result) if scan else None)
    assert found(drive, lambda scan: 1 if scan else 0) == [(0, 10)], "flags of messages are whole numbers"


class TestInterrupts:
    def test_give_what_was_found_until_then(self, drive: robowidgets.Recording) -> None:
        def stopped(moment: Any) -> bool:
            if moment.seconds > 6.5:
                raise KeyboardInterrupt
            return bool(moment.touch.touched["left"])

        spans = drive.find(stopped)
        assert [(span.start, span.end) for span in spans] == [(2, 3), (6, 6.5)]
        assert (spans.is_complete, spans.until) == (False, 6.5)
        assert "! stopped at 6.50 s: the rest was not searched" in repr(spans)

    @pytest.mark.parametrize(
        ("condition", "owner", "step", "until"),
        [
            (near, Now, "put", 2.8),
            (near, FunctionCondition, "_result", 2.8),
            (near, Reasons, "met", 2.8),
            (near, Search, "looked_at", 2.9),
            (conditions.stops(stands, rate=10), Now, "put", 2.8),
            (conditions.stops(stands, rate=10), ProgramRun, "step", 2.8),
            (conditions.stops(stands, rate=10), Search, "looked_at", 2.8),
        ],
    )
    def test_between_a_time_and_its_value_leave_no_time_without_a_value(
        self,
        drive: robowidgets.Recording,
        monkeypatch: pytest.MonkeyPatch,
        condition: Any,
        owner: Any,
        step: str,
        until: float,
    ) -> None:
        for module in (base, _stops):
            monkeypatch.setattr(module, "_BAR_EVERY", 1)
        original, calls = getattr(owner, step), itertools.count(1)

        def interrupted(*given: Any) -> Any:
            if next(calls) == 30:
                raise KeyboardInterrupt
            return original(*given)

        monkeypatch.setattr(owner, step, interrupted)
        spans = drive.find(condition)
        assert [(span.start, span.end) for span in spans] == [(0, until)]
        assert (spans.is_complete, spans.until) == (False, until)

    def test_end_what_follows_at_the_same_time(self, drive: robowidgets.Recording) -> None:
        def stopped(moment: Any) -> bool:
            if moment.seconds > 2.5:
                raise KeyboardInterrupt
            return True

        spans = drive.find(conditions.when(stopped) & conditions.touched())
        assert [(span.start, span.end) for span in spans] == [(2, 2.5)]

    def test_reach_ready_made_conditions_too(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        recording = robowidgets.open(sweeps.write(tmp_path / "x", sweeps.numbered(900, rays=1000)))
        condition = conditions.nearest_below(2.0)
        test, chunks = condition._test, []  # type: ignore[attr-defined]

        def interrupted(chunk: Any) -> Any:
            chunks.append(chunk)
            if len(chunks) == 3:
                raise KeyboardInterrupt
            return test(chunk)

        monkeypatch.setattr(condition, "_test", interrupted)
        spans = recording.find(condition)
        assert not spans.is_complete
        last = (chunks[1].times_ns[-1] - START_NS) / 1e9
        assert [(span.start, span.end) for span in spans] == [(0, pytest.approx(min(10, last)))]
        assert spans.until == pytest.approx(last)

    def test_before_anything_is_known_give_nothing(
        self, drive: robowidgets.Recording, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def interrupted(*_: Any) -> Any:
            raise KeyboardInterrupt

        monkeypatch.setattr(drive, "touches", interrupted)
        spans = drive.find(conditions.touched())
        assert (len(spans), spans.until) == (0, 0)


class TestSpans:
    FEW = Spans("bump <1>", [Span(1, 3, 2, 0, 0), Span(5, 5.5, 0.5, 0, 0)])

    def test_are_a_table(self) -> None:
        assert repr(self.FEW).splitlines() == [
            "bump <1>: 2 times, 2.50 s together",
            "  start   end  seconds",
            "   1.00  3.00     2.00",
            "   5.00  5.50     0.50",
        ]
        html = display_html(self.FEW)
        assert "bump &lt;1&gt;: 2 times" in html
        assert html.count("<tr>") == 3
        assert repr(Spans("bump", [])) == "bump: never"
        assert "once" in repr(self.FEW[:1])
        assert repr(Spans("x", [Span(0, 1, 1, 0, 0)] * 25)).endswith("... and 5 more")

    def test_are_a_sequence(self) -> None:
        assert len(self.FEW) == 2
        assert self.FEW[-1].start == 5
        assert [span.seconds for span in self.FEW] == [2, 0.5]
        assert self.FEW.seconds == 2.5

    def test_go_to_pandas(self, monkeypatch: pytest.MonkeyPatch) -> None:
        frame = self.FEW.to_pandas()
        assert frame["end"].tolist() == [3, 5.5]
        assert list(frame.columns) == [
            "start",
            "end",
            "seconds",
            "start_ns",
            "end_ns",
            "silent",
            "nearest",
            "index",
            "angle",
            "nearest_ns",
            "value",
            "value_ns",
        ]
        monkeypatch.setitem(sys.modules, "pandas", None)
        with pytest.raises(ImportError, match="pip install pandas"):
            self.FEW.to_pandas()

    def test_have_the_same_types_in_pandas_whatever_was_met(self) -> None:
        pytest.importorskip("pandas")
        at_ns = 1_700_000_000_000_000_001
        plain = Span(0, 1, 1, at_ns, at_ns)
        met = plain._replace(nearest=0.2, index=3, angle=0.1, nearest_ns=at_ns, value=0.1, value_ns=at_ns)
        none, some, every = (Spans("x", spans).to_pandas() for spans in ([], [plain, met], [met]))
        assert none.dtypes.tolist() == some.dtypes.tolist() == every.dtypes.tolist()
        assert some["nearest_ns"].dropna().tolist() == [at_ns]
        assert some["index"].dropna().tolist() == [3]


def test_a_span_tells_the_number_farthest_beyond_the_limit_and_when_or_the_first_of_equal_ones() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        speeds = recording.speeds("/odom")
        x, times = speeds.values[:, 0], speeds.times_ns

        def told(wanted: Any) -> list[tuple[float | None, int | None]]:
            return [(span.value, span.value_ns) for span in recording.find(wanted)]

        for wanted, best in (
            (conditions.speed_above(0.05, topic="/odom"), lambda part: abs(part).argmax()),
            (conditions.field("/odom.twist.twist.linear.x") < -0.01, np.argmin),
            (conditions.field("/odom.twist.twist.linear.x") >= 0.1, np.argmax),
            (conditions.field("/odom.twist.twist.linear.x") != 0, lambda _: 0),
        ):
            expected = []
            for span in recording.find(wanted):
                rows = np.flatnonzero((times >= span.start_ns) & (times < max(span.end_ns, span.start_ns + 1)))
                at = rows[best(x[rows])]
                expected.append((x[at], times[at]))
            assert told(wanted) == expected != []
        assert told(conditions.nearest_below(0.3)) == [(None, None)] * len(
            recording.find(conditions.nearest_below(0.3))
        )


def test_the_real_bump_is_found(data: Path) -> None:
    recording = robowidgets.open(data / "good" / "neato_fsm")
    (span,) = recording.find(conditions.touched())
    assert span.start == pytest.approx(21.96, abs=0.01)
    assert found(recording, lambda moment: any(moment.touch.touched.values())) == [(span.start, span.end)]


def test_the_pages_name_the_reading_that_the_story_ends_with() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        bump = recording.find(conditions.touched())[0]
        moment = recording.scans("/scan").at(bump.start)
        ray = moment.sample.nearest()
    told = f"ray {ray.index} at {moment.seconds:.2f} s: {ray.range:.3f} m"
    assert told in " ".join((ROOT / "docs" / "columns.md").read_text(encoding="utf-8").split())


@pytest.mark.slow
def test_nothing_odd_or_damaged_ends_in_an_error_of_another_kind(data: Path) -> None:
    searched = 0
    for path in sorted([*(data / "odd").iterdir(), *(data / "damaged").iterdir()]):
        try:
            recording = robowidgets.open(path)
        except RecordingError:
            continue
        with recording:
            for topic in recording.topics:
                asked: dict[Any, Any] = {
                    "laser": lambda name=topic.name: conditions.nearest_below(0.5, topic=name),
                    "speed": lambda name=topic.name: conditions.speed_above(0.1, topic=name),
                    "touch": lambda name=topic.name: conditions.touched(topic=name),
                    "sonar": lambda name=topic.name: conditions.when(lambda it: it[name].distance < 1),
                }
                if topic.widget:
                    assert recording.find(asked[topic.widget]() | conditions.gap(1e6, topic.name)).is_complete
                    searched += 1
    assert searched > 30

"""The verdict of a condition on one sample."""

from __future__ import annotations

import gc
import pickle
import sys
import weakref
from copy import copy, deepcopy
from dataclasses import replace
from functools import partial, wraps
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import Scan, Speed, Touch, TouchMode, conditions
from robowidgets.kinds import sample_names
from robowidgets.reasons.look import Look
from robowidgets.recordings.search.base import condition
from robowidgets.recordings.search.instant import NoSampleYetError
from robowidgets.samples.verdict import Verdict, fact

from ..pages import display_html

NAN, INF = float("nan"), float("inf")


def scan(*ranges: float) -> Scan:
    """Rays from -0.4 to the left, 0.2 rad apart, limits 0.1 to 4 m."""
    return Scan(np.array(ranges), angle_min=-0.4, angle_increment=0.2, range_min=0.1, range_max=4.0)


SEEN = scan(0.3, 1.0, 0.4, 0.45, INF)
RIGHT, AHEAD, LEFT = (-0.4, -0.2), (0.0, 0.0), (0.2, 0.4)


def judged(function: Any, *samples: Any) -> Verdict:
    return Look(function).judge(*samples)


class TestFunction:
    def test_marks_all_rays_that_the_comparison_holds_for(self) -> None:
        verdict = judged(lambda scan: scan.distance(("-15deg", "15deg")) < 0.5, SEEN)
        assert verdict.value is True
        assert verdict.rays.tolist() == [2, 3]
        assert verdict.text == "0.40 < 0.50 m"
        assert verdict.nearest == SEEN[2]

    def test_says_what_was_compared_as_a_fact_when_it_is_false(self) -> None:
        verdict = judged(lambda scan: scan.distance() < 0.25, SEEN)
        assert verdict == Verdict(False, "0.30 ≥ 0.25 m", verdict.rays)
        assert not verdict.rays.size

    def test_of_several_comparisons_those_that_held_are_marked(self) -> None:
        near, far = (-0.4, -0.4), (0.2, 0.4)
        assert judged(lambda s: s.distance(near) < 0.1 or s.distance(far) < 0.5, SEEN).rays.tolist() == [3]
        assert judged(lambda s: not s.distance(near) > 0.5, SEEN).rays.tolist() == [0]
        assert judged(lambda s: s.distance(near) < 0.5 and s.distance(far) > 0.4, SEEN).rays.tolist() == [0, 3, 4]

    @pytest.mark.parametrize(
        ("function", "rays", "text"),
        [
            (lambda s: min(s.distance(LEFT), s.distance(RIGHT)) < 0.4, [0], "0.30 < 0.40 m"),
            (lambda s: min(s.distance(RIGHT), s.distance(LEFT)) < 0.4, [0], "0.30 < 0.40 m"),
            (lambda s: max(s.distance(LEFT), s.distance(RIGHT)) > 0.4, [3, 4], "0.45 > 0.40 m"),
            (lambda s: sorted(map(s.distance, (LEFT, RIGHT, AHEAD)))[0] < 0.4, [0], "0.30 < 0.40 m"),
            (lambda s: sorted(map(s.distance, (LEFT, RIGHT, AHEAD)))[1] < 0.5, [2], "0.40 < 0.50 m"),
            (lambda s: s.distance(RIGHT) < s.distance(LEFT), [0], "0.30 < 0.45 m"),
            (
                lambda s: s.distance(RIGHT) < s.distance(LEFT) and s.distance(AHEAD) < 0.5,
                [0, 2],
                "0.30 < 0.45 m · 0.40 < 0.50 m",
            ),
        ],
    )
    def test_the_comparison_that_chooses_a_distance_is_not_a_condition(
        self, function: Any, rays: list[int], text: str
    ) -> None:
        verdict = judged(function, SEEN)
        assert (verdict.value, verdict.rays.tolist(), verdict.text) == (True, rays, text)

    @pytest.mark.parametrize(
        ("function", "rays"),
        [
            (lambda s: s.ranges < 0.42, [0, 2]),
            (lambda s: s.ranges[1:4] < 0.42, [2]),
            (lambda s: s.ranges[s.valid] < 0.42, [0, 2]),
            (lambda s: np.array([s.ranges[3] < 0.5, False]), []),
            (lambda s: s.nearest("front"), [0]),
            (lambda s: s.at(0.0).range < 0.5, [2]),
            (lambda s: (s.ranges < 0.42).any(), []),
        ],
    )
    def test_may_return_a_mask_or_a_ray(self, function: Any, rays: list[int]) -> None:
        verdict = judged(function, SEEN)
        assert verdict.value is True
        assert verdict.rays.tolist() == rays

    @pytest.mark.parametrize(
        ("function", "rays"),
        [
            (lambda s: s.ranges[1:4].min() < 0.5, [2]),
            (lambda s: min(s.ranges[1:]) < 0.5, [2]),
            (lambda s: np.nanmin(s.ranges[-2:]) < 0.5, [3]),
            (lambda s: s.ranges[s.indices(("0deg", "20deg"))].min() < 0.5, [2]),
            (lambda s: s.ranges[s.valid].min() < 0.5, [0]),
            (lambda s: s.ranges[:2].min() < 0.5 and s.ranges[2:].min() < 0.5, [0, 2]),
            (lambda s: s.ranges[3] < 0.5, [3]),
            (lambda s: s.ranges[..., -4] > 0.5, [1]),
            (lambda s: s[4].range > 1, [4]),
            (lambda s: any(s.ranges[i] < 0.42 for i in range(1, 5)), [2]),
            (lambda s: any(r < 0.42 for r in s.ranges), [0]),
            (lambda s: s.ranges.min() < 0.5, [0]),
            (lambda s: np.nanmin(s.ranges) < 0.5, [0]),
            (lambda s: np.sort(s.ranges)[1] < 0.5, []),  # the index does not belong to a ray
            (lambda s: s.ranges.copy()[1] > 0.5, []),
            (lambda s: s.turned("10deg").distance("front") < 0.5, [0, 2, 3]),
        ],
    )
    def test_marks_the_nearest_ray_of_each_part_of_the_ranges_that_it_reads(
        self, function: Any, rays: list[int]
    ) -> None:
        verdict = judged(function, SEEN)
        assert verdict.value is True
        assert verdict.rays.tolist() == rays
        nearest = min(rays, key=lambda index: SEEN.ranges[index], default=None)
        assert (verdict.nearest and verdict.nearest.index) == nearest
        assert judged(lambda s: not function(s), SEEN).rays.tolist() == []

    @pytest.mark.parametrize(
        "function",
        [
            lambda r: r[1:3],
            lambda r: r[2],
            lambda r: r[[0, 3]],
            lambda r: r[r < 0.5],
            lambda r: r + r[::-1],
            lambda r: np.add(1, r, out=r.copy()),
            lambda r: r < 0.5,
            lambda r: r.max(),
            lambda r: r.mean(),
            lambda r: np.sort(r),
            lambda r: np.median(r[:4]),
            lambda r: np.percentile(r, 20),
            lambda r: np.where(r < 0.5, r, 0),
            lambda r: np.concatenate([r[3:], r]),
            lambda r: np.split(r, 5)[1],
            np.argmin,
            list,
            sorted,
            np.asarray,
        ],
    )
    def test_gets_from_ranges_what_an_array_gives(self, function: Any) -> None:
        found: list[Any] = []
        judged(lambda s: found.append(function(s.ranges)), SEEN)
        expected = function(SEEN.ranges)
        assert type(found[0]) is type(expected)
        np.testing.assert_array_equal(found[0], expected)
        assert getattr(found[0], "dtype", None) == getattr(expected, "dtype", None)

    def test_the_nearest_is_a_ray_that_met_something_of_any_scan(self) -> None:
        verdict = judged(lambda s: not s.ranges[0] > 1 and s.distance() < 1, scan(NAN, 0.4))
        assert verdict.nearest
        assert verdict.nearest.range == 0.4
        assert judged(lambda s: not s.ranges[0] > 1, scan(NAN, 0.4)).nearest is None
        verdict = judged(lambda a, b: a.ranges[:2].min() < b.ranges[:2].min(), scan(0.3, 1.0), scan(0.9, 1.0))
        assert verdict.nearest
        assert verdict.nearest.range == 0.3

    def test_marks_no_ray_of_a_part_that_met_nothing(self) -> None:
        assert judged(lambda s: s.ranges[:2].min() > 1, scan(INF, NAN, INF)).rays.tolist() == []
        assert judged(lambda s: s.ranges[0:1].min() > 1, scan(INF, NAN)).rays.tolist() == []
        assert judged(lambda s: not s.ranges[:0].size, scan(INF)).rays.tolist() == []

    def test_is_unknown_if_it_compares_no_known_distance_or_returns_none(self) -> None:
        dark = scan(NAN, NAN, NAN)
        assert judged(lambda s: s.distance() < 0.5, dark).value is None
        assert judged(lambda s: not s.distance() > 0.5, dark).value is None
        assert judged(lambda touch: touch.touched.get("left"), Touch({"left": None})).value is None
        assert judged(lambda s: s.distance("back") < 0.5 or s.distance("front") < 0.5, SEEN).value is True

    def test_is_given_a_scan_like_any_other(self) -> None:
        seen: list[Scan] = []
        judged(lambda s: seen.append(s) or s.distance() + 1 == 1.3, SEEN)
        assert isinstance(seen[0], Scan)
        assert np.shares_memory(seen[0].ranges, SEEN.ranges)
        assert repr(seen[0].ranges) == repr(SEEN.ranges)
        assert repr(seen[0]) == repr(SEEN)
        assert seen[0].turned(0.1).angle_min == pytest.approx(-0.3)

    @pytest.mark.parametrize(
        "made",
        [
            copy,
            deepcopy,
            lambda s: pickle.loads(pickle.dumps(s)),
            lambda s: replace(s, ranges=np.maximum(s.ranges, 0.1)),
        ],
    )
    def test_makes_plain_scans_of_the_one_that_it_is_given(self, made: Any) -> None:
        assert judged(lambda s: made(s).distance() < 0.5, SEEN).value is True
        assert judged(lambda s: type(made(s)) is Scan, SEEN).value is True

    def test_raises_what_the_function_raises(self) -> None:
        with pytest.raises(ZeroDivisionError):
            judged(lambda _: 1 / 0, SEEN)


def near(scan: Any) -> Any:
    """A function that others call."""
    return scan.distance() < 0.5


class Limits:
    """An object of the user's, with the limit of a condition."""

    limit = 0.5

    def near(self, scan: Scan) -> bool:
        return scan.distance() < self.limit

    def __call__(self, scan: Scan) -> bool:
        return self.near(scan)

    @staticmethod
    def is_near(scan: Scan) -> bool:
        return near(scan)  # type: ignore[no-any-return]


def timed(function: Any) -> Any:
    @wraps(function)
    def wrapper(*samples: Any) -> Any:
        return function(*samples)

    return wrapper


LIMITS, RULES, HERE = Limits(), (lambda scan: scan.distance(LEFT) < 0.1, near), sys.modules[__name__]


def any_rule(scan: Scan) -> bool:
    holds = False
    for rule in RULES:
        holds = holds or rule(scan)
    return holds


def with_a_function_in_it(scan: Scan) -> bool:
    def check(scan: Scan) -> bool:
        return scan.distance() < 0.5

    return check(scan)


def of_limit(limit: float) -> Any:
    return lambda scan: scan.distance() < limit


def with_a_function_that_is_made(scan: Scan) -> bool:
    check = of_limit(0.5)
    return bool(check(scan))


class TestCalled:
    @pytest.mark.parametrize(
        "function",
        [
            LIMITS.near, LIMITS, timed(near), partial(lambda limit, scan: scan.distance() < limit, 0.5),
            lambda scan: near(scan), lambda scan: LIMITS.near(scan), lambda scan: Limits.is_near(scan),
            lambda scan: HERE.near(scan), lambda scan: any(rule(scan) for rule in RULES), any_rule,
            with_a_function_in_it, with_a_function_that_is_made,
        ],
    )  # fmt: skip
    def test_a_function_names_the_rays_that_functions_read_that_it_calls(self, function: Any) -> None:
        look = Look(function)
        for _ in range(2):
            verdict = look.judge(SEEN)
            assert (verdict.value, verdict.rays.tolist(), verdict.nearest) == (True, [0, 2, 3], SEEN[0])
            assert "0.30 < 0.50 m" in verdict.text

    def test_functions_that_each_call_makes_are_not_kept_for_ever(self) -> None:
        made = list[Any]()

        def condition(scan: Scan) -> bool:
            made.append(weakref.ref(check := of_limit(0.5)))
            return bool(check(scan))

        look = Look(condition)
        for _ in range(1000):
            look(SEEN)
        gc.collect()
        assert sum(one() is not None for one in made) < 500

    def test_a_function_without_a_source_says_so_and_is_called_as_it_is(self) -> None:
        verdict = judged(eval("lambda scan: scan.distance() < 0.5"), SEEN)
        assert verdict == Verdict(True, "shows no reasons: its source is not known", verdict.rays)
        assert not verdict.rays.size


def test_a_fact_has_enough_decimals_to_be_one() -> None:
    assert fact(1.24, "<", 1.5) == "1.24 < 1.50 m"
    assert fact(1.4996, "<", 1.5) == "1.4996 < 1.5000 m"
    assert fact(0.31, ">", 0.3, "m/s") == "0.31 > 0.30 m/s"
    assert fact(INF, "<", 0.5) == "inf ≥ 0.50 m"


class TestReadyMade:
    @pytest.mark.parametrize(
        ("ranges", "value", "rays"),
        [((0.3, 1, 0.4), True, [0, 2]), ((1, 1, INF), False, []), ((NAN, NAN), None, []), ((-INF, 3), True, [0])],
    )
    def test_nearest_below_marks_rays(self, ranges: tuple[float, ...], value: bool | None, rays: list[int]) -> None:
        verdict = conditions.nearest_below(0.5).judge(scan(*ranges))
        assert (verdict.value, verdict.rays.tolist()) == (value, rays)

    def test_nearest_below_names_the_nearest_ray_in_its_sector(self) -> None:
        verdict = conditions.nearest_below(0.5, ("-3deg", "30deg")).judge(SEEN)
        assert (verdict.text, verdict.nearest) == ("0.40 < 0.50 m", SEEN[2])

    def test_speed_above(self) -> None:
        turning = conditions.speed_above(0.3, "angular.z")
        assert turning.judge(Speed(angular=(0, 0, -0.5))) == Verdict(True, "0.50 > 0.30 rad/s")
        assert turning.judge(Speed(angular=(0, 0, 0.1))) == Verdict(False, "0.10 ≤ 0.30 rad/s")
        assert turning.judge(Speed(angular=(0, 0, NAN))).value is None

    def test_touched(self) -> None:
        touch = Touch({"left": False, "right": True, "nose": None})
        assert conditions.touched().judge(touch) == Verdict(True, "right")
        assert conditions.touched("left").judge(touch).value is False
        assert conditions.touched("nose").judge(touch).value is None
        assert conditions.touched("tail").judge(touch) == Verdict(None, "nothing of 'tail' yet")
        listed = Touch({}, mode=TouchMode.PRESENCE)
        assert conditions.touched("left").judge(listed).value is False

    def test_joined(self) -> None:
        left, low = conditions.nearest_below(0.5, (-0.4, -0.4)), conditions.nearest_below(0.5, (0.2, 0.2))
        assert (left & low).judge(SEEN).rays.tolist() == [0, 3]
        assert (left | ~low).judge(SEEN).value is True
        assert (~left).judge(SEEN) == Verdict(False, "0.30 < 0.50 m")
        assert (left & conditions.nearest_below(0.5, "back")).judge(SEEN).value is None

    def test_a_gap_lies_between_samples(self) -> None:
        with pytest.raises(TypeError, match=r"gap longer than 2 s: a gap lies between samples, so only Recording.find"):
            conditions.gap(2).judge(SEEN)
        with pytest.raises(TypeError, match="a gap lies between samples"):
            assert (~conditions.gap(2) & conditions.touched()).reads


class TestMoment:
    BUMP = Touch({"left": True})

    def test_several_samples_at_once(self) -> None:
        both = conditions.touched("left") & conditions.nearest_below(0.35)
        assert both.judge(SimpleNamespace(scan=SEEN, touch=self.BUMP)).value is True
        assert both.judge(SimpleNamespace(scan=None, touch=self.BUMP)).value is None
        assert both.reads == {"scan", "touch"}
        named = condition(lambda scan, touch: touch.touched["left"] and scan.distance() < 0.35)
        assert named.judge(SimpleNamespace(scan=SEEN, touch=self.BUMP)).rays.tolist() == [0]
        assert named.judge(SimpleNamespace(scan=SEEN, touch=None)).value is None
        assert named.reads == {"scan", "touch"}

    def test_a_sample_that_is_not_there_yet_is_unknown(self) -> None:
        class Early:
            @property
            def scan(self) -> Scan:
                raise NoSampleYetError("scan")

        assert conditions.nearest_below(1).judge(Early()).value is None
        assert conditions.when(lambda moment: moment.scan.distance() < 1).judge(Early()).value is None

    def test_by_topic(self) -> None:
        assert conditions.nearest_below(0.35, topic="/back").judge({"/back": SEEN}).value is True

    def test_a_function_of_a_moment_judges_one_sample_too(self) -> None:
        assert conditions.when(lambda moment: moment.scan.distance() < 0.35).judge(SEEN).rays.tolist() == [0]
        with pytest.raises(AttributeError, match="no 'touch' here: this is one scan"):
            conditions.when(lambda moment: moment.touch).judge(SEEN)

    def test_a_sample_of_another_kind_is_refused(self) -> None:
        with pytest.raises(TypeError, match="expected a touch, got a scan"):
            conditions.touched().judge(SEEN)

    def test_a_function_of_something_else_is_refused(self) -> None:
        names = ", ".join(sample_names())
        with pytest.raises(TypeError, match=rf"samples by name \({names}\); it takes scan, limit"):
            conditions.when(lambda scan, limit: scan.distance() < limit)
        assert conditions.when(lambda scan, limit=1: scan.distance() < limit).reads == {"scan"}  # type: ignore[misc]


class TestFound:
    @pytest.mark.parametrize(("sector", "limit"), [("front", 0.2), ("left", 0.4)])
    def test_the_same_function_is_found_in_a_recording_with_what_was_met(self, sector: str, limit: float) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            function = recording.find(lambda scan: scan.distance(sector) < limit)
            plain = recording.find(lambda scan: np.nanmin(scan.ranges[scan.indices(sector)]) < limit)
            ready_made = recording.find(conditions.nearest_below(limit, sector))
            assert list(function) == list(plain) == list(ready_made)
            assert len(ready_made) > 1
            for span in ready_made:
                scans = recording.scans().between(span.start, span.end)
                assert span.nearest == pytest.approx(scans.distances(sector).min())
                near = [moment.sample.nearest(sector) for moment in scans]
                assert (span.index, span.angle) in [(ray.index, pytest.approx(ray.angle)) for ray in near if ray]

    def test_only_conditions_on_distances_met_anything(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            assert {(span.nearest, span.index, span.angle) for span in recording.find(conditions.touched())} == {
                (None, None, None)
            }
            bumps = recording.find(conditions.touched() & conditions.nearest_below(0.3))
            assert "nearest  index   angle" in repr(bumps)
            assert f'<td style="text-align:right">[{bumps[0].index}]</td>' in display_html(bumps)

"""The distance of the nearest thing: `Scan.distance` and `Scan.nearest`, by one rule."""

from __future__ import annotations

from itertools import product
from math import floor, inf, isnan, nan, radians

import numpy as np
import pytest

from robowidgets.samples import Scan, Validity

LOW, HIGH = 0.12, 3.5
TOO_CLOSE = (-inf, 0.02, 0.08, 0.1199)
NOTHING = (inf, 3.51, 65.533)
CODES = (0.0, 0.001, 0.019, -1.0)


def scan(ranges: list[float], **changed: float) -> Scan:
    geometry = {"angle_min": -0.5, "angle_increment": 0.1, "range_min": LOW, "range_max": HIGH}
    return Scan(ranges, **(geometry | changed))


def circle(ahead: float, left: float, behind: float, right: float) -> Scan:
    """360 rays from forward on; all within 20 degrees of a direction read the same, the others see nothing."""
    ranges = np.full(360, inf)
    for i, value in enumerate((ahead, left, behind, right)):
        ranges[np.arange(90 * i - 20, 90 * i + 21) % 360] = value
    return Scan(ranges, angle_min=0.0, angle_increment=radians(1), range_min=LOW, range_max=HIGH)


def same(a: float, b: float) -> bool:
    return a == pytest.approx(b, nan_ok=True)


class TestTheRule:
    """The table in the docstring of `Scan.distance`, row by row."""

    @pytest.mark.parametrize("value", [LOW, 1.0, HIGH])
    def test_a_reading_is_its_distance(self, value: float) -> None:
        assert scan([value, HIGH, inf, nan, 0.0]).distance() == pytest.approx(value)

    @pytest.mark.parametrize("value", TOO_CLOSE)
    def test_too_close_is_0_and_nearer_than_any_reading(self, value: float) -> None:
        for beside in (LOW, 2.0, inf, nan, 0.0):
            one = scan([beside, value])
            assert one.distance() == 0
            assert one.nearest() == one[1]
        assert scan([value]).distance() == 0

    @pytest.mark.parametrize("value", NOTHING)
    def test_where_nothing_is_met_it_is_inf(self, value: float) -> None:
        for beside in ([], [nan], [0.0], [inf]):
            one = scan([value, *beside])
            assert one.distance() == inf
            assert one.nearest() is None

    @pytest.mark.parametrize("code", CODES)
    def test_a_code_means_nothing_seen_if_other_rays_measured(self, code: float) -> None:
        assert scan([code, 2.0]).distance() == 2
        assert scan([code, 2.0]).nearest().index == 1
        assert scan([code, inf]).distance() == inf

    @pytest.mark.parametrize("ranges", [[], [nan], [nan, nan], *([c] for c in CODES), [0.0, 0.0], [0.0, nan]])
    def test_where_nothing_was_measured_it_is_nan(self, ranges: list[float]) -> None:
        one = scan(ranges)
        assert isnan(one.distance())
        assert one.nearest() is None

    def test_a_scanner_that_measures_from_0_has_no_codes(self) -> None:
        one = scan([0.0, 1.0], range_min=0.0)
        assert (one.distance(), one.nearest()) == (0, one[0])
        assert scan([0.015, 1.0], range_min=0.01).distance() == pytest.approx(0.015)

    def test_without_a_limit_only_infinity_meets_nothing(self) -> None:
        assert scan([5e5, inf], range_max=inf).distance() == 5e5
        assert scan([inf], range_max=inf).distance() == inf

    def test_fifty_rays_too_close_hide_behind_none_at_2_m(self) -> None:
        one = scan([-inf] * 50 + [2.0] * 50)
        assert one.distance() == 0
        assert one.nearest() == one[0]
        assert one.nearest().validity is Validity.TOO_CLOSE

    @pytest.mark.parametrize("ranges", [[nan], [], [0.0], [-inf], [0.05], [nan, -inf]])
    def test_a_loop_that_goes_while_the_distance_is_larger_stops(self, ranges: list[float]) -> None:
        assert not scan(ranges).distance() > 0.3
        assert not scan(ranges).distance(percentile=5) > 0.3


class TestSectors:
    def test_a_name_is_a_quarter_of_the_circle(self) -> None:
        one = circle(ahead=1.0, left=2.0, behind=-inf, right=nan)
        assert [one.distance(name) for name in ("front", "left", "back", "right")] == [1, 2, 0, inf]
        assert one.nearest("left").range == 2
        assert one.nearest("right") is None
        assert one.distance((radians(-10), radians(10))) == 1
        assert isnan(one.distance((radians(-100), radians(-80))))

    @pytest.mark.parametrize("step", [1, -1])
    @pytest.mark.parametrize("first", [0, -180, 90])
    def test_the_four_leave_no_ray_out(self, first: int, step: int) -> None:
        for index in range(360):
            ranges = np.full(360, inf)
            ranges[index] = 1.0
            angles = {"angle_min": radians(first), "angle_increment": radians(step)}
            one = Scan(ranges, **angles, range_min=LOW, range_max=HIGH)
            found = [name for name in ("front", "left", "back", "right") if one.distance(name) == 1]
            assert found, index
            degrees = (first + step * index) % 360
            assert len(found) == (2 if degrees % 90 == 45 else 1)

    @pytest.mark.parametrize("sector", [("-10deg", "10deg"), ("-10 deg", radians(10)), ("-10°", "+10.0°")])
    def test_a_sector_may_be_given_in_degrees(self, sector: tuple[float | str, float | str]) -> None:
        one = circle(ahead=1.0, left=0.5, behind=2.0, right=nan)
        assert one.distance(sector) == 1
        assert one.nearest(sector).index == 0
        assert one.at("12deg").index == 12

    def test_a_sector_that_the_scanner_does_not_sweep_is_nan(self) -> None:
        assert isnan(scan([1.0] * 11).distance("back"))
        assert scan([1.0] * 11).nearest("back") is None

    @pytest.mark.parametrize(
        ("sector", "error", "text"),
        [
            ("frnt", ValueError, r"^sector: expected front, left, back, right or two angles, .* got 'frnt'$"),
            ((0, 90), ValueError, r"^sector: expected radians within ±2 pi, got 90.0; "),
            (("-10", 0), TypeError, r"^sector: expected radians, or degrees as in \"20deg\", got '-10'$"),
            (("400deg", 0), ValueError, r"^sector: expected radians within ±2 pi, got 6.98"),
            (0.5, TypeError, r"^sector: expected two angles, .* got 0.5$"),
        ],
    )
    def test_what_is_not_a_sector_is_refused(self, sector: object, error: type[Exception], text: str) -> None:
        for one in (scan([1.0]), scan([])):
            with pytest.raises(error, match=text):
                one.distance(sector)
            with pytest.raises(error, match=text):
                one.nearest(sector)


class TestPercentile:
    def test_few_wrong_rays_do_not_count(self) -> None:
        one = scan([0.2, -inf, *[2.0] * 98])
        assert one.distance() == 0
        assert one.distance(percentile=5) == 2
        assert one.distance(percentile=0) == 0

    def test_it_belongs_to_a_ray_and_the_nearer_of_two_counts(self) -> None:
        one = scan([3.0, 1.0, 2.0, inf])
        assert [one.distance(percentile=p) for p in (0, 33, 34, 50, 99, 100)] == [1, 1, 2, 2, 3, inf]

    def test_between_a_number_and_inf_there_is_no_nan(self) -> None:
        one = scan([1.0, inf, 0.0, -inf])
        assert [one.distance(percentile=p) for p in (0, 40, 60, 70, 100)] == [0, 1, 1, inf, inf]

    def test_nan_does_not_count_and_where_nothing_was_measured_it_is_nan(self) -> None:
        assert scan([nan] * 90 + [1.0, 2.0]).distance(percentile=100) == 2
        for ranges in ([], [nan], [0.0, 0.0], [0.0, nan]):
            assert isnan(scan(ranges).distance(percentile=50))

    @pytest.mark.parametrize("percentile", [-1, 101, nan])
    def test_it_is_0_to_100(self, percentile: float) -> None:
        with pytest.raises(ValueError, match=rf"^percentile: expected a number from 0 to 100, got {percentile}$"):
            scan([1.0]).distance(percentile=percentile)

    def test_it_is_a_number(self) -> None:
        with pytest.raises(TypeError, match=r"^percentile: expected a number, got '5'$"):
            scan([1.0]).distance(percentile="5")


def counts_as(value: float) -> float:
    """The table for one range, as documented."""
    if isnan(value):
        return nan
    if value in CODES or value > HIGH:
        return inf
    return 0.0 if value < LOW else value


def test_any_mixture_of_three_rays_is_judged_as_the_table_says() -> None:
    for ranges in product([1.0, HIGH, *TOO_CLOSE[:3], *NOTHING[:2], *CODES[:3], nan], repeat=3):
        one = scan(list(ranges))
        met = sorted(counts_as(value) for value in ranges if not isnan(value))
        is_known = not all(isnan(value) or value in CODES for value in ranges)
        least = met[0] if is_known else nan
        assert same(one.distance(), least), ranges
        near = one.nearest()
        first = [counts_as(value) for value in ranges].index(least) if least < inf else None
        assert near == (None if first is None else one[first]), ranges
        for percentile in (0, 40, 100):
            part = met[floor(percentile / 100 * (len(met) - 1))] if is_known else nan
            assert same(one.distance(percentile=percentile), part), (ranges, percentile)

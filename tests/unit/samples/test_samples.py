"""The samples: immutable, in SI units, with the geometry that follows."""

from __future__ import annotations

import pickle
from dataclasses import FrozenInstanceError
from math import cos, degrees, inf, isnan, nan, pi, radians, sin

import numpy as np
import pytest

from robowidgets.samples import AXES, Range, Ray, Scan, Speed, Touch, TouchMode, TouchState, Validity, yaw_of
from robowidgets.samples.scan import MAX_RAYS
from robowidgets.samples.sector import ALL_ROUND


def scan(ranges: object = (1.0, 2.0, 3.0), **changed: object) -> Scan:
    geometry = {"angle_min": -0.5, "angle_increment": 0.5, "range_min": 0.1, "range_max": 30.0}
    return Scan(ranges, **(geometry | changed))


def circle(count: int = 360, step: float = 1.0, start: float = 0.0) -> Scan:
    return scan(np.ones(count), angle_min=radians(start), angle_increment=radians(step))


def whats(scan: Scan) -> tuple[str, ...]:
    return tuple(problem.what for problem in scan.problems())


@pytest.mark.parametrize("sample", [scan([1.0, nan, inf]), Speed((0.1, 0.0, 0.0)), Touch({"left": True}), Range(0.4)])
def test_a_pickled_sample_is_the_same_as_old_and_read_only(sample: Scan | Speed | Touch | Range) -> None:
    copied = pickle.loads(pickle.dumps(sample))
    assert repr(copied) == repr(sample)
    assert copied._arrived == sample._arrived
    if isinstance(copied, Touch):
        assert type(copied.touched) is type(sample.touched)  # type: ignore[union-attr]
    if isinstance(copied, Scan):
        assert not copied.ranges.flags.writeable


class TestGeometry:
    def test_index_635_of_1040_rays_is_at_28_75_degrees(self) -> None:
        wide = scan(np.ones(1040), angle_min=radians(-130), angle_increment=radians(0.25))
        assert degrees(wide[635].angle) == pytest.approx(28.75, abs=1e-9)
        assert wide[635].index == 635

    def test_x_is_forward_and_y_is_left(self) -> None:
        one = scan([2.0, 2.0], angle_min=0.0, angle_increment=pi / 2)
        assert np.allclose(one.x, [2, 0])
        assert np.allclose(one.y, [0, 2])

    def test_points_belong_to_readings_only(self) -> None:
        one = scan([1.0, inf, 3.0])
        assert one.xy.shape == (2, 2)
        assert np.allclose(one.xy, [[cos(0.5), -sin(0.5)], [3 * cos(0.5), 3 * sin(0.5)]])
        assert isnan(one.x[1])
        assert isnan(one.y[1])

    def test_a_negative_increment_runs_clockwise(self) -> None:
        assert scan(angle_min=0.5, angle_increment=-0.5).angles.tolist() == [0.5, 0.0, -0.5]

    def test_a_single_ray_needs_no_increment(self) -> None:
        for increment in (nan, 0.0, 0.3):
            assert scan([1.0], angle_min=0.2, angle_increment=increment).angles.tolist() == [0.2]

    def test_turning_adds_to_every_angle_and_says_nothing_twice(self) -> None:
        odd = scan(np.ones(12), angle_increment=1.0)
        turned = odd.turned(0.25)
        assert np.allclose(turned.angles, odd.angles + 0.25)
        assert whats(turned) == whats(odd) == ("the rays sweep more than a full circle",)
        assert odd.turned(0.0) is odd

    def test_a_circle_that_repeats_its_end_ray_is_not_more_than_a_circle(self) -> None:
        assert whats(circle(361)) == ()
        assert whats(circle(364)) == ("the rays sweep more than a full circle",)

    def test_a_step_in_degrees_is_asked_after(self) -> None:
        assert whats(scan(np.ones(360), angle_min=0.0, angle_increment=1.0)) == ("the rays sweep 57 full circles",)


class TestValidity:
    def test_the_five_classes_stay_apart(self) -> None:
        one = scan([0.1, 30.0, -inf, inf, nan, 0.0, 30.01, -1.0], angle_increment=0.1)
        assert one.validity.tolist() == [0, 0, 1, 2, 3, 4, 4, 4]
        assert one.counts == {
            Validity.READING: 2,
            Validity.TOO_CLOSE: 1,
            Validity.NOTHING_IN_RANGE: 1,
            Validity.NO_MEASUREMENT: 1,
            Validity.OUTSIDE_LIMITS: 3,
        }
        assert one.valid.tolist() == [True, True] + [False] * 6

    def test_a_reading_at_a_limit_is_a_reading_though_float32_rounds(self) -> None:
        for limit in (0.1, 0.12, 3.5, 5.6, 59.99):
            at_max = scan(np.array([limit], np.float32), range_max=limit, range_min=0.0)
            at_min = scan(np.array([limit], np.float32), range_min=limit, range_max=60.0)
            assert at_max.valid.all()
            assert at_min.valid.all()

    def test_doubles_too_large_for_float32_are_beyond_every_range(self) -> None:
        assert scan([1e300, 1.0, 1.0])[0].validity is Validity.NOTHING_IN_RANGE

    @pytest.mark.parametrize(
        "range_max", [inf, np.float32(inf), 1.7976931348623157e308, float(np.finfo(np.float32).max)]
    )
    def test_without_a_limit_every_distance_is_a_reading_and_infinity_is_none(self, range_max: float) -> None:
        one = scan([50.0, 3e38, inf, nan, 0.0], angle_increment=0.1, range_max=range_max)
        assert one.validity.tolist() == [0, 0, 2, 3, 4]
        assert one.range_max == np.finfo(np.float32).max
        assert whats(one) == ()


class TestNearest:
    def test_only_a_sector_may_count_also_across_the_ends_of_a_circle(self) -> None:
        one = scan([1.0, 2.0, 3.0, 0.5], angle_min=0.0, angle_increment=pi / 2)
        assert one.nearest((0, 6.29)) == one[3], "a full turn may be given with few digits"
        found = [one.nearest(sector) for sector in (ALL_ROUND, (-0.1, 0.1), (pi / 2, pi), (-pi / 2, 0.0), (0.1, 0.2))]
        assert [ray and ray.index for ray in found] == [3, 0, 1, 3, None]

    @pytest.mark.parametrize(
        ("sector", "error", "text"),
        [
            ((1, 2, 3), TypeError, r"^sector: expected two angles, .* got \(1, 2, 3\)$"),
            ((0, 90), ValueError, r"^sector: expected radians within ±2 pi, got 90.0; math.radians\(\) makes them"),
            ((0, nan), ValueError, r"^sector: expected a finite number of radians, got nan$"),
        ],
    )
    def test_what_is_not_a_sector_is_refused(
        self, sector: tuple[float, float], error: type[Exception], text: str
    ) -> None:
        with pytest.raises(error, match=text):
            scan().nearest(sector)


class TestShown:
    def test_a_scan_fits_on_a_line(self) -> None:
        assert repr(scan([2.0, 0.5, inf])) == "<Scan of 3 rays from -28.6° to 28.6°, nearest 0.50 m at ranges[1]>"
        assert repr(scan([inf], angle_min=0.0, angle_increment=0.0)) == "<Scan of 1 ray from 0.0° to 0.0°, no readings>"
        assert repr(scan([2.0, -inf, inf])).endswith("° to 28.6°, too close at ranges[1]>")
        assert repr(scan([2.0, 1.0, 0.05])).endswith("° to 28.6°, too close at ranges[2]>")
        assert repr(scan([])) == "<Scan of 0 rays, no readings>"


class TestRays:
    def test_a_reading_has_a_place(self) -> None:
        ray = scan([1.0, 2.0, 3.0], intensities=[7, 8, 9])[2]
        assert ray == Ray(2, 3.0, 0.5, pytest.approx(3 * cos(0.5)), pytest.approx(3 * sin(0.5)), 9.0, Validity.READING)

    def test_a_ray_without_a_reading_has_no_number(self) -> None:
        ray = scan([inf, 2.0, 3.0])[0]
        assert (ray.range, ray.x, ray.y, ray.intensity) == (inf, None, None, None)
        assert ray.validity is Validity.NOTHING_IN_RANGE

    def test_indices_match_the_array_and_count_from_the_end_too(self) -> None:
        one = scan()
        assert one[-1].index == 2
        assert one[np.int64(1)].index == 1
        assert [ray.index for ray in one] == [0, 1, 2]
        assert len(one) == 3

    @pytest.mark.parametrize("index", [3, -4])
    def test_an_index_outside_says_how_many_rays_there_are(self, index: int) -> None:
        with pytest.raises(IndexError, match=rf"^index {index}: this scan has 3 rays$"):
            scan()[index]

    @pytest.mark.parametrize("index", [slice(0, 2), 1.0, "1"])
    def test_an_index_is_a_whole_number(self, index: object) -> None:
        with pytest.raises(TypeError, match=r"^expected the index of one ray, got .*; for several, index scan.ranges$"):
            scan()[index]

    def test_the_nearest_is_the_first_of_the_smallest_readings(self) -> None:
        one = scan([0.0, nan, 5.0, 2.0, 2.0, inf], angle_increment=0.1)
        assert one.nearest().index == 3
        assert one.nearest().range == 2.0

    def test_what_is_too_close_is_nearer_than_any_reading(self) -> None:
        one = scan([2.0, 0.0, 0.05, -inf], angle_increment=0.1)
        assert one.nearest() == one[2]
        assert one.turned(1.0).nearest((1.0 - 0.21, 1.0 - 0.19)).range == -inf

    @pytest.mark.parametrize("ranges", [[], [inf], [nan, nan], [0.0, 0.0]])
    def test_nothing_is_nearest_if_there_is_no_reading(self, ranges: list[float]) -> None:
        assert scan(ranges).nearest() is None


class TestRayAtAnAngle:
    @pytest.mark.parametrize(("at", "index"), [(-0.5, 0), (-0.26, 0), (-0.24, 1), (0.0, 1), (0.74, 2), (-0.74, 0)])
    def test_it_is_the_closest(self, at: float, index: int) -> None:
        assert scan().at(at).index == index

    @pytest.mark.parametrize("at", [0.76, -0.76, pi, 3.0])
    def test_outside_the_sweep_is_none(self, at: float) -> None:
        assert scan().at(at) is None

    @pytest.mark.parametrize("at", [0.5, 0.5 - 2 * pi])
    def test_a_whole_turn_makes_no_difference(self, at: float) -> None:
        assert scan().at(at).index == 2
        assert scan(angle_min=0.5, angle_increment=-0.5).at(at).index == 0

    def test_an_angle_of_the_scan_itself_is_taken_however_large(self) -> None:
        turned = circle().turned(pi)
        assert turned.at(turned.angles[359]).index == 359
        with pytest.raises(ValueError, match="radians within"):
            turned.at(turned.angles[359] + 0.1)

    @pytest.mark.parametrize(("at", "index"), [(-1, 359), (0.4, 0), (359.6, 0), (-0.4, 0), (359.4, 359), (180, 180)])
    def test_a_full_circle_from_forward_closes(self, at: float, index: int) -> None:
        assert circle().at(radians(at)).index == index

    @pytest.mark.parametrize(("at", "index"), [(180, 0), (-180, 0), (179, 359), (0, 180), (181, 1), (359, 179)])
    def test_a_full_circle_from_behind_closes(self, at: float, index: int) -> None:
        assert circle(start=-180).at(radians(at)).index == index

    @pytest.mark.parametrize(("at", "index"), [(0, 0), (-1, 1), (1, 359), (-90, 90), (90, 270)])
    def test_a_clockwise_circle_counts_to_the_right(self, at: float, index: int) -> None:
        assert circle(step=-1.0).at(radians(at)).index == index

    def test_where_a_circle_closes_between_two_steps_the_closer_ray_wins(self) -> None:
        almost = circle(count=4, step=91.0, start=-1.0)
        assert almost.at(radians(-2.5)).index == 0
        assert almost.at(radians(-2.5 - 91 / 2)).index == 3
        overlapping = circle(count=5, step=89.0)
        assert overlapping.at(radians(-3.0)).index == 4
        assert overlapping.at(radians(-1.0)).index == 0

    def test_a_ray_without_a_step_is_at_its_own_angle_only(self) -> None:
        one = scan([1.0], angle_min=0.2, angle_increment=nan)
        assert one.at(0.2).index == 0
        assert one.at(0.3) is None

    def test_an_empty_scan_has_no_ray_anywhere(self) -> None:
        assert scan([]).at(0.0) is None

    def test_an_angle_is_a_finite_number(self) -> None:
        with pytest.raises(ValueError, match=r"^angle: expected a finite number of radians, got nan$"):
            scan().at(nan)

    @pytest.mark.parametrize("value", [90.0, -6.3])
    def test_an_angle_is_in_radians(self, value: float) -> None:
        text = rf"^angle: expected radians within ±2 pi, got {value}; math.radians\(\) makes them of degrees$"
        with pytest.raises(ValueError, match=text):
            circle().at(value)

    @pytest.mark.parametrize("full", [2 * pi, -2 * pi, np.float32(2 * pi)])
    def test_a_full_turn_is_an_angle(self, full: float) -> None:
        assert circle().at(full).index == 0


class TestImmutable:
    @pytest.mark.parametrize("name", ["ranges", "intensities", "angles", "validity", "valid", "x", "y"])
    def test_arrays_of_a_scan_are_read_only(self, name: str) -> None:
        with pytest.raises(ValueError, match="read-only"):
            getattr(scan(intensities=[1, 2, 3]), name)[0] = 1

    @pytest.mark.parametrize(
        ("sample", "name"),
        [(scan(), "range_max"), (Speed(), "linear"), (Touch({"left": True}), "mode"), (Range(0.4), "range")],
    )
    def test_fields_cannot_be_set(self, sample: object, name: str) -> None:
        with pytest.raises(FrozenInstanceError):
            setattr(sample, name, 1)

    def test_what_came_is_not_held_on_to(self) -> None:
        given = np.ones(3, np.float32)
        one = scan(given)
        given[0] = 9
        assert one.ranges[0] == 1
        said = {"left": True}
        touch = Touch(said)
        said["left"] = False
        assert touch.touched["left"] is True
        with pytest.raises(TypeError, match="does not support item assignment"):
            touch.touched["left"] = False


class TestScanErrors:
    @pytest.mark.parametrize(
        ("changed", "text"),
        [
            ({"ranges": np.ones((2, 2))}, r"^ranges: expected a one-dimensional array, got shape \(2, 2\)$"),
            ({"ranges": 3.0}, r"^ranges: expected a one-dimensional array, got shape \(\)$"),
            ({"ranges": np.ones(MAX_RAYS + 1)}, r"^ranges: expected at most 1,000,000 rays, got 1,000,001$"),
            ({"intensities": np.ones((3, 1))}, r"^intensities: expected a one-dimensional array, got shape \(3, 1\)$"),
            ({"angle_min": nan}, r"^angle_min: expected a finite number of radians, got nan$"),
            (
                {"angle_increment": 0.0},
                r"^angle_increment: expected a finite step in radians other than 0 for 3 rays, got 0.0$",
            ),
            ({"angle_increment": inf}, r"^angle_increment: expected a finite step .* for 3 rays, got inf$"),
            ({"range_min": nan}, r"^range_min: expected a finite number of metres, got nan$"),
            ({"range_max": -inf}, r"^range_max: expected a finite number of metres, got -inf$"),
            ({"range_min": -0.5}, r"^range_min: expected metres, 0 or more, got -0.5$"),
            (
                {"range_min": 30.0, "range_max": 0.1},
                r"^range_max: .* above range_min \(30\), got 0.1; are the two swapped\?$",
            ),
            ({"range_min": 2.0, "range_max": 2.0}, r"^range_max: expected metres above range_min \(2\), got 2; "),
        ],
    )
    def test_a_bad_value_is_named_with_what_was_expected(self, changed: dict, text: str) -> None:
        with pytest.raises(ValueError, match=text):
            scan(**changed)

    @pytest.mark.parametrize(
        ("changed", "text"),
        [
            ({"ranges": ["a", "b"]}, r"^ranges: expected a one-dimensional array of numbers, got \['a', 'b'\]$"),
            (
                {"ranges": ["1.0", "2.0"]},
                r"^ranges: expected a one-dimensional array of numbers, got \['1.0', '2.0'\]$",
            ),
            ({"ranges": [1j]}, r"^ranges: expected a one-dimensional array of numbers, got \[1j\]$"),
            ({"ranges": [[1.0, 2.0], [1.0]]}, r"^ranges: expected a one-dimensional array of numbers, got "),
            ({"ranges": [object()] * 40}, r"^ranges: expected .* of numbers, got \[<object object at .{,50}…$"),
            ({"angle_min": "0"}, r"^angle_min: expected radians, or degrees as in .20deg., got '0'$"),
            ({"angle_increment": None}, r"^angle_increment: expected a number, got None$"),
            ({"range_max": True}, r"^range_max: expected a number, got True$"),
        ],
    )
    def test_a_wrong_type_is_named_with_what_was_expected(self, changed: dict, text: str) -> None:
        with pytest.raises(TypeError, match=text):
            scan(**changed)


class TestSpeed:
    def test_values_come_in_the_order_of_the_axes(self) -> None:
        speed = Speed(linear=(1, 2, 3), angular=[4, 5, 6])
        assert dict(zip(AXES, speed.values, strict=True)) == {
            "linear.x": 1.0,
            "linear.y": 2.0,
            "linear.z": 3.0,
            "angular.x": 4.0,
            "angular.y": 5.0,
            "angular.z": 6.0,
        }

    def test_nan_stays_nan(self) -> None:
        assert isnan(Speed(linear=(nan, 0, 0)).values[0])

    def test_numpy_vectors_are_taken(self) -> None:
        assert Speed(linear=np.array([1, 2, 3], np.float32)).linear == (1.0, 2.0, 3.0)

    @pytest.mark.parametrize(
        ("given", "error", "text"),
        [
            ({"linear": 0.5}, TypeError, r"^linear: expected three numbers \(x, y, z\), got 0.5$"),
            (
                {"linear": {"x": 0.4, "y": 0, "z": 0}},
                TypeError,
                r"^linear: expected three numbers .*, got {'x': 0.4, 'y",
            ),
            ({"linear": "0.5"}, TypeError, r"^linear: expected three numbers \(x, y, z\), got '0.5'$"),
            ({"linear": {0.5, 0.1, 0.2}}, TypeError, r"^linear: expected three numbers \(x, y, z\), got {0."),
            ({"angular": (0, "fast", 0)}, TypeError, r"^angular.y: expected a number, got 'fast'$"),
            ({"angular": (0, 0, None)}, TypeError, r"^angular.z: expected a number, got None$"),
            ({"linear": (0, 0)}, ValueError, r"^linear: expected three numbers \(x, y, z\), got 2$"),
        ],
    )
    def test_what_is_not_a_vector_is_refused(self, given: dict, error: type[Exception], text: str) -> None:
        with pytest.raises(error, match=text):
            Speed(**given)


class TestRange:
    @pytest.mark.parametrize(
        ("measured", "validity", "distance"),
        [
            (0.1, Validity.READING, 0.1),
            (5.0, Validity.READING, 5.0),
            (-inf, Validity.TOO_CLOSE, 0.0),
            (inf, Validity.NOTHING_IN_RANGE, inf),
            (nan, Validity.NO_MEASUREMENT, nan),
            (5.01, Validity.OUTSIDE_LIMITS, inf),
            (0.09, Validity.OUTSIDE_LIMITS, 0.0),
            (0.0, Validity.OUTSIDE_LIMITS, nan),
            (-1.0, Validity.OUTSIDE_LIMITS, nan),
        ],
    )
    def test_has_a_class_and_the_distance_that_a_scan_would_have(
        self, measured: float, validity: Validity, distance: float
    ) -> None:
        one = Range(measured, min_range=0.1, max_range=5.0)
        assert one.validity is validity
        assert one.distance == pytest.approx(distance, nan_ok=True)
        like = scan([measured], range_min=0.1, range_max=5.0)
        assert like[0].validity is validity
        assert like.distance() == pytest.approx(distance, nan_ok=True)

    def test_without_limits_any_distance_is_a_reading_and_infinite_is_none(self) -> None:
        assert Range(900.0).validity is Validity.READING
        assert Range(0.0).validity is Validity.READING
        assert Range(inf).validity is Validity.NOTHING_IN_RANGE
        assert Range(inf).distance == inf

    def test_numbers_are_written_as_users_would_write_them(self) -> None:
        one = Range(np.float32(0.42), min_range=np.float32(0.42), max_range=4, field_of_view=np.float32(0.26))
        assert (one.range, one.min_range, one.max_range, one.field_of_view) == (0.42, 0.42, 4.0, 0.26)
        assert one.validity is Validity.READING
        assert Range(1e300).range == inf

    @pytest.mark.parametrize(
        ("given", "error", "text"),
        [
            ({"range": "near"}, TypeError, r"^range: expected a number, got 'near'$"),
            ({"range": True}, TypeError, r"^range: expected a number, got True$"),
            ({"min_range": -0.1}, ValueError, r"^min_range: expected metres, 0 or more, got -0.1$"),
            ({"min_range": nan}, ValueError, r"^min_range: expected metres, 0 or more, got nan$"),
            (
                {"min_range": 4, "max_range": 0.1},
                ValueError,
                r"^max_range: expected metres above min_range \(4\), got 0.1; are the two swapped\?$",
            ),
            ({"max_range": nan}, ValueError, r"^max_range: expected metres above min_range \(0\), got nan$"),
            (
                {"min_range": 0.3, "max_range": 0.3},
                ValueError,
                r"^max_range: expected metres above min_range, got 0.3 for both; .* a touch widget shows it$",
            ),
            ({"field_of_view": 30}, ValueError, r"^field_of_view: expected radians from 0 to 2 pi, got 30.0$"),
            ({"radiation": "radio"}, ValueError, r"^radiation: expected 'ultrasound', 'infrared' or '', got 'radio'$"),
        ],
    )
    def test_what_is_not_a_range_is_refused(self, given: dict, error: type[Exception], text: str) -> None:
        with pytest.raises(error, match=text):
            Range(**{"range": 1.0, **given})


def test_the_yaw_of_damaged_numbers_is_none() -> None:
    assert isnan(yaw_of(*np.full(4, 1e200)))
    assert isnan(yaw_of(*np.full(4, inf)))
    assert yaw_of(0.0, 0.0, np.float64(2.0), 2.0) == pytest.approx(pi / 2)


class TestTouchState:
    def test_only_touched_is_true(self) -> None:
        assert [bool(state) for state in TouchState] == [False, True, False]


class TestTouch:
    def test_sensors_are_the_known_ones_and_then_those_that_were_named(self) -> None:
        touch = Touch({"right": True, "tail": None}, TouchMode.EVENT, ("left", "right"))
        assert touch.sensors == ("left", "right", "tail")

    def test_flags_of_numpy_become_plain(self) -> None:
        assert Touch({"left": np.True_}).touched["left"] is True

    def test_a_mode_may_be_given_by_its_word(self) -> None:
        assert Touch({}, mode="presence").mode is TouchMode.PRESENCE

    @pytest.mark.parametrize(
        ("given", "error", "text"),
        [
            ({"touched": {1: True}}, TypeError, r"^touched: expected sensor names as strings, got 1$"),
            ({"touched": {"left": 1}}, TypeError, r"^touched\['left'\]: expected True, False or None, got 1$"),
            ({"touched": {"left": "yes"}}, TypeError, r"^touched\['left'\]: expected True, False or None, got 'yes'$"),
            ({"touched": ["left"]}, TypeError, r"^touched: expected a mapping of sensor names .*, got \['left'\]$"),
            (
                {"touched": {}, "sensors": "left"},
                TypeError,
                r"^sensors: expected sensor names .* in a tuple, got 'left'$",
            ),
            (
                {"touched": {}, "sensors": (1,)},
                TypeError,
                r"^sensors: expected sensor names .* in a tuple, got \(1,\)$",
            ),
            ({"touched": {}, "mode": "loud"}, ValueError, r"'loud' is not a valid TouchMode$"),
        ],
    )
    def test_what_says_nothing_of_touch_is_refused(self, given: dict, error: type[Exception], text: str) -> None:
        with pytest.raises(error, match=text):
            Touch(**given)


@pytest.mark.parametrize(
    ("ranges", "range_max", "text"),
    [
        ([0.003, 0.004], 0.004, "nearest 0.0030 m at"),
        ([0.003, 4.0], 10.0, "nearest 0.003 m at"),
        ([0.0031, 0.004], inf, "nearest 0.0031 m at"),
        ([2.54, 4.0], 10.0, "nearest 2.54 m at"),
        ([1234.5, 4000.0], 5000.0, "nearest 1.234 km at"),
    ],
)
def test_a_distance_is_written_with_the_decimals_of_its_scale(ranges: list[float], range_max: float, text: str) -> None:
    assert text in repr(Scan(ranges, 0.0, 0.1, 0.0, range_max))


def test_a_distance_is_the_number_that_was_measured() -> None:
    scan = Scan([2.54, -inf, nan, inf], 0.0, 0.5, 0.1, 10.0)
    assert repr(scan[0].range) == "2.54"
    assert repr(Scan([2.54], 0.0, 0.1, 0.1, 10.0).distance()) == "2.54"
    assert [scan[1].range, scan[3].range] == [-inf, inf]
    assert isnan(scan[2].range)

"""`to_scan`, `to_speed` and `to_range` accept the messages of each source, and report odd ones."""

from __future__ import annotations

from array import array
from math import inf, nan, pi, radians
from types import SimpleNamespace

import numpy as np
import pytest

from robowidgets.messages import to_range, to_scan, to_speed, to_touch
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import decoder_of
from robowidgets.messages.encoding import encode
from robowidgets.messages.fields import describe, frame_id, get, has, stamp_ns, type_name, unwrap
from robowidgets.messages.twist import TWIST, TWIST_STAMPED, encode_twist
from robowidgets.samples import Problem, Range, Scan, Speed, Validity

from ..forms import FORMS, rclpy, rosbags, rospy

STAMP = {"sec": 1700000000, "nanosec": 123456789}
STAMP_NS = 1700000000_123456789
HEADER = {"stamp": STAMP, "frame_id": "laser"}


def laser(ranges: object = (1.0, 2.0, 3.0), **changed: object) -> dict:
    """A LaserScan as a dictionary, with what a test changes in it."""
    return {
        "header": HEADER,
        "angle_min": -0.5,
        "angle_max": 0.5,
        "angle_increment": 0.5,
        "time_increment": 0.0,
        "scan_time": 0.1,
        "range_min": 0.1,
        "range_max": 30.0,
        "ranges": ranges,
        "intensities": [],
        **changed,
    }


def vector(x: object = 0.0, y: object = 0.0, z: object = 0.0) -> dict:
    return {"x": x, "y": y, "z": z}


def twist(**linear: object) -> dict:
    return {"linear": vector(**linear), "angular": vector(z=-0.25)}


class TestScan:
    @pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
    def test_comes_from_every_source(self, form) -> None:
        fields = laser([1.0, inf, -inf], intensities=[10.0, 20.0, 30.0])
        scan = to_scan(form("sensor_msgs/LaserScan", fields))
        assert scan.ranges.tolist() == [1.0, inf, -inf]
        assert scan.intensities.tolist() == [10.0, 20.0, 30.0]
        assert (scan.angle_min, scan.angle_increment) == (-0.5, 0.5)
        assert (scan.range_min, scan.range_max) == (pytest.approx(0.1), 30.0)
        assert (scan.stamp_ns, scan.frame_id, scan.problems()) == (STAMP_NS, "laser", ())

    @pytest.mark.parametrize(
        "ranges",
        [
            array("f", [1.0, nan, inf]),
            (1.0, nan, inf),
            [1, None, inf],
            np.array([1.0, nan, inf], np.float32),
            np.array([1.0, nan, inf], np.float64),
            np.array([1.0, nan, inf], ">f4"),
        ],
        ids=["array of rclpy", "tuple of rospy", "list with null", "float32", "float64", "big-endian"],
    )
    def test_takes_ranges_in_every_container(self, ranges: object) -> None:
        scan = to_scan(laser(ranges))
        assert scan.ranges.dtype == np.float32
        assert scan.validity.tolist() == [Validity.READING, Validity.NO_MEASUREMENT, Validity.NOTHING_IN_RANGE]

    def test_does_not_follow_a_buffer_that_its_driver_fills_again(self) -> None:
        buffer = np.ones(3, np.float32)
        scan = to_scan(laser(buffer))
        buffer[:] = 7
        assert scan.ranges.tolist() == [1, 1, 1]

    def test_is_returned_as_it_is(self) -> None:
        scan = to_scan(laser())
        assert to_scan(scan) is scan

    def test_a_stamp_of_zero_was_never_set(self) -> None:
        assert to_scan(laser(header={"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""})).stamp_ns is None

    def test_needs_no_header_and_no_intensities(self) -> None:
        fields = laser()
        for name in ("header", "intensities", "angle_max", "time_increment", "scan_time"):
            del fields[name]
        scan = to_scan(fields)
        assert (scan.stamp_ns, scan.frame_id, len(scan.intensities), scan.problems()) == (None, "", 0, ())

    def test_null_intensities_are_none(self) -> None:
        assert odd(to_scan(laser(intensities=None))) == ()

    @pytest.mark.parametrize(
        ("message", "text"),
        [
            (
                twist(),
                r"got a dict with the keys linear, angular \(missing: ranges, angle_min, angle_increment, range_min, ",
            ),
            ("scan", r"got a str: 'scan' \(missing: ranges"),
            (None, r"got a NoneType: 'None' \(missing: "),
            ([1.0, 2.0], r"got a list: '\[1.0, 2.0\]' \(missing: "),
            (rosbags("std_msgs/String", {"data": "x"}), r"got a std_msgs/String with the fields data \(missing: "),
        ],
    )
    def test_of_something_else_is_refused_with_what_came_and_what_is_missing(self, message: object, text: str) -> None:
        with pytest.raises(
            TypeError, match=rf"^expected a message like sensor_msgs/LaserScan, with ranges, .*; {text}"
        ):
            to_scan(message)

    @pytest.mark.parametrize(
        ("changed", "text"),
        [
            ({"ranges": b"1234"}, r"^ranges: expected an array of numbers, got a bytes"),
            ({"ranges": "1234"}, r"^ranges: expected an array of numbers, got a str: '1234'"),
            ({"ranges": None}, r"^ranges: expected an array of numbers, got a NoneType"),
            ({"ranges": 3.0}, r"^ranges: expected an array of numbers, got a float: '3.0'"),
            ({"ranges": ["1", "2"]}, r"^ranges: expected a one-dimensional array of numbers, got \['1', '2'\]"),
            ({"range_min": None}, r"^range_min: expected a number, got None$"),
            ({"angle_min": "left"}, r"^angle_min: expected radians, or degrees as in .20deg., got 'left'$"),
            ({"angle_max": "right"}, r"^angle_max: expected radians, or degrees as in .20deg., got 'right'$"),
            ({"time_increment": []}, r"^time_increment: expected a number, got \[\]$"),
        ],
    )
    def test_with_a_field_of_the_wrong_type_names_it(self, changed: dict, text: str) -> None:
        with pytest.raises(TypeError, match=text):
            to_scan(laser(**changed))


@pytest.mark.parametrize("writeable", [True, False])
def test_a_scan_does_not_follow_a_buffer_that_its_driver_fills_again(writeable: bool) -> None:
    buffer = np.array([1.0, 2.0, 3.0], np.float32)
    window = buffer.view()
    window.flags.writeable = writeable
    scan = to_scan(laser(window))
    buffer[:] = 9.0
    assert scan.ranges.tolist() == [1.0, 2.0, 3.0]


class TestRange:
    def test_a_single_distance_is_refused_with_an_example(self) -> None:
        message = {"range": 1.0, "min_range": 0.1, "max_range": 4.0, "field_of_view": 0.3, "radiation_type": 0}
        with pytest.raises(
            TypeError, match=r"\(missing: ranges, .*\); a single distance is one ray: ranges=\[message\.range\]"
        ):
            to_scan(message)


def odd(scan: Scan) -> tuple[str, ...]:
    """The problems of a scan, each with a remedy."""
    assert all(problem.remedy for problem in scan.problems())
    return tuple(problem.what for problem in scan.problems())


class TestOddScan:
    """The inputs that exist in the wild."""

    def test_an_lds_01_starts_forward_and_sends_0_for_nothing(self) -> None:
        ranges = np.where(np.arange(360) % 2, 0.0, 1.5)
        scan = to_scan(
            laser(ranges, angle_min=0.0, angle_max=6.26573, angle_increment=0.0174533, range_min=0.12, range_max=3.5)
        )
        assert scan[0].angle == 0.0
        assert scan.counts[Validity.OUTSIDE_LIMITS] == 180
        assert odd(scan) == ()
        assert scan.angles[359] == pytest.approx(radians(359), abs=1e-4)

    def test_a_ydlidar_x4_says_angle_max_one_step_too_far(self) -> None:
        scan = to_scan(
            laser(np.ones(720), angle_min=-3.14159, angle_max=3.14159, angle_increment=0.00872665, range_max=16.0)
        )
        assert odd(scan) == ("angle_max is one step too far for 720 rays",)
        assert scan.angles[719] == pytest.approx(-3.14159 + 719 * 0.00872665)

    def test_a_newer_x4_driver_sends_fewer_rays_than_its_header_implies(self) -> None:
        scan = to_scan(
            laser(np.ones(719), angle_min=-3.14159, angle_max=3.14159, angle_increment=0.00869044, range_max=16.0)
        )
        assert odd(scan) == ("719 rays, but the header implies 724 (angle_max 180.0°)",)

    @pytest.mark.parametrize("increment", [nan, None, 0.0])
    def test_a_single_ray_points_at_angle_min(self, increment: float | None) -> None:
        scan = to_scan(laser([10.47], angle_min=0.0, angle_max=0.0, angle_increment=increment))
        assert scan.xy.tolist() == [[pytest.approx(10.47), 0.0]]
        noted = ("one ray, angle_increment is not a number: drawn at angle_min",)
        assert odd(scan) == (() if increment == 0.0 else noted)

    @pytest.mark.parametrize("range_max", [inf, None])
    def test_a_converter_of_point_clouds_sets_no_limit_which_json_cannot_say(self, range_max: float | None) -> None:
        scan = to_scan(laser([0.5, 80.0, inf], range_max=range_max))
        assert scan.validity.tolist() == [Validity.READING, Validity.READING, Validity.NOTHING_IN_RANGE]

    def test_an_upside_down_scanner_runs_clockwise(self) -> None:
        scan = to_scan(laser([1, 1, 1], angle_min=pi / 2, angle_max=-pi / 2, angle_increment=-pi / 2))
        assert np.allclose(scan.angles, [pi / 2, 0, -pi / 2])
        assert np.allclose(scan.y, [1, 0, -1])
        assert odd(scan) == ()

    @pytest.mark.parametrize("first", [-135.0, 6.3])
    def test_an_angle_min_that_looks_like_degrees_is_noted(self, first: float) -> None:
        scan = to_scan(laser([1, 1, 1], angle_min=first, angle_max=first + 1.0, angle_increment=0.5))
        assert odd(scan) == (f"angle_min is {first:g} rad",)

    @pytest.mark.parametrize("first", [2 * pi, np.float32(2 * pi), -2 * pi])
    def test_an_angle_min_of_a_full_turn_is_not_odd(self, first: float) -> None:
        assert odd(to_scan(laser([1, 1, 1], angle_min=first, angle_max=first + 1.0, angle_increment=0.5))) == ()

    def test_an_angle_max_against_the_increment_is_noted(self) -> None:
        scan = to_scan(laser([1, 1, 1], angle_min=1.0, angle_max=-1.0, angle_increment=1.0))
        assert scan.angles.tolist() == [1, 2, 3]
        assert odd(scan) == ("angle_max (-57.3°) lies against angle_increment",)

    @pytest.mark.parametrize(("first", "step", "last"), [(3.0, 0.5, 4.0 - 2 * pi), (-3.0, -0.5, 2 * pi - 4.0)])
    def test_a_sweep_across_the_back_is_not_odd(self, first: float, step: float, last: float) -> None:
        scan = to_scan(laser([1, 1, 1], angle_min=first, angle_max=last, angle_increment=step))
        assert odd(scan) == ()

    @pytest.mark.parametrize(
        ("value", "kind"),
        [(inf, Validity.NOTHING_IN_RANGE), (-inf, Validity.TOO_CLOSE), (0.0, Validity.OUTSIDE_LIMITS)],
    )
    def test_all_rays_alike_are_counted_in_their_class(self, value: float, kind: Validity) -> None:
        scan = to_scan(laser([value] * 3))
        assert scan.counts == {k: 3 if k is kind else 0 for k in Validity}
        assert scan.nearest() == (scan[0] if kind is Validity.TOO_CLOSE else None)

    def test_an_empty_scan_is_a_scan(self) -> None:
        scan = to_scan(laser([]))
        assert len(scan) == 0
        assert odd(scan) == ("the scan has no rays",)

    def test_a_header_lie_of_an_rplidar_is_turned_right(self) -> None:
        scan = to_scan(laser(np.ones(4), angle_min=-pi, angle_max=pi / 2, angle_increment=pi / 2)).turned(pi)
        assert np.allclose(scan.angles, [0, pi / 2, pi, 3 * pi / 2])
        assert scan.turned("-180deg").angle_min == -pi

    def test_intensities_of_another_length_are_noted_and_not_used(self) -> None:
        scan = to_scan(laser(intensities=[1.0, 2.0]))
        assert odd(scan) == ("2 intensities for 3 rays: not used",)
        assert len(scan.intensities) == 0

    def test_a_header_without_a_frame_is_noted_and_numbers_without_a_header_are_not(self) -> None:
        assert odd(to_scan(laser() | {"header": {**HEADER, "frame_id": ""}})) == ("frame_id is empty",)
        assert odd(to_scan({k: v for k, v in laser().items() if k != "header"})) == ()

    def test_absurd_times_are_noted_and_not_used(self) -> None:
        scan = to_scan(laser(time_increment=153333.3, scan_time=1.1e8))
        assert odd(scan) == ("time_increment is 153333 s: not used", "scan_time is 1.1e+08 s: not used")

    @pytest.mark.parametrize(("value", "word"), [(nan, "nan"), (-1.0, "-1"), (inf, "inf")])
    def test_invalid_times_are_noted(self, value: float, word: str) -> None:
        assert odd(to_scan(laser(scan_time=value))) == (f"scan_time is {word} s: not used",)

    def test_a_header_that_differs_and_times_that_are_absurd_are_both_noted(self) -> None:
        assert odd(to_scan(laser([1.0] * 5, time_increment=153333.3))) == (
            "5 rays, but the header implies 3 (angle_max 28.6°)",
            "time_increment is 153333 s: not used",
        )


SPEEDS = {
    "geometry_msgs/Twist": (twist(x=0.5), None, ""),
    "geometry_msgs/TwistStamped": ({"header": HEADER, "twist": twist(x=0.5)}, STAMP_NS, "laser"),
    "geometry_msgs/TwistWithCovariance": ({"twist": twist(x=0.5), "covariance": [0.0] * 36}, None, ""),
    "geometry_msgs/TwistWithCovarianceStamped": (
        {"header": HEADER, "twist": {"twist": twist(x=0.5), "covariance": [0.0] * 36}},
        STAMP_NS,
        "laser",
    ),
    "nav_msgs/Odometry": (
        {
            "header": HEADER | {"frame_id": "odom"},
            "child_frame_id": "base_link",
            "pose": {"pose": {"position": vector(), "orientation": vector()}},
            "twist": {"twist": twist(x=0.5), "covariance": [0.0] * 36},
        },
        STAMP_NS,
        "base_link",
    ),
}


class TestSpeed:
    @pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
    @pytest.mark.parametrize("type_name", SPEEDS)
    def test_comes_from_every_source(self, type_name: str, form) -> None:
        fields, stamp, frame = SPEEDS[type_name]
        speed = to_speed(form(type_name, fields))
        assert speed == Speed((0.5, 0.0, 0.0), (0.0, 0.0, -0.25), stamp, frame)

    def test_null_is_not_a_value_and_never_0(self) -> None:
        speed = to_speed(twist(x=None, y=nan, z=inf))
        assert np.isnan(speed.linear[:2]).all()
        assert speed.linear[2] == inf

    def test_is_returned_as_it_is(self) -> None:
        speed = Speed()
        assert to_speed(speed) is speed

    @pytest.mark.parametrize(
        ("message", "text"),
        [
            (laser(), r"AckermannDrive; got a dict with the keys header, angle_min, .*, …$"),
            ({"twist": {"linear": vector()}}, r"AckermannDrive; got a dict with the keys twist$"),
            (0.5, r"got a float: '0.5'$"),
        ],
    )
    def test_of_something_else_is_refused(self, message: object, text: str) -> None:
        with pytest.raises(TypeError, match=rf"^expected a message like geometry_msgs/Twist, .*{text}"):
            to_speed(message)

    @pytest.mark.parametrize(
        ("message", "text"),
        [
            ({"linear": [1, 2, 3], "angular": vector()}, r"^linear: expected a vector with x, y and z, got a list: "),
            (
                {"linear": vector(), "angular": {"x": 0}},
                r"^angular: expected a vector with .*, got a dict with the keys x$",
            ),
            (twist(x="fast"), r"^linear.x: expected a number, got 'fast'$"),
        ],
    )
    def test_with_a_vector_of_no_use_names_it(self, message: dict, text: str) -> None:
        with pytest.raises(TypeError, match=text):
            to_speed(message)


def ranger(measured: object = 0.42, **changed: object) -> dict:
    """A Range as a dictionary, with what a test changes in it."""
    limits = {"radiation_type": 0, "field_of_view": 0.5, "min_range": 0.1, "max_range": 5.0}
    return {"header": {**HEADER, "frame_id": "sonar_3"}, **limits, "range": measured, **changed}


class TestDistance:
    @pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
    def test_comes_from_every_source(self, form) -> None:
        read = to_range(form("sensor_msgs/Range", ranger()))
        assert read == Range(0.42, 0.1, 5.0, 0.5, "ultrasound", STAMP_NS, "sonar_3")

    def test_is_returned_as_it_is(self) -> None:
        one = Range(1.0)
        assert to_range(one) is one

    @pytest.mark.parametrize(("code", "radiation"), [(0, "ultrasound"), (1, "infrared"), (7, ""), (None, "")])
    def test_has_the_name_of_its_radiation(self, code: object, radiation: str) -> None:
        assert to_range(ranger(radiation_type=code)).radiation == radiation

    def test_null_is_not_a_measurement_and_not_a_limit(self) -> None:
        read = to_range(ranger(None, max_range=None))
        assert read.validity is Validity.NO_MEASUREMENT
        assert read.max_range == inf

    def test_needs_no_header_and_no_opening_angle(self) -> None:
        assert to_range({"range": 1, "min_range": 0, "max_range": 4}) == Range(1.0, 0.0, 4.0)

    @pytest.mark.parametrize(
        ("view", "what"),
        [
            (30.0, "field_of_view is 30 rad: not used; is it in degrees? math.radians() makes them of degrees"),
            (-0.5, "field_of_view is -0.5 rad: not used; the driver should send radians, 0 if unknown"),
        ],
    )
    def test_an_invalid_opening_angle_does_not_lose_the_distance(self, view: float, what: str) -> None:
        read = to_range(ranger(field_of_view=view))
        assert (read.distance, read.field_of_view) == (0.42, 0.0)
        assert tuple(map(str, read.problems)) == (what,)
        assert isinstance(read.problems[0], Problem)

    def test_one_that_tells_whether_something_is_there_stays_a_touch_sensor(self) -> None:
        message = ranger(-inf, min_range=0.3, max_range=0.3)
        with pytest.raises(ValueError, match=r"^max_range: .*, got 0.3 for both; .* a touch widget shows it$"):
            to_range(message)
        assert to_touch(message).touched == {"sonar_3": True}

    @pytest.mark.parametrize(
        ("message", "text"),
        [
            (laser(), r"got a dict with the keys header, angle_min, .*, … \(missing: range, min_range, max_range\)$"),
            (0.5, r"got a float: '0.5' \(missing: range, min_range, max_range\)$"),
        ],
    )
    def test_of_something_else_is_refused(self, message: object, text: str) -> None:
        with pytest.raises(TypeError, match=rf"^expected a message like sensor_msgs/Range, with range, .*{text}"):
            to_range(message)


class TestFields:
    def test_a_path_goes_through_attributes_and_keys(self) -> None:
        message = {"a": SimpleNamespace(b={"c": 5})}
        assert get(message, "a.b.c") == 5
        assert get(message, "a.x.c", None) is None
        assert has(message, "a.b", "a")
        assert not has(message, "a", "a.c")

    def test_only_an_envelope_of_a_publication_is_opened(self) -> None:
        assert unwrap({"op": "publish", "topic": "/t", "msg": {"data": 1}}) == {"data": 1}
        assert unwrap({"op": "status", "msg": "text"}) == {"op": "status", "msg": "text"}

    @pytest.mark.parametrize("stamp", [None, {}, {"sec": "x"}, {"sec": inf}, {"sec": 0, "nanosec": 0}])
    def test_an_empty_stamp_is_none(self, stamp: object) -> None:
        assert stamp_ns({"header": {"stamp": stamp}}) is None

    def test_a_frame_that_is_not_there_is_empty(self) -> None:
        assert frame_id({"ranges": []}) == ""

    @pytest.mark.parametrize("form", [rosbags, rospy, rclpy], ids=lambda form: form.__name__)
    def test_a_type_is_named_as_users_write_it(self, form) -> None:
        assert type_name(form("std_msgs/Bool", {"data": True})) == "std_msgs/Bool"
        assert describe(form("std_msgs/Bool", {"data": True})) == "a std_msgs/Bool with the fields data"


def test_a_moment_of_a_recording_stands_for_its_sample() -> None:
    moment = SimpleNamespace(topic="/odom", time_ns=1, sample=Speed((1, 2, 3), (4, 5, 6)))
    assert to_speed(moment) is moment.sample


@pytest.mark.parametrize("frame", ["", "base_link", "odom", "über"])
@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_a_twist_has_the_bytes_that_any_message_has(encoding: str, frame: str) -> None:
    fields = {"linear": vector(0.3, -0.1, 1e-9), "angular": vector(z=-inf)}
    stamped = {"header": {"stamp": STAMP, "frame_id": frame}, "twist": fields}
    assert encode_twist(encoding, TWIST, fields) == encode(encoding, TWIST, fields)
    assert encode_twist(encoding, TWIST_STAMPED, stamped) == encode(encoding, TWIST_STAMPED, stamped)
    assert encode_twist(encoding, TWIST_STAMPED, {}) == encode(encoding, TWIST_STAMPED, {})


def test_what_json_has_for_nan_and_for_bytes_is_that_in_the_bytes_of_a_message() -> None:
    battery = {"voltage": 12.0, "temperature": None, "present": None, "cell_voltage": [None, 4.0]}
    kind = "sensor_msgs/msg/BatteryState"
    read = decoder_of(Channel(0, "", kind, "cdr", "", 0))(encode("cdr", kind, battery))
    assert (read.voltage, read.current, read.present) == (12.0, 0.0, False)
    assert np.isnan([read.temperature, read.cell_voltage[0]]).all()
    kind = "sensor_msgs/msg/CompressedImage"
    image = {"format": "jpeg", "data": "AP7/"}
    read = decoder_of(Channel(0, "", kind, "cdr", "", 0))(encode("cdr", kind, image))
    assert bytes(read.data) == b"\x00\xfe\xff"
    with pytest.raises(ValueError, match="a message does not fit sensor_msgs/msg/CompressedImage: "):
        encode("cdr", kind, {"data": "no base64"})

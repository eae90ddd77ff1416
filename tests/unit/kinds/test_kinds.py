"""The table of kinds: the kind of each message type."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from robowidgets import LaserWidget, kinds
from robowidgets.kinds import (
    KINDS,
    Role,
    counts_every_message,
    is_command,
    is_standard,
    is_undecided,
    kind_of_message,
    kind_of_shape,
    kind_of_type,
    kinds_of_type,
)
from robowidgets.laser.row import LASER
from robowidgets.samples import Scan, Speed, Touch
from robowidgets.sonar.row import SONAR
from robowidgets.speed.row import SPEED
from robowidgets.touch.row import TOUCH

from ...more_rows.gauges import GAUGE

VECTOR = {"x": "float64", "y": "float64", "z": "float64"}
SCAN = {
    **dict.fromkeys(("angle_min", "angle_max", "angle_increment", "range_min", "range_max"), "float32"),
    "ranges": "float32[]",
}


TWIST = {"linear": dict.fromkeys("xyz", 0.5), "angular": dict.fromkeys("xyz", 0.0)}
RANGE = "sensor_msgs/msg/Range"


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("sensor_msgs/msg/LaserScan", LASER),
        ("geometry_msgs/msg/TwistStamped", SPEED),
        ("nav_msgs/msg/Odometry", SPEED),
        ("kobuki_ros_interfaces/msg/BumperEvent", TOUCH),
        ("irobot_create_msgs/msg/HazardDetectionVector", TOUCH),
        ("sensor_msgs/msg/Imu", None),
    ],
)
def test_known_types_have_their_kind(name: str, kind: kinds.Kind | None) -> None:
    assert kind_of_type(name) is kind
    assert kinds_of_type(name) == ((kind,) if kind else ())


def test_unknown_types_are_judged_by_their_fields() -> None:
    assert kind_of_shape({"header": {}, **SCAN}) is LASER
    assert kind_of_shape({"linear": VECTOR, "angular": VECTOR}) is SPEED
    assert kind_of_shape({"name": "string", "twist": {"twist": {"linear": VECTOR, "angular": VECTOR}}}) is SPEED
    assert kind_of_shape({"linear": VECTOR, "angular": "float64"}) is None
    assert kind_of_shape({"twist": "float64"}) is None


def test_many_echoes_are_not_a_scan() -> None:
    assert kind_of_shape({**SCAN, "ranges": "sensor_msgs/msg/LaserEcho[]"}) is None


def test_an_acceleration_is_not_a_speed_though_it_has_its_fields() -> None:
    assert is_standard("geometry_msgs/msg/Accel")
    assert kind_of_type("geometry_msgs/msg/Accel") is None
    assert not is_standard("my_robot_msgs/msg/Velocity")


def test_a_message_of_a_range_tells_whether_it_is_a_touch_sensor_or_a_sonar() -> None:
    assert is_undecided(RANGE)
    assert kind_of_type(RANGE) is None
    assert kinds_of_type(RANGE) == (TOUCH, SONAR)
    sensor = {"header": {}, "radiation_type": 1, "field_of_view": 0.1, "max_range": 0.3, "range": float("inf")}
    assert kind_of_message({**sensor, "min_range": 0.3}, RANGE) is TOUCH
    assert kind_of_message({**sensor, "min_range": 0.1}, RANGE) is SONAR


def test_a_message_of_an_unknown_type_is_of_a_kind_that_is_known_by_its_fields() -> None:
    assert kind_of_message(TWIST, "my_robot_msgs/msg/Velocity") is SPEED
    assert kind_of_message({"left": True}, "my_robot_msgs/msg/Bumpers") is None, "any message may be flags by name"
    assert kind_of_message({"x": 1.0}) is None


def test_a_message_with_bad_numbers_is_still_of_its_kind() -> None:
    bad = {"ranges": [1.0], "angle_min": 0.0, "angle_increment": 0.1, "range_min": 9.0, "range_max": 1.0}
    with pytest.raises(ValueError, match="range"):
        LASER.read(bad)
    assert kind_of_message(bad, "my_robot_msgs/msg/Scan") is LASER


@pytest.mark.parametrize(
    ("sample", "kind"),
    [(Scan([1.0], 0.0, 0.1, 0.1, 9.0), LASER), (Speed((0, 0, 0), (0, 0, 0)), SPEED), (Touch({"left": True}), TOUCH)],
)
def test_a_sample_is_of_its_kind_whatever_the_type(sample: object, kind: kinds.Kind) -> None:
    assert kind_of_message(sample) is kind
    assert kind_of_message(sample, "sensor_msgs/msg/LaserScan") is kind


def test_every_message_of_a_touch_sensor_counts() -> None:
    assert counts_every_message("kobuki_msgs/msg/BumperEvent")
    assert not counts_every_message("sensor_msgs/msg/LaserScan")
    assert not counts_every_message("sensor_msgs/msg/Imu")


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda kind: kind.name)
def test_the_sample_before_the_first_is_of_its_kind(kind: kinds.Kind) -> None:
    assert kind.read(kind.nothing) is kind.nothing
    assert isinstance(kind.nothing, kind.sample)


@pytest.mark.parametrize(
    ("topic", "commanded"),
    [
        ("/cmd_vel", True),
        ("/robot1/cmd_vel_nav", True),
        ("/mobile_base/commands/velocity", True),
        ("/odom", False),
        ("/velocity", False),
    ],
)
def test_a_speed_is_commanded_where_the_name_says_so(topic: str, commanded: bool) -> None:
    assert is_command(topic) is commanded


def test_only_kinds_with_commands_have_commanded_topics() -> None:
    assert SPEED.is_command("/cmd_vel", "geometry_msgs/msg/Twist")
    assert not LASER.is_command("/cmd_vel", "sensor_msgs/msg/LaserScan")


def test_some_types_are_commands_whatever_their_topic_is_called() -> None:
    assert SPEED.is_command("/drive", "ackermann_msgs/msg/AckermannDriveStamped")
    assert not SPEED.is_command("/drive", "geometry_msgs/msg/Twist")


@pytest.mark.parametrize(
    ("row", "text"),
    [
        ((None, "std_msgs/msg/String", False), ""),
        (("laser", "sensor_msgs/msg/LaserScan", False), "laser"),
        (("speed", "geometry_msgs/msg/Twist", True), "speed (commanded)"),
        (("speed", "nav_msgs/msg/Odometry", False), "speed, path"),
        (("speed", "geometry_msgs/msg/Twist, nav_msgs/msg/Odometry", False), "speed, path"),
        (("speed", "nav_msgs/msg/Odometry", True), "speed (commanded)"),
    ],
)
def test_a_table_names_all_widgets_of_a_topic(row: tuple[str | None, str, bool], text: str) -> None:
    assert kinds.widgets_of(*row) == text


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        (
            {"name": "laser"},
            "name: expected .* other than .*laser.*, got 'laser'; replace=True replaces a row",
        ),
        ({"name": "two words"}, "name: expected an identifier"),
        ({"sample_name": "scan"}, "sample_name: expected an identifier other than .*scan"),
        ({"sample_name": "sonars"}, "sample_name: expected an identifier other than .*sonars"),
        ({"roles": (Role(name="scan", combine=dict),)}, "parameter: expected an identifier other than .*scan"),
        ({"sample_name": "time_ns"}, "sample_name: expected an identifier other than time_ns"),
        (
            {"types": frozenset({"std_msgs/Float64"})},
            "types: expected message types .*, got 'std_msgs/Float64'",
        ),
    ],
)
def test_a_row_that_cannot_be_is_refused(changed: dict[str, Any], text: str) -> None:
    before = dict(KINDS)
    with pytest.raises(ValueError, match=text):
        kinds.add(replace(GAUGE, **changed))
    assert before == KINDS


@pytest.mark.parametrize("key", ["widget", "frames", "columns", "rerun"])
@pytest.mark.parametrize("given", ["module:name", LaserWidget])
def test_a_row_with_a_name_or_a_class_instead_of_a_function_is_refused(key: str, given: Any) -> None:
    with pytest.raises(TypeError, match=f"{key}: expected a function that imports and returns the class, got"):
        kinds.add(replace(GAUGE, **{key: given}))
    with pytest.raises(TypeError, match=r"row: expected a kinds\.Kind or a kinds\.OnDemandWidget, got"):
        kinds.add(given)
    assert GAUGE.name not in KINDS


def test_only_a_kind_may_have_no_widget() -> None:
    with pytest.raises(TypeError, match="widget: expected a function that imports and returns the class, got None"):
        kinds.add(kinds.OnDemandWidget(name="lost", widget=None))


def test_a_row_is_added_with_the_kinds_of_its_roles_or_not_at_all() -> None:
    before = dict(KINDS)
    taken = replace(GAUGE, name="laser", sample_name="level", roles=(Role(name="level"),), widget=None)
    row = replace(GAUGE, roles=(Role(name="gauge"), Role(name="level", take="level", kind=taken)))
    with pytest.raises(ValueError, match="name: expected an identifier other than"):
        kinds.add(row)
    assert before == KINDS

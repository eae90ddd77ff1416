"""Which widget shows what."""

from __future__ import annotations

import pytest

from robowidgets.kinds import is_command, is_standard, widget_by_shape, widget_by_type

VECTOR = {"x": "float64", "y": "float64", "z": "float64"}
SCAN = {
    **dict.fromkeys(("angle_min", "angle_max", "angle_increment", "range_min", "range_max"), "float32"),
    "ranges": "float32[]",
}


@pytest.mark.parametrize(
    ("name", "widget"),
    [
        ("sensor_msgs/msg/LaserScan", "laser"),
        ("geometry_msgs/msg/TwistStamped", "speed"),
        ("nav_msgs/msg/Odometry", "speed"),
        ("kobuki_ros_interfaces/msg/BumperEvent", "touch"),
        ("irobot_create_msgs/msg/HazardDetectionVector", "touch"),
        ("sensor_msgs/msg/Imu", None),
    ],
)
def test_known_types_have_their_widget(name: str, widget: str | None) -> None:
    assert widget_by_type(name) == widget


def test_unknown_types_are_judged_by_their_fields() -> None:
    assert widget_by_shape({"header": {}, **SCAN}) == "laser"
    assert widget_by_shape({"linear": VECTOR, "angular": VECTOR}) == "speed"
    assert widget_by_shape({"name": "string", "twist": {"twist": {"linear": VECTOR, "angular": VECTOR}}}) == "speed"
    assert widget_by_shape({"linear": VECTOR, "angular": "float64"}) is None
    assert widget_by_shape({"twist": "float64"}) is None


def test_many_echoes_are_no_scan() -> None:
    assert widget_by_shape({**SCAN, "ranges": "sensor_msgs/msg/LaserEcho[]"}) is None


def test_an_acceleration_is_no_speed_though_it_has_its_fields() -> None:
    assert is_standard("geometry_msgs/msg/Accel")
    assert widget_by_type("geometry_msgs/msg/Accel") is None
    assert not is_standard("my_robot_msgs/msg/Velocity")


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

"""The constants of a definition that name the values of a field."""

from __future__ import annotations

import pytest

from robowidgets.messages.channel import Channel
from robowidgets.messages.schema import Schema, constants_in, names_of, schema_of


def schema(type_name: str, definition: str = "", encoding: str = "cdr") -> Schema:
    return Schema(Channel(0, "", type_name, encoding, definition, 0))


@pytest.mark.parametrize(
    ("type_name", "field", "number", "name"),
    [
        ("diagnostic_msgs/msg/DiagnosticStatus", "level", 2, "ERROR"),
        ("sensor_msgs/msg/BatteryState", "power_supply_health", 1, "GOOD"),
        ("sensor_msgs/msg/NavSatFix", "position_covariance_type", 2, "DIAGONAL_KNOWN"),
        ("sensor_msgs/msg/NavSatStatus", "status", -1, "NO_FIX"),
        ("rcl_interfaces/msg/Log", "level", 30, "WARN"),
        ("visualization_msgs/msg/Marker", "type", 4, "LINE_STRIP"),
        ("visualization_msgs/msg/Marker", "action", 0, "ADD"),
        ("kobuki_msgs/msg/BumperEvent", "bumper", 0, "LEFT"),
        ("kobuki_msgs/msg/BumperEvent", "state", 0, "RELEASED"),
        ("irobot_create_msgs/msg/HazardDetection", "type", 1, "BUMP"),
        ("action_msgs/msg/GoalStatus", "status", 4, "SUCCEEDED"),
        ("gps_msgs/msg/GPSStatus", "motion_source", 4, "DOPPLER"),
        ("gps_msgs/msg/GPSStatus", "position_source", 4, "DOPPLER"),
        ("lifecycle_msgs/msg/State", "id", 3, "PRIMARY_STATE_ACTIVE"),
    ],
)
def test_a_number_has_the_name_that_the_definition_tells(type_name: str, field: str, number: int, name: str) -> None:
    assert schema(type_name).fields(type_name)[field].names[str(number)] == name


@pytest.mark.parametrize(
    ("type_name", "field"),
    [
        ("visualization_msgs/msg/Marker", "id"),
        ("sensor_msgs/msg/Image", "height"),
        ("turtlebot3_msgs/msg/SensorState", "left_encoder"),
        ("rcl_interfaces/msg/Log", "line"),
    ],
)
def test_a_number_has_no_name_where_the_definition_does_not_tell_whose_it_is(type_name: str, field: str) -> None:
    assert schema(type_name).fields(type_name)[field].names == {}


def test_the_definition_in_a_file_comes_before_the_one_that_is_known() -> None:
    text = "uint8 LOW=0 # volts below 3\nuint8 HIGH = 0x10\nstring WORD=none\nfloat32 PI=3.14\nuint8 state\n"
    assert constants_in(text) == [("LOW", "uint8", 0), ("HIGH", "uint8", 16)]
    assert schema("my_msgs/msg/Level", text).fields("my_msgs/msg/Level")["state"].names == {"0": "LOW", "16": "HIGH"}


def test_a_message_within_the_message_has_its_own() -> None:
    outer = "my_msgs/Mode mode\nfloat32[3] values\nHeader header\n" + "=" * 80 + "\nMSG: my_msgs/Mode\n"
    outer += (
        "uint8 OFF=0\nuint8 ON=1\nuint8 now\n"
        + "=" * 80
        + "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
    )
    known = schema("my_msgs/msg/Outer", outer, "ros1")
    fields = known.fields("my_msgs/msg/Outer")
    assert (fields["mode"].type, fields["mode"].is_message) == ("my_msgs/msg/Mode", True)
    assert (fields["values"].type, fields["values"].is_array) == ("float32", True)
    assert known.fields("my_msgs/msg/Mode")["now"].names == {"0": "OFF", "1": "ON"}
    assert known.fields("std_msgs/msg/Header")["stamp"].type == "time"
    assert known.fields("my_msgs/msg/Other") == {}


def test_names_lose_the_words_that_all_of_them_have_or_that_are_the_name_of_their_field() -> None:
    constants = [
        ("GRIPPER_OPEN", "uint8", 0),
        ("GRIPPER_SHUT", "uint8", 1),
        ("ARM_UP", "int16", 0),
        ("ARM", "int16", 1),
    ]
    assert names_of(constants, {"hand": "uint8", "arm": "int16"}) == {
        "hand": {0: "OPEN", 1: "SHUT"},
        "arm": {0: "UP"},
    }


def test_an_unknown_type_has_no_schema() -> None:
    assert schema_of(object()) is None
    assert schema_of({}, "nobody_msgs/msg/Nothing") is None
    assert schema_of({}, "a text") is None

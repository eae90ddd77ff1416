"""`to_touch` understands every dialect, from every source."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from robowidgets.messages import to_touch
from robowidgets.messages.touch import TOUCH_TYPES
from robowidgets.samples import Touch, TouchMode

from ..forms import FORMS, rclpy, rosbags, rospy

STAMP = {"sec": 5, "nanosec": 7}
HEADER = {"stamp": STAMP, "frame_id": "base"}
STAMP_NS = 5_000_000_007
INF = float("inf")
KOBUKI = ("kobuki_msgs", "kobuki_ros_interfaces")
CREATE3 = (
    "left",
    "front left",
    "front center",
    "front right",
    "right",
    "cliff side left",
    "cliff front left",
    "cliff front right",
    "cliff side right",
    "wheel left",
    "wheel right",
)


def hazard(frame: str, kind: int) -> dict:
    return {"header": {"stamp": STAMP, "frame_id": frame}, "type": kind}


def contact(first: str, second: str) -> dict:
    return {"collision1": {"name": first}, "collision2": {"name": second}}


def state(first: str, second: str) -> dict:
    return {"info": "", "collision1_name": first, "collision2_name": second}


def kobuki_state(bumper: int = 0, cliff: int = 0, wheel_drop: int = 0) -> dict:
    return {"header": HEADER, "time_stamp": 1, "bumper": bumper, "cliff": cliff, "wheel_drop": wheel_drop, "buttons": 0}


def turtlebot3_state(bumper: int, cliff: float = 0.5) -> dict:
    return {"header": HEADER, "bumper": bumper, "cliff": cliff, "sonar": 0.1, "illumination": 3.0, "torque": True}


def ranger(value: float | None, low: float = 0.1, high: float = 0.1, frame: str = "wall") -> dict:
    return {"header": {"stamp": STAMP, "frame_id": frame}, "min_range": low, "max_range": high, "range": value}


FREE_KOBUKI = dict.fromkeys(
    ("left", "center", "right", "cliff left", "cliff center", "cliff right", "wheel left", "wheel right"), False
)
LIGHTS = ("left", "front_left", "center_left", "center_right", "front_right", "right")
CLIFFS = ("left", "front_left", "front_right", "right")
CREATE = {"header": HEADER, "is_left_pressed": True, "is_right_pressed": False}

EVENT, LEVEL, PRESENCE = TouchMode.EVENT, TouchMode.LEVEL, TouchMode.PRESENCE
CASES = {
    # type, fields, mode, touched sensors, sensors from left to right (None: the named sensors)
    "bumper left": ("kobuki_msgs/BumperEvent", {"bumper": 0, "state": 1}, EVENT, {"left": True}),
    "bumper center": ("kobuki_ros_interfaces/BumperEvent", {"bumper": 1, "state": 1}, EVENT, {"center": True}),
    "bumper right off": ("kobuki_msgs/BumperEvent", {"bumper": 2, "state": 0}, EVENT, {"right": False}),
    "cliff left": ("kobuki_msgs/CliffEvent", {"sensor": 0, "state": 1, "bottom": 9}, EVENT, {"cliff left": True}),
    "cliff right off": (
        "kobuki_msgs/CliffEvent",
        {"sensor": 2, "state": 0, "bottom": 9},
        EVENT,
        {"cliff right": False},
    ),
    "wheel left off": ("kobuki_msgs/WheelDropEvent", {"wheel": 0, "state": 0}, EVENT, {"wheel left": False}),
    "wheel right": ("kobuki_msgs/WheelDropEvent", {"wheel": 1, "state": 1}, EVENT, {"wheel right": True}),
    "button 0": ("kobuki_msgs/ButtonEvent", {"button": 0, "state": 1}, EVENT, {"button 0": True}),
    "button 2 off": ("kobuki_msgs/ButtonEvent", {"button": 2, "state": 0}, EVENT, {"button 2": False}),
    "kobuki free": ("kobuki_msgs/SensorState", kobuki_state(), LEVEL, FREE_KOBUKI),
    "kobuki right": ("kobuki_msgs/SensorState", kobuki_state(bumper=1), LEVEL, FREE_KOBUKI | {"right": True}),
    "kobuki center": ("kobuki_msgs/SensorState", kobuki_state(bumper=2), LEVEL, FREE_KOBUKI | {"center": True}),
    "kobuki left": ("kobuki_msgs/SensorState", kobuki_state(bumper=4), LEVEL, FREE_KOBUKI | {"left": True}),
    "kobuki many": (
        "kobuki_ros_interfaces/SensorState",
        kobuki_state(bumper=5, cliff=4, wheel_drop=1),
        LEVEL,
        FREE_KOBUKI | {"left": True, "right": True, "cliff left": True, "wheel right": True},
    ),
    "kobuki wheel left": (
        "kobuki_msgs/SensorState",
        kobuki_state(wheel_drop=2),
        LEVEL,
        FREE_KOBUKI | {"wheel left": True},
    ),
    "kobuki cliff": (
        "kobuki_msgs/SensorState",
        kobuki_state(cliff=3),
        LEVEL,
        FREE_KOBUKI | {"cliff right": True, "cliff center": True},
    ),
    "create 1": ("create_msgs/Bumper", CREATE, LEVEL, {"left": True, "right": False}),
    "create 2": (
        "create_msgs/Bumper",
        CREATE | {f"is_light_{place}": place == "center_left" for place in LIGHTS},
        LEVEL,
        {"left": True, "right": False}
        | {f"light {place.replace('_', ' ')}": place == "center_left" for place in LIGHTS},
    ),
    "create cliff": (
        "create_msgs/Cliff",
        {"header": HEADER} | {f"is_cliff_{place}": place == "front_right" for place in CLIFFS},
        LEVEL,
        {f"cliff {place.replace('_', ' ')}": place == "front_right" for place in CLIFFS},
    ),
    "create wheel": (
        "ca_msgs/Wheeldrop",
        {"header": HEADER, "is_left_dropped": False, "is_right_dropped": True},
        LEVEL,
        {"wheel left": False, "wheel right": True},
    ),
    "no hazard": ("irobot_create_msgs/HazardDetectionVector", {"header": HEADER, "detections": []}, PRESENCE, {}),
    "hazards that are no touch": (
        "irobot_create_msgs/HazardDetectionVector",
        {"header": HEADER, "detections": [hazard("base_link", 0), hazard("base_link", 3), hazard("lid", 9)]},
        PRESENCE,
        {},
    ),
    "hazards": (
        "irobot_create_msgs/HazardDetectionVector",
        {
            "header": HEADER,
            "detections": [
                hazard("bump_front_center", 1),
                hazard("bump_left", 1),
                hazard("cliff_side_left", 2),
                hazard("wheel_drop_right", 4),
                hazard("base_link", 0),
                hazard("base_link", 3),
                hazard("ir_intensity_front_left", 5),
                hazard("bump_left", 3),
                hazard("somewhere", 1),
                hazard("lid", 9),
            ],
        },
        PRESENCE,
        dict.fromkeys(
            (
                "front center",
                "left",
                "cliff side left",
                "wheel right",
                "bump somewhere",
            ),
            True,
        ),
    ),
    "turtlebot3 front": ("turtlebot3_msgs/SensorState", turtlebot3_state(1), LEVEL, {"front": True, "back": False}),
    "turtlebot3 back": ("turtlebot3_msgs/SensorState", turtlebot3_state(2), LEVEL, {"front": False, "back": True}),
    "turtlebot3 both": ("turtlebot3_msgs/SensorState", turtlebot3_state(3), LEVEL, {"front": True, "back": True}),
    "gazebo": (
        "gazebo_msgs/ContactsState",
        {
            "header": HEADER,
            "states": [state("bot::bumper", "wall"), state("bot::bumper", "wall"), state("arm", "wall")],
        },
        PRESENCE,
        {"bot::bumper": True, "arm": True},
    ),
    "gazebo, nothing": ("gazebo_msgs/ContactsState", {"header": HEADER, "states": []}, PRESENCE, {}),
    "ros_gz": (
        "ros_gz_interfaces/Contacts",
        {"header": HEADER, "contacts": [contact("bot::bumper", "ground")]},
        PRESENCE,
        {"bot::bumper": True},
    ),
    "bool": ("std_msgs/Bool", {"data": True}, LEVEL, {"touch": True}),
    "bool off": ("std_msgs/Bool", {"data": False}, LEVEL, {"touch": False}),
    "range, detected": ("sensor_msgs/Range", ranger(-INF), LEVEL, {"wall": True}),
    "range, free": ("sensor_msgs/Range", ranger(INF), LEVEL, {"wall": False}),
    "range, null": ("sensor_msgs/Range", ranger(None), LEVEL, {"wall": None}),
    "range, a distance": ("sensor_msgs/Range", ranger(0.1), LEVEL, {"wall": None}),
    "range, NaN": ("sensor_msgs/Range", ranger(float("nan")), LEVEL, {"wall": None}),
    "range, no frame": ("sensor_msgs/Range", ranger(INF, frame=""), LEVEL, {"touch": False}),
    "neato": (
        "neato2_interfaces/Bump",
        {"left_front": 1, "left_side": 0, "right_front": 0, "right_side": 1},
        LEVEL,
        {"left side": False, "left front": True, "right front": False, "right side": True},
    ),
    "neato, ROS 1": (
        "neato_node/Bump",
        {"leftFront": 1, "leftSide": 0, "rightFront": 0, "rightSide": 1},
        LEVEL,
        {"left side": False, "left front": True, "right front": False, "right side": True},
    ),
}
SENSORS = {
    "kobuki_msgs/BumperEvent": ("left", "center", "right"),
    "kobuki_msgs/CliffEvent": ("cliff left", "cliff center", "cliff right"),
    "kobuki_msgs/WheelDropEvent": ("wheel left", "wheel right"),
    "kobuki_msgs/ButtonEvent": ("button 0", "button 1", "button 2"),
    "kobuki_msgs/SensorState": tuple(FREE_KOBUKI),
    "irobot_create_msgs/HazardDetectionVector": CREATE3,
    "turtlebot3_msgs/SensorState": ("front", "back"),
    "create_msgs/Cliff": tuple(f"cliff {place.replace('_', ' ')}" for place in CLIFFS),
    "ca_msgs/Wheeldrop": ("wheel left", "wheel right"),
    **dict.fromkeys(
        ("neato2_interfaces/Bump", "neato_node/Bump"), ("left side", "left front", "right front", "right side")
    ),
}


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
@pytest.mark.parametrize("case", CASES)
def test_says_what_the_message_says(case: str, form) -> None:
    type_name, fields, mode, touched = CASES[case]
    touch = to_touch(form(type_name, fields))
    known = SENSORS.get(type_name.replace(*reversed(KOBUKI)), ())
    assert dict(touch.touched) == touched
    assert touch.mode is mode
    assert touch.sensors == (*known, *(name for name in touched if name not in known))
    typed = form in (rosbags, rospy, rclpy)
    assert touch.dialect == (type_name if typed else type_name.replace(*reversed(KOBUKI)))
    assert touch.stamp_ns == (STAMP_NS if "header" in fields else None)


def test_every_row_of_the_table_is_a_case_and_a_topic_type() -> None:
    tested = {type_name for type_name, *_ in CASES.values()}
    same = {f"{package}/{t.split('/')[1]}" for t in tested if t.startswith("kobuki") for package in KOBUKI}
    older = {"ca_msgs/Bumper", "ca_msgs/Cliff", "ros_ign_interfaces/Contacts"}
    assert {t.replace("/", "/msg/") for t in tested | same | older} == TOUCH_TYPES


def test_bits_of_kobuki_states_count_the_other_way_round_than_its_events() -> None:
    event = to_touch({"bumper": 2, "state": 1})
    level = to_touch(kobuki_state(bumper=1))
    assert [name for name, on in event.touched.items() if on] == ["right"]
    assert [name for name, on in level.touched.items() if on] == ["right"]


def test_the_cliff_of_a_turtlebot3_is_a_reading_and_never_a_touch() -> None:
    assert dict(to_touch(turtlebot3_state(0, cliff=1.0)).touched) == {"front": False, "back": False}


def test_a_plain_mapping_names_its_own_sensors() -> None:
    touch = to_touch({"left": True, "right": np.False_, "back": None})
    assert dict(touch.touched) == {"left": True, "right": False, "back": None}
    assert touch.touched["right"] is False
    assert touch.sensors == ("left", "right", "back")
    assert touch.mode is LEVEL


@pytest.mark.parametrize(
    "names", [("bumper", "cliff"), ("bumper", "state"), ("states",), ("contacts",), ("detections",), ("wheel", "state")]
)
def test_a_plain_mapping_may_use_the_words_of_messages(names: tuple[str, ...]) -> None:
    assert to_touch(dict.fromkeys(names, True)).sensors == names


@pytest.mark.parametrize(
    "names",
    [
        ("data",),
        ("left_side", "left_front", "right_front", "right_side"),
        ("leftSide", "leftFront", "rightFront", "rightSide"),
        ("is_left_pressed", "is_right_pressed"),
        ("is_left_dropped", "is_right_dropped"),
        tuple(f"is_cliff_{place}" for place in CLIFFS),
    ],
)
def test_a_plain_mapping_with_all_fields_of_a_message_loses_no_other_name_and_no_unknown_state(
    names: tuple[str, ...],
) -> None:
    more = {**dict.fromkeys(names, True), "back": True}
    assert dict(to_touch(more).touched) == more
    unknown = {**dict.fromkeys(names, True), names[-1]: None}
    assert dict(to_touch(unknown).touched) == unknown


def test_a_touch_is_returned_as_it_is() -> None:
    touch = Touch({"left": True}, EVENT)
    assert to_touch(touch) is touch


@pytest.mark.parametrize("sides", [("wall", "bot::bumper"), ("bot::bumper", "wall")])
def test_a_contact_is_named_by_the_robots_own_side(sides: tuple[str, str]) -> None:
    for message in ({"states": [state(*sides)]}, {"contacts": [contact(*sides)]}):
        touch = to_touch(message, own=("bot::arm", "bot::bumper"))
        assert dict(touch.touched) == {"bot::bumper": True}
        assert touch.sensors == ("bot::arm", "bot::bumper")


def test_names_of_the_robots_own_concern_contacts_only() -> None:
    assert to_touch({"data": True}, own=("bot::bumper",)).sensors == ("touch",)


@pytest.mark.parametrize(
    ("message", "text"),
    [
        ({"bumper": 3, "state": 1}, r"^bumper: expected 0 \(left\), 1 \(center\) or 2 \(right\), got 3$"),
        ({"bumper": -1, "state": 1}, r"^bumper: expected 0 \(left\), 1 \(center\) or 2 \(right\), got -1$"),
        ({"bumper": 0, "state": 2}, r"^state: expected 0 \(released\) or 1 \(pressed\), got 2$"),
        ({"sensor": 0, "state": 2}, r"^state: expected 0 \(floor\) or 1 \(cliff\), got 2$"),
        ({"wheel": 2, "state": 0}, r"^wheel: expected 0 \(wheel left\) or 1 \(wheel right\), got 2$"),
        ({"wheel": 1, "state": 7}, r"^state: expected 0 \(raised\) or 1 \(dropped\), got 7$"),
        ({"button": 3, "state": 0}, r"^button: expected 0 \(button 0\), 1 \(button 1\) or 2 \(button 2\), got 3$"),
        (kobuki_state(bumper=8), r"^bumper: expected a sum of 4 \(left\), 2 \(center\) and 1 \(right\), got 8$"),
        (kobuki_state(wheel_drop=5), r"^wheel_drop: expected a sum of 2 \(wheel left\) and 1 \(wheel right\), got 5$"),
        (turtlebot3_state(4), r"^bumper: expected a sum of 1 \(front\) and 2 \(back\), got 4$"),
        (
            {"left_front": 2, "left_side": 0, "right_front": 0, "right_side": 0},
            r"^left_front: expected 0 \(released\) or 1 \(pressed\), got 2$",
        ),
        (
            ranger(1.5, low=0.1, high=4.0),
            r"^min_range: expected the same as max_range, because only such a Range is a touch sensor; "
            r"got 0.1 and 4 m \(a sensor that measures distance\)$",
        ),
    ],
)
def test_a_number_without_a_meaning_is_an_error_and_not_a_guess(message: dict, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        to_touch(message)


@pytest.mark.parametrize(
    ("message", "text"),
    [
        ({"bumper": "left", "state": 1}, r"^bumper: expected a whole number, got 'left'$"),
        ({"bumper": 1.0, "cliff": 0.5}, r"^bumper: expected a whole number, got 1.0$"),
        (CREATE | {"is_right_pressed": "no"}, r"^is_right_pressed: expected True or False, got 'no'$"),
        ({"bumper": None, "state": 1}, r"^bumper: expected a whole number, got None$"),
        (
            {"detections": [{"type": 1}]},
            r"^detections\[0\]: expected a hazard with header.frame_id and type, got a dict with",
        ),
        ({"detections": 3}, r"^detections: expected a list, got 3$"),
        (
            {"states": [{"name": "x"}]},
            r"^states\[0\]: expected a contact with collision1_name and collision2_name, got a dict",
        ),
        (
            {"contacts": [contact("bot", "wall"), {"collision1": 5}]},
            r"^contacts\[1\]: expected a contact with collision1.name and collision2.name, got a dict with",
        ),
        (ranger("far"), r"^range: expected a number, got 'far'$"),
        (
            {"left": None, "front": np.True_, "right": 0, "back": 1},
            r"^right: expected True, False or None in a mapping of sensor names, got 0; bool\(\) converts a number$",
        ),
        ({"data": 1}, r"^data: expected True, False or None in a mapping of sensor names, got 1; bool\(\) converts"),
        (
            {"left": 1.0},
            r"^left: expected True, False or None in a mapping of sensor names, got 1.0; bool\(\) converts",
        ),
        (
            {"right": True, "left": "True"},
            r"^left: expected True, False or None in a mapping of sensor .*, got 'True'$",
        ),
        ({0: True}, r"^touched: expected sensor names as strings, got 0$"),
    ],
)
def test_a_field_of_no_use_is_named(message: dict, text: str) -> None:
    with pytest.raises(TypeError, match=text):
        to_touch(message)


@pytest.mark.parametrize(
    ("message", "came"),
    [
        ({"left": 1, "right": [True]}, "a dict with the keys left, right"),
        ({}, r"a dict with the keys \(none\)"),
        ([True, False], r"a list: '\[True, False\]'"),
        (np.zeros(2), r"a ndarray: '\[0. 0.\]'"),
        (None, "a NoneType: 'None'"),
        ("left", "a str: 'left'"),
    ],
)
def test_anything_else_is_refused_with_the_list_of_what_is_understood(message: object, came: str) -> None:
    with pytest.raises(TypeError, match=rf"got {came}$") as error:
        to_touch(message)
    text = str(error.value)
    words = "expected sensor names with True, False or None, like {'left': True}, or a message like one of "
    assert text.startswith(f"{words}create_msgs/Bumper, create_msgs/Cliff, ")
    assert all(re.search(rf"{type_name}[,;] ", text) for type_name in SENSORS)


def test_a_real_neato_is_pressed_at_22_seconds_on_both_front_sides(data: Path) -> None:
    from rosbags.highlevel import AnyReader

    with AnyReader([data / "good" / "neato_fsm_zstd.mcap"]) as reader:
        bumps = [
            ((at - reader.start_time) / 1e9, to_touch(reader.deserialize(raw, connection.msgtype)))
            for connection, at, raw in reader.messages([c for c in reader.connections if c.topic == "/bump"])
        ]
    pressed = [
        (at, {name for name, on in touch.touched.items() if on}) for at, touch in bumps if any(touch.touched.values())
    ]
    assert len(bumps) > len(pressed) == 13
    assert pressed[0][0] == pytest.approx(21.96, abs=0.005)
    assert set().union(*(names for _, names in pressed)) == {"left front", "right front"}

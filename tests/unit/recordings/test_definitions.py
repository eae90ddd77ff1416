"""Our message definitions, against the hashes that ROS gives to the originals."""

from __future__ import annotations

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from robowidgets.messages.definitions import SAME_AS, definitions
from robowidgets.messages.touch import TOUCH_TYPES

PACKAGES = (
    *("kobuki_msgs", "create_msgs", "irobot_create_msgs", "turtlebot3_msgs", "neato2_interfaces", "gazebo_msgs"),
    *("ca_msgs", "neato_node", "ros_gz_interfaces", *SAME_AS),
)

# The first 16 digits of RIHS01, from the code that ROS 2 generates for these packages.
ROS2 = {
    "kobuki_ros_interfaces/msg/BumperEvent": "ca5b8abfc41495a1",
    "kobuki_ros_interfaces/msg/ButtonEvent": "f826413de9f26534",
    "kobuki_ros_interfaces/msg/CliffEvent": "a44cab1e368d1eca",
    "kobuki_ros_interfaces/msg/SensorState": "a508b53460c5282c",
    "kobuki_ros_interfaces/msg/WheelDropEvent": "93672e804bcf316e",
    "turtlebot3_msgs/msg/SensorState": "e35bc7db55e7a7ae",
    "gazebo_msgs/msg/ContactsState": "1dc585e627c16551",
    "ros_gz_interfaces/msg/Contact": "ba5acbac280b8650",
    "ros_gz_interfaces/msg/Entity": "266a26f377057ebb",
    "ros_gz_interfaces/msg/JointWrench": "aa50610f0bc1a9f1",
}

# The MD5 sums of ROS 1, in which the constants count too.
ROS1 = {
    "kobuki_msgs/msg/CliffEvent": "c5b106efbb1427a94f517c5e05f06295",
    "ca_msgs/msg/Bumper": "18fe5b1d31e6a8db180b924157ac665e",
    "neato_node/msg/Bump": "459d87767ce0f2ebdc162046e9ad2c13",
    "turtlebot3_msgs/msg/SensorState": "7250c1dc0b61c4190e78f528f599285f",
    "gazebo_msgs/msg/ContactState": "48c0ffb054b8c444f870cecea1ee50d9",
    "gazebo_msgs/msg/ContactsState": "acbcb1601a8e525bf72509f18e6f668d",
}


def store(base: Stores) -> Typestore:
    result = get_typestore(base)
    types = {}
    for package in PACKAGES:
        for name, text in definitions(package).items():
            types.update(get_types_from_msg(text, name))
    result.register(types)
    return result


@pytest.mark.parametrize("name", ROS2)
def test_fields_are_those_of_ros_2(name: str) -> None:
    assert store(Stores.ROS2_HUMBLE).hash_rihs01(name).removeprefix("RIHS01_")[:16] == ROS2[name]


@pytest.mark.parametrize("name", ROS1)
def test_fields_are_those_of_ros_1(name: str) -> None:
    assert store(Stores.ROS1_NOETIC).generate_msgdef(name)[1] == ROS1[name]


def test_every_touch_dialect_has_a_definition_here_or_in_rosbags() -> None:
    assert store(Stores.ROS2_HUMBLE).fielddefs.keys() >= TOUCH_TYPES


def test_a_package_that_is_not_here_has_none() -> None:
    assert definitions("sensor_msgs") == {}
    assert definitions("../messages") == {}

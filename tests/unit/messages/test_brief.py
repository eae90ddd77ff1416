"""A message in one line."""

from __future__ import annotations

from array import array
from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from robowidgets.messages.brief import MOST, brief, number
from robowidgets.samples import Range, Speed, Touch


@dataclass
class Header:
    stamp: Any
    frame_id: str


@dataclass
class Imu:
    header: Header
    rates: Any
    covariance: Any
    __msgtype__ = "sensor_msgs/msg/Imu"


class Slotted:
    """As a message of rclpy, whose slots have an underscore, and properties without."""

    __slots__ = ("_check_fields", "_data")

    def __init__(self, data: Any) -> None:
        self._data = data

    @property
    def data(self) -> Any:
        return self._data


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ({"data": 1.5}, "1.5"),
        ({"data": "hello\nthere"}, '"hello there"'),
        ({"data": True}, "true"),
        (Slotted(array("f", [1, 2])), "[1, 2]"),
        (Slotted(array("f", [1] * 360)), "[360]"),
        (
            Imu(Header({"sec": 1, "nanosec": 2}, "imu"), {"x": 0.0, "y": 0.0, "z": -0.5}, np.zeros(9)),
            "rates.z \N{MINUS SIGN}0.5, covariance [9], rates.x 0, rates.y 0",
        ),
        ({"joints": [{"name": "a"}]}, "[1]"),
        ({"height": 480, "width": 640, "encoding": "rgb8", "data": b""}, "640\N{MULTIPLICATION SIGN}480 rgb8"),
        ({"height": 1, "width": 12000, "point_step": 16, "data": b""}, "12,000 points"),
        ({"height": 480, "width": 640, "distortion_model": "", "d": []}, "640\N{MULTIPLICATION SIGN}480"),
        (
            {"header": {}, "info": {"resolution": 0.05, "width": 302, "height": 205}, "data": b""},
            "302\N{MULTIPLICATION SIGN}205 cells",
        ),
        ({"header": {}, "name": ["a", "b"], "position": [], "velocity": [], "effort": []}, "2 joints"),
        ({"header": {}, "poses": [{}]}, "1 pose"),
        ({"level": 30, "name": "scan", "msg": "12 rays were lost", "file": "x.cpp"}, '"12 rays were lost"'),
        (Range(0.42, min_range=0.1, max_range=5.0), "0.42 m"),
        (Range(float("nan"), min_range=0.1, max_range=5.0), "NaN m"),
        ({"transforms": [{}, {}]}, "2 frames"),
        (
            {"status": [{"level": 0, "name": "a", "message": ""}, {"level": b"\2", "name": "arm", "message": "hot"}]},
            "ERROR: arm hot, of 2",
        ),
        ({"level": 1, "name": "arm", "message": "warm", "hardware_id": ""}, "arm: WARN warm"),
        ({"status": [{"level": "warn", "name": "a", "message": "b"}]}, "[1]"),
        ({"status": [{"level": None}, {"level": 1}]}, "[2]"),
        (
            {"level": "high", "message": "x", "hardware_id": "y", "name": "n"},
            'level "high", message "x", hardware_id "y", name "n"',
        ),
        ({"level": 1, "message": "x", "hardware_id": "y"}, 'level 1, message "x", hardware_id "y"'),
        ({"height": "10", "width": "a", "point_step": 1}, 'height "10", width "a", point_step 1'),
        ({"height": 3, "width": None, "point_step": 1}, "height 3, width None, point_step 1"),
        (deque([1, 2]), "[1, 2]"),
        ({"level": "Ag==", "name": "arm", "message": "hot", "hardware_id": ""}, "arm: ERROR hot"),
        (Speed((0.2, 0.0, 0.0), (0.0, 0.0, -0.5)), "0.2 m/s, \N{MINUS SIGN}0.5 rad/s"),
        (Speed((1.0, float("nan"), 0.0), (0.0, 0.0, float("nan"))), "1 m/s"),
        (Touch({"left": True, "right": False}), "left"),
        (Touch({"left": False}), "nothing touched"),
        (None, "None"),
        (float("nan"), "NaN"),
        ([], "[0]"),
        ({}, "{}"),
        (object, "<class 'object'>"),
    ],
)
def test_a_message_of_any_kind_is_one_line(value: Any, text: str) -> None:
    assert brief(value) == text


def test_a_line_is_never_long_whatever_comes() -> None:
    deep: Any = {"x": 1}
    for _ in range(100):
        deep = {"inner": deep}
    for value in (
        {"data": "a" * 1_000_000},
        {f"field_{i}": i + 0.123456 for i in range(2000)},
        {"a" * 500: 1},
        deep,
        ["x" * 1000] * 3,
        bytes(1_000_000),
    ):
        assert len(brief(value)) <= MOST
        assert "\n" not in brief(value)


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0"), (-0.0, "0"), (10.0, "10"), (1e-9, "1e\N{MINUS SIGN}09"), (1234567.0, "1.23e+06")]
)
def test_a_number_keeps_what_matters(value: float, text: str) -> None:
    assert number(value) == text

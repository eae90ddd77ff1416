"""Commands of cars: a speed and a steering angle."""

from __future__ import annotations

from math import isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import Speed, SpeedWidget
from robowidgets.feeds import Advert, Feed
from robowidgets.messages import to_speed

from ..feeds.scripted import ODOM, Scripted
from ..waiting import wait_for
from . import recorded

DRIVE, STAMPED = "ackermann_msgs/msg/AckermannDrive", "ackermann_msgs/msg/AckermannDriveStamped"
FIELDS = {"speed": 1.5, "steering_angle": -0.25, "acceleration": 0.5}


@pytest.mark.parametrize("message", [FIELDS, {"header": recorded.stamped(7, "car"), "drive": FIELDS}])
def test_a_command_of_a_car_is_a_speed_ahead_and_a_steering_angle(message: dict[str, Any]) -> None:
    speed = to_speed(message)
    assert (speed.linear[0], speed.steering) == (1.5, -0.25)
    assert all(map(isnan, speed.values[1:]))
    assert speed.stamp_ns == (7 if "drive" in message else None)


def test_a_speed_without_an_angle_has_no_steering() -> None:
    assert to_speed({"linear": dict.fromkeys("xyz", 0), "angular": dict.fromkeys("xyz", 0)}).steering is None
    with pytest.raises(TypeError, match="steering: expected"):
        Speed(steering="left")  # type: ignore[arg-type]


@pytest.mark.parametrize("type_name", [DRIVE, STAMPED])
def test_a_recording_has_them_as_commands_whatever_their_topic_is_called(tmp_path: Path, type_name: str) -> None:
    messages = [(i / 10, "/drive", FIELDS if type_name == DRIVE else {"drive": FIELDS}) for i in range(3)]
    with robowidgets.open(recorded.write(tmp_path / "x", {"/drive": type_name}, messages)) as recording:
        (topic,) = recording.topics
        assert (topic.widget, topic.commanded) == ("speed", True)
        speeds = recording.speeds("/drive")
        assert speeds.steering.tolist() == [-0.25] * 3
        assert speeds.linear[:, 0].tolist() == [1.5] * 3
        assert speeds.to_numpy()["steering"].tolist() == [-0.25] * 3
        assert speeds[1].sample.steering == -0.25
        name = "steering_angle" if type_name == DRIVE else "drive.steering_angle"
        assert recording.fields("/drive")[name].tolist() == [-0.25] * 3
        player = recording.show()
        (view,) = player.views
        assert (view.widget.bars, view.widget.title) == ("commanded", "/drive")
        player.seek(0.1)
        assert view.widget.speed.steering == -0.25
        player.close()


def test_speeds_without_an_angle_have_nan(tmp_path: Path) -> None:
    messages = [(0.0, "/odom", {}), (1.0, "/odom", {})]
    with robowidgets.open(recorded.write(tmp_path / "x", {"/odom": "nav_msgs/msg/Odometry"}, messages)) as recording:
        assert np.isnan(recording.speeds().steering).all()
        assert "steering" not in recording.speeds().to_numpy()


def test_a_feed_shows_them_with_the_measured_speeds() -> None:
    script = Scripted(ODOM, Advert("/drive", STAMPED))
    with Feed(script) as feed:
        feed.connect("/odom", widget := SpeedWidget())
        feed.connect("/drive", widget.command)
        script.listener.on_message("/drive", {"header": {}, "drive": FIELDS})
        assert widget.commanded is not None
        assert widget.commanded.steering == -0.25
        (drive,) = (topic for topic in feed.topics if topic.name == "/drive")
        assert (drive.widget, drive.commanded) == ("speed", True)
        got: list[Any] = []
        feed.connect("/drive", got.append)
        script.listener.on_message("/drive", {"header": {}, "drive": FIELDS})
        wait_for(lambda: got, "it came")
        assert got[0].steering == -0.25


def test_what_is_frozen_keeps_its_angle() -> None:
    widget = SpeedWidget()
    widget.update(to_speed(FIELDS))
    widget.paused = True
    assert widget.frozen is not None
    assert widget.frozen.steering == -0.25
    assert "steering -0.25 rad" in repr(widget)
    widget.close()


def test_null_of_json_is_not_a_number() -> None:
    speed = to_speed({"drive": {"speed": None, "steering_angle": None}})
    assert isnan(speed.linear[0])
    assert speed.steering is not None
    assert isnan(speed.steering)


def test_a_steering_angle_that_is_not_a_number_is_null_for_the_page() -> None:
    widget = SpeedWidget()
    widget.update(Speed(steering=nan))
    assert widget.speed is not None
    widget.close()

"""A recording as a feed."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

import robowidgets
from robowidgets import SAMPLE, LaserWidget, RecordingError, feeds
from robowidgets.feeds import Feed
from robowidgets.feeds.replay import Played
from robowidgets.recordings import RecordingData

from ..clocks import ManualClock
from ..pages import synced
from ..recordings import recorded
from ..recordings.test_definitions import unknown_recording
from ..waiting import wait_for


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


def played(path: Path, clock: ManualClock, speed: float) -> Feed:
    """A feed of a recording that is played by moving the clock."""
    return Feed(Played(RecordingData(path), speed, False, clock))


def test_a_recording_is_played_to_its_end_at_any_speed(clock: ManualClock) -> None:
    with robowidgets.open(SAMPLE) as recording:
        recorded = [(moment.seconds, moment.sample.stamp_ns) for moment in recording.samples("/scan")]
        duration = recording.duration
    got: list[int | None] = []
    laser = LaserWidget()
    with played(SAMPLE, clock, speed=100) as feed:
        feed.connection.attach("/scan", lambda scan: got.append(scan.stamp_ns), lambda _: None)
        feed.connect("/scan", laser)
        clock.advance(0.0501)
        assert got == [stamp for seconds, stamp in recorded if seconds <= 5.01]
        clock.advance(duration / 100 - 0.0502)
        assert synced(laser, "_source")["status"] == ""
        clock.advance(0.0002)
        assert synced(laser, "_source")["status"] == "sample.mcap is at its end"
    assert got == [stamp for _, stamp in recorded]


def test_its_topics_match_the_file() -> None:
    with feeds.recording(SAMPLE) as feed:
        assert [(topic.name, topic.type) for topic in feed.topics] == [
            ("/scan", "sensor_msgs/msg/LaserScan"),
            ("/odom", "nav_msgs/msg/Odometry"),
            ("/cmd_vel", "geometry_msgs/msg/TwistStamped"),
            ("/bumper", "kobuki_ros_interfaces/msg/BumperEvent"),
        ]
        assert list(feed.show().widgets) == ["/scan", "/odom", "/bumper"]
        assert feed.where == "sample.mcap"


def test_in_a_loop_it_starts_again() -> None:
    stamps: list[int | None] = []
    with feeds.recording(SAMPLE, speed=300, loop=True) as feed:
        feed.connect("/scan", lambda scan: stamps.append(scan.stamp_ns))
        wait_for(lambda: any(b < a for a, b in pairwise(stamps)), "it restarts")  # type: ignore[operator]


def test_topics_that_are_connected_later_join_at_the_same_time(clock: ManualClock) -> None:
    with robowidgets.open(SAMPLE) as recording:
        stamps = [moment.sample.stamp_ns for moment in recording.samples("/odom", 4.0, 5.0)]
    got: list[int | None] = []
    with played(SAMPLE, clock, speed=20) as feed:
        feed.connection.attach("/scan", lambda _: None)
        clock.advance(4.0 / 20)
        feed.connection.attach("/odom", lambda speed: got.append(speed.stamp_ns), lambda _: None)
        clock.advance(0.999 / 20)
    assert got == stamps


def test_a_topic_that_no_widget_shows_comes_as_messages_in_its_place_among_the_others(
    clock: ManualClock, tmp_path: Path
) -> None:
    messages = [(0.1 * i, "/imu", {"linear_acceleration": {"x": float(i)}}) for i in range(20)]
    speeds = [(0.1 * i + 0.05, "/speed", {"linear": {"x": float(i)}}) for i in range(20)]
    types = {"/imu": "sensor_msgs/msg/Imu", "/speed": "geometry_msgs/msg/Twist"}
    path = recorded.write(tmp_path / "x", types, sorted([*messages, *speeds], key=lambda one: one[0]))
    came: list[tuple[str, float]] = []
    take = {
        "/imu": lambda message: came.append(("imu", message.linear_acceleration.x)),
        "/speed": lambda speed: came.append(("speed", speed.linear[0])),
    }
    with played(path, clock, speed=10) as feed:
        for topic, function in take.items():
            feed.connection.attach(topic, function, lambda _: None)
        clock.advance(0.2)
    assert came == [(name, float(i)) for i in range(20) for name in ("imu", "speed")]


def test_a_topic_that_cannot_be_read_says_why(tmp_path: Path) -> None:
    with feeds.recording(unknown_recording(tmp_path / "x")) as feed:
        feed.connect("/status", lambda _: None)
        wait_for(lambda: "cannot be read" in feed.connection.status_of("/status"), "it is reported")
        assert "my_msgs" in feed.connection.status_of("/status")


def test_a_real_recording_plays(data: Path) -> None:
    with feeds.recording(data / "good" / "hokuyo_people.bag", loop=True) as feed:
        view = feed.show()
        (laser,) = view.widgets.values()
        wait_for(lambda: laser.scan, "a scan has come")
        assert len(laser.scan) == 512


def test_words_for_what_cannot_be_played(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"nowhere\.bag"):
        feeds.recording(tmp_path / "nowhere.bag")
    with pytest.raises(ValueError, match="speed: expected seconds of the recording in a second, above 0, got 0"):
        feeds.recording(SAMPLE, speed=0)
    for loop in ("yes", 1, None):
        with pytest.raises(TypeError, match=rf"^loop: expected True or False, got {loop!r}$"):
            feeds.recording(SAMPLE, loop=loop)
    expected = r"^recording\(\): expected the path of a file or folder, such as 'drive.bag', got"
    with pytest.raises(TypeError, match=f"{expected} None$"):
        feeds.recording(None)
    with (
        robowidgets.open(SAMPLE) as opened,
        pytest.raises(TypeError, match=f"{expected} a Recording; an open recording"),
    ):
        feeds.recording(opened)
    with feeds.recording(SAMPLE) as feed, pytest.raises(TypeError, match=f"{expected} a Feed$"):
        feeds.recording(feed)


def test_a_program_drives_it_and_its_speeds_are_shown_next_to_the_recorded_ones() -> None:
    with feeds.recording(SAMPLE, loop=True) as feed:
        feed.driving = feeds.Driving(hold=3600.0)
        view = feed.show()
        feed.drive(0.25, 0.5)
        wait_for(lambda: "/cmd_vel (your program)" in view.widgets, "it has a widget of its own")
        feed.drive(0.25, 0.5)
        own = view.widgets["/cmd_vel (your program)"]
        wait_for(lambda: own.speed and own.speed.values[::5] == (0.25, 0.5), "it shows what the program drives")
        then = view.widgets["/odom"]
        assert then.command_title == "/cmd_vel"
        assert not then.commanded or then.commanded.values[::5] != (0.25, 0.5)
        assert "commanded linear.x 0.25 m/s" in repr(own)
        assert feed.drive_status == ""
        feed.stop()
        wait_for(lambda: own.speed.values[::5] == (0.0, 0.0), "and the zero that follows")


@pytest.mark.parametrize("topic", ["/base/cmd_vel", "/drive"])
def test_a_topic_that_the_recording_does_not_have_is_driven_there_all_the_same(topic: str) -> None:
    with feeds.recording(SAMPLE, loop=True) as feed:
        feed.driving = feeds.Driving(topic=topic, hold=3600.0)
        view = feed.show()
        feed.drive(0.25)
        wait_for(lambda: topic in view.widgets, "it has a widget")
        wait_for(lambda: "commanded linear.x 0.25 m/s" in repr(view.widgets[topic]), "it shows what is sent")

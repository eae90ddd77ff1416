"""Recording a feed: a file that other tools read, from every middleware, without delaying other work."""

from __future__ import annotations

import errno
import logging
import re
import signal
import subprocess
import sys
import threading
import time
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

import robowidgets
from robowidgets import Speed, Touch, TouchMode, feeds
from robowidgets.behaviors import Drive
from robowidgets.feeds import Advert, Feed, FeedError
from robowidgets.feeds.middleware import Outlet
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import decoder_of
from robowidgets.messages.encoding import encode
from robowidgets.recordings import live_writer
from robowidgets.repair.write import McapWriter
from robowidgets.samples.state_span import rows_of

from ..clocks import ManualClock
from ..waiting import threads_named, wait_for
from .scripted import CMD_VEL, IMU, ODOM, SCAN, Scripted, scan

KOBUKI = Advert("/bumper", "kobuki_msgs/msg/BumperEvent", wanted=False)
TOUCH = Advert("/touch", "robowidgets/msg/Touch", wanted=False)
KILLED = """
import os, sys, time
from robowidgets import feeds
from robowidgets.behaviors import Drive
class Walker:
    def forward(): return Drive(0.1)
    def turn(): return Drive(0, 0.5)
    moves = "forward -> turn after 0.2", "turn -> forward after 0.2"
robot = feeds.simulator(wander=False, hz=50)
recorder = robot.record(sys.argv[1])
robot.program(Walker, rate=20)
while recorder.written["/scan"] < 20:
    time.sleep(0.01)
size = os.path.getsize(sys.argv[1])
while os.path.getsize(sys.argv[1]) == size:  # until they are in the file
    time.sleep(0.01)
print("ready", flush=True)
time.sleep(60)
"""


class Nested:
    def forward() -> Drive:  # type: ignore[misc]
        return Drive(0.1)

    class avoid:  # noqa: N801
        stop = turn = None
        moves = "stop -> turn after 0.05"

    moves = "forward -> avoid after 0.1", "avoid -> forward after 0.15"


def decoded(path: Path) -> dict[str, list[Any]]:
    """The messages of a file by topic, as rosbags reads them with the definitions in the file alone."""
    with AnyReader([path], default_typestore=get_typestore(Stores.EMPTY)) as reader:
        found: dict[str, list[Any]] = {topic: [] for topic in reader.topics}
        for connection, _, raw in reader.messages():
            found[connection.topic].append(reader.deserialize(raw, connection.msgtype))
    return found


def test_disconnecting_a_topic_leaves_it_to_the_recorder_the_program_and_loops(tmp_path: Path) -> None:
    steps: list[float] = []
    with Feed(script := Scripted(SCAN, CMD_VEL)) as feed:
        laser = robowidgets.LaserWidget()
        feed.connect("/scan", laser, lambda _: None)
        recorder = feed.record(tmp_path / "run.mcap", "/scan")
        feed.program(lambda scan: steps.append(scan.ranges[0]), on="/scan")
        scans = feed.scans("/scan")
        sender = threading.Timer(0.05, lambda: script.listener.on_message("/scan", scan(1.0)))
        sender.start()
        next(scans)
        feed.disconnect("/scan")
        script.listener.on_message("/scan", scan(2.0))
        wait_for(lambda: steps[-1:] == [2.0], "the program steps on it")
        assert next(scans).ranges[0] == 2.0
        wait_for(lambda: recorder.written["/scan"] == 2, "both are recorded")
        assert laser.scan.ranges[0] == 1.0
        assert not feed.connection.functions.functions


def test_a_run_opens_here_and_in_other_tools_with_its_states_and_the_text_of_its_program(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with feeds.simulator(wander=False, hz=50) as robot:
        with robot.record(path) as recorder:
            robot.program(Nested, rate=50)
            wait_for(lambda: recorder.written["/robowidgets/states/Nested"] >= 6, "the machine has moved")
            robot.program(Nested, rate=50)
            wait_for(lambda: recorder.written["/robowidgets/program"] == 2, "the second version is written")
            wait_for(lambda: recorder.written["/scan"] >= 2, "scans have come")
            robot.stopped = True
            wait_for(lambda: not any(robot.robot.speed().values), "it stands")
            poses = recorder.written["/odom"]
            wait_for(lambda: recorder.written["/odom"] >= poses + 2, "the pose where it stands is written")
        count = sum(recorder.written.values())
        assert (recorder.closed, recorder.problems) == (True, ())
        assert not threads_named("robowidgets-recorder")

    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == count
    messages = decoded(path)
    assert {topic: type(some[0]).__name__ for topic, some in messages.items()} == {
        "/scan": "sensor_msgs__msg__LaserScan",
        "/odom": "nav_msgs__msg__Odometry",
        "/cmd_vel": "geometry_msgs__msg__Twist",
        "/bumper": "ros_gz_interfaces__msg__Contacts",
        **{f"/robowidgets/{name}": "std_msgs__msg__String" for name in ("program", "states/Nested")},
        "/robowidgets/states/Nested/avoid": "std_msgs__msg__String",
    }
    assert max(twist.linear.x for twist in messages["/cmd_vel"]) == 0.1

    with robowidgets.open(path) as recording:
        assert recording.problems == ()
        assert {topic.widget for topic in recording.topics} == {"laser", "speed", "touch", None}
        assert len(recording.scans("/scan")) == len(messages["/scan"])
        last = [moment.sample for moment in recording.samples("/odom")][-1]
        assert last.pose == pytest.approx(robot.robot.odometry, abs=0.05)
        states, programs = recording.states, recording.programs
        duration = recording.duration
    assert [(one.name, one.number) for one in programs] == [("Nested", 1), ("Nested", 2)]
    assert "class Nested:" in programs[0].text
    assert programs[0].seconds < programs[1].seconds <= duration
    outer = [span for span in states if span.machine == "Nested"]
    assert [span.name for span in outer[:4]] == ["forward", "avoid", "forward", "avoid"]
    assert all(before.end == after.start for before, after in pairwise(outer))
    seconds = [span.end - span.start for span in outer if span.name == "forward"]
    assert any(one == pytest.approx(0.1, abs=0.08) for one in seconds), seconds  # a pause of the machine blurs one
    inner = next(span for span in states if span.path == "Nested.avoid.stop")
    assert inner.start == outer[1].start
    rows = rows_of(states)
    assert [{span.machine for span in row} for row in rows] == [{"Nested"}, {"Nested.avoid"}]


def test_messages_of_every_middleware_are_written_as_ros_2_messages(tmp_path: Path) -> None:
    script = Scripted(SCAN, ODOM, KOBUKI, TOUCH)
    with Feed(script) as feed:
        recorder = feed.record(tmp_path / "run.mcap")
        say = script.listener.on_message
        header = {"seq": 7, "stamp": {"secs": 3, "nsecs": 4}, "frame_id": "laser"}
        say("/scan", {**scan(1.0, 2.0), "ranges": [1.0, None], "header": header})  # rosbridge, of ROS 1
        vector = SimpleNamespace(x=0.25, y=0.0, z=0.0)
        twist = SimpleNamespace(linear=vector, angular=vector)
        stamp = SimpleNamespace(sec=5, nanosec=6)
        odometry = SimpleNamespace(
            header=SimpleNamespace(stamp=stamp, frame_id="odom"),
            child_frame_id="base",
            pose=SimpleNamespace(pose=None, covariance=np.ones(36)),
            twist=SimpleNamespace(twist=twist, covariance=[2.0] * 36),
        )
        say("/odom", odometry)  # rclpy
        say("/bumper", SimpleNamespace(bumper=1, state=1))
        say("/touch", Touch({"left": True}, TouchMode.EVENT))
        say("/touch", Touch({"right": True}, TouchMode.EVENT))
        say("/touch", Touch({"left": False}, TouchMode.EVENT))
        recorder.close()
        wait_for(lambda: "closed" in repr(recorder), "the file is complete")
        assert recorder.problems == ()
    messages = decoded(tmp_path / "run.mcap")
    (one,) = messages["/scan"]
    assert (one.header.stamp.sec, one.header.stamp.nanosec, one.header.frame_id) == (3, 4, "laser")
    np.testing.assert_array_equal(one.ranges, np.array([1.0, np.nan], np.float32))
    (one,) = messages["/odom"]
    assert (one.twist.twist.linear.x, one.header.stamp.sec, one.pose.covariance[0]) == (0.25, 5, 1.0)
    assert [(one.bumper, one.state) for one in messages["/bumper"]] == [(1, 1)]
    touched = [[contact.collision1.name for contact in one.contacts] for one in messages["/touch"]]
    assert touched == [["left"], ["left", "right"], ["right"]]


def test_named_topics_are_recorded_from_when_they_appear_and_others_are_not(tmp_path: Path) -> None:
    script = Scripted(SCAN)
    with Feed(script) as feed:
        recorder = feed.record(tmp_path / "run.mcap", "/imu", "/odm")
        script.listener.on_topics([SCAN, Advert("/imu", "my_msgs/msg/Odd")])
        script.listener.on_message("/scan", scan())
        script.listener.on_message("/imu", {"x": 1})
        script.listener.on_message("/imu", {"x": 1})
        recorder.close()
        assert recorder.written == {}
        assert recorder.problems == (
            "/imu cannot be recorded: my_msgs/msg/Odd is not a known type; "
            "robowidgets.messages.add_definitions(folder) takes the .msg files of my_msgs",
            "no such topic /odm; there are /scan, /imu",
        )
        assert repr(recorder).startswith(f"{tmp_path / 'run.mcap'}: 0 messages, closed\n⚠ /imu")


def test_sent_speeds_are_recorded_if_no_other_node_publishes_them(tmp_path: Path) -> None:
    with Feed(Scripted(CMD_VEL._replace(name="/base/cmd_vel"))) as feed:
        feed.driving = feeds.Driving(topic="/base/cmd_vel")
        with feed.record(tmp_path / "run.mcap") as recorder:
            feed.drive(0.25, 0.5)
            wait_for(lambda: recorder.written["/base/cmd_vel"] >= 2, "the speed and the zero after it are written")
    speeds = [(one.linear.x, one.angular.z) for one in decoded(tmp_path / "run.mcap")["/base/cmd_vel"]]
    assert (speeds[0], speeds[-1]) == ((0.25, 0.5), (0.0, 0.0))


def test_the_speeds_of_a_program_on_a_recording_are_recorded_next_to_it(tmp_path: Path) -> None:
    with feeds.recording(robowidgets.SAMPLE, speed=20) as feed, feed.record(tmp_path / "run.mcap") as recorder:
        feed.program(lambda: Drive(0.125))
        wait_for(lambda: recorder.written["/cmd_vel_by_program"], "its speed is written")
        wait_for(lambda: recorder.written["/bumper"], "what was recorded is written")
    messages = decoded(tmp_path / "run.mcap")
    assert {one.twist.linear.x for one in messages["/cmd_vel_by_program"]} == {0.125}
    assert {"/scan", "/odom", "/bumper", "/cmd_vel"} <= messages.keys()


def test_a_slow_disk_delays_nothing_and_dropped_messages_are_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(live_writer, "MOST_WAITING", 10)
    goes_on, write = threading.Event(), McapWriter.add
    monkeypatch.setattr(McapWriter, "add", lambda *args: goes_on.wait() and write(*args))
    script, path = Scripted(SCAN), tmp_path / "run.mcap"
    with Feed(script) as feed:
        recorder = feed.record(path)
        for _ in range(50):
            script.listener.on_message("/scan", scan())
        monkeypatch.setattr(live_writer, "CLOSE_TIMEOUT", 0.1)
        recorder.close()
        assert "the disk is slow: the file is not complete yet; wait before you open or copy it" in caplog.text
        assert (recorder.closed, repr(recorder).splitlines()[0]) == (True, f"{path}: 0 messages, still being written")
        goes_on.set()
        wait_for(lambda: not threads_named("robowidgets-recorder"), "the file is complete")
        assert repr(recorder).splitlines()[0] == f"{path}: {recorder.written['/scan']} messages, closed"
    kept = len(decoded(tmp_path / "run.mcap")["/scan"])
    assert 10 <= kept <= 12
    assert recorder.problems == (f"/scan: {50 - kept} messages dropped, because writing did not keep up",)
    assert f"{50 - kept} messages dropped, as writing was too slow; record fewer topics" in caplog.text


def test_a_flood_of_one_topic_pushes_out_no_message_of_another(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_writer, "MOST_WAITING", 10)
    goes_on, write = threading.Event(), McapWriter.add
    monkeypatch.setattr(McapWriter, "add", lambda *args: goes_on.wait() and write(*args))
    script = Scripted(SCAN, IMU)
    with Feed(script) as feed:
        with feed.record(tmp_path / "run.mcap", "/scan", "/imu") as recorder:
            for i in range(100):
                script.listener.on_message("/imu", {"linear_acceleration": {"x": 1.0}})
                if i % 20 == 0:
                    script.listener.on_message("/scan", scan())
            goes_on.set()
            wait_for(lambda: recorder.written["/scan"] == 5, "each scan is written")
        (problem,) = recorder.problems
    assert re.fullmatch(r"/imu: (89|90) messages dropped, because writing did not keep up", problem)


def test_what_the_network_has_lost_is_counted_by_the_pace_of_the_rest(tmp_path: Path) -> None:
    class OverNetwork(Scripted):
        outlet = Outlet("dds", {})

    def stamped(number: int) -> dict[str, Any]:
        stamp = {"sec": 1 + number // 40, "nanosec": number % 40 * 25_000_000}
        return {**scan(), "header": {"stamp": stamp, "frame_id": "laser"}}

    for script, problems in (
        (OverNetwork(SCAN), ("/scan: 3 messages missing, by the pace of the others",)),
        (Scripted(SCAN), ()),
    ):
        with Feed(script) as feed, feed.record(tmp_path / f"{len(problems)}.mcap") as recorder:
            for number in range(100):
                if number not in (50, 51, 70):
                    script.listener.on_message("/scan", stamped(number))
            assert recorder.problems == problems
            script.listener.on_missed("/scan", 2)
            assert ("/scan: 1 message missing, by the pace of the others" in recorder.problems) == bool(problems)


def test_a_recorder_names_the_topics_that_it_leaves_out(tmp_path: Path) -> None:
    camera = Advert("/camera/image_raw", "sensor_msgs/msg/Image")
    script = Scripted(SCAN, camera, Advert("/rosout", "rcl_interfaces/msg/Log"), KOBUKI._replace(offered=False))
    with Feed(script) as feed:
        with feed.record(tmp_path / "run.mcap") as recorder:
            assert recorder.left_out == ("/camera/image_raw",)
            text = "not recorded: /camera/image_raw (everything=True records all topics)"
            assert repr(recorder).splitlines()[-1] == text
        script.listener.on_topics([SCAN, camera, Advert("/later", "sensor_msgs/msg/Image")])
        assert (recorder.left_out, text in repr(recorder)) == (("/camera/image_raw",), True)
        with feed.record(tmp_path / "all.mcap", everything=True) as recorder:
            assert recorder.left_out == ()
        with feed.record(tmp_path / "one.mcap", "/scan") as recorder:
            assert "not recorded" not in repr(recorder), "the user chose"


def test_a_full_disk_ends_the_recording_in_one_line_and_the_robot_is_driven_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    script = Scripted(SCAN, CMD_VEL)
    with Feed(script) as feed:
        recorder = feed.record(tmp_path / "run.mcap")
        script.listener.on_message("/scan", scan())
        wait_for(lambda: recorder.written["/scan"], "a scan is written")

        def fill(*_: object) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(McapWriter, "add", fill)
        caplog.set_level(logging.ERROR, "robowidgets")
        script.listener.on_message("/scan", scan())
        wait_for(lambda: recorder.closed, "the recording has ended")
        wait_for(lambda: not threads_named("robowidgets-recorder"), "its thread has ended")
        assert recorder.problems == ("recording has ended: No space left on device",)
        assert repr(recorder).startswith(f"{tmp_path / 'run.mcap'}: 1 message, incomplete\n⚠ recording has ended: ")
        assert len(caplog.records) == 1
        feed.drive(0.2)
        assert script.speeds[-1] == (0.2, 0.0)
        assert ("unsubscribe", "/scan") in script.asked


def test_a_path_that_cannot_be_written_is_refused_and_nothing_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    script = Scripted(SCAN)
    with Feed(script) as feed:
        first = feed.record(path)
        with pytest.raises(FileExistsError, match=r"run.mcap' exists; delete it, or name another file"):
            feed.record(path)
        assert not first.closed
        with pytest.raises(FileNotFoundError, match="there is no folder"):
            feed.record(tmp_path / "missing" / "run.mcap")
        with pytest.raises(ValueError, match=r"expected a name that ends in .mcap, got 'run.bag'"):
            feed.record("run.bag")
        with pytest.raises(TypeError, match=r"expected the name of a topic as text, got \['/scan'\]"):
            feed.record("run.mcap", ["/scan"])  # type: ignore[arg-type]
    assert first.closed, "closing the feed completes the file"
    with pytest.raises(FeedError, match="is closed"):
        feed.record(tmp_path / "other.mcap")
    assert [file.name for file in tmp_path.iterdir()] == ["run.mcap"]


def test_even_a_single_message_is_in_the_file_after_a_second_and_before_it_is_closed(tmp_path: Path) -> None:
    script, clock = Scripted(SCAN), ManualClock()
    with Feed(script, clock=clock) as feed:
        recorder = feed.record(tmp_path / "run.mcap")
        script.listener.on_message("/scan", scan(1.5, 2.0))
        wait_for(lambda: recorder.written["/scan"], "it is written")
        clock.advance(live_writer.FLUSH - 1 / 1024)
        assert (tmp_path / "run.mcap").stat().st_size < 200
        clock.advance(1 / 1024)
        assert (tmp_path / "run.mcap").stat().st_size > 200
        with robowidgets.open(tmp_path / "run.mcap") as recording:
            assert [moment.sample.ranges[0] for moment in recording.samples("/scan")] == [1.5]


@pytest.mark.slow
def test_the_file_of_a_killed_process_opens_with_all_but_the_last_moments(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    process = subprocess.Popen([sys.executable, "-c", KILLED, path], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
    finally:
        process.send_signal(signal.SIGKILL)
        process.communicate()
    with robowidgets.open(path) as recording:
        assert len(recording.problems) == 1
        assert recording.problems[0].startswith("the recorder was stopped before it closed the file: read all of its")
        assert len(recording.scans("/scan")) >= 10
        assert {span.path for span in recording.states} == {"Walker.forward", "Walker.turn"}
        assert recording.programs[0].name == "Walker"


def test_a_speed_without_a_type_of_its_own_is_stamped(tmp_path: Path) -> None:
    script, began = Scripted(Advert("/speed", "geometry_msgs/msg/TwistStamped")), time.time()
    with Feed(script) as feed, feed.record(tmp_path / "run.mcap") as recorder:
        script.listener.on_message("/speed", Speed((0.5, 0.0, 0.0)))
        wait_for(lambda: recorder.written["/speed"], "it is written")
    (one,) = decoded(tmp_path / "run.mcap")["/speed"]
    assert one.twist.linear.x == 0.5
    assert int(began) <= one.header.stamp.sec <= time.time()


OWN = "my_msgs/msg/Arm"
DEFINITION = f"float64 reach\nPart[] parts\n{'=' * 80}\nMSG: my_msgs/Part\nstring name\n"


def test_everything_is_recorded_also_what_no_widget_shows_by_the_definition_of_the_robot(tmp_path: Path) -> None:
    script = Scripted(IMU, ODOM, Advert("/arm", OWN), Advert("/odd", "my_msgs/msg/Unknown"))
    channel = Channel(0, "/arm", OWN, "cdr", DEFINITION, 0)
    arm = decoder_of(channel)(encode("cdr", OWN, {"reach": 0.5, "parts": [{"name": "hand"}]}, DEFINITION))
    with Feed(script) as feed:
        with feed.record(tmp_path / "run.mcap", everything=True) as recorder:
            script.listener.on_message("/imu", {"linear_acceleration": {"x": 1.5}})
            script.listener.on_message("/arm", arm)
            script.listener.on_message("/odd", {"x": 1})
            wait_for(lambda: recorder.written["/arm"] == 1 and len(recorder.problems) == 1, "all is written")
            assert recorder.problems[0].startswith("/odd cannot be recorded: my_msgs/msg/Unknown is not a known type")
            assert "takes the .msg files of my_msgs" in recorder.problems[0]
        with pytest.raises(TypeError, match="no names of topics with True"):
            feed.record(tmp_path / "other.mcap", "/imu", everything=True)
    with robowidgets.open(tmp_path / "run.mcap") as recording:
        assert recording.fields("/imu")["linear_acceleration.x"].tolist() == [1.5]
        assert recording.fields("/arm")["reach"].tolist() == [0.5]
        assert recording.fields("/arm")["parts[0].name"].tolist() == ["hand"]

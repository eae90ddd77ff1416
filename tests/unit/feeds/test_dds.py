"""ROS 2 topics without ROS: a robot in another process, on loopback."""

from __future__ import annotations

import gc
import json
import os
import resource
import subprocess
import sys
import threading
import weakref
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("cyclonedds", reason="cyclonedds is not installed: pip install cyclonedds")

from robowidgets.feeds import _dds_session
from robowidgets.feeds._dds_types import opaque, ros_topic, ros_type
from robowidgets.feeds._encode import Encoder
from robowidgets.feeds.dds import Dds
from robowidgets.feeds.middleware import Advert, FeedError

from ..waiting import wait_for
from .recorder import Recorder

DOMAIN = 60 + os.getpid() % 100  # several test runs on a machine do not hear each other
SCAN = "sensor_msgs/msg/LaserScan"
TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"


class Robot:
    """The process of `dds_robot`."""

    def __init__(self) -> None:
        command = [sys.executable, str(Path(__file__).with_name("dds_robot.py")), str(DOMAIN)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def do(self, *what: Any) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(what) + "\n")
        self._process.stdin.flush()

    def heard(self) -> Any:
        assert self._process.stdout is not None
        return json.loads(self._process.stdout.readline())

    def kill(self) -> None:
        self._process.kill()
        self._process.communicate()


@pytest.fixture
def robot() -> Iterator[Robot]:
    robot = Robot()
    yield robot
    robot.kill()


@pytest.fixture
def heard() -> Recorder:
    return Recorder()


@pytest.fixture
def dds(heard: Recorder) -> Iterator[Dds]:
    dds = Dds(DOMAIN, interface="lo")
    dds.open(heard)
    yield dds
    dds.close()


def publish_until(robot: Robot, condition: Any, what: str, *message: Any) -> None:
    def done() -> bool:
        if condition():
            return True
        robot.do("write", *message)
        return False

    wait_for(done, what)


def memory() -> int:
    """Bytes that this process holds."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def counts(heard: Recorder) -> set[int]:
    return {len(message.ranges) for _, message in heard.messages}


def test_a_scan_comes_with_its_topic_and_type(dds: Dds, heard: Recorder, robot: Robot) -> None:
    dds.subscribe("/scan")
    publish_until(robot, lambda: heard.messages, "a scan came", "/scan", "LaserScan", [1.0, 2.5], 0.5)
    topic, message = heard.messages[0]
    assert (topic, list(message.ranges), message.header.frame_id) == ("/scan", [1.0, 2.5], "laser")
    assert heard.topics == [Advert("/scan", SCAN, offered=True, wanted=False)]
    assert (heard.connected, heard.lost, heard.troubles) == (1, [], [])


def test_a_publisher_that_was_killed_and_restarted_is_heard_again(dds: Dds, heard: Recorder, robot: Robot) -> None:
    dds.subscribe("/scan")
    publish_until(robot, lambda: heard.messages, "a scan came", "/scan", "LaserScan", [1.0], 0.5)
    robot.kill()
    again = Robot()
    publish_until(again, lambda: 2 in counts(heard), "the other scan came", "/scan", "LaserScan", [1.0, 2.0], 0.5)
    again.kill()


def test_two_publishers_with_different_geometry_are_both_heard(dds: Dds, heard: Recorder, robot: Robot) -> None:
    other = Robot()
    dds.subscribe("/scan")
    publish_until(robot, lambda: 1 in counts(heard), "the one came", "/scan", "LaserScan", [1.0], 0.5)
    publish_until(other, lambda: 3 in counts(heard), "the other came", "/scan", "LaserScan", [1.0, 2.0, 3.0], 0.1)
    publish_until(robot, lambda: len(heard.messages[-1][1].ranges) == 1, "the one again", "/scan", "LaserScan", [1], 1)
    other.kill()


def test_events_that_come_at_once_all_come(dds: Dds, heard: Recorder, robot: Robot) -> None:
    dds.subscribe("/scan")
    dds.subscribe("/bump")
    publish_until(robot, lambda: heard.messages, "a scan came", "/scan", "LaserScan", [1.0], 0.5)
    publish_until(robot, lambda: heard.messages[-1][0] == "/bump", "a bump came", "/bump", "Twist", 0.0)
    held, go_on = threading.Event(), threading.Event()

    def hold() -> None:
        held.set()
        assert go_on.wait(20.0)

    heard.then = hold
    publish_until(robot, held.is_set, "it is busy", "/scan", "LaserScan", [1.0], 0.5)
    heard.messages.clear()
    for x in (1.0, 2.0, 3.0):
        robot.do("write", "/bump", "Twist", x)
    robot.do("hear", "/done", "Twist")
    assert robot.heard() == "ready"
    go_on.set()

    def bumps() -> list[float]:
        # One that was published before may come late.
        return [message.linear.x for topic, message in heard.messages if topic == "/bump" and message.linear.x]

    wait_for(lambda: len(bumps()) == 3, "all three came")
    assert bumps() == [1.0, 2.0, 3.0]


def test_a_topic_that_changes_its_type_is_heard_on(dds: Dds, heard: Recorder, robot: Robot) -> None:
    dds.subscribe("/speed")
    publish_until(robot, lambda: heard.messages, "a Twist came", "/speed", "Twist", 0.5)
    robot.do("stop", "/speed", "Twist")
    publish_until(
        robot, lambda: hasattr(heard.messages[-1][1], "ranges"), "a scan came", "/speed", "LaserScan", [1.0], 0.5
    )


def test_a_latched_message_comes_to_those_who_come_late(dds: Dds, heard: Recorder, robot: Robot) -> None:
    robot.do("latch", "/map_scan", "LaserScan", [4.0], 0.5)
    wait_for(lambda: heard.topics, "the topic is known")
    dds.subscribe("/map_scan")
    wait_for(lambda: heard.messages, "the kept scan came")
    assert list(heard.messages[0][1].ranges) == [4.0]


def test_a_type_that_nobody_defines_is_named(dds: Dds, heard: Recorder, robot: Robot) -> None:
    dds.subscribe("/riddle")
    publish_until(robot, lambda: heard.troubles, "it is said", "/riddle", "Mystery", "?")
    assert heard.words("/riddle") == (
        "/riddle comes as nobody_msgs/msg/Mystery, a type that is not known here; "
        "feeds.ros2 and feeds.foxglove can read it, as the robot defines it for them"
    )


def test_a_type_with_other_fields_under_the_same_name_is_told(dds: Dds, heard: Recorder, robot: Robot) -> None:
    dds.subscribe("/scan")
    publish_until(robot, lambda: heard.troubles, "it is said", "/scan", "OtherScan", "no scan")
    assert heard.words("/scan") == (
        "a publisher of /scan defines the fields of its type in another way, so its messages do not come"
    )
    assert not heard.messages


def test_a_truncated_message_is_told_until_a_whole_one_comes(heard: Recorder) -> None:
    # Cyclone DDS writes no such bytes: they come from others who do not describe their types, as ROS 2 up to Jazzy.
    session = _dds_session.Session(DOMAIN, heard)
    whole = Encoder().encode("cdr", TWIST, {"linear": {"x": 0.5}})
    samples = [[opaque(TWIST)(whole[:-9])], [opaque(TWIST)(whole)]]

    class Reader:
        def take(self, **_: Any) -> list[Any]:
            return samples.pop(0)

    wish = _dds_session.Wish("/speed", TWIST, False, False)
    session._readers[wish] = _dds_session._Reader(Reader(), None, _dds_session.decoder(TWIST))
    session.messages(wish)
    assert heard.words("/speed").startswith(f"a message of /speed cannot be read: 43 bytes that are no {TWIST}: ")
    session.messages(wish)
    assert heard.words("/speed") == ""
    assert heard.messages[0][1].linear.x == 0.5


@pytest.mark.slow
def test_messages_of_100_mb_come_hold_up_no_other_topic_and_leave_no_memory_behind(
    dds: Dds, heard: Recorder, robot: Robot
) -> None:
    other = Robot()
    scan = "/scan", "LaserScan", [1.0], 0.5
    dds.subscribe("/scan")
    publish_until(other, lambda: heard.messages, "a scan came", *scan)
    before = memory()
    for _ in range(3):
        heard.messages.clear()
        robot.do("latch", "/image", "Image", 100_000_000)
        dds.subscribe("/image")
        publish_until(other, lambda: "/image" in [topic for topic, _ in heard.messages], "the image came", *scan)
        publish_until(other, lambda: heard.messages[-1][0] == "/scan", "scans go on", *scan)
        dds.unsubscribe("/image")
    came = [(topic, len(message.data) if topic == "/image" else 0) for topic, message in heard.messages]
    assert came.index(("/image", 100_000_000)) > 10, "scans came while it was under way"
    heard.messages.clear()
    # What was freed in small pieces may stay with the process: as much as one of them, but not three.
    wait_for(lambda: memory() < before + 150e6, "the memory is given back")
    other.kill()


@pytest.mark.parametrize(("kind", "name"), [("Twist", TWIST), ("TwistStamped", STAMPED)])
def test_the_robot_hears_the_speed_that_it_listens_to(
    dds: Dds, heard: Recorder, robot: Robot, kind: str, name: str
) -> None:
    robot.do("hear", "/cmd_vel", kind)
    assert robot.heard() == "ready"
    wait_for(lambda: heard.topics, "the topic is known")
    assert heard.topics == [Advert("/cmd_vel", name, offered=False, wanted=True)]
    twist = {"linear": {"x": 0.25}, "angular": {"z": -0.5}}
    dds.publish("/cmd_vel", name, twist if kind == "Twist" else {"header": {"frame_id": "base"}, "twist": twist})
    got = robot.heard()
    if kind == "TwistStamped":
        assert got["header"]["frame_id"] == "base"
        got = got["twist"]
    assert (got["linear"]["x"], got["angular"]["z"]) == (0.25, -0.5)


def test_what_cannot_be_published_is_refused(dds: Dds) -> None:
    with pytest.raises(FeedError, match="nobody_msgs/msg/Mystery cannot be published"):
        dds.publish("/riddle", "nobody_msgs/msg/Mystery", {})


def test_no_message_comes_after_unsubscribing(dds: Dds, heard: Recorder, robot: Robot) -> None:
    dds.subscribe("/scan")
    dds.subscribe("/other")
    publish_until(robot, lambda: heard.messages, "a scan came", "/scan", "LaserScan", [1.0], 0.5)
    dds.unsubscribe("/scan")
    session = dds._session
    assert session is not None
    wait_for(lambda: not session.wishes, "nobody listens")
    count = len(heard.messages)
    robot.do("write", "/scan", "LaserScan", [1.0], 0.5)
    publish_until(robot, lambda: heard.messages[count:], "the other came", "/other", "LaserScan", [1.0], 0.5)
    assert {topic for topic, _ in heard.messages[count:]} == {"/other"}


def test_it_can_be_closed_twice_and_in_a_callback(dds: Dds, heard: Recorder, robot: Robot) -> None:
    heard.then = dds.close
    dds.subscribe("/scan")
    publish_until(robot, lambda: heard.messages, "a scan came", "/scan", "LaserScan", [1.0], 0.5)
    dds.close()
    dds.close()
    assert "robowidgets-dds" not in {thread.name for thread in threading.enumerate()}
    assert len(heard.messages) == 1


def test_a_hundred_opens_and_closes_leave_no_thread_no_socket_and_no_memory() -> None:
    there: list[weakref.ref[Dds]] = []

    def open_and_close() -> None:
        heard = Recorder()
        dds = Dds(DOMAIN, interface="lo")
        dds.open(heard)
        dds.subscribe("/scan")
        wait_for(lambda: heard.connected, "it takes part")
        dds.close()
        there.append(weakref.ref(dds))

    open_and_close()
    held = memory()
    files, threads = len(os.listdir("/proc/self/fd")), len(os.listdir("/proc/self/task"))
    for _ in range(100):
        open_and_close()
    assert len(os.listdir("/proc/self/fd")) <= files
    # One that was joined has done its work, but the system may not have ended it yet.
    wait_for(lambda: len(os.listdir("/proc/self/task")) <= threads, "every thread has ended")
    gc.collect()
    assert [ref for ref in there if ref() is not None] == []
    assert memory() < held + 10e6


def test_a_network_that_is_not_there_is_tried_again(heard: Recorder) -> None:
    dds = Dds(DOMAIN, interface="nowhere0")
    dds.open(heard)
    wait_for(lambda: len(heard.lost) > 1, "it was tried again")
    dds.close()
    assert heard.connected == 0
    assert heard.lost[0][0].startswith(f"DDS domain {DOMAIN} on nowhere0 cannot be used: ")
    assert heard.lost[1][1] > heard.lost[0][1]


def test_wrong_arguments_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match="domain: expected 0 to 232, as in ROS_DOMAIN_ID, got 233"):
        Dds(233)
    with pytest.raises(TypeError, match="domain: expected a whole number, as in ROS_DOMAIN_ID, got '0'"):
        Dds("0")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="interface: expected the name of a network interface, such as 'eth0', got 1"):
        Dds(interface=1)  # type: ignore[arg-type]


def test_names_of_dds_are_those_of_ros() -> None:
    assert (ros_topic("rt/a/scan"), ros_topic("rq/a/getRequest")) == ("/a/scan", "")
    assert ros_type("sensor_msgs::msg::dds_::LaserScan_") == SCAN
    assert ros_type("std_srvs::srv::dds_::Empty_Request_") == ""

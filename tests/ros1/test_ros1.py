"""ROS 1, against a real master and publishers in their own processes."""

from __future__ import annotations

import contextlib
import importlib
import itertools
import logging
import os
import re
import resource
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from robowidgets import LaserWidget, SpeedWidget, feeds
from robowidgets.feeds import _ros1_master
from robowidgets.feeds.middleware import SEND_TIMEOUT, Advert, FeedError, NotConnectedYetError

from ..conftest import ROOT
from ..unit.feeds.ears import Ears
from ..unit.feeds.scripted import set_connect_timeout
from ..unit.pages import get_newest, synced
from ..unit.waiting import wait_for
from .conftest import PACKAGES, PYTHON, set_send_timeout

STAMPED = "geometry_msgs/msg/TwistStamped"

MODULE = importlib.import_module("robowidgets.feeds.ros1")  # under its name the package has the function in it


@pytest.fixture
def quick(master, monkeypatch) -> None:
    monkeypatch.setattr(MODULE, "POLL", 0.1)
    monkeypatch.setattr(MODULE, "CONNECT_TIMEOUT_S", 0.5)
    monkeypatch.setattr("robowidgets.feeds._ros1_publications.UNREACHED", 1.0)
    set_send_timeout(monkeypatch, 3.0)  # the machine may be busy


@pytest.fixture
def feed(quick) -> Iterator[feeds.Feed]:
    with feeds.ros1() as opened:
        yield opened


class Told(Ears):
    """Keeps all reports about topics without a subscriber."""

    def on_unheard(self, topic: str, reason: str) -> None:
        if self.unheard.get(topic, "") != reason:
            self.said.append(reason)
        super().on_unheard(topic, reason)

    def advert(self, topic: str) -> Advert:
        return next((advert for advert in self.topics or () if advert.name == topic), Advert(topic, ""))


class Opened(NamedTuple):
    ros: Any
    told: Told

    def publish(self, topic: str, x: float) -> None:
        self.ros.publish(topic, STAMPED, {"twist": {"linear": {"x": x}}})

    def publish_once_connected(self, topic: str, x: float) -> None:
        """Publish again while the subscriber has not connected in time."""

        def is_published() -> bool:
            try:
                self.publish(topic, x)
            except NotConnectedYetError:
                return False
            return True

        wait_for(is_published, "it is published")

    def wait_for_listener(self, topic: str) -> None:
        wait_for(lambda: self.told.advert(topic).wanted, "a node listens")


@contextlib.contextmanager
def opened() -> Iterator[Opened]:
    told = Told()
    ros = MODULE.Ros1()
    ros.open(told)
    try:
        yield Opened(ros, told)
    finally:
        ros.close()


@pytest.fixture
def middleware(quick) -> Iterator[Opened]:
    with opened() as one:
        yield one


def memory() -> int:
    """The memory of this process, in bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def rays(laser: LaserWidget) -> int:
    return len(laser.scan) if laser.scan is not None else 0


def test_scans_and_speeds_arrive_and_are_listed(feed, publish):
    laser, speed = LaserWidget(), SpeedWidget()
    feed.connect("/one/scan", laser)
    feed.connect("/one/odom", speed)
    publish("/one/scan", "scan", 7)
    publish("/one/odom", "odom", 25)
    wait_for(lambda: rays(laser) == 7, "a scan comes")
    wait_for(lambda: speed.speed is not None, "a speed comes")
    assert speed.speed.values[0] == 0.25
    wait_for(lambda: synced(laser, "_source")["status"] == "", "nothing is left to say")

    def listed() -> list[Any]:
        return [(topic.type, topic.offered, topic.wanted) for topic in feed.topics if topic.name == "/one/scan"]

    wait_for(lambda: listed() == [("sensor_msgs/msg/LaserScan", True, False)], "it is listed")


def test_messages_of_a_package_that_is_not_installed_are_read_by_the_definition_of_their_publisher(feed, publish):
    laser = LaserWidget()
    feed.connect("/two/scan", laser)
    publish("/two/scan", "sweep", 6)
    wait_for(lambda: rays(laser) == 6, "a sweep comes")
    # A message may come before the state of the master that lists its topic.
    wait_for(lambda: synced(laser, "_source")["type"] == "acme_msgs/msg/Sweep", "the widget names the type")


def test_a_publisher_that_was_killed_and_comes_back_is_heard_again(feed, publish):
    laser = LaserWidget()
    feed.connect("/three/scan", laser)
    publisher = publish("/three/scan", "scan", 5)
    wait_for(lambda: rays(laser) == 5, "a scan comes")
    publisher.kill()
    wait_for(
        lambda: "rosnode cleanup" in synced(laser, "_source")["status"], "the widget says that its publisher has gone"
    )
    assert synced(laser, "_source")["status"].startswith("/three/scan is published, but its node /scan_")
    publish("/three/scan", "scan", 9)
    wait_for(lambda: rays(laser) == 9, "a scan of the next one comes")
    wait_for(lambda: synced(laser, "_source")["status"] == "", "nothing is left to say")


def test_a_publisher_that_cannot_be_reached_by_the_name_it_gave_the_master_is_reported(feed, publish):
    laser = LaserWidget()
    feed.connect("/far/scan", laser)
    publish("/far/scan", "scan", ROS_HOSTNAME="robot.invalid")
    wait_for(lambda: "cannot be reached at robot.invalid:" in synced(laser, "_source")["status"], "the widget says so")
    assert synced(laser, "_source")["status"].endswith("set ROS_IP where it runs")


def test_another_program_at_the_address_of_a_publisher_that_has_gone_is_not_taken_for_it(feed, publish, master):
    laser, topic = LaserWidget(), "/taken/scan"
    with socket.create_server(("127.0.0.1", 0)) as taken:
        address = f"127.0.0.1:{taken.getsockname()[1]}"
        known = _ros1_master.Master(f"http://127.0.0.1:{master.port}")
        known.register_publisher("/gone", topic, "sensor_msgs/LaserScan", f"http://{address}")
        feed.connect(topic, laser)
        words = f"{topic} is published, but its node /gone cannot be reached at {address} (no answer within 1.5 s)"
        wait_for(lambda: synced(laser, "_source")["status"].startswith(words), "the widget says so")
        publish(topic, "scan", 5)
        wait_for(lambda: rays(laser) == 5, "a scan of a publisher comes that is there")
        wait_for(lambda: synced(laser, "_source")["status"] == "", "nothing is left to say")


def test_data_still_come_when_the_master_is_lost_and_the_widget_says_both(feed, publish, master):
    laser, other = LaserWidget(), LaserWidget()
    feed.connect("/four/scan", laser)
    feed.connect("/four/other", other)
    publisher = publish("/four/scan", "scan", 5)
    wait_for(lambda: rays(laser) == 5, "a scan comes")
    master.kill()
    try:
        wait_for(lambda: synced(laser, "_source")["status"] == "master lost; data still come", "the widget says so")
        came = laser.scan
        wait_for(lambda: laser.scan is not came, "a scan comes without a master")
        assert synced(laser, "_source")["status"] == "master lost; data still come"
        assert not feed.status
        wait_for(
            lambda: "master lost, trying again: " in synced(other, "_source")["status"], "the other widget says so"
        )
        assert f"no ROS master at http://127.0.0.1:{master.port}" in synced(other, "_source")["status"]
        publisher.kill()
        wait_for(lambda: f"no ROS master at http://127.0.0.1:{master.port}" in feed.status, "now nothing is left")
        assert "is roscore running, and ROS_MASTER_URI right?" in synced(laser, "_source")["status"]
    finally:
        master.start()
    wait_for(lambda: not feed.status, "the feed is connected again")
    publish("/four/scan", "scan", 8)
    wait_for(lambda: rays(laser) == 8, "a scan of a publisher comes that only the new master knows")
    wait_for(lambda: synced(laser, "_source")["status"] == "", "nothing is left to say")


def test_a_master_that_is_restarted_while_data_come_hears_of_us_again(feed, publish, master):
    laser = LaserWidget()
    feed.connect("/again/scan", laser)
    publish("/again/scan", "scan", 5)
    wait_for(lambda: rays(laser) == 5, "a scan comes")
    master.kill()
    wait_for(lambda: synced(laser, "_source")["status"], "the widget says that the master is lost")
    master.start()
    publish("/again/scan", "scan", 8)
    wait_for(lambda: rays(laser) == 8, "a scan of a publisher comes that only the new master knows")


def test_a_publisher_that_refused_us_once_is_connected_to_when_it_is_there_again(feed, publish):
    laser = LaserWidget()
    feed.connect("/shy/scan", laser)
    publish("/shy/scan", "shy", 5)
    wait_for(lambda: rays(laser) == 5, "a scan comes")


@pytest.mark.parametrize("what", ["cut", "cut_sweep"])
def test_messages_that_cannot_be_read_are_reported_and_the_next_good_one_is_shown(feed, publish, what):
    laser, topic = LaserWidget(), f"/six/{what}"
    feed.connect(topic, laser)
    publisher = publish(topic, what)
    words = f"{topic}: a message of it cannot be read: "
    wait_for(lambda: synced(laser, "_source")["status"].startswith(words), "the widget says that they cannot be read")
    publisher.kill()
    publish(topic, "sweep" if what == "cut_sweep" else "scan", 4)
    wait_for(lambda: rays(laser) == 4, "a good scan comes")
    wait_for(lambda: synced(laser, "_source")["status"] == "", "nothing is left to say")


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("image", "step: expected at least 100000000 bytes for 100000000 pixels of mono8, got 0"),
        ("huge", "ranges: expected at most 1,000,000 rays, got 25,000,000"),
    ],
)
def test_a_message_of_100_mb_is_refused_in_words_and_holds_up_no_other_topic(feed, publish, what, words):
    laser, topic, scans, came = LaserWidget(), f"/big/{what}", [], []
    feed.connect("/big/scan", scans.append)
    publish("/big/scan", "scan")
    wait_for(lambda: scans, "a scan comes")
    before = memory()
    feed.connect(topic, laser)
    feed.connect(topic, lambda _: came.append(len(scans)), raw=True)
    publisher = publish(topic, what)
    wait_for(lambda: len(came) == 3, "three of them come")
    assert words in laser.get_state()["_about"]["error"]
    assert came[2] > came[0] + 20, "scans came meanwhile"
    publisher.kill()
    wait_for(lambda: memory() < before + 150e6, "the memory is given back")


def test_two_publishers_with_different_geometry_are_reported(feed, publish):
    laser = LaserWidget()
    feed.connect("/seven/scan", laser)
    publish("/seven/scan", "scan", 5)
    publish("/seven/scan", "scan", 9)
    wait_for(
        lambda: "two scanners take turns on this topic" in synced(laser, "_source")["status"], "the widget says so"
    )


class Robot(NamedTuple):
    process: subprocess.Popen[str]
    heard: list[float]


@pytest.fixture
def robot(publish) -> Iterator[Callable[[str], Robot]]:
    """`robot(topic)` starts a robot that listens, in its own process."""
    started: list[tuple[Robot, threading.Thread]] = []

    def start(topic: str) -> Robot:
        process, heard = publish(topic, "hear"), []
        thread = threading.Thread(target=lambda: heard.extend(map(float, process.stdout)))
        thread.start()
        started.append((Robot(process, heard), thread))
        return started[-1][0]

    yield start
    for one, thread in started:
        one.process.kill()
        thread.join()


def driven(feed: feeds.Feed, topic: str, hold: float = 60.0) -> None:
    """Make a feed drive by a topic, once it has a subscriber."""
    feed.driving = feeds.Driving(topic, hold=hold)
    wait_for(lambda: any(there.name == topic and there.wanted for there in feed.topics), "it is listened to")


def test_the_first_stop_is_heard(feed, robot):
    heard = robot("/halt/cmd_vel").heard
    driven(feed, "/halt/cmd_vel")
    feed.stop()
    wait_for(lambda: heard, "the robot hears zero")
    assert heard[0] == 0.0


def test_a_robot_that_comes_later_does_not_receive_earlier_speeds(middleware, robot):
    wait_for(lambda: middleware.told.topics is not None, "the topics are known")
    with pytest.raises(
        FeedError, match="cannot publish geometry_msgs/TwistStamped on /late/cmd_vel: it has no subscriber"
    ):
        middleware.publish("/late/cmd_vel", 0.25)
    heard = robot("/late/cmd_vel").heard
    middleware.wait_for_listener("/late/cmd_vel")
    middleware.publish_once_connected("/late/cmd_vel", 0.0)
    wait_for(lambda: heard, "the robot hears something")
    assert heard[0] == 0.0


def test_a_robot_that_was_killed_is_no_longer_published_to(middleware, robot):
    there = robot("/dead/cmd_vel")
    middleware.wait_for_listener("/dead/cmd_vel")
    middleware.publish_once_connected("/dead/cmd_vel", 0.25)
    there.process.kill()
    there.process.wait()
    with pytest.raises(FeedError, match=r"/dead/cmd_vel: /hear_\w+ listens to it, but has not connected"):
        middleware.publish("/dead/cmd_vel", 0.0)
    wait_for(lambda: middleware.told.unheard.get("/dead/cmd_vel"), "the missing subscriber is reported")
    assert "rosnode cleanup makes the master forget it" in middleware.told.unheard["/dead/cmd_vel"]


def test_what_was_published_arrives_though_the_process_ends_at_once_and_its_other_threads_are_busy(robot):
    heard = robot("/exit/cmd_vel").heard
    script = f"""
import os, sys, threading
sys.path.append({PACKAGES!r})
from robowidgets.feeds import _ros1_publications
from tests.ros1.test_ros1 import MODULE, Opened, Told
_ros1_publications.SEND_TIMEOUT = 10.0  # for the connection, as the machine may be busy
one = Opened(MODULE.Ros1(), Told())
one.ros.open(one.told)
one.wait_for_listener("/exit/cmd_vel")
one.publish("/exit/cmd_vel", 0.25)
for _ in range(3):
    threading.Thread(target=lambda: [None for _ in iter(int, 1)], daemon=True).start()
one.publish("/exit/cmd_vel", 0.0)
os._exit(0)
"""
    for runs in range(1, 4):
        subprocess.run([sys.executable, "-c", script], cwd=ROOT, check=True)
        wait_for(lambda runs=runs: heard == runs * [0.25, 0.0], "the robot hears zero")


def test_a_publisher_stays_when_its_feed_is_closed_so_that_no_robot_is_ever_refused(quick, robot, caplog):
    heard = robot("/often/cmd_vel").heard
    for speed in range(1, 21):
        with opened() as one:
            one.wait_for_listener("/often/cmd_vel")
            one.publish("/often/cmd_vel", speed)
            assert one.told.advert("/often/cmd_vel").publishers == ()
        wait_for(lambda speed=speed: heard and heard[-1] == speed, "the robot hears it")
        node = MODULE.Master(os.environ["ROS_MASTER_URI"]).state().publishers["/often/cmd_vel"]
        assert len(node) == 1
    assert "is not a publisher of" not in caplog.text


def test_a_topic_that_is_listed_has_its_type_though_it_appeared_a_moment_ago(feed, monkeypatch):
    """Without the type, a robot would get a publisher of another type, and refuse it."""
    call, uri = _ros1_master.call, os.environ["ROS_MASTER_URI"]

    def called(*given: Any, **caller: str) -> Any:
        answer = call(*given, **caller)
        if not appeared:
            appeared.append(
                call(uri, "registerSubscriber", "/now/cmd_vel", STAMPED.replace("/msg", ""), "http://127.0.0.1:1")
            )
        return answer

    appeared: list[Any] = []
    monkeypatch.setattr(_ros1_master, "call", called)
    try:
        state = _ros1_master.Master(uri).state()
        assert state.subscribers.keys() <= state.types.keys() | {"/rosout"}
    finally:
        call(uri, "unregisterSubscriber", "/now/cmd_vel", "http://127.0.0.1:1")


def test_a_refused_robot_is_reported_and_asked_again_until_it_connects(middleware, robot, monkeypatch):
    import rospy.impl.tcpros_base

    refused = []

    def refuse(sock, address, header):
        if header["topic"] == "/deaf/cmd_vel" and not refused:
            refused.append(header["callerid"])
            return "refused by the test"
        return handle(sock, address, header)

    wait_for(lambda: middleware.told.connected, "the node is there")
    server = rospy.impl.tcpros_base.init_tcpros_server()
    handle = server.topic_connection_handler
    monkeypatch.setattr(server, "topic_connection_handler", refuse)
    set_send_timeout(monkeypatch, SEND_TIMEOUT)
    heard = robot("/deaf/cmd_vel").heard
    middleware.wait_for_listener("/deaf/cmd_vel")
    with pytest.raises(FeedError, match=r"/deaf/cmd_vel: /hear_\w+ listens to it, but has not connected"):
        middleware.publish("/deaf/cmd_vel", 0.25)
    wait_for(lambda: middleware.told.unheard.get("/deaf/cmd_vel"), "it is reported")
    wait_for(lambda: refused, "the robot was refused")
    words = f"{refused[0]} listens to /deaf/cmd_vel, but does not connect; it is asked again"
    wait_for(lambda: middleware.told.said == [words, ""], "it has connected")
    middleware.publish_once_connected("/deaf/cmd_vel", 0.0)
    wait_for(lambda: heard, "the robot hears")
    assert heard == [0.0]


def test_a_robot_that_does_not_read_holds_up_no_other_and_hears_zero_when_it_reads_again(
    middleware, robot, monkeypatch
):
    topic = "/stuck/cmd_vel"
    stuck, other = robot(topic), robot(topic)
    middleware.wait_for_listener(topic)
    middleware.publish_once_connected(topic, 0.1)
    connections = middleware.ros._publications._connections
    wait_for(lambda: len(connections(topic)) == 2, "both are connected")
    for connection in connections(topic):  # as small as the robots' receive buffers
        connection.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    stuck.process.send_signal(signal.SIGSTOP)
    speeds = itertools.count(1)
    wait_for(lambda: middleware.publish(topic, next(speeds)) or middleware.told.unheard.get(topic), "it is reported")
    assert re.fullmatch(rf"/hear_{stuck.process.pid}_\d+ does not read {topic}", middleware.told.unheard[topic])
    last = next(speeds)
    wait_for(lambda: other.heard[-1] == last - 1, "the other robot hears all the same")
    set_send_timeout(monkeypatch, 1000.0)
    middleware.publish(topic, last)  # a speed does not wait for it
    limit = 3.0  # a busy machine may pause for long
    set_send_timeout(monkeypatch, limit)
    wait_for(lambda: other.heard[-1] == last, "the other robot hears it")
    started = time.monotonic()
    with pytest.raises(FeedError, match=rf"/hear_{stuck.process.pid}_\d+ took no message of {topic} for 3 s"):
        middleware.publish(topic, 0.0)
    assert time.monotonic() - started > limit
    wait_for(lambda: other.heard[-1] == 0.0, "the other robot hears zero")
    set_send_timeout(monkeypatch, 240.0)
    stuck.process.send_signal(signal.SIGCONT)
    middleware.publish(topic, 0.0)
    wait_for(lambda: stuck.heard and stuck.heard[-1] == 0.0, "the robot hears zero, after all that waited for it")
    wait_for(lambda: middleware.told.unheard[topic] == "", "nothing is left to say")


@pytest.mark.usefixtures("kernel_sends")
def test_the_first_speed_waits_until_the_robot_has_connected(feed, robot, monkeypatch):
    heard = robot("/first/cmd_vel").heard
    set_send_timeout(monkeypatch, 0.001)
    set_connect_timeout(monkeypatch, 20.0)  # the machine may be busy
    feed.driving = feeds.Driving("/first/cmd_vel")
    wait_for(lambda: any(topic.name == "/first/cmd_vel" and topic.wanted for topic in feed.topics), "it is listened to")
    feed.drive(0.25)
    wait_for(lambda: 0.25 in heard, "the robot hears it")
    wait_for(lambda: heard[-1] == 0.0, "the robot hears zero")


@pytest.mark.usefixtures("kernel_sends")
def test_speeds_and_zero_reach_the_robot_though_the_master_is_gone(feed, middleware, robot, master):
    there = robot("/gone/cmd_vel")
    driven(feed, "/gone/cmd_vel", hold=1.0)
    feed.drive(0.25, 0.0)
    wait_for(lambda: there.heard, "the robot hears a speed")
    asked = feed.connection.middleware._publications
    master.kill()
    try:
        wait_for(lambda: asked.master_lost, "the master is lost")
        feed.drive(0.5, 0.0)
        wait_for(lambda: 0.5 in there.heard, "the robot hears a speed without a master")
        wait_for(lambda: there.heard[-1] == 0.0, "the robot hears zero")
        assert not feed.status
        there.process.kill()
        there.process.wait()
        wait_for(lambda: feed.status, "no subscriber is left")
        with pytest.raises(
            FeedError, match="/gone/cmd_vel: no subscriber is connected, and there is no ROS master at http:"
        ):
            feed.connection.middleware.publish("/gone/cmd_vel", STAMPED, {})
    finally:
        master.start()


def test_a_guard_drives_on_without_a_master_and_is_not_another_publisher(robot, master):
    there = robot("/kept/cmd_vel")
    with feeds.ros1() as feed:
        driven(feed, "/kept/cmd_vel", hold=60.0)
        feed.drive(0.25)
        wait_for(lambda: there.heard, "the robot hears a speed")
        assert "publishes /kept/cmd_vel" not in feed.drive_status
        master.kill()
        try:
            wait_for(lambda: feed.status, "the master is lost")
            feed.drive(0.5)
            wait_for(lambda: 0.5 in there.heard, "the robot hears a speed without a master")
            feed.driver.watchdog.stop()
            wait_for(lambda: there.heard[-1] == 0.0, "the robot hears zero")
        finally:
            master.start()


def test_a_feed_keeps_its_master_and_a_second_one_is_refused(feed, monkeypatch, master):
    first = os.environ["ROS_MASTER_URI"]
    wait_for(lambda: feed.topics is not None and not feed.status, "the master is reached")
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:9")
    second = MODULE.Ros1()
    where = [one.where for one in (feed.connection.middleware, second)]
    assert where == [f"ROS 1, {first}", "ROS 1, http://127.0.0.1:9"]
    masters = [one.outlet.arguments["master"] for one in (feed.connection.middleware, second)]
    assert masters == [first, "http://127.0.0.1:9"]
    with pytest.raises(FeedError, match=f"rospy has the master {first} in this process, and can have no other one: "):
        second.open(Told())
    monkeypatch.setattr(MODULE, "master_of", lambda _: "http://127.0.0.1:9")  # it was asked too early
    late = MODULE.Ros1()
    told = Told()
    late.open(told)
    late.close()
    assert told.connected == 0


@pytest.mark.parametrize("guard", ["on", "off"])
def test_a_process_that_ends_without_closing_stops_the_robot(publish, guard):
    robot = publish("/end/cmd_vel", "hear")
    script = f"""
import sys
sys.path.append({PACKAGES!r})
from robowidgets import feeds
from tests.unit.waiting import wait_for
feed = feeds.ros1()
feed.driving = feeds.Driving("/end/cmd_vel", hold=60.0)
wait_for(lambda: any(topic.name == "/end/cmd_vel" and topic.wanted for topic in feed.topics), "it is listened to")
feed.drive(0.25)
"""
    subprocess.run([sys.executable, "-c", script], cwd=ROOT, env={**os.environ, "ROBOWIDGETS_GUARD": guard}, check=True)
    ends = threading.Timer(5.0, robot.kill)
    ends.start()
    assert "0.0\n" in iter(robot.stdout.readline, "")
    ends.cancel()


@pytest.mark.parametrize("guard", ["on", "off"])
@pytest.mark.parametrize("end", ["os.kill(os.getpid(), signal.SIGINT)", "rospy.signal_shutdown('by the test')"])
def test_a_node_that_is_shut_down_while_it_drives_stops_the_robot_first(robot, end, guard):
    heard = robot("/exit/cmd_vel").heard
    script = f"""
import os, signal, sys
sys.path.append({PACKAGES!r})
import rospy
rospy.init_node("program", anonymous=True)
from robowidgets import feeds
from tests.unit.waiting import wait_for
feed = feeds.ros1()
feed.driving = feeds.Driving("/exit/cmd_vel", hold=60.0)
wait_for(lambda: any(topic.name == "/exit/cmd_vel" and topic.wanted for topic in feed.topics), "it is listened to")
feed.drive(0.25)
sys.stdin.readline()
{end}
"""
    environment = {**os.environ, "ROBOWIDGETS_GUARD": guard}
    node = subprocess.Popen([sys.executable, "-c", script], cwd=ROOT, env=environment, stdin=subprocess.PIPE, text=True)
    wait_for(lambda: heard, "the robot hears a speed")
    assert heard[-1] == 0.25
    node.communicate("go on\n")
    wait_for(lambda: heard[-1] == 0.0, "the robot hears zero")


def test_other_publishers_of_a_topic_are_named(middleware, publish):
    publish("/named/scan", "scan")
    publish("/named/scan", "scan")
    wait_for(lambda: len(middleware.told.advert("/named/scan").publishers) == 2, "both are named")
    publishers = middleware.told.advert("/named/scan").publishers
    assert list(publishers) == sorted(publishers)
    assert all(name.startswith("/scan_") for name in publishers)


def test_a_publisher_of_speeds_that_was_killed_is_named_no_longer_and_holds_up_nothing(feed, robot, publish, master):
    topic = "/killed/cmd_vel"
    robot(topic)
    script = (
        "import rospy, time; from geometry_msgs.msg import TwistStamped; rospy.init_node('other_kernel')\n"
        f"rospy.Publisher({topic!r}, TwistStamped, queue_size=1); print('ready', flush=True); time.sleep(600)"
    )
    other = subprocess.Popen([PYTHON, "-c", script], stdout=subprocess.PIPE, text=True)
    with socket.create_server(("127.0.0.1", 0)) as silent:  # it may exist, but take time to answer
        known = _ros1_master.Master(f"http://127.0.0.1:{master.port}")
        address = f"http://127.0.0.1:{silent.getsockname()[1]}"
        try:
            assert other.stdout.readline() == "ready\n"
            known.register_publisher("/silent", topic, "geometry_msgs/TwistStamped", address)
            driven(feed, topic)
            wait_for(lambda: f"/other_kernel, /silent publishes {topic}, too" in feed.drive_status, "both are named")
            other.kill()
            other.wait()
            assert "/other_kernel" in dict(_ros1_master.call(known.uri, "getSystemState")[0])[topic]
            wait_for(lambda: f"/silent publishes {topic}, too" in feed.drive_status, "one is left")
            wait_for(lambda: "/other_kernel" not in feed.drive_status, "the killed one is not named")
        finally:
            other.kill()
            other.stdout.close()
            _ros1_master.call(known.uri, "unregisterPublisher", topic, address, caller="/silent")


def test_the_wires_name_real_nodes_with_what_they_publish_and_take(feed, publish, robot):
    publish("/wired/scan", "scan")
    robot("/wired/cmd_vel")
    got = []
    feed.connect("/wired/scan", got.append)
    widget = feed.wires().wires

    def wire(name):
        return next((one for one in get_newest(widget).sample.wires if one.name == name), None)

    wait_for(lambda: wire("/wired/scan") and wire("/wired/scan").value, "a scan came")
    wait_for(lambda: wire("/wired/scan").rate, "its rate is known")
    (lidar,) = wire("/wired/scan").publishers
    assert lidar.startswith("/scan_")
    # Our own node receives it, too, and is not a node of the robot.
    assert wire("/wired/scan").subscribers == ()
    wait_for(lambda: wire("/wired/cmd_vel"), "the robot listens")
    (base,) = wire("/wired/cmd_vel").subscribers
    assert lidar in get_newest(widget).sample.nodes
    assert base in get_newest(widget).sample.nodes
    assert lidar in wire("/rosout").publishers
    widget.close()


def test_an_error_of_any_kind_is_reported_and_it_is_tried_again(feed, monkeypatch):
    wait_for(lambda: not feed.status, "it is connected")
    with monkeypatch.context() as patch:
        patch.setattr(feed.connection.middleware, "_adverts_of", lambda state: state["odd"])
        wait_for(
            lambda: "the rospy node of this process cannot be used: tuple indices must be" in feed.status, "reported"
        )
    wait_for(lambda: not feed.status, "it is connected again")


def test_what_rospy_logs_may_be_empty(feed):
    logging.getLogger("rospy.internal").warning("")


def test_only_types_that_are_installed_can_be_published(feed):
    with pytest.raises(FeedError, match="cannot publish acme_msgs/Go: the Python package acme_msgs is not installed; "):
        feed.connection.middleware.publish("/go", "acme_msgs/msg/Go", {})


def test_a_robot_that_comes_later_is_driven_in_the_type_that_it_listens_to(feed, robot):
    wait_for(lambda: feed.connection.is_listed, "the topics are known")
    with pytest.raises(FeedError, match="cannot publish geometry_msgs/Twist on /go/cmd_vel: it has no subscriber"):
        feed.connection.middleware.publish("/go/cmd_vel", "geometry_msgs/msg/Twist", {})
    heard = robot("/go/cmd_vel").heard
    driven(feed, "/go/cmd_vel")
    with pytest.raises(
        FeedError, match="cannot publish geometry_msgs/Twist on /go/cmd_vel: its type is geometry_msgs/Twist"
    ):
        feed.connection.middleware.publish("/go/cmd_vel", "geometry_msgs/msg/Twist", {})
    feed.drive(0.25)
    wait_for(lambda: heard, "the robot hears a TwistStamped")
    assert heard[0] == 0.25


@pytest.mark.usefixtures("kernel_sends")
def test_another_type_on_a_topic_that_is_published_already_is_refused(feed, robot):
    heard = robot("/two/cmd_vel").heard
    driven(feed, "/two/cmd_vel")
    feed.drive(0.25)
    wait_for(lambda: heard, "the robot hears a TwistStamped")
    with pytest.raises(FeedError, match="/two/cmd_vel: it is already published as geometry_msgs/TwistStamped"):
        feed.connection.middleware.publish("/two/cmd_vel", "geometry_msgs/msg/Twist", {})


def test_a_plain_subscriber_feeds_a_widget_from_its_own_thread_next_to_a_feed(feed, publish):
    import rospy
    from sensor_msgs.msg import LaserScan

    plain, fed = LaserWidget(), LaserWidget()
    feed.connect("/eleven/scan", fed)
    publish("/eleven/scan", "scan", 5)
    wait_for(lambda: rays(fed) == 5, "the feed hears it")
    subscriber = rospy.Subscriber("/eleven/scan", LaserScan, plain.update)
    wait_for(lambda: rays(plain) == 5, "the subscriber hears it")
    subscriber.unregister()


def test_a_master_that_does_not_answer_is_reported_and_delays_nothing(master, monkeypatch):
    monkeypatch.setattr("robowidgets.feeds._ros1_master.TIMEOUT", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        monkeypatch.setenv("ROS_MASTER_URI", f"http://127.0.0.1:{silent.getsockname()[1]}")
        monkeypatch.setattr(MODULE, "master_of", lambda _: os.environ["ROS_MASTER_URI"])  # as in a process of its own
        with feeds.ros1() as feed:
            wait_for(lambda: "(no answer within 0.2 s)" in feed.status, "the feed says that it does not answer")
            thread = feed.connection.middleware._thread
        wait_for(lambda: not thread.is_alive(), "closing has ended it")


@pytest.mark.parametrize("uri", ["robot:11311", "http://robot", "http://robot:many"])
def test_a_master_that_cannot_be_is_refused_at_once(master, monkeypatch, uri):
    monkeypatch.setenv("ROS_MASTER_URI", uri)
    with pytest.raises(FeedError, match=f"ROS_MASTER_URI: expected something like http://robot:11311, got '{uri}'"):
        feeds.ros1()


def test_a_name_that_no_node_may_have_is_refused(master):
    with pytest.raises(FeedError, match="name: expected the name of a node, letters, digits and _, got 'my robot'"):
        feeds.ros1("my robot")


def test_without_rospy_a_feed_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "rospy", None)
    with pytest.raises(FeedError, match="rospy cannot be imported here"):
        feeds.ros1()


def test_a_process_whose_rospy_was_shut_down_has_to_restart(master):
    script = f"""
import sys
sys.path.append({PACKAGES!r})
import rospy
from robowidgets import feeds
from tests.unit.waiting import wait_for
feed = feeds.ros1()
wait_for(lambda: not feed.status, "it is connected")
rospy.signal_shutdown("by the test")
wait_for(lambda: "cannot be used: rospy was shut down in this process" in feed.status, "the feed says so")
feed.close()
try:
    feeds.ros1()
except feeds.FeedError as error:
    assert str(error) == "rospy was shut down in this process and cannot start again: restart the kernel"
else:
    raise AssertionError("it opened")
"""
    subprocess.run([sys.executable, "-c", script], cwd=ROOT, check=True)

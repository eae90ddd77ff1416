"""ROS 1: against a real master, and publishers in processes of their own."""

from __future__ import annotations

import gc
import importlib
import logging
import os
import resource
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from robowidgets import LaserWidget, SpeedWidget, feeds
from robowidgets.feeds.middleware import FeedError

from ..conftest import ROOT
from ..unit.waiting import wait_for
from .conftest import PACKAGES

STAMPED = "geometry_msgs/msg/TwistStamped"

MODULE = importlib.import_module("robowidgets.feeds.ros1")  # by its name there is the function in it


@pytest.fixture
def feed(master, monkeypatch) -> Iterator[feeds.Feed]:
    monkeypatch.setattr(MODULE, "POLL", 0.1)
    monkeypatch.setattr(MODULE, "PATIENCE", 0.5)
    with feeds.ros1() as opened:
        yield opened


def memory() -> int:
    """Bytes that this process holds."""
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
    wait_for(lambda: laser._source["words"] == "", "nothing is left to say")
    listed = {topic.name: topic for topic in feed.topics}
    assert listed["/one/scan"].type == "sensor_msgs/msg/LaserScan"
    assert listed["/one/scan"].offered
    assert listed["/one/scan"].wanted is False


def test_messages_of_a_package_that_is_not_installed_are_read_by_the_definition_of_their_publisher(feed, publish):
    laser = LaserWidget()
    feed.connect("/two/scan", laser)
    publish("/two/scan", "sweep", 6)
    wait_for(lambda: rays(laser) == 6, "a sweep comes")
    assert laser._source["type"] == "acme_msgs/msg/Sweep"


def test_a_publisher_that_was_killed_and_comes_back_is_heard_again(feed, publish):
    laser = LaserWidget()
    feed.connect("/three/scan", laser)
    publisher = publish("/three/scan", "scan", 5)
    wait_for(lambda: rays(laser) == 5, "a scan comes")
    publisher.kill()
    wait_for(lambda: "rosnode cleanup" in laser._source["words"], "the widget says that its publisher has gone")
    assert laser._source["words"].startswith("/three/scan is published, but its node /scan_")
    publish("/three/scan", "scan", 9)
    wait_for(lambda: rays(laser) == 9, "a scan of the next one comes")
    wait_for(lambda: laser._source["words"] == "", "nothing is left to say")


def test_a_publisher_that_cannot_be_reached_by_the_name_it_gave_the_master_is_told(feed, publish):
    laser = LaserWidget()
    feed.connect("/far/scan", laser)
    publish("/far/scan", "scan", ROS_HOSTNAME="robot.invalid")
    wait_for(lambda: "cannot be reached at robot.invalid:" in laser._source["words"], "the widget says so")
    assert laser._source["words"].endswith("set ROS_IP where it runs")


def test_a_master_that_was_killed_and_comes_back_hears_of_us_again(feed, publish, master):
    laser = LaserWidget()
    feed.connect("/four/scan", laser)
    publish("/four/scan", "scan", 5)
    wait_for(lambda: rays(laser) == 5, "a scan comes")
    master.kill()
    wait_for(lambda: feed.words, "the feed says that the master has gone")
    assert f"no ROS master at http://127.0.0.1:{master.port}" in feed.words
    assert "is roscore running, and ROS_MASTER_URI right?" in laser._source["words"]
    master.start()
    wait_for(lambda: not feed.words, "the feed is connected again")
    publish("/four/scan", "scan", 8)
    wait_for(lambda: rays(laser) == 8, "a scan of a publisher comes that only the new master knows")


def test_a_topic_that_changes_its_type_is_heard_as_what_it_is_now(feed, publish):
    came = []
    feed.connect("/five/any", came.append)
    publisher = publish("/five/any", "scan", 5)
    wait_for(lambda: came, "a scan comes")
    publisher.kill()
    publish("/five/any", "odom", 30)
    wait_for(lambda: hasattr(came[-1], "twist"), "an odometry comes")


@pytest.mark.parametrize("what", ["cut", "cut_sweep"])
def test_messages_that_cannot_be_read_are_told_and_the_next_good_one_is_shown(feed, publish, what):
    laser, topic = LaserWidget(), f"/six/{what}"
    feed.connect(topic, laser)
    publisher = publish(topic, what)
    wait_for(lambda: "cannot be read" in laser._source["words"], "the widget says that they cannot be read")
    assert laser._source["words"].startswith(f"{topic}: a message of it cannot be read: ")
    publisher.kill()
    publish(topic, "sweep" if what == "cut_sweep" else "scan", 4)
    wait_for(lambda: rays(laser) == 4, "a good scan comes")
    wait_for(lambda: laser._source["words"] == "", "nothing is left to say")


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("image", "expected a message like sensor_msgs/LaserScan"),
        ("huge", "ranges: expected at most 1,000,000 rays, got 25,000,000"),
    ],
)
def test_a_message_of_100_mb_is_refused_in_words_and_holds_up_no_other_topic(feed, publish, what, words):
    laser, topic, scans, came = LaserWidget(), f"/big/{what}", [], []
    feed.connect("/big/scan", scans.append)
    publish("/big/scan", "scan")
    wait_for(lambda: scans, "a scan comes")
    before = memory()
    feed.connect(topic, laser, lambda _: came.append(len(scans)))
    publisher = publish(topic, what)
    wait_for(lambda: len(came) == 3, "three of them come")
    assert words in laser.get_state()["_about"]["error"]
    assert came[2] > came[0] + 20, "scans came meanwhile"
    publisher.kill()
    wait_for(lambda: memory() < before + 150e6, "the memory is given back")


def test_two_publishers_with_different_geometry_are_told(feed, publish):
    laser = LaserWidget()
    feed.connect("/seven/scan", laser)
    publish("/seven/scan", "scan", 5)
    publish("/seven/scan", "scan", 9)
    wait_for(lambda: "two scanners take turns on this topic" in laser._source["words"], "the widget says so")


@pytest.fixture
def robot(publish) -> Iterator[Callable[[feeds.Feed, str], list[float]]]:
    """`robot(feed, topic)` starts one that listens, has the feed drive it, and gives what it hears, as it hears it."""
    listening: list[threading.Thread] = []

    def start(feed: feeds.Feed, topic: str, hold: float = 60.0) -> list[float]:
        process, heard = publish(topic, "hear"), []
        feed.driving = feeds.Driving(topic, hold=hold)
        wait_for(lambda: any(there.name == topic and there.wanted for there in feed.topics), "it is listened to")
        listening.append(threading.Thread(target=lambda: heard.extend(map(float, process.stdout))))
        listening[-1].start()
        started.append(process)
        return heard

    started: list[subprocess.Popen[str]] = []
    yield start
    for process, thread in zip(started, listening, strict=True):
        process.kill()
        thread.join()


def test_the_first_speed_is_heard_and_a_zero_when_the_feed_is_closed(feed, robot):
    heard = robot(feed, "/eight/cmd_vel")
    feed.drive(0.25, 0.0)
    wait_for(lambda: heard, "the robot hears the speed")
    assert heard[0] == 0.25
    feed.close()
    wait_for(lambda: heard[-1] == 0.0, "the robot hears zero")


def test_the_first_stop_is_heard(feed, robot):
    heard = robot(feed, "/halt/cmd_vel")
    feed.stop()
    wait_for(lambda: heard, "the robot hears zero")
    assert heard[0] == 0.0


def test_a_speed_is_never_sent_late(feed, robot):
    feed._middleware.publish("/late/cmd_vel", STAMPED, {"twist": {"linear": {"x": 0.25}}})
    publication = feed._middleware._publications._by_topic["/late/cmd_vel"]
    wait_for(lambda: not publication.may_be_sent_again(), "it is too old")
    heard = robot(feed, "/late/cmd_vel")
    wait_for(lambda: publication.publisher and publication.publisher.get_num_connections(), "the robot is connected")
    assert not publication.heard
    feed._middleware.publish("/late/cmd_vel", STAMPED, {"twist": {"linear": {"x": 0.0}}})
    wait_for(lambda: heard, "the robot hears something")
    assert heard[0] == 0.0


def test_a_zero_that_nobody_heard_is_sent_to_who_comes_much_later(feed, robot, monkeypatch):
    monkeypatch.setattr("robowidgets.feeds._ros1_publications.LATE", -1.0)
    feed._middleware.publish("/later/cmd_vel", STAMPED, {"twist": {"linear": {"x": 0.0}}})
    heard = robot(feed, "/later/cmd_vel")
    wait_for(lambda: heard, "the robot hears zero")
    assert heard[0] == 0.0


def test_zero_reaches_the_robot_though_the_master_is_gone(feed, robot, master):
    heard = robot(feed, "/gone/cmd_vel", hold=2.0)
    feed.drive(0.25, 0.0)
    wait_for(lambda: heard, "the robot hears a speed")
    master.kill()
    try:
        wait_for(lambda: feed.words, "the feed says that the master has gone")
        wait_for(lambda: heard[-1] == 0.0, "the robot hears zero")
    finally:
        master.start()


def test_a_process_that_ends_without_closing_stops_the_robot(publish):
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
wait_for(lambda: feed._middleware._publications._by_topic["/end/cmd_vel"].heard, "the robot hears it")
"""
    subprocess.run([sys.executable, "-c", script], cwd=ROOT, check=True, timeout=60)
    ends = threading.Timer(5.0, robot.kill)
    ends.start()
    assert "0.0\n" in iter(robot.stdout.readline, "")
    ends.cancel()


def test_an_error_of_any_kind_is_told_and_it_is_tried_again(feed, monkeypatch):
    wait_for(lambda: not feed.words, "it is connected")
    with monkeypatch.context() as patch:
        patch.setattr(feed._middleware, "_adverts_of", lambda state: state["odd"])
        wait_for(lambda: "the rospy node of this process cannot be used: tuple indices must be" in feed.words, "told")
    wait_for(lambda: not feed.words, "it is connected again")


def test_what_rospy_logs_may_be_empty(feed):
    logging.getLogger("rospy.internal").warning("")


def test_only_types_that_are_installed_can_be_published(feed):
    with pytest.raises(FeedError, match="cannot publish acme_msgs/Go: the Python package acme_msgs is not installed; "):
        feed._middleware.publish("/go", "acme_msgs/msg/Go", {})


def test_a_robot_that_comes_later_is_driven_in_the_type_that_it_listens_to(feed, robot):
    feed.driving = feeds.Driving("/go/cmd_vel")
    feed.stop()
    heard = robot(feed, "/go/cmd_vel")
    feed.drive(0.25)
    wait_for(lambda: heard, "the robot hears a TwistStamped")
    assert heard[0] == 0.25


def test_another_type_on_a_topic_that_is_published_already_is_refused(feed, robot):
    heard = robot(feed, "/two/cmd_vel")
    feed.drive(0.25)
    wait_for(lambda: heard, "the robot hears a TwistStamped")
    with pytest.raises(FeedError, match="cannot publish geometry_msgs/Twist on /two/cmd_vel: geometry_msgs/TwistStamp"):
        feed._middleware.publish("/two/cmd_vel", "geometry_msgs/msg/Twist", {})


def test_a_feed_may_be_closed_twice_and_in_a_callback(feed, publish):
    closed = threading.Event()

    def close(message):
        feed.close()
        closed.set()

    feed.connect("/nine/scan", close)
    publish("/nine/scan", "scan")
    assert closed.wait(20.0)
    feed.close()


def test_a_hundred_opens_and_closes_leave_nothing_behind(feed, publish):
    publish("/ten/scan", "scan", 5)

    def once():
        laser = LaserWidget()
        with feeds.ros1() as opened:
            opened.connect("/ten/scan", laser)
            wait_for(lambda: rays(laser) == 5, "a scan comes")
        laser.close()

    def in_use():
        gc.collect()  # rospy leaves what it polls its sockets with to the collector
        return threading.active_count(), len(os.listdir("/proc/self/fd"))

    once()
    before = in_use()
    for _ in range(100):
        once()
    # The master's own connections to the node come and go; one left by each opening would be 100.
    wait_for(lambda: all(now < then + 8 for now, then in zip(in_use(), before, strict=True)), "no more are in use")


def test_a_plain_subscriber_feeds_a_widget_from_its_own_thread_beside_a_feed(feed, publish):
    import rospy
    from sensor_msgs.msg import LaserScan

    plain, fed = LaserWidget(), LaserWidget()
    feed.connect("/eleven/scan", fed)
    publish("/eleven/scan", "scan", 5)
    wait_for(lambda: rays(fed) == 5, "the feed hears it")
    subscriber = rospy.Subscriber("/eleven/scan", LaserScan, plain.update)
    wait_for(lambda: rays(plain) == 5, "the subscriber hears it")
    subscriber.unregister()


def test_a_master_that_does_not_answer_is_told_of_and_holds_up_nobody(master, monkeypatch):
    monkeypatch.setattr("robowidgets.feeds._ros1_master.SECONDS", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        monkeypatch.setenv("ROS_MASTER_URI", f"http://127.0.0.1:{silent.getsockname()[1]}")
        with feeds.ros1() as feed:
            wait_for(lambda: "(no answer within 0.2 s)" in feed.words, "the feed says that it does not answer")


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


def test_a_process_whose_rospy_was_shut_down_is_told_to_restart(master):
    script = f"""
import sys
sys.path.append({PACKAGES!r})
import rospy
from robowidgets import feeds
from tests.unit.waiting import wait_for
feed = feeds.ros1()
wait_for(lambda: not feed.words, "it is connected")
rospy.signal_shutdown("by the test")
wait_for(lambda: "cannot be used: rospy was shut down in this process" in feed.words, "the feed says so")
feed.close()
try:
    feeds.ros1()
except feeds.FeedError as error:
    assert str(error) == "rospy was shut down in this process and cannot start again: restart the kernel"
else:
    raise AssertionError("it opened")
"""
    subprocess.run([sys.executable, "-c", script], cwd=ROOT, check=True, timeout=60)

"""The feed of rclpy on the real rclpy, if that is installed."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from array import array
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here: run where /opt/ros/<distro>/setup.bash was sourced")

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import LaserScan

from robowidgets.feeds.middleware import Advert, FeedError
from robowidgets.feeds.ros2 import Ros2

from ...reserved import free_domain
from ..waiting import wait_for
from .ears import Ears

DOMAIN = free_domain()
SCAN = "sensor_msgs/msg/LaserScan"


@pytest.fixture
def robot() -> Iterator[Any]:
    """A node in its own context, spun in a thread."""
    context = Context()
    rclpy.init(args=[], context=context, domain_id=DOMAIN, signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("robot", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    done = threading.Event()

    def spin() -> None:
        while not done.is_set():
            executor.spin_once(timeout_sec=0.05)

    thread = threading.Thread(target=spin)
    thread.start()
    yield node
    done.set()
    thread.join()
    executor.shutdown()
    node.destroy_node()
    context.try_shutdown()


@pytest.fixture
def heard() -> Ears:
    return Ears()


@pytest.fixture
def ros2(heard: Ears) -> Iterator[Ros2]:
    ros2 = Ros2(domain_id=DOMAIN)
    ros2.open(heard)
    yield ros2
    ros2.close()


def publish_until(publisher: Any, message: Any, condition: Any, what: str) -> None:
    def done() -> bool:
        publisher.publish(message)
        return bool(condition())

    wait_for(done, what)


def scan() -> Any:
    return LaserScan(angle_increment=0.5, range_max=10.0, ranges=array("f", [1.0, 2.0]))


@pytest.mark.parametrize("qos", [qos_profile_sensor_data, QoSProfile(depth=5)], ids=["best-effort", "reliable"])
def test_a_scan_comes(ros2: Ros2, heard: Ears, robot: Any, qos: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", qos)
    ros2.follow(frozenset({"/scan"}))
    publish_until(publisher, scan(), lambda: heard.messages, "a scan came")
    assert isinstance(heard.messages[0][1].ranges, array)
    assert Advert("/scan", SCAN, True, False, ("/robot",), ()) in heard.topics
    assert heard.said == []


def test_a_latched_scan_reaches_late_subscribers(ros2: Ros2, heard: Ears, robot: Any) -> None:
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    robot.create_publisher(LaserScan, "/kept", qos).publish(scan())
    ros2.follow(frozenset({"/kept"}))
    wait_for(lambda: heard.messages, "the kept scan came")


@pytest.mark.parametrize("kind", [Twist, TwistStamped])
def test_the_robot_hears_a_speed(ros2: Ros2, heard: Ears, robot: Any, kind: Any) -> None:
    got: list[Any] = []
    robot.create_subscription(kind, "/cmd_vel", got.append, 1)
    name = f"geometry_msgs/msg/{kind.__name__}"
    wait_for(
        lambda: Advert("/cmd_vel", name, False, True, (), ("/robot",)) in (heard.topics or ()), "the topic is known"
    )
    twist = {"linear": {"x": 0.25}}
    message = twist if kind is Twist else {"header": {"frame_id": "base"}, "twist": twist}

    def done() -> bool:
        ros2.publish("/cmd_vel", name, message)
        return bool(got)

    wait_for(done, "the robot heard it")
    assert (got[0] if kind is Twist else got[0].twist).linear.x == 0.25


def test_every_speed_arrives_once_and_before_the_next(ros2: Ros2, heard: Ears, robot: Any) -> None:
    log: list[float] = []
    robot.create_subscription(Twist, "/cmd_vel", lambda message: log.append(message.linear.x), 10)
    wait_for(lambda: heard.topics, "the topic is known")
    for number in range(1, 21):
        ros2.publish("/cmd_vel", "geometry_msgs/msg/Twist", {"linear": {"x": float(number)}})
        wait_for(lambda: len(log) == number, "the robot received it")  # noqa: B023
    assert log == [float(number) for number in range(1, 21)]


def test_a_listener_that_refuses_our_quality_of_service_is_reported(ros2: Ros2, heard: Ears, robot: Any) -> None:
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    picky = robot.create_subscription(Twist, "/cmd_vel", print, qos)
    wait_for(lambda: heard.topics, "the topic is known")
    ros2.publish("/cmd_vel", "geometry_msgs/msg/Twist", {})
    wait_for(lambda: "expects earlier messages" in heard.words("/cmd_vel"), "it is reported")
    robot.destroy_subscription(picky)
    wait_for(lambda: heard.words("/cmd_vel") == "", "it is over")


def test_another_publisher_is_named(ros2: Ros2, heard: Ears, robot: Any) -> None:
    robot.create_publisher(Twist, "/cmd_vel", 1)
    expected = Advert("/cmd_vel", "geometry_msgs/msg/Twist", True, False, ("/robot",), ())
    wait_for(lambda: expected in (heard.topics or ()), "it is named")


DRIVER = """
import sys, time, rclpy
from robowidgets import feeds

rclpy.init(domain_id=int(sys.argv[1]))
node = rclpy.create_node("program")
feed = feeds.ros2(node)
end = {"shutdown": rclpy.shutdown, "destroy": node.destroy_node, "interrupt": lambda: time.sleep(60.0)}[sys.argv[2]]
for _ in range(30):
    feed.drive(0.25)
    time.sleep(0.1)
end()
"""


@pytest.mark.parametrize("end", ["interrupt", "shutdown", "destroy"])
def test_a_program_that_ends_while_it_drives_stops_the_robot(robot: Any, end: str) -> None:
    speeds: list[float] = []
    robot.create_subscription(Twist, "/cmd_vel", lambda message: speeds.append(message.linear.x), 10)
    program = subprocess.Popen([sys.executable, "-c", DRIVER, str(DOMAIN), end])
    wait_for(lambda: 0.25 in speeds, "the robot drives")
    if end == "interrupt":
        program.send_signal(signal.SIGINT)
    program.wait(120)
    wait_for(lambda: speeds[-1] == 0.0, "the robot stops")


def test_of_a_node_only_the_domain_is_used(heard: Ears, robot: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", 1)
    ros2 = Ros2(robot)
    ros2.open(heard)
    ros2.follow(frozenset({"/scan"}))
    publish_until(publisher, scan(), lambda: heard.messages, "a scan came")
    ros2.close()
    assert ros2.where == f"ROS 2, domain {DOMAIN}"
    assert robot.get_name() == "robot"
    assert [s.topic_name for s in robot.subscriptions if s.topic_name == "/scan"] == []


def test_subscriptions_come_and_go_often(heard: Ears, robot: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", 10)
    ros2 = Ros2(robot)
    ros2.open(heard)
    for _ in range(20):
        heard.messages.clear()
        ros2.follow(frozenset({"/scan"}))
        publish_until(publisher, scan(), lambda: heard.messages, "a scan came")
        ros2.follow(frozenset())
    ros2.close()
    assert heard.lost == []


def test_a_name_that_ros_refuses_stops_nothing(ros2: Ros2, heard: Ears, robot: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", 1)
    ros2.follow(frozenset({"/my scan", "/scan"}))
    publish_until(publisher, scan(), lambda: heard.messages, "a scan came")
    with pytest.raises(FeedError, match="cannot publish on '/cmd vel'"):
        ros2.publish("/cmd vel", "geometry_msgs/msg/Twist", {})


def test_it_can_be_closed_in_a_callback_and_opened_again(heard: Ears, robot: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", 1)
    for _ in range(3):
        again = Ears()
        ros2 = Ros2(domain_id=DOMAIN)
        again.then = lambda *_, ros2=ros2: ros2.close()
        ros2.open(again)
        ros2.follow(frozenset({"/scan"}))
        publish_until(publisher, scan(), lambda again=again: again.messages, "a scan came")
        ros2.close()
        ros2.close()
        wait_for(lambda: "robowidgets-ros2" not in {t.name for t in threading.enumerate()}, "its thread ended")

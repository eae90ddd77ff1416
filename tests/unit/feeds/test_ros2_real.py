"""The feed of rclpy on the real one, wherever that is installed."""

from __future__ import annotations

import os
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

from ..waiting import wait_for
from .recorder import Recorder

DOMAIN = 1 + os.getpid() % 100
SCAN = "sensor_msgs/msg/LaserScan"


@pytest.fixture
def robot() -> Iterator[Any]:
    """A node in a context of its own, spun in a thread."""
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
def mine() -> Iterator[Any]:
    """A node in a context of its own that nobody spins."""
    context = Context()
    rclpy.init(args=[], context=context, domain_id=DOMAIN, signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("mine", context=context)
    yield node
    node.destroy_node()
    context.try_shutdown()


@pytest.fixture
def heard() -> Recorder:
    return Recorder()


@pytest.fixture
def ros2(heard: Recorder) -> Iterator[Ros2]:
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
def test_a_scan_comes(ros2: Ros2, heard: Recorder, robot: Any, qos: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", qos)
    ros2.subscribe("/scan")
    publish_until(publisher, scan(), lambda: heard.messages, "a scan came")
    assert isinstance(heard.messages[0][1].ranges, array)
    assert Advert("/scan", SCAN, True, False) in heard.topics
    assert heard.troubles == []


def test_a_latched_scan_comes_to_those_who_come_late(ros2: Ros2, heard: Recorder, robot: Any) -> None:
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    robot.create_publisher(LaserScan, "/kept", qos).publish(scan())
    ros2.subscribe("/kept")
    wait_for(lambda: heard.messages, "the kept scan came")


@pytest.mark.parametrize("kind", [Twist, TwistStamped])
def test_the_robot_hears_a_speed(ros2: Ros2, heard: Recorder, robot: Any, kind: Any) -> None:
    got: list[Any] = []
    robot.create_subscription(kind, "/cmd_vel", got.append, 1)
    name = f"geometry_msgs/msg/{kind.__name__}"
    wait_for(lambda: Advert("/cmd_vel", name, False, True) in heard.topics, "the topic is known")
    twist = {"linear": {"x": 0.25}}
    message = twist if kind is Twist else {"header": {"frame_id": "base"}, "twist": twist}

    def done() -> bool:
        ros2.publish("/cmd_vel", name, message)
        return bool(got)

    wait_for(done, "the robot heard it")
    assert (got[0] if kind is Twist else got[0].twist).linear.x == 0.25


def test_the_program_s_own_node_is_used_and_left_whole(heard: Recorder, robot: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", 1)
    ros2 = Ros2(robot)
    ros2.open(heard)
    ros2.subscribe("/scan")
    publish_until(publisher, scan(), lambda: heard.messages, "a scan came")
    ros2.close()
    assert robot.get_name() == "robot"
    assert [s.topic_name for s in robot.subscriptions if s.topic_name == "/scan"] == []


def test_a_node_that_nobody_spins_is_spun_until_the_program_does(heard: Recorder, robot: Any, mine: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", 1)
    own: list[Any] = []
    mine.create_subscription(LaserScan, "/scan", own.append, 1)
    threads: list[str] = []
    heard.then = lambda: threads.append(threading.current_thread().name)
    ros2 = Ros2(mine)
    ros2.open(heard)
    ros2.subscribe("/scan")
    publish_until(publisher, scan(), lambda: own and "robowidgets-ros2" in threads, "both heard a scan")
    executor = SingleThreadedExecutor(context=mine.context)
    executor.add_node(mine)

    def spun_here() -> bool:
        executor.spin_once(timeout_sec=0.05)
        return "MainThread" in threads

    publish_until(publisher, scan(), spun_here, "a scan came where the program spins")
    executor.remove_node(mine)
    threads.clear()
    publish_until(publisher, scan(), lambda: "robowidgets-ros2" in threads, "it is spun again")
    ros2.close()
    executor.shutdown()
    assert (heard.connected, heard.lost) == (1, [])


def test_subscriptions_come_and_go_while_the_program_spins(heard: Recorder, robot: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", 10)
    ros2 = Ros2(robot)
    ros2.open(heard)
    for _ in range(20):
        heard.messages.clear()
        ros2.subscribe("/scan")
        publish_until(publisher, scan(), lambda: heard.messages, "a scan came")
        ros2.unsubscribe("/scan")
    ros2.close()
    assert heard.lost == []


def test_a_name_that_ros_refuses_stops_nothing(ros2: Ros2, heard: Recorder, robot: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", 1)
    ros2.subscribe("/my scan")
    ros2.subscribe("/scan")
    publish_until(publisher, scan(), lambda: heard.messages, "a scan came")
    with pytest.raises(FeedError, match="cannot publish on '/cmd vel'"):
        ros2.publish("/cmd vel", "geometry_msgs/msg/Twist", {})


def test_it_can_be_closed_in_a_callback_and_opened_again(heard: Recorder, robot: Any) -> None:
    publisher = robot.create_publisher(LaserScan, "/scan", 1)
    for _ in range(3):
        again = Recorder()
        ros2 = Ros2(domain_id=DOMAIN)
        again.then = ros2.close
        ros2.open(again)
        ros2.subscribe("/scan")
        publish_until(publisher, scan(), lambda again=again: again.messages, "a scan came")
        ros2.close()
        ros2.close()
        wait_for(lambda: "robowidgets-ros2" not in {t.name for t in threading.enumerate()}, "its thread ended")

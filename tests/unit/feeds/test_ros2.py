"""The feed of rclpy on a stand-in; `test_ros2_real` holds the same against the real one."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from robowidgets.feeds.middleware import Advert, FeedError
from robowidgets.feeds.ros2 import Ros2

from ..waiting import wait_for
from .fake_rclpy import (
    DurabilityPolicy,
    Graph,
    QoSProfile,
    ReliabilityPolicy,
    SingleThreadedExecutor,
    get_message,
    install,
)
from .recorder import Recorder

SCAN = "sensor_msgs/msg/LaserScan"
TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Graph:
    return install(monkeypatch)


@pytest.fixture
def heard() -> Recorder:
    return Recorder()


@pytest.fixture
def ros2(graph: Graph, heard: Recorder) -> Iterator[Ros2]:
    ros2 = Ros2(domain_id=7)
    ros2.open(heard)
    yield ros2
    ros2.close()


def offer(graph: Graph, topic: str, kind: str, qos: Any = None) -> Any:
    return graph.node().create_publisher(get_message(kind), topic, qos or QoSProfile(1))


def listener(graph: Graph, topic: str, kind: str, callback: Any = None) -> Any:
    """Somebody who subscribes, and spins."""
    node = graph.node()
    SingleThreadedExecutor(context=node.context).add_node(node)
    events = SimpleNamespace(incompatible_qos=None)
    make = node.create_subscription
    return make(get_message(kind), topic, callback, QoSProfile(1), callback_group=None, event_callbacks=events)


def subscriptions(graph: Graph) -> list[Any]:
    return [s for node in list(graph.nodes) for s in list(node.subscriptions)]


def subscribed(ros2: Ros2, graph: Graph, topic: str) -> Any:
    ros2.subscribe(topic)
    wait_for(lambda: subscriptions(graph), "it subscribed")
    return subscriptions(graph)[0]


def test_topics_tell_what_others_publish_and_listen_to(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    offer(graph, "/scan", SCAN)
    listener(graph, "/cmd_vel", STAMPED)
    subscribed(ros2, graph, "/scan")
    expected = [Advert("/cmd_vel", STAMPED, False, True), Advert("/scan", SCAN, True, False)]
    wait_for(lambda: heard.topics == expected, "the topics are told")
    assert graph.contexts[0].domain_id == 7
    assert ros2.where == "ROS 2, domain 7"


def test_a_message_comes(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    publisher = offer(graph, "/scan", SCAN)
    subscribed(ros2, graph, "/scan")
    message = get_message(SCAN)()
    publisher.publish(message)
    wait_for(lambda: heard.messages, "it came")
    assert heard.messages == [("/scan", message)]


def test_a_reader_is_best_effort_whatever_the_publisher_is(ros2: Ros2, graph: Graph) -> None:
    offer(graph, "/scan", SCAN)
    qos = subscribed(ros2, graph, "/scan").qos_profile
    assert (qos.reliability, qos.durability, qos.depth) == (
        ReliabilityPolicy.BEST_EFFORT,
        DurabilityPolicy.VOLATILE,
        1,
    )


def test_a_latched_topic_is_asked_for_what_it_keeps(ros2: Ros2, graph: Graph) -> None:
    offer(graph, "/scan", SCAN, QoSProfile(1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    qos = subscribed(ros2, graph, "/scan").qos_profile
    assert (qos.reliability, qos.durability) == (ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL)


def test_a_refusal_is_told_and_gone_with_the_next_message(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    publisher = offer(graph, "/scan", SCAN)
    subscription = subscribed(ros2, graph, "/scan")
    subscription.events.incompatible_qos(SimpleNamespace(last_policy_kind="RELIABILITY"))
    assert heard.words("/scan") == "a publisher of /scan is best-effort, so its messages do not come"
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: heard.messages, "it came")
    assert heard.words("/scan") == ""


def test_it_subscribes_where_refusals_cannot_be_told(ros2: Ros2, graph: Graph) -> None:
    graph.tells_refusals = False
    offer(graph, "/scan", SCAN)
    assert subscribed(ros2, graph, "/scan").events.incompatible_qos is None


def test_a_topic_that_changes_its_type_is_heard_on(ros2: Ros2, graph: Graph) -> None:
    publisher = offer(graph, "/speed", TWIST)
    subscribed(ros2, graph, "/speed")
    publisher.node.destroy_publisher(publisher)
    offer(graph, "/speed", STAMPED)
    wait_for(lambda: [s.topic_type for s in subscriptions(graph)] == [STAMPED], "the other type is subscribed")


def test_a_package_that_is_not_installed_is_named(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    known = get_message(SCAN)
    known.name = "x_msgs/msg/Bump"
    graph.node().create_publisher(known, "/bump", QoSProfile(1))
    ros2.subscribe("/bump")
    wait_for(lambda: heard.troubles, "it is said")
    assert heard.words("/bump") == (
        "/bump comes as x_msgs/msg/Bump: the package x_msgs is not installed here, or lacks it; install "
        "ros-<distro>-x-msgs, or source the workspace that has it, and restart the kernel"
    )


@pytest.mark.parametrize("kind", [TWIST, STAMPED])
def test_a_speed_is_published_as_the_robot_wants_it(ros2: Ros2, graph: Graph, heard: Recorder, kind: str) -> None:
    got: list[Any] = []
    subscription = listener(graph, "/cmd_vel", kind, got.append)
    wait_for(lambda: heard.topics, "the topic is known")
    twist = {"linear": {"x": 0.25}}
    ros2.publish("/cmd_vel", kind, twist if kind == TWIST else {"header": {"frame_id": "base"}, "twist": twist})
    robot = subscription.node.executor
    wait_for(lambda: robot.due, "it was published")
    robot.spin_once(0)
    assert (got[0] if kind == TWIST else got[0].twist).linear.x == 0.25


def test_what_cannot_be_published_is_refused(ros2: Ros2) -> None:
    with pytest.raises(FeedError, match="x_msgs/msg/Bump cannot be published: the package x_msgs is not installed"):
        ros2.publish("/bump", "x_msgs/msg/Bump", {})
    with pytest.raises(FeedError, match="has no field 'speed'"):
        ros2.publish("/cmd_vel", TWIST, {"speed": 1.0})


def test_what_is_ours_is_shut_down_in_order_and_leaves_no_thread(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    wait_for(lambda: heard.connected, "it is connected")
    ros2.close()
    ros2.close()
    assert graph.contexts[0].log == ["executor", "node", "shutdown"]
    assert not graph.nodes
    assert "robowidgets-ros2" not in {thread.name for thread in threading.enumerate()}


def test_it_can_be_closed_in_a_callback(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    heard.then = ros2.close
    publisher = offer(graph, "/scan", SCAN)
    subscribed(ros2, graph, "/scan")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: graph.contexts[0].log == ["executor", "node", "shutdown"], "it ended")


def test_a_node_of_the_program_that_nobody_spins_is_spun_and_left_whole(graph: Graph, heard: Recorder) -> None:
    node = graph.node()
    publisher = offer(graph, "/scan", SCAN)
    ros2 = Ros2(node)
    ros2.open(heard)
    ros2.subscribe("/scan")
    wait_for(lambda: node.subscriptions, "it subscribed")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: heard.messages, "it came")
    ros2.close()
    assert node in graph.nodes
    assert (node.subscriptions, node.publishers, node.context.log) == ([], [], ["executor"])
    assert node not in node.executor.get_nodes()


def test_a_node_that_the_program_spins_calls_back_from_there(graph: Graph, heard: Recorder) -> None:
    node = graph.node()
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    publisher = offer(graph, "/scan", SCAN)
    threads: list[str] = []
    heard.then = lambda: threads.append(threading.current_thread().name)
    ros2 = Ros2(node)
    ros2.open(heard)
    ros2.subscribe("/scan")
    wait_for(lambda: node.subscriptions, "it subscribed")
    publisher.publish(get_message(SCAN)())
    executor.spin_once(5.0)
    assert threads == [threading.current_thread().name]
    ros2.close()
    assert executor.get_nodes() == [node]


def test_a_node_that_breaks_is_told_and_tried_again(
    graph: Graph, heard: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    node = graph.node()

    def gone() -> None:
        raise RuntimeError("the node was destroyed")

    monkeypatch.setattr(node, "get_topic_names_and_types", gone)
    ros2 = Ros2(node)
    ros2.open(heard)
    wait_for(lambda: heard.lost, "it is told")
    assert heard.lost[0][0] == "ROS 2, node robot cannot be used: the node was destroyed"
    monkeypatch.undo()
    ros2.close()


def test_wrong_arguments_are_refused_by_name(graph: Graph) -> None:
    with pytest.raises(TypeError, match="node: expected a node of rclpy, got 'robot'"):
        Ros2("robot")
    with pytest.raises(TypeError, match="domain_id: expected a whole number, as in ROS_DOMAIN_ID, got '1'"):
        Ros2(domain_id="1")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="domain_id: expected 0 to 232, as in ROS_DOMAIN_ID, got -1"):
        Ros2(domain_id=-1)
    with pytest.raises(TypeError, match="give a node or a domain_id, not both"):
        Ros2(graph.node(), domain_id=1)


def test_without_rclpy_it_says_what_to_do(monkeypatch: pytest.MonkeyPatch, heard: Recorder) -> None:
    monkeypatch.setitem(__import__("sys").modules, "rclpy", None)
    with pytest.raises(FeedError, match=r"rclpy cannot be imported here .* feeds\.dds\(\) needs no ROS"):
        Ros2().open(heard)

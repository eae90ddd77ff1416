"""The feed of rclpy on a stand-in; `test_ros2_real` holds the same against the real one."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robowidgets.feeds import _ros2_spin
from robowidgets.feeds.middleware import Advert, FeedError
from robowidgets.feeds.ros2 import Ros2

from ..waiting import wait_for
from .fake_rclpy import (
    DurabilityPolicy,
    Graph,
    Group,
    HistoryPolicy,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
    SingleThreadedExecutor,
    SubscriptionEventCallbacks,
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
    return graph.node().create_publisher(get_message(kind), topic, qos or QoSProfile(depth=1))


def listener(graph: Graph, topic: str, kind: str, callback: Any = None) -> Any:
    """Somebody who subscribes, and spins."""
    node = graph.node()
    node.spun_by = SingleThreadedExecutor(context=node.context)  # a node does not keep its executor
    node.spun_by.add_node(node)
    make = node.create_subscription
    return make(
        get_message(kind),
        topic,
        callback or (lambda _message: None),  # rclpy asks for a signature, which print has from Python 3.11 on
        1,
        callback_group=Group(),
        event_callbacks=SubscriptionEventCallbacks(),
    )


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
        5,
    )


def test_a_latched_topic_is_asked_for_what_it_keeps(ros2: Ros2, graph: Graph) -> None:
    offer(graph, "/scan", SCAN, QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    qos = subscribed(ros2, graph, "/scan").qos_profile
    assert (qos.reliability, qos.durability) == (ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL)


def test_a_refusal_is_told_and_gone_with_the_next_message(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    publisher = offer(graph, "/scan", SCAN)
    subscription = subscribed(ros2, graph, "/scan")
    refusal = SimpleNamespace(last_policy_kind=QoSPolicyKind.RELIABILITY)
    graph.call(subscription, refusal, subscription.events.incompatible_qos)
    wait_for(lambda: heard.troubles, "it is told")
    assert heard.words("/scan") == "a publisher of /scan is best-effort, so its messages do not come"
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: heard.messages, "it came")
    assert heard.words("/scan") == ""


def test_a_truncated_message_is_told_until_a_whole_one_comes_and_holds_up_no_other(
    ros2: Ros2, graph: Graph, heard: Recorder
) -> None:
    publisher, other = offer(graph, "/scan", SCAN), offer(graph, "/other", SCAN)
    ros2.subscribe("/other")
    ros2.subscribe("/scan")
    wait_for(lambda: len(subscriptions(graph)) == 2, "it subscribed to both")
    first = next(s for s in subscriptions(graph) if s.topic_name == "/scan")
    graph.call(first, b"half a scan", first.callback)
    wait_for(lambda: heard.troubles, "it is told")
    assert heard.words("/scan") == (
        "a message of /scan cannot be read: failed to take message from subscription: error not set"
    )
    other.publish(get_message(SCAN)())
    wait_for(lambda: [topic for topic, _ in heard.messages] == ["/other"], "the other goes on")
    wait_for(lambda: len(subscriptions(graph)) == 2, "it subscribed again")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: heard.words("/scan") == "", "a whole one came")
    assert (heard.connected, heard.lost) == (1, [])


def test_it_subscribes_where_refusals_cannot_be_told(ros2: Ros2, graph: Graph) -> None:
    graph.tells_refusals = False
    offer(graph, "/scan", SCAN)
    assert subscribed(ros2, graph, "/scan").events.incompatible_qos is None


def test_a_publisher_that_was_killed_and_restarted_is_heard_again(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    publisher = offer(graph, "/scan", SCAN)
    subscribed(ros2, graph, "/scan")
    publisher.node.destroy_node()
    wait_for(lambda: not subscriptions(graph), "it is gone")
    again = offer(graph, "/scan", SCAN)
    wait_for(lambda: subscriptions(graph), "it subscribed again")
    again.publish(get_message(SCAN)())
    wait_for(lambda: heard.messages, "it came")
    assert heard.lost == []


def test_two_publishers_on_one_topic_are_both_heard(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    both = [offer(graph, "/scan", SCAN), offer(graph, "/scan", SCAN)]
    subscribed(ros2, graph, "/scan")
    sent = []
    for rays, publisher in enumerate(both):
        sent.append(get_message(SCAN)())
        sent[-1].ranges = np.zeros(rays, np.float32)
        publisher.publish(sent[-1])
    wait_for(lambda: len(heard.messages) == 2, "both came")
    assert [message for _, message in heard.messages] == sent
    assert len(subscriptions(graph)) == 1


def test_a_ros_that_does_not_start_is_told_and_tried_again(
    graph: Graph, heard: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    rclpy, tries = sys.modules["rclpy"], []
    init = rclpy.init

    def refuse_once(**given: Any) -> None:
        tries.append(given)
        if len(tries) == 1:
            raise RuntimeError("failed to initialize rcl: no network")
        init(**given)

    monkeypatch.setattr(rclpy, "init", refuse_once)
    ros2 = Ros2()
    ros2.open(heard)
    wait_for(lambda: heard.connected, "it is connected")
    assert heard.lost[0][0] == f"{ros2.where} cannot be used: failed to initialize rcl: no network"
    ros2.close()


def test_a_hundred_opens_and_closes_leave_no_thread_and_no_node(graph: Graph) -> None:
    threads = threading.active_count()
    for _ in range(100):
        heard = Recorder()
        ros2 = Ros2(domain_id=7)
        ros2.open(heard)
        ros2.subscribe("/scan")
        wait_for(lambda: heard.connected, "it is connected")  # noqa: B023
        ros2.close()
    assert (threading.active_count(), graph.nodes, len(graph.contexts)) == (threads, [], 100)
    assert not any(context.ok() for context in graph.contexts)


def test_a_topic_that_changes_its_type_is_heard_on(ros2: Ros2, graph: Graph) -> None:
    publisher = offer(graph, "/speed", TWIST)
    subscribed(ros2, graph, "/speed")
    publisher.node.destroy_publisher(publisher)
    offer(graph, "/speed", STAMPED)
    wait_for(lambda: [s.topic_type for s in subscriptions(graph)] == [STAMPED], "the other type is subscribed")


def test_a_package_that_is_not_installed_is_named(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    known = get_message(SCAN)
    known.name = "x_msgs/msg/Bump"
    graph.node().create_publisher(known, "/bump", 1)
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
    wait_for(lambda: subscription.node.due, "it was published")
    subscription.node.executor.spin_once(0)
    assert (got[0] if kind == TWIST else got[0].twist).linear.x == 0.25


def test_what_cannot_be_published_is_refused(ros2: Ros2) -> None:
    with pytest.raises(FeedError, match="x_msgs/msg/Bump cannot be published: the package x_msgs is not installed"):
        ros2.publish("/bump", "x_msgs/msg/Bump", {})
    with pytest.raises(FeedError, match="has no field 'speed'"):
        ros2.publish("/cmd_vel", TWIST, {"speed": 1.0})
    with pytest.raises(FeedError, match="cannot publish on '/cmd vel': Invalid topic name"):
        ros2.publish("/cmd vel", TWIST, {})


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
    assert node.executor is None


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


def test_the_program_may_take_its_node_back_and_leave_it_again(
    graph: Graph, heard: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_ros2_spin, "FREE", 0.1)
    node = graph.node()
    publisher = offer(graph, "/scan", SCAN)
    ros2 = Ros2(node)
    ros2.open(heard)
    ros2.subscribe("/scan")
    wait_for(lambda: node.subscriptions, "it subscribed")
    ours = node.executor
    executor = SingleThreadedExecutor(context=node.context)  # what `rclpy.spin(node)` does, up to its end
    node.waited_for_by = executor
    executor.add_node(node)
    publisher.publish(get_message(SCAN)())
    executor.spin_once(5.0)
    assert len(heard.messages) == 1
    executor.remove_node(node)
    wait_for(lambda: node.executor is ours, "it is spun again")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: len(heard.messages) == 2, "the next one came")
    assert heard.lost == []
    ros2.close()


def test_a_node_that_the_program_spins_step_by_step_is_left_to_it(graph: Graph, heard: Recorder) -> None:
    node = graph.node()
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    offer(graph, "/scan", SCAN)
    ros2 = Ros2(node)
    ros2.open(heard)
    executor.remove_node(node)
    ros2.subscribe("/scan")
    wait_for(lambda: node.subscriptions, "it subscribed")
    assert node.executor is executor
    ros2.close()


def test_a_subscription_is_never_destroyed_in_the_hands_of_an_executor(graph: Graph, heard: Recorder) -> None:
    node = graph.node()
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    publisher = offer(graph, "/scan", SCAN)
    ros2 = Ros2(node)
    ros2.open(heard)
    ros2.subscribe("/scan")
    wait_for(lambda: node.subscriptions, "it subscribed")
    seen: list[bool] = []

    def unsubscribe(subscription: Any) -> None:
        ros2.unsubscribe("/scan")
        wait_for(lambda: subscription.callback_group._shut, "its end has begun")
        seen.append(subscription.destroyed)

    graph.before_taking = unsubscribe
    publisher.publish(get_message(SCAN)())
    executor.spin_once(5.0)
    assert seen == [False]
    wait_for(lambda: not node.subscriptions, "it is gone")
    publisher.publish(get_message(SCAN)())
    ros2.close()


def test_a_message_of_a_subscription_that_has_ended_is_not_taken(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    publisher = offer(graph, "/scan", SCAN)
    subscription = subscribed(ros2, graph, "/scan")
    subscription.callback_group.shut(0.0)
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: not subscription.node.due, "it was looked at")
    assert heard.messages == []
    assert heard.lost == []


def test_closing_in_a_callback_of_the_program_s_executor_waits_for_nothing(graph: Graph, heard: Recorder) -> None:
    node = graph.node()
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    publisher = offer(graph, "/scan", SCAN)
    ros2 = Ros2(node)
    heard.then = ros2.close
    ros2.open(heard)
    ros2.subscribe("/scan")
    wait_for(lambda: node.subscriptions, "it subscribed")
    publisher.publish(get_message(SCAN)())
    executor.spin_once(5.0)
    assert (node.subscriptions, executor.get_nodes()) == ([], [node])


def test_an_error_in_a_callback_of_the_program_s_own_is_logged_and_stops_nothing(
    graph: Graph, heard: Recorder, caplog: pytest.LogCaptureFixture
) -> None:
    node = graph.node()

    def fail(message: Any) -> None:
        raise ValueError("a bug of the program's")

    mine = node.create_subscription(
        get_message(SCAN), "/scan", fail, 1, callback_group=Group(), event_callbacks=SubscriptionEventCallbacks()
    )
    publisher = offer(graph, "/scan", SCAN)
    ros2 = Ros2(node)
    ros2.open(heard)
    ros2.subscribe("/scan")
    wait_for(lambda: len(node.subscriptions) == 2, "it subscribed")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: heard.messages, "it came")
    assert "a callback of the node robot raised" in caplog.text
    assert (heard.connected, heard.lost) == (1, [])
    ros2.close()
    assert node.subscriptions == [mine]


def test_a_node_that_was_destroyed_is_told_and_never_called_connected(graph: Graph, heard: Recorder) -> None:
    node = graph.node()
    ros2 = Ros2(node)
    node.destroy_node()
    ros2.open(heard)
    wait_for(lambda: heard.lost, "it is told")
    assert heard.connected == 0
    assert heard.lost[0][0] == (
        "ROS 2, node robot cannot be used: cannot use Destroyable because destruction was requested"
    )
    ros2.close()
    with pytest.raises(FeedError, match="node: it cannot be used, was it destroyed"):
        Ros2(node)


def test_ros_that_is_shut_down_under_our_node_is_told_and_started_again(
    ros2: Ros2, graph: Graph, heard: Recorder
) -> None:
    wait_for(lambda: heard.connected, "it is connected")
    graph.contexts[0].try_shutdown()  # as an interrupt does, where the program called `rclpy.init()`
    wait_for(lambda: heard.connected == 2, "it is connected again")
    assert [why for why, _ in heard.lost] == ["ROS 2, domain 7 cannot be used: rclpy was shut down"]
    assert len(graph.contexts) == 2


def test_a_topic_whose_name_ros_refuses_stops_nothing(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    offer(graph, "/a-topic of somebody else's", SCAN)
    offer(graph, "/scan", SCAN)
    ros2.subscribe("/my scan")
    subscribed(ros2, graph, "/scan")
    wait_for(lambda: heard.topics == [Advert("/scan", SCAN, True, False)], "the others are told")
    assert heard.lost == []


def test_a_package_that_is_half_installed_is_trouble_of_its_topic_alone(
    ros2: Ros2, graph: Graph, heard: Recorder
) -> None:
    graph.broken.add(TWIST)
    offer(graph, "/speed", TWIST)
    offer(graph, "/scan", SCAN)
    ros2.subscribe("/speed")
    subscribed(ros2, graph, "/scan")
    wait_for(lambda: heard.troubles, "it is told")
    assert heard.words("/speed") == f"/speed cannot be subscribed to as {TWIST}: no type support of {TWIST}"
    assert heard.lost == []


def test_a_policy_that_is_not_known_is_heard_best_effort(ros2: Ros2, graph: Graph) -> None:
    unknown = QoSProfile(
        depth=0,
        history=HistoryPolicy.UNKNOWN,
        reliability=ReliabilityPolicy.UNKNOWN,
        durability=DurabilityPolicy.UNKNOWN,
    )
    offer(graph, "/scan", SCAN, unknown)
    qos = subscribed(ros2, graph, "/scan").qos_profile
    assert (qos.history, qos.reliability) == (HistoryPolicy.KEEP_LAST, ReliabilityPolicy.BEST_EFFORT)


def test_events_are_told_by_the_older_rclpy_too(monkeypatch: pytest.MonkeyPatch, heard: Recorder) -> None:
    graph = install(monkeypatch, events="qos_event")
    ros2 = Ros2(domain_id=7)
    ros2.open(heard)
    offer(graph, "/scan", SCAN)
    assert subscribed(ros2, graph, "/scan").events.incompatible_qos is not None
    ros2.close()


def test_a_last_speed_is_out_before_the_publisher_ends(ros2: Ros2, graph: Graph, heard: Recorder) -> None:
    got: list[Any] = []
    subscription = listener(graph, "/cmd_vel", TWIST, got.append)
    wait_for(lambda: heard.topics, "the topic is known")
    ros2.publish("/cmd_vel", TWIST, {"linear": {"x": 0.25}})
    wait_for(lambda: subscription.node.due, "it was published")
    publisher = graph.nodes[0].publishers[0] if graph.nodes[0].publishers else graph.nodes[1].publishers[0]
    ros2.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    ros2.close()
    assert (len(subscription.node.due), publisher.acked, publisher.destroyed) == (2, 1, True)


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
    monkeypatch.setitem(sys.modules, "rclpy", None)
    with pytest.raises(FeedError, match=r"rclpy cannot be imported here .* feeds\.dds\(\) needs no ROS"):
        Ros2().open(heard)

"""The feed of rclpy on a stand-in; `test_ros2_real` holds the same against the real one."""

from __future__ import annotations

import gc
import itertools
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robowidgets import feeds
from robowidgets.feeds import _ros2_session, _zeros
from robowidgets.feeds.middleware import CLOSE_TIMEOUT, SEND_TIMEOUT, Advert, FeedError, NotConnectedYetError
from robowidgets.feeds.ros2 import EARLY_LOOK, LOOK, Ros2

from ..clocks import ManualClock
from ..waiting import wait_for
from .bursts import EVERY, LAST, record_bursts
from .ears import Ears
from .fake_rclpy import (
    DurabilityPolicy,
    Graph,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
    SingleThreadedExecutor,
    get_message,
    install,
)

SCAN = "sensor_msgs/msg/LaserScan"
TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
FORWARD, ZERO = {"linear": {"x": 0.25}}, {"linear": {"x": 0.0}}


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    graph = install(monkeypatch)
    yield graph
    assert graph.warnings == []


@pytest.fixture
def heard() -> Ears:
    return Ears()


THREADS = ("robowidgets-ros2", "robowidgets-drive")
"""Threads that wait elsewhere than by the clock that is moved by hand."""

NEVER = 1000.0
"""Replaces waits of seconds: a test that really waits this long fails by its time-out."""


@pytest.fixture
def ros2(graph: Graph, heard: Ears) -> Iterator[Ros2]:
    ros2 = Ros2(domain_id=7)
    ros2.open(heard)
    yield ros2
    ros2.close()


def look_no_more(ros2: Ros2, heard: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    """Return once a middleware has looked at the topics for the last time, and waits for a request."""
    wait_for(lambda: heard.topics, "the topics are known")
    spin, idle = SingleThreadedExecutor.spin_once, threading.Event()

    def note(executor: Any, timeout_sec: float | None = None) -> None:
        if timeout_sec is None or timeout_sec > NEVER / 2:
            idle.set()
        spin(executor, timeout_sec)

    monkeypatch.setattr(SingleThreadedExecutor, "spin_once", note)
    for pause in ("LOOK", "EARLY_LOOK"):
        monkeypatch.setattr(sys.modules[Ros2.__module__], pause, NEVER)
    wait_for(idle.is_set, "it is idle")


class Spun:
    """A node in an executor that spins in its own thread, as in a program."""

    def __init__(self, node: Any) -> None:
        self.node = node
        self.executor = SingleThreadedExecutor(context=node.context)
        self.executor.add_node(node)
        self._thread = threading.Thread(target=self._spin)
        self._thread.start()

    def _spin(self) -> None:
        try:
            self.executor.spin()
        except Exception:
            assert not self.node.context.ok(), "only a shutdown ends it"

    def __enter__(self) -> Spun:
        return self

    def __exit__(self, *_: object) -> None:
        self.executor.shutdown()
        self._thread.join()


class Robot(Spun):
    """Listens to a topic, and logs when each message came."""

    def __init__(self, graph: Graph, kind: str = TWIST, qos: Any = 10) -> None:
        node = graph.node("base", "/robot")
        self.log: list[tuple[float, Any]] = []
        node.create_subscription(
            get_message(kind), "/cmd_vel", lambda message: self.log.append((time.monotonic(), message)), qos
        )
        super().__init__(node)

    @property
    def speeds(self) -> list[float]:
        return [getattr(message, "twist", message).linear.x for _, message in self.log]


@pytest.fixture
def robot(graph: Graph) -> Iterator[Robot]:
    with Robot(graph) as robot:
        yield robot


def offer(graph: Graph, topic: str, kind: str, qos: Any = None) -> Any:
    return graph.node().create_publisher(get_message(kind), topic, qos or QoSProfile(depth=1))


def subscriptions(graph: Graph) -> list[Any]:
    """The nodes of the product."""
    nodes = [node for node in list(graph.nodes) if node.context in graph.contexts]
    return [s for node in nodes for s in list(node.subscriptions)]


def subscribed(ros2: Ros2, graph: Graph, topic: str) -> Any:
    """The subscription to a topic, once its publisher knows it."""
    ros2.follow(ros2._wanted | {topic})
    wait_for(lambda: any(s.topic_name == topic and s.others() for s in subscriptions(graph)), "it subscribed")
    return next(s for s in subscriptions(graph) if s.topic_name == topic)


# -- topics ------------------------------------------------------------------------------------------------------------


def test_topics_tell_what_others_publish_and_listen_to(ros2: Ros2, graph: Graph, heard: Ears, robot: Robot) -> None:
    offer(graph, "/scan", SCAN)
    subscribed(ros2, graph, "/scan")
    ros2.publish("/cmd_vel", TWIST, FORWARD)
    expected = [
        Advert("/cmd_vel", TWIST, False, True, (), ("/robot/base",)),
        Advert("/scan", SCAN, True, False, ("/robot",), ()),
    ]
    wait_for(lambda: heard.topics == expected, "the topics are reported")
    assert graph.contexts[0].domain_id == 7
    assert ros2.where == "ROS 2, domain 7"


def test_a_domain_without_a_robot_says_what_to_compare_until_there_is_one(
    graph: Graph, heard: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = sys.modules[Ros2.__module__]
    assert module.ALONE + EARLY_LOOK < 2.0
    monkeypatch.setattr(module, "ALONE", 0.3)
    offer(graph, "/rosout", "rcl_interfaces/msg/Log")  # as every node has, also a program on this machine
    ros2 = Ros2(domain_id=7)
    ros2.open(heard)
    wait_for(lambda: heard.nobody or heard.topics is not None, "it is reported")
    assert heard.nobody == (
        "no robot in domain 7. Is 7 the robot's ROS_DOMAIN_ID? Does a firewall block the UDP ports 9150 to 9399? "
        "Do both sides have the same RMW_IMPLEMENTATION? Does one have ROS_LOCALHOST_ONLY or "
        "ROS_AUTOMATIC_DISCOVERY_RANGE set?"
    )
    robot = offer(graph, "/scan", SCAN)
    wait_for(lambda: len(heard.topics or ()) == 2, "the robot is found")
    assert heard.nobody == ""
    robot.node.destroy_node()
    wait_for(lambda: len(heard.topics or ()) == 1, "it is gone")
    graph.interrupt()
    wait_for(lambda: heard.connected == 2, "another session has begun")
    wait_for(lambda: (session := ros2._session) and session.age > 0.5, "after time for discovery")
    assert heard.nobody == "", "a known subscriber has the right settings"
    ros2.close()


def test_other_nodes_that_publish_are_named_if_their_names_are_known(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    for name, namespace in (("teleop", "/hand"), ("nav", "/"), ("_NODE_NAME_UNKNOWN_", "_NODE_NAMESPACE_UNKNOWN_")):
        graph.node(name, namespace).create_publisher(get_message(TWIST), "/cmd_vel", 1)
    graph.node("_CREATED_BY_BARE_DDS_APP_", "_CREATED_BY_BARE_DDS_APP_").create_publisher(
        get_message(TWIST), "/cmd_vel", 1
    )
    ros2.publish("/cmd_vel", TWIST, ZERO)
    expected = [Advert("/cmd_vel", TWIST, True, False, ("/hand/teleop", "/nav"), ())]
    wait_for(lambda: heard.topics == expected, "they are named")


def test_a_topic_without_a_publisher_left_is_not_offered(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    lonely, shared = offer(graph, "/lonely", SCAN), offer(graph, "/shared", SCAN)
    graph.node("viewer").create_subscription(get_message(SCAN), "/shared", lambda _message: None, 1)
    for topic in ("/lonely", "/shared"):
        subscribed(ros2, graph, topic)
    lonely.node.destroy_node()
    shared.node.destroy_node()
    wait_for(lambda: heard.topics == [Advert("/shared", SCAN, False, True, (), ("/viewer",))], "it is reported")
    assert heard.lost == []


def test_a_topic_that_appears_soon_after_the_start_is_found_by_an_early_look(
    graph: Graph, heard: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert EARLY_LOOK < LOOK
    monkeypatch.setattr(sys.modules[Ros2.__module__], "LOOK", NEVER)
    ros2 = Ros2(domain_id=7)
    ros2.open(heard)
    wait_for(lambda: heard.connected, "it has looked for the first time")
    with Robot(graph):
        wait_for(lambda: heard.topics, "the robot is known")
    ros2.close()


def test_a_topic_whose_name_ros_refuses_stops_nothing(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    offer(graph, "/a-topic of somebody else's", SCAN)
    offer(graph, "/scan", SCAN)
    ros2.follow(frozenset({"/my scan"}))
    subscribed(ros2, graph, "/scan")
    wait_for(lambda: [advert.name for advert in heard.topics or ()] == ["/scan"], "the others are reported")
    assert heard.lost == []


# -- messages ----------------------------------------------------------------------------------------------------------


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


def test_a_refusal_is_reported_and_gone_with_the_next_message(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    publisher = offer(graph, "/scan", SCAN, QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    subscribed(ros2, graph, "/scan")
    refused = offer(graph, "/scan", SCAN)
    wait_for(lambda: heard.troubles, "it is reported")
    assert heard.words("/scan") == (
        "a publisher of /scan keeps no earlier messages (durability), so its messages do not come"
    )
    wait_for(lambda: publisher.matches() and refused.matches(), "it is asked for less")
    refused.publish(get_message(SCAN)())
    wait_for(lambda: heard.messages, "it came")
    assert heard.words("/scan") == ""


def test_a_truncated_message_is_reported_until_a_whole_one_comes_and_delays_no_other(
    ros2: Ros2, graph: Graph, heard: Ears
) -> None:
    publisher, other = offer(graph, "/scan", SCAN), offer(graph, "/other", SCAN)
    subscribed(ros2, graph, "/other")
    first = subscribed(ros2, graph, "/scan")
    first.receive(b"half a scan")
    wait_for(lambda: heard.troubles, "it is reported")
    assert heard.words("/scan") == (
        "a message of /scan cannot be read: failed to take message from subscription: error not set"
    )
    other.publish(get_message(SCAN)())
    wait_for(lambda: [topic for topic, _ in heard.messages] == ["/other"], "the other goes on")
    wait_for(publisher.matches, "it subscribed again")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: heard.words("/scan") == "", "a whole one came")
    assert (heard.connected, heard.lost) == (1, [])


def test_it_subscribes_if_refusals_cannot_be_reported(ros2: Ros2, graph: Graph) -> None:
    graph.tells_refusals = False
    offer(graph, "/scan", SCAN)
    assert subscribed(ros2, graph, "/scan").events.incompatible_qos is None
    ros2.publish("/cmd_vel", TWIST, ZERO)


def test_two_publishers_on_one_topic_are_both_heard(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    both = [offer(graph, "/scan", SCAN), offer(graph, "/scan", SCAN)]
    ros2.follow(frozenset({"/scan"}))
    sent = []
    for rays, publisher in enumerate(both):
        wait_for(publisher.matches, "it subscribed")
        sent.append(get_message(SCAN)())
        sent[-1].ranges = np.zeros(rays, np.float32)
        publisher.publish(sent[-1])
    wait_for(lambda: len(heard.messages) == 2, "both came")
    assert [message for _, message in heard.messages] == sent
    assert len(subscriptions(graph)) == 1


def test_a_package_that_is_not_installed_is_named(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    known = get_message(SCAN)
    known.name = "x_msgs/msg/Bump"
    graph.node().create_publisher(known, "/bump", 1)
    ros2.follow(frozenset({"/bump"}))
    wait_for(lambda: heard.troubles, "it is reported")
    assert heard.words("/bump") == (
        "/bump comes as x_msgs/msg/Bump: the package x_msgs is not installed here, or lacks it; install "
        "ros-<distro>-x-msgs, or source the workspace that has it, and restart the kernel"
    )


def test_a_package_that_is_half_installed_is_trouble_of_its_topic_alone(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    graph.broken.add(TWIST)
    offer(graph, "/speed", TWIST)
    offer(graph, "/scan", SCAN)
    ros2.follow(frozenset({"/speed"}))
    subscribed(ros2, graph, "/scan")
    wait_for(lambda: heard.troubles, "it is reported")
    assert heard.words("/speed") == f"/speed cannot be subscribed to as {TWIST}: no type support of {TWIST}"
    assert heard.lost == []


def test_events_are_reported_by_the_older_rclpy_too(monkeypatch: pytest.MonkeyPatch, heard: Ears) -> None:
    graph = install(monkeypatch, events="qos_event")
    ros2 = Ros2(domain_id=7)
    ros2.open(heard)
    offer(graph, "/scan", SCAN)
    assert subscribed(ros2, graph, "/scan").events.incompatible_qos is not None
    ros2.close()


# -- publishing --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [TWIST, STAMPED])
def test_a_speed_is_published_as_the_robot_wants_it(ros2: Ros2, graph: Graph, kind: str) -> None:
    with Robot(graph, kind) as robot:
        ros2.publish("/cmd_vel", kind, FORWARD if kind == TWIST else {"header": {"frame_id": "b"}, "twist": FORWARD})
        wait_for(lambda: robot.speeds == [0.25], "the robot received it")


def test_the_first_message_of_a_feed_that_was_just_opened_arrives(ros2: Ros2, graph: Graph, robot: Robot) -> None:
    graph.discovery = 0.2
    ros2.publish("/cmd_vel", TWIST, ZERO)
    wait_for(lambda: robot.speeds == [0.0], "the robot received it")


def test_the_first_message_to_a_robot_that_came_late_arrives(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    wait_for(lambda: heard.connected, "it is connected")
    with Robot(graph) as robot:
        wait_for(lambda: heard.topics, "the robot is known")
        ros2.publish("/cmd_vel", TWIST, ZERO)
        wait_for(lambda: robot.speeds == [0.0], "the robot received it")


def test_the_first_message_to_a_best_effort_robot_arrives(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    with Robot(graph, qos=QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)) as robot:
        wait_for(lambda: heard.topics, "the robot is known")
        ros2.publish("/cmd_vel", TWIST, ZERO)
        wait_for(lambda: robot.speeds == [0.0], "the robot received it")


def test_a_topic_without_subscribers_does_not_wait(
    ros2: Ros2, graph: Graph, heard: Ears, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    wait_for(lambda: heard.topics, "the robot is known")
    monkeypatch.setattr(sys.modules[Ros2.__module__], "SEND_TIMEOUT", NEVER)
    ros2.publish("/cmd_vel", STAMPED, {"twist": ZERO})  # it takes the other type


def test_the_calling_thread_publishes_and_has_published_when_it_returns(ros2: Ros2, graph: Graph, robot: Robot) -> None:
    ros2.publish("/cmd_vel", TWIST, ZERO)
    assert graph.published_by == [threading.current_thread().name]


def test_every_message_arrives_though_no_other_comes(
    ros2: Ros2, robot: Robot, heard: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    look_no_more(ros2, heard, monkeypatch)
    for number in range(1, 21):
        ros2.publish("/cmd_vel", TWIST, {"linear": {"x": float(number)}})
        wait_for(lambda: len(robot.log) == number, "the robot received it")  # noqa: B023
    assert robot.speeds == [float(number) for number in range(1, 21)]


@pytest.fixture(params=["alone", "spun by its program", "of a context that was shut down", "destroyed"])
def node(graph: Graph, request: pytest.FixtureRequest) -> Iterator[Any]:
    """A node of the program's, or none; once a feed is open, the test does `node.befall` to it."""
    node = graph.node("mine")
    node.befall = lambda: None
    if request.param == "alone":
        yield node
        return
    with Spun(node):
        if request.param == "of a context that was shut down":
            node.befall = node.context.try_shutdown
        elif request.param == "destroyed":
            node.befall = node.destroy_node
        yield node


def test_stop_of_a_feed_arrives_whatever_becomes_of_the_node(graph: Graph, robot: Robot, node: Any) -> None:
    with feeds.ros2(node) as feed:
        wait_for(lambda: feed.topics, "the robot is known")
        feed.drive(0.25)
        wait_for(lambda: robot.speeds, "the robot drives")
        feed.driving = feeds.Driving(hold=NEVER)
        node.befall()
        for _ in range(5):
            feed.drive(0.25)
            wait_for(lambda: robot.speeds[-1] == 0.25, "the robot drives")
            feed.stop()
            wait_for(lambda: robot.speeds[-1] == 0.0, "the robot stops")


@pytest.mark.parametrize("both_at_first", [True, False])
def test_no_message_waits_for_a_subscriber_of_another_type_after_the_first(
    ros2: Ros2, graph: Graph, robot: Robot, heard: Ears, monkeypatch: pytest.MonkeyPatch, both_at_first: bool
) -> None:
    stamped = Advert("/cmd_vel", STAMPED, offered=False, wanted=True, subscribers=("/robot/base",))
    if not both_at_first:
        ros2.publish("/cmd_vel", TWIST, FORWARD)
    with Robot(graph, STAMPED) as other:
        wait_for(lambda: stamped in (heard.topics or ()), "the other is known")
        if both_at_first:
            ros2.publish("/cmd_vel", TWIST, FORWARD)
        monkeypatch.setattr(_ros2_session, "_MATCH_LAG", NEVER)

        def publish() -> list[float]:
            ros2.publish("/cmd_vel", STAMPED, {"twist": FORWARD})
            return other.speeds

        wait_for(publish, "the other moves, too")


def test_what_cannot_be_published_is_refused(ros2: Ros2) -> None:
    with pytest.raises(FeedError, match=r"cannot publish on '/bump': .*the package x_msgs is not installed"):
        ros2.publish("/bump", "x_msgs/msg/Bump", {})
    with pytest.raises(FeedError, match="cannot publish on '/cmd vel': Invalid topic name"):
        ros2.publish("/cmd vel", TWIST, {})


def test_what_rclpy_does_not_publish_is_refused(ros2: Ros2, graph: Graph) -> None:
    graph.broken.add(TWIST)
    with pytest.raises(FeedError, match=f"cannot publish on '/cmd_vel': no type support of {TWIST}"):
        ros2.publish("/cmd_vel", TWIST, ZERO)


def test_without_a_connection_nothing_is_published_and_nothing_kept(
    graph: Graph, heard: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(**_: Any) -> None:
        raise RuntimeError("failed to initialize rcl: no network")

    with monkeypatch.context() as refusing:
        refusing.setattr(sys.modules["rclpy"], "init", refuse)
        ros2 = Ros2(domain_id=7)
        ros2.open(heard)
        wait_for(lambda: heard.lost, "it is reported")
        with pytest.raises(FeedError, match="ROS 2, domain 7 cannot be used: failed to initialize rcl: no network"):
            ros2.publish("/cmd_vel", TWIST, FORWARD)
    with Robot(graph) as robot:
        wait_for(lambda: heard.connected, "it is connected")
        ros2.publish("/cmd_vel", TWIST, ZERO)
        wait_for(lambda: robot.speeds == [0.0], "only what was published since arrives")
        ros2.close()
    with pytest.raises(FeedError, match="ROS 2, domain 7 is closed"):
        ros2.publish("/cmd_vel", TWIST, ZERO)


def test_a_listener_that_refuses_our_quality_of_service_is_reported_until_it_is_gone(
    ros2: Ros2, graph: Graph, heard: Ears, robot: Robot
) -> None:
    ros2.publish("/cmd_vel", TWIST, ZERO)
    wait_for(lambda: robot.speeds, "the robot received it")
    picky = graph.node("picky").create_subscription(
        get_message(TWIST),
        "/cmd_vel",
        lambda _message: None,
        QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
    )
    wait_for(lambda: heard.unheard, "it is reported")
    words = "a subscriber of /cmd_vel expects earlier messages (durability), so it receives nothing"
    assert heard.unheard == {"/cmd_vel": words}
    offer(graph, "/scan", SCAN)
    wait_for(lambda: any(advert.name == "/scan" for advert in heard.topics or ()), "it looked again")
    assert heard.unheard == {"/cmd_vel": words}
    picky.node.destroy_node()
    wait_for(lambda: heard.words("/cmd_vel") == "", "it is over")


# -- its context and node ----------------------------------------------------------------------------------------------


def test_a_ros_that_does_not_start_is_reported_and_tried_again(
    graph: Graph, heard: Ears, monkeypatch: pytest.MonkeyPatch
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
    assert heard.lost[0] == f"{ros2.where} cannot be used: failed to initialize rcl: no network"
    ros2.close()


@pytest.mark.parametrize(("seconds", "asks"), [(NEVER, 1), (0.0, 0)], ids=["just now", "a while ago"])
def test_a_close_waits_for_subscribers_only_shortly_after_a_message(
    ros2: Ros2, graph: Graph, robot: Robot, monkeypatch: pytest.MonkeyPatch, seconds: float, asks: int
) -> None:
    ros2.publish("/cmd_vel", TWIST, ZERO)
    publishers = [end for node in graph.nodes for end in node.publishers if end.topic_name == "/cmd_vel"]
    monkeypatch.setattr(_ros2_session, "SEND_TIMEOUT", seconds)
    ros2.close()
    assert [publisher.acked for publisher in publishers] == [asks]


def test_a_hundred_opens_and_closes_leave_no_thread_and_no_node(graph: Graph) -> None:
    threads = threading.active_count()
    for _ in range(100):
        heard = Ears()
        ros2 = Ros2(domain_id=7)
        ros2.open(heard)
        ros2.follow(frozenset({"/scan"}))
        wait_for(lambda: heard.connected, "it is connected")  # noqa: B023
        ros2.close()
    wait_for(lambda: threading.active_count() <= threads, "every thread has ended")
    assert (graph.nodes, len(graph.contexts)) == ([], 100)
    assert not any(context.ok() for context in graph.contexts)


def test_two_feeds_have_nodes_of_different_names(graph: Graph) -> None:
    both = [Ros2(domain_id=7), Ros2(domain_id=7)]
    for ros2 in both:
        ros2.open(Ears())
    wait_for(lambda: len(graph.nodes) == 2, "both have a node")
    assert graph.nodes[0].name != graph.nodes[1].name
    for ros2 in both:
        ros2.close()


def test_our_node_and_context_are_shut_down_in_order_and_leave_no_thread(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    wait_for(lambda: heard.connected, "it is connected")
    ros2.close()
    ros2.close()
    assert graph.contexts[0].log == ["executor", "node", "shutdown"]
    assert not graph.nodes
    assert "robowidgets-ros2" not in {thread.name for thread in threading.enumerate()}


def test_closing_takes_no_longer_than_it_may_whatever_rclpy_does(graph: Graph, heard: Ears) -> None:
    clock = ManualClock()
    ros2 = Ros2(domain_id=7, clock=clock)
    ros2.open(heard)
    wait_for(lambda: heard.connected, "it is connected")
    released, held, numbers = threading.Event(), threading.Event(), itertools.count()

    def hang() -> list[Any]:
        held.set()
        released.wait()
        return []

    graph.nodes[0].get_topic_names_and_types = hang  # type: ignore[method-assign]
    wait_for(lambda: ros2.follow(frozenset({f"/{next(numbers)}"})) or held.is_set(), "it hangs")
    closing = clock.beside(ros2.close)
    clock.advance(CLOSE_TIMEOUT - 0.001, THREADS)
    assert closing.is_alive()
    clock.advance(0.001, THREADS)
    closing.join()
    released.set()
    wait_for(lambda: not graph.nodes, "it ends when it can")


def test_closing_waits_until_the_last_message_is_received_but_not_for_ever(
    graph: Graph, robot: Robot, heard: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = ManualClock()
    ros2 = Ros2(domain_id=7, clock=clock)
    ros2.open(heard)
    wait_for(lambda: clock.advance(0.1, THREADS) or heard.topics, "the robot is known")
    publishing = clock.beside(lambda: ros2.publish("/cmd_vel", TWIST, ZERO))
    wait_for(lambda: clock.advance(0.05, THREADS) or not publishing.is_alive(), "it is published")
    publisher = next(p for node in graph.nodes for p in node.publishers)
    wait = publisher.wait_for_all_acked

    def never(timeout: Any) -> bool:
        assert not publisher.destroyed
        wait(timeout)
        clock.advance(timeout.nanoseconds / 1e9, THREADS)
        return False

    monkeypatch.setattr(publisher, "wait_for_all_acked", never)
    began = clock.now()
    ros2.close()
    assert publisher.acked > 1
    assert publisher.destroyed
    assert clock.now() - began == pytest.approx(SEND_TIMEOUT, abs=0.02)


def test_what_is_asked_of_an_idle_feed_is_done_at_once(
    graph: Graph, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    offer(graph, "/scan", SCAN)
    for _ in range(3):
        ros2, heard = Ros2(domain_id=7), Ears()
        ros2.open(heard)
        with monkeypatch.context() as patch:
            look_no_more(ros2, heard, patch)
            ros2.follow(frozenset({"/scan"}))
            wait_for(lambda: subscriptions(graph), "it subscribed")
            ros2.close()
        thread = ros2._thread
        wait_for(lambda: not thread.is_alive(), "it ended")  # type: ignore[union-attr]  # noqa: B023


def test_it_can_be_closed_in_a_callback(ros2: Ros2, graph: Graph, heard: Ears) -> None:
    heard.then = lambda *_: ros2.close()
    publisher = offer(graph, "/scan", SCAN)
    subscribed(ros2, graph, "/scan")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: graph.contexts[0].log == ["executor", "node", "shutdown"], "it ended")


def test_an_interrupt_that_ends_all_of_rclpy_is_reported_once_and_survived(
    ros2: Ros2, graph: Graph, heard: Ears, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    unraisable: list[Any] = []
    monkeypatch.setattr(sys, "unraisablehook", unraisable.append)
    wait_for(lambda: heard.connected, "it is connected")
    graph.interrupt()
    wait_for(lambda: heard.connected == 2, "it is connected again")
    publisher = offer(graph, "/scan", SCAN)
    subscribed(ros2, graph, "/scan")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: heard.messages, "messages come again")
    assert list(zip(heard.lost, heard.pauses, strict=True)) == [
        ("ROS 2, domain 7 cannot be used: rclpy was shut down", 0.0)
    ]
    assert [context.ok() for context in graph.contexts] == [False, True]
    gc.collect()
    assert (unraisable, capfd.readouterr().err) == ([], "")


def test_a_zero_after_an_interrupt_that_ended_all_of_rclpy_arrives(
    ros2: Ros2, graph: Graph, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.modules[Ros2.__module__], "EARLY_LOOK", NEVER)  # the interrupt ends no wait of its thread
    for _ in range(3):
        ros2.publish("/cmd_vel", TWIST, FORWARD)
        wait_for(lambda: robot.speeds[-1:] == [0.25], "the robot drives")
        for context in graph.contexts:
            context.interrupt()  # the robot is in another process
        ros2.publish("/cmd_vel", TWIST, ZERO)
        wait_for(lambda: robot.speeds[-1] == 0.0, "the robot stops")


def test_a_stop_after_such_an_interrupt_arrives(graph: Graph, robot: Robot) -> None:
    for _ in range(3):
        with feeds.ros2(domain_id=7) as feed:
            feed.driving = feeds.Driving(hold=NEVER)
            feed.drive(0.25)
            wait_for(lambda: robot.speeds[-1:] == [0.25], "the robot drives")
            graph.contexts[-1].interrupt()
            feed.stop()
            wait_for(lambda: robot.speeds[-1] == 0.0, "the robot stops")


def test_a_feed_that_is_closed_after_such_an_interrupt_stops_the_robot(graph: Graph, robot: Robot) -> None:
    feed = feeds.ros2(domain_id=7)
    feed.driving = feeds.Driving(hold=NEVER)
    feed.drive(0.25)
    wait_for(lambda: robot.speeds[-1:] == [0.25], "the robot drives")
    graph.contexts[0].interrupt()
    feed.close()
    wait_for(lambda: robot.speeds[-1] == 0.0, "the robot stops")


def test_a_zero_that_the_robot_cannot_have_received_is_not_called_sent(ros2: Ros2, graph: Graph, robot: Robot) -> None:
    ros2.publish("/cmd_vel", TWIST, FORWARD)
    ros2._matched.add(("/cmd_vel", STAMPED))
    graph.discovery = 1.0
    graph.contexts[0].interrupt()
    with pytest.raises(FeedError, match="the subscriber of /cmd_vel is not discovered again since rclpy was shut"):
        ros2.publish("/cmd_vel", TWIST, ZERO)
    with pytest.raises(FeedError, match="not discovered again"):
        ros2.publish("/cmd_vel", STAMPED, {"twist": ZERO})
    assert robot.speeds == [0.25]

    def arrived() -> bool:
        try:
            ros2.publish("/cmd_vel", TWIST, ZERO)
        except FeedError:
            return False
        return True

    wait_for(arrived, "the robot is found again")
    wait_for(lambda: robot.speeds == [0.25, 0.0], "the robot stops")


def test_a_zero_that_was_too_early_follows_as_soon_as_the_robot_is_found_again(
    graph: Graph, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robowidgets.driving.command_watchdog.RETRY", 60.0)
    with feeds.ros2(domain_id=7) as feed:
        feed.driving = feeds.Driving(hold=NEVER)
        feed.drive(0.25)
        wait_for(lambda: robot.speeds[-1:] == [0.25], "the robot drives")
        graph.discovery = 1.3
        graph.contexts[0].interrupt()
        with pytest.raises(FeedError, match=r"not discovered again .*; zero follows when it can be sent"):
            feed.stop()
        wait_for(lambda: robot.speeds[-1] == 0.0, "the robot stops")


def test_a_speed_with_which_the_robot_was_found_again_owes_no_earlier_zero(
    ros2: Ros2, graph: Graph, robot: Robot, heard: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    def is_published() -> bool:
        try:
            ros2.publish("/cmd_vel", TWIST, FORWARD)
        except NotConnectedYetError:
            return False
        return True

    monkeypatch.setattr(sys.modules[Ros2.__module__], "EARLY_LOOK", 3.0)
    assert is_published()
    graph.discovery = 1.0
    graph.contexts[0].interrupt()
    with pytest.raises(FeedError, match="not discovered again"):
        ros2.publish("/cmd_vel", TWIST, ZERO)
    wait_for(is_published, "the robot is found again")
    connected, topics = heard.connected, heard.topics
    wait_for(lambda: heard.topics is not topics, "it looks again")
    assert heard.connected == connected, "otherwise zero would follow the speed"


@pytest.mark.parametrize("reliability", list(ReliabilityPolicy)[1:3])
def test_a_robot_that_comes_back_gets_the_zero_that_was_sent_meanwhile(
    ros2: Ros2, graph: Graph, heard: Ears, reliability: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.modules[Ros2.__module__], "LOOK", 0.05)
    qos = QoSProfile(depth=10, reliability=reliability)
    with Robot(graph, qos=qos) as robot:
        wait_for(lambda: heard.topics, "the robot is known")
        ros2.publish("/cmd_vel", TWIST, FORWARD)
        wait_for(lambda: robot.speeds == [0.25], "it drives")
        robot.node.destroy_node()
        wait_for(lambda: not heard.topics, "it is gone")
    with pytest.raises(
        TimeoutError, match="/cmd_vel has no subscriber any more: the robot that was driven may be unreachable"
    ):
        ros2.publish("/cmd_vel", TWIST, ZERO)
    with Robot(graph, qos=qos) as again:
        wait_for(lambda: again.speeds == [0.0], "it gets zero")


def test_a_best_effort_robot_gets_zero_some_more_times_unless_a_speed_follows(
    ros2: Ros2, graph: Graph, heard: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.modules[Ros2.__module__], "LOOK", 0.05)
    with Robot(graph, qos=QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)) as robot:
        wait_for(lambda: heard.topics, "the robot is known")
        ros2.publish("/cmd_vel", TWIST, FORWARD)
        ros2.publish("/cmd_vel", TWIST, ZERO)
        session = ros2._session
        assert session is not None
        with session._publishing:
            zeros = session._zeros._topics["/cmd_vel"]
            zeros.since -= 100.0
        wait_for(lambda: robot.speeds == [0.25, 0.0, 0.0], "zero comes again")
        ros2.publish("/cmd_vel", TWIST, FORWARD)
        assert not zeros.zeros


def test_a_best_effort_robot_gets_zero_some_more_times_before_the_connection_ends(
    ros2: Ros2, graph: Graph, heard: Ears
) -> None:
    with Robot(graph, qos=QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)) as robot:
        wait_for(lambda: heard.topics, "the robot is known")
        ros2.publish("/cmd_vel", TWIST, FORWARD)
        ros2.publish("/cmd_vel", TWIST, ZERO)
        ros2.close()
        wait_for(lambda: robot.speeds == [0.25, *[0.0] * (1 + _zeros.LAST)], "zero comes again")


def test_a_robot_that_was_found_late_is_known_to_have_listened(ros2: Ros2, graph: Graph, robot: Robot) -> None:
    graph.discovery = SEND_TIMEOUT + 0.2
    ros2.publish("/cmd_vel", TWIST, FORWARD)
    assert robot.speeds == []
    wait_for(lambda: ros2._matched, "it is found")
    graph.contexts[0].interrupt()
    with pytest.raises(FeedError, match="not discovered again"):
        ros2.publish("/cmd_vel", TWIST, ZERO)


def test_a_feed_that_is_closed_waits_until_its_robot_is_found_again(graph: Graph, robot: Robot) -> None:
    feed = feeds.ros2(domain_id=7)
    feed.driving = feeds.Driving(hold=NEVER)
    feed.drive(0.25)
    wait_for(lambda: robot.speeds[-1:] == [0.25], "the robot drives")
    graph.discovery = 1.3
    graph.contexts[0].interrupt()
    feed.close()
    wait_for(lambda: robot.speeds[-1] == 0.0, "the robot stops")


# -- a node of the program's -------------------------------------------------------------------------------------------


def test_of_a_node_only_the_domain_is_used(graph: Graph, heard: Ears) -> None:
    node = graph.node("mine")
    publisher = offer(graph, "/scan", SCAN)
    ros2 = Ros2(node)
    ros2.open(heard)
    subscribed(ros2, graph, "/scan")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: heard.messages, "it came, though no executor spins the node")
    assert ros2.where == "ROS 2, domain 7"
    assert (node.executor, node.subscriptions, node.publishers) == (None, [], [])
    ros2.close()
    assert node in graph.nodes
    assert node.context.ok()


def test_messages_come_after_the_program_s_context_was_shut_down(graph: Graph, heard: Ears) -> None:
    node = graph.node("mine")
    ros2 = Ros2(node)
    ros2.open(heard)
    node.destroy_node()
    node.context.try_shutdown()
    publisher = offer(graph, "/scan", SCAN)
    subscribed(ros2, graph, "/scan")
    publisher.publish(get_message(SCAN)())
    wait_for(lambda: heard.messages, "it came")
    assert (heard.connected, heard.lost) == (1, [])
    ros2.close()


def test_a_node_of_a_context_that_was_shut_down_is_refused(graph: Graph) -> None:
    node = graph.node()
    node.context.try_shutdown()
    with pytest.raises(FeedError, match="node: its domain is not known any more, as rclpy was shut down; give a new"):
        Ros2(node)


def test_wrong_arguments_are_refused_by_name(graph: Graph) -> None:
    with pytest.raises(TypeError, match="node: expected a node of rclpy, got 'robot'"):
        Ros2("robot")
    with pytest.raises(TypeError, match="domain_id: expected a whole number, as in ROS_DOMAIN_ID, got '1'"):
        Ros2(domain_id="1")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="domain_id: expected 0 to 232, as in ROS_DOMAIN_ID, got -1"):
        Ros2(domain_id=-1)
    with pytest.raises(TypeError, match="give a node or a domain_id, not both"):
        Ros2(graph.node(), domain_id=1)


def test_the_domain_of_the_environment_stays_the_domain_of_the_feed(
    graph: Graph, heard: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "11")
    red = Ros2()
    monkeypatch.setenv("ROS_DOMAIN_ID", "0x0c")
    blue = Ros2()
    monkeypatch.delenv("ROS_DOMAIN_ID")
    assert (red.where, blue.where) == ("ROS 2, domain 11", "ROS 2, domain 12")
    assert [one.outlet.arguments["domain_id"] for one in (red, blue, Ros2())] == [11, 12, 0]
    red.open(heard)
    wait_for(lambda: heard.connected, "it is connected")
    assert graph.contexts[0].domain_id == 11
    red.close()
    for wrong in ("red", "233", "011"):  # a zero before makes it octal for rcl
        monkeypatch.setenv("ROS_DOMAIN_ID", wrong)
        with pytest.raises(ValueError, match=rf"^ROS_DOMAIN_ID: expected a whole number from 0 to 232 .* '{wrong}'$"):
            Ros2()
    assert Ros2(domain_id=3).where == "ROS 2, domain 3"


def test_without_rclpy_it_says_what_to_do(monkeypatch: pytest.MonkeyPatch, heard: Ears) -> None:
    monkeypatch.setitem(sys.modules, "rclpy", None)
    with pytest.raises(FeedError, match=r"rclpy cannot be imported here .* feeds\.dds\(\) needs no ROS"):
        Ros2().open(heard)


# -- recording ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("offered", "asked"),
    [
        ([ReliabilityPolicy.RELIABLE], ReliabilityPolicy.RELIABLE),
        ([ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT], ReliabilityPolicy.BEST_EFFORT),
        ([ReliabilityPolicy.UNKNOWN], ReliabilityPolicy.BEST_EFFORT),
    ],
)
def test_recording_requests_lost_packets_again_if_each_publisher_can_repeat_them(
    ros2: Ros2, graph: Graph, offered: list[Any], asked: Any
) -> None:
    for reliability in offered:
        offer(graph, "/scan", SCAN, QoSProfile(depth=5, reliability=reliability))
    ros2.follow(frozenset({"/scan"}), frozenset({"/scan"}))
    wait_for(lambda: len(subscriptions(graph)) == 2, "the newest is asked for, and each")
    by_depth = {one.qos_profile.depth: one.qos_profile.reliability for one in subscriptions(graph)}
    assert by_depth == {5: ReliabilityPolicy.BEST_EFFORT, 1000: asked}


def test_each_message_of_a_burst_is_recorded_and_lost_ones_are_counted(graph: Graph, tmp_path: Path) -> None:
    publisher = offer(graph, "/scan", SCAN)

    def send(readings: list[float]) -> None:
        for reading in readings:
            message = get_message(SCAN)()
            message.range_max, message.angle_increment = 10.0, 0.01
            message.ranges = np.full(360, reading, np.float32)
            publisher.publish(message)
        if readings[0] == LAST:
            losing = [s for s in subscriptions(graph) if hasattr(s, "lost") and not s.lost.count]
            for subscription in losing:
                subscription.lost.count = 3

    recorded = record_bursts(Ros2(domain_id=7), tmp_path / "run.mcap", send)
    assert recorded.there == EVERY
    assert recorded.problems == ("/scan: 3 messages lost on the way, or came faster than they could be read",)
    assert recorded.shown < len(EVERY)

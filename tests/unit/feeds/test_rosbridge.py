from __future__ import annotations

import json
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import cbor2
import foxglove
import numpy as np
import pytest

from robowidgets import Validity
from robowidgets.feeds import rosbridge as rosbridge_feed
from robowidgets.feeds._rosbridge_frames import topic_of
from robowidgets.feeds.middleware import CLOSE_TIMEOUT, Advert, FeedError
from robowidgets.feeds.rosbridge import Rosbridge
from robowidgets.messages import to_scan

from ...reserved import free_port
from ..clocks import ManualClock
from ..waiting import wait_for
from .bridge import Rosbridge as Server
from .bursts import EVERY, record_bursts
from .ears import Ears

SCAN = "sensor_msgs/msg/LaserScan"
TWIST = "geometry_msgs/msg/Twist"
STAMPED = "geometry_msgs/msg/TwistStamped"


@pytest.fixture
def ears() -> Ears:
    return Ears()


@pytest.fixture
def in_json(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without cbor2, as if it were not installed."""
    monkeypatch.setitem(sys.modules, "cbor2", None)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Requests for topics follow each other quickly, but leave a busy machine time for the answers."""
    monkeypatch.setattr(sys.modules["robowidgets.feeds.rosbridge"], "_POLL", 0.3)


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers may take as long as a busy machine needs."""
    for limit in ("_websocket.SEND_TIMEOUT", "_websocket._GOODBYE", "_threaded.CLOSE_TIMEOUT"):
        monkeypatch.setattr(f"robowidgets.feeds.{limit}", 120.0)


def opened(address: str, ears: Ears, *topics: str) -> Rosbridge:
    middleware = Rosbridge(address)
    middleware.open(ears)
    middleware.follow(frozenset(topics))
    return middleware


def scan(*ranges: float) -> dict[str, Any]:
    limits = {"angle_min": -1.0, "angle_max": 1.0, "angle_increment": 0.5, "range_min": 0.1, "range_max": 10.0}
    header = {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "laser"}
    return {"header": header, **limits, "ranges": np.array(ranges, np.float32)}


def validities(message: Any) -> list[Validity]:
    return [Validity(kind) for kind in to_scan(message).validity]


def test_a_scan_in_cbor_keeps_nan_and_both_infinities(ears: Ears) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        server.publish("/scan", scan(1.5, np.nan, np.inf, -np.inf))
        wait_for(lambda: ears.messages, "it came")
        wait_for(lambda: ears.topics == [Advert("/scan", SCAN, True, None, ("/driver",))], "its publisher was reported")
        middleware.close()
        asked = server.heard_op("subscribe")[0]
    assert {name: asked[name] for name in ("topic", "queue_length", "throttle_rate", "compression")} == {
        "topic": "/scan",
        "queue_length": 1,
        "throttle_rate": 16,
        "compression": "cbor",
    }
    kinds = [Validity.READING, Validity.NO_MEASUREMENT, Validity.NOTHING_IN_RANGE, Validity.TOO_CLOSE]
    assert validities(ears.of("/scan")[0]) == kinds
    assert asked["type"] == SCAN
    assert ears.said == []


def test_in_json_null_is_not_a_measurement_and_what_it_hides_is_reported(ears: Ears, in_json: None) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        server.publish("/scan", scan(1.5, np.nan, np.inf))
        wait_for(lambda: ears.messages, "it came")
        server.publish("/scan", scan(1.5, 1.5, 1.5))
        wait_for(lambda: len(ears.messages) == 2, "the next came")
        middleware.close()
        assert server.subscribed["/scan"]["compression"] == "none"
    assert validities(ears.of("/scan")[0]) == [Validity.READING, Validity.NO_MEASUREMENT, Validity.NO_MEASUREMENT]
    assert ears.said == [
        "the robot sends null both for nothing in range and for no measurement: they cannot be distinguished; "
        "with cbor2 installed here they can"
    ]


def test_every_event_of_a_bumper_is_asked_for_and_handed_on(ears: Ears, quick: None) -> None:
    with Server({}) as server:
        middleware = opened(server.address, ears, "/bumper")
        wait_for(lambda: ears.topics == [], "there is no topic yet")
        server.topics = {"/bumper": "kobuki_msgs/BumperEvent"}
        wait_for(lambda: server.subscribed, "it was asked for")
        asked = server.subscribed["/bumper"]
        assert (asked["queue_length"], asked["throttle_rate"]) == (100, 0)
        for i in range(60):
            server.publish("/bumper", {"bumper": i % 3, "state": i % 2})
        wait_for(lambda: len(ears.messages) == 60, "all came")
        middleware.close()
    assert [message.bumper for message in ears.of("/bumper")] == 20 * [0, 1, 2]


def test_types_of_ros_1_are_reported_as_types_of_ros_2(ears: Ears) -> None:
    with Server({"/scan": "sensor_msgs/LaserScan"}) as server:
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics == [Advert("/scan", SCAN)], "it was reported")
        middleware.close()


def test_subscribers_and_publishers_are_reported_without_counting_the_bridge(ears: Ears, quick: None) -> None:
    with Server({"/cmd_vel": STAMPED, "/drive": TWIST, "/scan": SCAN}) as server:
        server.listeners["/cmd_vel"] = ["/base", "/rosbridge_websocket"]
        server.publishers = {"/cmd_vel": ["/teleop", "/r1/rosbridge_websocket", "/nav"], "/drive": [], "/scan": []}
        middleware = opened(server.address, ears, "/scan")
        told = [
            Advert("/cmd_vel", STAMPED, True, True, ("/nav", "/teleop"), ("/base",)),
            Advert("/drive", TWIST, False, False, (), ()),
            Advert("/scan", SCAN, False, None),
        ]
        wait_for(lambda: ears.topics == told, "it was reported")
        middleware.close()


def test_questions_are_asked_one_at_a_time_for_a_speed_waits_for_what_came_before(ears: Ears, quick: None) -> None:
    with Server({f"/drive_{i}": TWIST for i in range(5)}) as server:
        waiting: list[int] = []
        answer = server.on_call_service

        def count(client: Any, said: Any) -> None:
            waiting.append(len(server.heard_op("call_service")) - len(waiting))
            answer(client, said)

        server.on_call_service = count  # type: ignore[method-assign]
        middleware = opened(server.address, ears)
        wait_for(lambda: len(waiting) > 20, "it asked about all topics twice")
        middleware.close()
        assert set(waiting) == {1}


def test_while_all_nodes_are_asked_for_each_topic_has_its_turn_and_no_node_is_asked_about(
    ears: Ears, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.modules["robowidgets.feeds.rosbridge"], "_NODES_AT_ONCE", 2)
    names = [f"/topic_{i}" for i in range(5)]
    with Server(dict.fromkeys(names, SCAN)) as server:
        server.publishers = {name: [f"/from{name}"] for name in names}
        server.listeners = {name: [f"/to{name}", "/rosbridge_websocket"] for name in names}
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics == [Advert(name, SCAN) for name in names], "the topics are reported without nodes")
        middleware.ask_for_nodes(True)
        named = [Advert(name, SCAN, True, True, (f"/from{name}",), (f"/to{name}",)) for name in names]
        wait_for(lambda: ears.topics == named, "all nodes are reported")
        server.listeners["/topic_4"] = []
        wait_for(lambda: ears.topics and ears.topics[4].subscribers == (), "a change is reported in the next round")
        middleware.ask_for_nodes(False)
        wait_for(lambda: not middleware._requests, "what was asked is answered")
        services = [said["service"] for said in server.heard_op("call_service")]
        asked = services.count("/rosapi/publishers")
        wait_for(lambda: len(server.heard_op("call_service")) > len(services) + 1, "it goes on asking for topics")
        after = [said["service"] for said in server.heard_op("call_service")]
        assert after.count("/rosapi/publishers") == asked
        # Asked about a node that has just ended, rosapi of ROS 2 raises.
        assert set(after) == {"/rosapi/topics", "/rosapi/publishers", "/rosapi/subscribers"}
        middleware.close()


@pytest.mark.parametrize(
    "kind",
    ["nav_msgs/msg/Odometry", "geometry_msgs/msg/TwistWithCovariance", "sensor_msgs/msg/Imu", "my_msgs/msg/Unknown"],
)
def test_a_message_with_an_array_of_fixed_size_comes_though_cbor2_is_installed(kind: str, ears: Ears) -> None:
    with Server({"/odom": kind}) as server:
        middleware = opened(server.address, ears, "/odom")
        wait_for(lambda: server.subscribed, "it subscribed")
        server.publish("/odom", {"covariance": (0.0,) * 36})
        wait_for(lambda: ears.messages or server.log, "it came, or could not be sent")
        middleware.close()
    assert server.log == []
    assert len(ears.of("/odom")) == 1


@pytest.mark.parametrize("kinds", [(SCAN, TWIST), ("sensor_msgs/LaserScan", "geometry_msgs/Twist")])
def test_a_topic_may_come_after_it_was_connected_and_change_its_type(
    kinds: tuple[str, str], ears: Ears, quick: None
) -> None:
    with Server({}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: ears.topics == [], "no topic is there yet")
        server.topics = {"/scan": kinds[0]}
        wait_for(lambda: "/scan" in server.subscribed, "it subscribed")
        assert server.subscribed["/scan"]["type"] == kinds[0]
        server.publish("/scan", scan(1.0))
        wait_for(lambda: ears.messages, "a message came")
        server.topics = {"/scan": kinds[1]}
        wait_for(lambda: server.subscribed.get("/scan", {}).get("type") == kinds[1], "it subscribed again")
        assert server.heard_op("unsubscribe")[0]["topic"] == "/scan"
        wait_for(lambda: [topic.type for topic in ears.topics or ()] == [TWIST], "the new type was reported")
        middleware.close()
    assert ears.said == []


def test_without_rosapi_topics_are_heard_and_the_lack_is_reported(ears: Ears, quick: None) -> None:
    with Server({}, rosapi=False) as server:
        middleware = opened(server.address, ears, "/scan")
        words = "waiting for /scan; the list of topics is unknown, because the robot runs no rosapi"
        wait_for(lambda: words in ears.said, "it was reported")
        server.topics = {"/scan": SCAN}
        wait_for(lambda: "/scan" in server.subscribed, "it asked again until it was there")
        server.publish("/scan", scan(1.0))
        wait_for(lambda: ears.messages, "a message came")
        assert ears.troubles["/scan"] == ""
        assert ears.topics is None
        middleware.close()


def test_a_server_that_answers_no_question_is_one_without_rosapi(ears: Ears, quick: None) -> None:
    with Server({"/scan": SCAN}) as server:
        server.on_call_service = lambda *_: None  # type: ignore[method-assign]
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: "/scan" in server.subscribed, "it subscribed all the same")
        assert ears.said == ["waiting for /scan; the list of topics is unknown, because the robot runs no rosapi"]
        middleware.close()


def test_after_unsubscribing_nothing_is_asked_for_or_handed_on(ears: Ears) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        subscription = dict(server.subscribed)
        middleware.follow(frozenset())
        wait_for(lambda: not server.subscribed, "it unsubscribed")
        server.subscribed = subscription
        server.publish("/scan", scan(1.0))
        server.topics = {"/after": SCAN}
        middleware.follow(frozenset({"/after"}))
        wait_for(lambda: "/after" in server.subscribed, "it subscribed to another")
        server.publish("/after", scan(1.0))
        wait_for(lambda: ears.of("/after"), "what was sent later came")
        middleware.close()
    assert ears.of("/scan") == []


@pytest.mark.parametrize("binary", [False, True])
def test_a_message_of_100_mb_costs_its_topic_and_no_other(ears: Ears, binary: bool) -> None:
    with Server({"/scan": SCAN, "/huge": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan", "/huge")
        wait_for(lambda: len(server.subscribed) == 2, "it subscribed to both")
        for name in ("/scan", "/huge"):
            server.publish(name, scan(1.0))
        wait_for(lambda: len(ears.messages) == 2, "a message of each came")
        middleware.follow(frozenset({"/scan", "/huge"}), frozenset({"/huge"}))
        message = {"op": "publish", "topic": "/huge", "msg": {"data": "x" * 100_000_000}}
        server.send(cbor2.dumps(message) if binary else json.dumps(message))
        wait_for(lambda: "/huge" not in server.subscribed, "it listens to that topic no longer")
        server.publish("/scan", scan(2.0))
        wait_for(lambda: len(ears.messages) == 3, "the scan came again")
        middleware.close()
        assert server.opened == 1
    assert (ears.lost, ears.missed["/huge"]) == ([], 1)
    assert ears.troubles["/huge"] == "/huge sent a message of 100 MB, larger than 50 MB, and was unsubscribed"


def test_a_message_that_is_too_large_and_names_no_topic_is_skipped_in_words(ears: Ears) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        server.send(b"\0" * 60_000_000)
        wait_for(lambda: ears.said, "it is reported")
        assert ears.said == ["skipped a message of 60 MB, which is larger than 50 MB"]
        server.publish("/scan", scan(1.0))
        wait_for(lambda: ears.messages, "a scan came")
        middleware.close()
        assert (server.opened, ears.lost, ears.troubles["/scan"]) == (1, [], "")


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        ('{"op": "publish", "topic": "/scan", "msg": {"ranges": [1', "56 bytes came that are not JSON: "),
        (cbor2.dumps({"op": "publish", "topic": "/scan", "msg": {"a": 1}})[:-2], "30 bytes came that are not CBOR: "),
        ('{"op": "publish", "topic": "/scan", "msg": [1]}', "a message without fields came: [1]"),
        ('{"msg": "no", "topic": "/scan", "op": "publish"}', "a message without fields came: 'no'"),
        (
            json.dumps({"op": "fragment", "id": "1", "data": '{"op": "publish", "topic": "/scan", "m', "num": 0}),
            "/scan comes in fragments, which are not read: its messages are too large",
        ),
        ("no JSON", "does not speak rosbridge: 7 bytes came that are not JSON: "),
        ("[1]", "does not speak rosbridge: expected a rosbridge message, got [1]"),
    ],
)
def test_what_cannot_be_read_is_reported_until_something_can(frame: Any, words: str, ears: Ears) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        server.send(frame)
        wait_for(lambda: ears.said, "it was reported")
        assert words in ears.troubles["/scan"]
        server.publish("/scan", scan(1.0))
        wait_for(lambda: ears.messages, "a message came")
        assert ears.troubles["/scan"] == ""
        middleware.close()


HOSTILE = [
    "{}", '{"op": []}', '{"op": "publish"}', '{"op": "publish", "topic": []}', '{"op": "status", "level": "error"}',
    '{"op": "service_response"}',
    '{"op": "service_response", "service": "/rosapi/publishers", "values": {"publishers": 1}}',
    '{"op": "service_response", "service": "/rosapi/topics", "values": {"topics": [1, {}], "types": 3}}',
    '{"op": "fragment", "data": 3}', "[" * 5000, b"", b"\xa3\x62op\x67publish\x65topic\x79\xff\xff",
    b"\xa3\x62op\x67publish\x65topic\x61\xff", cbor2.dumps(cbor2.CBORTag(85, b"123")),
]  # fmt: skip


def test_a_server_that_says_odd_things_is_heard_no_less(ears: Ears) -> None:
    name = "/<script>alert(1)</script>"
    with Server({name: SCAN}) as server:
        middleware = opened(server.address, ears, name)
        wait_for(lambda: server.subscribed, "it subscribed")
        for said in HOSTILE:
            server.send(said)
        server.publish(name, scan(1.0))
        wait_for(lambda: ears.of(name), "the message came")
        middleware.close()
        assert server.opened == 1


def test_unrequested_binary_data_is_reported(ears: Ears, in_json: None) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        server.send(b"\xa0")
        words = "unrequested binary data came, and reading it needs cbor2"
        wait_for(lambda: words in ears.troubles.get("/scan", ""), "it was reported")
        middleware.close()


@pytest.mark.parametrize("name", ["/scan", "/" + "x" * 30, "/" + "x" * 300, "/mäß", '/a"b\\'])
def test_the_topic_of_a_message_is_known_from_its_start(name: str) -> None:
    said = {"op": "publish", "topic": name, "msg": {"topic": "/other"}}
    assert topic_of(json.dumps(said)) == name
    assert topic_of(json.dumps(said, separators=(",", ":"), ensure_ascii=False)) == name
    assert topic_of(cbor2.dumps(said)) == name


@pytest.mark.parametrize(
    ("types", "sent", "stamp"),
    [
        ({"/scan": SCAN}, STAMPED, {"sec": 1, "nanosec": 2}),
        ({"/scan": "sensor_msgs/LaserScan"}, "geometry_msgs/TwistStamped", {"secs": 1, "nsecs": 2}),
    ],
)
def test_a_speed_is_published_as_the_robots_ros_writes_it(
    types: dict[str, str], sent: str, stamp: dict[str, int], ears: Ears
) -> None:
    with Server(types) as server:
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics, "the topics were reported")
        speed = {"header": {"stamp": {"sec": 1, "nanosec": 2}}, "twist": {"linear": {"x": 0.25}}}
        middleware.publish("/cmd_vel", STAMPED, speed)
        middleware.close()  # messages published before are still sent
        wait_for(lambda: server.published, "it came")
    assert server.advertised == {"/cmd_vel": sent}
    assert server.published == [("/cmd_vel", {"header": {"stamp": stamp}, "twist": {"linear": {"x": 0.25}}})]


def test_a_speed_after_a_lost_connection_is_written_as_before(ears: Ears) -> None:
    with Server({"/scan": "sensor_msgs/LaserScan"}) as server:
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics, "the topics were reported")
        server.rosapi = False
        server.drop()
        wait_for(lambda: ears.connected == 2, "it is connected again")
        middleware.publish("/cmd_vel", TWIST, {})
        middleware.close()
    assert server.advertised == {"/cmd_vel": "geometry_msgs/Twist"}


def test_a_topic_that_rosbridge_cannot_publish_is_reported_though_it_reports_no_error(
    ears: Ears, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.modules["robowidgets.feeds.rosbridge"], "_ANSWERED", 0.3)
    with Server({"/scan": SCAN}) as server:
        server.missing = {"geometry_msgs"}
        server.publishers = {"/cmd_vel": ["/teleop"]}
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics, "the topics were reported")
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.25}})
        wait_for(lambda: len(server.log) >= 2, "it is refused, and so is its publisher")
        assert not any(said.get("op") == "status" for said in server.heard)
        server.publishers["/cmd_vel"] = []
        words = (
            "rosbridge does not publish /cmd_vel, so no speed arrives: is the package geometry_msgs installed on the "
            "robot, and the topic a geometry_msgs/msg/Twist? The log of rosbridge says why"
        )
        wait_for(lambda: ears.unheard.get("/cmd_vel") == words, "it is reported")
        server.advertised["/cmd_vel"] = TWIST
        wait_for(lambda: ears.unheard["/cmd_vel"] == "", "it is mended")
        middleware.close()


@pytest.mark.parametrize("bridge", ["/rosbridge_websocket", "/robot/bridge_of_another_name"])
def test_a_topic_that_rosbridge_publishes_is_not_a_problem_whatever_its_name(
    bridge: str, ears: Ears, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.modules["robowidgets.feeds.rosbridge"], "_ANSWERED", 0.3)
    with Server({"/cmd_vel": TWIST}) as server:
        server.publishers = {"/cmd_vel": ["/teleop"]}
        server.publishers_of = lambda topic: [
            *server.publishers.get(topic, ()),
            *([bridge] if server.advertised else []),
        ]
        middleware = opened(server.address, ears)
        wait_for(lambda: middleware._publishers, "the publishers were reported")
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.25}})
        wait_for(lambda: ears.unheard.get("/cmd_vel") == "", "it is looked at")
        asked = len(server.heard_op("call_service"))
        wait_for(lambda: len(server.heard_op("call_service")) > asked + 8, "more than once")
        assert ears.unheard == {"/cmd_vel": ""}
        middleware.close()


IMAGE, INFO, OWN = "sensor_msgs/msg/Image", "sensor_msgs/CameraInfo", "my_msgs/msg/Own"


@pytest.mark.parametrize("cbor", [True, False])
def test_raw_messages_are_objects_with_arrays_as_in_every_middleware(
    cbor: bool, ears: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not cbor:
        monkeypatch.setitem(sys.modules, "cbor2", None)
    with Server({"/scan": SCAN, "/image": IMAGE, "/own": OWN}) as server:
        middleware = opened(server.address, ears, "/scan", "/image", "/own")
        wait_for(lambda: len(server.subscribed) == 3, "it subscribed")
        server.publish("/scan", scan(1.5, np.nan, 2.0))
        header = {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "camera"}
        said = {"header": header, "height": 1, "width": 3, "encoding": "mono8", "is_bigendian": 0, "step": 3}
        server.send({"op": "publish", "topic": "/image", "msg": {**said, "data": "AAEC"}})
        own = {"inner": {"numbers": [1, None, 2.5], "words": ["a"], "count": [1, 2], "on": [True]}, "void": []}
        server.send({"op": "publish", "topic": "/own", "msg": own})
        wait_for(lambda: len(ears.messages) == 3, "all came")
        middleware.close()
    (scanned,), (image,), (own_message,) = (ears.of(name) for name in ("/scan", "/image", "/own"))
    assert (scanned.header.stamp.sec, scanned.header.stamp.nanosec, scanned.header.frame_id) == (1, 2, "laser")
    np.testing.assert_array_equal(scanned.ranges, np.array([1.5, np.nan, 2.0], np.float32))
    assert (scanned.ranges.dtype, scanned.__msgtype__) == (np.float32, SCAN)
    assert (image.data.dtype, image.data.tolist(), image.step) == (np.uint8, [0, 1, 2], 3)
    # Only the field names of a type that no package here defines are kept.
    np.testing.assert_array_equal(own_message.inner.numbers, [1.0, np.nan, 2.5])
    assert own_message.inner.count.tolist() == [1, 2]
    assert (own_message.inner.words, own_message.inner.on, own_message.void) == (["a"], [True], [])


def test_raw_messages_of_ros_1_have_its_fields_and_the_stamps_of_all(ears: Ears, quick: None) -> None:
    with Server({"/info": INFO}) as server:
        middleware = opened(server.address, ears, "/info")
        wait_for(lambda: server.subscribed, "it subscribed")
        header = {"seq": 7, "stamp": {"secs": 3, "nsecs": 4}, "frame_id": "camera"}
        server.publish("/info", {"header": header, "height": 2, "K": [1.0] * 9})
        wait_for(lambda: ears.messages, "it came")
        middleware.close()
    (info,) = ears.of("/info")
    assert (info.header.seq, info.header.stamp.sec, info.header.stamp.nanosec, info.height) == (7, 3, 4, 2)
    assert (info.K.dtype, info.K.tolist()) == (np.float64, [1.0] * 9)


@pytest.mark.usefixtures("patient")
def test_without_a_connection_publishing_is_an_error_and_nothing_is_kept(ears: Ears) -> None:
    port = free_port()
    middleware = Rosbridge(f"ws://127.0.0.1:{port}")
    words = f"not connected to ws://127.0.0.1:{port}"
    with pytest.raises(FeedError, match=words):
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 1.0}})
    middleware.open(ears)
    with pytest.raises(FeedError, match=words):
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 2.0}})
    with Server({"/scan": SCAN}, port) as server:
        wait_for(lambda: ears.connected, "it is connected")
        middleware.publish("/cmd_vel", TWIST, {})
        middleware.close()
    assert server.published == 2 * [("/cmd_vel", {})]  # the first zero of a new publisher is repeated


@pytest.mark.usefixtures("patient")
def test_closing_waits_until_the_robot_has_processed_a_zero_for_it_drops_its_queue_then(ears: Ears) -> None:
    with Server({"/scan": SCAN}, delay=0.02) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: ears.topics, "the topics were reported")
        for speed in (0.1, 0.2, 0.3, 0.0):
            middleware.publish("/cmd_vel", TWIST, {"linear": {"x": speed}})
        middleware.close()
        assert [message["linear"]["x"] for _, message in server.published] == [0.1, 0.2, 0.3, 0.0, 0.0]
    assert _threads() == []


def test_closing_a_connection_that_published_nothing_asks_the_robot_nothing(ears: Ears) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics, "the topics were reported")
        middleware.close()
        wait_for(lambda: not server.clients, "the connection ended")
    assert server.log == []


def test_to_a_robot_that_falls_silent_publishing_a_zero_is_an_error_that_says_so(ears: Ears) -> None:
    clock, errors = ManualClock(), []
    zero = {"header": {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "base"}, "twist": {"linear": {"x": 0.0}}}

    def publish() -> None:
        try:
            middleware.publish("/cmd_vel", STAMPED, zero)
        except TimeoutError as error:
            errors.append(str(error))

    with Server({"/cmd_vel": STAMPED}) as server:
        middleware = Rosbridge(server.address, clock)
        middleware.open(ears)
        wait_for(lambda: ears.topics, "the topics were reported")
        publish()
        go_on = server.stall()
        publishing = clock.beside(publish)
        clock.advance(0.5)
        publishing.join()
        assert errors == [f"{server.address} has not answered for 0.5 s"]
        go_on()
        publish()
        assert len(errors) == 1
        wait_for(lambda: len(server.published) == 4, "all came, and the first was repeated")
        closing = clock.beside(middleware.close)
        clock.advance(CLOSE_TIMEOUT)
        closing.join()
    assert server.published == 4 * [("/cmd_vel", zero)]


def test_closing_takes_half_a_second_where_the_robot_answers_no_question(ears: Ears) -> None:
    clock = ManualClock()
    with Server({"/scan": SCAN}) as server:
        middleware = Rosbridge(server.address, clock)
        middleware.open(ears)
        wait_for(lambda: ears.topics, "the topics were reported")
        server.on_call_service = lambda *_: None  # type: ignore[method-assign]
        middleware.publish("/cmd_vel", TWIST, {})
        closing = clock.beside(middleware.close)
        clock.advance(0.499)
        assert closing.is_alive()
        wait_for(lambda: server.published == 2 * [("/cmd_vel", {})], "both came")
        clock.advance(0.001)
        closing.join()
        assert _threads() == []


@pytest.mark.slow
@pytest.mark.parametrize("end", ["feed.close()", ""])
def test_a_process_that_ends_while_it_drives_stops_the_robot(end: str) -> None:
    with Server({"/cmd_vel": TWIST}, delay=0.01) as server:
        server.listeners["/cmd_vel"] = ["/base"]
        script = (
            "from robowidgets import feeds\n"
            f"feed = feeds.rosbridge({server.address!r})\n"
            "while not feed.topics: pass\n"
            "for i in range(10): feed.drive(0.25)\n" + end
        )
        subprocess.run([sys.executable, "-c", script], check=True)
        speeds = [message["linear"]["x"] for _, message in server.published]
    assert (speeds[0], speeds[-1]) == (0.25, 0.0)


def test_a_feed_of_it_shows_its_topics() -> None:
    with Server({"/scan": SCAN}) as server, rosbridge_feed(server.address) as feed:
        wait_for(lambda: feed.topics, "the topics were reported")
        assert [(topic.name, topic.widget) for topic in feed.topics] == [("/scan", "laser")]


def _threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name.startswith("robowidgets ws")]


def test_a_foxglove_server_at_the_port_is_refused_with_a_hint(ears: Ears) -> None:
    server = foxglove.start_server(host="127.0.0.1", port=0, context=foxglove.Context())
    address = f"ws://127.0.0.1:{server.port}"
    middleware = Rosbridge(address)
    middleware.open(ears)
    wait_for(lambda: ears.lost, "it is reported")
    middleware.close()
    server.stop()
    assert ears.lost[0].startswith(f"{address} cannot be connected to: HTTP 4")
    assert ears.lost[0].endswith(f"; if it is a foxglove server, use feeds.foxglove({address!r})")


def test_each_message_of_a_burst_is_recorded_though_a_widget_asked_for_fewer(tmp_path: Path, quick: None) -> None:
    with Server({"/scan": SCAN}) as server:

        def send(readings: list[float]) -> None:
            asked = [1000] if readings[0] else [1, 1000]
            wait_for(lambda: server.subscribed.get("/scan", {}).get("queue_length") in asked, "it subscribed")
            for reading in readings:
                server.publish("/scan", scan(*[reading] * 360))

        recorded = record_bursts(Rosbridge(server.address), tmp_path / "run.mcap", send)
        asked = [(said["throttle_rate"], said["queue_length"]) for said in server.heard_op("subscribe")]
        wait_for(lambda: server.log == [] and not server.clients, "it has left")
    assert (recorded.there, recorded.problems) == (EVERY, ())
    assert recorded.shown < len(EVERY)
    assert asked[:2] == [(16, 1), (0, 1000)], "the same subscription is changed, and back after the recording"
    assert asked[2:] in ([], [(16, 1)])

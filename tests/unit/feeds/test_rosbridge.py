from __future__ import annotations

import json
import sys
from typing import Any

import cbor2
import numpy as np
import pytest

from robowidgets import Validity
from robowidgets.feeds import rosbridge as rosbridge_feed
from robowidgets.feeds._rosbridge_frames import topic_of
from robowidgets.feeds.middleware import Advert, FeedError
from robowidgets.feeds.rosbridge import Rosbridge
from robowidgets.messages import to_scan

from ..waiting import wait_for
from .bridge import Rosbridge as Server
from .ears import Ears
from .servers import free_port

SCAN = "sensor_msgs/msg/LaserScan"
TWIST = "geometry_msgs/msg/Twist"
STAMPED = "geometry_msgs/msg/TwistStamped"


@pytest.fixture
def ears() -> Ears:
    return Ears()


@pytest.fixture
def in_json(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where cbor2 is not installed."""
    monkeypatch.setitem(sys.modules, "cbor2", None)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Questions for topics follow each other quickly."""
    monkeypatch.setattr(sys.modules["robowidgets.feeds.rosbridge"], "_POLL", 0.02)


def opened(address: str, ears: Ears, *topics: str) -> Rosbridge:
    middleware = Rosbridge(address)
    middleware.open(ears)
    for topic in topics:
        middleware.subscribe(topic)
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
    assert ears.said == []
    assert ears.topics == [Advert("/scan", SCAN, True, None)]


def test_in_json_null_is_no_measurement_and_what_it_hides_is_told(ears: Ears, in_json: None) -> None:
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
        "the robot sends null for nothing in range as for no measurement: they cannot be told apart; "
        "with cbor2 installed here they can"
    ]


def test_every_event_of_a_bumper_is_asked_for_and_handed_on(ears: Ears, quick: None) -> None:
    with Server({}) as server:
        middleware = opened(server.address, ears, "/bumper")
        wait_for(lambda: server.heard_op("subscribe"), "it was asked for before anybody knew its type")
        server.topics = {"/bumper": "kobuki_msgs/BumperEvent"}
        wait_for(lambda: server.subscribed.get("/bumper", {}).get("queue_length") == 100, "it was asked for again")
        assert server.subscribed["/bumper"]["throttle_rate"] == 0
        for i in range(60):
            server.publish("/bumper", {"bumper": i % 3, "state": i % 2})
        wait_for(lambda: len(ears.messages) == 60, "all came")
        middleware.close()
    assert [message["bumper"] for message in ears.of("/bumper")] == 20 * [0, 1, 2]


def test_types_of_ros_1_are_told_as_those_of_ros_2(ears: Ears) -> None:
    with Server({"/scan": "sensor_msgs/LaserScan"}) as server:
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics == [Advert("/scan", SCAN)], "it was told")
        middleware.close()


def test_who_listens_and_who_publishes_is_told_without_counting_the_bridge(ears: Ears, quick: None) -> None:
    with Server({"/cmd_vel": STAMPED, "/drive": TWIST, "/scan": SCAN}) as server:
        server.listeners["/cmd_vel"] = ["/base", "/rosbridge_websocket"]
        server.silent = {"/scan"}
        middleware = opened(server.address, ears, "/scan")
        told = [
            Advert("/cmd_vel", STAMPED, True, True),
            Advert("/drive", TWIST, True, False),
            Advert("/scan", SCAN, False, None),
        ]
        wait_for(lambda: ears.topics == told, "it was told")
        middleware.close()


def test_a_topic_may_come_later_and_change_its_type(ears: Ears, quick: None) -> None:
    with Server({}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: ears.topics == [], "there is none yet")
        wait_for(lambda: server.heard_op("subscribe"), "it was asked for all the same")
        server.topics = {"/scan": SCAN}
        wait_for(lambda: "/scan" in server.subscribed, "it subscribed again")
        server.publish("/scan", scan(1.0))
        wait_for(lambda: ears.messages, "a message came")
        old = server.subscribed["/scan"]
        server.topics = {"/scan": TWIST}
        wait_for(lambda: server.subscribed.get("/scan", old) is not old, "it subscribed anew")
        assert server.heard_op("unsubscribe")[0]["topic"] == "/scan"
        wait_for(lambda: [topic.type for topic in ears.topics or ()] == [TWIST], "the new type was told")
        middleware.close()
    assert ears.said == []


def test_without_rosapi_topics_are_heard_and_the_lack_is_told(ears: Ears, quick: None) -> None:
    with Server({}, rosapi=False) as server:
        middleware = opened(server.address, ears, "/scan")
        words = "waiting for /scan; which topics there are cannot be told: the robot runs no rosapi"
        wait_for(lambda: words in ears.said, "it was told")
        server.topics = {"/scan": SCAN}
        wait_for(lambda: "/scan" in server.subscribed, "it asked again until it was there")
        server.publish("/scan", scan(1.0))
        wait_for(lambda: ears.messages, "a message came")
        assert ears.troubles["/scan"] == ""
        assert ears.topics is None
        middleware.close()


def test_what_rosbridge_says_of_a_subscription_is_told_of_its_topic(ears: Ears) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan", "/other")
        wait_for(lambda: ears.topics, "the topics were told")
        said = {"op": "status", "level": "error", "msg": "subscribe: no\nsuch type", "id": "subscribe:/scan"}
        server.send({**said, "level": "warning", "msg": "slow"})
        server.send(said)
        wait_for(lambda: ears.said, "it was told")
        middleware.close()
    assert ears.troubles == {"/scan": "the robot's bridge says: subscribe: no such type"}


def test_after_unsubscribing_nothing_is_asked_for_or_handed_on(ears: Ears) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        subscription = dict(server.subscribed)
        middleware.unsubscribe("/scan")
        wait_for(lambda: not server.subscribed, "it unsubscribed")
        server.subscribed = subscription
        server.publish("/scan", scan(1.0))
        server.topics = {"/after": SCAN}
        middleware.subscribe("/after")
        wait_for(lambda: "/after" in server.subscribed, "it subscribed to another")
        server.publish("/after", scan(1.0))
        wait_for(lambda: ears.of("/after"), "what was sent later came")
        middleware.close()
    assert ears.of("/scan") == []


def test_a_killed_bridge_is_found_again_when_it_is_back(ears: Ears) -> None:
    port = free_port()
    middleware = opened(f"ws://127.0.0.1:{port}", ears, "/scan")
    for times in (1, 2):
        with Server({"/scan": SCAN}, port) as server:
            wait_for(lambda: server.subscribed, "it subscribed")
            server.publish("/scan", scan(1.0))
            wait_for(lambda: len(ears.messages) == times, "a message came")  # noqa: B023
    middleware.close()
    assert ears.connected == 2


def test_a_message_of_100_mb_costs_its_topic_and_no_other(ears: Ears) -> None:
    with Server({"/scan": SCAN, "/huge": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan", "/huge")
        wait_for(lambda: len(server.subscribed) == 2, "it subscribed to both")
        server.publish("/scan", scan(1.0))
        wait_for(lambda: ears.messages, "the scan came")
        server.subscribed.clear()
        server.send(b"\0" * 100_000_000)
        wait_for(lambda: server.opened == 2 and server.subscribed, "it came back")
        server.publish("/scan", scan(2.0))
        wait_for(lambda: len(ears.messages) == 2, "the scan came again")
        middleware.close()
        assert set(server.subscribed) == {"/scan"}
    assert ears.lost == ["a message larger than 50 MB came"]
    assert ears.troubles["/huge"] == "/huge sent a message larger than 50 MB: it is not listened to"


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        ('{"op": "publish", "topic": "/scan", "msg": {"ranges": [1', "56 bytes came that are no JSON: "),
        (cbor2.dumps({"op": "publish", "topic": "/scan", "msg": {"a": 1}})[:-2], "30 bytes came that are no CBOR: "),
        ('{"op": "publish", "topic": "/scan", "msg": [1]}', "a message without fields came: [1]"),
        ('{"msg": "no", "topic": "/scan", "op": "publish"}', "a message without fields came: 'no'"),
        (
            json.dumps({"op": "fragment", "id": "1", "data": '{"op": "publish", "topic": "/scan", "m', "num": 0}),
            "/scan comes in fragments, which are not read: its messages are too large",
        ),
        ("no JSON", "does not speak rosbridge: 7 bytes came that are no JSON: "),
        ("[1]", "does not speak rosbridge: no rosbridge message came but [1]"),
    ],
)
def test_what_cannot_be_read_is_told_until_something_can(frame: Any, words: str, ears: Ears) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        server.send(frame)
        wait_for(lambda: ears.said, "it was told")
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


def test_binary_data_that_nobody_asked_for_is_told(ears: Ears, in_json: None) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        server.send(b"\xa0")
        words = "binary data came, which nobody asked for and needs cbor2 to be read"
        wait_for(lambda: words in ears.troubles.get("/scan", ""), "it was told")
        middleware.close()


@pytest.mark.parametrize("name", ["/scan", "/" + "x" * 30, "/" + "x" * 300, "/mäß", '/a"b\\'])
def test_the_topic_of_a_message_is_told_by_its_start(name: str) -> None:
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
        wait_for(lambda: ears.topics, "the topics were told")
        speed = {"header": {"stamp": {"sec": 1, "nanosec": 2}}, "twist": {"linear": {"x": 0.25}}}
        middleware.publish("/cmd_vel", STAMPED, speed)
        middleware.close()  # what was published before is still sent
        wait_for(lambda: server.published, "it came")
    assert server.advertised == {"/cmd_vel": sent}
    assert server.published == [("/cmd_vel", {"header": {"stamp": stamp}, "twist": {"linear": {"x": 0.25}}})]


def test_a_speed_after_a_lost_connection_is_written_as_before(ears: Ears) -> None:
    with Server({"/scan": "sensor_msgs/LaserScan"}) as server:
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics, "the topics were told")
        server.rosapi = False
        ears.on_connected = lambda: middleware.publish("/cmd_vel", TWIST, {})  # type: ignore[method-assign]
        server.drop()
        wait_for(lambda: server.advertised, "a speed went out as soon as it could")
        middleware.close()
    assert server.advertised == {"/cmd_vel": "geometry_msgs/Twist"}


def test_what_json_cannot_say_is_not_published(ears: Ears) -> None:
    with Server({"/scan": SCAN}) as server:
        middleware = Rosbridge(server.address)
        middleware.publish("/cmd_vel", TWIST, {"linear": np.nan})  # there is no connection yet: nothing happens
        middleware.open(ears)
        wait_for(lambda: ears.topics, "the topics were told")
        words = r"\{'linear': nan\} cannot be sent as a geometry_msgs/msg/Twist in JSON: Out of range float"
        with pytest.raises(FeedError, match=words):
            middleware.publish("/cmd_vel", TWIST, {"linear": float("nan")})
        middleware.close()


def test_a_feed_of_it_shows_what_is_there() -> None:
    with Server({"/scan": SCAN}) as server, rosbridge_feed(server.address) as feed:
        wait_for(lambda: feed.topics, "the topics were told")
        assert [(topic.name, topic.widget) for topic in feed.topics] == [("/scan", "laser")]

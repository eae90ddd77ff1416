from __future__ import annotations

import json
import os
import signal
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import foxglove
import numpy as np
import pytest
from foxglove.websocket import Capability, ConnectionGraph, ServerListener

from robowidgets import LaserWidget, feeds
from robowidgets.feeds import _bridge, _websocket
from robowidgets.feeds.foxglove import Foxglove
from robowidgets.feeds.middleware import Advert, FeedError

from ...reserved import free_port
from ..waiting import wait_for
from .bridge import Rosbridge
from .bursts import EVERY, record_bursts
from .ears import Ears
from .fox import NOETIC, SCAN, OldFoxglove, cdr, channel, definition, scan

foxglove.set_log_level("CRITICAL")
TWIST = "geometry_msgs/msg/Twist"


@pytest.fixture
def ears() -> Ears:
    return Ears()


class Real:
    """The server of foxglove-sdk, with a channel like foxglove_bridge offers."""

    def __init__(self, port: int = 0, **more: Any) -> None:
        self.context = foxglove.Context()
        self.server = foxglove.start_server(host="127.0.0.1", port=port, context=self.context, **more)
        self.address = f"ws://127.0.0.1:{self.server.port}"
        self.scan = self.channel("/scan", SCAN, definition())

    def channel(self, topic: str, kind: str, text: str, encoding: str = "cdr") -> foxglove.Channel:
        schema = foxglove.Schema(name=kind, encoding="ros2msg", data=text.encode())
        return foxglove.Channel(topic, schema=schema, message_encoding=encoding, context=self.context)


@pytest.fixture
def real() -> Iterator[Real]:
    made = Real()
    yield made
    made.server.stop()


def opened(address: str, ears: Ears, *topics: str) -> Foxglove:
    middleware = Foxglove(address)
    middleware.open(ears)
    middleware.follow(frozenset(topics))
    return middleware


def log_until(server: Real, ears: Ears, payload: bytes, topic: str = "/scan") -> Any:
    """Log until a message of a topic comes: the server does not report when it has registered a subscription."""
    before = len(ears.of(topic))

    def came() -> bool:
        server.scan.log(payload)
        return len(ears.of(topic)) > before

    wait_for(came, f"a message of {topic} came")
    return ears.of(topic)[-1]


def test_a_topic_that_is_followed_as_soon_as_it_appears_is_subscribed_to_when_the_server_has_settled() -> None:
    class Timed(OldFoxglove):
        at: float

        def on_said(self, client: Any, said: Any) -> None:
            self.at = time.monotonic()
            super().on_said(client, said)

    class Follower(Ears):
        def on_topics(self, topics: Any) -> None:
            super().on_topics(topics)
            middleware.follow(frozenset(topic.name for topic in topics))

    with Timed([]) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears := Follower())
        wait_for(lambda: ears.connected, "it is connected")
        advertised = time.monotonic()
        server.send({"op": "advertise", "channels": [channel(1)]})
        wait_for(lambda: server.subscribed, "it subscribed")
        middleware.close()
    assert list(server.subscribed) == [1]
    assert server.at - advertised >= 0.05, "the SDK's server loses a subscription that comes at once"


def test_a_scan_of_the_real_server_arrives_as_it_was_sent(real: Real, ears: Ears) -> None:
    middleware = opened(real.address, ears, "/scan")
    try:
        message = log_until(real, ears, cdr(1040, 2.5))
        laser = LaserWidget()
        laser.update(message)
        assert laser.scan is not None
        assert (len(laser.scan), float(laser.scan.ranges[7])) == (1040, 2.5)
        assert ears.topics == [Advert("/scan", SCAN)]
        assert middleware.where == real.address
    finally:
        middleware.close()


def test_the_older_subprotocol_is_spoken_too(ears: Ears) -> None:
    with OldFoxglove([channel(7)]) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: 7 in server.subscribed, "it subscribed")
        server.log(7, cdr())
        wait_for(lambda: ears.messages, "a message came")
        middleware.close()
        assert server.offered == ["foxglove.sdk.v1", "foxglove.websocket.v1"]


def test_messages_of_ros_1_and_of_json_are_read(ears: Ears) -> None:
    one = channel(1, kind="sensor_msgs/LaserScan", encoding="ros1", schema=definition(store=NOETIC, version=1))
    two = channel(2, "/json", kind="sensor_msgs/LaserScan", encoding="json", schema="{}")
    with OldFoxglove([one, two]) as server:
        middleware = opened(server.address, ears, "/scan", "/json")
        wait_for(lambda: len(server.subscribed) == 2, "it subscribed")
        server.log(1, bytes(NOETIC.serialize_ros1(scan(NOETIC, 4), SCAN)))
        server.log(2, b'{"ranges": [1.0]}')
        wait_for(lambda: len(ears.messages) == 2, "both came")
        middleware.close()
    assert len(ears.of("/scan")[0].ranges) == 4
    assert [(one.ranges.tolist(), one.header.frame_id) for one in ears.of("/json")] == [([1.0], "")]
    assert ears.topics == [Advert("/scan", SCAN), Advert("/json", SCAN)]


def test_a_server_without_topics_says_so(ears: Ears) -> None:
    with OldFoxglove([]) as server:
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics == [], "no topic is there")
        middleware.close()


def test_publishers_and_subscribers_are_reported_without_counting_the_bridge(ears: Ears) -> None:
    real = Real(capabilities=[Capability.ConnectionGraph])
    middleware = opened(real.address, ears)
    try:
        graph = ConnectionGraph()
        graph.set_published_topic("/scan", ["/lidar", "/r1/foxglove_bridge"])
        graph.set_subscribed_topic("/scan", ["/foxglove_bridge"])
        graph.set_subscribed_topic("/cmd_vel", ["/base"])
        told = [
            Advert("/scan", SCAN, True, False, ("/lidar",), ()),
            Advert("/cmd_vel", "", False, True, (), ("/base",)),
        ]
        wait_for(lambda: real.server.publish_connection_graph(graph) or ears.topics == told, "it was reported")
    finally:
        middleware.close()
        real.server.stop()


def test_a_killed_robot_is_found_again_when_it_is_back(ears: Ears) -> None:
    port = free_port()
    script = (
        "import sys, time, foxglove\n"
        "foxglove.start_server(host='127.0.0.1', port=int(sys.argv[1]))\n"
        "s = foxglove.Schema(name='std_msgs/msg/Bool', encoding='ros2msg', data=b'bool data')\n"
        "c = foxglove.Channel('/bump', schema=s, message_encoding='cdr')\n"
        "while True: c.log(bytes([0, 1, 0, 0, 1])); time.sleep(0.02)\n"
    )

    def start() -> subprocess.Popen[bytes]:
        return subprocess.Popen([sys.executable, "-c", script, str(port)], stderr=subprocess.DEVNULL)

    robot = start()
    middleware = opened(f"ws://127.0.0.1:{port}", ears, "/bump")
    try:
        wait_for(lambda: ears.messages, "a message came")
        os.kill(robot.pid, signal.SIGKILL)
        robot.wait()
        lost = len(ears.lost)
        wait_for(lambda: len(ears.lost) > lost, "it was lost")
        robot = start()
        count = len(ears.messages)
        wait_for(lambda: len(ears.messages) > count, "messages came again")
        assert ears.connected == 2
        assert ears.of("/bump")[-1].data is True
    finally:
        middleware.close()
        robot.kill()
        robot.wait()


def test_a_refused_connection_is_reported_and_tried_again_ever_more_rarely(ears: Ears) -> None:
    address = f"ws://127.0.0.1:{free_port()}"
    middleware = opened(address, ears)
    wait_for(lambda: len(ears.lost) == 2, "it was tried twice")
    middleware.close()
    assert ears.lost[0] == (
        f"nothing listens at {address}; is the robot's bridge running, and the port right? The usual ports are 8765 "
        "for foxglove_bridge and 9090 for rosbridge"
    )
    assert ears.pauses[0] < ears.pauses[1]
    assert ears.connected == 0


def test_a_truncated_message_is_reported_until_a_whole_one_comes(real: Real, ears: Ears) -> None:
    middleware = opened(real.address, ears, "/scan")
    try:
        wait_for(lambda: real.scan.log(cdr()[:40]) or ears.troubles.get("/scan"), "the trouble was reported")
        assert ears.troubles["/scan"].startswith(
            f"a message of /scan cannot be read: 40 bytes are not a valid {SCAN}: "
        )
        log_until(real, ears, cdr())
        assert ears.troubles["/scan"] == ""
    finally:
        middleware.close()


@pytest.mark.parametrize(
    ("offer", "words"),
    [
        (
            {"kind": "foxglove.LaserScan", "encoding": "protobuf"},
            "/scan comes as foxglove.LaserScan in protobuf, which cannot be read; foxglove_bridge sends "
            "cdr, ros1 or json",
        ),
        (
            {"kind": "", "encoding": "", "schemaEncoding": ""},
            "/scan comes without a type: the robot's bridge lacks the package of its messages",
        ),
        (
            {"kind": "my_msgs/msg/<b>Odd</b>", "schema": "no definition"},
            "/scan comes as my_msgs/msg/<b>Odd</b>, which is not a known type, and the server does not define it in a "
            "way that can be understood; add its .msg files with robowidgets.messages.add_definitions(folder)",
        ),
    ],
)
def test_what_cannot_be_read_is_not_asked_for_and_named(offer: dict[str, str], words: str, ears: Ears) -> None:
    with OldFoxglove([channel(1, **offer)]) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: ears.troubles.get("/scan"), "it was reported")
        middleware.close()
        assert ears.troubles["/scan"] == words
        assert server.subscribed == {}


def test_invalid_json_and_json_without_an_object_are_named(ears: Ears) -> None:
    with OldFoxglove([channel(1, encoding="json")]) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        server.log(1, b"{")
        wait_for(lambda: "that are not JSON: " in ears.troubles.get("/scan", ""), "it was reported")
        server.log(1, b"[1]")
        wait_for(lambda: "expected a JSON object, got '[1]'" in ears.troubles["/scan"], "it was reported, too")
        middleware.close()


def test_two_publishers_on_one_topic_are_both_heard(ears: Ears) -> None:
    with OldFoxglove([channel(1), channel(2)]) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: len(server.subscribed) == 2, "it subscribed to both")
        server.log(1, cdr(5))
        wait_for(lambda: len(ears.messages) == 1, "the first came")
        server.log(2, cdr(9))
        wait_for(lambda: len(ears.messages) == 2, "the second came")
        middleware.close()
    assert [len(message.ranges) for message in ears.of("/scan")] == [5, 9]
    assert ears.topics == [Advert("/scan", SCAN)]


def test_two_types_on_one_topic_are_reported_as_two(ears: Ears) -> None:
    with OldFoxglove([channel(1), channel(2, kind=TWIST)]) as server:
        middleware = opened(server.address, ears)
        told = [Advert("/scan", SCAN), Advert("/scan", TWIST)]
        wait_for(lambda: ears.topics == told, "both were reported")
        middleware.close()


def test_a_message_of_100_mb_costs_its_topic_and_no_other(ears: Ears) -> None:
    with OldFoxglove([channel(1), channel(2, "/huge")]) as server:
        middleware = opened(server.address, ears, "/scan", "/huge")
        wait_for(lambda: len(server.subscribed) == 2, "it subscribed to both")
        server.log(1, cdr())
        server.log(2, cdr())
        wait_for(lambda: len(ears.messages) == 2, "a message of each came")
        server.send(struct.pack("<BIQ", 1, server.subscribed[2], 0) + bytes(100_000_000))
        wait_for(lambda: set(server.subscribed) == {1}, "it listens to that topic no longer")
        server.log(1, cdr())
        wait_for(lambda: len(ears.messages) == 3, "the scan came again")
        middleware.close()
        assert server.opened == 1
    assert ears.lost == []
    assert ears.troubles["/huge"] == "/huge sent a message of 100 MB, larger than 50 MB, and was unsubscribed"


def test_what_piled_up_is_not_read_but_the_newest(ears: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_websocket, "_OVERDUE", 60.0)
    with OldFoxglove([channel(1)]) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        first, go_on = threading.Event(), threading.Event()

        def stall(*_: object) -> None:
            first.set()
            go_on.wait(120)

        ears.then = stall
        server.log(1, cdr(distance=1.0))
        assert first.wait(120)
        for i in range(50):
            server.log(1, cdr(distance=2.0 + i))
        sent = threading.Event()
        server.loop.call_soon_threadsafe(sent.set)
        assert sent.wait(120)
        go_on.set()
        wait_for(lambda: float(ears.messages[-1][1].ranges[0]) == 51.0, "the newest came")
        middleware.close()
    assert len(ears.messages) < 20
    assert ears.came["/scan"] == 51, "replaced messages are counted"


@pytest.mark.parametrize(
    ("text", "is_told"),
    [
        ("Failed to create publisher: package 'geometry_msgs' not found", True),
        ("client cannot advertise /cmd_vel", True),
        ("Failed to publish on /other", True),
        ("Failed to subscribe to /scan", False),
    ],
)
def test_a_publisher_that_the_bridge_cannot_make_is_reported(text: str, is_told: bool, ears: Ears) -> None:
    info = {"capabilities": ["clientPublish"], "supportedEncodings": ["json"]}
    with OldFoxglove([channel(1)], **info) as server:
        middleware = opened(server.address, ears, "/scan")
        wait_for(lambda: server.subscribed, "it subscribed")
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.25}})
        server.send({"op": "status", "level": 2, "message": text})
        server.log(1, cdr())
        wait_for(lambda: ears.messages, "what follows came")
        middleware.close()
    assert ears.unheard.get("/cmd_vel", "") == (f"the robot's bridge reports: {text}" if is_told else "")


class Taken(ServerListener):
    def __init__(self) -> None:
        self.channels: list[Any] = []
        self.payloads: list[bytes] = []

    def on_client_advertise(self, _client: Any, channel: Any) -> None:
        self.channels.append((channel.topic, channel.encoding, channel.schema_name))

    def on_message_data(self, _client: Any, _channel_id: int, data: bytes) -> None:
        self.payloads.append(data)


@pytest.mark.parametrize("encoding", ["cdr", "ros1", "json"])
def test_a_speed_is_published_in_what_the_robot_takes(encoding: str, ears: Ears) -> None:
    taken = Taken()
    real = Real(capabilities=[Capability.ClientPublish], supported_encodings=["?", encoding], server_listener=taken)
    middleware = opened(real.address, ears)
    try:
        wait_for(lambda: ears.topics, "the topics were reported")
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.25}})
        middleware.close()
        wait_for(lambda: taken.payloads, "it came")
    finally:
        middleware.close()
        real.server.stop()
    kind = TWIST if encoding != "ros1" else "geometry_msgs/Twist"
    assert taken.channels == [("/cmd_vel", encoding, kind)]
    doubles = np.array([0.25, 0, 0, 0, 0, 0]).tobytes()
    lead = {"cdr": b"\0\1\0\0", "ros1": b""}
    assert taken.payloads == [b'{"linear": {"x": 0.25}}' if encoding == "json" else lead[encoding] + doubles]


def test_a_widget_of_a_user_s_class_whose_update_hangs_holds_back_neither_speed_nor_zero() -> None:
    entered, gate = threading.Event(), threading.Event()

    class Slow(LaserWidget):
        def update(self, message: Any) -> None:
            entered.set()
            assert gate.wait(120)
            super().update(message)

    def speeds() -> list[float]:
        return [float(np.frombuffer(payload[4:])[0]) for payload in taken.payloads]

    taken, laser = Taken(), Slow()
    real = Real(capabilities=[Capability.ClientPublish], supported_encodings=["cdr"], server_listener=taken)
    try:
        with feeds.foxglove(real.address) as feed:
            feed.connect("/scan", laser)
            wait_for(lambda: real.scan.log(cdr()) or entered.is_set(), "it hangs")
            feed.drive(0.25)
            wait_for(lambda: speeds() == [0.25, 0.0], "the speed came, and the zero of its hold")
            feed.drive(0.25)
            feed.stop()
            wait_for(lambda: speeds()[-2:] == [0.25, 0.0], "stop came")
            gate.set()
            wait_for(lambda: laser.scan, "it shows the scan")
            assert laser.title == "/scan"
            feed.disconnect("/scan", laser)
            assert feed.functions == ()
    finally:
        gate.set()
        real.server.stop()


@pytest.mark.usefixtures("kernel_sends")
def test_zero_follows_a_speed_that_is_sent_after_it_was_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    frame_on, told = Foxglove._frame_on, threading.Event()

    def slowly(self: Foxglove, key: tuple[str, str, str], payload: bytes, *, is_zero: bool) -> bytes:
        monkeypatch.setattr(Foxglove, "_frame_on", frame_on)
        assert told.wait(120)  # as when a busy program leaves no time for it
        return frame_on(self, key, payload, is_zero=is_zero)

    with (
        OldFoxglove([channel(1)], capabilities=["clientPublish"], supportedEncodings=["json"]) as server,
        feeds.foxglove(server.address) as feed,
    ):
        wait_for(lambda: feed.topics, "the topics are known")
        feed.driving = feeds.Driving(hold=60.0)
        monkeypatch.setattr(Foxglove, "_frame_on", slowly)
        with pytest.raises(FeedError, match="cannot drive: "):
            feed.drive(0.25)
        told.set()
        wait_for(lambda: sum(isinstance(said, bytes) for said in server.heard) > 1, "the speed and zero came")
        speeds = [json.loads(said[5:])["linear"]["x"] for said in server.heard if isinstance(said, bytes)]
        assert speeds == [0.25, 0.0]


@pytest.mark.usefixtures("kernel_sends")
def test_a_robot_that_was_lost_while_it_drove_is_stopped_though_its_server_takes_time_to_introduce_itself() -> None:
    class Slow(OldFoxglove):
        def on_open(self, client: Any) -> None:
            if self.opened == 1:
                super().on_open(client)

    info = {"capabilities": ["clientPublish"], "supportedEncodings": ["json"]}
    with Slow([channel(1)], **info) as server, feeds.foxglove(server.address) as feed:
        feed.drive(0.25)
        wait_for(lambda: _speeds(server) == [0.25], "the speed came")
        server.drop()
        wait_for(lambda: server.opened == 2, "it is called again")
        server.send({"op": "status", "level": 0, "message": "soon"})
        assert feed.status
        server.send(server.info)
        wait_for(lambda: _speeds(server)[1:] == [0.0], "zero came")
        assert not feed.status


def _speeds(server: OldFoxglove) -> list[float]:
    return [json.loads(said[5:])["linear"]["x"] for said in server.heard if isinstance(said, bytes)]


@pytest.mark.parametrize(
    ("info", "words"),
    [
        (
            {},
            "accepts no messages: its server does not offer clientPublish; foxglove_bridge offers it if its parameter",
        ),
        (
            {"capabilities": ["clientPublish"]},
            "accepts messages in no encoding, but robowidgets writes only cdr, ros1 and json",
        ),
    ],
)
def test_a_robot_that_takes_no_messages_is_an_error(info: dict[str, Any], words: str, ears: Ears) -> None:
    with OldFoxglove([channel(1)], **info) as server:
        middleware = opened(server.address, ears)
        wait_for(lambda: ears.topics, "the topics were reported")
        with pytest.raises(FeedError, match=words):
            middleware.publish("/cmd_vel", TWIST, {})
        middleware.close()


def test_without_a_connection_publishing_is_an_error(ears: Ears) -> None:
    address = f"ws://127.0.0.1:{free_port()}"
    middleware = opened(address, ears)
    with pytest.raises(FeedError, match=f"not connected to {address}"):
        middleware.publish("/cmd_vel", TWIST, {})
    middleware.close()


HOSTILE = [
    "no JSON", "[]", "3", '{"op": 7}', '{"op": "advertise"}', '{"op": "advertise", "channels": [1, {}, {"id": "x"}]}',
    '{"op": "advertise", "channels": [{"id": 3, "topic": 4, "encoding": []}]}',
    '{"op": "unadvertise", "channelIds": 3}',
    '{"op": "unadvertise", "channelIds": [{}, "1", 99]}',
    '{"op": "connectionGraphUpdate", "publishedTopics": [[], {}]}',
    '{"op": "connectionGraphUpdate", "removedTopics": [[], 1]}', '{"op": "serverInfo", "capabilities": {"a": 1}}',
    '{"op": "status", "level": 2, "message": 5}', "[" * 5000, b"", b"\1", b"\2" * 9, b"\1" + b"\xff" * 12,
]  # fmt: skip


def test_a_server_that_says_odd_things_is_heard_no_less(ears: Ears) -> None:
    name = "/<script>alert(1)</script>"
    with OldFoxglove([channel(1), channel(2, name)]) as server:
        middleware = opened(server.address, ears, "/scan", name)
        wait_for(lambda: len(server.subscribed) == 2, "it subscribed")
        for said in HOSTILE:
            server.send(said)
        server.log(2, cdr())
        wait_for(lambda: ears.of(name), "the message came")
        middleware.close()
        assert server.opened == 1
    assert f"{server.address} does not speak foxglove: it sent 'no JSON'" in ears.said


def test_a_message_of_the_robot_about_a_topic_is_reported_for_that_topic(ears: Ears) -> None:
    with OldFoxglove([channel(1), channel(2, "/scan_2")]) as server:
        middleware = opened(server.address, ears, "/scan", "/scan_2")
        wait_for(lambda: len(server.subscribed) == 2, "it subscribed")
        server.send({"op": "status", "level": 1, "message": "/scan is slow"})
        server.send({"op": "status", "level": 2, "message": "no\npublisher of /scan_2"})
        wait_for(lambda: ears.said, "it was reported")
        middleware.close()
    assert ears.troubles == {"/scan_2": "the robot's bridge reports: no publisher of /scan_2"}


def test_every_event_of_a_bumper_is_handed_on(ears: Ears) -> None:
    bumper = channel(1, "/bumper", kind="kobuki_ros_interfaces/msg/BumperEvent", encoding="json", schema="{}")
    with OldFoxglove([bumper]) as server:
        middleware = opened(server.address, ears, "/bumper")
        wait_for(lambda: server.subscribed, "it subscribed")
        for i in range(60):
            server.log(1, json.dumps({"bumper": i % 3, "state": i % 2}).encode())
        wait_for(lambda: len(ears.messages) == 60, "all came")
        middleware.close()
    assert [message.bumper for message in ears.of("/bumper")] == 20 * [0, 1, 2]


def test_a_rosbridge_at_the_port_is_refused_with_a_hint(ears: Ears) -> None:
    with Rosbridge({}) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: ears.lost, "it is reported")
        middleware.close()
    assert ears.lost[0].endswith(f"; if it is a rosbridge, use feeds.rosbridge({server.address!r})")


def test_each_message_of_a_burst_is_recorded_and_the_newest_are_shown(real: Real, tmp_path: Path) -> None:
    def send(readings: list[float]) -> None:
        for reading in readings:
            real.scan.log(cdr(360, reading))

    recorded = record_bursts(Foxglove(real.address), tmp_path / "run.mcap", send)
    assert (recorded.there, recorded.problems) == (EVERY, ())
    assert recorded.shown < len(EVERY)


def test_what_does_not_fit_into_the_queue_is_counted_and_the_rest_comes_in_order(
    ears: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_bridge, "MOST_UNREAD", 10)
    monkeypatch.setattr(_websocket, "_OVERDUE", 20.0)
    with OldFoxglove([channel(1)]) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        middleware.follow(frozenset({"/scan"}), frozenset({"/scan"}))
        wait_for(lambda: server.subscribed, "it subscribed")
        frames = [struct.pack("<BIQ", 1, server.subscribed[1], 0) + cdr(distance=float(i)) for i in range(50)]
        # In the loop of the connection: they pile up before it decodes them.
        middleware._socket.call_soon(lambda: [middleware.on_frame(frame) for frame in frames] and middleware.deliver())
        wait_for(lambda: ears.messages, "the newest came")
        middleware.close()
    assert [float(message.ranges[0]) for _, message in (*ears.replaced, *ears.messages)] == list(range(40, 50))
    assert (len(ears.messages), ears.missed) == (1, {"/scan": 40})

"""Any robot that runs rosbridge, over its websocket.

Protocol: https://github.com/RobotWebTools/rosbridge_suite/blob/ros2/ROSBRIDGE_PROTOCOL.md
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Mapping
from typing import Any

from ..kinds import counts_every_message
from ._bridge import Bridge, UnreadableError, full_type, is_zero, other_nodes, short_type, strings, to_json
from ._rosbridge_frames import has_cbor, read, topic_of
from ._websocket import Frame, one_line
from .feed import Feed
from .middleware import EVENTS, Advert

_POLL = 3.0
"""Seconds between two questions for the topics."""

_THROTTLE_MS = 16
_DRIVEN = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
_SUBSCRIBE = "subscribe:"
_OURS = "rosbridge_websocket"
_TOPICS, _PUBLISHERS, _SUBSCRIBERS = "/rosapi/topics", "/rosapi/publishers", "/rosapi/subscribers"
_CLOSING = "/robowidgets/closing"  # no such service: that is what the robot answers, and logs
_IN_CBOR = frozenset(
    (
        *("sensor_msgs/msg/LaserScan", "sensor_msgs/msg/Range", "sensor_msgs/msg/PointCloud2"),
        *("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "nav_msgs/msg/OccupancyGrid"),
    )
)
"""Types that gain by CBOR: infinity has a meaning, or the messages are large. Not all types come in CBOR: most servers
cannot encode an array of fixed size, which any covariance is, and then send nothing."""
_ONLY_NULL = "the robot sends null for nothing in range as for no measurement: they cannot be told apart"


class Rosbridge(Bridge):
    """A `Middleware` that speaks to a rosbridge server, in CBOR where cbor2 is installed.

    Raises:
        TypeError, ValueError: the address is not one.
    """

    def __init__(self, address: str = "ws://127.0.0.1:9090") -> None:
        self._has_cbor = has_cbor()
        self._reactions = {
            "publish": self._on_publish,
            "service_response": self._on_response,
            "fragment": self._on_fragment,
        }
        self._is_ros1 = False  # known for good: a speed may go out before a new connection tells it again
        super().__init__(address)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""
        fields = _ros1_stamps(message) if self._is_ros1 else message
        frame = to_json(message_type, message, {"op": "publish", "topic": topic, "msg": fields})

        def advertised() -> str:
            if (topic, message_type) not in self._advertised:
                self._advertised.add((topic, message_type))
                kind = self._as_written(message_type)
                self._write({"op": "advertise", "id": f"advertise:{topic}", "topic": topic, "type": kind})
            return frame

        self._line.publish(advertised, confirm=is_zero(message))

    async def finish(self) -> None:
        """See `Talk`."""
        # A server drops what it has not processed when the connection ends. It answers in order.
        if self._advertised:
            self._questions.clear()
            self._call(_CLOSING)
            await self._finished.wait()

    def on_frame(self, frame: Frame) -> None:
        """See `Talk`."""
        topic = topic_of(frame)
        if topic is not None:
            self._take(topic, frame)
            return
        try:
            said = read(frame)
        except UnreadableError as error:
            self._trouble_all(f"{self.where} does not speak rosbridge: {error}")
            return
        react = self._reactions.get(str(said.get("op")))
        if react is not None:
            react(said)

    def _take(self, topic: str, frame: Frame | dict[str, Any]) -> None:
        if topic in self._wanted:
            self._keep(topic, self._types.get(topic, ""), _message, frame)

    def _about(self, topic: str, message: Any) -> str:
        ranges = message.get("ranges")
        if isinstance(ranges, list) and None in ranges:
            self._with_null.add(topic)
        if topic not in self._with_null:
            return ""
        return _ONLY_NULL + ("" if self._has_cbor else "; with cbor2 installed here they can")

    def on_open(self) -> None:
        """See `Talk`."""
        super().on_open()
        self._listener.on_connected()
        self._poll()

    def _begin(self) -> None:
        self._types: dict[str, str] = {}
        self._nodes: dict[tuple[str, str], tuple[str, ...]] = {}
        self._subscribed_as: dict[str, str] = {}
        self._with_null: set[str] = set()
        self._advertised: set[tuple[str, str]] = set()
        self._questions: deque[tuple[str, str]] = deque()
        """Services to call, and about which topics; the first one is called."""
        self._is_answered = True
        self._has_no_rosapi = False
        self._finished = asyncio.Event()

    def _poll(self) -> None:
        if self._questions and not self._is_answered:  # nobody answered in all that time
            self._questions.clear()
            self._without_rosapi()
        if not self._questions:
            self._call(_TOPICS)
        self._is_answered = False
        self._line.later(_POLL, self._poll)

    def _call(self, service: str, topic: str = "") -> None:
        # One at a time: a server may process all in one thread, in which a speed waits for what came before it.
        if (service, topic) not in self._questions:
            self._questions.append((service, topic))
            if len(self._questions) == 1:
                self._call_first()

    def _call_first(self) -> None:
        service, topic = self._questions[0]
        self._write({"op": "call_service", "service": service, "id": topic, "args": {"topic": topic} if topic else {}})

    def _start(self, topic: str) -> None:
        kind = self._types.get(topic, "")
        if not kind and not self._has_no_rosapi:
            self._call(_TOPICS)  # without its type, a server never begins with a topic that is not there yet
            return
        self._subscribed_as[topic] = kind
        queue, throttle = (EVENTS, 0) if counts_every_message(kind) else (1, _THROTTLE_MS)
        compression = "cbor" if self._has_cbor and kind in _IN_CBOR else "none"
        how = {"queue_length": queue, "throttle_rate": throttle, "compression": compression}
        if kind:
            how["type"] = self._as_written(kind)
        self._write({"op": "subscribe", "id": _SUBSCRIBE + topic, "topic": topic, **how})
        if kind:
            self._call(_PUBLISHERS, topic)

    def _stop(self, topic: str) -> None:
        self._subscribed_as.pop(topic, None)
        self._write({"op": "unsubscribe", "id": _SUBSCRIBE + topic, "topic": topic})

    def _on_publish(self, said: dict[str, Any]) -> None:
        self._take(str(said.get("topic")), said)

    def _on_fragment(self, said: dict[str, Any]) -> None:
        topic = topic_of(str(said.get("data")))  # the first of them says it
        if topic in self._wanted:
            self._trouble(str(topic), f"{topic} comes in fragments, which are not read: its messages are too large")

    def _on_response(self, said: dict[str, Any]) -> None:
        service, topic, values = said.get("service"), str(said.get("id")), said.get("values")
        if service == _CLOSING:
            self._finished.set()
            return
        if self._questions and self._questions[0] == (service, topic):
            self._is_answered = True
            self._questions.popleft()
            if self._questions:
                self._call_first()
        if service == _TOPICS:
            if said.get("result") is False or not isinstance(values, dict):
                self._without_rosapi()
            else:
                self._on_topics(dict(zip(strings(values.get("topics")), strings(values.get("types")), strict=False)))
        elif isinstance(values, dict) and service in (_PUBLISHERS, _SUBSCRIBERS):
            nodes = strings(values.get(str(service).rpartition("/")[2]))
            self._nodes[str(service), topic] = other_nodes(nodes, _OURS)
            self._tell_topics()

    def _on_topics(self, types: dict[str, str]) -> None:
        if self._has_no_rosapi:
            self._has_no_rosapi = False
            for topic in self._wanted - self._heard:
                self._trouble(topic, "")
        self._is_ros1 = bool(types) and not any("/msg/" in kind for kind in types.values())
        self._types = {name: full_type(kind) for name, kind in types.items()}
        self._tell_topics()
        for topic, kind in self._types.items():
            if kind in _DRIVEN:
                self._call(_SUBSCRIBERS, topic)
            if kind in _DRIVEN or topic in self._wanted:
                self._call(_PUBLISHERS, topic)
            if topic in self._wanted and self._subscribed_as.get(topic) != kind:
                if topic in self._subscribed_as:  # else the server would wait for messages of the old type for ever
                    self._stop(topic)
                self._start(topic)

    def _as_written(self, kind: str) -> str:
        return short_type(kind) if self._is_ros1 else kind

    def _tell_topics(self) -> None:
        adverts = []
        for name, kind in self._types.items():
            publishers, subscribers = (self._nodes.get((service, name)) for service in (_PUBLISHERS, _SUBSCRIBERS))
            wanted = None if subscribers is None else bool(subscribers)
            adverts.append(Advert(name, kind, publishers is None or bool(publishers), wanted, publishers or ()))
        self._tell(adverts)

    def _without_rosapi(self) -> None:
        self._has_no_rosapi = True
        for topic in self._wanted - self._heard:
            self._start(topic)  # again and again, for the topic may be there by now
            self._trouble(
                topic, f"waiting for {topic}; which topics there are cannot be told: the robot runs no rosapi"
            )


def _message(frame: Frame | dict[str, Any]) -> Any:
    said = frame if isinstance(frame, dict) else read(frame)
    message = said.get("msg")
    if not isinstance(message, dict):
        raise UnreadableError(f"a message without fields came: {one_line(repr(message)[:80])}")
    return message


def _ros1_stamps(value: Any) -> Any:
    """A message with its times as ROS 1 writes them."""
    if not isinstance(value, Mapping):
        return value
    if value.keys() == {"sec", "nanosec"}:
        return {"secs": value["sec"], "nsecs": value["nanosec"]}
    return {name: _ros1_stamps(field) for name, field in value.items()}


def rosbridge(address: str = "ws://127.0.0.1:9090") -> Feed:
    """A feed of a robot that runs rosbridge_server, of ROS 1 or ROS 2. It needs tornado, and is better with cbor2.

    Args:
        address: where rosbridge listens: ``ws://``, or ``wss://`` for an encrypted connection.

    Raises:
        TypeError, ValueError: the address is not one.
        FeedError: tornado is not installed.
    """
    return Feed(Rosbridge(address))

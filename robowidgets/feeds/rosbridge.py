"""Robots that run rosbridge, over its websocket.

Protocol: https://github.com/RobotWebTools/rosbridge_suite/blob/ros2/ROSBRIDGE_PROTOCOL.md
"""

from __future__ import annotations

import asyncio
import json
from collections import deque
from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from ..messages.channel import full_type
from ..messages.twist import TWIST, TWIST_STAMPED
from ..runtime.clock import Clock
from ._bridge import Bridge, UnreadableError, other_nodes, short_type, strings
from ._rosbridge_frames import has_cbor, read, topic_of
from ._twist import is_zero
from ._websocket import Frame, one_line
from .middleware import EVENTS, MOST_UNREAD, Advert, Outlet

if TYPE_CHECKING:
    from .feed import Feed

_POLL = 3.0
"""Seconds between two requests for the topics."""

_NODES_AT_ONCE = 16
"""The largest number of topics whose nodes are requested after each request for topics, if all nodes are wanted."""

_THROTTLE_MS = 16
_SUBSCRIBE = "subscribe:"
_OURS = "rosbridge_websocket"
_TOPICS, _PUBLISHERS, _SUBSCRIBERS = "/rosapi/topics", "/rosapi/publishers", "/rosapi/subscribers"
_ANSWERED = 3.0
"""Seconds after which rosapi must name the bridge as a publisher of a topic that we advertised."""

_CLOSING = "/robowidgets/closing"  # this service does not exist: the robot answers so, and logs it
_IN_CBOR = frozenset(
    (
        *("sensor_msgs/msg/LaserScan", "sensor_msgs/msg/Range", "sensor_msgs/msg/PointCloud2"),
        *("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "nav_msgs/msg/OccupancyGrid"),
    )
)
"""Types that are requested in CBOR, because infinity has a meaning or the messages are large. Other types are not: most
servers cannot encode an array of fixed size, such as any covariance, and then send nothing."""
_ONLY_NULL = "the robot sends null both for nothing in range and for no measurement: they cannot be distinguished"


class Rosbridge(Bridge):
    """A `Middleware` with a connection to a rosbridge server, in CBOR if cbor2 is installed.

    Raises:
        TypeError, ValueError: the address is invalid.
    """

    def __init__(self, address: str = "ws://127.0.0.1:9090", clock: Clock | None = None) -> None:
        self._has_cbor = has_cbor()
        self._reactions = {
            "publish": self._on_publish,
            "service_response": self._on_response,
            "fragment": self._on_fragment,
        }
        self._is_ros1 = False  # kept across connections: a speed may be sent before a new connection lists the types
        super().__init__(address, clock=clock)

    @property
    def outlet(self) -> Outlet:
        """See `HasOutlet`."""
        return Outlet("rosbridge", {"address": self._address})

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""
        fields = _ros1_stamps(message) if self._is_ros1 else message
        frame = json.dumps({"op": "publish", "topic": topic, "msg": fields})
        key, zero = (topic, message_type), is_zero(message)

        def advertised() -> str:
            if key not in self._advertised:
                self._advertised.add(key)
                self._advertised_at[topic] = self._clock.now(), message_type, self._publishers.get(topic)
                self._later(_ANSWERED, lambda: self._call(_PUBLISHERS, topic))
                kind = self._as_written(message_type)
                self._write({"op": "advertise", "id": f"advertise:{topic}", "topic": topic, "type": kind})
                self._await_match(key)
            self._note_sent(key, frame, is_zero=zero)
            return frame

        self._publish(topic, advertised, confirm=zero)

    def ask_for_nodes(self, wanted: bool) -> None:
        """See `Middleware`."""
        super().ask_for_nodes(wanted)
        if wanted and self._socket is not None:
            self._socket.call_soon(self._ask_about_some)

    async def finish(self) -> None:
        """See `Bridge`."""
        await super().finish()
        # When the connection ends, a server drops unprocessed messages. It answers in order, so await an answer.
        if self._advertised:
            self._requests.clear()
            self._call(_CLOSING)
            await self._finished.wait()

    def on_frame(self, frame: Frame) -> None:
        """See `Bridge`."""
        topic = topic_of(frame)
        if topic is not None:
            self._take(topic, frame)
            return
        try:
            operation = read(frame)
        except UnreadableError as error:
            self._report_on_all(f"{self.where} does not speak rosbridge: {error}")
            return
        react = self._reactions.get(str(operation.get("op")))
        if react is not None:
            react(operation)

    def _topic_of_start(self, start: bytes) -> str:
        return topic_of(start) or topic_of(start.decode(errors="ignore")) or ""

    def _take(self, topic: str, frame: Frame | dict[str, Any]) -> None:
        if topic in self._followed:
            kind = self._types.get(topic, "")
            self._keep(topic, kind, partial(self._read, topic, kind), frame)

    def _read(self, topic: str, kind: str, frame: Frame | dict[str, Any]) -> Any:
        fields = _fields(frame)
        ranges = fields.get("ranges")
        if isinstance(ranges, list) and None in ranges:
            self._with_null.add(topic)
        from ..messages.encoding import as_message  # Imported lazily: a guard reads no topic.

        return as_message("ros1" if self._is_ros1 else "cdr", kind, fields)

    def _flaw(self, topic: str, message: Any) -> str:  # noqa: ARG002
        if topic not in self._with_null:
            return ""
        return _ONLY_NULL + ("" if self._has_cbor else "; with cbor2 installed here they can")

    def on_open(self) -> None:
        """See `Bridge`."""
        super().on_open()
        self._listener.on_connected()
        self._poll()

    @property
    def hint(self) -> str:
        """See `BridgeCalls`."""
        return f"if it is a foxglove server, use feeds.foxglove({self.where!r})"

    def _begin(self) -> None:
        self._types: dict[str, str] = {}
        self._nodes: dict[tuple[str, str], tuple[str, ...]] = {}
        self._asked_about: deque[str] = deque()
        """The topics whose nodes must still be requested in this round of all topics."""
        self._subscribed_as: dict[str, str] = {}
        self._with_null: set[str] = set()
        self._advertised: set[tuple[str, str]] = set()
        self._advertised_at: dict[str, tuple[float, str, tuple[str, ...] | None]] = {}
        """By topic that we advertised: the time, the type, and the publishers before, if they were known."""
        self._publishers: dict[str, tuple[str, ...]] = {}
        """The publishers of topics, including the bridge."""
        self._requests: deque[tuple[str, str]] = deque()
        """The services to call, each with its topic. The call of the first one is running."""
        self._is_answered = True
        self._has_no_rosapi = False
        self._finished = asyncio.Event()

    def _poll(self) -> None:
        if self._requests and not self._is_answered:  # since the last poll
            self._requests.clear()
            self._without_rosapi()
        if not self._requests:
            self._call(_TOPICS)
        self._is_answered = False
        self._later(_POLL, self._poll)

    def _call(self, service: str, topic: str = "") -> None:
        # One at a time: a server may process all messages in one thread, and a speed would wait for earlier messages.
        if (service, topic) not in self._requests:
            self._requests.append((service, topic))
            if len(self._requests) == 1:
                self._call_first()

    def _call_first(self) -> None:
        service, topic = self._requests[0]
        self._write({"op": "call_service", "service": service, "id": topic, "args": {"topic": topic} if topic else {}})

    def _start(self, topic: str) -> None:
        kind = self._types.get(topic, "")
        if not kind and not self._has_no_rosapi:
            self._call(_TOPICS)  # without a type, a server never starts a subscription to a topic that appears later
            return
        from ..kinds import counts_every_message  # Imported lazily: a guard subscribes to nothing.

        self._subscribed_as[topic] = kind
        queue, throttle = (EVENTS, 0) if counts_every_message(kind) else (1, _THROTTLE_MS)
        if topic in self._all_of:
            queue, throttle = MOST_UNREAD, 0
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

    def _change_share(self, topic: str) -> None:
        if topic in self._subscribed_as:
            self._start(topic)  # the same id changes the subscription, and the server may send one message twice

    def _on_publish(self, operation: dict[str, Any]) -> None:
        self._take(str(operation.get("topic")), operation)

    def _on_fragment(self, operation: dict[str, Any]) -> None:
        topic = topic_of(str(operation.get("data")))  # only the first fragment contains it
        if topic in self._followed:
            self._listener.on_trouble(
                str(topic), f"{topic} comes in fragments, which are not read: its messages are too large"
            )

    def _on_response(self, operation: dict[str, Any]) -> None:
        service, topic, values = operation.get("service"), str(operation.get("id")), operation.get("values")
        if service == _CLOSING:
            self._finished.set()
            return
        if self._requests and self._requests[0] == (service, topic):
            self._is_answered = True
            self._requests.popleft()
            if self._requests:
                self._call_first()
        if service == _TOPICS:
            if operation.get("result") is False or not isinstance(values, dict):
                self._without_rosapi()
            else:
                self._on_topics(dict(zip(strings(values.get("topics")), strings(values.get("types")), strict=False)))
        elif isinstance(values, dict) and service in (_PUBLISHERS, _SUBSCRIBERS):
            nodes = strings(values.get(str(service).rpartition("/")[2]))
            if service == _PUBLISHERS:
                self._publishers[topic] = tuple(nodes)
                self._report_refused(topic, nodes)
            self._nodes[str(service), topic] = other_nodes(nodes, _OURS)
            self._report_topics()

    def _report_refused(self, topic: str, nodes: list[str]) -> None:
        """Report a topic that we advertised if the bridge does not publish it. The bridge reports no error for it."""
        if topic not in self._advertised_at:
            return
        at, kind, before = self._advertised_at[topic]
        is_there = any(node.rpartition("/")[2].startswith(_OURS) for node in nodes)
        # The node of the bridge may have another name.
        if is_there or set(nodes) - set(nodes if before is None else before):
            self._listener.on_unheard(topic, "")
        elif self._clock.now() - at >= _ANSWERED:
            package = kind.partition("/")[0]
            self._listener.on_unheard(
                topic,
                f"rosbridge does not publish {topic}, so no speed arrives: is the package {package} installed on the "
                f"robot, and the topic a {self._as_written(kind)}? The log of rosbridge says why",
            )

    def _on_topics(self, types: dict[str, str]) -> None:
        if self._has_no_rosapi:
            self._has_no_rosapi = False
            for topic in self._followed - self._received:
                self._listener.on_trouble(topic, "")
        self._is_ros1 = bool(types) and not any("/msg/" in kind for kind in types.values())
        self._types = {name: full_type(kind) for name, kind in types.items()}
        self._report_topics()
        for topic, kind in self._types.items():
            if kind in (TWIST, TWIST_STAMPED):
                self._call(_SUBSCRIBERS, topic)
            if kind in (TWIST, TWIST_STAMPED) or topic in self._followed:
                self._call(_PUBLISHERS, topic)
            if topic in self._followed and self._subscribed_as.get(topic) != kind:
                if topic in self._subscribed_as:  # otherwise the server would wait for the old type forever
                    self._stop(topic)
                self._start(topic)
        for topic in self._advertised_at:
            self._call(_PUBLISHERS, topic)
        if self._asks_for_nodes:
            self._ask_about_some()

    def _ask_about_some(self) -> None:
        """Request the publishers and subscribers of some topics: new topics first, then all others in turn.

        It does not use ``/rosapi/node_details``, which needs fewer requests: with ROS 2, a request for a node that has
        just ended raises an error in rosapi, which may end.
        """
        new = [topic for topic in self._types if (_SUBSCRIBERS, topic) not in self._nodes]
        if not self._asked_about:
            self._asked_about.extend(self._types)
        turn = [self._asked_about.popleft() for _ in range(min(_NODES_AT_ONCE, len(self._asked_about)))]
        for topic in [*new, *(topic for topic in turn if topic in self._types and topic not in new)][:_NODES_AT_ONCE]:
            self._call(_PUBLISHERS, topic)
            self._call(_SUBSCRIBERS, topic)

    def _as_written(self, kind: str) -> str:
        return short_type(kind) if self._is_ros1 else kind

    def _report_topics(self) -> None:
        adverts = []
        for name, kind in self._types.items():
            publishers, subscribers = (self._nodes.get((service, name)) for service in (_PUBLISHERS, _SUBSCRIBERS))
            wanted = None if subscribers is None else bool(subscribers)
            offered = publishers is None or bool(publishers)
            adverts.append(Advert(name, kind, offered, wanted, publishers or (), subscribers))
        self._listener.on_topics(adverts)

    def _without_rosapi(self) -> None:
        self._has_no_rosapi = True
        for topic in self._followed - self._received:
            self._start(topic)  # repeatedly, because the topic may exist now
            self._listener.on_trouble(
                topic, f"waiting for {topic}; the list of topics is unknown, because the robot runs no rosapi"
            )


def _fields(frame: Frame | dict[str, Any]) -> dict[str, Any]:
    operation = frame if isinstance(frame, dict) else read(frame)
    message = operation.get("msg")
    if not isinstance(message, dict):
        raise UnreadableError(f"a message without fields came: {one_line(repr(message)[:80])}")
    return message


def _ros1_stamps(value: Any) -> Any:
    """Return a message with its times in the spelling of ROS 1."""
    if not isinstance(value, Mapping):
        return value
    if value.keys() == {"sec", "nanosec"}:
        return {"secs": value["sec"], "nsecs": value["nanosec"]}
    return {name: _ros1_stamps(field) for name, field in value.items()}


def rosbridge(address: str = "ws://127.0.0.1:9090") -> Feed:
    """Open a feed of a robot that runs rosbridge_server, of ROS 1 or ROS 2. It needs tornado and is faster with cbor2.

    Args:
        address: the address of rosbridge: ``ws://``, or ``wss://`` for an encrypted connection.

    Raises:
        TypeError, ValueError: the address is invalid.
        FeedError: tornado is not installed.
    """
    from .feed import Feed  # a guard imports only the middleware

    return Feed(Rosbridge(address))

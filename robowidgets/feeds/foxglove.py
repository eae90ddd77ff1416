"""Robots that run foxglove_bridge, over its websocket.

Protocol: https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from functools import partial
from struct import Struct
from typing import TYPE_CHECKING, Any, NamedTuple

from ..messages.channel import Channel
from ..messages.twist import encode_twist
from ..runtime.clock import Clock
from ._bridge import Bridge, Read, UnreadableError, short_type, strings
from ._foxglove_channels import Graph, channel_of, decoder
from ._twist import is_zero
from ._websocket import Frame, one_line
from .middleware import FeedError, Outlet

if TYPE_CHECKING:
    from .feed import Feed

_PROTOCOLS = ["foxglove.sdk.v1", "foxglove.websocket.v1"]
_WRITTEN = ("cdr", "ros1", "json")
_DATA = Struct("<BIQ")
_CLIENT_DATA = Struct("<BI")
_MESSAGE = 1
_ERROR = 2
_SETTLE = 0.05  # seconds: the SDK's server loses one in ten subscriptions that follow the advertisement at once
_NO_CHANNELS = 0.5  # seconds within which a server advertises its channels, if it has any


class _Stream(NamedTuple):
    """A subscription to a channel."""

    topic: str
    channel_id: int
    type: str
    read: Read


class Foxglove(Bridge):
    """A `Middleware` with a connection to a foxglove server.

    Raises:
        TypeError, ValueError: the address is invalid.
    """

    def __init__(self, address: str = "ws://127.0.0.1:8765", clock: Clock | None = None) -> None:
        self._subscriptions = 0
        self._reactions = {
            "serverInfo": self._on_info,
            "advertise": self._on_advertise,
            "unadvertise": self._on_unadvertise,
            "connectionGraphUpdate": self._on_graph,
            "status": self._on_status,
        }
        super().__init__(address, _PROTOCOLS, clock)

    @property
    def outlet(self) -> Outlet:
        """See `HasOutlet`."""
        return Outlet("foxglove", {"address": self._address})

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""
        info = self._info
        if info is None:
            raise FeedError(f"not connected to {self.where}")
        if "clientPublish" not in strings(info.get("capabilities")):
            raise FeedError(
                f"{self.where} accepts no messages: its server does not offer clientPublish; "
                "foxglove_bridge offers it if its parameter capabilities lists it"
            )
        encoding = _encoding_for(info)
        if encoding is None:
            taken = one_line(", ".join(strings(info.get("supportedEncodings")))) or "no encoding"
            raise FeedError(f"{self.where} accepts messages in {taken}, but robowidgets writes only cdr, ros1 and json")
        is_json = encoding == "json"
        payload = json.dumps(message).encode() if is_json else encode_twist(encoding, message_type, message)
        key = topic, message_type, encoding
        zero = is_zero(message)
        self._publish(topic, lambda: self._frame_on(key, payload, is_zero=zero), confirm=zero)

    def on_frame(self, frame: Frame) -> None:
        """See `Bridge`."""
        if isinstance(frame, bytes):
            # Shorter frames and other opcodes are times, answers to requests that we never send, or malformed.
            if len(frame) >= _DATA.size and frame[0] == _MESSAGE:
                stream = self._streams.get(_DATA.unpack_from(frame)[1])
                if stream is not None:
                    self._keep(stream.topic, stream.type, stream.read, frame)
            return
        try:
            operation = json.loads(frame)
        except (ValueError, RecursionError):
            operation = None
        if isinstance(operation, dict):
            react = self._reactions.get(str(operation.get("op")))
            if react is not None:
                react(operation)
        else:
            self._report_on_all(f"{self.where} does not speak foxglove: it sent {one_line(frame[:80])!r}")

    def _topic_of_start(self, start: bytes) -> str:
        is_message = len(start) >= _DATA.size and start[0] == _MESSAGE
        stream = self._streams.get(_DATA.unpack_from(start)[1]) if is_message else None
        return stream.topic if stream is not None else ""

    @property
    def hint(self) -> str:
        """See `BridgeCalls`."""
        return f"if it is a rosbridge, use feeds.rosbridge({self.where!r})"

    def _begin(self) -> None:
        self._info: dict[str, Any] | None = None
        self._channels: dict[int, Channel] = {}
        self._settled_at: dict[int, float] = {}
        """By channel, the time from which it can be subscribed to."""
        self._streams: dict[int, _Stream] = {}
        self._graph = Graph()
        self._sent_on: dict[tuple[str, str, str], int] = {}

    def _on_info(self, operation: dict[str, Any]) -> None:
        is_first, self._info = self._info is None, operation
        if is_first:
            self._listener.on_connected()
        if "connectionGraph" in strings(operation.get("capabilities")):
            self._write({"op": "subscribeConnectionGraph"})
        # A server without channels sends no advertise message.
        self._later(_NO_CHANNELS, lambda: self._change(set()))

    def _on_advertise(self, operation: dict[str, Any]) -> None:
        offers = operation.get("channels")
        for channel in map(channel_of, offers if isinstance(offers, list) else []):
            if channel is not None:
                self._end({channel.id})
                self._channels[channel.id] = channel
                self._settled_at[channel.id] = self._clock.now() + _SETTLE
        self._change({channel.topic for channel in self._channels.values()})

    def _on_unadvertise(self, operation: dict[str, Any]) -> None:
        ids = operation.get("channelIds")
        gone = {i for i in ids if type(i) is int and i in self._channels} if isinstance(ids, list) else set()
        self._end(gone)
        self._change({self._channels.pop(i).topic for i in gone})

    def _change(self, topics: set[str]) -> None:
        self._listener.on_topics(self._graph.adverts(self._channels.values()))
        for topic in topics:
            self._start(topic)

    def _on_graph(self, operation: dict[str, Any]) -> None:
        self._graph.update(operation)
        self._change(set())

    def _on_status(self, operation: dict[str, Any]) -> None:
        text = operation.get("message")
        if operation.get("level") != _ERROR or not isinstance(text, str):
            return
        reason = f"the robot's bridge reports: {one_line(text)}"
        for topic in self._followed:
            if _names(text, topic):
                self._listener.on_trouble(topic, reason)
        published = {topic for topic, _, _ in self._sent_on}
        # foxglove_bridge does not name the topic that it cannot publish.
        is_of_publisher = "publish" in text or "client channel" in text
        for topic in published:
            if _names(text, topic) or (is_of_publisher and not any(_names(text, other) for other in published)):
                self._listener.on_unheard(topic, reason)

    def _start(self, topic: str) -> None:
        """Subscribe to each channel of a followed topic that can be decoded, and report if none of them can."""
        if topic not in self._followed:
            return
        channels = [channel for channel in self._channels.values() if channel.topic == topic]
        wait = max((self._settled_at[channel.id] for channel in channels), default=0.0) - self._clock.now()
        if wait > 0:
            self._later(wait, lambda: self._start(topic))
            return
        had = {stream.channel_id for stream in self._streams.values()}
        reason = ""
        for channel in channels:
            if channel.id in had:
                continue
            try:
                decode = decoder(channel)
            except UnreadableError as error:
                reason = str(error)
                continue
            self._subscriptions += 1
            self._streams[self._subscriptions] = _Stream(topic, channel.id, channel.type, partial(_read, decode))
            self._write({"op": "subscribe", "subscriptions": [{"id": self._subscriptions, "channelId": channel.id}]})
        if not any(stream.topic == topic for stream in self._streams.values()):
            self._listener.on_trouble(topic, reason)

    def _stop(self, topic: str) -> None:
        self._end({stream.channel_id for stream in self._streams.values() if stream.topic == topic})

    def _end(self, channel_ids: set[int]) -> None:
        """Unsubscribe from some channels."""
        ids = [number for number, stream in self._streams.items() if stream.channel_id in channel_ids]
        for number in ids:
            del self._streams[number]
        if ids:
            self._write({"op": "unsubscribe", "subscriptionIds": ids})

    def _frame_on(self, key: tuple[str, str, str], payload: bytes, *, is_zero: bool) -> bytes:
        """Return the frame of a message on our channel for a topic, type and encoding. Advertise the channel first."""
        if key not in self._sent_on:
            topic, message_type, encoding = key
            self._sent_on[key] = len(self._sent_on) + 1
            kind = short_type(message_type) if encoding == "ros1" else message_type
            channel = {"id": self._sent_on[key], "topic": topic, "encoding": encoding, "schemaName": kind}
            self._write({"op": "advertise", "channels": [channel]})
            self._await_match(key)
        frame = _CLIENT_DATA.pack(_MESSAGE, self._sent_on[key]) + payload
        self._note_sent(key, frame, is_zero=is_zero)
        return frame


def _names(text: str, topic: str) -> bool:
    """Return True if a text names a topic."""
    return re.search(rf"(?<![\w/]){re.escape(topic)}(?![\w/])", text) is not None


def _encoding_for(info: Mapping[str, Any]) -> str | None:
    """Return the encoding in which a server accepts messages, or None if we cannot write any of its encodings."""
    encodings = strings(info.get("supportedEncodings"))
    return next((known for known in _WRITTEN if known in encodings), None)


def _read(decode: Read, frame: bytes) -> Any:
    return decode(frame[_DATA.size :])


def foxglove(address: str = "ws://127.0.0.1:8765") -> Feed:
    """Open a feed of a robot that runs foxglove_bridge, or any other server of the Foxglove SDK. It needs tornado.

    Args:
        address: the address of the bridge: ``ws://``, or ``wss://`` for an encrypted connection.

    Raises:
        TypeError, ValueError: the address is invalid.
        FeedError: tornado is not installed.
    """
    from .feed import Feed  # a guard imports only the middleware

    return Feed(Foxglove(address))

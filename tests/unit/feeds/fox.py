"""Foxglove servers: the real one, and one for the older subprotocol."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import foxglove
import numpy as np
from rosbags.typesys import Stores, get_typestore
from tornado.websocket import WebSocketHandler

from robowidgets.messages.encoding import encode

from .servers import Server

HUMBLE = get_typestore(Stores.ROS2_HUMBLE)
NOETIC = get_typestore(Stores.ROS1_NOETIC)
SCAN = "sensor_msgs/msg/LaserScan"


def scan(store: Any, count: int = 5, distance: float = 1.0) -> Any:
    kinds = store.types
    sequence = {"seq": 0} if store is NOETIC else {}
    header = kinds["std_msgs/msg/Header"](
        stamp=kinds["builtin_interfaces/msg/Time"](1, 2), frame_id="laser", **sequence
    )
    return kinds[SCAN](
        header, -1.0, 1.0, 0.5, 0.0, 0.1, 0.1, 10.0, np.full(count, distance, np.float32), np.empty(0, np.float32)
    )


def cdr(count: int = 5, distance: float = 1.0) -> bytes:
    return bytes(HUMBLE.serialize_cdr(scan(HUMBLE, count, distance), SCAN))


def definition(kind: str = SCAN, store: Any = HUMBLE, version: int = 2) -> str:
    return store.generate_msgdef(kind, ros_version=version)[0]


def channel(number: int, topic: str = "/scan", kind: str = SCAN, **more: Any) -> dict[str, Any]:
    told = {"id": number, "topic": topic, "encoding": "cdr", "schemaName": kind, "schemaEncoding": "ros2msg"}
    return {**told, "schema": definition() if kind == SCAN else "", **more}


@contextmanager
def serving(types: Mapping[str, str]) -> Iterator[tuple[str, Callable[[str, Any], None]]]:
    """Yield the address of a server with topics of these types, and a function that publishes fields on one of them."""
    context = foxglove.Context()
    server = foxglove.start_server(host="127.0.0.1", port=0, context=context)
    channels = {
        topic: foxglove.Channel(
            topic,
            schema=foxglove.Schema(name=kind, encoding="ros2msg", data=definition(kind).encode()),
            message_encoding="cdr",
            context=context,
        )
        for topic, kind in types.items()
    }
    yield (
        f"ws://127.0.0.1:{server.port}",
        lambda topic, fields: channels[topic].log(bytes(encode("cdr", types[topic], fields))),
    )
    server.stop()


class OldFoxglove(Server):
    """A server of foxglove.websocket.v1, like bridges before the SDK."""

    subprotocols = ("foxglove.websocket.v1",)

    def __init__(self, channels: list[dict[str, Any]], port: int = 0, **info: Any) -> None:
        super().__init__(port)
        self.channels = channels
        self.info = {"op": "serverInfo", "name": "old", "capabilities": [], **info}
        self.subscribed: dict[int, int] = {}
        self.pings: list[bytes] = []
        """The pings that it has answered."""

    def on_open(self, client: WebSocketHandler) -> None:
        client.on_ping = self.pings.append  # type: ignore[method-assign]
        self.tell(client, self.info)
        if self.channels:
            self.tell(client, {"op": "advertise", "channels": self.channels})

    def on_said(self, _client: WebSocketHandler, said: Any) -> None:
        if isinstance(said, dict) and said["op"] == "subscribe":
            for asked in said["subscriptions"]:
                self.subscribed[asked["channelId"]] = asked["id"]
        elif isinstance(said, dict) and said["op"] == "unsubscribe":
            gone = said["subscriptionIds"]
            self.subscribed = {c: s for c, s in self.subscribed.items() if s not in gone}

    def log(self, channel_id: int, payload: bytes) -> None:
        """Send a message to all subscribers of a channel."""
        self.send(struct.pack("<BIQ", 1, self.subscribed[channel_id], 0) + payload)

"""A rosbridge server that behaves like the sources of rosbridge_suite, branches ros1 and ros2."""

from __future__ import annotations

import asyncio
import json
import math
from collections import deque
from typing import Any

import cbor2
import numpy as np
from tornado.websocket import WebSocketHandler

from .servers import Server


class Rosbridge(Server):
    """Publishes messages of a test: in JSON with null for NaN and infinity, or in CBOR with arrays in one piece.

    Like the real one, it has a queue of messages, which it drops when the connection ends; it reports errors in its
    log alone; it cannot encode arrays of fixed size in CBOR, which are tuples here; and it never begins a subscription
    without a type to a topic that does not exist yet.

    ``topics``: names to types, which decide between ROS 1 and 2. ``rosapi``: True if it runs. ``publishers``,
    ``listeners``: nodes by topic. ``missing``: packages that the robot lacks. ``delay``: seconds that each message
    waits in the queue.
    """

    def __init__(self, topics: dict[str, str], port: int = 0, rosapi: bool = True, delay: float = 0.001) -> None:
        super().__init__(port)
        self.topics = topics
        self.rosapi = rosapi
        self.delay = delay
        self.publishers: dict[str, list[str]] = {}
        self.listeners: dict[str, list[str]] = {}
        self.subscribed: dict[str, dict[str, Any]] = {}
        self.advertised: dict[str, str] = {}
        self.missing: set[str] = set()
        self.published: list[tuple[str, Any]] = []
        self.log: list[str] = []
        self._waiting: dict[str, deque[Any]] = {}
        self._sent_at: dict[str, float] = {}
        self._queues: dict[WebSocketHandler, tuple[asyncio.Queue[Any], asyncio.Task[None]]] = {}

    def publish(self, topic: str, message: dict[str, Any]) -> None:
        said = {"op": "publish", "topic": topic, "msg": message}
        asked = self.subscribed[topic]
        try:
            frame = _cbor(said) if asked.get("compression") == "cbor" else _text(said)
        except AttributeError as error:
            self.log.append(f"Exception calling subscribe callback: {error}")
        else:
            self.loop.call_soon_threadsafe(self._throttle, topic, asked, frame)

    def _throttle(self, topic: str, asked: dict[str, Any], frame: Any) -> None:
        """Send one waiting frame in each interval; drop the oldest of the frames that wait meanwhile."""
        pause, waiting = asked["throttle_rate"] / 1000, self._waiting.setdefault(topic, deque())
        waiting.append(frame)
        while len(waiting) > max(1, asked["queue_length"]):
            waiting.popleft()
        now = self.loop.time()
        due = max(now, self._sent_at.get(topic, 0.0) + pause)
        if len(waiting) == 1:
            self.loop.call_later(due - now, self._send_first, topic)

    def _send_first(self, topic: str) -> None:
        self._sent_at[topic] = self.loop.time()
        for frame in self._waiting.pop(topic, ()):
            self.send(frame)

    def on_open(self, client: WebSocketHandler) -> None:
        queue: asyncio.Queue[Any] = asyncio.Queue()
        self._queues[client] = queue, asyncio.ensure_future(self._process(client, queue))

    def on_said(self, client: WebSocketHandler, said: Any) -> None:
        self._queues[client][0].put_nowait(said)

    def on_close(self, client: WebSocketHandler) -> None:
        self._queues.pop(client)[1].cancel()

    async def _process(self, client: WebSocketHandler, queue: asyncio.Queue[Any]) -> None:
        while True:
            said = await queue.get()
            await asyncio.sleep(self.delay)
            try:
                getattr(self, f"on_{said['op']}")(client, said)
            except Exception as error:
                self.log.append(f"{said['op']}: {error}")

    def on_subscribe(self, _client: WebSocketHandler, said: dict[str, Any]) -> None:
        self._check(said["topic"], said.get("type"))
        self.subscribed[said["topic"]] = said

    def on_unsubscribe(self, _client: WebSocketHandler, said: dict[str, Any]) -> None:
        self.subscribed.pop(said["topic"], None)

    def on_advertise(self, _client: WebSocketHandler, said: dict[str, Any]) -> None:
        self._check(said["topic"], said["type"])
        if said["type"].split("/")[0] in self.missing:
            raise ValueError(f"Unable to import {said['type'].split('/')[0]}.msg from package")
        self.advertised[said["topic"]] = said["type"]

    def on_publish(self, _client: WebSocketHandler, said: dict[str, Any]) -> None:
        if said["topic"] not in self.advertised:
            self._check(said["topic"], None)
        self.published.append((said["topic"], said["msg"]))

    def on_call_service(self, client: WebSocketHandler, said: dict[str, Any]) -> None:
        topic = said["args"].get("topic", "")
        values = {
            "/rosapi/topics": {"topics": list(self.topics), "types": list(self.topics.values())},
            "/rosapi/publishers": {"publishers": self.publishers_of(topic)},
            "/rosapi/subscribers": {"subscribers": self.listeners.get(topic, ["/rosbridge_websocket"])},
        }
        answer = {"op": "service_response", "service": said["service"], "id": said["id"]}
        if self.rosapi and said["service"] in values:
            self.tell(client, {**answer, "values": values[said["service"]], "result": True})
        else:
            words = f"Service {said['service']} does not exist"
            self.log.append(f"call_service InvalidServiceException: {words}")
            self.tell(client, {**answer, "values": words, "result": False})

    def publishers_of(self, topic: str) -> list[str]:
        """The nodes that publish a topic, including the bridge."""
        there = self.publishers.get(topic, ["/driver"])
        ours = ["/rosbridge_websocket"] if topic in self.advertised else []
        return [*there, *(name for name in ours if name not in there)]

    def _check(self, topic: str, kind: str | None) -> None:
        """Refuse a type in the notation of the other ROS, or another type than the topic's."""
        there = self.topics.get(topic)
        if kind is None and there is None:
            raise ValueError(f"Cannot infer type for topic {topic} as it is not yet advertised")
        is_ros1 = any("/msg/" not in known for known in self.topics.values())
        if kind is not None and kind.count("/") != (1 if is_ros1 else 2):
            raise ValueError(f"{kind} is not a valid type string")
        if there is not None and kind not in (None, there):
            raise ValueError(f"Tried to register topic {topic} with type {kind} but it is already {there}")


def _text(said: Any) -> str:
    return json.dumps(_plain(said))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(field) for name, field in value.items()}
    if isinstance(value, (np.ndarray, tuple)):
        return [_plain(float(item)) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _cbor(said: Any) -> bytes:
    return cbor2.dumps(_tagged(said))


def _tagged(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _tagged(field) for name, field in value.items()}
    if isinstance(value, tuple):
        raise AttributeError("'numpy.ndarray' object has no attribute 'get_fields_and_field_types'")
    return cbor2.CBORTag(85, np.asarray(value, "<f4").tobytes()) if isinstance(value, np.ndarray) else value

"""A rosbridge server, written from the protocol document of rosbridge v2."""

from __future__ import annotations

import json
import math
from typing import Any

import cbor2
import numpy as np
from tornado.websocket import WebSocketHandler

from .servers import Server


class Rosbridge(Server):
    """Publishes what a test publishes: in JSON with null for NaN and infinity, or in CBOR with arrays in one piece.

    ``topics``: names to types. ``rosapi``: whether it runs. ``listeners``: nodes that listen, by topic.
    """

    def __init__(self, topics: dict[str, str], port: int = 0, rosapi: bool = True) -> None:
        super().__init__(port)
        self.topics = topics
        self.rosapi = rosapi
        self.listeners: dict[str, list[str]] = {}
        self.silent: set[str] = set()
        self.subscribed: dict[str, dict[str, Any]] = {}
        self.advertised: dict[str, str] = {}
        self.published: list[tuple[str, Any]] = []

    def publish(self, topic: str, message: dict[str, Any]) -> None:
        said = {"op": "publish", "topic": topic, "msg": message}
        self.send(_cbor(said) if self.subscribed[topic].get("compression") == "cbor" else _text(said))

    def on_said(self, client: WebSocketHandler, said: Any) -> None:
        getattr(self, f"_{said['op']}")(client, said)

    def _subscribe(self, client: WebSocketHandler, said: dict[str, Any]) -> None:
        topic = said["topic"]
        if topic in self.topics:
            self.subscribed[topic] = said
        else:
            self._error(client, said, f"subscribe: Cannot infer type for topic {topic} as it is not yet advertised")

    def _unsubscribe(self, _client: WebSocketHandler, said: dict[str, Any]) -> None:
        self.subscribed.pop(said["topic"], None)

    def _advertise(self, _client: WebSocketHandler, said: dict[str, Any]) -> None:
        self.advertised[said["topic"]] = said["type"]

    def _publish(self, client: WebSocketHandler, said: dict[str, Any]) -> None:
        if said["topic"] in self.advertised:
            self.published.append((said["topic"], said["msg"]))
        else:
            self._error(client, said, f"publish: {said['topic']} was not advertised")

    def _call_service(self, client: WebSocketHandler, said: dict[str, Any]) -> None:
        topic = said["args"].get("topic", "")
        values = {
            "/rosapi/topics": {"topics": list(self.topics), "types": list(self.topics.values())},
            "/rosapi/publishers": {"publishers": [] if topic in self.silent else ["/driver"]},
            "/rosapi/subscribers": {"subscribers": self.listeners.get(topic, ["/rosbridge_websocket"])},
        }
        answer = {"op": "service_response", "service": said["service"], "id": said["id"]}
        if self.rosapi:
            self.tell(client, {**answer, "values": values[said["service"]], "result": True})
        else:
            self._error(client, said, f"call_service InvalidServiceException: Service {said['service']} does not exist")
            self.tell(client, {**answer, "values": "Service does not exist", "result": False})

    def _error(self, client: WebSocketHandler, said: dict[str, Any], words: str) -> None:
        self.tell(client, {"op": "status", "level": "error", "msg": words, "id": said.get("id")})


def _text(said: Any) -> str:
    return json.dumps(_plain(said))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(field) for name, field in value.items()}
    if isinstance(value, np.ndarray):
        return [_plain(item) for item in value.tolist()]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _cbor(said: Any) -> bytes:
    return cbor2.dumps(_tagged(said))


def _tagged(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _tagged(field) for name, field in value.items()}
    return cbor2.CBORTag(85, np.asarray(value, "<f4").tobytes()) if isinstance(value, np.ndarray) else value

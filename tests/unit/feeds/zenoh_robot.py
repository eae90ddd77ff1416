"""A robot on Zenoh, in its own process: reads commands as lines of JSON, and writes received messages as lines of JSON.

It uses the nodes of zenoh-ros2-sdk by ROBOTIS, which shares no code with the feed. The SDK neither keeps messages for
late subscribers nor sends messages by other definitions, so these are written here with Zenoh alone.
"""

from __future__ import annotations

import json
import os
import struct
import sys
import threading
import time
from itertools import count
from typing import Any

import numpy as np
import zenoh
from rosbags.typesys import Stores, get_typestore
from zenoh import ext
from zenoh_ros2_sdk import ROS2Publisher, ROS2Subscriber

STORE = get_typestore(Stores.ROS2_JAZZY)
KEPT = ":1:,1:,:,:,,"


def tell(what: Any) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


def made(store: Any, kind: str, values: dict[str, Any]) -> Any:
    """Return a message of a type with these fields; all others are 0 or empty."""
    names = store.types[kind].__dataclass_fields__
    fields = dict(store.get_msgdef(kind).fields)
    given = {}
    for name, (node, what) in fields.items():
        value = values.get(name)
        if node == 2:  # another message
            given[name] = made(store, what, value or {})
        elif node in (3, 4):  # a list
            kind_of = what[0][1][0] if isinstance(what[0][1], tuple) else ""
            given[name] = (
                np.array(value or [], dtype=getattr(np, kind_of, None)) if hasattr(np, kind_of) else value or []
            )
        else:
            given[name] = value if value is not None else ("" if what[0] == "string" else 0)
    return store.types[kind](**{name: given[name] for name in names if name in given})


class Robot:
    """Its publishers and subscribers at a router, by topic and type."""

    def __init__(self, port: int, domain: int) -> None:
        self._at = {"router_ip": "127.0.0.1", "router_port": port, "domain_id": domain}
        self._domain, self._port = domain, port
        self._publishers: dict[tuple[str, str], Any] = {}
        self._subscribers: list[Any] = []
        self._session: Any = None
        self._raw: dict[tuple[str, str], Any] = {}
        self._numbers = count(1)

    def _kind(self, kind: str) -> dict[str, Any]:
        return {
            "msg_definition": STORE.generate_msgdef(kind, ros_version=2)[0],
            "type_hash": STORE.hash_rihs01(kind),
            **self._at,
        }

    def write(self, topic: str, kind: str, values: dict[str, Any], name: str = "driver", namespace: str = "/") -> None:
        """Publish a message as the SDK does."""
        if (topic, kind) not in self._publishers:
            there = self._kind(kind)
            self._publishers[topic, kind] = ROS2Publisher(topic, kind, node_name=name, namespace=namespace, **there)
        publisher = self._publishers[topic, kind]
        types = publisher.session_mgr.store
        message = made(types, kind, values)
        publisher.publish(**{field: getattr(message, field) for field, _ in types.get_msgdef(kind).fields})

    def hear(self, topic: str, kind: str) -> None:
        """Report the speeds on a topic."""
        ready = threading.Event()

        def heard(message: Any) -> None:
            ready.wait()
            twist = getattr(message, "twist", message)
            tell([twist.linear.x, twist.angular.z])

        self._subscribers.append(ROS2Subscriber(topic, kind, callback=heard, node_name="base", **self._kind(kind)))
        tell("ready")
        ready.set()

    def stop(self, topic: str, kind: str) -> None:
        self._publishers.pop((topic, kind)).close()

    def flood(self, topic: str, kind: str, pause: float, values: dict[str, Any]) -> None:
        def run() -> None:
            while True:
                self.write(topic, kind, values)
                time.sleep(pause)

        threading.Thread(target=run, daemon=True).start()

    def put(self, topic: str, kind: str, type_hash: str, qos: str, raw: str, size: int = 0) -> None:
        """Publish bytes, in hex, and ``size`` zeros after them, under a hash. ``KEPT`` keeps the last one."""
        if self._session is None:
            config = zenoh.Config()
            config.insert_json5("mode", '"client"')
            config.insert_json5("connect/endpoints", f'["tcp/127.0.0.1:{self._port}"]')
            config.insert_json5("scouting/multicast/enabled", "false")
            config.insert_json5("timestamping/enabled", "true")
            self._session = zenoh.open(config)
        package, _, name = kind.partition("/msg/")
        wire = f"{package}::msg::dds_::{name}_"
        if (topic, kind) not in self._raw:
            key = f"{self._domain}/{topic.strip('/')}/{wire}/{type_hash}"
            block = zenoh.CongestionControl.BLOCK  # by default, a publisher drops what does not fit into its queue
            if qos == KEPT:
                publisher = ext.declare_advanced_publisher(
                    self._session, key, congestion_control=block, cache=ext.CacheConfig(1), publisher_detection=True
                )
            else:
                publisher = self._session.declare_publisher(key, congestion_control=block)
            token = f"@ros2_lv/{self._domain}/{self._session.info.zid()}/0/{next(self._numbers)}/MP/%/%/raw/"
            token += "/".join((topic.replace("/", "%"), wire, type_hash, qos))
            held = self._session.liveliness().declare_token(token)
            self._raw[topic, kind] = [publisher, held, 0, os.urandom(16)]
        there = self._raw[topic, kind]
        there[2] += 1
        head = struct.pack("<qqB", there[2], time.time_ns(), 16) + there[3]
        there[0].put(bytes.fromhex(raw) + bytes(size), attachment=head)

    def withdraw(self, topic: str, kind: str) -> None:
        """Drop a publisher of bytes."""
        publisher, token, *_ = self._raw.pop((topic, kind))
        token.undeclare()
        publisher.undeclare()

    def wait_for_subscriber(self, topic: str, kind: str) -> None:
        """Wait until a publisher of bytes has a subscriber."""
        while not self._raw[topic, kind][0].matching_status.matching:
            time.sleep(0.01)

    def skip(self, topic: str, kind: str, count: int) -> None:
        """Count messages that are never sent, as if the network had lost them."""
        self._raw[topic, kind][2] += count


def main(port: int, domain: int) -> None:
    robot = Robot(port, domain)
    for line in sys.stdin:
        do, *what = json.loads(line)
        getattr(robot, do)(*what)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))

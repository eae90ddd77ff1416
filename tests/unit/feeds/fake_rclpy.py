"""Stands in for rclpy: one graph, nodes on it, executors that call back. Messages are those of rosbags."""

from __future__ import annotations

import sys
import threading
from enum import Enum
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

from robowidgets.feeds._encode import _message

STORE = get_typestore(Stores.ROS2_HUMBLE)


class DurabilityPolicy(Enum):
    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class ReliabilityPolicy(Enum):
    RELIABLE = 1
    BEST_EFFORT = 2


class HistoryPolicy(Enum):
    KEEP_LAST = 1


class QoSProfile:
    def __init__(
        self,
        depth: int,
        history: HistoryPolicy = HistoryPolicy.KEEP_LAST,
        reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE,
        durability: DurabilityPolicy = DurabilityPolicy.VOLATILE,
    ) -> None:
        self.depth, self.history, self.reliability, self.durability = depth, history, reliability, durability


class UnsupportedEventTypeError(Exception):
    pass


class SubscriptionEventCallbacks:
    def __init__(self, *, incompatible_qos: Any = None, use_default_callbacks: bool = True) -> None:
        assert not use_default_callbacks
        self.incompatible_qos = incompatible_qos


class Context:
    def __init__(self) -> None:
        self.log: list[str] = []
        self.domain_id: int | None = None

    def try_shutdown(self) -> None:
        self.log.append("shutdown")


class SingleThreadedExecutor:
    def __init__(self, *, context: Any) -> None:
        self.context = context
        self.nodes: list[Any] = []
        self.guard = threading.Event()
        self.due: list[Any] = []

    def add_node(self, node: Any) -> None:
        if node.executor is not None and node in node.executor.nodes:
            node.executor.remove_node(node)
        node.executor = self
        self.nodes.append(node)

    def remove_node(self, node: Any) -> None:
        self.nodes.remove(node)

    def get_nodes(self) -> list[Any]:
        return list(self.nodes)

    def wake(self) -> None:
        self.guard.set()

    def spin_once(self, timeout_sec: float) -> None:
        if not self.due:
            self.guard.wait(timeout_sec)
        self.guard.clear()
        if self.due:
            self.due.pop(0)()

    def shutdown(self) -> None:
        self.context.log.append("executor")


class Node:
    def __init__(self, graph: Graph, context: Any) -> None:
        self.graph, self.context = graph, context
        self.executor: Any = None
        self.subscriptions: list[Any] = []
        self.publishers: list[Any] = []
        graph.nodes.append(self)

    def get_name(self) -> str:
        return "robot"

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        names = {e.topic for n in self.graph.nodes for e in (*n.subscriptions, *n.publishers)}
        return [(name, []) for name in sorted(names)]

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        return [e for n in self.graph.nodes for e in n.publishers if e.topic == topic]

    def get_subscriptions_info_by_topic(self, topic: str) -> list[Any]:
        return [e for n in self.graph.nodes for e in n.subscriptions if e.topic == topic]

    def create_subscription(
        self, kind: Any, topic: str, callback: Any, qos: Any, *, callback_group: Any, event_callbacks: Any
    ) -> Any:
        del callback_group
        if event_callbacks.incompatible_qos and not self.graph.tells_refusals:
            raise UnsupportedEventTypeError
        made = SimpleNamespace(
            topic=topic, topic_type=kind.name, qos_profile=qos, callback=callback, events=event_callbacks, node=self
        )
        self.subscriptions.append(made)
        return made

    def create_publisher(self, kind: Any, topic: str, qos: Any) -> Any:
        made = SimpleNamespace(topic=topic, topic_type=kind.name, qos_profile=qos, node=self)
        made.publish = lambda message: self.graph.deliver(made, message)
        made.get_subscription_count = lambda: len(self.get_subscriptions_info_by_topic(topic))
        self.publishers.append(made)
        return made

    def destroy_subscription(self, subscription: Any) -> None:
        self.subscriptions.remove(subscription)

    def destroy_publisher(self, publisher: Any) -> None:
        self.publishers.remove(publisher)

    def destroy_node(self) -> None:
        self.graph.nodes.remove(self)
        self.context.log.append("node")


class Graph:
    """All nodes, and what was published."""

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.contexts: list[Any] = []
        self.tells_refusals = True

    def node(self) -> Node:
        """A node of somebody else's."""
        return Node(self, Context())

    def deliver(self, publisher: Any, message: Any) -> None:
        for node in self.nodes:
            for subscription in node.subscriptions:
                if (subscription.topic, subscription.topic_type) == (publisher.topic, publisher.topic_type):
                    self.call(node, lambda s=subscription: s.callback(message))

    def call(self, node: Any, what: Any) -> None:
        if node.executor is not None:
            node.executor.due.append(what)
            node.executor.wake()


def get_message(name: str) -> Any:
    if name not in STORE.types:
        raise ModuleNotFoundError(f"No module named {name.split('/')[0]!r}")

    def make() -> Any:
        return _message(STORE, name, {})

    make.name = name  # type: ignore[attr-defined]
    return make


def install(monkeypatch: pytest.MonkeyPatch) -> Graph:
    """Put it in the place of rclpy, and give its graph."""
    graph = Graph()

    def init(*, args: Any, context: Any, domain_id: int | None, signal_handler_options: str) -> None:
        assert (args, signal_handler_options) == ([], "no")
        context.domain_id = domain_id
        graph.contexts.append(context)

    def create_node(name: str, *, context: Any, use_global_arguments: bool) -> Node:
        assert (name.isidentifier(), use_global_arguments) == (True, False)
        return Node(graph, context)

    modules = {
        "rclpy": {
            "init": init,
            "create_node": create_node,
        },
        "rclpy.context": {"Context": Context},
        "rclpy.signals": {"SignalHandlerOptions": SimpleNamespace(NO="no")},
        "rclpy.executors": {"SingleThreadedExecutor": SingleThreadedExecutor},
        "rclpy.callback_groups": {"MutuallyExclusiveCallbackGroup": object},
        "rclpy.event_handler": {
            "SubscriptionEventCallbacks": SubscriptionEventCallbacks,
            "UnsupportedEventTypeError": UnsupportedEventTypeError,
        },
        "rclpy.qos": {
            "DurabilityPolicy": DurabilityPolicy,
            "ReliabilityPolicy": ReliabilityPolicy,
            "HistoryPolicy": HistoryPolicy,
            "QoSProfile": QoSProfile,
            "qos_policy_name_from_kind": str,
        },
        "rosidl_runtime_py": {},
        "rosidl_runtime_py.utilities": {"get_message": get_message},
    }
    for name, holds in modules.items():
        module = ModuleType(name)
        vars(module).update(holds)
        monkeypatch.setitem(sys.modules, name, module)
    return graph

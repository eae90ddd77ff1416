"""Stands in for rclpy: one graph, nodes on it, executors that call back. Messages are those of rosbags.

Where rclpy of Humble to Rolling differ, it is as unforgiving as any of them.
"""

from __future__ import annotations

import re
import sys
import threading
import warnings
import weakref
from enum import IntEnum
from importlib.util import find_spec, module_from_spec
from inspect import signature
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

from robowidgets.feeds._encode import _message

STORE = get_typestore(Stores.ROS2_HUMBLE)


class InvalidHandle(Exception):  # noqa: N818
    """What is asked of something that was destroyed."""

    def __init__(self) -> None:
        super().__init__("cannot use Destroyable because destruction was requested")


class NameValidationException(Exception):  # noqa: N818
    pass


class InvalidTopicNameException(NameValidationException):
    def __init__(self, name: str) -> None:
        super().__init__(f"Invalid topic name: it has a bad character:\n  '{name}'\n   ^")


class ExternalShutdownException(Exception):  # noqa: N818
    """It says nothing."""


class UnsupportedEventTypeError(Exception):
    pass


def validate_topic_name(name: str) -> None:
    if not re.fullmatch(r"[~/]?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", name):
        raise InvalidTopicNameException(name)


class DurabilityPolicy(IntEnum):
    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3


class ReliabilityPolicy(IntEnum):
    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3


class HistoryPolicy(IntEnum):
    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3


class QoSPolicyKind(IntEnum):
    DURABILITY = 2
    DEADLINE = 4
    RELIABILITY = 16


def qos_policy_name_from_kind(kind: int) -> str:
    return QoSPolicyKind(kind).name


class QoSProfile:
    def __init__(
        self,
        *,
        depth: int,
        history: HistoryPolicy = HistoryPolicy.KEEP_LAST,
        reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE,
        durability: DurabilityPolicy = DurabilityPolicy.VOLATILE,
    ) -> None:
        if history == HistoryPolicy.KEEP_LAST and depth == 0:
            warnings.warn("A zero depth with KEEP_LAST doesn't make sense", stacklevel=2)
        self.depth, self.history = depth, HistoryPolicy(history)
        self.reliability, self.durability = ReliabilityPolicy(reliability), DurabilityPolicy(durability)


class PublisherEventCallbacks:
    def __init__(self, *, use_default_callbacks: bool = True) -> None:
        self.use_default_callbacks = use_default_callbacks


class SubscriptionEventCallbacks:
    def __init__(self, *, incompatible_qos: Any = None, use_default_callbacks: bool = True) -> None:
        self.incompatible_qos, self.use_default_callbacks = incompatible_qos, use_default_callbacks


class Duration:
    def __init__(self, *, seconds: float = 0, nanoseconds: int = 0) -> None:
        self.nanoseconds = int(seconds * 1e9) + nanoseconds


class Context:
    def __init__(self) -> None:
        self.log: list[str] = []
        self.domain_id: int | None = None
        self._state = "new"
        self._executors: list[weakref.ref[SingleThreadedExecutor]] = []

    def init(self, args: list[str], *, domain_id: int | None = None) -> None:
        if self._state != "new":
            raise RuntimeError("Context.init() must only be called once")
        assert isinstance(args, list)
        self._state, self.domain_id = "up", domain_id

    def ok(self) -> bool:
        return self._state == "up"

    def try_shutdown(self) -> None:
        if self.ok():
            self.log.append("shutdown")
            self._state = "down"
            for executor in [reference() for reference in self._executors]:
                if executor is not None:
                    executor.wake()


class CallbackGroup:
    """All that is known of one: who asks it, and that it answers."""

    def __init__(self) -> None:
        self.entities: set[Any] = set()

    def add_entity(self, entity: Any) -> None:
        self.entities.add(entity)

    def has_entity(self, entity: Any) -> bool:
        return entity in self.entities


class SingleThreadedExecutor:
    def __init__(self, *, context: Context) -> None:
        if not context.ok():
            raise RuntimeError("failed to create guard_condition: the given context is not valid")
        self.context = context
        self._nodes: set[Node] = set()
        self._guard: threading.Event | None = threading.Event()
        self._spinning = threading.Lock()
        context._executors.append(weakref.ref(self))

    def add_node(self, node: Node) -> bool:
        if node in self._nodes:
            return False
        self._nodes.add(node)
        node.executor = self
        self.wake()
        return True

    def remove_node(self, node: Node) -> None:
        if node in self._nodes:
            self._nodes.remove(node)
            self.wake()

    def get_nodes(self) -> list[Node]:
        return list(self._nodes)

    def wake(self) -> None:
        if self._guard is not None:
            self._guard.set()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        if not self._spinning.acquire(blocking=False):
            raise RuntimeError("Executor is already spinning")
        try:
            self._spin_once(timeout_sec)
        finally:
            self._spinning.release()

    def _spin_once(self, timeout_sec: float | None) -> None:
        guard = self._guard
        if guard is None:
            return
        nodes = self.get_nodes()
        for node in nodes:
            node.waited_for_by = self
        if not any(node.due for node in nodes):
            guard.wait(timeout_sec)
        guard.clear()
        if not self.context.ok():
            raise ExternalShutdownException
        for node in nodes:
            if node.waited_for_by is not self and self._guard is not None:
                raise IndexError("wait set index too big")
        node = next((node for node in nodes if node.due), None)
        if node is not None:
            self._execute(*node.due.pop(0))

    def _execute(self, subscription: Subscription, argument: Any, callback: Any) -> None:
        group = subscription.callback_group
        if not (group.can_execute(subscription) and group.beginning_execution(subscription)):
            return
        subscription.node.graph.before_taking(subscription)
        if subscription.destroyed:  # Jazzy goes on; Humble does not
            raise InvalidHandle
        if isinstance(argument, bytes):  # the group never hears that it has ended
            raise RuntimeError("failed to take message from subscription: error not set")
        try:
            callback(argument)
        finally:
            group.ending_execution(subscription)

    def shutdown(self) -> None:
        self._nodes = set()
        self._guard = None
        self.context.log.append("executor")


class Subscription:
    def __init__(self, node: Node, kind: Any, topic: str, callback: Any, qos: Any, group: Any, events: Any) -> None:
        signature(callback).bind(object())
        self.node, self.topic_name, self.topic_type, self.qos_profile = node, topic, kind.name, qos
        self.callback, self.callback_group, self.events, self.destroyed = callback, group, events, False


class Publisher:
    def __init__(self, node: Node, kind: Any, topic: str, qos: Any) -> None:
        self.node, self.topic_name, self.topic_type, self.qos_profile = node, topic, kind.name, qos
        self.destroyed = False
        self.acked = 0
        """How often it was asked whether all was heard."""

    def publish(self, message: Any) -> None:
        self._check()
        if type(message).__name__ != self.topic_type.replace("/", "__"):
            raise TypeError(f"Expected {self.topic_type}, got {type(message)}")
        self.node.graph.deliver(self, message)

    def get_subscription_count(self) -> int:
        self._check()
        return len(self.node.get_subscriptions_info_by_topic(self.topic_name))

    def wait_for_all_acked(self, timeout: Duration) -> bool:
        self._check()
        assert timeout.nanoseconds >= 0, "it would wait for ever"
        self.acked += 1
        return True

    def _check(self) -> None:
        if self.destroyed:
            raise InvalidHandle


class Group(CallbackGroup):
    """A group that lets everything through."""

    def can_execute(self, _entity: Any) -> bool:
        return True

    beginning_execution = can_execute

    def ending_execution(self, _entity: Any) -> None:
        pass


class Node:
    def __init__(self, graph: Graph, context: Context) -> None:
        if not context.ok():
            raise RuntimeError("rclpy.init() has not been called. msg:cannot create node")
        self.graph, self.context = graph, context
        self.subscriptions: list[Subscription] = []
        self.publishers: list[Publisher] = []
        self.due: list[tuple[Subscription, Any, Any]] = []
        self.waited_for_by: Any = None
        self.spun_by: Any = None
        self._executor: Any = None
        self._destroyed = False
        graph.nodes.append(self)

    @property
    def executor(self) -> Any:
        return self._executor() if self._executor is not None else None

    @executor.setter
    def executor(self, new: Any) -> None:
        current = self.executor
        if current is new:
            return
        if current is not None:
            current.remove_node(self)
        self._executor = weakref.ref(new) if new is not None else None
        if new is not None:
            new.add_node(self)

    def get_name(self) -> str:
        self._check()
        return "robot"

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        self._check()
        names = {e.topic_name for n in self.graph.nodes for e in (*n.subscriptions, *n.publishers)}
        return [(name, []) for name in sorted(names)]

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        return self._infos(topic, [e for n in list(self.graph.nodes) for e in list(n.publishers)])

    def get_subscriptions_info_by_topic(self, topic: str) -> list[Any]:
        return self._infos(topic, [e for n in list(self.graph.nodes) for e in list(n.subscriptions)])

    def create_subscription(
        self, msg_type: Any, topic: str, callback: Any, qos_profile: Any, *, callback_group: Any, event_callbacks: Any
    ) -> Subscription:
        self._check()
        validate_topic_name(topic)
        qos_profile = self._profile(qos_profile)
        if event_callbacks.incompatible_qos and not self.graph.tells_refusals:
            raise UnsupportedEventTypeError
        if msg_type.name in self.graph.broken:
            raise AttributeError(f"no type support\nof {msg_type.name}")
        made = Subscription(self, msg_type, topic, callback, qos_profile, callback_group, event_callbacks)
        callback_group.add_entity(made)
        self.subscriptions.append(made)
        return made

    def create_publisher(
        self, msg_type: Any, topic: str, qos_profile: Any, *, event_callbacks: Any = None
    ) -> Publisher:
        self._check()
        qos_profile = self._profile(qos_profile)
        if event_callbacks is not None:  # ours, not the test's
            validate_topic_name(topic)
            assert not event_callbacks.use_default_callbacks, "it would log"
        made = Publisher(self, msg_type, topic, qos_profile)
        self.publishers.append(made)
        return made

    def destroy_subscription(self, subscription: Subscription) -> bool:
        if subscription not in self.subscriptions:
            return False
        self.subscriptions.remove(subscription)
        subscription.destroyed = True
        if self.executor is not None:
            self.executor.wake()
        return True

    def destroy_publisher(self, publisher: Publisher) -> bool:
        if publisher not in self.publishers:
            return False
        self.publishers.remove(publisher)
        publisher.destroyed = True
        return True

    def destroy_node(self) -> None:
        for subscription in list(self.subscriptions):
            self.destroy_subscription(subscription)
        for publisher in list(self.publishers):
            self.destroy_publisher(publisher)
        self._destroyed = True
        self.graph.nodes.remove(self)
        self.context.log.append("node")

    def _infos(self, topic: str, endpoints: list[Any]) -> list[Any]:
        self._check()
        validate_topic_name(topic)
        there = [endpoint for endpoint in endpoints if endpoint.topic_name == topic]
        return [SimpleNamespace(topic_type=e.topic_type, qos_profile=e.qos_profile) for e in there]

    def _check(self) -> None:
        if self._destroyed:
            raise InvalidHandle

    def _profile(self, qos: Any) -> QoSProfile:
        if isinstance(qos, QoSProfile):
            return qos
        if isinstance(qos, int):
            return QoSProfile(depth=qos)
        raise TypeError(f"Expected QoSProfile or int, but received {type(qos)!r}")


class Graph:
    """All nodes, and what was published."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.contexts: list[Context] = []
        self.tells_refusals = True
        self.broken: set[str] = set()
        """Types whose package is half installed."""
        self.before_taking: Any = lambda _subscription: None
        """What happens in other threads just before an executor takes a message."""

    def node(self) -> Node:
        """A node of somebody else's."""
        context = Context()
        context.init([])
        return Node(self, context)

    def deliver(self, publisher: Publisher, message: Any) -> None:
        for node in list(self.nodes):
            for subscription in list(node.subscriptions):
                same = (publisher.topic_name, publisher.topic_type)
                if (subscription.topic_name, subscription.topic_type) == same:
                    self.call(subscription, message, subscription.callback)

    def call(self, subscription: Subscription, argument: Any, callback: Any) -> None:
        """Have whoever spins its node call back."""
        subscription.node.due.append((subscription, argument, callback))
        if subscription.node.executor is not None:
            subscription.node.executor.wake()


def get_message(name: str) -> Any:
    if name not in STORE.types:
        raise ModuleNotFoundError(f"No module named {name.split('/')[0]!r}")

    def make() -> Any:
        return _message(STORE, name, {})

    make.name = name  # type: ignore[attr-defined]
    return make


def install(monkeypatch: pytest.MonkeyPatch, *, events: str = "event_handler") -> Graph:
    """Put it in the place of rclpy, and give its graph. Before Iron, events were in `qos_event`."""
    graph = Graph()

    def init(*, args: Any, context: Any, domain_id: int | None, signal_handler_options: str) -> None:
        assert signal_handler_options == "no"
        context.init(args, domain_id=domain_id)
        graph.contexts.append(context)

    def create_node(name: str, *, context: Any, use_global_arguments: bool) -> Node:
        assert (name.isidentifier(), use_global_arguments) == (True, False)
        return Node(graph, context)

    modules: dict[str, dict[str, Any]] = {
        "rclpy": {"init": init, "create_node": create_node},
        "rclpy.context": {"Context": Context},
        "rclpy.duration": {"Duration": Duration},
        "rclpy.exceptions": {"InvalidHandle": InvalidHandle, "NameValidationException": NameValidationException},
        "rclpy.signals": {"SignalHandlerOptions": SimpleNamespace(NO="no")},
        "rclpy.executors": {
            "ExternalShutdownException": ExternalShutdownException,
            "SingleThreadedExecutor": SingleThreadedExecutor,
        },
        "rclpy.callback_groups": {"CallbackGroup": CallbackGroup},
        f"rclpy.{events}": {
            "PublisherEventCallbacks": PublisherEventCallbacks,
            "SubscriptionEventCallbacks": SubscriptionEventCallbacks,
            "UnsupportedEventTypeError": UnsupportedEventTypeError,
        },
        "rclpy.qos": {
            "DurabilityPolicy": DurabilityPolicy,
            "ReliabilityPolicy": ReliabilityPolicy,
            "HistoryPolicy": HistoryPolicy,
            "QoSProfile": QoSProfile,
            "qos_policy_name_from_kind": qos_policy_name_from_kind,
        },
        "rclpy.validate_topic_name": {"validate_topic_name": validate_topic_name},
        "rosidl_runtime_py": {},
        "rosidl_runtime_py.utilities": {"get_message": get_message},
    }
    for name, holds in modules.items():
        module = ModuleType(name)
        vars(module).update(holds)
        if name in ("rclpy", "rosidl_runtime_py"):
            module.__path__ = []
        monkeypatch.setitem(sys.modules, name, module)
        parent, _, last = name.rpartition(".")
        if parent:
            setattr(sys.modules[parent], last, module)
    spec = find_spec("robowidgets.feeds._ros2_gate")
    assert spec is not None
    assert spec.loader is not None
    gate = module_from_spec(spec)
    spec.loader.exec_module(gate)  # its class is derived from one of rclpy's
    monkeypatch.setitem(sys.modules, spec.name, gate)
    return graph

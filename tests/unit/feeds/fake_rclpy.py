"""Stands in for rclpy: one network, nodes on it, executors that call back. Messages come from rosbags.

If rclpy differs from Humble to Rolling, the stand-in has the strictest behaviour:

- `Executor.wake` only requests a new wait set: `spin_once` waits on to its end. A task ends it.
- Nodes of other contexts are known `Graph.discovery` seconds after they were made, and a publisher or subscription of a
  known node after `Graph.matching`. What is published before is lost. So is what comes after, for a best-effort
  subscription that does not know the publisher yet.
- An interrupt, where a program called `rclpy.init()`, shuts down every context of the process (`Graph.interrupt`);
  `fake_signals` has these handlers.
- Calls on a context that was shut down, or on a destroyed object, raise.
- A message that cannot be taken leaves its callback group waiting for the end of a callback that never began.
"""

from __future__ import annotations

import re
import sys
import threading
import time
import warnings
import weakref
from collections import deque
from collections.abc import Callable
from enum import IntEnum
from inspect import signature
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from .fake_signals import SignalHandlerOptions, Signals

STORE = get_typestore(Stores.ROS2_HUMBLE)

INVALID = "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called."


class RCLError(RuntimeError):
    pass


class InvalidHandle(Exception):  # noqa: N818
    """Raised by calls on a destroyed object."""

    def __init__(self) -> None:
        super().__init__("cannot use Destroyable because destruction was requested")


class NameValidationException(Exception):  # noqa: N818
    pass


class InvalidTopicNameException(NameValidationException):
    def __init__(self, name: str) -> None:
        super().__init__(f"Invalid topic name: it has a bad character:\n  '{name}'\n   ^")


class ExternalShutdownException(Exception):  # noqa: N818
    """It has no message."""


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
    def __init__(self, *, incompatible_qos: Any = None, use_default_callbacks: bool = True) -> None:
        self.incompatible_qos, self.use_default_callbacks = incompatible_qos, use_default_callbacks


class SubscriptionEventCallbacks(PublisherEventCallbacks):
    def __init__(self, *, message_lost: Any = None, **others: Any) -> None:
        super().__init__(**others)
        self.message_lost = message_lost


class Duration:
    def __init__(self, *, seconds: float = 0, nanoseconds: int = 0) -> None:
        self.nanoseconds = int(seconds * 1e9) + nanoseconds


class Context:
    def __init__(self) -> None:
        self.log: list[str] = []
        self.domain_id = 0
        self._state = "new"
        self._executors: list[weakref.ref[SingleThreadedExecutor]] = []

    def init(self, args: list[str] | None = None, *, domain_id: int | None = None) -> None:
        if self._state != "new":
            raise RuntimeError("Context.init() must only be called once")
        assert isinstance(args, list)
        self._state, self.domain_id = "up", domain_id or 0

    def ok(self) -> bool:
        return self._state == "up"

    def get_domain_id(self) -> int:
        if not self.ok():
            raise RCLError("Failed to get domain id")
        return self.domain_id

    def try_shutdown(self) -> None:
        if self.ok():
            self.log.append("shutdown")
            self._state = "down"
            for reference in self._executors:
                executor = reference()
                if executor is not None:
                    executor.wake()

    shutdown = try_shutdown

    def interrupt(self) -> None:
        """Act as the signal handler. It wakes executors just before: they wait on, unless they are late."""
        self._state = "down"


class MutuallyExclusiveCallbackGroup:
    def __init__(self) -> None:
        self.entities: set[Any] = set()
        self._active: Any = None

    def add_entity(self, entity: Any) -> None:
        self.entities.add(entity)

    def can_execute(self, entity: Any) -> bool:
        assert entity in self.entities
        return self._active is None

    def beginning_execution(self, entity: Any) -> bool:
        if not self.can_execute(entity):
            return False
        self._active = entity
        return True

    def ending_execution(self, entity: Any) -> None:
        assert self._active is entity
        self._active = None


class SingleThreadedExecutor:
    def __init__(self, *, context: Context) -> None:
        if not context.ok():
            raise RCLError(f"failed to create guard_condition: {INVALID}")
        self.context = context
        self._nodes: set[Node] = set()
        self._tasks: list[Callable[[], object]] = []
        self._guard: threading.Event | None = threading.Event()
        self._sigint_gc = None
        self._spinning = threading.Lock()
        context._executors.append(weakref.ref(self))

    def __del__(self) -> None:
        self._sigint_gc  # noqa: B018 # not there where the context was shut down before: that is printed

    @property
    def is_spinning(self) -> bool:
        return self._spinning.locked()

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

    def create_task(self, callback: Callable[[], object]) -> None:
        self._tasks.append(callback)
        assert self._guard is not None, "'NoneType' object has no attribute 'trigger'"
        self._guard.set()

    def wake(self) -> None:
        """Request that the wait set is rebuilt."""
        if self._guard is not None:
            self._guard.set()

    def spin(self) -> None:
        while self.context.ok() and self._guard is not None:
            self.spin_once()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        if not self._spinning.acquire(blocking=False):
            raise RuntimeError("Executor is already spinning")
        try:
            self._spin_once(time.monotonic() + (1e6 if timeout_sec is None else timeout_sec))
        finally:
            self._spinning.release()

    def _spin_once(self, until: float) -> None:
        while (guard := self._guard) is not None:
            if self._tasks:
                self._tasks.pop(0)()
                return
            ready = self._wait(guard, until)
            if self._guard is None:
                return
            if ready is not None:
                ready.execute()
                return
            if time.monotonic() >= until:
                return

    def _wait(self, guard: threading.Event, until: float) -> Subscription | Event | None:
        """Wait for the entities of this moment, and for the guard condition."""
        if not self.context.ok():
            raise RCLError(f"failed to initialize wait set: {INVALID}")
        entities = [entity for node in self.get_nodes() for entity in node.entities() if entity.can_execute()]
        while True:
            ready = next((entity for entity in entities if entity.is_ready()), None)
            left = min(until, self._next_discovery()) - time.monotonic()
            if ready is not None or guard.wait(max(0.0, left)) or time.monotonic() >= until:
                break
        guard.clear()
        if self._guard is not None and not self.context.ok():
            raise ExternalShutdownException
        return ready

    def _next_discovery(self) -> float:
        return min((node.graph.next_discovery() for node in self.get_nodes()), default=1e9)

    def shutdown(self) -> None:
        guard, self._guard = self._guard, None
        if guard is not None:
            guard.set()
        self._nodes = set()
        self.context.log.append("executor")


class Entity:
    """An entity that an executor waits for, except while it is taken, and for ever if that fails."""

    node: Node
    callback_group: Any
    _executor_event = False

    def can_execute(self) -> bool:
        return not self._executor_event and bool(self.callback_group.can_execute(self))

    def execute(self) -> None:
        self._executor_event = True
        if not self.callback_group.beginning_execution(self):
            self._executor_event = False
            return
        call = self.take()
        self._executor_event = False
        try:
            call()
        finally:
            self.callback_group.ending_execution(self)

    def is_ready(self) -> bool:
        raise NotImplementedError

    def take(self) -> Callable[[], object]:
        raise NotImplementedError


class Event(Entity):
    """Report an endpoint found whose quality of service is incompatible with this one."""

    def __init__(self, endpoint: Endpoint, callback: Any, callback_group: Any) -> None:
        signature(callback).bind(object())
        self.endpoint, self.callback, self.callback_group = endpoint, callback, callback_group
        callback_group.add_entity(self)
        self._told: set[Endpoint] = set()

    def _new(self) -> list[tuple[Endpoint, QoSPolicyKind]]:
        return [found for found in self.endpoint.refusals() if found[0] not in self._told]

    def is_ready(self) -> bool:
        return bool(self._new())

    def take(self) -> Callable[[], object]:
        new = self._new()
        self._told.update(other for other, _ in new)
        return lambda: self.callback(SimpleNamespace(last_policy_kind=int(new[-1][1]))) if new else None


class Lost(Entity):
    """Report messages lost on the network."""

    def __init__(self, callback: Any, callback_group: Any) -> None:
        signature(callback).bind(object())
        self.callback, self.callback_group, self.count, self._told = callback, callback_group, 0, 0
        callback_group.add_entity(self)

    def is_ready(self) -> bool:
        return self.count > self._told

    def take(self) -> Callable[[], object]:
        new, self._told = self.count - self._told, self.count
        return lambda: self.callback(SimpleNamespace(total_count=self.count, total_count_change=new))


class Endpoint:
    """A publisher or a subscription."""

    def __init__(self, node: Node, kind: Any, topic: str, qos: QoSProfile, group: Any, events: Any) -> None:
        self.node, self.topic_name, self.topic_type, self.qos_profile = node, topic, kind.name, qos
        self.callback_group, self.destroyed, self.made = group, False, time.monotonic()
        self.event_handlers: list[Any] = []
        if events.incompatible_qos is not None:
            if not node.graph.tells_refusals:
                raise UnsupportedEventTypeError
            self.event_handlers.append(Event(self, events.incompatible_qos, group))

    def refusals(self) -> list[tuple[Endpoint, QoSPolicyKind]]:
        pairs = [(other, self.refusal(other)) for other in self.others()]
        return [(other, kind) for other, kind in pairs if kind is not None]

    def matches(self) -> list[Any]:
        return [other for other in self.found() if self.refusal(other) is None]

    def others(self) -> list[Any]:
        """The endpoints on the other side of the topic that know this one, and are known to it."""
        return [other for other in self.found() if other.node.knows(self)]

    def found(self) -> list[Any]:
        """The endpoints on the other side of the topic that are known."""
        publishes = isinstance(self, Publisher)
        return [
            other
            for node in list(self.node.graph.nodes)
            for other in list(node.subscriptions if publishes else node.publishers)
            if (other.topic_name, other.topic_type) == (self.topic_name, self.topic_type) and self.node.knows(other)
        ]

    def refusal(self, other: Endpoint) -> QoSPolicyKind | None:
        offered, asked = (self, other) if isinstance(self, Publisher) else (other, self)
        offer, ask = offered.qos_profile, asked.qos_profile
        if (offer.reliability, ask.reliability) == (ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE):
            return QoSPolicyKind.RELIABILITY
        if (offer.durability, ask.durability) == (DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL):
            return QoSPolicyKind.DURABILITY
        return None

    def _check(self) -> None:
        if self.destroyed:
            raise InvalidHandle
        if not self.node.context.ok():
            raise RCLError(f"Failed to publish: publisher's context is invalid: {INVALID}")


class Subscription(Endpoint, Entity):
    def __init__(
        self, node: Node, kind: Any, topic: str, callback: Any, qos: QoSProfile, group: Any, events: Any
    ) -> None:
        signature(callback).bind(object())
        super().__init__(node, kind, topic, qos, group, events)
        self.callback, self.events = callback, events
        self.received: deque[Any] = deque(maxlen=max(1, qos.depth))
        group.add_entity(self)
        if events.message_lost is not None:
            self.lost = Lost(events.message_lost, group)
            self.event_handlers.append(self.lost)

    def is_ready(self) -> bool:
        return bool(self.received)

    def take(self) -> Callable[[], object]:
        if self.destroyed:  # Jazzy goes on; Humble does not
            raise InvalidHandle
        message = self.received.popleft()
        if isinstance(message, bytes):
            raise RCLError("failed to take message from subscription: error not set")
        return lambda: self.callback(message)

    def receive(self, message: Any) -> None:
        self.received.append(message)
        if self.node.executor is not None:
            self.node.executor.wake()


class Publisher(Endpoint):
    acked = 0
    """The number of checks that all was received."""

    def publish(self, message: Any) -> None:
        self._check()
        if type(message).__name__ != self.topic_type.replace("/", "__"):
            raise TypeError(f"Expected {self.topic_type}, got {type(message)}")
        self.node.graph.published_by.append(threading.current_thread().name)
        for subscription in self.matches():
            if subscription.qos_profile.reliability != ReliabilityPolicy.BEST_EFFORT or subscription.node.knows(self):
                subscription.receive(message)

    def get_subscription_count(self) -> int:
        self._check()
        return len(self.matches())

    def wait_for_all_acked(self, timeout: Duration) -> bool:
        self._check()
        assert timeout.nanoseconds >= 0, "it would wait for ever"
        self.acked += 1
        return True


class Node:
    def __init__(self, graph: Graph, context: Context, name: str, namespace: str = "/") -> None:
        if not context.ok():
            raise RuntimeError("rclpy.init() has not been called. msg:cannot create node")
        here = [node for node in graph.nodes if {node.context, context} <= set(graph.contexts)]
        if any(node.name == name for node in here):
            graph.warnings.append("Publisher already registered for provided node name.")
        self.graph, self.context, self.name, self.namespace = graph, context, name, namespace
        self.made = time.monotonic()
        self.subscriptions: list[Subscription] = []
        self.publishers: list[Publisher] = []
        self.default_callback_group = MutuallyExclusiveCallbackGroup()
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

    def entities(self) -> list[Any]:
        endpoints = [*self.subscriptions, *self.publishers]
        return [*(event for endpoint in endpoints for event in endpoint.event_handlers), *self.subscriptions]

    def knows(self, endpoint: Endpoint) -> bool:
        """True if it has discovered the other: at once within a context, after a delay in another one."""
        other = endpoint.node.context
        if other is self.context:
            return True
        found = max(self.made, endpoint.node.made) + self.graph.discovery
        matched = endpoint.made + self.graph.matching
        return other.domain_id == self.context.domain_id and time.monotonic() >= max(found, matched)

    def get_name(self) -> str:
        self._check()
        return self.name

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        self._check()
        ends = [e for n in list(self.graph.nodes) for e in (*n.subscriptions, *n.publishers)]
        return [(name, []) for name in sorted({end.topic_name for end in ends if self.knows(end)})]

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        return self._infos(topic, [e for n in list(self.graph.nodes) for e in list(n.publishers)])

    def get_subscriptions_info_by_topic(self, topic: str) -> list[Any]:
        return self._infos(topic, [e for n in list(self.graph.nodes) for e in list(n.subscriptions)])

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Any,
        qos_profile: Any,
        *,
        callback_group: Any = None,
        event_callbacks: Any = None,
    ) -> Subscription:
        qos_profile = self._begin(msg_type, topic, qos_profile)
        group, events = callback_group or self.default_callback_group, event_callbacks or SubscriptionEventCallbacks()
        made = Subscription(self, msg_type, topic, callback, qos_profile, group, events)
        self.subscriptions.append(made)
        self.graph.changed()
        return made

    def create_publisher(
        self, msg_type: Any, topic: str, qos_profile: Any, *, event_callbacks: Any = None
    ) -> Publisher:
        qos_profile = self._begin(msg_type, topic, qos_profile)
        if event_callbacks is not None:  # our context, not the test's
            assert not event_callbacks.use_default_callbacks, "it would log"
        events = event_callbacks or PublisherEventCallbacks()
        made = Publisher(self, msg_type, topic, qos_profile, self.default_callback_group, events)
        self.publishers.append(made)
        self.graph.changed()
        return made

    def destroy_subscription(self, subscription: Subscription) -> bool:
        return self._destroy(self.subscriptions, subscription)

    def destroy_publisher(self, publisher: Publisher) -> bool:
        return self._destroy(self.publishers, publisher)

    def destroy_node(self) -> None:
        for endpoint in [*self.subscriptions, *self.publishers]:
            endpoint.destroyed = True
        self.subscriptions, self.publishers, self._destroyed = [], [], True
        self.graph.nodes.remove(self)
        self.context.log.append("node")

    def _destroy(self, endpoints: list[Any], endpoint: Endpoint) -> bool:
        if endpoint not in endpoints:
            return False
        endpoints.remove(endpoint)
        endpoint.destroyed = True
        if self.executor is not None:
            self.executor.wake()
        return True

    def _infos(self, topic: str, endpoints: list[Any]) -> list[Any]:
        self._check()
        validate_topic_name(topic)
        return [
            SimpleNamespace(
                topic_type=end.topic_type,
                qos_profile=end.qos_profile,
                node_name=end.node.name,
                node_namespace=end.node.namespace,
            )
            for end in endpoints
            if end.topic_name == topic and self.knows(end)
        ]

    def _begin(self, msg_type: Any, topic: str, qos: Any) -> QoSProfile:
        self._check()
        if self.context in self.graph.contexts:  # our node; others may be DDS programs without ROS
            validate_topic_name(topic)
        if msg_type.name in self.graph.broken and self.context in self.graph.contexts:
            raise AttributeError(f"no type support\nof {msg_type.name}")
        if isinstance(qos, QoSProfile):
            return qos
        if isinstance(qos, int):
            return QoSProfile(depth=qos)
        raise TypeError(f"Expected QoSProfile or int, but received {type(qos)!r}")

    def _check(self) -> None:
        if self._destroyed:
            raise InvalidHandle
        if not self.context.ok():
            raise RCLError(f"Failed to use the node: {INVALID}")


class Graph:
    """All nodes, and the state of rclpy as seen from outside."""

    def __init__(self, domain_id: int = 7) -> None:
        self.domain_id = domain_id
        self.nodes: list[Node] = []
        self.contexts: list[Context] = []
        """The nodes of the product."""
        self.discovery, self.matching = 0.05, 0.03
        self.tells_refusals = True
        self.broken: set[str] = set()
        """Types with an incomplete package."""
        self.warnings: list[str] = []
        """Messages that rcl logs."""
        self.published_by: list[str] = []
        """The names of the threads that published."""

    def node(self, name: str = "robot", namespace: str = "/") -> Node:
        """A node of another program, in its own context."""
        context = Context()
        context.init([], domain_id=self.domain_id)
        return Node(self, context, name, namespace)

    def interrupt(self) -> None:
        """Act as rclpy's signal handler."""
        for context in [*self.contexts, *{node.context for node in self.nodes}]:
            context.interrupt()

    def changed(self) -> None:
        """Make all executors check their work."""
        for node in list(self.nodes):
            if node.executor is not None:
                node.executor.wake()

    def next_discovery(self) -> float:
        made = [end.made for node in list(self.nodes) for end in (*node.subscriptions, *node.publishers)]
        times = [at + self.matching for at in made] + [node.made + self.discovery for node in list(self.nodes)]
        return min((at for at in times if at > time.monotonic()), default=1e9)


def _blank(name: str) -> Any:
    """A message of a type, with zeros, empty texts and empty arrays in its fields."""
    return STORE.types[name](**{field: _blank_field(kind, what) for field, (kind, what) in STORE.fielddefs[name][1]})


def _blank_field(kind: int, what: Any) -> Any:
    if kind == Nodetype.NAME:
        return _blank(what)
    if kind == Nodetype.BASE:
        return {"string": "", "bool": False}.get(what[0], 0.0 if what[0].startswith("float") else 0)
    (inner, item), count = what
    items = [_blank_field(inner, item)] * (count if kind == Nodetype.ARRAY else 0)
    return np.array(items, item[0]) if inner == Nodetype.BASE and item[0] != "string" else items


def get_message(name: str) -> Any:
    if name not in STORE.types:
        raise ModuleNotFoundError(f"No module named {name.split('/')[0]!r}")

    def make() -> Any:
        return _blank(name)

    make.name = name  # type: ignore[attr-defined]
    return make


def install(monkeypatch: pytest.MonkeyPatch, *, events: str = "event_handler") -> Graph:
    """Replace rclpy by the stand-in, and yield its graph. Before Iron, events were in `qos_event`."""
    graph = Graph()

    program = Context()
    signals = Signals(lambda: [context.interrupt() for context in (*graph.contexts, program)], monkeypatch)

    def init(
        *, args: Any = None, context: Any = None, domain_id: int | None = None, signal_handler_options: Any = None
    ) -> None:
        if signal_handler_options is None:
            signal_handler_options = SignalHandlerOptions.ALL if context is None else SignalHandlerOptions.NO
        signals.install(signal_handler_options)
        if context is None:
            program.init(args or [], domain_id=domain_id)
            return
        assert signal_handler_options == SignalHandlerOptions.NO
        context.init(args, domain_id=domain_id)
        graph.contexts.append(context)

    def shutdown() -> None:
        program.try_shutdown()
        signals.uninstall()

    def create_node(name: str, *, context: Any = None, use_global_arguments: bool = True) -> Node:
        assert name.isidentifier()
        assert context is None or not use_global_arguments
        return Node(graph, context or program, name)

    modules: dict[str, dict[str, Any]] = {
        "rclpy": {"init": init, "create_node": create_node, "ok": program.ok, "shutdown": shutdown},
        "rclpy.context": {"Context": Context},
        "rclpy.duration": {"Duration": Duration},
        "rclpy.exceptions": {"InvalidHandle": InvalidHandle, "NameValidationException": NameValidationException},
        "rclpy.signals": vars(signals.module),
        "rclpy.executors": {
            "ExternalShutdownException": ExternalShutdownException,
            "SingleThreadedExecutor": SingleThreadedExecutor,
        },
        "rclpy.callback_groups": {"MutuallyExclusiveCallbackGroup": MutuallyExclusiveCallbackGroup},
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
    return graph

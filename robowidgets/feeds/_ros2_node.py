"""What a feed does with a node of rclpy. rclpy is imported when it is used."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from .middleware import Advert, FeedError

_Key = tuple[str, str, bool]
"""A topic, a type, and whether what was published before is asked for."""


class Held:
    """A node that is spun while nobody else does."""

    def __init__(self, node: Any) -> None:
        from rclpy.executors import SingleThreadedExecutor

        self.node = node
        self.executor = SingleThreadedExecutor(context=node.context)

    def __enter__(self) -> Held:
        return self

    def __exit__(self, *_: object) -> None:
        if self.node in self.executor.get_nodes():
            self.executor.remove_node(self.node)
        self.executor.shutdown()

    def spin_once(self, seconds: float) -> None:
        """Do what is due, or wait for it. A node that the program spins is left to it."""
        spins = self.node.executor  # the last one that had it, which may have let go of it
        if spins is None or self.node not in spins.get_nodes():
            self.executor.add_node(self.node)
        self.executor.spin_once(timeout_sec=seconds)


@contextmanager
def own_node(domain_id: int | None) -> Iterator[Held]:
    """A node of ours, in a context of its own that leaves Ctrl-C to the notebook."""
    import rclpy
    from rclpy.context import Context
    from rclpy.signals import SignalHandlerOptions

    context = Context()
    rclpy.init(args=[], context=context, domain_id=domain_id, signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = rclpy.create_node(f"robowidgets_{os.getpid()}", context=context, use_global_arguments=False)
        try:
            with Held(node) as held:
                yield held
        finally:
            node.destroy_node()
    finally:
        context.try_shutdown()


class NodeTools:
    """The topics around a node, and what we subscribe and publish by it."""

    def __init__(self, node: Any, hand_on: Callable[[str, Any], None], trouble: Callable[[str, str], None]) -> None:
        from rclpy.callback_groups import MutuallyExclusiveCallbackGroup

        self._node, self._hand_on, self._trouble = node, hand_on, trouble
        self._group = MutuallyExclusiveCallbackGroup()  # the program's own callbacks may block theirs
        self._subscriptions: dict[_Key, Any] = {}
        self._publishers: dict[tuple[str, str], Any] = {}

    def adverts(self) -> list[Advert]:
        """All topics that somebody else publishes or listens to."""
        offered: Counter[tuple[str, str]] = Counter()
        wanted: Counter[tuple[str, str]] = Counter()
        for name, _ in self._node.get_topic_names_and_types():
            offered.update((name, info.topic_type) for info in self._node.get_publishers_info_by_topic(name))
            wanted.update((name, info.topic_type) for info in self._node.get_subscriptions_info_by_topic(name))
        offered.subtract(self._publishers.keys())
        wanted.subtract((topic, kind) for topic, kind, _ in self._subscriptions)
        keys = sorted(key for key in offered.keys() | wanted.keys() if offered[key] > 0 or wanted[key] > 0)
        return [Advert(*key, offered[key] > 0, wanted[key] > 0) for key in keys]

    def follow(self, topics: Iterable[str]) -> None:
        """Subscribe to what is published on these topics, and to nothing else."""
        wishes = {wish for topic in topics for wish in self._wishes(topic)}
        for wish in self._subscriptions.keys() - wishes:
            self._node.destroy_subscription(self._subscriptions.pop(wish))
        for wish in wishes - self._subscriptions.keys():
            self._begin(wish)

    def publisher(self, topic: str, message_type: str, patience: float) -> Any:
        """What publishes messages of a type; a new one waits up to so many seconds for somebody who hears it."""
        from rclpy.qos import QoSProfile

        if (topic, message_type) not in self._publishers:
            publisher = self._node.create_publisher(message_class(message_type), topic, QoSProfile(depth=1))
            self._publishers[topic, message_type] = publisher
            until = time.monotonic() + patience
            while not publisher.get_subscription_count() and time.monotonic() < until:
                time.sleep(0.005)
        return self._publishers[topic, message_type]

    def close(self) -> None:
        """Give back to the node what we made by it."""
        for subscription in self._subscriptions.values():
            self._node.destroy_subscription(subscription)
        for publisher in self._publishers.values():
            self._node.destroy_publisher(publisher)

    def _wishes(self, topic: str) -> set[_Key]:
        from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

        by_type: dict[str, bool] = {}
        for info in self._node.get_publishers_info_by_topic(topic):
            qos = info.qos_profile
            kept = (qos.durability, qos.reliability) == (DurabilityPolicy.TRANSIENT_LOCAL, ReliabilityPolicy.RELIABLE)
            by_type[info.topic_type] = by_type.get(info.topic_type, True) and kept
        return {(topic, kind, kept) for kind, kept in by_type.items()}

    def _begin(self, wish: _Key) -> None:
        from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

        topic, kind, kept = wish
        try:
            known = message_class(kind)
        except LookupError as error:
            self._trouble(topic, f"{topic} comes as {kind}: {error}")
            return
        # A best-effort reader hears reliable publishers, too; only what is kept for those who come late needs more.
        qos = QoSProfile(
            history=HistoryPolicy.KEEP_LAST,
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE if kept else ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE,
        )
        self._subscriptions[wish] = self._subscription(known, topic, qos)

    def _subscription(self, known: Any, topic: str, qos: Any) -> Any:
        from rclpy.qos import qos_policy_name_from_kind

        try:
            from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError
        except ImportError:  # before Iron
            from rclpy.qos_event import SubscriptionEventCallbacks, UnsupportedEventTypeError

        def hear(message: Any) -> None:
            self._hand_on(topic, message)

        def refused(event: Any) -> None:
            self._trouble(topic, _refusal(topic, qos_policy_name_from_kind(event.last_policy_kind).lower()))

        events = SubscriptionEventCallbacks(incompatible_qos=refused, use_default_callbacks=False)
        make, group = self._node.create_subscription, self._group
        try:
            return make(known, topic, hear, qos, callback_group=group, event_callbacks=events)
        except UnsupportedEventTypeError:  # Zenoh refuses nobody, and so tells of no refusal
            return make(
                known,
                topic,
                hear,
                qos,
                callback_group=group,
                event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
            )


def message_class(message_type: str) -> Any:
    """The class of a message; LookupError, in words for a person, where it is not installed."""
    from rosidl_runtime_py.utilities import get_message

    try:
        return get_message(message_type)
    except (ImportError, AttributeError, LookupError, ValueError):
        package = message_type.partition("/")[0]
        raise LookupError(
            f"the package {package} is not installed here, or lacks it; install "
            f"ros-<distro>-{package.replace('_', '-')}, or source the workspace that has it, and restart the kernel"
        ) from None


def fill(message: Any, fields: Mapping[str, Any]) -> None:
    """Set the fields of a message, those within its fields too; FeedError for what it does not have or take."""
    for name, value in fields.items():
        if not hasattr(message, name):
            raise FeedError(f"a {type(message).__name__} has no field {name!r}")
        if isinstance(value, Mapping):
            fill(getattr(message, name), value)
        else:
            _set(message, name, value)


def _set(message: Any, name: str, value: Any) -> None:
    try:
        setattr(message, name, value)
    except (AssertionError, TypeError, ValueError) as error:
        raise FeedError(f"{name} of a {type(message).__name__} cannot be {value!r}: {error}") from None


def _refusal(topic: str, name: str) -> str:
    does = {"reliability": "is best-effort", "durability": "keeps no message for those who come late"}
    return f"a publisher of {topic} {does.get(name, f'disagrees on {name}')}, so its messages do not come"

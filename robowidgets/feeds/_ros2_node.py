"""What a feed does with a node of rclpy. rclpy is imported when it is used."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from ._ros2_messages import message_class
from .middleware import EVENTS, Advert, is_event

if TYPE_CHECKING:
    from ._ros2_gate import Gate

_Key = tuple[str, str, bool]
"""A topic, a type, and whether what was published before is asked for."""

_DEPTH = 5
"""Messages that wait for us, as for sensor data."""

_LEAVING = 0.2
"""Seconds that the end of a subscription waits for its callback, and that of a publisher for those who hear it."""


class NodeTools:
    """The topics around a node, and what we subscribe and publish by it."""

    def __init__(self, node: Any, hand_on: Callable[[str, Any], None], trouble: Callable[[str, str], None]) -> None:
        self._node, self._hand_on, self._trouble = node, hand_on, trouble
        self._offers: dict[str, list[Any]] = {}
        self._subscriptions: dict[_Key, tuple[Any, Gate]] = {}
        self._publishers: dict[tuple[str, str], Any] = {}

    def look(self) -> list[Advert]:
        """See which topics somebody else publishes or listens to."""
        from rclpy.exceptions import NameValidationException

        self._offers.clear()
        offered: Counter[tuple[str, str]] = Counter()
        wanted: Counter[tuple[str, str]] = Counter()
        for name, _ in self._node.get_topic_names_and_types():
            try:
                offers = self._node.get_publishers_info_by_topic(name)
                wants = self._node.get_subscriptions_info_by_topic(name)
            except (NameValidationException, ValueError):
                continue  # who speaks DDS without ROS gives names that rclpy refuses
            self._offers[name] = offers
            offered.update((name, info.topic_type) for info in offers)
            wanted.update((name, info.topic_type) for info in wants)
        offered.subtract(self._publishers.keys())
        wanted.subtract((topic, kind) for topic, kind, _ in self._subscriptions)
        keys = sorted(key for key in offered.keys() | wanted.keys() if offered[key] > 0 or wanted[key] > 0)
        return [Advert(*key, offered[key] > 0, wanted[key] > 0) for key in keys]

    def follow(self, topics: Iterable[str]) -> None:
        """Subscribe to what the last look saw published on these topics, and to nothing else."""
        wishes = {wish for topic in topics for wish in _wishes(topic, self._offers.get(topic, ()))}
        for wish in self._subscriptions.keys() - wishes:
            self._end(*self._subscriptions.pop(wish))
        for wish in wishes - self._subscriptions.keys():
            self._begin(wish)

    def publisher(self, topic: str, message_type: str, patience: float) -> Any:
        """What publishes messages of a type; a new one waits up to so many seconds for somebody who hears it."""
        from rclpy.qos import QoSProfile

        if (topic, message_type) not in self._publishers:
            publisher = self._node.create_publisher(
                message_class(message_type),
                topic,
                QoSProfile(depth=1),
                event_callbacks=_events().PublisherEventCallbacks(use_default_callbacks=False),
            )
            self._publishers[topic, message_type] = publisher
            until = time.monotonic() + patience
            while not publisher.get_subscription_count() and time.monotonic() < until:
                time.sleep(0.005)
        return self._publishers[topic, message_type]

    def blame(self, error: Exception) -> bool:
        """End the subscription whose message led to an error, until the next look; says whether there is one."""
        stuck = [wish for wish, (_, gate) in self._subscriptions.items() if gate.is_inside]
        for wish in stuck:
            self._trouble(wish[0], f"a message of {wish[0]} cannot be read: {_words(error)}")
            subscription, gate = self._subscriptions.pop(wish)
            gate.shut(0.0)
            self._node.destroy_subscription(subscription)
        return bool(stuck)

    def flush(self) -> None:
        """Wait a moment until everybody has heard what was published: it may be a zero."""
        from rclpy.duration import Duration

        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=_LEAVING))

    def close(self) -> None:
        """Give back to the node what we made by it."""
        for subscription, gate in self._subscriptions.values():
            self._end(subscription, gate)
        for publisher in self._publishers.values():
            self._node.destroy_publisher(publisher)

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
            depth=EVENTS if is_event(kind) else _DEPTH,
            reliability=ReliabilityPolicy.RELIABLE if kept else ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE,
        )
        try:
            self._subscriptions[wish] = self._subscription(known, topic, qos)
        except Exception as error:  # a package that is half installed raises whatever it likes
            self._trouble(topic, f"{topic} cannot be subscribed to as {kind}: {_words(error)}")

    def _subscription(self, known: Any, topic: str, qos: Any) -> tuple[Any, Gate]:
        from rclpy.qos import qos_policy_name_from_kind

        from ._ros2_gate import Gate

        events = _events()

        def hear(message: Any) -> None:
            self._hand_on(topic, message)

        def refused(event: Any) -> None:
            self._trouble(topic, _refusal(topic, qos_policy_name_from_kind(event.last_policy_kind).lower()))

        gate = Gate()
        make = self._node.create_subscription
        told = events.SubscriptionEventCallbacks(incompatible_qos=refused, use_default_callbacks=False)
        try:
            return make(known, topic, hear, qos, callback_group=gate, event_callbacks=told), gate
        except events.UnsupportedEventTypeError:  # Zenoh refuses nobody, and so tells of no refusal
            untold = events.SubscriptionEventCallbacks(use_default_callbacks=False)
            return make(known, topic, hear, qos, callback_group=gate, event_callbacks=untold), gate

    def _end(self, subscription: Any, gate: Gate) -> None:
        gate.shut(_LEAVING)
        self._node.destroy_subscription(subscription)


def _wishes(topic: str, offers: Iterable[Any]) -> set[_Key]:
    """A subscription for each type. It asks for what is kept only where all publishers keep: it hears all then."""
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    by_type: dict[str, bool] = {}
    for info in offers:
        qos = info.qos_profile
        kept = (qos.durability, qos.reliability) == (DurabilityPolicy.TRANSIENT_LOCAL, ReliabilityPolicy.RELIABLE)
        by_type[info.topic_type] = by_type.get(info.topic_type, True) and kept
    return {(topic, kind, kept) for kind, kept in by_type.items()}


def _events() -> Any:
    """The module of rclpy that tells of events."""
    try:
        from rclpy import event_handler
    except ImportError:  # before Iron
        from rclpy import qos_event as event_handler
    return event_handler


def _words(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _refusal(topic: str, name: str) -> str:
    does = {"reliability": "is best-effort", "durability": "keeps no message for those who come late"}
    return f"a publisher of {topic} {does.get(name, f'disagrees on {name}')}, so its messages do not come"

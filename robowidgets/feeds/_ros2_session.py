"""A node with a separate rclpy context, its subscriptions and publishers. Importing this module imports no rclpy."""

from __future__ import annotations

import os
import re
import secrets
import threading
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack, suppress
from typing import Any, NamedTuple

from ..runtime.clock import Clock
from ._guard.mark import MARK
from ._ros2_common import adverts_of, nobody_left, not_coming, not_received, queue_depth, speed_types
from ._twist import fill, is_zero
from ._zeros import Zeros
from .middleware import MOST_UNREAD, SEND_TIMEOUT, Advert, Listener, NotConnectedYetError


class _Wish(NamedTuple):
    """A subscription to create. ``kept`` requests earlier messages (transient local), ``each`` requests every message.

    ``reliable`` requests lost packets again, which works only if all publishers offer it.
    """

    topic: str
    type: str
    kept: bool
    each: bool = False
    reliable: bool = False


DISCOVERY = 2.0
"""The longest time in which a new participant discovers the others, in seconds."""

_MATCH_POLL = 0.005
_MATCH_LAG = 0.05
"""Seconds after which a subscriber has also matched a new publisher. A best-effort one misses earlier messages."""

_ACK_POLL = 0.02

_OURS = re.compile(r"robowidgets_\d+_[0-9a-f]{6}")
"""The names of our nodes. Nodes of a kernel may subscribe to what its guard publishes, but they are not a robot."""

_UNKNOWN = ("_NODE_NAME_UNKNOWN_", "_CREATED_BY_BARE_DDS_APP_")
"""The names of an unknown node, and of a program without a node."""


class Ros2Session:
    """A node with its executor in a separate context, which no program spins, destroys or shuts down.

    Only the signal handler of rclpy shuts down every context of the process; then `ok` is False. Any thread may call
    `publish`, `wake` and `ok`. Everything else belongs to the thread that made the session.

    Args:
        domain_id: the domain.
        listener: gets messages and reports.
        is_wanted: returns True if messages of a topic are still wanted.
        matched: the topics and types with a publisher that has matched a subscriber, including earlier sessions.
        clock: the clock of its waits, except for waits in rclpy.
        name: the name of the node, or empty for a generated name.

    Raises:
        Exception: rclpy does not start. The class depends on the reason.
    """

    def __init__(
        self,
        domain_id: int,
        listener: Listener,
        is_wanted: Callable[[str], bool],
        matched: set[tuple[str, str]],
        clock: Clock,
        name: str = "",
    ) -> None:
        import rclpy
        from rclpy.context import Context
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.signals import SignalHandlerOptions

        self._listener, self._is_wanted, self._matched, self._clock = listener, is_wanted, matched, clock
        # Random, because processes in containers often have the same id, and rcl warns about duplicate node names.
        self._name = name or f"robowidgets_{os.getpid()}_{secrets.token_hex(3)}"
        self._opened = self._clock.now()
        self._context = Context()
        self._offers: dict[str, list[Any]] = {}
        self._subscriptions: dict[_Wish, tuple[Any, Any]] = {}
        self._publishers: dict[tuple[str, str], Any] = {}
        self._unmatched: set[tuple[str, str]] = set()
        self._missed: set[tuple[str, str]] = set()
        """Topics and types with an unpublished message, because their subscriber has not been discovered again."""
        self._zeros = Zeros(self._clock)
        self._counts: dict[str, int] = {}
        """By topic, the number of its subscribers at the last look, except ours."""
        self._publishing = threading.Lock()
        self._published_at = float("-inf")
        self._unheard: set[str] = set()
        rclpy.init(args=[], context=self._context, domain_id=domain_id, signal_handler_options=SignalHandlerOptions.NO)
        with ExitStack() as made:
            made.callback(self._context.try_shutdown)
            self._node = rclpy.create_node(self._name, context=self._context, use_global_arguments=False)
            made.callback(self._node.destroy_node)
            self._executor = SingleThreadedExecutor(context=self._context)
            made.callback(self._executor.shutdown)
            self._executor.add_node(self._node)
            self._made = made.pop_all()

    def ok(self) -> bool:
        """Return True until it is shut down."""
        return bool(self._context.ok())

    @property
    def age(self) -> float:
        """Seconds since it was opened."""
        return self._clock.now() - self._opened

    @property
    def is_young(self) -> bool:
        """True while other participants may not have been discovered yet."""
        return self.age < DISCOVERY

    def wake(self) -> None:
        """Make `spin_once` return. `Executor.wake` would only rebuild its wait set and continue to wait."""
        self._executor.create_task(lambda: None)

    def spin_once(self, seconds: float) -> None:
        """Handle one message or event, or wait for one."""
        try:
            self._executor.spin_once(timeout_sec=seconds)
        except Exception as error:
            if not (self.ok() and self._drop_unreadable(error)):
                raise

    def look(self) -> list[Advert]:
        """Return the topics that other nodes publish or subscribe to."""
        from rclpy.exceptions import NameValidationException

        self._offers.clear()
        offered: dict[tuple[str, str], set[str]] = {}
        wanted: dict[tuple[str, str], set[str]] = {}
        heard: dict[str, list[Any]] = {}
        for topic, _ in self._node.get_topic_names_and_types():
            try:
                offers = self._others(self._node.get_publishers_info_by_topic(topic))
                wants = self._node.get_subscriptions_info_by_topic(topic)
            except (NameValidationException, ValueError):
                continue  # a DDS program without ROS may use names that rclpy rejects
            self._offers[topic] = offers
            for info in offers:
                offered.setdefault((topic, info.topic_type), set()).add(_full_name(info))
            for info in self._others(wants):
                wanted.setdefault((topic, info.topic_type), set()).add(_full_name(info))
            heard[topic] = self._robots(wants)
            if topic in self._unheard and self._all_matched(topic, wants):
                self._unheard.discard(topic)
                self._listener.on_unheard(topic, "")
        self._note_matches()
        for topic in {topic for topic, _ in list(self._publishers)}:
            types = speed_types(kind for name, kind in wanted if name == topic)
            if any((topic, kind) not in self._publishers for kind in types):
                with self._publishing:
                    self._create_publishers(topic, types)
        self._repeat_zeros(heard)
        return adverts_of(offered, wanted)

    def follow(self, topics: frozenset[str], each: frozenset[str]) -> None:
        """Subscribe to these topics with the types of the last `look`, and again if every message is wanted.

        All other subscriptions end.
        """
        wishes = {wish for topic in topics for wish in _wishes(topic, self._offers.get(topic, ()))}
        wishes |= {_wish_for_each(wish, self._offers.get(wish.topic, ())) for wish in wishes if wish.topic in each}
        for wish in self._subscriptions.keys() - wishes:
            self._node.destroy_subscription(self._subscriptions.pop(wish)[0])
        for wish in wishes - self._subscriptions.keys():
            self._subscribe(wish)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any], until: float) -> None:
        """Publish a message. The first message on a topic waits until a time for matched subscribers.

        Raises:
            NotConnectedYetError: a subscriber of an earlier session has not been discovered again.
            TimeoutError: the message is a zero that has no subscriber any more.
            Exception: rclpy does not publish, for example because the session was shut down.
        """
        key = (topic, message_type)
        with self._publishing:
            if key not in self._publishers:
                self._create_publishers(topic, {message_type} | speed_types(self._types_wanted(topic)))
            waiting = {one for one in self._unmatched if one[0] == topic}
            found = {one for one in waiting if self._await_match(one, until)}
            late = {one for one in waiting - found if one in self._matched and self.is_young}
            self._unmatched -= waiting - late
            self._matched |= found
            if key in late:
                self._missed.add(key)
                raise NotConnectedYetError(
                    f"the subscriber of {topic} is not discovered again since rclpy was shut down"
                )
            self._missed -= found & {key}
            if found:
                self._clock.sleep(_MATCH_LAG)
            self._publishers[key].publish(fill(message_class(message_type)(), message))
            self._published_at = self._clock.now()
            subscribers = self._counts.get(topic, 0)
            if not is_zero(message):
                self._zeros.note_speed(topic, subscribers)
                return
            self._zeros.note_zero(topic, message_type, message, subscribers)
            if self._zeros.is_unheard(topic, subscribers):
                raise TimeoutError(nobody_left(topic))

    def _repeat_zeros(self, heard: Mapping[str, list[Any]]) -> None:
        """Repeat the zeros that subscribers may have missed. If another thread is publishing, do it at the next look.

        Args:
            heard: the subscribers of each topic.
        """
        self._counts = {topic: len(there) for topic, there in heard.items()}
        if not self._publishing.acquire(blocking=False):
            return
        try:
            for topic in self._zeros.topics():
                there = heard.get(topic, [])
                due = self._zeros.due(topic, len(there), all_confirm=all(map(_is_reliable, there)))
                for kind, zero in due.items():
                    self._publishers[topic, kind].publish(fill(message_class(kind)(), zero))
        finally:
            self._publishing.release()

    def close(self) -> None:
        """Wait until every subscriber has the last message, which may be a zero; then end everything.

        A best-effort subscriber gets zero some more times.
        """
        with self._publishing:
            with suppress(Exception):  # the session was shut down, or its middleware has no acknowledgements
                self._await_acknowledgements()
            with suppress(Exception):  # the session was shut down
                for topic, kind, zero in self._zeros.last(self._all_confirm):
                    self._publishers[topic, kind].publish(fill(message_class(kind)(), zero))
            with suppress(Exception):
                self._made.close()
        for topic in self._unheard:
            self._listener.on_unheard(topic, "")

    def _create_publishers(self, topic: str, types: Iterable[str]) -> None:
        """Create the missing publishers. Called with the lock held.

        A message waits for the first publishers of a topic, and for publishers with a subscriber of an earlier session,
        which is owed a zero.
        """
        is_first = all(name != topic for name, _ in self._publishers)
        for key in {(topic, kind) for kind in types} - self._publishers.keys():
            self._publishers[key] = self._publisher(key)
            if is_first or key in self._matched:
                self._unmatched.add(key)

    def _publisher(self, key: tuple[str, str]) -> Any:
        from rclpy.qos import QoSProfile

        topic, message_type = key

        def refused(event: Any) -> None:
            self._unheard.add(topic)
            self._listener.on_unheard(topic, not_received(topic, _policy(event)))

        def make(on_event: Any) -> Any:
            kind = message_class(message_type)
            return self._node.create_publisher(kind, topic, QoSProfile(depth=1), event_callbacks=on_event)

        return _with_events(make, "PublisherEventCallbacks", refused)

    def _await_match(self, key: tuple[str, str], until: float) -> bool:
        """Wait for a subscriber of another node, which would miss earlier messages. Return True if it is matched."""
        topic, message_type = key
        while not self._is_matched(self._publishers[key], key):
            wanted = self._types_wanted(topic)
            may_come = message_type in wanted or (self.is_young and not wanted)
            if not may_come or self._clock.now() >= until:
                return False
            self._clock.sleep(_MATCH_POLL)
        return True

    def _types_wanted(self, topic: str) -> set[str]:
        return {info.topic_type for info in self._others(self._node.get_subscriptions_info_by_topic(topic))}

    def _is_matched(self, publisher: Any, key: tuple[str, str]) -> bool:
        """Return True if a subscriber of another node is matched."""
        ours = sum((wish.topic, wish.type) == key for wish in list(self._subscriptions))
        return bool(publisher.get_subscription_count() > ours)

    def _note_matches(self) -> None:
        """Note which publishers have been matched, and report a subscriber that was discovered too late for a zero."""
        matched = {key for key, publisher in list(self._publishers.items()) if self._is_matched(publisher, key)}
        self._matched |= matched
        if self._missed & matched:
            self._missed -= matched
            self._listener.on_connected()

    def _await_acknowledgements(self) -> None:
        from rclpy.duration import Duration

        until = self._published_at + SEND_TIMEOUT  # a subscriber that has not confirmed by then may be gone
        for publisher in self._publishers.values() if self._clock.now() < until else ():
            # In short steps, because rclpy holds the GIL while it waits.
            while not publisher.wait_for_all_acked(Duration(seconds=_ACK_POLL)) and self._clock.now() < until:
                pass

    def _all_matched(self, topic: str, wants: Iterable[Any]) -> bool:
        """Return True if all subscribers of a topic are matched with our publishers."""
        types = [info.topic_type for info in wants]
        return all(
            publisher.get_subscription_count() >= types.count(message_type)
            for (name, message_type), publisher in list(self._publishers.items())
            if name == topic
        )

    def _others(self, infos: Iterable[Any]) -> list[Any]:
        return [info for info in infos if info.node_name not in (self._name, MARK)]

    def _robots(self, wants: Iterable[Any]) -> list[Any]:
        """Return the subscribers except those of our nodes."""
        return [info for info in self._others(wants) if not _OURS.fullmatch(info.node_name)]

    def _all_confirm(self, topic: str) -> bool:
        return all(map(_is_reliable, self._robots(self._node.get_subscriptions_info_by_topic(topic))))

    def _subscribe(self, wish: _Wish) -> None:
        from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

        topic, kind, kept, each, reliable = wish
        try:
            known = message_class(kind)
        except LookupError as error:
            self._listener.on_trouble(topic, f"{topic} comes as {kind}: {error}")
            return
        # A best-effort subscription also matches reliable publishers. Only transient local needs a reliable one.
        reliable = reliable or kept
        qos = QoSProfile(
            history=HistoryPolicy.KEEP_LAST,
            depth=MOST_UNREAD if each else queue_depth(kind),
            reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE,
        )
        try:
            self._subscriptions[wish] = self._subscription(known, wish, qos)
        except Exception as error:  # a partly installed package may raise any error
            self._listener.on_trouble(topic, f"{topic} cannot be subscribed to as {kind}: {one_line(error)}")

    def _subscription(self, known: Any, wish: _Wish, qos: Any) -> tuple[Any, Any]:
        from rclpy.callback_groups import MutuallyExclusiveCallbackGroup

        topic = wish.topic

        def receive(message: Any) -> None:
            if self._is_wanted(topic):
                self._listener.on_trouble(topic, "")
                each = wish.each or not any(one.each and one.topic == topic for one in self._subscriptions)
                self._listener.on_message(topic, message, newest=not wish.each, each=each)

        def lost(event: Any) -> None:
            self._listener.on_missed(topic, event.total_count_change)

        def refused(event: Any) -> None:
            self._listener.on_trouble(topic, not_coming(topic, _policy(event)))

        def make(on_event: Any) -> tuple[Any, Any]:
            group = MutuallyExclusiveCallbackGroup()  # one for each subscription: see `_drop_unreadable`
            create = self._node.create_subscription
            return create(known, topic, receive, qos, callback_group=group, event_callbacks=on_event), group

        more = {"message_lost": lost} if wish.each else {}
        made: tuple[Any, Any] = _with_events(make, "SubscriptionEventCallbacks", refused, **more)
        return made

    def _drop_unreadable(self, error: Exception) -> bool:
        """End the subscription whose message caused an error, until the next `look`. Return True if one was ended.

        Otherwise its callback group in rclpy would wait forever for the end of a callback that never began.
        """
        stuck = [wish for wish, (entity, group) in self._subscriptions.items() if not group.can_execute(entity)]
        for wish in stuck:
            self._listener.on_trouble(wish.topic, f"a message of {wish.topic} cannot be read: {one_line(error)}")
            self._node.destroy_subscription(self._subscriptions.pop(wish)[0])
        return bool(stuck)


def message_class(message_type: str) -> Any:
    """Return the class of a message. Raise LookupError with a text for the user if it is not installed."""
    from rosidl_runtime_py.utilities import get_message

    try:
        return get_message(message_type)
    except (ImportError, AttributeError, LookupError, ValueError):
        package = message_type.partition("/")[0]
        raise LookupError(
            f"the package {package} is not installed here, or lacks it; install "
            f"ros-<distro>-{package.replace('_', '-')}, or source the workspace that has it, and restart the kernel"
        ) from None


def one_line(error: Exception) -> str:
    """Return the text of an error in one line, or its class if it has no text."""
    return " ".join(str(error).split()) or type(error).__name__


def _is_reliable(info: Any) -> bool:
    from rclpy.qos import ReliabilityPolicy

    return bool(info.qos_profile.reliability == ReliabilityPolicy.RELIABLE)


def _full_name(info: Any) -> str:
    """Return the name of an endpoint's node with its namespace, or empty if it is unknown."""
    return "" if info.node_name in _UNKNOWN else f"{info.node_namespace.rstrip('/')}/{info.node_name}"


def _wishes(topic: str, offers: Iterable[Any]) -> set[_Wish]:
    """Return a subscription for each type. It is transient local only if all publishers are, so that it matches all."""
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    by_type: dict[str, bool] = {}
    for info in offers:
        qos = info.qos_profile
        kept = (qos.durability, qos.reliability) == (DurabilityPolicy.TRANSIENT_LOCAL, ReliabilityPolicy.RELIABLE)
        by_type[info.topic_type] = by_type.get(info.topic_type, True) and kept
    return {_Wish(topic, kind, kept) for kind, kept in by_type.items()}


def _wish_for_each(wish: _Wish, offers: Iterable[Any]) -> _Wish:
    """Return the subscription to every message for a subscription. It is reliable only if all publishers are."""
    same = [info for info in offers if info.topic_type == wish.type]
    return wish._replace(each=True, reliable=all(map(_is_reliable, same)))


def _with_events(
    make: Callable[[Any], Any], callbacks: str, refused: Callable[[Any], None], **more: Callable[[Any], None]
) -> Any:
    """Return what ``make`` makes with event callbacks. ``refused`` is called for an endpoint with an incompatible QoS.

    Events that the ROS middleware does not support are left out. With Zenoh, every endpoint is compatible.
    """
    try:
        from rclpy import event_handler as events
    except ImportError:  # before Iron
        from rclpy import qos_event as events
    callbacks_of = getattr(events, callbacks)
    for there in ({"incompatible_qos": refused, **more}, {"incompatible_qos": refused}, more):
        with suppress(events.UnsupportedEventTypeError):
            return make(callbacks_of(use_default_callbacks=False, **there))
    return make(callbacks_of(use_default_callbacks=False))


def _policy(event: Any) -> str:
    """Return the name of the policy that last made an endpoint incompatible with ours."""
    from rclpy.qos import qos_policy_name_from_kind

    return str(qos_policy_name_from_kind(event.last_policy_kind)).lower()

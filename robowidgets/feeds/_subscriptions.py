"""The topics of a feed, the targets connected to them, and their status on each widget."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Sequence
from typing import Any
from uuid import uuid4

from ..driving.command_watchdog import Velocity
from ..kinds import on_demand_for_type, sensor_of, title_of, topic_and_field
from ..messages.twist import TWIST
from ..poses.live_mounts import LiveMounts
from ..runtime.clock import Clock, Threads
from ..runtime.coalesced_call import CoalescedCall
from ..samples import Speed
from ..widget.observed import Observed
from ..widget.sample_widget import SampleWidget
from ..widget.title_observers import TitleObservers
from ._callbacks import FunctionCaller
from ._subscription import Subscription, Target
from ._topics import FeedTopic, check_name, decided, topics_of, unlisted
from .middleware import Advert, FeedError, Middleware

DISCOVERY_TIMEOUT_S = 2.0
"""Seconds after opening for which `show`, `drive` and `stop` wait for the topics and for a subscriber."""

CLOSED = "the feed is closed"
"""The status of a closed feed."""

_Connected = tuple[Subscription, Target]


class Subscriptions(Observed):
    """The topics of a feed and the targets connected to them: the part of `Connection` that its other parts use.

    Args:
        middleware: the connection to the robot.
        clock: the clock of its waits.

    Attributes:
        page_name: the name of this robot on the page, which its widgets share.
        functions: the connected functions.
        mounts: the mounting angles of the scanners on the robot.
        by_topic: the subscriptions by topic.
        adverts: the topics as the middleware listed them last.
        is_listed: True once the middleware has listed the topics.
        is_closed: True if the feed was closed, or this is a forked process.
        is_forked: True if it belongs to the parent of this forked process.
        nobody: hint to show if no robot may be there although it is connected, or empty if a robot is there.
        sent_count: the number of sent speeds, including zero.
        black_box, black_box_troubles: the state of the black box in one line, or empty without one, and the reasons why
            it keeps nothing or writes no file.
    """

    def __init__(self, middleware: Middleware, clock: Clock) -> None:
        super().__init__()
        self.clock = clock
        self.middleware = middleware
        self._lock = threading.RLock()
        self._changed = clock.condition(self._lock)
        self._opened = clock.now()
        self.page_name = uuid4().hex
        self.mounts = LiveMounts()
        self.functions = FunctionCaller(self._show_status, mounted=self.mounts.mounted)
        self._titles = TitleObservers(Threads(clock))
        self.by_topic: dict[str, Subscription] = {}
        self._widgets: dict[SampleWidget, list[_Connected]] = {}
        self._topics: dict[str, FeedTopic] | None = None
        """The known topics by name, or None until they are listed."""
        self._down = f"connecting to {middleware.where}"
        """The reason why no message can come on any topic, or empty."""
        self.adverts: tuple[Advert, ...] = ()
        self.nobody = ""
        self.black_box = ""
        self.black_box_troubles: tuple[str, ...] = ()
        self.sent_count = 0
        self._reached = self.is_listed = self.is_closed = self.is_forked = False
        self._driven: str | None = None
        """The topic on which this feed publishes speeds and no other node publishes anything."""
        self._decided: dict[str, FeedTopic] = {}
        """The topics whose widget was chosen by a message."""
        self._subscribe = CoalescedCall(self._follow_connected)

    @property
    def where(self) -> str:
        """See `Feed.where`."""
        return self.middleware.where

    @property
    def topics(self) -> tuple[FeedTopic, ...]:
        """See `Feed.topics`."""
        return tuple((self._topics or {}).values())

    @property
    def status(self) -> str:
        """See `Feed.status`."""
        return CLOSED if self.is_closed else self._down

    @property
    def widgets(self) -> tuple[SampleWidget, ...]:
        """The connected widgets, once each."""
        return tuple(self._widgets)

    @property
    def connected(self) -> dict[str, tuple[Target, ...]]:
        """The targets of the messages of each topic, except connected functions."""
        return {topic: one.targets for topic, one in dict(self.by_topic).items()}

    @property
    def is_settled(self) -> bool:
        """True once the topics are listed and there was time to discover them after opening."""
        return self.is_listed and self.clock.now() >= self._opened + DISCOVERY_TIMEOUT_S

    def check_open(self, *topics: Any) -> None:
        """Raise FeedError unless the feed is open in this process, and TypeError or ValueError for invalid names."""
        for topic in topics:
            check_name(topic)
        if self.is_closed:
            why = "belongs to the parent of this forked process" if self.is_forked else "is closed"
            raise FeedError(f"the feed of {self.where} {why}: open it again")

    def wait_until(self, condition: Callable[[], bool], seconds: float) -> None:
        """Wait for at most some seconds until a condition is true or the feed is closed."""
        until = self.clock.now() + seconds
        with self._lock:
            while not condition() and not self.is_closed and self._changed.wait_until(until):
                pass

    def await_topics(self, names: Collection[str]) -> None:
        """Wait a moment until these topics or fields can be shown, or any topic if no names are given."""

        def are_there() -> bool:
            if not names:
                return any(topic.widget for topic in self.topics)
            there = {topic.name for topic in self.topics if topic.widget or on_demand_for_type(topic.type)}
            return there.issuperset(topic_and_field(name, there)[0] for name in names)

        self.wait_until(are_there, DISCOVERY_TIMEOUT_S)

    def await_subscriber(self, topic: str) -> None:
        """Wait on a newly opened feed for the connection and for a subscriber of a topic."""
        self.wait_until(
            lambda: self._reached and (self.status not in ("", self.nobody) or self._has_subscriber(topic)),
            self._opened + DISCOVERY_TIMEOUT_S - self.clock.now(),
        )

    def why_missing(self, topic: str) -> str:
        """Return the reason why a connected topic will send nothing until something changes, or empty if unknown."""
        if self.clock.now() < self._opened + DISCOVERY_TIMEOUT_S:
            return ""
        subscription = self.by_topic.get(topic)
        return self.status or ("" if subscription is None else subscription.why_missing(self._topics))

    def topic_of(self, name: str) -> FeedTopic:
        """Return a topic as it is known now."""
        return (self._topics or {}).get(name) or unlisted(name)

    def status_of(self, topic: str) -> str:
        """Return the problems of a topic, connected or not, or empty."""
        with self._lock:
            subscription = self.by_topic.get(topic) or Subscription(topic, self.clock.now)
            status = self._down or subscription.status(self._topics)
            return "; ".join(filter(None, (status, self.functions.status_of(topic))))

    def trouble_of(self, topic: str) -> str:
        """Return the middleware's reason why a topic's messages do not come or cannot be read, or empty."""
        subscription = self.by_topic.get(topic)
        return subscription.trouble if subscription is not None else ""

    def mounted(self, sample: Any) -> Any:
        """Return a scan with the angles of the robot if the mount of its scanner is known, or any sample unchanged."""
        return self.mounts.mounted(sample)

    # -- targets -------------------------------------------------------------------------------------------------------

    def attach(
        self, topic: str, take: Callable[[Any], object], on_missed: Callable[[int], object] | None = None
    ) -> Target:
        """Pass the messages of a topic to code of this package, in the thread of the transport. It must return at once.

        With ``on_missed`` it gets every message, and ``on_missed`` gets the number of lost messages.
        """
        target = Target(take, None, on_missed)
        self.attach_target(topic, target)
        return target

    def attach_target(self, topic: str, target: Target) -> None:
        """Attach a target as `attach` does. The caller knows the target before its first message."""
        self._connect(topic, [target])
        self._titles.call_later()

    def detach(self, topic: str, target: Target) -> None:
        """End an `attach`."""
        with self._lock:
            self._disconnect(topic, [target])
        self._subscribe()
        self._titles.call_later()

    def _connect(self, topic: str, targets: Sequence[Target]) -> tuple[Any, ...]:
        """Add new targets to a topic. Return the message that its publisher keeps for new subscribers.

        Raises:
            ValueError: a widget has a sensor of this name from another topic.
        """
        with self._lock:
            self.check_open()
            for target in targets:
                connected = [] if target.widget is None else self._widgets.get(target.widget, [])
                if target.is_of_sensor and (other := _other_topic(topic, target, connected)):
                    raise ValueError(
                        f"connect({topic!r}): the widget has a sensor {sensor_of(topic)!r}, from {other}; connect a "
                        "function that gives it another name: lambda message: widget.update('another', message)"
                    )
            subscription = self.by_topic.get(topic)
            if subscription is None:
                subscription = self.by_topic[topic] = Subscription(topic, self.clock.now)
                subscription.update((self._topics or {}).get(topic))
            kept = subscription.kept
            new = []
            for target in targets:
                if target in subscription.targets:
                    continue
                subscription.targets += (target,)
                new.append(target)
                if target.widget is not None:
                    self._widgets.setdefault(target.widget, []).append((subscription, target))
            self._show(subscription)
        self._subscribe()
        subscription.pass_kept(kept, new)  # without the lock, as for a new message
        return kept

    def _disconnect(self, topic: str, targets: Sequence[Target] | None) -> None:
        """Remove these targets from a topic, or its widgets if None. Called with the lock held."""
        subscription = self.by_topic.get(topic)
        if subscription is None:
            return
        widgets = [target for target in subscription.targets if target.widget is not None]
        gone = widgets if targets is None else targets
        subscription.targets = tuple(target for target in subscription.targets if target not in gone)
        for target in gone:
            if target.widget is not None:
                left = [pair for pair in self._widgets.pop(target.widget, []) if pair != (subscription, target)]
                if left:
                    self._widgets[target.widget] = left
                self._show_on(target.widget)
        self._prune()

    def _prune(self) -> None:
        """Remove the subscriptions without a target and without a function. Called with the lock held."""
        used = {function.topic for function in self.functions.functions}
        self.by_topic = {topic: one for topic, one in self.by_topic.items() if one.targets or topic in used}

    def _follow_connected(self) -> None:
        """Make the middleware pass on the connected topics."""
        with self._lock:
            topics = frozenset(self.by_topic)
            each = frozenset(
                topic for topic, one in self.by_topic.items() if one.passes_each or self.functions.passes_each(topic)
            )
        # Without the lock: the middleware may take a lock that one of its threads holds while waiting for ours.
        if not self.is_closed:
            self.middleware.follow(topics, each)

    # -- topics --------------------------------------------------------------------------------------------------------

    def decide(self, topic: FeedTopic, message: Any) -> None:
        """List the widget that can show the messages of a topic, decided by this message."""
        found = decided(topic, message)
        if found.widget:
            with self._lock:
                self._decided[topic.name] = found
                self._list_topics()
            self._call_observers()

    def list_driven(self, topic: str) -> None:
        """List a topic on which only this feed publishes, so that a widget can show what is sent."""
        if topic != self._driven:
            self._driven = topic
            with self._lock:
                self._list_topics()
            self._call_observers()

    def show_sent(self, topic: str, speed: Speed) -> None:
        """Show a sent speed as commanded, unless the middleware reports it like messages of other publishers."""
        self.sent_count += 1
        self._show_speed(topic, speed)

    def show_beside(self, topic: str, velocity: Velocity) -> None:
        """Show a speed that another feed of this process has sent to the same robot through the same guard."""
        if self._driven is None:
            self.list_driven(topic)
        self._show_speed(topic, velocity.as_speed)

    def on_driving(self) -> None:
        """Show changed settings of driving: a pad has a knob for each direction in which the robot moves."""
        self._call_observers()

    def show_black_box(self, line: str, troubles: tuple[str, ...] = ()) -> None:
        """Show the state of the black box on the screen, or nothing if it is empty, and its troubles."""
        if (line, troubles) != (self.black_box, self.black_box_troubles):
            self.black_box, self.black_box_troubles = line, troubles
            self._call_observers()

    def _show_speed(self, topic: str, speed: Speed) -> None:
        subscription = self.by_topic.get(topic)
        if subscription is not None and not self.topic_of(topic).offered:
            subscription.take(speed)
            users = [target.call for target in subscription.targets if not target.is_ours]
            self.functions.put(self.topic_of(topic), speed, users)
            self._show_status(topic)

    def _has_subscriber(self, topic: str) -> bool:
        """Return True if a topic has a subscriber, or if the middleware does not report subscribers at all."""
        known = [advert.wanted for advert in self.adverts if advert.wanted is not None]
        here = any(advert.name == topic and advert.wanted for advert in self.adverts)
        return self.is_listed and (here or bool(self.adverts and not known))

    def _list_topics(self) -> None:
        """Update the known topics. Called with the lock held."""
        adverts = list(self.adverts)
        if self._driven is not None and all(advert.name != self._driven for advert in adverts):
            reports = any(advert.wanted is not None for advert in adverts)
            adverts.append(Advert(self._driven, TWIST, offered=False, wanted=False if reports else None))
        topics = topics_of(adverts)
        driven = topics.get(self._driven or "")
        if driven is not None and not driven.offered:  # regardless of its name
            topics[driven.name] = driven._replace(commanded=True)
        for name, found in self._decided.items():
            if name in topics and topics[name].type == found.type:
                topics[name] = topics[name]._replace(widget=found.widget, commanded=found.commanded)
        self._topics = topics
        for subscription in self.by_topic.values():
            subscription.update(topics.get(subscription.topic))
        self._show_all()

    def _free_lock(self) -> None:
        """Replace the lock in a forked process. The threads stayed in the parent process and may have held it."""
        self._lock = threading.RLock()
        self._changed = self.clock.condition(self._lock)

    def _lose(self, why: str) -> None:
        """Set the reason why no message comes until the robot is connected again. Called with the lock held."""
        self._down = why
        for subscription in self.by_topic.values():
            subscription.receives = False
        self._show_all()

    # -- status --------------------------------------------------------------------------------------------------------

    def _call_observers(self) -> None:
        self._titles.call()
        super()._call_observers()

    def _show_status(self, topic: str) -> None:
        """Show the status of a topic, if it is connected."""
        with self._lock:
            self._show(self.by_topic.get(topic))
        self._titles.call()

    def _show(self, subscription: Subscription | None) -> None:
        """Show the status on the widgets of a subscription, if any. Called with the lock held."""
        for target in subscription.targets if subscription is not None else ():
            if target.widget is not None:
                self._show_on(target.widget)

    def _show_all(self) -> None:
        """Show the status on every widget. Called with the lock held."""
        for widget in self._widgets:
            self._show_on(widget)

    def _show_on(self, widget: SampleWidget) -> None:
        connected = sorted(self._widgets.get(widget, []), key=_rank)
        if not connected:
            widget.set_source({})
            return
        self._set_titles(widget, connected)
        first = connected[0][0]
        counted = self._without_replaced(widget, connected)
        listed = [one.status(self._topics, is_primary=one is first) for one in counted]
        failed = (self.functions.status_of(subscription.topic) for subscription, _ in connected)
        source = {
            "robot": self.page_name,
            "topic": first.topic,
            "type": first.type,
            "status": self._down or "; ".join(dict.fromkeys(filter(None, listed))),
            "error": "; ".join(filter(None, failed)),
            "lost": bool(self._down) and not first.receives,
        }
        widget.set_source(source, self._down or first.why_missing(self._topics))

    def _set_titles(self, widget: SampleWidget, connected: Sequence[_Connected]) -> None:
        """Name a widget after the first topic of each of its methods, or after the namespace of several topics."""
        titled: dict[str, list[str]] = {}
        for subscription, target in connected:
            topics = titled.setdefault(target.title, [])
            if not topics or target.is_of_sensor:
                topics.append(subscription.topic)
        for title, topics in titled.items():
            if widget.has_trait(title):
                self._titles.add(widget.name_quietly(title_of(topics), title))

    def _without_replaced(self, widget: SampleWidget, connected: Sequence[_Connected]) -> list[Subscription]:
        """Return the subscriptions without missing topics whose target gets messages of a topic connected later."""
        in_order = self._widgets[widget]
        return [
            subscription
            for subscription, target in connected
            if self._topics is None
            or subscription.topic in self._topics
            or not any(
                later.has_received and target == other
                for later, other in in_order[in_order.index((subscription, target)) + 1 :]
            )
        ]


def _rank(connected: _Connected) -> tuple[bool, bool, bool]:
    """Return a sort key: primary topics first, and among them topics that receive messages, or did."""
    subscription, target = connected
    return not target.is_primary, not subscription.receives, not subscription.has_received


def _other_topic(topic: str, target: Target, connected: Sequence[_Connected]) -> str:
    """Return another topic that has the target already, or empty."""
    return next((one.topic for one, other in connected if other == target and one.topic != topic), "")

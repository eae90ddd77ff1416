"""The subscriptions of a feed, and their status on each widget."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any
from uuid import uuid4

from ..kinds import sensor_of, title_of
from ..widget.sample_widget import SampleWidget
from ..widget.title_observers import TitleObservers
from ._callbacks import FunctionCaller
from ._subscription import Subscription, Target
from ._topics import FeedTopic

_Connected = tuple[Subscription, Target]


CLOSED = "the feed is closed"
"""The status of a closed feed."""


class SubscriptionTable:
    """The subscriptions of a feed, by topic. The feed holds its lock during each change.

    Args:
        down: the initial reason why no message comes on any topic.
        functions: the connected functions.
        titles: calls the observers of changed titles after the feed has released its lock.
        now: the clock.

    Attributes:
        robot: the name that all widgets of the feed share on the page.
        topics: the known topics by name, or None until they are listed.
        down: the reason why no message can come on any topic, or empty.
    """

    def __init__(self, down: str, functions: FunctionCaller, titles: TitleObservers, now: Callable[[], float]) -> None:
        self._functions, self._titles, self._now = functions, titles, now
        self.robot = uuid4().hex
        self.by_topic: dict[str, Subscription] = {}
        self.topics: dict[str, FeedTopic] | None = None
        self.down = down
        self._widgets: dict[SampleWidget, list[_Connected]] = {}

    @property
    def widgets(self) -> tuple[SampleWidget, ...]:
        """The connected widgets, once each."""
        return tuple(self._widgets)

    def connect(self, topic: str, targets: Sequence[Target]) -> tuple[Any, ...]:
        """Add new targets to a topic. Return the message that its publisher keeps for new subscribers.

        Raises:
            ValueError: a widget has a sensor of this name from another topic.
        """
        for target in targets:
            connected = [] if target.widget is None else self._widgets.get(target.widget, [])
            if target.is_of_sensor and (other := _other_topic(topic, target, connected)):
                raise ValueError(
                    f"connect({topic!r}): the widget has a sensor {sensor_of(topic)!r}, from {other}; connect a "
                    "function that gives it another name: lambda message: widget.update('another', message)"
                )
        subscription = self.by_topic.get(topic)
        if subscription is None:
            subscription = self.by_topic[topic] = Subscription(topic, self._now)
            subscription.update((self.topics or {}).get(topic))
        kept = subscription.kept
        for target in targets:
            if target in subscription.targets:
                continue
            subscription.targets += (target,)
            if target.widget is not None:
                self._widgets.setdefault(target.widget, []).append((subscription, target))
        self.show(subscription)
        return kept

    def begin(self) -> None:
        """Note that messages can come, because the robot is connected, perhaps again."""
        self.down = ""
        for subscription in self.by_topic.values():
            subscription.begin()
        self.show_all()

    def disconnect(self, topic: str, targets: Sequence[Target] | None) -> None:
        """Remove these targets from a topic, or its widgets if None."""
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
        self.prune()

    def prune(self) -> None:
        """Remove the subscriptions without a target and without a function."""
        used = {function.topic for function in self._functions.functions}
        self.by_topic = {topic: one for topic, one in self.by_topic.items() if one.targets or topic in used}

    def learn(self, topics: dict[str, FeedTopic]) -> None:
        """Replace the known topics."""
        self.topics = topics
        for subscription in self.by_topic.values():
            subscription.update(topics.get(subscription.topic))
        self.show_all()

    def lose(self, why: str) -> None:
        """Set the reason why no message comes until the robot is connected again."""
        self.down = why
        for subscription in self.by_topic.values():
            subscription.receives = False
        self.show_all()

    def close(self) -> None:
        """Report that no message can come any more."""
        self.lose(CLOSED)
        for widget in self._widgets:
            widget.on_source_closed()

    def status_of(self, topic: str) -> str:
        """Return the problems of a topic, connected or not, or empty."""
        status = self.down or (self.by_topic.get(topic) or Subscription(topic, self._now)).status(self.topics)
        return "; ".join(filter(None, (status, self._functions.status_of(topic))))

    def show(self, subscription: Subscription) -> None:
        """Show the status on the widgets of a subscription."""
        for target in subscription.targets:
            if target.widget is not None:
                self._show_on(target.widget)

    def show_all(self) -> None:
        """Show the status on every widget."""
        for widget in self._widgets:
            self._show_on(widget)

    def _show_on(self, widget: SampleWidget) -> None:
        connected = sorted(self._widgets.get(widget, []), key=_rank)
        if not connected:
            widget.set_source({})
            return
        self._set_titles(widget, connected)
        first = connected[0][0]
        listed = [one.status(self.topics, is_primary=one is first) for one in self._without_replaced(widget, connected)]
        failed = (self._functions.status_of(subscription.topic) for subscription, _ in connected)
        source = {
            "robot": self.robot,
            "topic": first.topic,
            "type": first.type,
            "status": self.down or "; ".join(dict.fromkeys(filter(None, listed))),
            "error": "; ".join(filter(None, failed)),
            "lost": bool(self.down) and not first.receives,
        }
        widget.set_source(source, self.down or first.why_missing(self.topics))

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
            if self.topics is None
            or subscription.topic in self.topics
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

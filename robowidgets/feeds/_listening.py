"""The newest values of a robot's topics, and their rates, while a view shows them."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from math import isfinite
from typing import Any, NamedTuple

from ..messages.infrastructure import is_large
from ..runtime.clock import Scheduler
from ..runtime.clock import scheduler as threads
from ..runtime.log_once import LogOnce
from ..samples.staleness import SEEN_FOR
from ..widget.rate import SHORTEST, RateMeter
from ._subscription import Target
from ._subscriptions import Subscriptions
from .middleware import FeedError

log = logging.getLogger("robowidgets")

UPDATE_PERIOD_S = 0.5
"""Seconds between two updates."""

MAX_TOPICS = 60
"""The largest number of topics to follow, in addition to topics that are connected to a target."""

PROBED_RATE_HZ = 100.0
"""Messages per second from which a topic is only probed, as a topic with large messages is."""

PROBE_MESSAGES = 3
"""The least number of messages of a large topic in a probe, enough for a rate."""

PROBE_TIMEOUT_S = 2.0
"""The longest duration of a probe, in seconds."""

PROBE_PAUSE_S = 15.0
"""Seconds between two probes of a topic."""


class TopicStats:
    """The statistics and the last message of a topic.

    Attributes:
        count: the number of received messages.
        came_at: the time of the last message.
        message: the last message.
        rate: messages per second, or None while unknown.
        is_probed: True if the topic is only probed now and then, so that its count is incomplete.
        timed_out: True if no message came during the whole last probe.
        has_seen_enough: True once the end of a probe was requested.
    """

    def __init__(self) -> None:
        self.count, self.came_at, self.message = 0, 0.0, None
        self.rate: float | None = None
        self.is_probed = self.timed_out = False
        self.target: Target | None = None
        self.again_at = float("-inf")
        """The time from which the topic may be probed again."""
        self.begin(float("-inf"))

    def begin(self, until: float) -> None:
        """Start a new measurement of the rate, after a time without a subscription."""
        self.until, self._first_at, self.came, self.is_measured = until, 0.0, 0, False
        self.has_seen_enough = False
        self._meter = RateMeter()

    def take(self, message: Any, now: float) -> None:
        """Keep a message."""
        self._first_at = self._first_at if self.came else now
        self.count, self.came, self.came_at, self.message = self.count + 1, self.came + 1, now, message
        self.timed_out = False

    def count_replaced(self, count: int) -> None:
        """Count messages that a later one replaced, but not before the first, because the rate counts from its time."""
        if self.came:
            self.count, self.came = self.count + count, self.came + count

    def measure(self) -> None:
        """Measure the rate. It is called repeatedly, because the meter samples the counter only then."""
        rate = self._meter.rate(self.came, self.came_at)
        if not isfinite(rate) and self.is_probed and self.shows_rate:
            rate = (self.came - 1) / (self.came_at - self._first_at)
        if isfinite(rate):
            self.rate, self.is_measured = round(rate, 2), True

    @property
    def shows_rate(self) -> bool:
        """True if a probe has seen enough messages for a rate, over a time long enough to average bursts."""
        return self.came >= PROBE_MESSAGES and self.came_at - self._first_at >= SHORTEST

    @property
    def shows_silence(self) -> bool:
        """True if its age shows a missing message, which is not known while the topic is not subscribed to."""
        return not self.is_probed or self.timed_out

    def age(self, now: float) -> float:
        """Return the seconds since the last message."""
        return round(now - self.came_at, 2)


class _Watcher(NamedTuple):
    """The topics that a view shows, and the time until which it follows them."""

    names: Callable[[], Iterable[str]]
    until: float


class Listening:
    """Subscriptions to topics of a feed while a view shows them, and for a moment after that.

    Small and slow topics stay subscribed to. A topic with large or very frequent messages is probed now and then, one
    topic at a time, unless another target gets its messages anyway.

    Args:
        connection: the connection of the feed.
        scheduler: the scheduler of its timers, with their clock.
    """

    def __init__(self, connection: Subscriptions, scheduler: Scheduler = threads) -> None:
        self._connection, self._scheduler = connection, scheduler
        self._now = scheduler.clock.now
        self._lock = threading.RLock()
        self._watchers: dict[Callable[[bool], object], _Watcher] = {}
        self._stats: dict[str, TopicStats] = {}
        self._ticks = False
        self._log = LogOnce(log.error)

    def look(self, on_update: Callable[[bool], object], names: Callable[[], Iterable[str]] | None) -> None:
        """Follow topics for a view, which must call this again within `SEEN_FOR`.

        Args:
            on_update: called with True twice a second, in the thread of timers, and with False when following ends.
            names: returns the names of the topics, the most wanted first; or None to end following.
        """
        with self._lock:
            if names is None:
                if on_update in self._watchers:
                    self._watchers[on_update] = self._watchers[on_update]._replace(until=float("-inf"))
                return
            self._watchers[on_update] = _Watcher(names, self._now() + SEEN_FOR)
            if self._ticks:
                return
            self._ticks = True
        self._scheduler.call_at(self._now(), self._tick)

    def of(self, topic: str) -> TopicStats | None:
        """Return the statistics of a topic, or None while it is not followed."""
        return self._stats.get(topic)

    @property
    def now(self) -> float:
        """The current time in seconds."""
        return self._now()

    @property
    def used(self) -> set[str]:
        """The topics whose messages another target gets."""
        used = {function.topic for function in self._connection.functions.functions}
        for name, targets in self._connection.connected.items():
            stats = self._stats.get(name)
            if any(stats is None or target is not stats.target for target in targets):
                used.add(name)
        return used

    def _tick(self) -> None:
        """Update the subscriptions and the views, or end them. It runs in the thread of timers."""
        with self._lock:
            now, is_closed = self._now(), self._connection.is_closed
            gone = [one for one, watcher in self._watchers.items() if is_closed or now >= watcher.until]
            for one in gone:
                del self._watchers[one]
            watchers = dict(self._watchers)
            self._ticks = bool(watchers)
        try:
            with suppress(FeedError):  # the feed was closed in the meantime, and reports it itself
                self._follow([name for watcher in watchers.values() for name in watcher.names()], now)
            for stats in list(self._stats.values()):
                stats.measure()
            for on_update in (*gone, *watchers):
                self._update(on_update, on_update in watchers)
        finally:
            if watchers:
                self._scheduler.call_at(now + UPDATE_PERIOD_S, self._tick)

    def _update(self, on_update: Callable[[bool], object], is_seen: bool) -> None:
        """Update a view. An error of one view, for example for a message, does not stop the others."""
        try:
            on_update(is_seen)
        except Exception as error:
            self._log(f"the values of topics could not be shown: {type(error).__name__}: {error}", exc_info=True)

    def _follow(self, names: Iterable[str], now: float) -> None:
        """Follow these topics, and no others."""
        topics, used = {topic.name: topic for topic in self._connection.topics}, self.used
        wanted = dict.fromkeys(name for name in names if name in topics)
        unused = [name for name in wanted if name not in used and topics[name].offered and topics[name].type]
        followed = {*unused[:MAX_TOPICS], *(wanted.keys() & used)}
        for name in self._stats.keys() - followed:
            self._unsubscribe(name)
            del self._stats[name]
        is_probing = any(one.is_probed and one.target is not None for one in self._stats.values())
        for name in (name for name in wanted if name in followed):
            stats = self._stats.setdefault(name, TopicStats())
            large = is_large(topics[name].type)
            stats.is_probed = name not in used and (large or (stats.rate or 0) >= PROBED_RATE_HZ)
            if stats.target is not None:
                if stats.is_probed and (now >= stats.until or (stats.is_measured and not large)):
                    stats.timed_out = not stats.came
                    self._unsubscribe(name)
            elif not stats.is_probed or (now >= stats.again_at and not is_probing):
                is_probing |= stats.is_probed
                stats.begin(now + PROBE_TIMEOUT_S)
                stats.target = Target(partial(self._take, name, stats), None, on_replaced=stats.count_replaced)
                self._connection.attach_target(name, stats.target)

    def _unsubscribe(self, name: str) -> None:
        """End the subscription to a topic for some time."""
        with self._lock:
            stats = self._stats.get(name)
            if stats is None or stats.target is None:
                return
            target, stats.target = stats.target, None
            stats.again_at = self._now() + PROBE_PAUSE_S
        self._connection.detach(name, target)

    def _take(self, name: str, stats: TopicStats, message: Any) -> None:
        """Keep a message. It runs in the thread of the transport."""
        now = self._now()
        stats.take(message, now)
        if stats.is_probed and stats.shows_rate and not stats.has_seen_enough:
            stats.has_seen_enough = True
            self._scheduler.call_at(now, partial(self._end_probe, name))

    def _end_probe(self, name: str) -> None:
        """End a probe of large messages that has seen enough. It runs in the thread of timers."""
        stats = self._stats.get(name)
        topic = next((topic for topic in self._connection.topics if topic.name == name), None)
        if stats is not None and topic is not None and stats.is_probed and is_large(topic.type):
            stats.measure()
            self._unsubscribe(name)

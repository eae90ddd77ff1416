"""The newest values of a robot's topics, and their rates, while a view shows them."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from math import isfinite
from typing import Any, NamedTuple, Protocol

from .._core.clock import Scheduler
from .._core.clock import scheduler as threads
from .._core.log_once import LogOnce
from .._core.rate import SHORTEST, RateMeter
from ..messages.infrastructure import is_large
from ..samples.staleness import SEEN_FOR
from ._callbacks import FunctionCaller
from ._links import TopicLink
from ._subscription import Target
from .middleware import FeedError

log = logging.getLogger("robowidgets")

PERIOD = 0.5
"""Seconds between two updates."""

MOST_HEARD = 60
"""The largest number of topics to follow, in addition to topics that are connected to a target."""

FAST = 100.0
"""Messages per second from which a topic is only probed, as a topic with large messages is."""

GLANCE = 3
"""The least number of messages of a large topic in a probe, enough for a rate."""

PATIENCE = 2.0
"""The longest duration of a probe, in seconds."""

PAUSE = 15.0
"""Seconds between two probes of a topic."""


class Listened(TopicLink, Protocol):
    """The part of a connection that is used here."""

    functions: FunctionCaller

    @property
    def is_closed(self) -> bool:
        """True once no message can come any more."""

    @property
    def connected(self) -> dict[str, tuple[Target, ...]]:
        """The targets of the messages of each topic, except connected functions."""


class Heard:
    """The statistics and the last message of a topic.

    Attributes:
        count: the number of received messages.
        came_at: the time of the last message.
        message: the last message.
        rate: messages per second, or None while unknown.
        is_glanced_at: True if the topic is only probed now and then, so that its count is incomplete.
        is_missed: True if no message came during the whole last probe.
        has_seen_enough: True once the end of a probe was requested.
    """

    def __init__(self) -> None:
        self.count, self.came_at, self.message = 0, 0.0, None
        self.rate: float | None = None
        self.is_glanced_at = self.is_missed = False
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
        self.is_missed = False

    def count_replaced(self, count: int) -> None:
        """Count messages that a later one replaced, but not before the first, because the rate counts from its time."""
        if self.came:
            self.count, self.came = self.count + count, self.came + count

    def measure(self) -> None:
        """Measure the rate. It is called repeatedly, because the meter samples the counter only then."""
        rate = self._meter.rate(self.came, self.came_at)
        if not isfinite(rate) and self.is_glanced_at and self.shows_rate:
            rate = (self.came - 1) / (self.came_at - self._first_at)
        if isfinite(rate):
            self.rate, self.is_measured = round(rate, 2), True

    @property
    def shows_rate(self) -> bool:
        """True if a probe has seen enough messages for a rate, over a time long enough to average bursts."""
        return self.came >= GLANCE and self.came_at - self._first_at >= SHORTEST

    @property
    def tells_silence(self) -> bool:
        """True if its age shows a missing message, which is not known while the topic is not subscribed to."""
        return not self.is_glanced_at or self.is_missed

    def age(self, now: float) -> float:
        """Seconds since the last message came."""
        return round(now - self.came_at, 2)


class _Looker(NamedTuple):
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

    def __init__(self, connection: Listened, scheduler: Scheduler = threads) -> None:
        self._connection, self._scheduler = connection, scheduler
        self._now = scheduler.clock.now
        self._lock = threading.RLock()
        self._lookers: dict[Callable[[bool], object], _Looker] = {}
        self._heard: dict[str, Heard] = {}
        self._ticks = False
        self._log = LogOnce(log.error)

    def look(self, on_heard: Callable[[bool], object], names: Callable[[], Iterable[str]] | None) -> None:
        """Follow topics for a view, which must call this again within `SEEN_FOR`.

        Args:
            on_heard: called with True twice a second, in the thread of timers, and with False when following ends.
            names: returns the names of the topics, the most wanted first; or None to end following.
        """
        with self._lock:
            if names is None:
                if on_heard in self._lookers:
                    self._lookers[on_heard] = self._lookers[on_heard]._replace(until=float("-inf"))
                return
            self._lookers[on_heard] = _Looker(names, self._now() + SEEN_FOR)
            if self._ticks:
                return
            self._ticks = True
        self._scheduler.call_at(self._now(), self._tick)

    def of(self, topic: str) -> Heard | None:
        """Return the statistics of a topic, or None while it is not followed."""
        return self._heard.get(topic)

    @property
    def now(self) -> float:
        """The current time in seconds."""
        return self._now()

    @property
    def used(self) -> set[str]:
        """The topics whose messages another target gets."""
        used = {function.topic for function in self._connection.functions.functions}
        for name, targets in self._connection.connected.items():
            heard = self._heard.get(name)
            if any(heard is None or target is not heard.target for target in targets):
                used.add(name)
        return used

    def _tick(self) -> None:
        """Update the subscriptions and the views, or end them. It runs in the thread of timers."""
        with self._lock:
            now, is_closed = self._now(), self._connection.is_closed
            gone = [one for one, looker in self._lookers.items() if is_closed or now >= looker.until]
            for one in gone:
                del self._lookers[one]
            lookers = dict(self._lookers)
            self._ticks = bool(lookers)
        try:
            with suppress(FeedError):  # the feed was closed in the meantime, and reports it itself
                self._hear([name for looker in lookers.values() for name in looker.names()], now)
            for heard in list(self._heard.values()):
                heard.measure()
            for on_heard in (*gone, *lookers):
                self._tell(on_heard, on_heard in lookers)
        finally:
            if lookers:
                self._scheduler.call_at(now + PERIOD, self._tick)

    def _tell(self, on_heard: Callable[[bool], object], is_seen: bool) -> None:
        """Update a view. An error of one view, for example for a message, does not stop the others."""
        try:
            on_heard(is_seen)
        except Exception as error:
            self._log(f"the values of topics could not be shown: {type(error).__name__}: {error}", exc_info=True)

    def _hear(self, names: Iterable[str], now: float) -> None:
        """Follow these topics, and no others."""
        topics, used = {topic.name: topic for topic in self._connection.topics}, self.used
        wanted = dict.fromkeys(name for name in names if name in topics)
        unused = [name for name in wanted if name not in used and topics[name].offered and topics[name].type]
        heard_of = {*unused[:MOST_HEARD], *(wanted.keys() & used)}
        for name in self._heard.keys() - heard_of:
            self._let_go(name)
            del self._heard[name]
        glances = any(one.is_glanced_at and one.target is not None for one in self._heard.values())
        for name in (name for name in wanted if name in heard_of):
            heard = self._heard.setdefault(name, Heard())
            large = is_large(topics[name].type)
            heard.is_glanced_at = name not in used and (large or (heard.rate or 0) >= FAST)
            if heard.target is not None:
                if heard.is_glanced_at and (now >= heard.until or (heard.is_measured and not large)):
                    heard.is_missed = not heard.came
                    self._let_go(name)
            elif not heard.is_glanced_at or (now >= heard.again_at and not glances):
                glances |= heard.is_glanced_at
                heard.begin(now + PATIENCE)
                heard.target = Target(partial(self._take, name, heard), None, on_replaced=heard.count_replaced)
                self._connection.attach_target(name, heard.target)

    def _let_go(self, name: str) -> None:
        """End the subscription to a topic for some time."""
        with self._lock:
            heard = self._heard.get(name)
            if heard is None or heard.target is None:
                return
            target, heard.target = heard.target, None
            heard.again_at = self._now() + PAUSE
        self._connection.detach(name, target)

    def _take(self, name: str, heard: Heard, message: Any) -> None:
        """Keep a message. It runs in the thread of the transport."""
        now = self._now()
        heard.take(message, now)
        if heard.is_glanced_at and heard.shows_rate and not heard.has_seen_enough:
            heard.has_seen_enough = True
            self._scheduler.call_at(now, partial(self._end_glance, name))

    def _end_glance(self, name: str) -> None:
        """End a probe of large messages that has seen enough. It runs in the thread of timers."""
        heard = self._heard.get(name)
        topic = next((topic for topic in self._connection.topics if topic.name == name), None)
        if heard is not None and topic is not None and heard.is_glanced_at and is_large(topic.type):
            heard.measure()
            self._let_go(name)

"""The mounts of the scanners on the robot of a feed, from its tf and its first scans."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple

from ..laser.row import LASER
from ..laser_widget import LaserWidget
from ..messages.fields import frame_id, unwrap
from ..poses.transforms import STATIC, TRANSFORMS
from ..runtime.clock import Threads, scheduler
from ..runtime.coalesced_call import CoalescedCall
from ..samples import Scan
from ._subscription import Target
from ._subscriptions import Subscriptions
from .middleware import MOST_UNREAD, FeedError

GRACE = 2.0
"""Seconds for which scans wait for tf to name their scanner, because the robot may drive by them."""


class Held(NamedTuple):
    """A message that waits for tf.

    ``newest`` is True if targets of the newest message must get it, ``each`` if functions of every message must.
    """

    topic: str
    message: Any
    newest: bool
    each: bool


class ScannerMounts:
    """The subscriptions to tf while scans are wanted. It holds scans of a scanner for `GRACE` until tf names it.

    Dynamic tf topics are subscribed to until all scanners are known by static transforms. Without tf, no scan is held.

    Args:
        connection: the connection of the feed.
        pass_on: passes a held message to its targets.

    Attributes:
        look: subscribes to the tf topics that are needed now, in one thread at a time.
    """

    def __init__(self, connection: Subscriptions, pass_on: Callable[[Held], object]) -> None:
        self.mounts = connection.mounts
        self._connection, self._pass_on = connection, pass_on
        clock = connection.clock
        self._timers = scheduler if clock is scheduler.clock else Threads(clock)
        self._lock = threading.RLock()
        self._attached: dict[str, Target] = {}
        self._has_tf = self._has_messages = False
        """True if there are tf topics, and if a message with a scan came instead of a sample from a recording."""
        self._until: dict[str, float] = {}
        """By the frame of a scanner that tf has not named, the time until which its scans are held."""
        self._frames: set[str] = set()
        """The frames of all scans so far."""
        self._held: deque[Held] = deque(maxlen=MOST_UNREAD)
        self._is_closed = False
        self.look = CoalescedCall(self._look)

    def _look(self) -> None:
        connection = self._connection
        tf = {topic.name for topic in connection.topics if not {*TRANSFORMS}.isdisjoint(topic.type.split(", "))}
        with self._lock:
            if self._is_closed:
                return
            self._has_tf, scanned = bool(tf), any(map(self._has_scans, connection.connected))
            are_fixed = bool(self._frames) and all(map(self.mounts.is_fixed, self._frames))
            wanted = {name for name in tf if scanned and self._has_messages and (_is_static(name) or not are_fixed)}
            gone = {name: self._attached.pop(name) for name in self._attached.keys() - wanted}
            new = wanted - self._attached.keys()
            targets = {name: Target(partial(self._take, name), None, _miss) for name in new}
            self._attached |= targets
        for name, target in gone.items():
            connection.detach(name, target)
        with suppress(FeedError):  # the feed was closed in the meantime
            for name, target in targets.items():
                connection.attach_target(name, target)

    def holds(self, topic: str, message: Any, *, newest: bool, each: bool) -> bool:
        """Return True for a message that must wait, because tf has not given the mount of its scanner yet."""
        if self._is_closed or not self._has_scans(topic) or isinstance(unwrap(message), Scan):
            return False
        frame = frame_id(message).lstrip("/")
        if not self._has_messages or frame not in self._frames:
            self._has_messages = True
            self._frames.add(frame)
            self.look()
        if not self._has_tf or not frame or self.mounts.of(frame) is not None:
            return False
        now = self._connection.clock.now()
        with self._lock:
            if frame not in self._until:
                self._until[frame] = now + GRACE
                self._timers.call_at(self._until[frame], self._release)
            if now >= self._until[frame]:
                return False
            self._held.append(Held(topic, message, newest, each))
        return True

    def close(self) -> None:
        """Stop following tf and holding scans."""
        with self._lock:
            self._is_closed = True
            self._held.clear()

    def _take(self, topic: str, message: Any) -> None:
        self.mounts.take(message, static=_is_static(topic))
        if self._held:
            self._release()

    def _release(self) -> None:
        """Pass on the messages that need not wait any more, in their order. One of each topic is its newest."""
        now = self._connection.clock.now()
        waiting: deque[Held] = deque(maxlen=MOST_UNREAD)
        passed: list[Held] = []
        with self._lock:
            for one in self._held:
                frame = frame_id(one.message).lstrip("/")
                waits = self.mounts.of(frame) is None and now < self._until[frame]
                (waiting if waits else passed).append(one)
            self._held = waiting
        newest = {one.topic: number for number, one in enumerate(passed) if one.newest}
        for number, one in enumerate(passed):
            self._pass_on(one._replace(newest=newest.get(one.topic) == number))
        if passed:
            self.look()

    def _has_scans(self, topic: str) -> bool:
        """Return True for a connected topic with scans, or from which a laser widget makes scans."""
        if self._connection.topic_of(topic).widget == LASER.name:
            return True
        subscription = self._connection.by_topic.get(topic)
        return subscription is not None and any(isinstance(one.widget, LaserWidget) for one in subscription.targets)


def _is_static(topic: str) -> bool:
    return topic.rpartition("/")[2] == STATIC


def _miss(_count: int) -> None:
    """Ignore a missed message, because a later one repeats it."""

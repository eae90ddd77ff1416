"""Answers from a running robot: the newest messages of its topics, with their age."""

from __future__ import annotations

import threading
from collections.abc import Callable
from difflib import get_close_matches
from math import inf, isfinite
from typing import Any

from ..feeds import Feed, FeedTopic
from ..kinds import KINDS
from ..laser.row import LASER
from ..recordings.topics import Topic, likeliest
from ..runtime.text import listed, many
from ..samples import Scan
from ..samples.staleness import LIVE
from ..widget.rate import RateMeter
from .answer import AnswerError, QuotingError, ToolAnswer, cut, from_robot, is_name, name, number, seconds
from .describe import describe
from .reading import MAX_TOPICS, of_distance, of_nearest, of_picture, when

MAX_FOLLOWED = 20
"""The most topics that are received at once. One that was asked for longest ago is dropped for another."""

FIRST_MESSAGE_TIMEOUT_S = 3.0
"""Seconds to wait for the first message of a topic."""


class _Newest:
    """The newest message of a topic, and when it came."""

    def __init__(self, now: Callable[[], float], on_message: Callable[[], None]) -> None:
        self._now, self._on_message, self._meter = now, on_message, RateMeter()
        self.count = 0
        self.kept: tuple[Any, float, float] | None = None
        """The message, its time of arrival, and the rate, or NaN."""

    def take(self, message: Any) -> None:
        """Keep a message. The thread of the transport calls it."""
        now = self._now()
        self.count += 1
        self.kept = message, now, self._meter.rate(self.count, now)
        self._on_message()


class LiveTools:
    """Answers from the topics of a feed. Each method is one question; any thread may ask.

    Args:
        feed: the feed, which stays open.
    """

    def __init__(self, feed: Feed) -> None:
        self._feed, self._connection = feed, feed.connection
        self._clock = feed.connection.clock
        self._lock = threading.RLock()
        self._came = self._clock.condition(self._lock)
        self._followed: dict[str, tuple[_Newest, Any]] = {}
        """The topics that are received, in the order in which they were asked for."""

    def topics(self) -> ToolAnswer:
        """List the topics of the robot."""
        self._connection.await_topics(())
        topics = [_topic(topic) for topic in sorted(self._feed.topics, key=lambda one: one.widget is None)]
        data = {
            "robot": from_robot(self._feed.where),
            "topics": cut(topics, MAX_TOPICS),
            **({"problem": from_robot(self._feed.status)} if self._feed.status else {}),
        }
        problem = ", and a problem of the connection" if self._feed.status else ""
        return ToolAnswer(f"{many(len(topics), 'topic')}{problem}.", data)

    def at(self, topic: str) -> ToolAnswer:
        """Return the newest sample or message of a topic."""
        sample, about = self._newest(topic)
        return ToolAnswer(when(about), {**about, **describe(sample)})

    def distance(self, topic: str | None, sector: Any, percentile: float | None) -> ToolAnswer:
        """Return the distance to the nearest thing in a sector now."""
        return of_distance(*self._scan(topic), sector, percentile)

    def nearest(self, topic: str | None, sector: Any, count: int) -> ToolAnswer:
        """Return the rays to the nearest things in a sector now."""
        return of_nearest(*self._scan(topic), sector, count)

    def picture(self, topic: str) -> ToolAnswer:
        """Return a PNG of the newest scan or camera picture."""
        sample, about = self._newest(topic)
        return of_picture(sample, about, self._connection.topic_of(topic).type)

    def close(self) -> None:
        """Receive no more messages."""
        with self._lock:
            followed, self._followed = self._followed, {}
        for topic, (_, target) in followed.items():
            self._connection.detach(topic, target)

    def _scan(self, topic: str | None) -> tuple[Scan, dict[str, Any]]:
        sample, about = self._newest(self._scanner() if topic is None else topic)
        if not isinstance(sample, Scan):
            raise AnswerError(f"topic: expected a topic of scans, got {topic}")
        return sample, about

    def _scanner(self) -> str:
        self._connection.await_topics(())
        there = [topic for topic in self._feed.topics if topic.widget == LASER.name and topic.offered]
        if not there:
            raise AnswerError("topic: the robot has no topic of scans now; `robot_topics` lists what it has")
        return likeliest(Topic(one.name, one.type, 0, None, one.widget, one.commanded, "") for one in there).name

    def _newest(self, topic: str) -> tuple[Any, dict[str, Any]]:
        newest = self._follow(topic)
        until = self._clock.now() + FIRST_MESSAGE_TIMEOUT_S
        with self._lock:
            while newest.kept is None and not self._connection.is_closed and self._came.wait_until(until):
                pass
        if newest.kept is None:
            why = self._connection.status_of(topic) or self._feed.status
            raise QuotingError(
                f"{topic}: unknown, no message came within {FIRST_MESSAGE_TIMEOUT_S:g} s" + (f": {why}" if why else "")
            )
        message, came, rate = newest.kept
        listed = self._connection.topic_of(topic)
        sample = message if listed.widget is None else self._connection.mounted(KINDS[listed.widget].read(message))
        age = self._clock.now() - came
        # The state of a touch sensor stays until the next message.
        holds = listed.widget is not None and not KINDS[listed.widget].goes_stale
        is_late = not holds and age > LIVE.after(1 / rate if isfinite(rate) and rate > 0 else inf)
        about = {
            "topic": name(topic),
            "age_s": seconds(age),
            "rate_hz": number(rate),
            "stale": bool(self._feed.status) or is_late,
        }
        if self._feed.status:
            about["problem"] = from_robot(self._feed.status)
        return sample, about

    def _follow(self, topic: str) -> _Newest:
        """Receive a topic from now on."""
        self._connection.check_open(topic)
        with self._lock:
            there = self._followed.pop(topic, None)
            if there is not None:
                self._followed[topic] = there
                return there[0]
        self._connection.await_topics([topic])
        names = [one.name for one in self._feed.topics]
        if self._connection.is_listed and topic not in names:
            readable = [name for name in names if is_name(name)]
            known = listed(readable, 8) or "none"
            near = get_close_matches(topic, readable, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise AnswerError(f"topic: the robot has no topic {topic[:120]!r} now; there are {known}{hint}")
        newest = _Newest(self._clock.now, self._notify)
        mine = newest, self._connection.attach(topic, newest.take)
        with self._lock:
            kept = self._followed.setdefault(topic, mine)
            dropped = {oldest: self._followed.pop(oldest) for oldest in list(self._followed)[:-MAX_FOLLOWED]}
        if kept is not mine:  # another question was faster
            self._connection.detach(topic, mine[1])
        for oldest, (_, target) in dropped.items():
            self._connection.detach(oldest, target)
        return kept[0]

    def _notify(self) -> None:
        with self._lock:
            self._came.notify_all()


def _topic(topic: FeedTopic) -> dict[str, Any]:
    return {
        "topic": name(topic.name),
        "type": name(topic.type) if topic.type else "unknown",
        "shown_by": topic.widget,
        "published": topic.offered,
        "subscribed": topic.wanted,
        **({"commanded": True} if topic.commanded else {}),
    }

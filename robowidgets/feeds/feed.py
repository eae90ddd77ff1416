"""A running robot: its topics, the widgets that show them, and driving it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection, Sequence
from typing import TYPE_CHECKING, Any

from .._cells import take_the_place
from .._table import as_html, as_text
from ._drive import Driver, Driving, Twists
from ._drive_words import DriveWords
from ._ending import close_first, still_open
from ._link import target_of
from ._links import Links
from ._subscriptions import Subscriptions
from ._topics import Topic, check_name, table_of, topics_of
from .middleware import Advert, FeedError, Middleware

if TYPE_CHECKING:
    from ._view import FeedView

PATIENCE = 2.0
"""Seconds that `show` and `drive` wait for the first list of topics."""


class Feed:
    """What each function of `robowidgets.feeds` gives: a connection to a robot, or to what stands for one.

    Printed, it is a table of the topics there are. It reconnects by itself, and says on its widgets what is going on.
    All of it may be called from any thread. As a context manager it closes itself; else when its cell opens another.

    Args:
        middleware: what connects; it is opened.

    Raises:
        FeedError: it can never work; the text says why, and what to do.

    Example:
        >>> from robowidgets import LaserWidget, feeds
        >>> laser = LaserWidget()
        >>> with feeds.simulator() as feed:
        ...     feed.connect("/scan", laser)
    """

    def __init__(self, middleware: Middleware) -> None:
        self._driving = Driving()
        self._middleware = middleware
        self._changed = threading.Condition(threading.RLock())
        self._links = Links(f"connecting to {middleware.where}")
        self._watchers: list[Callable[[], None]] = []
        self._adverts: tuple[Advert, ...] = ()
        self._reached = self._closed = self._forked = False
        self._twists = Twists(middleware)
        self._opened = time.monotonic()
        self._drive_words = DriveWords()
        self._subscriptions = Subscriptions(middleware, self._wanted)
        self._driver = Driver(self._send_speed, lambda: not self._links.down)
        take_the_place(self)  # before it opens: the one before may have the node, or drive
        still_open.add(self)
        try:
            middleware.open(self)
        except BaseException:
            still_open.discard(self)
            raise
        close_first()

    # -- what a person uses --------------------------------------------------------------------------------------------

    @property
    def where(self) -> str:
        """What it is connected to."""
        return self._middleware.where

    @property
    def topics(self) -> tuple[Topic, ...]:
        """The topics there are now."""
        return tuple((self._links.there or {}).values())

    @property
    def words(self) -> str:
        """What a person should know of the connection; empty when all is well."""
        return self._links.down

    @property
    def driving(self) -> Driving:
        """How `drive` drives: topic, limits, and how long a speed holds. To set it stops the robot."""
        return self._driving

    @driving.setter
    def driving(self, driving: Driving) -> None:
        if not isinstance(driving, Driving):
            raise TypeError(f"driving: expected feeds.Driving(topic=..., max_linear=...), got {driving!r}")
        self._driver.halt()
        self._driving, self._drive_words.cut = driving, ""

    @property
    def drive_words(self) -> str:
        """Why the robot would not move as it is told: who does not hear it, and how the last speed was cut.

        Empty when nothing is known against it.
        """
        return self._links.down or self._drive_words.of(self.driving.topic, self._links.there)

    def connect(self, topic: str, *targets: Any) -> None:
        """Hand the messages of a topic on, whether it is there yet or not.

        Args:
            topic: its name.
            *targets: widgets, whose `update` takes the messages and which get the topic as title if they have none; or
                functions of a message, such as `speed.command`. They are called in a thread of the feed's; an error is
                logged.

        Raises:
            TypeError: no text, no target, or something else than a widget or a function. ValueError: an empty name.
            FeedError: the feed is closed.
        """
        check_name(topic)
        if not targets:
            raise TypeError(f"connect({topic!r}) needs a widget, or a function of a message")
        with self._changed:
            self._check_open()
            self._links.connect(topic, [target_of(target) for target in targets])
        self._subscriptions.settle()

    def disconnect(self, topic: str, *targets: Any) -> None:
        """Hand no more messages of a topic on to these targets of `connect`; to none at all when none are named."""
        check_name(topic)
        with self._changed:
            self._links.disconnect(topic, [target_of(target) for target in targets])
        self._subscriptions.settle()

    def show(self, *topics: str) -> FeedView:
        """The widgets that fit its topics, live, for the page.

        It waits a moment for the first list of topics. Without names, topics that appear later get a widget too; a
        named topic gets its own when it appears.

        Args:
            *topics: names of the topics to show; none: all that have a widget.

        Raises:
            TypeError: a name is no text, but a list of them, say.
            FeedError: the feed is closed.

        Example:
            >>> feed.show("/scan", "/odom")  # doctest: +SKIP
        """
        from ._view import FeedView

        for topic in topics:
            check_name(topic)
        self._check_open()
        self._wait(lambda: bool(set(topics) <= self._showable() if topics else self._showable()), time.monotonic())
        view = FeedView(self, topics)
        self.watch(view.refresh)
        view.refresh()
        return view

    def drive(self, linear: float = 0.0, angular: float = 0.0) -> None:
        """Publish a speed, cut to the limits of `driving`; unless it is renewed in time, zero follows.

        What was cut is told by `drive_words` until the next speed that is not, and by the log once.

        Args:
            linear: forward, m/s.
            angular: counter-clockwise, rad/s.

        Raises:
            TypeError: no number. ValueError: NaN or infinite.
            FeedError: the robot cannot be reached or driven, or the feed is closed. Nothing is sent then.
        """
        driving = self.driving
        speed = driving.within(linear, angular)
        self._drive_words.cut = driving.cut(linear, angular)
        self._await_robot()
        self._check_open()
        if self._links.down:
            raise FeedError(f"cannot drive: {self._links.down}")
        self._drive_words.log(self.where, driving.topic, self._links.there)
        self._driver.drive(driving.topic, *speed, driving.hold)

    def stop(self) -> None:
        """Publish zero now. Where the connection was lost while driving, zero goes out as soon as it is back.

        Raises:
            FeedError: the robot cannot be driven at all; or it cannot be reached, and was not left driving.
        """
        self._drive_words.cut = ""
        self._await_robot()
        if self._closed and not self._forked:
            return
        self._check_open()
        down = self._links.down
        if not self._driver.stop(self.driving.topic) and down:
            raise FeedError(f"cannot stop: {down}")

    def close(self) -> None:
        """Stop the robot if it is driven, disconnect, end every thread; doing it again does nothing."""
        with self._changed:
            if self._closed:
                return
            self._closed = True
        try:
            try:
                self._driver.close()
            finally:
                self._middleware.close()
        finally:
            still_open.discard(self)
            with self._changed:
                self._links.lose("the feed is closed")
                self._changed.notify_all()
            self._tell_watchers()

    def __enter__(self) -> Feed:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return as_text(*table_of(self.where, self.topics, self._links.down))

    def _repr_html_(self) -> str:
        return as_html(*table_of(self.where, self.topics, self._links.down))

    # -- what the middleware tells: see `Listener` ---------------------------------------------------------------------

    def on_connected(self) -> None:
        """See `Listener`."""
        with self._changed:
            if self._closed:
                return
            self._links.down, self._reached = "", True
            self._links.tell_all()
            self._changed.notify_all()
        self._driver.nudge()
        self._tell_watchers()

    def on_lost(self, why: str, again_in: float) -> None:
        """See `Listener`."""
        with self._changed:
            if self._closed:
                return
            lost = "connection lost" if self._reached else f"cannot reach {self.where}"
            self._links.lose(f"{lost}, trying again in {again_in:.2g} s: {why}")
        self._driver.lost()
        self._tell_watchers()

    def on_topics(self, topics: Sequence[Advert]) -> None:
        """See `Listener`."""
        with self._changed:
            if self._closed:
                return
            self._adverts = tuple(topics)
            self._links.learn(topics_of(topics))
            self._changed.notify_all()
        self._tell_watchers()

    def on_message(self, topic: str, message: Any) -> None:
        """See `Listener`."""
        link = self._links.by_topic.get(topic)
        if link is not None and not self._closed and link.take(message):
            with self._changed:
                self._links.tell(link)

    def on_trouble(self, topic: str, words: str) -> None:
        """See `Listener`."""
        with self._changed:
            link = self._links.by_topic.get(topic)
            if link is not None and not self._closed:
                link.trouble = words
                self._links.tell(link)

    def on_unheard(self, topic: str, words: str) -> None:
        """See `Listener`."""
        self._drive_words.unheard[topic] = words

    # -- within --------------------------------------------------------------------------------------------------------

    def on_fork(self) -> None:
        """Be closed in a process that was forked off: the threads stayed behind, maybe with the lock."""
        self._changed = threading.Condition(threading.RLock())
        self._closed = self._forked = True

    def words_of(self, topic: str) -> str:
        """What a person should know of a topic, connected or not; empty when all is well."""
        with self._changed:
            return self._links.words_of(topic)

    @property
    def is_closed(self) -> bool:
        """Whether `close` was called."""
        return self._closed

    @property
    def is_listed(self) -> bool:
        """Whether it was told which topics there are."""
        return self._links.there is not None

    def watch(self, tell: Callable[[], None]) -> None:
        """Call a function whenever topics or connection have changed, and when it is closed, from any thread."""
        with self._changed:
            self._watchers.append(tell)

    def forget(self, tell: Callable[[], None]) -> None:
        """Call a function of `watch` no more."""
        with self._changed:
            if tell in self._watchers:
                self._watchers.remove(tell)

    def _showable(self) -> set[str]:
        return {topic.name for topic in self.topics if topic.widget}

    def _wait(self, until: Callable[[], bool], since: float) -> None:
        """Wait for what should come a moment after a time."""
        with self._changed:
            while not until() and not self._closed and (left := since + PATIENCE - time.monotonic()) > 0:
                self._changed.wait(left)

    def _await_robot(self) -> None:
        """Wait for what is published to arrive, and for the type that it must have."""
        self._wait(lambda: self._reached and bool(self._links.down or self._links.there is not None), self._opened)

    def _send_speed(self, topic: str, linear: float, angular: float) -> None:
        if linear or angular:
            self._check_open()
        if self._links.down and self._links.there is None:
            return  # it would not arrive, and of which type it must be is not known
        self._twists.send(topic, linear, angular, self._adverts)

    def _wanted(self) -> Collection[str] | None:
        with self._changed:
            return None if self._closed else tuple(self._links.by_topic)

    def _tell_watchers(self) -> None:
        """Without the lock: a view may put up widgets, and connect them."""
        for tell in list(self._watchers):
            tell()

    def _check_open(self) -> None:
        if self._closed:
            why = "stayed with the process that was forked" if self._forked else "is closed"
            raise FeedError(f"the feed of {self.where} {why}: open it again")

"""A running robot: its topics, the widgets that show them, and driving it."""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from .._core.cells import running_cell, take_the_place
from .._core.command_watchdog import PROGRAM, ZERO, CommandWatchdog, RefusedError, Request
from .._core.text import as_html, as_text
from ..samples import Scan, Speed
from ..samples.numbers import finite
from ._drive import TWIST, Driving, TwistPublisher
from ._drive_words import DriveWords
from ._ending import close_first, still_open
from ._functions import Function, FunctionCaller
from ._link import Target, target_of
from ._links import Links
from ._scans import scans_of
from ._subscriptions import Subscriptions
from ._topics import Table, Topic, check_name, table_of, topics_of
from .middleware import Advert, FeedError, Middleware

if TYPE_CHECKING:
    from ._view import FeedView

log = logging.getLogger("robowidgets")

PATIENCE = 2.0
"""Seconds after opening for which `show`, `drive` and `stop` wait for the topics and for a robot that listens."""

PAGE_TIMEOUT = 3.0
"""Seconds without a word from a page after which there is none."""


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
        self._functions = FunctionCaller(self._tell_topic)
        self._links = Links(f"connecting to {middleware.where}", self._functions)
        self._watchers: list[Callable[[], None]] = []
        self._adverts: tuple[Advert, ...] = ()
        self._reached = self._closed = self._forked = False
        self._driven: str | None = None
        """The topic on which a speed was sent that nobody else knows."""
        self._page_at = float("-inf")
        self._by_hand = False
        self._twists = TwistPublisher(middleware)
        self._opened = time.monotonic()
        self._drive_words = DriveWords()
        self._subscriptions = Subscriptions(middleware, self._wanted)
        self.watchdog = CommandWatchdog(self._send_speed, not_sent=FeedError)
        self.watchdog.watch(self._show_sent)
        _tell_dropped(take_the_place(self))  # before it opens: the one before may have the node, or drive
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
        if self.watchdog.owes_zero:
            with contextlib.suppress(FeedError, TimeoutError):  # it is logged, and stays owed
                self.watchdog.sent_in_time(self.watchdog.stop())
        self._driving, self._drive_words.cut = driving, ""

    @property
    def drive_words(self) -> str:
        """Why the robot would not move as it is told: who does not hear it, who drives, how the last speed was cut.

        Empty when nothing is known against it.
        """
        return self._links.down or self._drive_words.of(self.driving.topic, self._adverts)

    @property
    def stopped(self) -> bool:
        """Whether stop is latched: all driving is refused until it is released.

        True sends zero and latches, False releases; so do the buttons on the page.
        """
        return self.watchdog.stopped

    @stopped.setter
    def stopped(self, stopped: bool) -> None:
        self.watchdog.stopped = bool(stopped)

    @property
    def functions(self) -> tuple[Function, ...]:
        """The functions that are connected."""
        return self._functions.functions

    def connect(self, topic: str, *targets: Any, raw: bool = False) -> None:
        """Hand the messages of a topic on, whether it is there yet or not.

        Functions are called in a thread of their own, one at a time, with the newest message: a `Scan`, `Speed` or
        `Touch` where a widget shows the topic, else the message as it came. Of a touch sensor every message counts. One
        that raises is named on the widgets of its topic, and so is one that has not come back for a second. A function
        takes the place of the one of the same name in the notebook, and of those that an earlier run of the same cell
        connected.

        Args:
            topic: its name.
            *targets: widgets, whose `update` takes the messages and which get the topic as title if they have none;
                their methods, such as `speed.command`; or functions of a sample.
            raw: whether functions get the messages as they came.

        Raises:
            TypeError: no text, no target, or something else than a widget or a function. ValueError: an empty name.
            FeedError: the feed is closed.
        """
        check_name(topic)
        if not targets:
            raise TypeError(f"connect({topic!r}) needs a widget, or a function of a sample")
        every = [target_of(target) for target in targets]
        self._connect(topic, [one for one in every if isinstance(one, Target)])
        with self._changed:
            self._functions.connect(topic, [one for one in every if not isinstance(one, Target)], raw)
            self._links.prune()
        self._subscriptions.settle()

    def disconnect(self, topic: str, *targets: Any) -> None:
        """Hand no more messages of a topic on to these targets of `connect`; to none at all when none are named."""
        check_name(topic)
        every = [target_of(target) for target in targets]
        with self._changed:
            link = self._links.by_topic.get(topic)
            ours = [one for one in every if isinstance(one, Target)] if targets else link.targets if link else ()
            self._functions.disconnect(
                topic, [one for one in every if not isinstance(one, Target)] if targets else None
            )
            self._links.disconnect(topic, ours)
            self._tell_topic(topic)
        self._subscriptions.settle()

    def scans(self, topic: str, timeout: float = 0.5) -> Iterator[Scan]:
        """The scans of a topic from now on, each once; the newest, where a loop is slower than the scanner.

        Args:
            topic: its name.
            timeout: seconds that it waits for the next scan. For the first one it waits 10 s at least.

        Raises:
            TimeoutError: no scan came in time; the text says why, as far as it is known.
            TypeError, ValueError: no name, or no number of seconds above 0; or a message that is no scan.
            FeedError: the feed is closed.

        Example:
            >>> for scan in feed.scans("/scan", timeout=0.5):  # doctest: +SKIP
            ...     feed.drive(0.2 if scan.distance() > 0.6 else 0.0)
        """
        check_name(topic)
        if finite("timeout", timeout, "seconds") <= 0:
            raise ValueError(f"timeout: expected seconds above 0, got {timeout!r}")
        self._check_open()
        return scans_of(self, topic, timeout)

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

        At most 50 speeds a second are published, the newest wins; zero goes out at once. What was cut is told by
        `drive_words` until the next speed that is not, and by the log once.

        Args:
            linear: forward, m/s.
            angular: counter-clockwise, rad/s.

        Raises:
            TypeError: no number. ValueError: NaN or infinite.
            FeedError: the robot cannot be reached or driven; a hand holds a pad, or stop is latched; the feed is
                closed. Nothing is sent then.
        """
        velocity = self._within(linear, angular)
        if self._functions.is_abandoned and velocity != ZERO:
            raise FeedError("cannot drive: this function was disconnected or replaced while it was at work")
        self._await_robot()
        self._drive_words.log(self.where, self.driving.topic, self._adverts)
        self._sent_in_time("drive", self._request(velocity, PROGRAM))

    def drive_by_hand(self, linear: float, angular: float, press: str) -> None:
        """Publish the speed of a press on a pad; waits for nothing. Raises as `drive`."""
        self._by_hand = True
        self._request(self._within(linear, angular), press)

    def stop(self) -> None:
        """Publish zero now, and return when it is sent.

        Raises:
            FeedError: zero was not sent; the text says why, and whether it follows when the robot can be reached.
        """
        self._drive_words.cut = ""
        if self._closed and not self._forked:
            return
        self._await_robot()
        self._check_open()
        self._sent_in_time("stop", self.watchdog.stop())

    def close(self) -> None:
        """Stop the robot if it is driven, disconnect, end every thread; doing it again does nothing.

        It takes a few seconds at most, whatever the robot and connected functions do.
        """
        with self._changed:
            if self._closed:
                return
            self._closed = True
        try:
            with contextlib.suppress(FeedError, TimeoutError):  # it is logged
                self.watchdog.close()
        finally:
            try:
                self._functions.close()
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
        tables = [as_text(*table) for table in self._tables()]
        return "\n".join(tables)

    def _repr_html_(self) -> str:
        return "".join(as_html(*table) for table in self._tables())

    # -- what the middleware tells: see `Listener` ---------------------------------------------------------------------

    def on_connected(self) -> None:
        """See `Listener`."""
        with self._changed:
            if self._closed:
                return
            self._links.down, self._reached = "", True
            self._links.tell_all()
            self._changed.notify_all()
        self._twists.on_connected()
        self.watchdog.on_connected()
        self._tell_watchers()

    def on_lost(self, why: str, again_in: float) -> None:
        """See `Listener`."""
        with self._changed:
            if self._closed:
                return
            lost = "connection lost" if self._reached else f"cannot reach {self.where}"
            self._links.lose(f"{lost}, trying again in {again_in:.2g} s: {why}")
        self.watchdog.on_lost()
        self._tell_watchers()

    def on_topics(self, topics: Sequence[Advert]) -> None:
        """See `Listener`."""
        with self._changed:
            if self._closed:
                return
            self._adverts = tuple(topics)
            self._learn()
            self._changed.notify_all()
        self._tell_watchers()

    def on_message(self, topic: str, message: Any) -> None:
        """See `Listener`."""
        link = self._links.by_topic.get(topic)
        if link is None or self._closed:
            return
        if link.take(message):
            with self._changed:
                self._links.tell(link)
        known = (self._links.there or {}).get(topic)
        self._functions.put(known or Topic(topic, "", None, False, True, None), message)

    def on_trouble(self, topic: str, words: str) -> None:
        """See `Listener`."""
        with self._changed:
            link = self._links.by_topic.get(topic)
            if link is not None and not self._closed:
                link.trouble = words
                self._links.tell(link)
        if not self._closed:
            self._tell_watchers()

    def on_unheard(self, topic: str, words: str) -> None:
        """See `Listener`."""
        self._drive_words.unheard[topic] = words
        self._tell_watchers()

    # -- within --------------------------------------------------------------------------------------------------------

    def on_fork(self) -> None:
        """Be closed in a process that was forked off: the threads stayed behind, maybe with the lock."""
        self._changed = threading.Condition(threading.RLock())
        self._closed = self._forked = True

    def page_seen(self) -> None:
        """Note that a page which shows the feed, or a pad of it, is there."""
        self._page_at = time.monotonic()

    def words_of(self, topic: str) -> str:
        """What a person should know of a topic, connected or not; empty when all is well."""
        with self._changed:
            return self._links.words_of(topic)

    def trouble_of(self, topic: str) -> str:
        """Why no message of a connected topic comes or can be read, as the middleware says; empty when all is well."""
        link = self._links.by_topic.get(topic)
        return link.trouble if link is not None else ""

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

    def attach(self, topic: str, take: Callable[[Any], object]) -> Target:
        """Hand the messages of a topic to code of this package, in the transport's thread; it must return at once."""
        target = Target(take, None)
        self._connect(topic, [target])
        return target

    def detach(self, topic: str, target: Target) -> None:
        """End an `attach`."""
        with self._changed:
            self._links.disconnect(topic, [target])
        self._subscriptions.settle()

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

    def _connect(self, topic: str, targets: Sequence[Target]) -> None:
        with self._changed:
            self._check_open()
            self._links.connect(topic, targets)
        self._subscriptions.settle()

    def _await_robot(self) -> None:
        """Wait for what is published to arrive, for the type that it must have, and for somebody who listens."""
        self._wait(lambda: self._reached and (bool(self._links.down) or self._is_heard()), self._opened)

    def _is_heard(self) -> bool:
        """Whether somebody is known to listen; or nobody can tell."""
        told = [advert.wanted for advert in self._adverts if advert.wanted is not None]
        here = any(advert.name == self.driving.topic and advert.wanted for advert in self._adverts)
        return self.is_listed and (here or bool(self._adverts and not told))

    def _within(self, linear: float, angular: float) -> tuple[float, float]:
        velocity = self.driving.within(linear, angular)
        self._drive_words.cut = self.driving.cut(linear, angular)
        return velocity

    def _request(self, velocity: tuple[float, float], driver: str) -> Request:
        """Have a speed sent, if nothing speaks against it."""
        self._check_open()
        if self._links.down:
            raise FeedError(f"cannot drive: {self._links.down}")
        if self.driving.needs_page and time.monotonic() - self._page_at > PAGE_TIMEOUT:
            raise FeedError(
                "cannot drive: no page that shows this feed or its pad answers, and driving.needs_page asks for one; "
                "beside a busy cell only ipykernel 7 or later hears the page"
            )
        if velocity != ZERO:
            self._learn_driven(self.driving.topic)
        try:
            return self.watchdog.drive(velocity, self.driving.hold, driver)
        except RefusedError as error:
            raise FeedError(f"cannot drive: {error}") from None

    def _sent_in_time(self, what: str, request: Request) -> None:
        try:
            self.watchdog.sent_in_time(request)
        except (FeedError, TimeoutError) as error:
            follows = "; zero follows when it can be sent" if what == "stop" and self.watchdog.owes_zero else ""
            raise FeedError(f"cannot {what}: {self._links.down or error}{follows}") from None

    def _send_speed(self, linear: float, angular: float) -> None:
        """The sink of the watchdog."""
        if linear or angular:
            self._check_open()
        self._twists.send(self.driving.topic, linear, angular, self._adverts)

    def _learn_driven(self, topic: str) -> None:
        """List a topic on which only this feed publishes, so that a widget shows what is sent."""
        if topic != self._driven:
            self._driven = topic
            with self._changed:
                self._learn()
            self._tell_watchers()

    def _learn(self) -> None:
        adverts = list(self._adverts)
        if self._driven is not None and all(advert.name != self._driven for advert in adverts):
            tells = any(advert.wanted is not None for advert in adverts)
            adverts.append(Advert(self._driven, TWIST, offered=False, wanted=False if tells else None))
        self._links.learn(topics_of(adverts))

    def _show_sent(self) -> None:
        """Show what was sent as commanded, unless the middleware hands it on itself as it does what others publish."""
        topic, velocity = self.driving.topic, self.watchdog.sent
        if (
            self._by_hand and velocity == ZERO and not self.watchdog.driver
        ):  # what a hand was told of its speed ends with its press
            self._by_hand, self._drive_words.cut = False, ""
        link = self._links.by_topic.get(topic)
        known = (self._links.there or {}).get(topic)
        if link is not None and known is not None and not known.offered and self.watchdog.error is None:
            link.take(Speed((velocity[0], 0.0, 0.0), (0.0, 0.0, velocity[1])))
            with self._changed:
                self._links.tell(link)

    def _tables(self) -> list[Table]:
        tables = [table_of(self.where, self.topics, self._links.down)]
        if self.functions:
            tables.append(self._functions.table())
        return tables

    def _tell_topic(self, topic: str) -> None:
        link = self._links.by_topic.get(topic)
        if link is not None:
            with self._changed:
                self._links.tell(link)

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


def _tell_dropped(closed: Sequence[Any]) -> None:
    """Say which functions of other cells were connected to a feed that a new run of its cell closed."""
    cell, _ = running_cell()
    functions = [function for feed in closed if isinstance(feed, Feed) for function in feed.functions]
    names = [f"`{function.name}` ({function.topic})" for function in functions if function.cell != cell]
    if names:
        log.warning("the feed was opened anew; no longer connected: %s. Run their cells again", ", ".join(names))

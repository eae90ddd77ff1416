"""A running robot: its topics, the widgets that show them, and driving it."""

from __future__ import annotations

import contextlib
import logging
import os
import threading
import time
import weakref
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from .._core.cells import running_cell, take_the_place
from .._core.platform_fixes import let_threads_print, shorten_switch_interval
from .._core.tables import as_html, as_text
from ..behaviors.program import Program
from ..behaviors.programs import Programs
from ..behaviors.variables import Variables
from ..messages.standard import TWIST
from ..samples import Scan, Speed
from ..samples.checks import finite
from ._callbacks import Function, FunctionCaller
from ._driver import Driver
from ._driving import Driving
from ._open_feeds import close_first, open_feeds
from ._program_inputs import FeedRobot
from ._scan_iterator import scans_of
from ._subscriber import Subscriber
from ._subscription import Target, target_of
from ._subscription_table import SubscriptionTable
from ._topics import Table, Topic, check_name, table_of, topics_of, unlisted
from .middleware import Advert, FeedError, Middleware

if TYPE_CHECKING:
    from ._feed_view import FeedView
    from ._recorder import Recorder

log = logging.getLogger("robowidgets")

PATIENCE = 2.0
"""Seconds after opening for which `show`, `drive` and `stop` wait for the topics and for a subscriber."""


class Feed:
    """A connection to a robot, a simulated robot or a recording; each function of `robowidgets.feeds` returns one.

    Its printed form is a table of its topics. It reconnects by itself and shows its status on its widgets. All methods
    may be called from any thread. A context manager closes it; so does a new run of the cell that opened it.

    Args:
        middleware: the connection, which the feed opens.

    Raises:
        FeedError: it can never work. The text gives the reason and the next step.

    Example:
        >>> from robowidgets import LaserWidget, feeds
        >>> laser = LaserWidget()
        >>> with feeds.simulator() as feed:
        ...     feed.connect("/scan", laser)
    """

    def __init__(self, middleware: Middleware) -> None:
        # Threads refer to a twin with the same state. When the feed itself is gone, neither the user nor a widget of it
        # is left, and its program ends.
        twin = self.twin = object.__new__(type(self))
        self.__dict__ = twin.__dict__ = {**vars(self)}
        self._middleware = middleware
        self._changed = threading.Condition(threading.RLock())
        self._functions = FunctionCaller(twin._show_status)
        self._table = SubscriptionTable(f"connecting to {middleware.where}", self._functions)
        self._watchers: list[Callable[[], None]] = []
        self._adverts: tuple[Advert, ...] = ()
        self._reached = self._closed = self._forked = False
        self._driven: str | None = None
        """The topic on which this feed publishes speeds and nobody else publishes anything."""
        self._opened = time.monotonic()
        self._subscriber = Subscriber(middleware, twin._wanted)
        self.driver = Driver(twin, middleware)
        self.watchdog = self.driver.watchdog
        self.programs = Programs(FeedRobot(twin, weakref.ref(self)))
        shorten_switch_interval()
        let_threads_print()
        # Before it opens, because the feed of the earlier run may use the node, or drive the robot.
        _log_dropped(take_the_place(self))
        open_feeds.add(twin)
        try:
            middleware.open(twin)
        except BaseException:
            open_feeds.discard(twin)
            raise
        close_first()

    # -- what a person uses --------------------------------------------------------------------------------------------

    @property
    def where(self) -> str:
        """The name of the connection, such as ``ROS 2, domain 0``."""
        return self._middleware.where

    @property
    def topics(self) -> tuple[Topic, ...]:
        """The topics that are known now."""
        return tuple((self._table.topics or {}).values())

    @property
    def status(self) -> str:
        """The problem of the connection; empty if there is none."""
        return self._table.down

    @property
    def driving(self) -> Driving:
        """The settings of `drive`: topic, limits, and the hold of a speed. Setting it stops the robot."""
        return self.driver.driving

    @driving.setter
    def driving(self, driving: Driving) -> None:
        self.driver.driving = driving

    @property
    def drive_status(self) -> str:
        """The reasons why the robot may not move as commanded; empty if there are none.

        Reasons are a topic without subscribers, incompatible subscribers, other publishers, and a cut of the last
        speed.
        """
        return self.driver.status

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
        """Pass the messages of a topic to widgets and functions; the topic may appear later.

        Functions are called in a thread of their own, one at a time, with the newest message: a `Scan`, `Speed` or
        `Touch` if a widget can show the topic, else the message as received. Functions of a touch sensor get every
        message. The widgets of a topic name a function that raises, and one that has not returned for a second. A
        function replaces the function of the same name in the notebook, and the functions that an earlier run of the
        same cell connected.

        Args:
            topic: its name.
            *targets: widgets, whose `update` takes the messages and whose title becomes the topic if it is empty; their
                methods, such as `speed.command`; or functions of a sample.
            raw: whether functions get the messages as received.

        Raises:
            TypeError: the topic is no text, there is no target, or a target is neither a widget nor a function.
            ValueError: the topic is empty.
            FeedError: the feed is closed.
        """
        check_name(topic)
        if not targets:
            raise TypeError(f"connect({topic!r}) needs a widget, or a function of a sample")
        ours, functions = _sorted(targets)
        self._connect(topic, ours)
        with self._changed:
            self._functions.connect(topic, functions, raw)
            self._table.prune()
        self._subscriber.update()

    def disconnect(self, topic: str, *targets: Any) -> None:
        """Pass no more messages of a topic to these targets of `connect`; without targets, to none at all."""
        check_name(topic)
        ours, functions = _sorted(targets)
        with self._changed:
            self._functions.disconnect(topic, functions if targets else None)
            self._table.disconnect(topic, ours if targets else None)
            self._show_status(topic)
        self._subscriber.update()

    def scans(self, topic: str, timeout: float = 0.5) -> Iterator[Scan]:
        """The scans of a topic from now on, each once. A loop that is slower than the scanner gets the newest.

        Args:
            topic: its name.
            timeout: seconds to wait for the next scan. The first one is awaited for 10 s at least.

        Raises:
            TimeoutError: no scan came in time; the text gives the reason, if it is known.
            TypeError, ValueError: no name, or no number of seconds above 0, or a message is no scan.
            FeedError: the feed is closed.

        Example:
            >>> for scan in feed.scans("/scan", timeout=0.5):  # doctest: +SKIP
            ...     feed.drive(0.2 if scan.distance() > 0.6 else 0.0)
        """
        check_name(topic)
        if finite("timeout", timeout, "seconds") <= 0:
            raise ValueError(f"timeout: expected seconds above 0, got {timeout!r}")
        self.check_open()
        return scans_of(self, topic, timeout)

    def show(self, *topics: str) -> FeedView:
        """The widgets that fit its topics, live, for the page, and those of its program and state machine.

        It waits a moment for the first list of topics. Without names, topics and programs that appear later get a
        widget too; a named topic gets its own when it appears.

        Args:
            *topics: names of the topics to show, without the program; none: all that have a widget.

        Raises:
            TypeError: a name is no text, but a list of them, say.
            FeedError: the feed is closed.

        Example:
            >>> feed.show("/scan", "/odom")  # doctest: +SKIP
        """
        from ._feed_view import FeedView

        for topic in topics:
            check_name(topic)
        self.check_open()
        self.wait_until(lambda: bool(set(topics) <= self._showable() if topics else self._showable()), PATIENCE)
        view = FeedView(self, topics)
        self.watch(view.refresh)
        view.refresh()
        return view

    def record(self, path: str | os.PathLike[str], *topics: str) -> Recorder:
        """Write what the robot sends into an MCAP file, until the result is closed, as a context manager or by `close`.

        Beside the topics it has the speeds that are sent, and the text and the states of each version of the program.
        `robowidgets.open` and other tools read it, also when the process dies before it is closed. Writing holds up
        neither the robot nor the program: `problems` of the result says what is missing in the file.

        Args:
            path: the file, such as ``"run.mcap"``, which must not exist yet.
            *topics: names of topics, which may appear later; none: all that have a widget.

        Raises:
            TypeError: no path, or a name is no text. ValueError: the name does not end in ``.mcap``.
            OSError: the file exists, or cannot be written.
            FeedError: the feed is closed.

        Example:
            >>> with feed.record("run.mcap"):  # doctest: +SKIP
            ...     time.sleep(10)
        """
        from ._recorder import Recorder

        for topic in topics:
            check_name(topic)
        self.check_open()
        return Recorder(self, path, topics)

    def drive(self, linear: float = 0.0, angular: float = 0.0) -> None:
        """Publish a speed, cut to the limits of `driving`; unless it is renewed in time, zero follows.

        At most 50 speeds a second are published, the newest wins; zero is published at once. `drive_status` names a cut
        until the next speed that is not cut, and the log names it once. The first call waits two seconds at most for a
        subscriber to connect.

        Args:
            linear: forward, m/s.
            angular: counter-clockwise, rad/s.

        Raises:
            TypeError: no number. ValueError: NaN or infinite.
            FeedError: the robot cannot be reached or driven; a hand holds a pad, or stop is latched; the feed is
                closed. Nothing is sent then.
        """
        self.driver.drive(linear, angular)

    def stop(self) -> None:
        """Publish zero now, and return when it is sent.

        Raises:
            FeedError: zero was not sent. The text gives the reason, and whether zero is sent on reconnection.
        """
        if not self._closed or self._forked:
            self.driver.stop()

    @property
    def variables(self) -> Variables:
        """The values that programs read and that a person sets on the page, such as ``variables.near = 0.6``."""
        return self.programs.variables

    def program(
        self,
        function: Callable[..., Any] | None = None,
        *,
        rate: float | None = None,
        on: str | None = None,
        **topics: str,
    ) -> Any:
        """Have a function drive the robot, step by step; a decorator.

        One program at a time drives a robot. Defined again under its name, usually by running its cell again, it is
        replaced at the next step. A program of another name ends it.

        The function gets what it names as parameters: the newest ``scan``, ``speed`` and ``touch`` of the robot;
        ``time``, the seconds since its first step; ``state``, which it keeps from step to step and from version to
        version; ``variables``, which a person sets. It returns a `robowidgets.behaviors.Drive`, or None to keep the
        speed. It must return at once: after half a second it is abandoned. When it raises, and when a sample is
        missing or old, the robot is stopped.

        Args:
            function: the function, or a class that describes a state machine, see `robowidgets.behaviors.Machine`;
                without it, `program` returns a decorator.
            rate: steps a second, at most 200; 10 without `on`.
            on: a topic; there is one step for each of its messages, the newest if they come too fast.
            **topics: for a parameter, the topic that it is read from: ``scan="/base_scan"``. A parameter of any other
                name gets the messages of its topic.

        Raises:
            TypeError: no function, or it asks for something unknown. ValueError: the rate is out of range.
            FeedError: the feed is closed.

        Example:
            >>> from robowidgets import feeds
            >>> from robowidgets.behaviors import Drive
            >>> with feeds.simulator(wander=False) as robot:
            ...     @robot.program(rate=10)
            ...     def avoid(scan):
            ...         return Drive(0.2) if scan.distance("front") > 0.6 else Drive(0, 0.8)
            >>> avoid.mode
            'ended'
        """
        if on is not None:
            check_name(on)
        for topic in topics.values():
            check_name(topic)
        self.check_open()

        def install(given: Callable[..., Any]) -> Program:
            program = self.programs.install(given, rate, on, topics)
            self._call_watchers()  # a view shows the program from now on
            return program

        return install if function is None else install(function)

    def close(self) -> None:
        """Stop the robot if it is driven, disconnect, end every thread; doing it again does nothing.

        It takes a few seconds at most, whatever the robot and connected functions do.
        """
        with self._changed:
            if self._closed:
                return
            self._closed = True
        try:
            self.programs.close()
            with contextlib.suppress(FeedError, TimeoutError):  # the watchdog logs it
                self.watchdog.close()
        finally:
            try:
                self._functions.close()
                self._middleware.close()
            finally:
                open_feeds.discard(self.twin)
                with self._changed:
                    self._table.lose("the feed is closed")
                    self._changed.notify_all()
                self._call_watchers()

    def __enter__(self) -> Feed:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return "\n".join(as_text(*table) for table in self._tables())

    def _repr_html_(self) -> str:
        return "".join(as_html(*table) for table in self._tables())

    # -- what the middleware calls: see `Listener` ---------------------------------------------------------------------

    def on_connected(self) -> None:
        """See `Listener`."""
        with self._changed:
            if self._closed:
                return
            self._table.down, self._reached = "", True
            self._table.show_all()
            self._changed.notify_all()
        self.driver.on_connected()
        self._call_watchers()

    def on_lost(self, reason: str, again_in: float) -> None:
        """See `Listener`."""
        with self._changed:
            if self._closed:
                return
            lost = "connection lost" if self._reached else f"cannot reach {self.where}"
            self._table.lose(f"{lost}, trying again in {again_in:.2g} s: {reason}")
        self.watchdog.on_lost()
        self._call_watchers()

    def on_topics(self, topics: Sequence[Advert]) -> None:
        """See `Listener`."""
        with self._changed:
            if self._closed or (self.is_listed and self._adverts == tuple(topics)):
                return
            self._adverts = tuple(topics)
            self._list_topics()
            self._changed.notify_all()
        self._call_watchers()

    def on_message(self, topic: str, message: Any) -> None:
        """See `Listener`."""
        subscription = self._table.by_topic.get(topic)
        if subscription is None or self._closed:
            return
        if subscription.take(message):
            self._show_status(topic)
        self._functions.put(self.topic_of(topic), message)

    def on_trouble(self, topic: str, reason: str) -> None:
        """See `Listener`."""
        subscription = self._table.by_topic.get(topic)
        if subscription is None or self._closed or subscription.trouble == reason:
            return
        with self._changed:
            subscription.trouble = reason
            self._table.show(subscription)
        self._call_watchers()

    def on_unheard(self, topic: str, reason: str) -> None:
        """See `Listener`."""
        if self.driver.on_unheard(topic, reason):
            self._call_watchers()

    # -- for this package ----------------------------------------------------------------------------------------------

    @property
    def adverts(self) -> Sequence[Advert]:
        """The topics as the middleware listed them last."""
        return self._adverts

    @property
    def is_closed(self) -> bool:
        """Whether `close` was called."""
        return self._closed

    @property
    def is_listed(self) -> bool:
        """Whether the middleware has listed the topics."""
        return self._table.topics is not None

    @property
    def page_name(self) -> str:
        """The name by which the page knows the widgets of this robot."""
        return self._table.robot

    def check_open(self) -> None:
        """FeedError unless the feed is open, in this process."""
        if self._closed:
            why = "stayed with the process that was forked" if self._forked else "is closed"
            raise FeedError(f"the feed of {self.where} {why}: open it again")

    def wait_until(self, condition: Callable[[], bool], seconds: float) -> None:
        """Wait until a condition is true or the feed is closed, for some seconds at most."""
        until = time.monotonic() + seconds
        with self._changed:
            while not condition() and not self._closed and (left := until - time.monotonic()) > 0:
                self._changed.wait(left)

    def await_subscriber(self, topic: str) -> None:
        """Wait, on a feed that was just opened, for the connection and for a subscriber to a topic."""
        self.wait_until(
            lambda: self._reached and (bool(self.status) or self._has_subscriber(topic)),
            self._opened + PATIENCE - time.monotonic(),
        )

    def topic_of(self, name: str) -> Topic:
        """A topic as it is known now."""
        return (self._table.topics or {}).get(name) or unlisted(name)

    def status_of(self, topic: str) -> str:
        """The problems of a topic, connected or not; empty if there are none."""
        with self._changed:
            return self._table.status_of(topic)

    def trouble_of(self, topic: str) -> str:
        """The reason of the middleware why no message of a topic comes or can be read; empty if there is none."""
        subscription = self._table.by_topic.get(topic)
        return subscription.trouble if subscription is not None else ""

    def watch(self, on_change: Callable[[], None]) -> None:
        """Call a function whenever topics or connection have changed, and on closing, from any thread."""
        with self._changed:
            self._watchers.append(on_change)

    def forget(self, on_change: Callable[[], None]) -> None:
        """Remove a function that was added by `watch`."""
        with self._changed:
            if on_change in self._watchers:
                self._watchers.remove(on_change)

    def attach(self, topic: str, take: Callable[[Any], object]) -> Target:
        """Pass the messages of a topic to code of this package, in the transport's thread; it must return at once."""
        target = Target(take, None)
        self._connect(topic, [target])
        return target

    def detach(self, topic: str, target: Target) -> None:
        """End an `attach`."""
        with self._changed:
            self._table.disconnect(topic, [target])
        self._subscriber.update()

    def list_driven(self, topic: str) -> None:
        """List a topic on which only this feed publishes, so that a widget can show what is sent."""
        if topic != self._driven:
            self._driven = topic
            with self._changed:
                self._list_topics()
            self._call_watchers()

    def show_sent(self, topic: str, speed: Speed) -> None:
        """Show a speed that was sent as commanded, unless the middleware reports it like those of other publishers."""
        subscription = self._table.by_topic.get(topic)
        if subscription is not None and not self.topic_of(topic).offered:
            subscription.take(speed)
            self._show_status(topic)

    def on_fork(self) -> None:
        """Close in a forked process: the threads stayed with its parent, perhaps holding the lock."""
        self._changed = threading.Condition(threading.RLock())
        self._closed = self._forked = True

    def _showable(self) -> set[str]:
        return {topic.name for topic in self.topics if topic.widget}

    def _has_subscriber(self, topic: str) -> bool:
        """Whether a topic has a subscriber; or the middleware reports none on any topic."""
        known = [advert.wanted for advert in self._adverts if advert.wanted is not None]
        here = any(advert.name == topic and advert.wanted for advert in self._adverts)
        return self.is_listed and (here or bool(self._adverts and not known))

    def _connect(self, topic: str, targets: Sequence[Target]) -> None:
        with self._changed:
            self.check_open()
            self._table.connect(topic, targets)
        self._subscriber.update()

    def _list_topics(self) -> None:
        adverts = list(self._adverts)
        if self._driven is not None and all(advert.name != self._driven for advert in adverts):
            reports = any(advert.wanted is not None for advert in adverts)
            adverts.append(Advert(self._driven, TWIST, offered=False, wanted=False if reports else None))
        topics = topics_of(adverts)
        driven = topics.get(self._driven or "")
        if driven is not None and not driven.offered:  # whatever its name says
            topics[driven.name] = driven._replace(commanded=True)
        self._table.learn(topics)

    def _tables(self) -> list[Table]:
        tables = [table_of(self.where, self.topics, self.status)]
        if self.functions:
            tables.append(self._functions.table())
        return tables

    def _show_status(self, topic: str) -> None:
        with self._changed:
            subscription = self._table.by_topic.get(topic)
            if subscription is not None:
                self._table.show(subscription)

    def _wanted(self) -> Collection[str] | None:
        with self._changed:
            return None if self._closed else tuple(self._table.by_topic)

    def _call_watchers(self) -> None:
        # Without the lock: a view may make widgets and connect them.
        for on_change in list(self._watchers):
            on_change()


def _sorted(targets: Sequence[Any]) -> tuple[list[Target], list[Callable[[Any], object]]]:
    """The targets of `connect`, separated into those of widgets and functions."""
    every = [target_of(target) for target in targets]
    ours = [one for one in every if isinstance(one, Target)]
    return ours, [one for one in every if not isinstance(one, Target)]


def _log_dropped(closed: Sequence[Any]) -> None:
    """Log the functions of other cells that were connected to a feed which a new run of its cell closed."""
    cell, _ = running_cell()
    functions = [function for feed in closed if isinstance(feed, Feed) for function in feed.functions]
    names = [f"`{function.name}` ({function.topic})" for function in functions if function.cell != cell]
    if names:
        log.warning("the feed was opened anew; no longer connected: %s. Run their cells again", ", ".join(names))

"""The connection of a feed: its topics, the targets connected to them, and driving."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from ..behaviors.program import Program
from ..behaviors.programs import Programs
from ..behaviors.robot import DrivenRobot
from ..driving.stop_all import stop_at_end
from ..kinds import add_installed
from ..laser_widget import LaserWidget
from ..notebook.cells import predecessor, running_cell
from ..runtime.clock import Clock
from ..runtime.platform_fixes import let_threads_print, shorten_switch_interval
from ._driver import Driver
from ._frame_topics import FrameTopics
from ._listening import Listening
from ._open_feeds import open_feeds
from ._program_inputs import FeedInputs
from ._scanner_mounts import Held, ScannerMounts
from ._subscription import sorted_targets
from ._subscriptions import CLOSED, Subscriptions
from ._topics import check_name
from .middleware import Advert, FeedError, Middleware

log = logging.getLogger("robowidgets")


class Connection(Subscriptions):
    """The part of a feed that threads refer to: the `Listener` of its middleware, its subscriptions, and driving.

    It does not refer to the `Feed`. So the feed is deleted as soon as neither the user nor a widget refers to it, and
    then its program ends.

    Args:
        middleware: the connection to the robot, which `open` opens.
        is_deleted: returns True if the feed is deleted.
        clock: the clock of its waits and its driving.

    Attributes:
        unsent: the reason why zero could not be sent on closing, or empty if it was sent.
        driver, watchdog, programs: the parts that drive the robot.
        listening: the values of its topics while a list of topics is in view.
    """

    def __init__(self, middleware: Middleware, is_deleted: Callable[[], bool], clock: Clock) -> None:
        add_installed()
        super().__init__(middleware, clock)
        self.unsent = ""
        self.driver = Driver(self, middleware)
        self.watchdog = self.driver.watchdog
        self.programs = Programs(_robot_of(self, is_deleted))
        self.listening = Listening(self)
        self._scanner_mounts = ScannerMounts(self, self._pass_held)
        self._frame_topics = FrameTopics(self)

    def open(self) -> None:
        """Connect, and close what an earlier run of the same cell opened. Raise FeedError if it can never work."""
        shorten_switch_interval()
        let_threads_print()
        # Before it opens, because the feed of the earlier run may use the node, or drive the robot.
        _log_dropped(predecessor(self, Connection))
        open_feeds.add(self)
        try:
            self.middleware.open(self)
        except BaseException:
            open_feeds.discard(self)
            raise
        # Even with a guard: rclpy handles SIGTERM, so neither the process nor its guard ends.
        stop_at_end()

    def connect(self, topic: str, *targets: Any, raw: bool = False, each: bool = False) -> None:
        """See `Feed.connect`."""
        check_name(topic)
        if not targets:
            raise TypeError(
                f"connect({topic!r}): expected a widget, or a function of a sample, after the topic; got none"
            )
        of_widgets, functions = sorted_targets(topic, targets)
        there = {function.call for function in self.functions.functions if function.topic == topic}
        for target in of_widgets:
            if isinstance(target.widget, LaserWidget):
                target.widget.take_mounts(self.mounts.mounted)
        kept = self._connect(topic, of_widgets)
        with self._lock:
            for target in of_widgets:
                if not target.is_ours:
                    self.functions.connect(topic, [target.call], raw=True, each=target.on_missed is not None)
            self.functions.connect(topic, functions, raw, each)
            self._prune()
        new = [call for call in (*functions, *(one.call for one in of_widgets if not one.is_ours)) if call not in there]
        for message in kept:
            self.functions.put(self.topic_of(topic), message, new, each=False)
        self._subscribe()
        self._scanner_mounts.look()
        self._frame_topics.look()
        self._titles.call()

    def disconnect(self, topic: str, *targets: Any) -> None:
        """See `Feed.disconnect`."""
        check_name(topic)
        of_widgets, functions = sorted_targets(topic, targets)
        with self._lock:
            self.functions.disconnect(topic, [*functions, *(one.call for one in of_widgets)] if targets else None)
            self._disconnect(topic, of_widgets if targets else None)
            self._show(self.by_topic.get(topic))
        for target in of_widgets:
            if isinstance(target.widget, LaserWidget) and target.widget not in self.widgets:
                target.widget.take_mounts(None)
        self._subscribe()
        self._scanner_mounts.look()
        self._frame_topics.look()
        self._titles.call()

    def install(
        self, function: Callable[..., Any], rate: float | None, on: str | None, topics: Mapping[str, str]
    ) -> Program:
        """Run a function as the program. See `Feed.program`."""
        self.check_open()
        self.driver.prepare()
        program = self.programs.install(function, rate, on, topics)
        self._call_observers()  # a view shows the program from now on
        return program

    def close(self) -> None:
        """See `Feed.close`."""
        with self._lock:
            if self.is_closed:
                return
            self.is_closed = True
        try:
            self.programs.close()
            try:
                self.driver.close()
            except (FeedError, OSError) as error:  # the watchdog logs it
                self.unsent = str(error)
        finally:
            try:
                self.functions.close()
                self.middleware.close()
            finally:
                open_feeds.discard(self)
                self._frame_topics.look()
                self._scanner_mounts.close()
                with self._lock:
                    self._lose(CLOSED)
                    for widget in self.widgets:
                        widget.on_source_closed()
                    self._changed.notify_all()
                self._call_observers()

    # -- called by the middleware: see `Listener` ----------------------------------------------------------------------

    def on_connected(self) -> None:
        """See `Listener`."""
        with self._lock:
            if self.is_closed:
                return
            self.nobody, self._reached = "", True
            self._down = ""
            for subscription in self.by_topic.values():
                subscription.begin()
            self._show_all()
            self._changed.notify_all()
        self.driver.on_connected()
        self._call_observers()

    def on_lost(self, reason: str, again_in: float) -> None:
        """See `Listener`."""
        with self._lock:
            if self.is_closed:
                return
            self.nobody = ""
            lost = "connection lost" if self._reached else f"cannot reach {self.where}"
            self._lose(f"{lost}, trying again in {again_in:.2g} s: {reason}")
        self.watchdog.on_lost()
        self._call_observers()

    def on_nobody(self, reason: str) -> None:
        """See `Listener`."""
        with self._lock:
            if self.is_closed or self.nobody == reason:
                return
            self.nobody = reason
            self._lose(reason)
            self._changed.notify_all()
        self._call_observers()

    def on_topics(self, topics: Sequence[Advert]) -> None:
        """See `Listener`."""
        with self._lock:
            if self.is_closed or (self.is_listed and self.adverts == tuple(topics)):
                return
            self.adverts, self.is_listed = tuple(topics), True
            self._list_topics()
            self._changed.notify_all()
        self._scanner_mounts.look()
        self._frame_topics.look()
        self._call_observers()

    def on_message(
        self, topic: str, message: Any, *, newest: bool = True, each: bool = True, replaced: int = 0
    ) -> None:
        """See `Listener`."""
        subscription = self.by_topic.get(topic)
        if subscription is None or self.is_closed:
            return
        waits = self._scanner_mounts.holds(topic, message, newest=newest, each=each)
        # A target of every message, such as a recorder or a map, gets it without waiting for tf.
        if subscription.take(message, newest=newest and not waits, each=each, replaced=replaced):
            self._show_status(topic)
        if not waits:
            self.functions.put(self.topic_of(topic), message, newest=newest, each=each)

    def on_missed(self, topic: str, count: int) -> None:
        """See `Listener`."""
        subscription = self.by_topic.get(topic)
        if subscription is not None:
            subscription.miss(count)
            if self.functions.passes_each(topic):
                self.functions.miss(topic, count)

    def on_trouble(self, topic: str, reason: str) -> None:
        """See `Listener`."""
        subscription = self.by_topic.get(topic)
        if subscription is None or self.is_closed or subscription.trouble == reason:
            return
        with self._lock:
            subscription.trouble = reason
            self._show(subscription)
        self._call_observers()

    def on_unheard(self, topic: str, reason: str) -> None:
        """See `Listener`."""
        self.driver.on_unheard(topic, reason)

    def on_fork(self) -> None:
        """Close in a forked process."""
        self._free_lock()
        self.driver.on_fork()
        self.is_closed = self.is_forked = True

    def _pass_held(self, held: Held) -> None:
        """Pass on a message that waited for tf."""
        subscription = self.by_topic.get(held.topic)
        if subscription is None or self.is_closed:
            return
        if held.newest and subscription.take(held.message, each=False):
            self._show_status(held.topic)
        self.functions.put(self.topic_of(held.topic), held.message, newest=held.newest, each=held.each)


def _log_dropped(closed: Connection | None) -> None:
    """Log the functions of other cells that were connected to a feed that a new run of its cell has closed."""
    cell, _ = running_cell()
    functions = closed.functions.functions if closed is not None else ()
    names = [f"`{function.name}` ({function.topic})" for function in functions if function.cell != cell]
    if names:
        log.warning("the feed was opened again; no longer connected: %s. Run their cells again", ", ".join(names))


def _robot_of(connection: Connection, is_deleted: Callable[[], bool]) -> DrivenRobot:
    """Return the robot of a feed, as its program sees it.

    Args:
        connection: the connection of the feed.
        is_deleted: returns True if the feed is deleted, because neither the user nor a widget refers to it.
    """
    watchdog = connection.watchdog
    return DrivenRobot(
        where=connection.where,
        is_gone=is_deleted,
        is_stopped=lambda: watchdog.stopped,
        listen=partial(FeedInputs, connection),
        drive=connection.driver.drive_by_program,
        halt=watchdog.stop_program,
        is_guarded=lambda: connection.driver.is_guarded,
    )

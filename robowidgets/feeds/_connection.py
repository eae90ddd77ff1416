"""The connection of a feed: its topics, the targets connected to them, and driving."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from typing import Any

from ..behaviors.program import Program
from ..behaviors.programs import Programs
from ..behaviors.robot import DrivenRobot
from ..driving.command_watchdog import Velocity
from ..driving.stop_all import stop_at_end
from ..kinds import add_installed, on_demand_for_type, topic_and_field
from ..laser_widget import LaserWidget
from ..messages.twist import TWIST
from ..notebook.cells import running_cell, take_the_place
from ..runtime.clock import Clock, Threads
from ..runtime.coalesced_call import CoalescedCall
from ..runtime.platform_fixes import let_threads_print, shorten_switch_interval
from ..samples import Speed
from ..widget.observed import Observed
from ..widget.sample_widget import SampleWidget
from ..widget.title_observers import TitleObservers
from ._callbacks import FunctionCaller
from ._driver import Driver
from ._frame_topics import FrameTopics
from ._listening import Listening
from ._open_feeds import open_feeds
from ._program_inputs import FeedInputs
from ._scanner_mounts import Held, ScannerMounts
from ._subscription import Target, sorted_targets
from ._subscription_table import CLOSED, SubscriptionTable
from ._topics import FeedTopic, check_name, decided, topics_of, unlisted
from .middleware import Advert, FeedError, Middleware

log = logging.getLogger("robowidgets")

DISCOVERY_TIMEOUT_S = 2.0
"""Seconds after opening for which `show`, `drive` and `stop` wait for the topics and for a subscriber."""


class Connection(Observed):
    """The part of a feed that threads refer to: the `Listener` of its middleware, its subscriptions, and driving.

    It does not refer to the `Feed`. So the feed is deleted as soon as neither the user nor a widget refers to it, and
    then its program ends.

    Args:
        middleware: the connection to the robot, which `open` opens.
        is_deleted: returns True if the feed is deleted.
        clock: the clock of its waits and its driving.

    Attributes:
        clock: that clock.
        functions: the connected functions.
        mounts: the mounting angles of the scanners on the robot.
        adverts: the topics as the middleware listed them last.
        is_closed: True if `close` was called, or this is a forked process.
        is_forked: True if it belongs to the parent of this forked process.
        nobody: hint to show if no robot may be there although it is connected, or empty if a robot is there.
        unsent: the reason why zero could not be sent on closing, or empty if it was sent.
        sent_count: the number of sent speeds, including zero.
        driver, watchdog, programs: the parts that drive the robot.
        listening: the values of its topics while a list of topics is in view.
    """

    def __init__(self, middleware: Middleware, is_deleted: Callable[[], bool], clock: Clock) -> None:
        super().__init__()
        add_installed()
        self.clock = clock
        self.middleware = middleware
        self._lock = threading.RLock()
        self._changed = self.clock.condition(self._lock)
        self._scanner_mounts = ScannerMounts(self, self._pass_held)
        self.mounts = self._scanner_mounts.mounts
        self.functions = FunctionCaller(self._show_status, mounted=self.mounts.mounted)
        self._titles = TitleObservers(Threads(clock))
        self._table = SubscriptionTable(f"connecting to {middleware.where}", self.functions, self._titles, clock.now)
        self.adverts: tuple[Advert, ...] = ()
        self.nobody = self.unsent = ""
        self.sent_count = 0
        self._reached = self._listed = self.is_closed = self.is_forked = False
        self._driven: str | None = None
        """The topic on which this feed publishes speeds and no other node publishes anything."""
        self._decided: dict[str, FeedTopic] = {}
        """The topics whose widget was chosen by a message."""
        self._opened = self.clock.now()
        self._subscribe = CoalescedCall(self._follow_connected)
        self.driver = Driver(self, middleware)
        self.watchdog = self.driver.watchdog
        self.programs = Programs(_robot_of(self, is_deleted))
        self.listening = Listening(self)
        self._frame_topics = FrameTopics(self)

    def open(self) -> None:
        """Connect, and close what an earlier run of the same cell opened. Raise FeedError if it can never work."""
        shorten_switch_interval()
        let_threads_print()
        # Before it opens, because the feed of the earlier run may use the node, or drive the robot.
        _log_dropped(take_the_place(self))
        open_feeds.add(self)
        try:
            self.middleware.open(self)
        except BaseException:
            open_feeds.discard(self)
            raise
        # Even with a guard: rclpy handles SIGTERM, so neither the process nor its guard ends.
        stop_at_end()

    @property
    def where(self) -> str:
        """See `Feed.where`."""
        return self.middleware.where

    @property
    def topics(self) -> tuple[FeedTopic, ...]:
        """See `Feed.topics`."""
        return tuple((self._table.topics or {}).values())

    @property
    def status(self) -> str:
        """See `Feed.status`."""
        # Views look once more when the feed is closed, maybe before the table is.
        return CLOSED if self.is_closed else self._table.down

    @property
    def widgets(self) -> tuple[SampleWidget, ...]:
        """The widgets that are connected."""
        return self._table.widgets

    @property
    def connected(self) -> dict[str, tuple[Target, ...]]:
        """The targets of the messages of each topic, except connected functions."""
        return {topic: one.targets for topic, one in dict(self._table.by_topic).items()}

    def connect(self, topic: str, *targets: Any, raw: bool = False, each: bool = False) -> None:
        """See `Feed.connect`."""
        check_name(topic)
        if not targets:
            raise TypeError(f"connect({topic!r}) needs a widget, or a function of a sample")
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
            self._table.prune()
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
            self._table.disconnect(topic, of_widgets if targets else None)
            self._show(topic)
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
                    self._table.close()
                    self._changed.notify_all()
                self._call_observers()

    # -- called by the middleware: see `Listener` ----------------------------------------------------------------------

    def on_connected(self) -> None:
        """See `Listener`."""
        with self._lock:
            if self.is_closed:
                return
            self.nobody, self._reached = "", True
            self._table.begin()
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
            self._table.lose(f"{lost}, trying again in {again_in:.2g} s: {reason}")
        self.watchdog.on_lost()
        self._call_observers()

    def on_nobody(self, reason: str) -> None:
        """See `Listener`."""
        with self._lock:
            if self.is_closed or self.nobody == reason:
                return
            self.nobody = reason
            self._table.lose(reason)
            self._changed.notify_all()
        self._call_observers()

    def on_topics(self, topics: Sequence[Advert]) -> None:
        """See `Listener`."""
        with self._lock:
            if self.is_closed or (self.is_listed and self.adverts == tuple(topics)):
                return
            self.adverts, self._listed = tuple(topics), True
            self._list_topics()
            self._changed.notify_all()
        self._scanner_mounts.look()
        self._frame_topics.look()
        self._call_observers()

    def on_message(
        self, topic: str, message: Any, *, newest: bool = True, each: bool = True, replaced: int = 0
    ) -> None:
        """See `Listener`."""
        subscription = self._table.by_topic.get(topic)
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
        subscription = self._table.by_topic.get(topic)
        if subscription is not None:
            subscription.miss(count)
            if self.functions.passes_each(topic):
                self.functions.miss(topic, count)

    def on_trouble(self, topic: str, reason: str) -> None:
        """See `Listener`."""
        subscription = self._table.by_topic.get(topic)
        if subscription is None or self.is_closed or subscription.trouble == reason:
            return
        with self._lock:
            subscription.trouble = reason
            self._table.show(subscription)
        self._call_observers()

    def on_unheard(self, topic: str, reason: str) -> None:
        """See `Listener`."""
        if self.driver.on_unheard(topic, reason):
            self._call_observers()

    # -- for this package ----------------------------------------------------------------------------------------------

    @property
    def is_listed(self) -> bool:
        """True once the middleware has listed the topics."""
        return self._listed

    @property
    def is_settled(self) -> bool:
        """True once the topics are listed and there was time to discover them after opening."""
        return self.is_listed and self.clock.now() >= self._opened + DISCOVERY_TIMEOUT_S

    @property
    def page_name(self) -> str:
        """The name of this robot on the page, which its widgets share."""
        return self._table.robot

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
        subscription = self._table.by_topic.get(topic)
        return self.status or ("" if subscription is None else subscription.why_missing(self._table.topics))

    def topic_of(self, name: str) -> FeedTopic:
        """Return a topic as it is known now."""
        return (self._table.topics or {}).get(name) or unlisted(name)

    def status_of(self, topic: str) -> str:
        """Return the problems of a topic, connected or not, or empty."""
        with self._lock:
            return self._table.status_of(topic)

    def trouble_of(self, topic: str) -> str:
        """Return the middleware's reason why a topic's messages do not come or cannot be read, or empty."""
        subscription = self._table.by_topic.get(topic)
        return subscription.trouble if subscription is not None else ""

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

    def decide(self, topic: FeedTopic, message: Any) -> None:
        """List the widget that can show the messages of a topic, decided by this message."""
        found = decided(topic, message)
        if found.widget:
            with self._lock:
                self._decided[topic.name] = found
                self._list_topics()
            self._call_observers()

    def detach(self, topic: str, target: Target) -> None:
        """End an `attach`."""
        with self._lock:
            self._table.disconnect(topic, [target])
        self._subscribe()
        self._titles.call_later()

    def mounted(self, sample: Any) -> Any:
        """Return a scan with the angles of the robot if the mount of its scanner is known, or any sample unchanged."""
        return self.mounts.mounted(sample)

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

    def _show_speed(self, topic: str, speed: Speed) -> None:
        subscription = self._table.by_topic.get(topic)
        if subscription is not None and not self.topic_of(topic).offered:
            subscription.take(speed)
            users = [target.call for target in subscription.targets if not target.is_ours]
            self.functions.put(self.topic_of(topic), speed, users)
            self._show_status(topic)

    def on_driving(self) -> None:
        """Show changed settings of driving: a pad has a knob for each direction in which the robot moves."""
        self._call_observers()

    def on_fork(self) -> None:
        """Close in a forked process. The threads stayed in the parent process and may have held the lock."""
        self._lock = threading.RLock()
        self._changed = self.clock.condition(self._lock)
        self.driver.on_fork()
        self.is_closed = self.is_forked = True

    def _has_subscriber(self, topic: str) -> bool:
        """Return True if a topic has a subscriber, or if the middleware does not report subscribers at all."""
        known = [advert.wanted for advert in self.adverts if advert.wanted is not None]
        here = any(advert.name == topic and advert.wanted for advert in self.adverts)
        return self.is_listed and (here or bool(self.adverts and not known))

    def _connect(self, topic: str, targets: Sequence[Target]) -> tuple[Any, ...]:
        """Add targets. Return the message kept for new subscribers, as `SubscriptionTable.connect` does."""
        with self._lock:
            self.check_open()
            there = self._table.by_topic.get(topic)
            new = [target for target in targets if there is None or target not in there.targets]
            kept = self._table.connect(topic, targets)
            subscription = self._table.by_topic[topic]
        self._scanner_mounts.note(topic, targets)
        self._subscribe()
        subscription.pass_kept(kept, new)  # without the lock, as for a new message
        return kept

    def _list_topics(self) -> None:
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
        self._table.learn(topics)

    def _call_observers(self) -> None:
        self._titles.call()
        super()._call_observers()

    def _show_status(self, topic: str) -> None:
        with self._lock:
            self._show(topic)
        self._titles.call()

    def _show(self, topic: str) -> None:
        """Show the status of a topic. Called with the lock held."""
        subscription = self._table.by_topic.get(topic)
        if subscription is not None:
            self._table.show(subscription)

    def _pass_held(self, held: Held) -> None:
        """Pass on a message that waited for tf."""
        subscription = self._table.by_topic.get(held.topic)
        if subscription is None or self.is_closed:
            return
        if held.newest and subscription.take(held.message, each=False):
            self._show_status(held.topic)
        self.functions.put(self.topic_of(held.topic), held.message, newest=held.newest, each=held.each)

    def _follow_connected(self) -> None:
        """Make the middleware pass on the connected topics."""
        with self._lock:
            topics = frozenset(self._table.by_topic)
            each = frozenset(
                topic
                for topic, one in self._table.by_topic.items()
                if one.passes_each or self.functions.passes_each(topic)
            )
        # Without the lock: the middleware may take a lock that one of its threads holds while waiting for ours.
        if not self.is_closed:
            self.middleware.follow(topics, each)


def _log_dropped(closed: Sequence[Any]) -> None:
    """Log the functions of other cells that were connected to a feed that a new run of its cell has closed."""
    cell, _ = running_cell()
    functions = [function for feed in closed if isinstance(feed, Connection) for function in feed.functions.functions]
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

"""Driving the robot of a feed."""

from __future__ import annotations

import contextlib
import itertools
import logging
import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from ..driving.command_watchdog import (
    ASSISTANT,
    PROGRAM,
    ZERO,
    CommandWatchdog,
    Lease,
    RefusedError,
    Request,
    Velocity,
)
from ..runtime.log_once import call_in_thread
from ..samples.staleness import PAGE_SILENCE
from ._driving import USUAL, DriveStatus, Driving, heard_speeds, unheard
from ._guard.guard import OFF, guard_for, release
from ._guard.link import HasGuard, NoAnswerError
from ._subscriptions import Subscriptions
from ._twist import TwistPublisher
from .middleware import Advert, FeedError, HasOutlet, Middleware, NotConnectedYetError

log = logging.getLogger("robowidgets")

CONNECT_TIMEOUT = 2.0
"""Seconds after the first `drive` on a topic, and on closing, for which a speed waits for a subscriber to connect.

On closing, also the seconds for which zero is sent again until it is confirmed."""

START_TIMEOUT = 30.0
"""Seconds for which the first `drive` waits for the guard to start."""

RETRY_PAUSE = 0.05
"""Seconds between two attempts to send a speed."""


_numbers = itertools.count()


class Driver:
    """The part of a feed that checks speeds against limits, connection and latch, and passes them to the watchdog.

    The watchdog decides which speed is sent, and when. A guard, which is a separate process, sends it, and sends zero
    when it gets no more messages. If the guard does not run, or cannot send a zero, the middleware of the feed sends.

    Args:
        connection: the connection of the feed, with its topics.
        middleware: the middleware that publishes the speeds.

    Attributes:
        watchdog: the watchdog that sends the speeds.
    """

    def __init__(self, connection: Subscriptions, middleware: Middleware) -> None:
        self._connection, self._clock = connection, connection.clock
        self._driving = Driving()
        self._chosen: tuple[Driving, Driving] | None = None
        """The settings without a topic, and the same settings with the topic that was chosen for them."""
        self._changing = threading.Lock()
        """Held while the settings change, so that no speed is sent between the old topic's zero and the new topic."""
        self._status = DriveStatus()
        self._twists = TwistPublisher(middleware, self._clock)
        self._connected_by: float | None = None
        """The time by which a subscriber should have connected, or None before the first `drive` on the topic."""
        self._page_at = float("-inf")
        self._by_hand = False
        self._number, self._is_prepared = next(_numbers), False
        self._outlet = middleware.outlet if isinstance(middleware, HasOutlet) and not OFF else None
        self._guard = guard_for(self._number, self._outlet, connection.where) if self._outlet else None
        self._link = middleware.guard if isinstance(middleware, HasGuard) else self._guard
        """The guard of the driver or of the middleware, or None."""
        self._guard_ends = self._guard_stops = 0
        """The numbers of ends of the guard and of stops by the guard that were handled."""
        self._standstills = 0
        """The number of reported standstills of the watchdog."""
        self.watchdog = CommandWatchdog(self._send, not_sent=FeedError, clock=self._clock)
        self.watchdog.observe(self._after_send)
        if self._link is not None:
            self._link.observe(self._after_guard)
            self._link.on_unheard[self._number] = self.on_unheard
            self._link.on_sent[self._number] = connection.show_beside

    def prepare(self) -> None:
        """Start the guard if there may be one, because it takes a moment until it can send a speed."""
        self._is_prepared = True
        if self._guard is not None:
            self._guard.start()

    @property
    def is_guarded(self) -> bool:
        """True if a guard sends zero when this process cannot, now or once it is started."""
        return self._link is not None and not self._link.unavailable

    def _await_guard(self) -> None:
        """Start the guard, and wait until it can send a speed or has failed to for too long."""
        self.prepare()
        guard, until = self._link, self._clock.now() + START_TIMEOUT
        while guard is not None and guard.is_starting and self._clock.now() < until:
            self._connection.wait_until(lambda: not guard.is_starting, RETRY_PAUSE)

    @property
    def sender(self) -> str:
        """Text for the sender of the speeds and its effect on stopping, or empty if it is not known yet."""
        guard = self._link
        if guard is None and not self._is_prepared:
            return ""
        if guard is not None and not guard.unavailable:
            return "a guard next to the kernel sends speeds, and zero if the kernel is killed or hangs"
        why = f" ({guard.unavailable})" if guard is not None else ""
        return f"the kernel itself sends speeds{why}: if it is killed or hangs, no zero is sent"

    @property
    def driving(self) -> Driving:
        """See `Feed.driving`."""
        given, chosen = self._driving, self._chosen
        return chosen[1] if chosen is not None and chosen[0] is given else given

    @driving.setter
    def driving(self, driving: Driving) -> None:
        if not isinstance(driving, Driving):
            raise TypeError(f"driving: expected feeds.Driving(topic=..., max_linear=...), got {driving!r}")
        with self._changing:
            if self.watchdog.owes_zero:
                with contextlib.suppress(FeedError, OSError):  # the watchdog logs it and sends zero later
                    self.watchdog.sent_in_time(self.watchdog.stop())
            self._driving, self._connected_by = driving, None
            self._status.cut = self._status.taken = ""
        self.prepare()
        self._connection.on_driving()

    @property
    def topic(self) -> str:
        """The topic on which speeds are published now."""
        return self.driving.topic or USUAL

    @property
    def status(self) -> str:
        """See `Feed.drive_status`."""
        reasons = self._status.reasons(self.topic, self._listed)
        if self._link is not None and self._link.is_driven_beside(self._number):
            reasons.append("another feed of this kernel drives the robot, too")
        return self._connection.status or "; ".join(reasons)

    def drive(self, wanted: Velocity) -> None:
        """See `Feed.drive`."""
        velocity, stops = self._within(wanted), self.watchdog.stops
        self._await_robot()
        self._send_soon(velocity, stops)

    def drive_by_program(self, linear: float, angular: float, lateral: float) -> str:
        """Publish the speed of a program's step without waiting. Return why it was not sent, or empty if it was.

        It also returns the error of an earlier speed, because another thread sends this one.
        """
        return self._drive_now(Velocity(linear, angular, lateral))

    def drive_by_assistant(self, wanted: Velocity, seconds: float, check: Callable[[], object]) -> Lease:
        """Publish the first speed of an assistant's command, and return the lease with which `renew` repeats it.

        Args:
            wanted: the speed.
            seconds: the time for which it is valid.
            check: raises an error if the command was cancelled while it waited for the robot. Nothing is sent then.

        Raises:
            FeedError: as `Feed.drive`, or a program drives.
        """
        velocity, stops = self._within(wanted), self.watchdog.stops
        self._await_robot()
        check()
        lease = self.watchdog.lend(seconds, stops)
        try:
            self._send_soon(velocity, stops, lease, check)
            check()
        except BaseException:
            self.watchdog.end_lease(lease)
            raise
        return lease

    def renew(self, wanted: Velocity, lease: Lease) -> str:
        """Publish the speed of an assistant again, as `drive_by_program`."""
        return self._drive_now(wanted, lease)

    def drive_by_hand(self, wanted: Velocity, press: str) -> None:
        """Publish the speed of a press on a pad without waiting. Raises as `Feed.drive`."""
        self._by_hand = True
        self._request(self._within(wanted), press)

    def stop(self) -> None:
        """See `Feed.stop`."""
        self._status.cut = self._status.stalled = ""
        self._connection.await_subscriber(self.topic)
        self._connection.check_open()
        try:
            self.watchdog.sent_in_time(self.watchdog.stop())
        except (FeedError, OSError) as error:
            follows = "; zero follows when it can be sent" if self.watchdog.owes_zero else ""
            raise FeedError(f"cannot stop: {self._connection.status or error}{follows}") from None
        finally:
            self._log_status()
        if nobody := self._connection.nobody or self._heard_elsewhere():
            raise FeedError(f"cannot stop: {nobody}")

    def end(self) -> None:
        """Send zero if one is owed, and refuse every speed from now on, without waiting."""
        self.watchdog.refuse(self)

    def close(self) -> None:
        """Send zero if one is owed, and refuse every speed from now on.

        It waits for a subscriber that is connecting. Without a guard, it also sends zero again until it is confirmed.

        Raises:
            FeedError, OSError: zero could not be sent.
        """
        until = self._clock.now() + CONNECT_TIMEOUT
        try:
            self.watchdog.close()
        except (FeedError, OSError):
            if not self._may_arrive_soon:
                raise
            while self.watchdog.busy_for or not self._try_zero():
                if self._clock.now() > until:
                    raise
                self._clock.sleep(RETRY_PAUSE)
        finally:
            if self._link is not None:
                self._link.unobserve(self._after_guard)
            if self._outlet is not None:
                release(self._number, self._outlet)

    def on_fork(self) -> None:
        """Close in a forked process. Threads of its parent may have held the locks."""
        self._changing = threading.Lock()
        self.watchdog.on_fork()

    def page_seen(self) -> None:
        """Record that a page shows the feed or one of its pads."""
        self._page_at = self._clock.now()

    def on_connected(self) -> None:
        """Send the overdue zeros."""
        if self._guard is not None:
            self._guard.hurry()
        self._twists.on_connected()
        self.watchdog.on_connected()

    def on_unheard(self, topic: str, reason: str) -> None:
        """Show why a subscriber does not receive speeds. See `Listener`."""
        is_new = self._status.unheard.get(topic, "") != reason
        self._status.unheard[topic] = reason
        if is_new:
            self._connection.on_driving()

    def _await_robot(self) -> None:
        """Wait until the guard can send a speed, and a moment for a subscriber."""
        self._connection.check_open()
        self._await_guard()
        self._connection.await_subscriber(self.topic)
        if self._connected_by is None:
            self._connected_by = self._clock.now() + CONNECT_TIMEOUT

    def _send_soon(
        self, velocity: Velocity, stops: int, lease: Lease | None = None, check: Callable[[], object] = lambda: None
    ) -> None:
        """Send a speed, again and again while a subscriber is connecting."""
        try:
            while not self._try_drive(velocity, stops, lease):
                self._connection.wait_until(lambda: False, RETRY_PAUSE)
                check()
        finally:
            self._log_status()

    def _drive_now(self, wanted: Velocity, lease: Lease | None = None) -> str:
        """Send a speed without waiting. Return why it, or the speed before, was not sent, or empty."""
        try:
            self._request(self._within(wanted), PROGRAM, lease=lease)
        except FeedError as error:
            return str(error)
        finally:
            self._log_status()
        error_before = self.watchdog.error
        return "" if error_before is None else f"cannot drive: {self._connection.status or error_before}"

    def _within(self, wanted: Velocity) -> Velocity:
        velocity = self._driving.within(wanted)
        self._status.cut = "" if velocity == wanted else self._driving.cut(wanted)
        return velocity

    def _try_drive(self, velocity: Velocity, stops: int, lease: Lease | None) -> bool:
        """Send the speed of a program or an assistant. Return False if it must be sent again for a new subscriber.

        It is refused if it was stopped while it waited, since the stop number ``stops``.
        """
        request = self._request(velocity, PROGRAM, stops, lease)
        try:
            self.watchdog.sent_in_time(request)
        except (FeedError, OSError) as error:
            until = max(self._connected_by or 0.0, self._link.up_at + CONNECT_TIMEOUT if self._link else 0.0)
            if isinstance(error, NotConnectedYetError) and self._clock.now() < until:
                return False
            raise FeedError(f"cannot drive: {self._connection.status or error}") from None
        return True

    @property
    def _may_arrive_soon(self) -> bool:
        """True if another attempt to send zero makes sense. A guard that is there sends a lost zero again by itself."""
        error, is_guarded = self.watchdog.error, self._guard is not None and self._guard.is_there
        return isinstance(error, NotConnectedYetError) or (isinstance(error, TimeoutError) and not is_guarded)

    def _try_zero(self) -> bool:
        """Send zero without the watchdog, which is closed. Return False if another attempt may succeed."""
        try:
            self._send(*ZERO)
        except (NotConnectedYetError, TimeoutError):
            return False
        return True

    def _request(
        self, velocity: Velocity, driver: str, stops: int | None = None, lease: Lease | None = None
    ) -> Request:
        """Check a speed and request it from the watchdog. Raise FeedError if a check fails."""
        self._connection.check_open()
        if self._connection.status and not self._is_reached_by_guard:
            raise FeedError(f"cannot drive: {self._connection.status}")
        self._choose(is_driven=velocity != ZERO)
        if velocity != ZERO:
            if self.driving.topic is None and (elsewhere := self._heard_elsewhere()):
                raise FeedError(f"cannot drive: {elsewhere}")
            self._connection.list_driven(self.topic)
        with self._changing:
            is_page_gone = self._clock.now() - self._page_at > PAGE_SILENCE
            if velocity != ZERO and self._driving.needs_page and is_page_gone:
                raise FeedError(
                    "cannot drive: no page that shows this feed or its pad answers, and driving.needs_page asks for "
                    "one; while a cell runs, only ipykernel 7 or later receives messages of the page"
                )
            try:
                by = driver if lease is None else ASSISTANT
                return self.watchdog.drive(velocity, self._driving.hold, by, stops, lease)
            except RefusedError as error:
                raise FeedError(f"cannot drive: {error}") from None

    @property
    def _is_reached_by_guard(self) -> bool:
        """True if the guard still reaches a robot that this process has lost, as it may without a ROS 1 master."""
        is_lost = self._connection.is_listed and self._connection.status != self._connection.nobody
        return is_lost and self._guard is not None and self._guard.is_up

    def _send(self, linear: float, angular: float, lateral: float) -> None:
        """The sink of the watchdog, called in its thread."""
        velocity = Velocity(linear, angular, lateral)
        if velocity != ZERO:
            self._connection.check_open()
        self._choose(is_driven=False)
        topic = self.topic
        if not self._send_by_guard(topic, velocity):
            self._twists.send(topic, velocity, self._connection.adverts)
            self._status.refused = self._twists.refused
        if self._guard is not None:
            self._guard.tell_others(self._number, topic, velocity)

    def _send_by_guard(self, topic: str, velocity: Velocity) -> bool:
        """Send a speed by the guard. Return False if the kernel must send it, because the guard cannot."""
        guard = self._guard
        if guard is None or guard.unavailable or (velocity == ZERO and not guard.is_there):
            return False
        here = [advert for advert in self._connection.adverts if advert.name == topic]
        try:
            sent = guard.send(self._number, topic, velocity, self.watchdog.expires, here)
        except (FeedError, OSError) as error:
            # The guard repeats a zero that was published but not confirmed, for as long as needed.
            is_published = isinstance(error, TimeoutError) and not isinstance(error, NoAnswerError)
            if velocity != ZERO or is_published:
                raise
            return False
        self._twists.note_moved(topic, sent.moved)
        self._status.refused = sent.refused
        return True

    @property
    def _listed(self) -> Sequence[Advert] | None:
        """The topics, or None before they are listed."""
        return self._connection.adverts if self._connection.is_listed else None

    def _choose(self, *, is_driven: bool) -> None:
        """Choose a topic if no topic is set: the usual one, or the only velocity topic with a subscriber.

        A topic that was driven once stays chosen: if its robot is gone for a moment, no other robot is driven instead.
        """
        given, adverts = self._driving, self._connection.adverts
        if self.driving.topic is not None:
            return
        heard = heard_speeds(adverts)
        if USUAL in heard:
            if is_driven:
                self._chosen = given, replace(given, topic=USUAL)
        elif len(heard) == 1 and self._connection.is_settled and unheard(USUAL, adverts):
            self._chosen = given, replace(given, topic=heard[0])
            self._status.taken = (
                f"{USUAL} has no subscriber; sending speeds to {heard[0]}, the only velocity topic that has one"
            )

    def _heard_elsewhere(self) -> str:
        """Return a text if the topic has no subscriber but other velocity topics do, or empty."""
        topic, adverts = self.topic, self._connection.adverts
        heard = heard_speeds(adverts)
        if not heard or not self._connection.is_settled or not (reason := unheard(topic, adverts)):
            return ""
        return f"{reason}; name the topic of your robot: feed.driving = feeds.Driving(topic={heard[0]!r})"

    def _log_status(self) -> None:
        """Log why the robot may not move as commanded, after a speed or a zero was requested."""
        if not self._connection.status:
            self._status.log(self._connection.where, self.topic, self._listed)

    def _after_guard(self) -> None:
        """Stop a robot whose guard has ended or has stopped it. The guard calls this in its thread."""
        guard = self._link
        if guard is None:
            return
        has_ended, has_stopped = guard.ends != self._guard_ends, guard.stops != self._guard_stops
        self._guard_ends, self._guard_stops = guard.ends, guard.stops
        if has_stopped:
            self._status.stalled = guard.told
            self.watchdog.note_standstill(guard.told)
        elif has_ended and self.watchdog.owes_zero:
            self.watchdog.stop()
        self._connection.on_driving()

    def _after_send(self) -> None:
        watchdog = self.watchdog
        if self._standstills < watchdog.standstills:
            self._standstills = watchdog.standstills
            if not self.is_guarded:  # else the guard reports the same standstill
                self._status.stalled = f"{watchdog.stood}: the robot was stopped after it"
                call_in_thread(partial(log.warning, "%s: %s", self._connection.where, self._status.stalled))
        if self._by_hand and watchdog.sent == ZERO and not watchdog.driver:
            self._by_hand, self._status.cut = False, ""  # the press has ended, and its speed is not cut any more
        if watchdog.error is None:
            self._connection.show_sent(self.topic, watchdog.sent.as_speed)

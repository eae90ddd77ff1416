"""The kernel's side of the connection to a guard: it sends speeds, and receives the results."""

from __future__ import annotations

import itertools
import logging
import os
import select
import socket
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple, Protocol, runtime_checkable
from weakref import WeakSet

from ...driving.command_watchdog import ZERO, Velocity
from ...runtime.clock import RealClock
from ...runtime.log_once import call_in_thread
from ...widget.observed import Observed
from ..middleware import Advert, FeedError, NotConnectedYetError
from .frames import FROM_GUARD, DamagedError, Unpacker, packed

log = logging.getLogger("robowidgets")

BEAT = 0.1
"""Seconds between two signs of life while a robot moves."""

ANSWER = 0.8
"""Seconds within which a guard answers, or reports a slow message. Each message waits for at most half a second."""

LOOK = 0.1
"""Seconds between two checks for an answer."""

WORKS = 0.05
"""A process whose threads wait for the GIL uses at least this many seconds of processor time per second."""

ENDED = "the guard that sends speeds has ended"

_CLOCK = RealClock()

_ERRORS = {kind.__name__: kind for kind in (FeedError, NotConnectedYetError, TimeoutError, ConnectionError)}


class NoAnswerError(TimeoutError):
    """The guard itself does not answer."""


class Sent(NamedTuple):
    """The result of a speed: the subscribers that it did not reach, and the types in which its topic got speeds."""

    refused: str
    moved: list[str]


class _Answer:
    def __init__(self) -> None:
        self.is_there = False
        self.error: BaseException | None = None
        self.sent = Sent("", [])


class GuardLink(Observed):
    """The connection to a guard, over a socket.

    Any thread may call each method. One thread runs `listen`, which reads the messages of the guard and reports to it
    that the kernel is alive.

    Args:
        where: text for the robot.

    Attributes:
        unavailable: the reason why a guard cannot run here, so that the kernel sends speeds; or empty.
        down: the reason why no speed can be sent now, or empty if speeds can be sent.
        told: text for the last standstill of the kernel or the guard, or empty before the first.
        stops: the number of stops of the robot because of a standstill.
        ends: the number of guard processes that ended unexpectedly.
        up_at: the monotonic time at which the robot was reached last.
    """

    def __init__(self, where: str) -> None:
        super().__init__()
        self._where = where
        self.unavailable = self.told = ""
        self.down = "the guard that sends speeds is starting"
        self.stops = self.ends = 0
        self.up_at = float("-inf")
        self.on_unheard: dict[int, Callable[[str, str], object]] = {}
        """By feed, a function that is called with a topic and the reason why a subscriber does not receive it."""
        self.on_sent: dict[int, Callable[[str, Velocity], object]] = {}
        """By feed, a function that is called with each topic and speed that another feed has sent by this guard."""
        self._lock = threading.RLock()
        self._changed = threading.Condition(self._lock)
        self._socket: socket.socket | None = None
        self._is_ready = self._is_up = self._is_closed = self._hangs = self._has_been_ready = False
        self._is_starting = True
        self._known_stops = 0
        """The number of stops that the current process has reported."""
        self._numbers = itertools.count()
        self._answers: dict[int, _Answer] = {}
        self._slow = 0
        """The number of slow messages."""
        self._moving: set[int] = set()
        """The feeds whose last speed was not zero."""
        self._beat_at, self._worked, self._share = 0.0, 0.0, 0.0
        """The time of the last sign of life, the processor time at it, and the share of it in the last silence."""
        _links.add(self)

    @property
    def is_starting(self) -> bool:
        """True while a process is about to accept speeds and to reach the robot for the first time."""
        return self._is_starting

    @property
    def is_up(self) -> bool:
        """True while it reaches the robot."""
        return self._is_up

    @property
    def is_there(self) -> bool:
        """True while its process accepts speeds, even if the robot cannot be reached."""
        return self._is_ready

    def send(self, feed: int, topic: str, velocity: Velocity, expires: float, adverts: Sequence[Advert]) -> Sent:
        """Send a speed, or zero, and return when it is sent.

        Args:
            feed: the number of the feed.
            topic: the topic of the speed.
            velocity: the speed.
            expires: the monotonic time at which zero is due after it.
            adverts: the adverts of the topic.

        Raises:
            NotConnectedYetError: the guard has not started, or not reached the robot.
            NoAnswerError: the guard does not answer.
            FeedError, TimeoutError, ConnectionError: as `Middleware.publish`.
        """
        answer, number = _Answer(), next(self._numbers)
        there = [[advert.name, advert.type, advert.offered, advert.wanted] for advert in adverts]
        with self._lock:
            if not self._is_ready:
                raise NotConnectedYetError(self.down)
            moved = feed in self._moving
            if velocity == ZERO:
                frame = packed("zero", feed, number, topic, there)
            else:
                sent_at = _CLOCK.now() + _CLOCK.slept()
                frame = packed("drive", feed, number, topic, list(velocity), expires, sent_at, self._known_stops, there)
                self._moving.add(feed)
            self._answers[number] = answer
            self._write(frame)
            self._await(answer)
            del self._answers[number]
            if not answer.is_there:
                self._hangs = True
                self._hang_up()
                raise NoAnswerError(f"the guard that sends speeds has not answered for {ANSWER:g} s")
            if answer.error is None:
                if velocity == ZERO:
                    self._moving.discard(feed)
                return answer.sent
            if isinstance(answer.error, FeedError) and not moved:  # it was not sent
                self._moving.discard(feed)
            raise answer.error

    def tell_others(self, feed: int, topic: str, velocity: Velocity) -> None:
        """Report to the other feeds what a feed has sent. They ignore what a guard publishes on the network."""
        for number, call in list(self.on_sent.items()):
            if number != feed:
                call(topic, velocity)

    def is_driven_beside(self, feed: int) -> bool:
        """Return True if another feed of this process drives the robot now."""
        return bool(self._moving - {feed})

    def listen(self, guard: socket.socket, *first: Any, ready_timeout: float = float("inf")) -> None:
        """Read the messages of a guard, and report that the kernel is alive, until the guard hangs up.

        Args:
            guard: the socket.
            first: the name of the first message to the guard, and its parts.
            ready_timeout: seconds within which the guard must report that it is ready.
        """
        guard.setblocking(False)
        with self._lock:
            self._socket, self._hangs, self._known_stops = guard, self._is_closed, 0
            self._write(packed(*first))
            if self._is_closed:
                self._hang_up()
        reason = ENDED
        try:
            with suppress(OSError):  # the guard ended before it had read everything
                if not self._hear(guard, time.monotonic() + ready_timeout):
                    reason, self._hangs = f"it is not ready after {ready_timeout:g} s", True
        except DamagedError as error:
            reason = f"the guard that sends speeds sent an invalid message: {error}"
            self._hangs = True
        self._hear_no_more(reason)

    def hurry(self) -> None:
        """Make the guard connect now, because the robot can be reached again."""
        with self._lock:
            if self._is_ready and not self._is_up:
                self._write(packed("again"))

    def forget(self, feed: int) -> None:
        """Send nothing more for a feed."""
        with self._lock:
            self._moving.discard(feed)
            self.on_unheard.pop(feed, None)
            self.on_sent.pop(feed, None)
            if self._is_ready:
                self._write(packed("close", feed))

    def close(self) -> None:
        """Make the guard send zero and end."""
        with self._lock:
            self._is_closed = True
            self._hang_up()
            self._changed.notify_all()

    def leave(self) -> None:
        """Leave the guard to the parent of this forked process, whose thread may have held the lock."""
        self._lock = threading.RLock()
        self._changed = threading.Condition(self._lock)
        self._is_closed = True
        if self._socket is not None:
            self._socket.close()

    # -- within --------------------------------------------------------------------------------------------------------

    def _await(self, answer: _Answer) -> None:
        """Wait for an answer while the guard is at work. Called with the lock held."""
        waited, at, slow = 0.0, time.monotonic(), self._slow
        while not answer.is_there and waited < ANSWER:
            if not self._changed.wait(LOOK):
                self._beat()  # once the robot moves, the thread that reads the guard's messages sends beats
            # If a check comes late, this process stood still, and the answer may be waiting in the socket.
            waited, at = waited + min(time.monotonic() - at, 2 * LOOK), time.monotonic()
            if slow != self._slow:
                waited, slow = 0.0, self._slow

    def _hear_no_more(self, reason: str) -> None:
        with self._lock:
            self._socket, self._is_ready, self._is_up, self.down = None, False, False, reason
            self._moving.clear()
            for answer in self._answers.values():
                answer.is_there, answer.error = True, ConnectionError(reason)
            self._changed.notify_all()
        if not self._is_closed:
            self.ends += 1
            self._call_observers()

    def _hear(self, guard: socket.socket, ready_by: float) -> bool:
        """Read the messages of a guard until it hangs up. Return False if it is not ready in time."""
        frames, poll = Unpacker(FROM_GUARD), select.poll()
        poll.register(guard, select.POLLIN)
        while True:
            ready = poll.poll(1000 * (BEAT if self._moving else 1.0))
            if self._moving:
                self._beat()
            if not ready:
                if not self._has_been_ready and time.monotonic() > ready_by:
                    return False
                continue
            data = guard.recv(1 << 16)
            if not data:
                return True
            for name, parts in frames.take(data):
                getattr(self, f"_on_{name}")(*parts)

    def _beat(self) -> None:
        with self._lock:
            now, worked = time.monotonic(), time.process_time()
            if now - self._beat_at > 4 * BEAT:
                self._share = (worked - self._worked) / (now - self._beat_at)
            self._beat_at, self._worked = now, worked
            self._write(packed("beat"))

    def _write(self, frame: bytes) -> None:
        """Send a message without waiting: a guard that does not read is ended. Called with the lock held."""
        try:
            if self._socket is not None and self._socket.send(frame) != len(frame):
                raise BlockingIOError
        except OSError:
            self._hang_up()

    def _hang_up(self) -> None:
        if self._socket is not None:
            with suppress(OSError):
                self._socket.shutdown(socket.SHUT_RDWR)

    def _say(self, write: Callable[[str], object], text: str) -> None:
        """Log a line from another thread, because a log may hang and this thread sends the signs of life."""
        call_in_thread(partial(write, f"{self._where}: {text}"))

    def _on_ready(self) -> None:
        with self._lock:
            self._is_ready = self._has_been_ready = True
            self.down = "the guard that sends speeds has not reached the robot yet"

    def _on_failed(self, reason: str) -> None:
        self.unavailable = f"its process cannot reach the robot: {reason}"
        self.close()

    def _on_up(self) -> None:
        self.up_at = time.monotonic()
        self._is_up, self._is_starting, self.down = True, False, ""
        self._call_observers()

    def _on_down(self, reason: str, again_in: float) -> None:
        self._is_up = self._is_starting = False
        self.down = f"the guard that sends speeds cannot reach the robot, trying again in {again_in:.2g} s: {reason}"
        self._call_observers()

    def _on_unheard(self, topic: str, reason: str) -> None:
        for call in list(self.on_unheard.values()):
            call(topic, reason)

    def _on_slow(self) -> None:
        with self._lock:
            self._slow += 1
            self._changed.notify_all()

    def _on_done(self, _feed: int, number: int, kind: str, text: str, refused: str, moved: list[str]) -> None:
        with self._lock:
            answer = self._answers.get(number)
            if answer is not None:
                answer.error = _ERRORS.get(kind, ConnectionError)(text) if kind else None
                answer.sent, answer.is_there = Sent(refused, moved), True
                self._changed.notify_all()

    def _on_stopped(self, stops: int, seconds: float, stood: str) -> None:
        if stood:
            self.told = f"{stood}: the robot was stopped after it"
        else:
            why = "code held the interpreter lock (GIL)" if self._share > WORKS else "its process stood still"
            self.told = (
                f"the kernel was silent for {seconds:.1f} s, because {why}: the guard stopped the robot meanwhile"
            )
        self._known_stops = stops
        self.stops += 1
        self._say(log.warning, self.told)
        self._call_observers()


@runtime_checkable
class HasGuard(Protocol):
    """A middleware that sends by a guard."""

    guard: GuardLink | None
    """The guard, or None if this middleware has none."""


_links: WeakSet[GuardLink] = WeakSet()


def _leave_all() -> None:
    for link in list(_links):
        link.leave()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_leave_all)

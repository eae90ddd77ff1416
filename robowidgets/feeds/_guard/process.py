"""The process of a guard. It runs no code of a user, and imports neither Jupyter nor widgets.

`robowidgets.feeds._guard.guard` starts it. It sends zero and ends by itself when the kernel is gone.
"""

from __future__ import annotations

import faulthandler
import os
import select
import signal
import socket
import sys
import threading
import traceback
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from typing import Any

from ...driving.command_watchdog import HOLD, CommandWatchdog, Request, Velocity
from ...runtime.clock import Clock, RealClock
from .._ros2_common import ALONE
from .._threaded import ThreadedMiddleware
from .._twist import TwistPublisher
from ..middleware import Advert, FeedError, Listener, Middleware, NotConnectedYetError
from .frames import TO_GUARD, DamagedError, Unpacker, packed
from .mark import SERVER_ENDED

SILENCE = HOLD
"""Seconds without a message of the kernel after which zero is sent while the robot moves."""

GRACE = 0.03
"""Seconds by which a speed is valid longer here than in the kernel, so that a healthy kernel sends zero first."""

DISCOVERY = ALONE + 0.6
"""Seconds after the start in which a subscriber that the kernel knows may not have been discovered yet."""

LAST_ZERO = 10.0
"""Seconds for which it tries to send zero after the kernel is gone."""

SLOW = 0.05
"""Seconds after which a slow message is reported to the kernel, so that it waits for the next one, too."""

ALIVE = 1.0
"""Seconds between two checks if the kernel is alive."""

MIDDLEWARES = {
    "dds": ("dds", "Dds"),
    "foxglove": ("foxglove", "Foxglove"),
    "ros1": ("ros1", "Ros1"),
    "ros2": ("ros2", "Ros2"),
    "rosbridge": ("rosbridge", "Rosbridge"),
    "zenoh": ("zenoh", "Zenoh"),
}
"""The module in ``feeds`` and the class of each middleware that a guard can publish by."""

Tell = Callable[..., None]
"""A function that sends the kernel a message: its name and its parts."""

MakeMiddleware = Callable[[str, dict[str, Any]], Middleware]


class Guarding:
    """The reactions of a guard to the messages of its kernel. It is the listener of its middleware.

    Args:
        tell: sends the kernel a message; any thread may call it.
        clock: the clock.
        make: makes a middleware from its name in `MIDDLEWARES` and its arguments.
    """

    def __init__(self, tell: Tell, clock: Clock, make: MakeMiddleware | None = None) -> None:
        self._tell, self._clock, self._make = tell, clock, make or _made
        self._middleware: Middleware | None = None
        self._publishing = threading.Lock()
        """Held while the middleware publishes: only one thread at a time may."""
        self._feeds: dict[int, _Feed] = {}
        self._ending: list[_Feed] = []
        """The closed feeds whose robot has not received its zero yet."""
        self._heard_at = clock.now()
        self._stops = self._standstills = 0
        self._silent_since: float | None = None
        self._up_at: float | None = None
        """The time at which the robot was reached for the first time."""
        self._wanted: frozenset[str] = frozenset()
        """The topics that have a subscriber, as the middleware reports them."""

    def take(self, name: str, parts: Sequence[Any]) -> None:
        """Handle a message of the kernel.

        Raises:
            DamagedError: a part of it is invalid.
        """
        self._find_standstill()
        now = self._clock.now()
        if self._silent_since is not None:
            self._tell("stopped", self._stops, now - self._silent_since, "")
            self._silent_since = None
        self._heard_at = now
        if name == "open":
            self._open(*parts)
        elif name == "drive":
            self._drive(*parts)
        elif name == "zero":
            self._zero(*parts)
        elif name == "again" and isinstance(self._middleware, ThreadedMiddleware):
            self._middleware.retry()
        elif name == "close":
            self._close(*parts)

    def look(self) -> float:
        """Send zero after a standstill of this process or the kernel. Return the seconds until the next check.

        A kernel sends signs of life only while it drives.
        """
        self._find_standstill()
        if self._silent_since is not None or not any(feed.is_driven for feed in self._all):
            return ALIVE
        left = self._heard_at + SILENCE - self._clock.now()
        if left > 0:
            return left
        self._silent_since = self._heard_at
        self._stops += 1
        for feed in self._all:
            feed.watchdog.stop()
        return ALIVE

    def _find_standstill(self) -> None:
        """Detect a standstill of this process, and refuse what the kernel requested before it."""
        found = [(feed.watchdog.look(), feed.watchdog.stood) for feed in self._all]
        standstills, before = sum(count for count, _ in found), self._standstills
        self._standstills = standstills
        if standstills > before:
            self._stops += 1
            self._heard_at, self._silent_since = self._clock.now(), None
            for feed in self._all:
                feed.watchdog.stop()
            stood = next(stood for _, stood in found if stood)
            self._tell("stopped", self._stops, 0.0, stood.replace("this process", "the guard"))

    def finish(self) -> None:
        """Send zero for every feed that moves, and try again for a while; then disconnect."""
        until = self._clock.now() + LAST_ZERO
        there = self._all
        for feed in there:
            if feed.watchdog.owes_zero:
                feed.watchdog.stop()
        while any(feed.watchdog.owes_zero for feed in there) and self._clock.now() < until:
            self._clock.sleep(0.01)
        if self._middleware is not None:
            self._middleware.close()

    # -- as the listener of the middleware -----------------------------------------------------------------------------

    def on_connected(self) -> None:
        """See `Listener`."""
        if self._up_at is None:
            self._up_at = self._clock.now()
        self._tell("up")
        for feed in self._all:
            feed.on_connected()

    def on_lost(self, reason: str, again_in: float) -> None:
        """See `Listener`."""
        self._tell("down", reason, again_in)
        for feed in self._all:
            feed.watchdog.on_lost()

    def on_nobody(self, reason: str) -> None:
        """See `Listener`. The kernel gets the report from its own middleware."""

    def on_topics(self, topics: Sequence[Advert]) -> None:
        """See `Listener`."""
        self._wanted = frozenset(advert.name for advert in topics if advert.wanted)

    def on_message(
        self, topic: str, message: Any, *, newest: bool = True, each: bool = True, replaced: int = 0
    ) -> None:
        """See `Listener`. A guard follows no topic."""

    def on_missed(self, topic: str, count: int) -> None:
        """See `Listener`."""

    def on_trouble(self, topic: str, reason: str) -> None:
        """See `Listener`."""

    def on_unheard(self, topic: str, reason: str) -> None:
        """See `Listener`."""
        self._tell("unheard", topic, reason)

    # -- as the middleware of its feeds --------------------------------------------------------------------------------

    def publish(self, topic: str, message_type: str, message: Any) -> None:
        """See `Middleware`."""
        if self._middleware is None or self._up_at is None:
            raise NotConnectedYetError("the guard that sends speeds has not reached the robot yet")
        with self._publishing:
            began = self._clock.now()
            try:
                self._middleware.publish(topic, message_type, message)
            finally:
                if self._clock.now() - began > SLOW:
                    self._tell("slow")

    def why_too_early(self, topic: str, adverts: Sequence[Advert]) -> str:
        """Return the reason why a subscriber that the kernel knows would miss a speed, or empty if none would."""
        is_wanted = any(advert.wanted for advert in adverts)
        if is_wanted and topic not in self._wanted and self._clock.now() < (self._up_at or 0.0) + DISCOVERY:
            return f"the guard that sends speeds has not discovered the subscriber of {topic} yet"
        return ""

    # -- within --------------------------------------------------------------------------------------------------------

    def _open(self, kind: str, arguments: dict[str, Any]) -> None:
        if self._middleware is not None:
            raise DamagedError("a second middleware was opened")
        try:
            self._middleware = self._make(kind, arguments)
            self._middleware.open(self)
        except FeedError as error:
            self._tell("failed", str(error))
        else:
            self._tell("ready")

    @property
    def _all(self) -> list[_Feed]:
        """The feeds whose robot may need a zero, including closed ones."""
        return [*self._feeds.values(), *self._ending]

    def _close(self, number: int) -> None:
        """Forget a feed, but not the zero that it owes."""
        self._ending = [feed for feed in self._ending if feed.moves]
        feed = self._feeds.get(number)
        if feed is None:
            return
        feed.end()
        if feed.moves:
            feed.watchdog.stop()
            self._ending.append(feed)
        del self._feeds[number]

    def _feed(self, number: int) -> _Feed:
        return self._feeds.setdefault(number, _Feed(number, self, self._tell, self._clock))

    def _drive(
        self,
        feed: int,
        number: int,
        topic: str,
        speed: list[Any],
        expires: float,
        sent_at: float,
        stops: int,
        adverts: list[Any],
    ) -> None:
        velocity, there, left = _velocity(speed), _adverts(adverts), expires - self._clock.now()
        is_old = self._clock.now() + self._clock.slept() - sent_at > SILENCE  # it waited during a standstill
        why = self.why_too_early(topic, there)
        if stops != self._stops:
            self._tell("done", feed, number, "FeedError", "the guard has stopped the robot meanwhile", "", [])
        elif left <= 0 or is_old:
            self._tell("done", feed, number, "FeedError", "the speed came too late", "", [])
        elif why:
            self._tell("done", feed, number, "NotConnectedYetError", why, "", [])
        else:
            self._feed(feed).drive(number, topic, there, velocity, left + GRACE)

    def _zero(self, feed: int, number: int, topic: str, adverts: list[Any]) -> None:
        self._feed(feed).zero(number, topic, _adverts(adverts))


def _made(kind: str, arguments: dict[str, Any]) -> Middleware:
    if kind not in MIDDLEWARES:
        raise DamagedError(f"{kind!r:.80} cannot be opened")
    module, name = MIDDLEWARES[kind]
    made: Middleware = getattr(import_module(f"robowidgets.feeds.{module}"), name)(**arguments)
    return made


class _Feed:
    """The speeds of one feed of the kernel: a watchdog, and the publisher that it uses."""

    def __init__(self, number: int, guarding: Guarding, tell: Tell, clock: Clock) -> None:
        self._number, self._tell, self._clock = number, tell, clock
        self._topic = ""
        self._adverts: dict[str, Sequence[Advert]] = {}
        self._asked: list[tuple[int, Request]] = []
        self._answering = threading.Lock()
        self._twists = TwistPublisher(guarding, clock)
        # The kernel refuses speeds based on data from before a standstill. Here only earlier requests are old.
        self.watchdog = CommandWatchdog(self._send, not_sent=FeedError, clock=clock, settle=0.0)
        self.watchdog.observe(self._answer)

    @property
    def moves(self) -> bool:
        """True while a speed other than zero was sent, or may have been, without a zero since."""
        return self.watchdog.owes_zero

    @property
    def is_driven(self) -> bool:
        """True while a speed is valid. A zero that could not be sent is sent again without the kernel."""
        return self.moves and self.watchdog.expires > self._clock.now()

    def drive(self, number: int, topic: str, adverts: Sequence[Advert], velocity: Velocity, hold: float) -> None:
        """Send a speed, and report when it is done."""
        self._topic, self._adverts[topic] = topic, adverts
        self._await(number, self.watchdog.drive(velocity, hold))

    def zero(self, number: int, topic: str, adverts: Sequence[Advert]) -> None:
        """Send zero, and report when it is done."""
        self._topic, self._adverts[topic] = topic, adverts
        self._await(number, self.watchdog.stop())

    def on_connected(self) -> None:
        """Send the overdue zeros."""
        self._twists.on_connected()
        self.watchdog.on_connected()

    def end(self) -> None:
        """Report nothing any more."""
        self.watchdog.unobserve(self._answer)

    def _send(self, linear: float, angular: float, lateral: float) -> None:
        """The sink of the watchdog, in its thread."""
        there = [advert for adverts in list(self._adverts.values()) for advert in adverts]
        self._twists.send(self._topic, Velocity(linear, angular, lateral), there)

    def _await(self, number: int, request: Request) -> None:
        with self._answering:
            self._asked.append((number, request))
        self._answer()

    def _answer(self) -> None:
        """Report to the kernel which of its requests are done. The watchdog calls it after each speed."""
        with self._answering:
            done = [(number, request.error) for number, request in self._asked if request.done]
            self._asked = [(number, request) for number, request in self._asked if not request.done]
        for number, error in done:
            kind = "" if error is None else _kind_of(error)
            text, moved = "" if error is None else str(error) or type(error).__name__, self._twists.moved(self._topic)
            self._tell("done", self._number, number, kind, text, self._twists.refused, moved)


def _kind_of(error: BaseException) -> str:
    """Return the class of an error of a sink, in the form in which the kernel raises it again."""
    kinds = (NotConnectedYetError, FeedError, TimeoutError)
    return next((kind.__name__ for kind in kinds if isinstance(error, kind)), ConnectionError.__name__)


def _velocity(speed: list[Any]) -> Velocity:
    if len(speed) != 3 or not all(isinstance(part, (int, float)) for part in speed):
        raise DamagedError(f"not a speed: {speed!r:.80}")
    return Velocity(*map(float, speed))


def _adverts(given: list[Any]) -> list[Advert]:
    try:
        return [Advert(str(name), str(kind), bool(offered), wanted) for name, kind, offered, wanted in given]
    except (TypeError, ValueError):
        raise DamagedError(f"not a list of topics: {given!r:.80}") from None


def serve(kernel: socket.socket, ends: Collection[Any], make: MakeMiddleware | None = None) -> None:
    """Guard until the kernel is gone or sends an invalid message, or until another source asks for the end; send zero.

    Args:
        kernel: the connection to the kernel, a non-blocking socket.
        ends: sockets and files, as `select` accepts them. The guard ends when any of them can be read.
        make: as for `Guarding`.
    """
    parent, writing = os.getppid(), threading.Lock()

    def tell(name: str, *parts: Any) -> None:
        try:
            with writing:
                kernel.sendall(packed(name, *parts))
        except OSError:  # the kernel does not read any more; nothing may wait for it
            with suppress(OSError):
                kernel.shutdown(socket.SHUT_RDWR)

    guarding, frames = Guarding(tell, RealClock(), make), Unpacker(TO_GUARD)
    try:
        while os.getppid() == parent:
            ready, _, _ = select.select([kernel, *ends], (), (), guarding.look())
            if any(one is not kernel for one in ready):
                break
            if kernel in ready:
                data = kernel.recv(1 << 16)
                if not data:
                    break
                for name, parts in frames.take(data):
                    guarding.take(name, parts)
    except OSError:
        pass  # the kernel is gone
    finally:  # also after an invalid message
        guarding.finish()


class _Robot:
    """A simulated robot in this process, as a `Middleware`."""

    where = "the simulated robot"

    def __init__(self, drive: Callable[[float, float, float], object]) -> None:
        self._drive = drive

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        listener.on_connected()

    def follow(self, topics: frozenset[str], each: frozenset[str] = frozenset()) -> None:
        """See `Middleware`."""

    def ask_for_nodes(self, wanted: bool) -> None:
        """See `Middleware`."""

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:  # noqa: ARG002
        """See `Middleware`."""
        self._drive(message["linear"]["x"], message["angular"]["z"], message["linear"]["y"])

    def close(self) -> None:
        """See `Middleware`."""


def guard_robot(kernel: socket.socket, drive: Callable[[float, float, float], object]) -> None:
    """Guard a simulated robot in its process, which runs no code of a user either and so needs no extra process."""
    kernel.setblocking(False)
    with kernel:
        serve(kernel, (), lambda *_: _Robot(drive))


def main(server: int = 0) -> None:
    """Run the process: standard input is the socket to the kernel.

    Args:
        server: the number of the process whose end ends the kernel, or 0. The kernel checks it once a second, but the
            robot must stop at once.
    """
    faulthandler.enable()
    ended, signalled = socket.socketpair()
    signalled.setblocking(False)
    signal.set_wakeup_fd(signalled.fileno(), warn_on_full_buffer=False)
    for number in (signal.SIGINT, signal.SIGHUP):  # the kernel may survive them
        signal.signal(number, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: None)  # the wakeup descriptor reports it to `serve`
    sys.setswitchinterval(0.0005)
    kernel = socket.socket(fileno=os.dup(0))
    kernel.setblocking(False)
    code = 1
    try:
        serve(kernel, [ended, *_end_of(server)])
        code = 0
    except BaseException as error:  # the kernel reports the text
        traceback.print_exc()
        code = SERVER_ENDED if isinstance(error, _ServerEndedError) else 1
    finally:
        sys.stderr.flush()
        os._exit(code)


class _ServerEndedError(RuntimeError):
    """The server that started the kernel has ended."""


def _end_of(server: int) -> list[int]:
    """Return a file that can be read when a process has ended, if the system supports such files; else nothing."""
    if not server or not hasattr(os, "pidfd_open"):
        return []
    try:
        end = os.pidfd_open(server)
        has_ended = bool(select.select([end], (), (), 0)[0])
    except ProcessLookupError:
        has_ended = True
    except OSError:  # the system forbids it
        return []
    if has_ended:
        raise _ServerEndedError("the server that started this kernel has ended, and so will the kernel")
    return [end]


if __name__ == "__main__":
    main()

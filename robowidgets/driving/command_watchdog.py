"""Sending speeds to a robot, and zero as soon as the newest speed is not renewed."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from ..notebook.cells import on_failed_cell
from ..runtime.clock import Clock, RealClock
from ..runtime.log_once import log_in_thread
from ..runtime.platform_fixes import run_beside_debugger
from ..runtime.user_threads import why_refused
from ..samples.staleness import TO_DRIVE_BY
from ..widget.observed import Observed
from .stop_all import SEND_TIMEOUT, running, stop_driven_by_cell

if TYPE_CHECKING:
    from ..samples import Speed


class Velocity(NamedTuple):
    """A speed in the plane (REP-103): m/s forward, rad/s counter-clockwise, and m/s to the left."""

    linear: float = 0.0
    angular: float = 0.0
    lateral: float = 0.0

    @property
    def as_speed(self) -> Speed:
        """The same speed as a sample."""
        from ..samples import Speed  # Imported lazily: a guard needs no samples and must start fast.

        return Speed((self.linear, self.lateral, 0.0), (0.0, 0.0, self.angular))


ZERO = Velocity()

HOLD = 0.5
"""Seconds for which a speed is valid unless it is renewed."""

MAX_LINEAR, MAX_ANGULAR = 0.5, 1.0
"""The default limits, in m/s and rad/s."""

LOOK = 0.1
"""Seconds between two checks of the clock while a robot moves."""

STANDSTILL = HOLD
"""If two checks are further apart than these seconds, or the computer slept longer, this process stood still."""

SETTLE = TO_DRIVE_BY.longest
"""Seconds after a standstill for which no speed is sent. After that, data from before it is too old to drive by."""

INTERVAL = 0.02
"""Shortest time between two speeds, in seconds; zero is sent at once."""

LINGER = 0.5
"""Seconds for which the thread waits for another speed after the last zero."""

RETRY = 1.0
"""Seconds after which a zero that could not be sent is sent again."""

RECENT = 30.0
"""The longest time for which a dead connection may go unnoticed, in seconds."""

_REAL = RealClock()

_USER = object()

PROGRAM = "program"
"""The driver if no press on a pad drives."""

ASSISTANT = "assistant"
"""The driver of a speed that a lease allows."""


class RefusedError(Exception):
    """A speed that is not sent, for example because a hand drives, or after a standstill. The text gives the reason."""


@dataclass(eq=False)
class Request:
    """A speed, or zero, that is to be sent.

    Attributes:
        done: True once it is sent or another request has replaced it.
        error: the reason why sending it failed, or None.
    """

    done: bool = False
    error: BaseException | None = None


@dataclass(frozen=True, eq=False)
class Lease:
    """The right of an assistant to drive by one command until a time, unless something stops the robot before.

    Attributes:
        ends: the time at which it ends.
        stops: the number of stops of the watchdog when the command was given.
    """

    ends: float
    stops: int


class CommandWatchdog(Observed):
    """A sender of speeds that runs in a thread: at most 50 a second, the newest one only, and zero at once.

    Zero follows a speed that is not renewed in time. The thread runs no code of a caller except the sink. It lives
    while a zero is owed, and for a moment after that, because a program that stands still sends zero at each step. Any
    thread may call any method; a method does not wait unless its docstring says so.

    While this process stands still, nothing can send zero. The process may be suspended, the computer may sleep, or
    code may hold the GIL. After a standstill, zero is sent, and speeds are refused for a while, because callers may
    base them on data from before the standstill.

    Args:
        send: the sink, a function of the three speeds of a `Velocity`.
        not_sent: the errors that mean that nothing reached the robot. After any other error, zero is due at once.
        settle: seconds after a standstill for which speeds are refused.
    """

    def __init__(
        self,
        send: Callable[[float, float, float], object],
        *,
        not_sent: type[Exception] | tuple[()] = (),
        clock: Clock = _REAL,
        settle: float = SETTLE,
    ) -> None:
        super().__init__()
        self._clock, self._settle = clock, settle
        self._send, self._not_sent = send, not_sent
        self._lock = threading.RLock()
        self._changed = clock.condition(self._lock)
        self._thread: threading.Thread | None = None
        self._wanted: Velocity | None = None
        """The newest speed, while it is not sent yet."""
        self._speeds: list[Request] = []
        self._zeros: list[Request] = []
        """The requests that are resolved when the next speed, or the next zero, is sent."""
        self._expires = 0.0
        """The time at which the newest speed expires."""
        self._zero_at: float | None = None
        """The time at which zero is due, or None while nothing moves."""
        self._next_speed_at = self._next_zero_at = 0.0
        self._moved_at = float("-inf")
        self._lost = self._closed = False
        self._latches: set[object] = set()
        """The owners of a latched stop. `_USER` stands for `stopped`."""
        self._hand, self._hand_until = "", 0.0
        self._driver = ""
        self._lease: Lease | None = None
        """The lease of the newest command of an assistant."""
        self._entered: float | None = None
        self._is_logged = False
        """True if the log shows that the newest zero could not be sent."""
        self._looked_at, self._slept = clock.now(), clock.slept()
        self._asked_at = self._settled_at = float("-inf")
        self.standstills = 0
        """Number of standstills of this process in which the robot may have moved."""
        self.stood = ""
        """Text for the last standstill, or empty before the first."""
        self.from_cell = False
        """True if a notebook cell drives, False if a thread does."""
        self.stops = 0
        """Number of requests for zero, by any caller."""
        self.sent: Velocity = ZERO
        """The speed that the sink accepted last."""
        self.error: BaseException | None = None
        """The error of the last call of the sink, or None if it accepted the speed."""
        self.failed: Velocity = ZERO
        """The last speed for which the sink raised an error."""

    # -- the driver ----------------------------------------------------------------------------------------------------

    @property
    def driver(self) -> str:
        """The driver: `PROGRAM`, `ASSISTANT`, the name of a press on a pad, or empty if nothing drives."""
        with self._lock:
            return self._hand_now() or (self._driver if self._clock.now() < self._expires else "")

    @property
    def lease_left(self) -> float:
        """Seconds for which an assistant may go on driving, or 0 if it does not drive."""
        with self._lock:
            lease = self._lease
            return lease.ends - self._clock.now() if lease is not None and self.driver == ASSISTANT else 0.0

    def lend(self, seconds: float, stops: int) -> Lease:
        """Allow an assistant to drive for some seconds, instead of its command before.

        Args:
            seconds: the duration.
            stops: the value of `stops` when the command was given.
        """
        with self._lock:
            self._lease = Lease(self._clock.now() + seconds, stops)
            return self._lease

    def end_lease(self, lease: Lease) -> bool:
        """End a lease, and send zero if its assistant drives. Return False if it had ended before."""
        with self._lock:
            if self._lease is not lease:
                return False
            self._lease = None
            if self._driver == ASSISTANT and self.owes_zero and not self._hand_now():
                self._ask_for_zero()
            return True

    @property
    def stopped(self) -> bool:
        """True while stop is latched: all speeds are refused until it is released. Setting it to True sends zero.

        Setting it to False releases every latch.
        """
        return bool(self._latches)

    @stopped.setter
    def stopped(self, stopped: bool) -> None:
        if stopped:
            self.latch(_USER)
        else:
            with self._lock:
                self._latches.clear()
            self._call_observers()

    def latch(self, owner: object) -> None:
        """Latch stop for an owner, and send zero. Other owners, such as the user on the page, keep their latches."""
        with self._lock:
            self.refuse(owner)
            self._ask_for_zero()
        self._call_observers()

    def refuse(self, owner: object) -> None:
        """Latch stop for an owner, and send zero only if one is owed."""
        with self._lock:
            self._latches.add(owner)
            self._lease = None
            self._hand = ""  # after the release, the user must press the pad again
            if self.owes_zero:
                self._ask_for_zero()

    def is_latched_by(self, owner: object) -> bool:
        """Return True if this owner has latched stop."""
        return owner in self._latches

    def release(self, owner: object) -> None:
        """Release the latch of one owner only."""
        with self._lock:
            self._latches.discard(owner)
        self._call_observers()

    def take(self, hand: str) -> None:
        """Give control to a press on a pad for as long as it is renewed, and stop the previous driver.

        Raises:
            RefusedError: stop is latched.
        """
        with self._lock:
            self._check(hand, taking=True)
            self._hand, self._hand_until, self._lease = hand, self._clock.now() + HOLD, None
            if self._zero_at is not None or self._wanted is not None:
                self._ask_for_zero()
        self._call_observers()

    def let_go(self, hand: str = "") -> None:
        """End this press, or any press, and send zero."""
        with self._lock:
            if not self._hand or hand not in ("", self._hand):
                return
            self._hand = ""
            self._ask_for_zero()
        self._call_observers()

    # -- speeds --------------------------------------------------------------------------------------------------------

    def drive(
        self,
        velocity: Velocity,
        hold: float = HOLD,
        driver: str = PROGRAM,
        stops: int | None = None,
        lease: Lease | None = None,
    ) -> Request:
        """Send a speed, or renew it.

        Args:
            velocity: the speed.
            hold: seconds for which it is valid; at most `HOLD` for the speed of a press.
            driver: `PROGRAM`, `ASSISTANT`, or the name of the press.
            stops: the value of `stops` when the caller began to wait with the speed, or None if it did not wait.
            lease: the lease of the speed of an assistant, which is valid until its end at most.

        Returns:
            The request for `sent_in_time`. It is done already if the speed is sent later because another one was sent
            just before.

        Raises:
            RefusedError: a hand drives. Or, except for the zero of a program: stop is latched, the calling thread is
                abandoned, this process stood still shortly before, or there was another stop since ``stops``. An
                assistant is also refused without its lease, while a program drives, and after a stop since its command.
        """
        if velocity == ZERO and driver == PROGRAM and not self._hand_now():
            with self._lock:
                self._look()
                self._asked_at = self._clock.now()
                return self._ask_for_zero()
        is_main = threading.current_thread() is threading.main_thread()
        if is_main:
            on_failed_cell(stop_driven_by_cell)
        with self._lock:
            self._look()
            self._asked_at = self._clock.now()
            self._check(driver)
            if driver == ASSISTANT:
                lease = self._checked_lease(lease)
                stops = lease.stops
            if stops not in (None, self.stops):
                raise RefusedError("another call or Stop has stopped the robot meanwhile")
            now = self._clock.now()
            self._wanted, self._expires, self._driver = velocity, now + hold, driver
            if lease is not None:
                self._expires, self.from_cell = min(self._expires, lease.ends), False
            elif driver == PROGRAM:
                self.from_cell, self._lease = is_main, None
            else:  # a page that is gone sends no release
                self._expires = self._hand_until = now + min(hold, HOLD)
            request = Request()
            if self._next_speed_at > now:
                request.done = True
            else:
                self._speeds.append(request)
            self._wake_sender()
        return request

    def stop(self) -> Request:
        """Send zero now, instead of any speed. Return the request for `sent_in_time`. A hand keeps its press."""
        with self._lock:
            return self._ask_for_zero()

    def stop_program(self) -> None:
        """Send zero now if a program drives or was the last driver."""
        with self._lock:
            if self.owes_zero and self.driver in ("", PROGRAM):
                self._ask_for_zero()

    def look(self) -> int:
        """Detect a standstill that ended just now, before the thread does. Return the number of `standstills`."""
        with self._lock:
            self._look()
            return self.standstills

    def note_standstill(self, stood: str) -> None:
        """Send zero and refuse speeds for a while, after a standstill that was detected elsewhere.

        Args:
            stood: text for the standstill.
        """
        with self._lock:
            self._stand(stood)

    @property
    def expires(self) -> float:
        """The time at which the newest speed expires, or 0 if zero has replaced it."""
        return self._expires

    @property
    def busy_for(self) -> float:
        """Seconds for which the sink has been running, or 0 if it is not running."""
        entered = self._entered
        return self._clock.now() - entered if entered is not None else 0.0

    @property
    def owes_zero(self) -> bool:
        """True while a zero must still be sent, now or after a speed, or while the sink is running."""
        return self._zero_at is not None or self._wanted is not None or bool(self._zeros) or self._entered is not None

    def on_lost(self) -> None:
        """Note a lost connection. A zero that was sent shortly before may not have arrived and is sent again."""
        with self._lock:
            self._lost = self._lost or self._clock.now() - self._moved_at < RECENT

    def on_connected(self) -> None:
        """Send the owed zero to a robot that can be reached again."""
        with self._lock:
            if self._wanted is None and (self._lost or self._zero_at is not None):
                self._ask_for_zero()
            self._lost = False

    def close(self, timeout: float = SEND_TIMEOUT) -> None:
        """Send zero if one is owed, wait until it is sent, and refuse every speed from now on.

        Raises:
            As `sent_in_time`, if zero could not be sent.
        """
        with self._lock:
            self._closed, self._wanted, self._hand = True, None, ""
            zero = self._ask_for_zero() if self.owes_zero else None
        try:
            if zero is not None:
                self.sent_in_time(zero, timeout)
        finally:
            with self._lock:
                self._zero_at = None
                self._changed.notify_all()

    def sent_in_time(self, request: Request, timeout: float = SEND_TIMEOUT) -> None:
        """Wait until a request of `drive` or `stop` is sent.

        Raises:
            TimeoutError: the sink does not return.
            BaseException: any error that the sink raised.
        """
        if threading.current_thread() is self._thread:
            return
        if not self.is_done_in_time(request, timeout):
            raise TimeoutError(f"the function that sends speeds has not returned for {self.busy_for:.1f} s")
        if request.error is not None:
            raise request.error

    def is_done_in_time(self, request: Request, timeout: float) -> bool:
        """Wait for at most some seconds until a request is done. Return True if it is."""
        with self._lock:
            until = self._clock.now() + timeout
            while not request.done and self._changed.wait_until(until):
                pass
            return request.done

    def on_fork(self) -> None:
        """Close in a forked process. The thread stayed in the parent process and may have held the lock."""
        self._lock = threading.RLock()
        self._changed = self._clock.condition(self._lock)
        self._thread = self._wanted = self._zero_at = self._entered = None
        self._speeds, self._zeros, self._closed = [], [], True

    # -- within --------------------------------------------------------------------------------------------------------

    def _hand_now(self) -> str:
        return self._hand if self._clock.now() < self._hand_until else ""

    def _check(self, driver: str, *, taking: bool = False) -> None:
        if self._closed:
            raise RefusedError("it is closed; open the feed or the pad again")
        if self._latches:
            raise RefusedError("Stop is pressed: press Allow driving on the page, or set stopped = False")
        if self._clock.now() < self._settled_at:
            raise RefusedError(
                f"{self.stood}, and the speed may be based on data from before that; drive again in {self._settle:g} s"
            )
        if driver == PROGRAM and (why := why_refused(self)):
            raise RefusedError(why)
        hand = self._hand_now()
        if driver != hand and not taking and (hand or driver not in (PROGRAM, ASSISTANT)):
            raise RefusedError(
                "a hand drives from a pad, until it is released"
                if hand
                else "the press on the pad is over; press again"
            )

    def _checked_lease(self, lease: Lease | None) -> Lease:
        """Return the lease of an assistant; RefusedError if it has ended, or if a program drives."""
        now = self._clock.now()
        if lease is None or lease is not self._lease or now >= lease.ends:
            raise RefusedError("the lease has ended; ask to drive again")
        if self._driver == PROGRAM and now < self._expires:
            raise RefusedError("a program drives; pause it first")
        return lease

    @property
    def _may_move(self) -> bool:
        return self._zero_at is not None or self._wanted is not None

    def _look(self) -> None:
        """Detect a standstill since the last check. Called with the lock held.

        The thread checks while the robot may move, except while the sink runs, which may take long.
        """
        now, slept = self._clock.now(), self._clock.slept()
        is_watched = self._thread is not None and self._may_move and self._entered is None
        gap = now - self._looked_at if is_watched else 0.0
        asleep = slept - self._slept
        self._looked_at, self._slept = now, slept
        if asleep > STANDSTILL and (self.owes_zero or now - self._asked_at < SETTLE):
            self._stand("the computer has slept")
        elif gap > STANDSTILL:
            self._stand(f"this process stood still for {gap:.1f} s")

    def _stand(self, stood: str) -> None:
        """Send zero and refuse speeds for a while. Called with the lock held."""
        self.stood, self._settled_at, self._hand = stood, self._clock.now() + self._settle, ""
        self._resolve_speeds(TimeoutError(stood))
        if self.owes_zero:
            self.standstills += 1
            self._ask_for_zero()
        else:
            self.stops += 1

    def _wake_sender(self) -> None:
        if self._thread is None:
            thread = threading.Thread(target=self._run, name="robowidgets-drive", daemon=True)
            run_beside_debugger(thread)
            self._clock.began(thread)
            running.add(self)
            self._thread = thread  # before the start, so that an interrupt handler does not start a second thread
            try:
                thread.start()
            except BaseException:
                if thread.ident is None:
                    self._thread = None
                    running.discard(self)
                raise
        self._changed.notify_all()

    def _ask_for_zero(self) -> Request:
        self._wanted, self._expires = None, 0.0
        self.stops += 1
        request = Request()
        self._zeros.append(request)
        self._wake_sender()
        return request

    def _run(self) -> None:
        while True:
            with self._lock:
                velocity, requests = self._next()
                if velocity is None:
                    return
                self._entered, stops = self._clock.now(), self.stops
            error = self._call(velocity)
            with self._lock:
                self._look()
                self._entered = None
                if velocity != ZERO and stops != self.stops and isinstance(error, self._not_sent):
                    error = None  # zero has replaced the speed in the meantime, so it did not have to be sent
                else:
                    self._note(velocity, error)
                self._resolve(requests, error)
            self._call_observers()

    def _next(self) -> tuple[Velocity | None, list[Request]]:
        """Wait until a speed or zero is due, and return it; or return None once nothing has been owed for a moment."""
        ends_at = self._clock.now() + LINGER
        while True:
            self._look()
            now = self._clock.now()
            if self._wanted is not None and now >= self._expires:  # it expired while the sink was busy
                self._wanted = None
                late = TimeoutError("sending the speed before took longer than this one holds, so it was not sent")
                self._resolve_speeds(late)
            elif self._wanted is None:  # zero replaced it
                self._resolve_speeds(None)
            moves = self._zero_at is not None
            if self._zeros and (moves or self._next_zero_at <= now):
                requests, self._zeros = self._zeros, []
                return ZERO, requests
            if self._zeros:
                due = self._next_zero_at
            elif self._wanted is not None:
                due = self._next_speed_at
            elif self._zero_at is not None:
                due = self._zero_at
            elif now < ends_at and not self._closed:
                due = ends_at
            else:
                self._thread = None
                running.discard(self)
                return None, []
            if due > now:
                self._changed.wait_until(min(due, now + LOOK) if self._may_move else due)
                continue
            velocity, self._wanted = self._wanted or ZERO, None
            requests, self._speeds = self._speeds, []
            return velocity, requests

    def _resolve_speeds(self, error: BaseException | None) -> None:
        requests, self._speeds = self._speeds, []
        self._resolve(requests, error)

    def _resolve(self, requests: list[Request], error: BaseException | None) -> None:
        for request in requests:
            request.done, request.error = True, error
        self._changed.notify_all()

    def _call(self, velocity: Velocity) -> BaseException | None:
        try:
            self._send(*velocity)
        except BaseException as error:  # even a SystemExit of the sink must not end the thread
            return error
        return None

    def _note(self, velocity: Velocity, error: BaseException | None) -> None:
        """Record the outcome of a call, and set the time at which zero is due. Called with the lock held."""
        now = self._clock.now()
        self.error = error
        if error is not None:
            self.failed = velocity
        else:
            self.sent = velocity
        if velocity == ZERO:
            self._next_zero_at = now + INTERVAL
            self._zero_at = now + RETRY if error is not None and not self._closed else None
            if error is None:
                self._is_logged = False
            elif not self._is_logged:
                self._is_logged = True
                log_in_thread(f"sending zero to the robot failed: {error}")
        elif error is None:
            self._moved_at, self._zero_at, self._next_speed_at = now, self._expires, now + INTERVAL
        elif not isinstance(error, self._not_sent):  # the speed may have reached the robot, or may still reach it
            self._moved_at, self._zero_at = now, 0.0

"""Driving a robot by the commands of an assistant: within limits of the user, each for a few seconds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..behaviors.program import ENDED
from ..driving.command_watchdog import ASSISTANT, PROGRAM, ZERO, Lease, Velocity
from ..feeds import Feed, FeedError
from ..runtime.clock import Threads, Ticket
from ..samples.checks import finite
from .answer import AnswerError, ToolAnswer, from_robot, name, number, seconds

MAX_LINEAR, MAX_ANGULAR = 0.2, 0.5
"""The default limits of an assistant, in m/s and rad/s."""

LEASE_S = 5.0
"""The default seconds for which one command is valid at most."""

LONGEST_LEASE_S = 30.0

RENEWAL_PERIOD_S = 0.2
"""Seconds between two renewals of a speed, or a third of the hold of the feed if that is shorter."""


_DRIVERS = {ASSISTANT: "you", PROGRAM: "a program or a cell", "": "nobody"}


@dataclass(frozen=True)
class DriveLimits:
    """The limits of an assistant that may drive.

    Args:
        max_linear: m/s, forward and backward; greater speeds are cut.
        max_angular: rad/s, both ways; greater speeds are cut.
        lease: seconds for which one command is valid at most; then the robot stops unless the assistant asks again.

    Raises:
        TypeError, ValueError: a limit is not a number above 0, or the lease is longer than 30 s.
    """

    max_linear: float = MAX_LINEAR
    max_angular: float = MAX_ANGULAR
    lease: float = LEASE_S

    def __post_init__(self) -> None:
        for limit, unit in (("max_linear", "m/s"), ("max_angular", "rad/s"), ("lease", "seconds")):
            if finite(limit, getattr(self, limit), unit) <= 0:
                raise ValueError(f"{limit}: expected {unit} above 0, got {getattr(self, limit)!r}")
        if self.lease > LONGEST_LEASE_S:
            raise ValueError(f"lease: expected at most {LONGEST_LEASE_S:g} s, got {self.lease!r}")


class Hand:
    """The hand of an assistant on the robot of a feed.

    A command drives for its seconds, and its speed is renewed here meanwhile. Stop, a pad, a program or a cell of the
    user, the end of the connection, and the end of its time end it, with zero; only another command drives again.

    Args:
        feed: the feed.
        limits: the limits.
    """

    def __init__(self, feed: Feed, limits: DriveLimits) -> None:
        self._feed, self.limits = feed, limits
        self._driver, self._watchdog, self._programs = feed.driver, feed.watchdog, feed.programs
        self._clock = feed.connection.clock
        self._held: tuple[Velocity, Lease] | None = None
        self._last_end = ""
        self._renewer: Ticket | None = None
        self._is_closed = False

    def drive(
        self, linear: float, angular: float, duration: float, check: Callable[[], object] = lambda: None
    ) -> ToolAnswer:
        """Drive for some seconds, cut to the limits.

        Args:
            linear: m/s, forward.
            angular: rad/s, counter-clockwise.
            duration: seconds.
            check: raises an error if the command was cancelled while it waited for the robot. Nothing is sent then.

        Raises:
            AnswerError: the duration is too long. FeedError: the robot cannot be driven now. Nothing is sent then.
            TypeError, ValueError: an argument is not a finite number.
        """
        limits = self.limits
        asked = Velocity(finite("linear", linear, "m/s"), finite("angular", angular, "rad/s"))
        if not 0 < finite("seconds", duration, "seconds") <= limits.lease:
            raise AnswerError(
                f"seconds: expected above 0 and at most {limits.lease:g}, the lease that the user set, got "
                f"{duration:g}; nothing was sent"
            )
        if asked == ZERO:
            return self.stop()
        driving = self._feed.driving
        wanted = Velocity(
            _cut(asked.linear, min(limits.max_linear, driving.max_linear)),
            _cut(asked.angular, min(limits.max_angular, driving.max_angular)),
        )
        program = self._programs.current
        if self._is_closed:
            raise AnswerError("the server is closed; nothing was sent")
        if program is not None and program.mode != ENDED:
            raise FeedError(f"the program {program.name} of the user drives alone; nothing was sent")
        try:
            lease = self._driver.drive_by_assistant(wanted, duration, check)
        except FeedError as error:
            raise FeedError(f"{error}; nothing was sent") from None
        self._held = wanted, lease
        if self._is_closed:  # while the command waited for the robot
            self.close()
            raise AnswerError("the server is closed; zero is sent")
        self._programs.report(f"an assistant drives: {_text(wanted)}, for {duration:g} s")
        if self._renewer is None:
            self._renewer = Threads(self._clock).start(self._renew, "robowidgets-assistant")
        else:
            self._renewer.wake()
        cut = [
            f"{value:g} {unit} was cut to {sent:g}"
            for value, sent, unit in ((asked.linear, wanted.linear, "m/s"), (asked.angular, wanted.angular, "rad/s"))
            if value != sent
        ]
        data = {
            "sent": {"linear_m_s": wanted.linear, "angular_rad_s": wanted.angular, "seconds": duration},
            "not_sent": cut,
            **self._state(),
        }
        said = f"Driving {_text(wanted)} for {duration:g} s, then zero unless you ask again."
        return ToolAnswer(" ".join([said, *(f"{one}." for one in cut)]), data)

    def stop(self) -> ToolAnswer:
        """Send zero now.

        Raises:
            FeedError: zero was not sent.
        """
        held, self._held = self._held, None
        if held is not None:
            self._watchdog.end_lease(held[1])
            self._end("it stopped by itself")
        self._feed.stop()
        return ToolAnswer("Zero was sent.", self._state())

    def status(self) -> ToolAnswer:
        """Return the limits, the driver, the last speed that was sent, and why the last command ended."""
        state = self._state()
        left = state["seconds_left"]
        said = f"You drive for {left:.1f} s more." if left else "You do not drive."
        return ToolAnswer(f"{said}{' Stop is latched by the user.' if state['stopped'] else ''}", state)

    def close(self) -> None:
        """Stop the robot if the assistant drives it, and refuse every later command."""
        self._is_closed = True
        held, self._held = self._held, None
        if held is not None and self._watchdog.end_lease(held[1]):
            self._end("its server was closed")
        if self._renewer is not None:
            self._renewer.detach()

    def _state(self) -> dict[str, Any]:
        watchdog, limits, sent, driver = self._watchdog, self.limits, self._watchdog.sent, self._watchdog.driver
        return {
            "limits": {
                "max_linear_m_s": limits.max_linear,
                "max_angular_rad_s": limits.max_angular,
                "lease_s": limits.lease,
            },
            "driver": _DRIVERS.get(driver, "a hand"),
            "seconds_left": seconds(watchdog.lease_left),
            "last_sent": {"linear_m_s": number(sent.linear), "angular_rad_s": number(sent.angular)},
            "stopped": watchdog.stopped,
            "topic": name(self._driver.topic),
            "warnings": from_robot(self._feed.drive_status) if self._feed.drive_status else "",
            "last_end": from_robot(self._last_end) if self._last_end else "",
        }  # fmt: skip

    def _renew(self) -> float | None:
        """Renew the speed, and return the time of the next renewal, or None if nothing is driven."""
        held = self._held
        if held is None:
            return None
        wanted, lease = held
        now = self._clock.now()
        why = "its time is over" if now >= lease.ends else self._driver.renew(wanted, lease)
        if not why:
            return min(lease.ends, now + min(RENEWAL_PERIOD_S, self._feed.driving.hold / 3))
        if self._held is held:
            self._held = None
            self._watchdog.end_lease(lease)
            self._end(why.removeprefix("cannot drive: "))
        return None if self._held is None else self._clock.now()

    def _end(self, why: str) -> None:
        self._last_end = why
        self._programs.report(f"an assistant does not drive any more: {why}")


def _cut(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _text(velocity: Velocity) -> str:
    return f"{velocity.linear:.2f} m/s, {velocity.angular:.2f} rad/s"

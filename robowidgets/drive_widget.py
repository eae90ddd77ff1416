"""The drive pad, which drives a robot from the notebook."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from numbers import Real
from typing import Any

import traitlets

from ._core.front_end import bundle
from ._core.limit_traits import LARGEST
from ._core.traits import Flag
from .driving.command_watchdog import HOLD, PROGRAM, ZERO, CommandWatchdog
from .driving.driving_widget import DrivingWidget
from .driving.press import PadMessage, PressLease
from .samples import Speed


class _Limit(traitlets.TraitType[Any, Any]):
    """A finite number above 0, in a unit."""

    def __init__(self, default: float, unit: str, **more: Any) -> None:
        super().__init__(default, **more)
        self.unit = unit

    def validate(self, _obj: Any, value: Any) -> float:
        """The limit as a float; TraitError says what is wrong with it."""
        is_number = isinstance(value, Real) and not isinstance(value, bool)
        if not is_number or not isfinite(value) or not 0 < value <= LARGEST:
            raise traitlets.TraitError(
                f"{self.name}: expected a number above 0 and at most {LARGEST:g}, in {self.unit}; got {value!r}"
            )
        return float(value)


class DriveWidget(DrivingWidget):
    """A pad that drives a robot: drag its knob, or press arrow keys or W, A, S, D while it has the focus.

    Up is forward and left turns to the left (REP-103: linear x and angular z above 0). The knob's place is a share of
    the limits; keys go to the limits. The pad shows the speed that was sent, its limits, and who drives.

    The pad stops the robot on release, when it loses the focus or the page is hidden, and when something raises. The
    robot moves only while the page and the kernel answer each other: half a second without an answer ends a press, on
    both sides, and no message that was delayed for longer moves the robot. After that the knob must be released and
    pressed anew. No program can stop a robot when its whole process hangs, so a robot should also stop by itself when
    no speed comes.

    The newest press of all pads on one feed drives it. While it is held, programs are refused. Stop is latched: all
    driving is refused until it is released, on the page or by ``stopped = False``.

    Args:
        send: a function of linear (m/s) and angular (rad/s) that drives the robot. A thread of the pad calls it, ten
            times a second while the pad is held, and with zero at the end.
        title: the name of the robot for the header; usually the topic.
        linear_limit: m/s at the edge of the pad, forward and backward.
        angular_limit: rad/s at the edge of the pad, both ways.
        enabled: whether the pad drives at all.
        header: whether the header is shown.

    Raises:
        TypeError: an unknown keyword; ``send`` is no function.
        traitlets.TraitError: a limit that is not a finite number above 0.

    Source: geometry_msgs/Twist, REP-103.

    Example:
        >>> from robowidgets.simulator import Robot, World
        >>> robot = Robot(World.rooms())
        >>> pad = DriveWidget(send=robot.drive, linear_limit=0.3)
        >>> pad.commanded.linear
        (0.0, 0.0, 0.0)
    """

    _esm, _css = bundle("drive_widget")
    _keywords = ("send",)
    _usual = "send=feed.drive"

    linear_limit = _Limit(0.5, "m/s", help="At the edge of the pad, m/s.").tag(sync=True)
    angular_limit = _Limit(1.0, "rad/s", help="At the edge of the pad, rad/s.").tag(sync=True)
    enabled = Flag(True, help="Whether the pad drives.").tag(sync=True)

    def __init__(self, *, send: Callable[[float, float], Any] | None = None, **kwargs: Any) -> None:
        if send is not None and not callable(send):
            raise TypeError(f"send: expected a function of linear and angular speed, got {send!r}")
        self._lease = PressLease()
        self._driving = ""
        """The press of this pad that drove the robot last."""
        super().__init__(**kwargs)
        if send is not None:
            self._attach(CommandWatchdog(send), owns=True)

    def connect(self, robot: Any) -> None:
        """Drive this robot from now on; the one that this pad drove until now is stopped.

        When a feed is closed, the pad shows it.

        Args:
            robot: a feed, or anything with ``drive(linear, angular)``. Its ``stop()`` is used where it has one.

        Raises:
            TypeError: it has no ``drive``.
        """
        watchdog = getattr(robot, "watchdog", None)
        if isinstance(watchdog, CommandWatchdog):
            self._attach(watchdog, robot)
        else:
            self._attach(CommandWatchdog(_sink_of(robot)), owns=True)
        self._title_after_feed()

    def send_newest(self) -> int:
        """See `DrivingWidget`. The feed may have chosen another topic."""
        self._title_after_feed()
        return super().send_newest()

    def disconnect(self) -> None:
        """Drive nothing any more; the robot that this pad drove is stopped."""
        self._detach()

    @property
    def commanded(self) -> Speed:
        """The speed that was sent last: linear x in m/s, angular z in rad/s."""
        linear, angular = self._watchdog.sent
        return Speed((linear, 0.0, 0.0), (0.0, 0.0, angular))

    def _title_after_feed(self) -> None:
        feed = self._feed
        if feed is not None:
            self._name_after(feed.driver.topic)

    def _on_press(self, message: PadMessage) -> None:
        press, over = message.press, self._why_not()
        token = None
        if message.act == "press" and not over:
            self._cause = self._driving = ""
            self._forget_errors()
            token = self._lease.take(press)
        elif message.act == "hold" and not over:
            token = self._lease.renew(press, message.token)
            over = self._lease.why_over(press) if token is None else self._drive(message)
        if message.act == "release":
            over = "released"
        if over and press == self._lease.press:
            self._end_press(over)
        self.send({"press": press, "over": over} if over else {"press": press, "token": token})

    def _why_not(self) -> str:
        """Why nothing can be driven, as a key for the page; empty when it can."""
        if not self._is_ready:
            return "nothing"
        if not self.enabled:
            return "disabled"
        if self.stopped:
            return "stopped"
        return "hangs" if self._watchdog.busy_for > HOLD else ""

    def _drive(self, message: PadMessage) -> str:
        """Send a speed of the press that holds the pad; returns why the press is over, empty when it is not.

        The first speed takes over the robot, not the press: the speed is fresh, but a press that was delayed by a busy
        kernel must not interrupt a program.
        """
        press, watchdog = message.press, self._watchdog
        linear, angular = message.forward * self.linear_limit, message.turn * self.angular_limit
        try:
            if self._driving != press:
                watchdog.take(press)
                self._driving = press
            if self._feed is not None:
                self._feed.driver.drive_by_hand(linear, angular, press)
            else:
                watchdog.drive((linear, angular), driver=press)
        except Exception as error:  # whatever the feed raises, the page must show it
            over = self._why_refused(press)
            if not over:
                self._fail(error)
            return over or "failed"
        return ""

    def _why_refused(self, press: str) -> str:
        """Why a press no longer drives, though nothing failed; empty when it does."""
        driver = self._watchdog.driver
        if self.stopped or driver == press:
            return "stopped" if self.stopped else ""
        return "taken" if driver not in ("", PROGRAM) else "late"

    def _end_press(self, why: str) -> None:
        press = self._lease.end(why)
        if press:
            self._watchdog.let_go(press)

    def _on_failed(self, failure: str, error: BaseException) -> None:
        if self._lease.press:
            self._cause = str(error) or type(error).__name__
            self._end_press("failed")
            self._log_once(failure)

    @traitlets.observe("enabled")
    def _after_enabled(self, _change: Any) -> None:
        if not self.enabled:
            self._end_press("disabled")


def _sink_of(robot: Any) -> Callable[[float, float], Any]:
    drive, stop = getattr(robot, "drive", None), getattr(robot, "stop", None)
    if not callable(drive):
        raise TypeError(
            f"connect(): expected a feed, or something with drive(linear, angular), got {robot!r}; "
            "a function goes to DriveWidget(send=...)"
        )
    return lambda *speed: stop() if callable(stop) and speed == ZERO else drive(*speed)

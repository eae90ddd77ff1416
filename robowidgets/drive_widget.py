"""The drive pad, which drives a robot from the notebook."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from math import isfinite
from numbers import Real
from typing import Any

import traitlets

from .driving.command_watchdog import ASSISTANT, HOLD, MAX_ANGULAR, MAX_LINEAR, PROGRAM, CommandWatchdog, Velocity
from .driving.driving_widget import DrivingWidget
from .driving.press import PadMessage, PressLease
from .samples import Speed
from .widget.front_end import bundle
from .widget.limit_traits import LARGEST
from .widget.pacer import pacer
from .widget.title_observers import TitleObservers
from .widget.traits import Flag


class _Limit(traitlets.TraitType[Any, Any]):
    """A finite number above 0, in a unit; or None, if that is the default."""

    def __init__(self, default: float | None, unit: str, **more: Any) -> None:
        super().__init__(default, allow_none=default is None, **more)
        self.unit = unit

    def validate(self, _obj: Any, value: Any) -> float:
        """Return the limit as a float. Raise TraitError for other values."""
        is_number = isinstance(value, Real) and not isinstance(value, bool)
        if not is_number or not isfinite(value) or not 0 < value <= LARGEST:
            raise traitlets.TraitError(
                f"{self.name}: expected a number above 0 and at most {LARGEST:g}, in {self.unit}; got {value!r}"
            )
        return float(value)


class DriveWidget(DrivingWidget):
    """A pad that drives a robot: drag its knob, or press arrow keys or W, A, S, D while it has the focus.

    Up is forward and left turns to the left (REP-103: linear x and angular z above 0). The position of the knob is a
    share of the limits; keys go to the limits. The pad shows the speed that was sent, its limits, and the current
    driver. For a robot that moves sideways it has a second knob below, and the keys Q and E (to the left: linear y
    above 0).

    The pad stops the robot on release, when it loses the focus or the page is hidden, and on an error. The robot moves
    only while the page and the kernel answer each other: half a second without an answer ends a press, on both sides,
    and a message with a longer delay does not move the robot. Then the knob must be released and pressed again. No
    program can stop a robot if its whole process hangs, so a robot should also stop by itself when no speed comes.

    The newest press of all pads on one feed drives the robot. During a press, programs are refused. Stop is latched:
    all driving is refused until it is released, on the page or by ``stopped = False``.

    Args:
        send: a function of linear (m/s) and angular (rad/s) that drives the robot, and of ``lateral`` (m/s to the left)
            if it has a parameter of this name. A thread of the pad calls it ten times a second during a press, and with
            zero at the end.
        title: the name of the robot in the header; usually the topic.
        linear_limit: m/s at the edge of the pad, forward and backward.
        angular_limit: rad/s at the edge of the pad, both ways.
        lateral_limit: m/s at the ends of the knob for moving sideways, which it adds. By default ``max_lateral`` of the
            feed's ``driving``, and no such knob without a feed.
        enabled: False to disable the pad.
        header: False to hide the header.

    Raises:
        TypeError: an unknown keyword; or ``send`` is not a function, or a coroutine function.
        traitlets.TraitError: a limit that is not a finite number above 0; or ``lateral_limit`` although ``send`` has no
            parameter ``lateral``.

    Source: geometry_msgs/Twist, REP-103.

    Examples:
        >>> from robowidgets.simulator import Robot, World
        >>> robot = Robot(World.rooms())
        >>> pad = DriveWidget(send=robot.drive, linear_limit=0.3)
        >>> pad.commanded.linear
        (0.0, 0.0, 0.0)
    """

    _esm, _css = bundle("drive_widget")
    _keywords = ("send",)
    _usual = "send=feed.drive"

    linear_limit = _Limit(MAX_LINEAR, "m/s", help="Speed at the edge of the pad, m/s.").tag(sync=True)
    angular_limit = _Limit(MAX_ANGULAR, "rad/s", help="Speed at the edge of the pad, rad/s.").tag(sync=True)
    lateral_limit = _Limit(
        None, "m/s", help="Speed at the ends of the knob for sideways, m/s; the feed's limit by default."
    )
    enabled = Flag(True, help="True if the pad drives.").tag(sync=True)

    def __init__(self, *, send: Callable[..., Any] | None = None, **kwargs: Any) -> None:
        if send is not None and not callable(send):
            raise TypeError(f"send: expected a function of linear and angular speed, got {send!r}")
        _check_plain("send", send)
        self._lease = PressLease()
        self._driving = ""
        """The last press of this pad that drove the robot."""
        self._titles = TitleObservers()
        self._takes_lateral = send is None or _takes_lateral(send)
        """True if the driven robot can move sideways."""
        super().__init__(**kwargs)
        if send is not None:
            self._attach(CommandWatchdog(_sink_of(send)), owns=True)

    def connect(self, robot: Any) -> None:
        """Drive this robot from now on, and stop the robot that the pad drove before.

        The pad shows when a feed is closed.

        Args:
            robot: a feed, or an object with ``drive(linear, angular)``, optionally with ``lateral``. Its ``stop()`` is
                used if it exists.

        Raises:
            TypeError: it has no ``drive``, or the pad has a ``lateral_limit`` but ``drive`` has no ``lateral``.
        """
        watchdog = getattr(robot, "watchdog", None)
        if isinstance(watchdog, CommandWatchdog):
            self._takes_lateral = True
            self._attach(watchdog, robot)
            robot.driver.prepare()
        else:
            drive, stop = _drive_of(robot), getattr(robot, "stop", None)
            if self.lateral_limit is not None and not _takes_lateral(drive):
                raise TypeError(f"connect(): {_NOT_SIDEWAYS}")
            self._takes_lateral = _takes_lateral(drive)
            self._attach(CommandWatchdog(_sink_of(drive, stop)), owns=True)
        self._title_after_feed()
        self._titles.call()

    def send_newest(self) -> int:
        """See `DrivingWidget`. The feed may have chosen another topic."""
        self._title_after_feed()
        self._titles.call_later()  # the pacer holds its turn
        return super().send_newest()

    def disconnect(self) -> None:
        """Stop the robot that the pad drove, and drive no robot any more."""
        self._detach()

    @property
    def commanded(self) -> Speed:
        """The speed that was sent last: linear x and y in m/s, angular z in rad/s."""
        return self._watchdog.sent.as_speed

    @property
    def _lateral_limit(self) -> float:
        """M/s at the ends of the knob for sideways, or 0 without such a knob."""
        if self.lateral_limit is not None:
            return float(self.lateral_limit)
        return 0.0 if self._feed is None else self._feed.driving.max_lateral

    def _compose(self) -> dict[str, Any]:
        return {**super()._compose(), "lateral_limit": self._lateral_limit}

    def _title_after_feed(self) -> None:
        feed = self._feed
        if feed is not None:
            self._titles.add(self.name_quietly(feed.driver.topic))

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
        """Return why the pad cannot drive, as a key for the page; empty if it can."""
        if not self._is_ready:
            return "nothing"
        if not self.enabled:
            return "disabled"
        if self.stopped:
            return "stopped"
        return "hangs" if self._watchdog.busy_for > HOLD else ""

    def _drive(self, message: PadMessage) -> str:
        """Send a speed of the current press; return why the press is over, or empty if it is not.

        The robot is taken over by the first speed and not by the press. The speed is fresh, but a press that was
        delayed by a busy kernel must not interrupt a program.
        """
        press, watchdog = message.press, self._watchdog
        shares, limits = message[-3:], (self.linear_limit, self.angular_limit, self._lateral_limit)
        velocity = Velocity(*(share * limit for share, limit in zip(shares, limits, strict=True)))
        try:
            if self._driving != press:
                watchdog.take(press)
                self._driving = press
            if self._feed is not None:
                self._feed.driver.drive_by_hand(velocity, press)
            else:
                watchdog.drive(velocity, driver=press)
        except Exception as error:  # whatever the feed raises, the page must show it
            over = self._why_refused(press)
            if not over:
                self._fail(error)
            return over or "failed"
        return ""

    def _why_refused(self, press: str) -> str:
        """Return why a press no longer drives although nothing failed; empty if it drives."""
        driver = self._watchdog.driver
        if self.stopped or driver == press:
            return "stopped" if self.stopped else ""
        return "taken" if driver not in ("", PROGRAM, ASSISTANT) else "late"

    def _end_press(self, why: str) -> None:
        press = self._lease.end(why)
        if press:
            self._watchdog.let_go(press)

    def _on_failed(self, failure: str, error: BaseException) -> None:
        if self._lease.press:
            self._cause = str(error) or type(error).__name__
            self._end_press("failed")
            self._log_once(failure)

    @traitlets.validate("lateral_limit")
    def _check_lateral(self, proposal: Any) -> Any:
        if proposal["value"] is not None and not self._takes_lateral:
            raise traitlets.TraitError(_NOT_SIDEWAYS)
        return proposal["value"]

    @traitlets.observe("lateral_limit")
    def _after_lateral(self, _change: Any) -> None:
        pacer.mark(self)

    @traitlets.observe("enabled")
    def _after_enabled(self, _change: Any) -> None:
        if not self.enabled:
            self._end_press("disabled")


_NOT_SIDEWAYS = "lateral_limit: what drives the robot has no parameter lateral: drive(linear, angular, lateral)"


def _drive_of(robot: Any) -> Callable[..., Any]:
    drive: Callable[..., Any] | None = getattr(robot, "drive", None)
    if not callable(drive):
        raise TypeError(
            f"connect(): expected a feed, or something with drive(linear, angular), got {robot!r}; "
            "a function goes to DriveWidget(send=...)"
        )
    _check_plain("connect(): drive", drive)
    return drive


def _check_plain(name: str, drive: Any) -> None:
    """Raise TypeError for a coroutine function: a call of it moves nothing."""
    if inspect.iscoroutinefunction(drive) or inspect.iscoroutinefunction(getattr(drive, "__call__", None)):  # noqa: B004
        of = getattr(drive, "__name__", type(drive).__name__)
        raise TypeError(
            f"{name}: expected a plain function, got the coroutine function {of}, whose call alone sends nothing; give "
            f"one that runs it to its end: lambda linear, angular: asyncio.run({of}(linear, angular))"
        )


def _takes_lateral(drive: Callable[..., Any]) -> bool:
    try:
        return "lateral" in inspect.signature(drive).parameters
    except (TypeError, ValueError):  # unknown for built-in functions
        return False


def _sink_of(drive: Callable[..., Any], stop: Any = None) -> Callable[[float, float, float], Any]:
    """Return the sink for a function of two speeds, and of a third one if it has a parameter ``lateral``."""
    sideways = _takes_lateral(drive)

    def send(linear: float, angular: float, lateral: float) -> None:
        if callable(stop) and not (linear or angular or lateral):
            stop()
        elif sideways:
            drive(linear, angular, lateral=lateral)
        else:
            drive(linear, angular)

    return send

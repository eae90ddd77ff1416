"""The drive pad: a robot is driven from the notebook."""

from __future__ import annotations

import threading
from collections.abc import Callable
from math import isfinite
from numbers import Real
from typing import Any, Protocol, runtime_checkable

import traitlets

from ._dead_man import ZERO, DeadMan, Speed2
from ._grip import Grip, Said, to_said
from ._limits import LARGEST
from ._named_widget import NamedWidget, bundle
from ._traits import Flag
from .samples import Speed

_NOT_DRIVEN = "could not be driven"
_NOR_STOPPED = ". Nor could it be told to stop"


@runtime_checkable
class _Feed(Protocol):
    """What says when it was closed."""

    @property
    def is_closed(self) -> bool: ...

    def watch(self, tell: Callable[[], None]) -> None: ...

    def forget(self, tell: Callable[[], None]) -> None: ...


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


class DriveWidget(NamedWidget):
    """A pad that drives a robot: drag its knob, or press arrow keys or W, A, S, D while it has the focus.

    Up is forward and left turns to the left (REP-103: linear x and angular z above 0). The knob's place is a share of
    the limits; keys go to the limits. The reader sees the speed that was handed on, its limits, and in words what is
    going on.

    The robot is told to stop on release, when the pad loses the focus or the page is hidden, and when something raises.
    It moves only while the page and the kernel answer each other: half a second without an answer ends a press, on both
    sides, and nothing that waited longer than that ever moves the robot. A press that ended so must be let go and made
    anew. No program can do better than that when its whole process hangs: a robot should stop by itself, too, when it
    hears nothing.

    Args:
        send: a function of linear (m/s) and angular (rad/s) that drives the robot. It is called in a thread of the
            pad's, ten times a second while the pad is held, and with zero at the end.
        title: what is driven, for the header; usually the topic.
        linear_limit: m/s at the edge of the pad, forward and backward.
        angular_limit: rad/s at the edge of the pad, both ways.
        enabled: whether the pad drives at all.
        header: whether it is there.

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

    _esm = bundle("drive_widget.js")
    _keywords = ("send",)
    _dead_man: DeadMan | None = None
    _feed: _Feed | None = None

    linear_limit = _Limit(0.5, "m/s", help="At the edge of the pad, m/s.").tag(sync=True)
    angular_limit = _Limit(1.0, "rad/s", help="At the edge of the pad, rad/s.").tag(sync=True)
    enabled = Flag(True, help="Whether the pad drives.").tag(sync=True)
    _ready = Flag(False, help="Whether there is something to drive.").tag(sync=True)
    _state = traitlets.Dict(
        help="speed: (m/s, rad/s) handed on last; press: who holds the pad; error: text; cause: why a press ended, or "
        "nothing can be driven any more."
    ).tag(sync=True, echo_update=False)

    def __init__(self, *, send: Callable[[float, float], Any] | None = None, **kwargs: Any) -> None:
        if send is not None and not callable(send):
            raise TypeError(f"send: expected a function of linear and angular speed, got {send!r}")
        self._grip = Grip()
        self._telling = threading.Lock()
        self._failed = ""
        """The press that an error ended last."""
        super().__init__(**kwargs)
        self._tell(speed=ZERO, press="", error="", cause="")
        self.on_msg(self._on_page)
        if send is not None:
            self._drive_by(send, lambda: send(0.0, 0.0))

    def connect(self, robot: Any) -> None:
        """Drive this one from now on; what was driven until now is told to stop.

        When a feed is closed, the pad says so.

        Args:
            robot: a feed, or anything with ``drive(linear, angular)``. Its ``stop()`` is used where it has one.

        Raises:
            TypeError: it has no ``drive``.
        """
        drive = getattr(robot, "drive", None)
        if not callable(drive):
            raise TypeError(
                f"connect(): expected a feed, or something with drive(linear, angular), got {robot!r}; "
                "a function goes to DriveWidget(send=...)"
            )
        stop = getattr(robot, "stop", None)
        self._drive_by(drive, stop if callable(stop) else lambda: drive(0.0, 0.0), robot)
        topic = getattr(getattr(robot, "driving", None), "topic", "")
        if isinstance(topic, str) and topic:
            self._name_after(topic)
        if isinstance(robot, _Feed):
            self._feed = robot
            robot.watch(self._look)
            self._look()

    def disconnect(self) -> None:
        """Drive nothing any more; what was driven is told to stop."""
        self._end()
        self._ready = False
        self._tell(cause="")

    def stop(self) -> None:
        """Tell the robot to stop, and let nobody drive who does not press anew."""
        self._let_go()
        if self._dead_man is not None:
            self._dead_man.stop()

    def close(self) -> None:
        """Tell the robot to stop if it is driven, and take the pad off the page."""
        self._end()
        super().close()

    @property
    def commanded(self) -> Speed:
        """The speed that was handed on last: linear x in m/s, angular z in rad/s."""
        linear, angular = self._state["speed"]
        return Speed((linear, 0.0, 0.0), (0.0, 0.0, angular))

    def _drive_by(self, drive: Callable[[float, float], Any], halt: Callable[[], Any], robot: Any = None) -> None:
        self._end()
        self._dead_man = DeadMan(drive, halt, lambda speed: self._on_told(speed, robot), self._on_failed)
        self._ready = True
        self._tell(error="", cause="")

    def _look(self) -> None:
        """Say so when the feed was closed; the feed's call, from any thread."""
        if self._feed is not None and self._feed.is_closed:
            self._end()
            self._ready = False
            self._tell(error="", cause="the feed is closed")

    def _end(self) -> None:
        feed, self._feed = self._feed, None
        if feed is not None:
            feed.forget(self._look)
        dead_man, self._dead_man = self._dead_man, None
        if dead_man is not None:
            self._let_go()
            dead_man.close()

    def _let_go(self) -> None:
        self._grip.let_go()
        self._tell(press="")

    def _on_told(self, speed: Speed2, robot: Any) -> None:
        within = getattr(getattr(robot, "driving", None), "within", None)
        words = {"error": getattr(robot, "drive_words", "")} if speed != ZERO else {}
        self._tell(speed=within(*speed) if callable(within) else speed, **words)

    def _on_failed(self, error: BaseException, speed: Speed2) -> None:
        what = "could not be told to stop" if speed == ZERO else _NOT_DRIVEN
        text = f"The robot {what}: {type(error).__name__}: {error}"
        self._log_once(text)
        cause = str(error) or type(error).__name__
        before = self._state["error"]
        if speed == ZERO and _NOT_DRIVEN in before:
            text = before if before.endswith(_NOR_STOPPED) else f"{before}{_NOR_STOPPED}"
            cause = self._state["cause"]
        self._failed = self._grip.press or self._failed
        self._let_go()
        self._tell(error=text, cause=cause)

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        try:
            said = to_said(content)
        except ValueError as error:
            self._log_once(f"the page sent what is no speed: {error}")
            self.stop()
            return
        over = "" if said.act == "release" else self._why_not()
        token = None if over or said.act == "release" else self._token(said)
        if token is not None:
            self.send({"press": said.press, "token": token})
            return
        if said.act == "hold" and not over:
            late = "failed" if said.press == self._failed else "late"
            over = "taken" if self._grip.press not in ("", said.press) else late
        if self._grip.press == said.press:
            self.stop()
        self.send({"press": said.press, "over": over or "released"})

    def _why_not(self) -> str:
        """Why nothing can be driven, for the page to put in words; empty when it can."""
        if self._dead_man is None:
            return "nothing"
        if not self.enabled:
            return "disabled"
        return "hangs" if self._dead_man.hangs_for else ""

    def _token(self, said: Said) -> int | None:
        """Do what a press says; the token of the answer, None for one that does not count."""
        if said.act == "press":
            token = self._grip.take(said.press)
            self._tell(press=said.press, error="", cause="")
            return token
        renewed = self._grip.renew(said.press, said.token)
        if renewed is not None and self._dead_man is not None:
            self._dead_man.drive((said.forward * self.linear_limit, said.turn * self.angular_limit))
        return renewed

    def _tell(self, **state: Any) -> None:
        with self._telling:
            self._state = {**self._state, **state}

    @traitlets.observe("enabled")
    def _after_enabled(self, _change: Any) -> None:
        if not self.enabled:
            self.stop()

"""The base of the drive pad and the Stop bar: the state of driving, Stop, and the presence of a page."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from math import ceil
from typing import Any, Protocol

import traitlets

from ..runtime.log_once import LogOnce, log_in_thread
from ..runtime.platform_fixes import route_by_message
from ..samples.staleness import BEAT
from ..widget.base_widget import NamedWidget
from ..widget.pacer import pacer
from .command_watchdog import HOLD, ZERO, CommandWatchdog, Velocity
from .press import PadMessage, Tokens, to_pad_message
from .stop_all import stop_at_end

ALLOW_LIFETIME = 3.0
"""Seconds for which a token may release the latch. The page gets a token every second."""


class FeedConnection(Protocol):
    """The connection of a feed."""

    is_closed: bool

    def observe(self, on_change: Callable[[], None]) -> None:
        """Call a function on each change."""

    def unobserve(self, on_change: Callable[[], None]) -> None:
        """Stop calling it."""


class FeedDriver(Protocol):
    """The driver of a feed."""

    @property
    def topic(self) -> str:
        """The topic on which it sends speeds."""

    @property
    def sender(self) -> str:
        """Text for the sender of the speeds, or empty if it is not known yet."""

    def prepare(self) -> None:
        """Start the sender of the speeds."""

    def page_seen(self) -> None:
        """Note that a page is connected."""

    def drive_by_hand(self, velocity: Velocity, press: str) -> None:
        """Send a speed of a press."""


class FeedLimits(Protocol):
    """The limits among the settings of driving, in m/s and rad/s."""

    @property
    def max_linear(self) -> float:
        """The limit forward and back, in m/s."""

    @property
    def max_angular(self) -> float:
        """The limit of turning, in rad/s."""

    @property
    def max_lateral(self) -> float:
        """The limit sideways, in m/s."""


class DrivenFeed(Protocol):
    """The part of a feed that the driving widgets use."""

    @property
    def connection(self) -> FeedConnection:
        """Its connection."""

    @property
    def driver(self) -> FeedDriver:
        """Its driver."""

    @property
    def driving(self) -> FeedLimits:
        """Its settings of driving."""

    @property
    def drive_status(self) -> str:
        """The reason why the robot may not move as commanded, or empty if it may."""

    @property
    def idle_motion(self) -> str:
        """The cause that moves the robot while no speeds are sent, or "" if it stands still."""


class DrivingWidget(NamedWidget):
    """A widget with a Stop that shows the driver. It uses the watchdog of a feed, or a watchdog without a feed."""

    _watchdog: CommandWatchdog
    _feed: DrivenFeed | None = None
    """The feed that its watchdog belongs to, or None for a watchdog without a feed."""
    _owns = False

    _state = traitlets.Dict(
        help="ready: true if there is something to drive; driver: 'program', 'assistant', the name of a press, or "
        "empty; left: seconds for which an assistant may go on; speed: "
        "(m/s, rad/s, m/s to the left) sent last; stopped: true while stop is latched; error, cause, status, idle, "
        "topic, sender: texts; number: number of the message."
    ).tag(sync=True, echo_update=False)

    def __init__(self, **kwargs: Any) -> None:
        self._page_lock = threading.Lock()
        self._error_lock = threading.Lock()
        self._send_lock = threading.RLock()
        self._tokens = Tokens(ALLOW_LIFETIME)
        self._sent: dict[str, Any] = {}
        self._number = 0
        self._renew_at = 0.0
        self._cause = ""
        self._forget_errors()
        self._is_ready, self._watchdog = False, CommandWatchdog(lambda *_: None)
        super().__init__(**kwargs)
        self._error_log = LogOnce(log_in_thread)  # the watchdog's thread logs, too
        self.on_msg(self._on_page)

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm)

    @property
    def stopped(self) -> bool:
        """True while stop is latched: driving is refused until a release, on the page or by setting this to False."""
        return self._watchdog.stopped

    @stopped.setter
    def stopped(self, stopped: bool) -> None:
        self._watchdog.stopped = bool(stopped)

    def stop(self) -> None:
        """Stop the robot and end every press, without latching stop: a new press or a program may drive again."""
        self._end_press("released")
        self._watchdog.let_go()
        self._watchdog.stop()

    def close(self) -> None:
        """Remove the widget from the page, and stop a robot that only this widget drives."""
        if "_watchdog" not in vars(self):  # the constructor raised an error before it set one
            return
        self._detach()
        with self._send_lock:
            super().close()
            pacer.forget(self)

    # -- for subclasses ------------------------------------------------------------------------------------------------

    def _attach(self, watchdog: CommandWatchdog, feed: DrivenFeed | None = None, *, owns: bool = False) -> None:
        """Use a watchdog from now on."""
        self._detach()
        self._forget_errors()
        self._is_ready, self._watchdog, self._feed, self._owns, self._cause = True, watchdog, feed, owns, ""
        watchdog.observe(self._on_change)
        if owns:
            stop_at_end()
        if feed is not None:
            feed.connection.observe(self._on_change)
        self._on_change()

    def _detach(self, cause: str = "") -> None:
        """Stop using the watchdog, and stop a robot that only this widget drives."""
        watchdog, feed, owns = self._watchdog, self._feed, self._owns
        if feed is not None:
            feed.connection.unobserve(self._on_change)
        watchdog.unobserve(self._on_change)
        if owns:
            try:
                watchdog.close()
            except Exception as error:
                self._log_once(f"sending zero to the robot failed: {_described(error)}")
        self._end_press("nothing")
        self._is_ready, self._watchdog = False, CommandWatchdog(lambda *_: None)
        self._feed, self._owns = None, False
        self._forget_errors()
        self._cause = cause
        pacer.mark(self)

    def _end_press(self, why: str) -> None:
        """End the press of this widget, if it holds one."""

    def _on_failed(self, failure: str, error: BaseException) -> None:
        """React to a speed that was not sent."""

    def _on_press(self, message: PadMessage) -> None:
        """Handle a message that belongs to a press."""
        raise ValueError(f"act: expected stop, allow or beat for a Stop, got {message.act}")

    def _forget_errors(self) -> None:
        self._not_driven = self._not_stopped = ""
        self._error: BaseException | None = None

    # -- called by the watchdog and the feed ---------------------------------------------------------------------------

    def _on_change(self) -> None:
        """Note errors and let the pacer send the state. Any thread may call it; it does not wait."""
        feed = self._feed
        if feed is not None and feed.connection.is_closed:
            self._detach("the feed is closed")
            return
        with self._error_lock:
            watchdog = self._watchdog
            error, velocity = watchdog.error, watchdog.failed
            is_new, self._error = error is not self._error, error
            if error is None:
                self._not_stopped = ""
                if watchdog.driver and watchdog.sent != ZERO:
                    self._not_driven = ""
            elif is_new and velocity == ZERO:
                self._not_stopped = f"Sending zero to the robot failed: {_described(error)}"
        if error is not None and is_new and velocity != ZERO:
            self._fail(error)
        pacer.mark(self)

    def _fail(self, error: BaseException) -> None:
        """Show that sending a speed failed."""
        failure = f"The robot could not be driven: {_described(error)}"
        self._on_failed(failure, error)
        # Only after the press has ended: while it drives, a speed sent earlier would clear the text.
        self._not_driven = failure
        pacer.mark(self)

    def _error_text(self) -> str:
        busy = self._watchdog.busy_for
        if busy > HOLD:
            return f"The function that drives the robot has not returned for {busy:.0f} s"
        if self._not_driven and self._not_stopped:
            return f"{self._not_driven}. Sending zero failed, too"
        return self._not_driven or self._not_stopped

    # -- to the page ---------------------------------------------------------------------------------------------------

    def _compose(self) -> dict[str, Any]:
        watchdog, feed = self._watchdog, self._feed
        return {
            "ready": self._is_ready,
            "driver": watchdog.driver,
            "left": ceil(watchdog.lease_left),
            "speed": watchdog.sent,
            "stopped": watchdog.stopped,
            "error": self._error_text(),
            "cause": self._cause,
            "status": "" if feed is None else feed.drive_status,
            "idle": "" if feed is None else feed.idle_motion,
            "topic": "" if feed is None else feed.driver.topic,
            "sender": "" if feed is None else feed.driver.sender,
        }

    def send_newest(self) -> int:
        """Send the state to the page if it has changed, and every second while there is something to drive.

        The pacer calls it, because speeds change 50 times a second.
        """
        with self._send_lock:
            if self.comm is None:
                return 0
            state, now = self._compose(), time.monotonic()
            # It also requests an answer: a hidden page, which may be needed, has slow timers, but answers at once.
            renews = state["ready"]
            if state != self._sent or (renews and now >= self._renew_at):
                self._store(state)
                super().send_state("_state")
                self._sent, self._renew_at = state, now + BEAT
            if renews:
                pacer.mark_at(self, self._renew_at)
        return 0

    def get_state(self, key: str | Iterable[str] | None = None, drop_defaults: bool = False) -> dict[str, Any]:
        """Return the synced traits with the newest state, for a new view, a reload and a saved notebook."""
        if key is None:
            with self._send_lock:
                self._store(self._compose())
        state: dict[str, Any] = super().get_state(key, drop_defaults)
        return state

    def _store(self, state: dict[str, Any]) -> None:
        """Store a state without sending it, as setting the trait would."""
        self._number += 1
        self._trait_values["_state"] = {**state, "number": self._number}

    # -- from the page -------------------------------------------------------------------------------------------------

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Handle a message of the page, in the main thread or a thread of a subshell. It does not wait."""
        feed = self._feed
        if feed is not None:
            feed.driver.page_seen()
        with self._page_lock:
            try:
                message = to_pad_message(content)
                if message.act == "beat":
                    self.send({"beat": message.press, "token": self._tokens.issue()})
                elif message.act == "stop":
                    self.stopped = True
                elif message.act == "allow":
                    self._allow(message)
                else:
                    self._on_press(message)
            except ValueError as error:
                self.stop()
                self._log_once(f"the page sent an invalid message: {error}")

    def _allow(self, message: PadMessage) -> None:
        """Release the latch, unless a busy kernel delayed the message: the user may have left the page since."""
        if self._tokens.is_fresh(message.token):
            self.stopped = False
        else:
            self.send({"refused": message.press})


def _described(error: BaseException) -> str:
    """Return an error as text, with its class if it is not of this package, whose texts are whole sentences."""
    is_ours = type(error).__module__.partition(".")[0] == __name__.partition(".")[0]
    return str(error) if is_ours else f"{type(error).__name__}: {error}"

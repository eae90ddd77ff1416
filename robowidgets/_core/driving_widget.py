"""What the widgets share by which a person drives or stops a robot: who drives, Stop, and whether a page is there."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from typing import Any, Protocol

import traitlets

from .command_watchdog import HOLD, ZERO, CommandWatchdog
from .named_widget import NamedWidget
from .pacer import pacer
from .press import PadMessage, Tokens, to_pad_message

RENEWAL = 1.0
"""Seconds after which the state of a robot that is driven is sent again: the page takes an older one for no news."""

ALLOW_LIFETIME = 3.0
"""Seconds for which a token allows driving again. The page gets one a second."""


class _Driving(Protocol):
    @property
    def topic(self) -> str: ...
    @property
    def needs_page(self) -> bool: ...


class DrivenFeed(Protocol):
    """What pad and Stop need of a feed."""

    @property
    def watchdog(self) -> CommandWatchdog: ...
    @property
    def driving(self) -> _Driving: ...
    @property
    def drive_words(self) -> str: ...
    @property
    def is_closed(self) -> bool: ...
    def drive_by_hand(self, linear: float, angular: float, press: str) -> None: ...
    def page_seen(self) -> None: ...
    def watch(self, tell: Callable[[], None]) -> None: ...
    def forget(self, tell: Callable[[], None]) -> None: ...


class DrivingWidget(NamedWidget):
    """A widget with a Stop, which tells the page who drives. It stands on a watchdog: a feed's, or one of its own."""

    _watchdog: CommandWatchdog
    _feed: DrivenFeed | None = None
    _owns = False

    _state = traitlets.Dict(
        help="ready: whether there is something to drive; driver: 'program', the name of a press, or nobody; speed: "
        "(m/s, rad/s) sent last; stopped: whether stop is latched; error, cause, words, topic: texts; number: of the "
        "message."
    ).tag(sync=True, echo_update=False)

    def __init__(self, **kwargs: Any) -> None:
        self._handling, self._noting, self._sending = threading.Lock(), threading.Lock(), threading.RLock()
        self._tokens = Tokens(ALLOW_LIFETIME)
        self._sent: dict[str, Any] = {}
        self._number = 0
        self._renew_at = 0.0
        self._cause = ""
        self._forget_errors()
        self._watchdog = CommandWatchdog(lambda *_: None)
        super().__init__(**kwargs)
        self.on_msg(self._on_page)

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        answer_beside_cells(self.comm)

    @property
    def stopped(self) -> bool:
        """Whether stop is latched: nobody drives until it is released, on the page or by setting this to False."""
        return self._watchdog.stopped

    @stopped.setter
    def stopped(self, stopped: bool) -> None:
        self._watchdog.stopped = bool(stopped)

    def stop(self) -> None:
        """Tell the robot to stop, and let nobody drive by hand who does not press anew. It latches nothing."""
        self._end_press("released")
        self._watchdog.let_go()
        self._watchdog.stop()

    def close(self) -> None:
        """Take the widget off the page; a robot that only it drives is told to stop."""
        if "_watchdog" not in vars(self):  # it was refused before there was one
            return
        self._detach()
        with self._sending:
            super().close()
            pacer.forget(self)

    # -- for subclasses ------------------------------------------------------------------------------------------------

    def _attach(self, watchdog: CommandWatchdog, feed: DrivenFeed | None = None, *, owns: bool = False) -> None:
        """Stand on a watchdog from now on."""
        self._detach()
        self._forget_errors()
        self._watchdog, self._feed, self._owns, self._cause = watchdog, feed, owns, ""
        watchdog.watch(self._look)
        if feed is not None:
            feed.watch(self._look)
        self._look()

    def _detach(self, cause: str = "") -> None:
        """Stand on nothing any more; a robot that only this widget drives is told to stop."""
        watchdog, feed, owns = self._watchdog, self._feed, self._owns
        if feed is not None:
            feed.forget(self._look)
        watchdog.forget(self._look)
        if owns:
            try:
                watchdog.close()
            except Exception as error:
                self._log_once(f"the robot could not be told to stop: {_described(error)}")
        self._end_press("nothing")
        self._watchdog, self._feed, self._owns = CommandWatchdog(lambda *_: None), None, False
        self._forget_errors()
        self._cause = cause
        pacer.mark(self)

    def _end_press(self, why: str) -> None:
        """End the press of this widget, if it holds one."""

    def _on_failed(self, words: str, error: BaseException) -> None:
        """End what cannot go on after a speed was not sent."""

    def _on_press(self, message: PadMessage) -> None:
        """Do what a press says."""
        raise ValueError(f"act: a Stop has no {message.act}")

    def _is_ready(self) -> bool:
        return self._feed is not None or self._owns

    def _forget_errors(self) -> None:
        self._not_driven = self._not_stopped = ""
        self._error: BaseException | None = None

    # -- what the watchdog and the feed tell ---------------------------------------------------------------------------

    def _look(self) -> None:
        """Note what has changed, in any thread; the pacer sends it. It waits for nobody."""
        feed = self._feed
        if feed is not None and feed.is_closed:
            self._detach("the feed is closed")
            return
        with self._noting:
            watchdog = self._watchdog
            error, velocity = watchdog.error, watchdog.failed
            is_new, self._error = error is not self._error, error
            if error is None:
                self._not_stopped = ""
                if watchdog.driver and watchdog.sent != ZERO:
                    self._not_driven = ""
            elif is_new and velocity == ZERO:
                self._not_stopped = f"The robot could not be told to stop: {_described(error)}"
        if error is not None and is_new and velocity != ZERO:
            self._fail(error)
        pacer.mark(self)

    def _fail(self, error: BaseException) -> None:
        """Say that a speed was not sent."""
        words = f"The robot could not be driven: {_described(error)}"
        self._on_failed(words, error)
        # After the press has ended: while it drives, a speed that was sent before takes the words back.
        self._not_driven = words
        pacer.mark(self)

    def _error_words(self) -> str:
        busy = self._watchdog.busy_for
        if busy > HOLD:
            return f"What drives the robot has not come back for {busy:.0f} s"
        if self._not_driven and self._not_stopped:
            return f"{self._not_driven}. Nor could it be told to stop"
        return self._not_driven or self._not_stopped

    # -- to the page ---------------------------------------------------------------------------------------------------

    def _compose(self) -> dict[str, Any]:
        watchdog, feed = self._watchdog, self._feed
        return {
            "ready": self._is_ready(),
            "driver": watchdog.driver,
            "speed": watchdog.sent,
            "stopped": watchdog.stopped,
            "error": self._error_words(),
            "cause": self._cause,
            "words": "" if feed is None else feed.drive_words,
            "topic": "" if feed is None else feed.driving.topic,
        }

    def send_newest(self) -> int:
        """Send the state to the page if it has changed, and again and again while the robot is driven.

        The pacer's call: speeds come 50 times a second.
        """
        with self._sending:
            if self.comm is None:
                return 0
            state, feed, now = self._compose(), self._feed, time.monotonic()
            # Where a page is needed, it is asked: while it is hidden it has slow timers, but answers at once.
            asks = feed is not None and feed.driving.needs_page
            renews = asks or bool(state["driver"]) or self._watchdog.owes_zero
            if state != self._sent or (renews and now >= self._renew_at):
                self._keep(state)
                super().send_state("_state")
                self._sent, self._renew_at = state, now + RENEWAL
            if renews:
                pacer.mark_at(self, self._renew_at)
        return 0

    def get_state(self, key: str | Iterable[str] | None = None, drop_defaults: bool = False) -> dict[str, Any]:
        """The synced traits, with the newest state: what a new view, a reload and a saved notebook get."""
        if key is None:
            with self._sending:
                self._keep(self._compose())
        state: dict[str, Any] = super().get_state(key, drop_defaults)
        return state

    def _keep(self, state: dict[str, Any]) -> None:
        """Have a state without sending it: setting the trait would."""
        self._number += 1
        self._trait_values["_state"] = {**state, "number": self._number}

    # -- from the page -------------------------------------------------------------------------------------------------

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Take a message of the page, in the main thread or a subshell's. Nothing in it waits."""
        feed = self._feed
        if feed is not None:
            feed.page_seen()
        with self._handling:
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
                self._log_once(f"the page sent what is no speed: {error}")
                self.stop()

    def _allow(self, message: PadMessage) -> None:
        """Release the latch. A message that waited for a busy kernel may not: its sender may have left since."""
        if self._tokens.is_fresh(message.token):
            self.stopped = False
        else:
            self.send({"refused": message.press})


def answer_beside_cells(comm: Any) -> None:
    """Let messages of the page be answered while a cell runs, where the kernel can.

    JupyterLab has a subshell for widgets, a thread beside the main one, and names it in each message. ipykernel 7.1 to
    7.3 handle the message there. ipykernel 7.4 handles it where the widget last sent something from: that is nearly
    always the main shell, where a message waits until the running cell has ended. Stop must not wait. So this comm
    routes by the message. Its handlers are safe in any thread. ipykernel 6 has no subshells.
    """
    if hasattr(comm, "_reply_subshell_for"):
        comm._reply_subshell_for = lambda _data, named_by_message: named_by_message


def _described(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"

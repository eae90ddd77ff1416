"""One Stop for several robots, for example for a teacher."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from html import escape
from typing import Any

from ..behaviors.program import RUNNING
from ..runtime.clock import Scheduler, Ticket
from ..runtime.clock import scheduler as threads
from .feed import Feed
from .middleware import FeedError

REPEAT = 0.2
"""Seconds after which zero is sent again, before a twist_mux regards the topic as silent."""

TIMEOUT = 2.0
"""Seconds for which `stop` waits for all robots together."""

_LOOK = 0.01


class StopAll:
    """One Stop for several robots. A notebook shows it as a button, with a line for each robot.

    It sends zero to all robots at once, and repeats it five times a second until it is released. Each robot has a
    thread, so a robot that cannot be reached does not delay the others. Until the release, the feeds refuse to drive.
    Their programs are paused, and stay paused after it.

    Other nodes that send speeds to a robot continue to send them. The robot is certain to stand only if its zeros have
    priority, for example on a topic with the highest priority of a twist_mux.

    Args:
        robots: the feed of each robot, by its name.
        scheduler: the scheduler of its threads, with their clock.

    Raises:
        TypeError: ``robots`` does not contain feeds by name.
        ValueError: ``robots`` is empty.

    Example:
        >>> from robowidgets import feeds
        >>> with feeds.simulator() as red, feeds.simulator() as blue:
        ...     all_robots = feeds.StopAll({"red": red, "blue": blue})
        ...     print(all_robots.stop())
        {'red': '', 'blue': ''}
    """

    def __init__(self, robots: Mapping[str, Feed], *, scheduler: Scheduler = threads) -> None:
        named = isinstance(robots, Mapping) and all(
            isinstance(name, str) and isinstance(feed, Feed) for name, feed in robots.items()
        )
        if not named:
            raise TypeError(f"StopAll: expected feeds by name, as StopAll({{'red': robot}}), got {robots!r:.80}")
        if not robots:
            raise ValueError("StopAll: expected one robot or more, got none")
        self._clock = scheduler.clock
        self._robots = {name: _Standstill(feed, self._show, scheduler) for name, feed in robots.items()}
        self._box: Any = None

    @property
    def stopped(self) -> bool:
        """True while it sends zeros."""
        return any(robot.holds for robot in self._robots.values())

    @property
    def problems(self) -> dict[str, str]:
        """The problem of the last zero for each robot, or empty."""
        return {name: robot.problem for name, robot in self._robots.items()}

    def stop(self, timeout: float = TIMEOUT) -> dict[str, str]:
        """Send zero to all robots, and repeat it until `release`.

        Args:
            timeout: seconds for which it waits for all robots together.

        Returns:
            `problems`: by name of the robot, why zero was not sent or which node also drives it, or empty.
        """
        for robot in self._robots.values():
            robot.hold()
        until = self._clock.now() + timeout
        while not all(robot.answered for robot in self._robots.values()) and self._clock.now() < until:
            self._clock.sleep(_LOOK)
        for robot in self._robots.values():
            if not robot.answered:
                robot.tell(f"zero was not sent within {timeout:g} s; sending is tried again")
        return self.problems

    def release(self) -> None:
        """Stop sending zeros, and let the feeds drive again, except feeds with another latch.

        The programs of these feeds stay paused until the user runs them. A program in another notebook, or any other
        node that sends speeds all the time, moves its robot again.
        """
        for robot in self._robots.values():
            robot.let_go()

    def __repr__(self) -> str:
        return "\n".join(f"{name}: {robot.status}" for name, robot in self._robots.items())

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        if self._box is None:
            from ipywidgets import HTML, Button, HBox, VBox

            stop = Button(description="Stop all robots", button_style="danger", icon="stop")
            release = Button(description="Release")
            stop.on_click(lambda _button: self.stop())
            release.on_click(lambda _button: self.release())
            for robot in self._robots.values():
                robot.line = HTML()
            self._box = VBox([HBox([stop, release]), *(robot.line for robot in self._robots.values())])
            self._show()
        return self._box._repr_mimebundle_(**kwargs)

    def _show(self) -> None:
        if self._box is not None:
            for name, robot in self._robots.items():
                mark = "⚠" if robot.problem else "■" if robot.holds else "○"
                line = f"{mark} <b>{escape(name)}</b> {escape(robot.status)}"
                if robot.line.value != line:
                    robot.line.value = line


class _Standstill:
    """A sender of zeros to one robot, until it is released."""

    def __init__(self, feed: Feed, show: Callable[[], None], scheduler: Scheduler) -> None:
        self.problem = ""
        self.answered = False
        self.line: Any = None
        self._feed = feed
        self._show = show
        self._scheduler = scheduler
        self._hold: object = None
        """A new object for each hold, or None while it does not hold."""
        self._ticket: Ticket | None = None

    @property
    def holds(self) -> bool:
        return self._hold is not None

    @property
    def status(self) -> str:
        if self.problem:
            return self.problem
        if not self.holds:
            return "is not stopped from here"
        return "is sent zero" if self.answered else "is being stopped"

    def hold(self) -> None:
        if self._hold is None:
            self.answered = False
            hold = self._hold = object()
            self._ticket = self._scheduler.start(partial(self._turn, hold), "robowidgets-standstill")
        elif self._ticket is not None:
            self._ticket.wake()

    def let_go(self) -> None:
        hold, self._hold = self._hold, None
        if hold is not None:
            if self._ticket is not None:
                self._ticket.detach()
            self._pause()  # also pause a program that was started since the last zero
            self._feed.watchdog.release(self)
            self.tell("")

    def tell(self, problem: str) -> None:
        self.problem = problem
        self._show()

    def _pause(self) -> None:
        """Pause the program of the feed, because it would drive again after the release."""
        program = self._feed.programs.current
        if program is not None and program.mode == RUNNING:
            program.pause("paused, because all robots were stopped")

    def _turn(self, hold: object) -> float:
        problem = others = ""
        if self._feed.connection.is_closed:
            problem = "cannot stop: its feed is closed; open it again"
        else:
            try:
                watchdog = self._feed.watchdog
                if not watchdog.is_latched_by(self):
                    try:
                        watchdog.latch(self)
                    finally:
                        if self._hold is not hold:  # it was released in the meantime
                            watchdog.release(self)
                self._pause()
                self._feed.stop()
            except (FeedError, OSError) as error:
                problem = str(error)
            others = self._feed.drive_status
        if self._hold is hold:
            self.answered = True
            self.tell(problem or (f"is sent zero, but {others}" if others else ""))
        return self._scheduler.clock.now() + REPEAT

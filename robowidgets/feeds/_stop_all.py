"""One Stop for several robots, as a teacher needs it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from html import escape
from typing import Any

from .._core.clock import Scheduler, Ticket
from .._core.clock import scheduler as threads
from ..behaviors.program import RUNNING
from .feed import Feed
from .middleware import FeedError

REPEAT = 0.2
"""Seconds after which zero is sent again: sooner than a twist_mux takes its topic for silent."""

TIMEOUT = 2.0
"""Seconds for which `stop` waits for all robots together."""

_LOOK = 0.01


class StopAll:
    """One Stop for several robots. A notebook shows it as a button, with a line for each robot.

    It sends zero to all of them at once, and again five times a second until it is released. Each robot has a thread of
    its own: one that cannot be reached holds up no other. Until then its feeds refuse to drive, and their programs are
    paused, which they stay.

    Who else sends speeds to a robot goes on sending them. The robot stands for sure where zeros come first there, as
    those of a topic of their own with the greatest priority of a twist_mux.

    Args:
        robots: the feed of each robot, by its name.
        scheduler: has the threads, and the time.

    Raises:
        TypeError: these are no feeds with names.
        ValueError: there is none.

    Example:
        >>> from robowidgets import feeds
        >>> with feeds.simulator() as red, feeds.simulator() as blue:
        ...     everybody = feeds.StopAll({"red": red, "blue": blue})
        ...     print(everybody.stop())
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
        """Whether zeros are sent now."""
        return any(robot.holds for robot in self._robots.values())

    @property
    def problems(self) -> dict[str, str]:
        """What is wrong with the last zero of each robot; empty where nothing is."""
        return {name: robot.problem for name, robot in self._robots.items()}

    def stop(self, timeout: float = TIMEOUT) -> dict[str, str]:
        """Send zero to all robots, and go on with it until `release`.

        Args:
            timeout: seconds for which it waits for all of them together.

        Returns:
            `problems`: by name of each robot why it was not sent zero, or who else drives it; empty if all is well.
        """
        for robot in self._robots.values():
            robot.hold()
        until = self._clock.now() + timeout
        while not all(robot.answered for robot in self._robots.values()) and self._clock.now() < until:
            self._clock.sleep(_LOOK)
        for robot in self._robots.values():
            if not robot.answered:
                robot.tell(f"zero was not sent within {timeout:g} s; it is tried on")
        return self.problems

    def release(self) -> None:
        """Send no more zeros, and let the feeds drive again, except those that someone else has stopped as well.

        No program of these feeds goes on by that alone: somebody runs it. Whoever else sends speeds all the time moves
        the robot again, such as a program in another notebook.
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
    """Sends zero to one robot until it is let go."""

    def __init__(self, feed: Feed, show: Callable[[], None], scheduler: Scheduler) -> None:
        self.problem = ""
        self.answered = False
        self.line: Any = None
        self._feed = feed
        self._show = show
        self._scheduler = scheduler
        self._hold: object = None
        """Another object each time that it is held; None while it is not."""
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
            self._pause()  # one that was started since the last zero, too
            self._feed.watchdog.release(self)
            self.tell("")

    def tell(self, problem: str) -> None:
        self.problem = problem
        self._show()

    def _pause(self) -> None:
        """Pause the program of the feed: it would drive as soon as it may again."""
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
                        if self._hold is not hold:  # it was let go meanwhile
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

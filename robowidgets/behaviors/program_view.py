"""The base of the widgets that show the steps of a robot's programs."""

from __future__ import annotations

from typing import Any, TypeVar

from ..runtime.platform_fixes import route_by_message
from ..widget.robot_widget import RobotWidget
from .programs import Programs

S = TypeVar("S")


class ProgramView(RobotWidget[S]):
    """A widget of the program that drives a robot. It is frozen with all other widgets of the robot.

    A subclass shows a step in `_on_step`, and calls `_follow_programs` at the end of its constructor.
    """

    _unnamed = 1

    column = "wide"
    goes_stale = False
    beats = True

    def __init__(self, robot: Any, **kwargs: Any) -> None:
        programs = getattr(robot, "programs", None)
        if not isinstance(programs, Programs):
            got = repr(robot).splitlines()[0]
            raise TypeError(f"{type(self).__name__}(): expected a feed, such as feeds.simulator(), got {got}")
        self._programs = programs
        self._robot = robot.connection.page_name
        super().__init__(**kwargs)
        self.freeze_with_robot()

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm)

    def freeze_with_robot(self) -> None:
        """Join the group of all widgets of the robot, which the page freezes together in all its views."""
        self._together = self._robot

    def close(self) -> None:
        """Remove the widget from the page; the program goes on."""
        if "_programs" in vars(self):  # else the constructor raised before it set them
            self._programs.unobserve(self._on_step)
            super().close()

    def _follow_programs(self) -> None:
        self._programs.observe(self._on_step)
        self._on_step()

    def _on_step(self) -> None:
        """Show the newest step. The thread of the program usually calls this."""
        raise NotImplementedError

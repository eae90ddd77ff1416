"""A bar with Stop, for every view of a feed."""

from __future__ import annotations

from typing import Any

import traitlets

from .driving.command_watchdog import CommandWatchdog
from .driving.driving_widget import DrivingWidget
from .widget.front_end import bundle
from .widget.traits import Flag


class StopWidget(DrivingWidget):
    """A slim bar: Stop, the driver and the speed, and why the robot may not move as commanded.

    In the view of a feed it also freezes all pictures of the view, and puts the view next to the notebook. Stop is
    latched: it sends zero, and all driving is refused until it is released, on the page or by ``stopped = False``.

    Args:
        robot: a feed, or a watchdog.

    Raises:
        TypeError: something else.

    Examples:
        >>> bar = StopWidget(CommandWatchdog(print))
        >>> bar.stopped
        False
    """

    _esm, _css = bundle("stop_widget")
    _unnamed = 1

    _together = traitlets.Unicode(help="Name of the group that its Freeze freezes; empty without the button.").tag(
        sync=True, echo_update=False
    )
    _view = traitlets.Unicode(
        help="Id of the model that its button puts next to the notebook; empty without the button."
    ).tag(sync=True, echo_update=False)
    _opens = Flag(False, help="True to do that as soon as the bar is on the page.").tag(sync=True, echo_update=False)
    _black_box = traitlets.Unicode(help="The state of the black box of the robot, or empty without one.").tag(
        sync=True, echo_update=False
    )
    _robot = traitlets.Unicode(help="Name of the robot of that group.").tag(sync=True, echo_update=False)

    def __init__(self, robot: Any, **kwargs: Any) -> None:
        watchdog = robot if isinstance(robot, CommandWatchdog) else getattr(robot, "watchdog", None)
        if not isinstance(watchdog, CommandWatchdog):
            raise TypeError(f"StopWidget(): expected a feed or a watchdog, got {robot!r}")
        super().__init__(**kwargs)
        self._attach(watchdog, None if robot is watchdog else robot)

    def stand_in(self, view: str, *, opens: bool = False) -> None:
        """Become the bar of the view with this model, and put the view next to the notebook by a button or at once."""
        self._view, self._opens = view, opens

    def show_black_box(self, line: str) -> None:
        """Show the state of the black box, or nothing if the line is empty."""
        self._black_box = line

    def freeze_with(self, group: str, robot: str) -> None:
        """Show a button that freezes the pictures of a group of a robot; no button if the group is empty."""
        self._together, self._robot = group, robot

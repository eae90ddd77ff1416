"""Several widgets as one view: side by side, and frozen and stepped together."""

from __future__ import annotations

from typing import Any

import ipywidgets

from ..widget.freezing import freeze_together
from ..widget.robot_widget import RobotWidget
from .layout import Together


def together(*widgets: RobotWidget[Any]) -> ipywidgets.Box:
    """Group widgets so that they are frozen and stepped together, and return them side by side.

    Freezing one of them, by its button, a key or ``paused``, freezes all. After a step back in one, the others show
    their newest sample at that time, as long as they keep it. All of this happens in the page, even while a cell runs.
    `Recording.show` and `Feed.show` group their widgets by themselves. A widget belongs to its last group.

    Args:
        *widgets: laser, speed and touch widgets.

    Raises:
        TypeError: no widgets, or not a widget that can be frozen. RuntimeError: a widget is closed.

    Examples:
        >>> from robowidgets import LaserWidget, SpeedWidget, together
        >>> laser, speed = LaserWidget(), SpeedWidget()
        >>> view = together(laser, speed)
        >>> laser.paused = True
        >>> speed.paused
        True
    """
    for widget in widgets:
        if not isinstance(widget, RobotWidget):
            raise TypeError(
                f"together: expected laser, speed and touch widgets, got {type(widget).__name__}; "
                "give each as an argument of its own, as in together(laser, speed)"
            )
    if not widgets:
        raise TypeError("together: expected the widgets to freeze together, as in together(laser, speed)")
    for widget in widgets:
        widget.check_open("together()")
    freeze_together(widgets)
    return Together(widgets)

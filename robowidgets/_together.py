"""Several widgets as one view: side by side, and frozen and stepped together."""

from __future__ import annotations

from typing import Any

import ipywidgets

from ._core.freezing import freeze_together
from ._core.robot_widget import RobotWidget
from ._layout import Together


def together(*widgets: RobotWidget[Any]) -> ipywidgets.Box:
    """Freeze and step widgets together, so that they always show one moment; returns them side by side.

    Freezing one of them, by its button, a key or ``paused``, freezes all. A step back in one shows in the others what
    was their newest sample then; it goes back as far as each of them remembers. All of it happens in the page, also
    while a cell runs. `Recording.show` and `Feed.show` do so by themselves. A widget is in one group: the last.

    Args:
        *widgets: laser, speed and touch widgets.

    Raises:
        TypeError: something is no widget that can be frozen, or there is none. RuntimeError: one is closed.

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

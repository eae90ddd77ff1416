"""Several widgets on one screen: side by side, and frozen and stepped together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from ..screen_widget import ScreenWidget
from ..widget.freezing import freeze_together
from ..widget.front_end import FrontEndWidget
from ..widget.sample_widget import GroupedWidget
from .layout import in_columns


def screen(*widgets: FrontEndWidget, arrangement: Any = None) -> ScreenWidget:
    """Show widgets side by side on one screen, frozen and stepped together.

    Freezing one of them, by its button, a key or ``paused``, freezes all. After a step back in one, the others show
    their newest sample at that time, as long as they keep it. All of this happens in the page, even while a cell runs.
    `Recording.show` and `Feed.show` do this by themselves. A widget is frozen with its last screen.

    Args:
        *widgets: widgets, players, or other screens, whose widgets are frozen with the others. The widgets of a
            recording or of a robot keep a freeze of their own.
        arrangement: an arrangement of their cards by hand, as `ScreenWidget.arrangement` returns it.

    Raises:
        TypeError: no widgets, or not a widget of robowidgets. RuntimeError: a widget is closed.

    Examples:
        >>> from robowidgets import LaserWidget, SpeedWidget, screen
        >>> laser, speed = LaserWidget(), SpeedWidget()
        >>> view = screen(laser, speed)
        >>> laser.paused = True
        >>> speed.paused
        True
    """
    for widget in widgets:
        if not isinstance(widget, FrontEndWidget):
            is_shown = hasattr(widget, "show")
            hint = "give the widget that its show() returns" if is_shown else "give each as an argument of its own"
            raise TypeError(
                f"screen: expected widgets of robowidgets, got {type(widget).__name__}; "
                f"{hint}, as in screen({'recording.show()' if is_shown else 'laser'}, speed)"
            )
    if not widgets:
        raise TypeError("screen: expected the widgets to show side by side, as in screen(laser, speed)")
    for widget in widgets:
        if widget.comm is None:
            raise RuntimeError("screen(): this widget is closed; show a new one")
    freeze_together(_freezable(widgets))
    return ScreenWidget(places=in_columns(dict.fromkeys(widgets)), arrangement=arrangement)


def _freezable(widgets: Iterable[Any]) -> Iterator[GroupedWidget]:
    """Yield the widgets that can be frozen, within other screens too, except a recording's and a robot's."""
    for widget in widgets:
        if hasattr(widget, "join_group"):
            yield widget
        elif isinstance(widget, ScreenWidget) and not widget.kind:
            yield from _freezable(widget.children)

"""Widgets of several topics, side by side."""

from __future__ import annotations

from collections.abc import Sequence

import ipywidgets

from .laser_widget import LaserWidget

WIDE = {"display": "flex", "flex_flow": "row wrap", "align_items": "flex-start", "width": "100%"}
"""Layout of a box that holds columns."""

_CARD = "764px"


def columns(widgets: Sequence[ipywidgets.Widget]) -> list[ipywidgets.VBox]:
    """Lasers in the wide column, the rest one under the other beside them, or below where room is short."""
    lasers = [widget for widget in widgets if isinstance(widget, LaserWidget)]
    others = [widget for widget in widgets if widget not in lasers]
    wide = [_column(lasers, "2 1 460px", max_width=_CARD)] if lasers else []
    return [*wide, *([_column(others, "1 1 340px")] if others else [])]


def _column(widgets: Sequence[ipywidgets.Widget], flex: str, **limits: str) -> ipywidgets.VBox:
    layout = ipywidgets.Layout(flex=flex, min_width="min(100% - 8px, 300px)", margin="0 4px", **limits)
    return ipywidgets.VBox(list(widgets), layout=layout)

"""Widgets of several topics, side by side."""

from __future__ import annotations

from collections.abc import Sequence

import ipywidgets

WIDE = {"display": "flex", "flex_flow": "row wrap", "align_items": "flex-start", "width": "100%"}
"""Layout of a box that holds columns."""

_CARD = "764px"


def columns(widgets: Sequence[ipywidgets.Widget]) -> list[ipywidgets.VBox]:
    """Widgets that are ``wide`` in the wide column, the rest one under the other beside them.

    Where room is short the rest stand below.
    """
    wide = [widget for widget in widgets if widget.wide]
    others = [widget for widget in widgets if not widget.wide]
    left = [_column(wide, "2 1 460px", max_width=_CARD)] if wide else []
    return [*left, *([_column(others, "1 1 340px")] if others else [])]


def _column(widgets: Sequence[ipywidgets.Widget], flex: str, **limits: str) -> ipywidgets.VBox:
    layout = ipywidgets.Layout(flex=flex, min_width="min(100% - 8px, 300px)", margin="0 4px", **limits)
    return ipywidgets.VBox(list(widgets), layout=layout)

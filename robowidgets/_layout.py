"""Widgets of several topics, side by side."""

from __future__ import annotations

from collections.abc import Sequence

import ipywidgets

WIDE = {"flex_flow": "row wrap", "align_items": "flex-start", "width": "100%"}
"""Layout of a box that holds columns."""

_COLUMNS = {"wide": "2 1 460px", "narrow": "1 1 340px", "map": "1 1 340px"}
"""How the columns share the width, from left to right."""
_WIDEST = "764px"


def columns(widgets: Sequence[ipywidgets.Widget]) -> list[ipywidgets.VBox]:
    """Widgets in their columns, one under the other.

    Where room is short, the map stands below the others, over the whole width, then beside the narrow column.
    """
    each = {name: [widget for widget in widgets if widget.column == name] for name in _COLUMNS}
    return [_column(name, found) for name, found in each.items() if found]


def _column(name: str, widgets: Sequence[ipywidgets.Widget]) -> ipywidgets.VBox:
    limits = {"max_width": _WIDEST} if name == "wide" else {}
    layout = ipywidgets.Layout(flex=_COLUMNS[name], min_width="min(100% - 8px, 300px)", margin="0 4px", **limits)
    box = ipywidgets.VBox(list(widgets), layout=layout)
    box.add_class(f"rw-{name}-column")
    return box

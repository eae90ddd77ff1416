"""Widgets of several topics, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ipywidgets

WIDE = {"flex_flow": "row wrap", "align_items": "flex-start", "width": "100%"}
"""Layout of a box that holds columns."""

UNDER_MAIN = 3
"""Small widgets that fit into one row under the main ones: usually speeds, touches and the path."""

_COLUMNS = {"wide": "2 1 460px", "narrow": "1 1 340px", "map": "1 1 340px"}
"""How the columns share the width, from left to right."""
_WIDEST = "764px"


class Together(ipywidgets.Box):  # type: ignore[misc]  # ipywidgets has no types
    """Widgets side by side, in their columns."""

    def __init__(self, widgets: Sequence[ipywidgets.Widget]) -> None:
        self._widgets = list(widgets)
        super().__init__(columns(widgets), layout=WIDE)

    def _display_(self) -> Any:
        return stacked(self._widgets)


def stacked(widgets: Sequence[ipywidgets.Widget]) -> Any:
    """For marimo, which shows no box of ipywidgets and asks a view for this: its widgets in a stack of marimo's own."""
    from marimo import vstack  # only marimo asks

    return vstack(widgets)


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


def on_one_screen(
    main: Sequence[ipywidgets.Widget], wide: Sequence[ipywidgets.Widget], small: Sequence[ipywidgets.Widget]
) -> ipywidgets.Box:
    """Widgets in two columns that share the height of the window; the stylesheet `screen.css` gives places and heights.

    Left stand the main ones, side by side, with up to three small ones in a low row below them, and right the wide
    ones; the other small ones share the width below. Without main ones the wide ones stand left, and all small ones
    right. On a narrow page the columns stand one above the other, the wide ones first. The view around the box has the
    class ``rw-one-screen``.
    """
    if not main:
        return _box("rw-screen", *_boxes("rw-wides", wide), *_boxes("rw-smalls", small))
    left = _box("rw-whole", *_boxes("rw-mains", main), *_boxes("rw-smalls", small[:UNDER_MAIN]))
    return _box("rw-screen", left, *_boxes("rw-wides", wide), *_boxes("rw-below", small[UNDER_MAIN:]))


def _box(name: str, *children: ipywidgets.Widget) -> ipywidgets.Box:
    box = ipywidgets.Box(children)
    box.add_class(name)
    return box


def _boxes(name: str, children: Sequence[ipywidgets.Widget]) -> list[ipywidgets.Box]:
    """A box with a class; none without children."""
    return [_box(name, *children)] if children else []

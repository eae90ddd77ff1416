"""Widgets of several topics, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ipywidgets

from ..kinds.choice import ROW_COLUMNS

WIDE = {"flex_flow": "row wrap", "align_items": "flex-start", "width": "100%"}
"""Layout of a box that holds columns."""

UNDER_MAIN = 3
"""The number of small widgets in one row below the main ones: usually speeds, touches and the path."""

_COLUMNS = {"wide": "2 1 460px", "narrow": "1 1 340px", "map": "1 1 340px"}
"""The shares of the columns in the width, from left to right."""
_WIDEST = "764px"


class Together(ipywidgets.Box):  # type: ignore[misc]  # ipywidgets has no types
    """Widgets side by side, in their columns."""

    def __init__(self, widgets: Sequence[ipywidgets.Widget]) -> None:
        self._widgets = list(widgets)
        super().__init__(columns(widgets), layout=WIDE)

    def _display_(self) -> Any:
        return stacked(self._widgets)


def stacked(widgets: Sequence[ipywidgets.Widget]) -> Any:
    """Return the widgets of a view in a stack of marimo, which calls this because it cannot show these boxes."""
    from marimo import vstack  # only marimo calls this

    return vstack(widgets)


def columns(widgets: Sequence[ipywidgets.Widget]) -> list[ipywidgets.VBox]:
    """Return boxes for the columns of widgets.

    On a narrow page, the map moves below the others, with the whole width, or next to the narrow column.
    """
    each = {name: [widget for widget in widgets if widget.column == name] for name in _COLUMNS}
    return [_column(name, found) for name, found in each.items() if found]


def _column(name: str, widgets: Sequence[ipywidgets.Widget]) -> ipywidgets.VBox:
    limits = {"max_width": _WIDEST} if name == "wide" else {}
    layout = ipywidgets.Layout(flex=_COLUMNS[name], min_width="min(100% - 8px, 300px)", margin="0 4px", **limits)
    box = ipywidgets.VBox(list(widgets), layout=layout)
    box.add_class(f"rw-{name}-column")
    return box


class OneScreen(ipywidgets.Box):  # type: ignore[misc]  # ipywidgets has no types
    """Widgets in two columns that share the height of the window. The stylesheet `screen.css` sets places and heights.

    The left column has the main widgets side by side, with up to three small ones in a low row below them. The right
    column has the wide ones. Other small ones share the width below. Without main widgets the wide ones are on the
    left, and all small ones on the right. On a narrow page the columns are stacked, the wide ones first. The view
    around it has the class ``rw-one-screen``.

    Widgets that are added later fill free room: next to wide ones without a second column, below the only wide one, in
    the rest of the low row, or in a row below. Plots, maps and other wide ones get a row of their own. Existing widgets
    do not move, because their boxes stay the same.
    """

    def __init__(self) -> None:
        names = ("whole", "mains", "smalls", "wides", "below")
        self._boxes = {name: ipywidgets.Box() for name in names}
        for name, box in self._boxes.items():
            box.add_class(f"rw-{name}")
        super().__init__()
        self.add_class("rw-screen")

    def arrange(
        self,
        main: Sequence[ipywidgets.Widget],
        wide: Sequence[ipywidgets.Widget],
        small: Sequence[ipywidgets.Widget],
        added: Sequence[ipywidgets.Widget] = (),
    ) -> None:
        """Put widgets in their places."""
        rows = [widget for widget in added if widget.column in ROW_COLUMNS]
        more = [widget for widget in added if widget not in rows]
        if not main:
            # A single laser leaves room for the picture of a camera on its right.
            beside = rows[:1] if wide and not (small or more) else []
            right = [*small, *more, *beside]
            places = {"mains": [], "wides": [*wide], "smalls": right, "below": rows[len(beside) :]}
        else:
            under = len(wide) == 1 and bool(more)
            low = [*small[:UNDER_MAIN], *more[under : under + max(0, UNDER_MAIN - len(small))]]
            rest = [widget for widget in more[under:] if widget not in low]
            places = {
                "mains": [*main],
                "smalls": low,
                "wides": [*wide, *more[:under]],
                "below": [*small[UNDER_MAIN:], *rest, *rows],
            }
        boxes = self._boxes
        for name, widgets in places.items():
            boxes[name].children = widgets
        filled = {name: [boxes[name]] if widgets else [] for name, widgets in places.items()}
        boxes["whole"].children = [*filled["mains"], *filled["smalls"]] if main else []
        columns = [boxes["whole"], *filled["wides"]] if main else [*filled["wides"], *filled["smalls"]]
        self.children = [*columns, *filled["below"]]

    def close(self) -> None:
        """Close it and its boxes, but not the widgets in them."""
        for box in self._boxes.values():
            box.layout.close()
            box.close()
        self.layout.close()
        super().close()

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


_ROWS = ("wide", "map")
"""Columns of which a widget that was added has a row of its own."""


def added_classes(column: str) -> list[str]:
    """The classes of a widget that is added to a screen.

    It has them from the start: in the page, the view of a widget that is new misses what is said soon after.
    """
    return ["rw-added", *(["rw-added-row"] if column in _ROWS else [])]


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


class OneScreen(ipywidgets.Box):  # type: ignore[misc]  # ipywidgets has no types
    """Widgets in two columns that share the height of the window; the stylesheet `screen.css` gives places and heights.

    Left stand the main ones, side by side, with up to three small ones in a low row below them, and right the wide
    ones; the other small ones share the width below. Without main ones the wide ones stand left, and all small ones
    right. On a narrow page the columns stand one above the other, the wide ones first. The view around it has the
    class ``rw-one-screen``.

    What was added since takes the room that is left: beside wide ones that stand alone, below the only wide one, the
    rest of the low row, or a row below; plots, maps and what else is wide have a row of their own. Nothing that is
    there moves for it, as its box stays the same.
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
        """Give widgets their places."""
        rows = [widget for widget in added if widget.column in _ROWS]
        more = [widget for widget in added if widget not in rows]
        if not main:
            # Beside a laser alone is room for the picture of a camera.
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
        """Close it and its boxes, and leave what is in them."""
        for box in self._boxes.values():
            box.layout.close()
            box.close()
        self.layout.close()
        super().close()

"""One widget that holds others: the page lays them out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import traitlets

from .widget.front_end import FrontEndWidget, bundle


def rooms_of(places: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Return the widgets for the page, from top to bottom: place, model, and the classes and style set in Python."""
    return [
        {
            "place": place,
            "widget": f"anywidget:{widget.model_id}",
            "classes": list(widget._dom_classes),
            "style": _style(widget.layout),
        }
        for place, widgets in places.items()
        for widget in widgets
    ]


def _style(layout: Any) -> dict[str, str]:
    """Return the set properties of a layout, by their names in CSS."""
    names = [name for name in layout.keys if not name.startswith("_")]
    return {name.replace("_", "-"): str(value) for name in names if (value := getattr(layout, name)) is not None}


class ScreenWidget(FrontEndWidget):
    """Widgets on one screen, which the page lays out by their places. A widget that changes its place stays as it is.

    Args:
        kind: "recording" or "feed" for the screens of these, else empty. Words of it become CSS classes of the screen.
        places: the widgets of each place, such as ``{"bar": [player], "wides": [laser]}``, from top to bottom.

    """

    _esm, _css = bundle("screen_widget")

    # Private, so that no observers of users are called under the locks of players and feeds.
    _children = traitlets.Tuple().tag(sync=True, to_json=lambda _children, screen: screen.rooms)
    _notes = traitlets.List(traitlets.Unicode()).tag(sync=True)
    _kind = traitlets.Unicode().tag(sync=True)

    def __init__(self, kind: str = "", places: Mapping[str, Sequence[Any]] | None = None, **kwargs: Any) -> None:
        self._places = places or {}
        super().__init__(_kind=kind, _children=self._all, **kwargs)

    def place(self, places: Mapping[str, Sequence[Any]]) -> None:
        """Show these widgets in these places, and no others. The others are not closed."""
        self._places = places
        if self._children == self._all:
            self.send_state("_children")  # only the places may have changed
        else:
            self._children = self._all

    @property
    def children(self) -> tuple[Any, ...]:
        """All widgets on the screen, from top to bottom."""
        return tuple(self._children)

    @property
    def notes(self) -> list[str]:
        """Lines of plain text, such as problems: above the bar of a recording, below the bar of a feed."""
        return list(self._notes)

    def note(self, lines: Sequence[str]) -> None:
        """Show these lines of plain text."""
        self._notes = list(lines)

    @property
    def rooms(self) -> list[dict[str, Any]]:
        """The children for the page."""
        return rooms_of(self._places)

    @property
    def _all(self) -> tuple[Any, ...]:
        return tuple(widget for widgets in self._places.values() for widget in widgets)

    def close(self) -> None:
        """Remove the screen from the page, without closing the widgets on it."""
        if self.comm is not None:
            self.layout.close()
        super().close()

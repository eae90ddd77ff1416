"""One widget that holds others: the page lays them out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import traitlets

from .widget.cards import as_arrangement, checked_cards
from .widget.front_end import FrontEndWidget, bundle, kind_of
from .widget.in_words import CLOSED, InWords


def _style(layout: Any) -> dict[str, str]:
    """Return the set properties of a layout, by their names in CSS."""
    names = [name for name in layout.keys if not name.startswith("_")]
    return {name.replace("_", "-"): str(value) for name in names if (value := getattr(layout, name)) is not None}


class ScreenWidget(InWords, FrontEndWidget):
    """Widgets on one screen, which the page lays out by their places. A widget that changes its place stays as it is.

    Args:
        kind: "recording" or "feed" for the screens of these, else empty. Words of it become CSS classes of the screen.
        places: the widgets of each place, such as ``{"bar": [player], "wides": [laser]}``, from top to bottom.
        arrangement: the arrangement by hand, or None to arrange the widgets by their places. Its ``"cards"`` are the
            name of a card, or a dictionary with a row or a column of them, such as ``{"row": ["/scan", {"column":
            ["/odom", "/bumper"]}]}``, each with an optional width (its share of the row) and height (pixels). The user
            changes it on the page.

    """

    _esm, _css = bundle("screen_widget")

    _cards = traitlets.Dict().tag(sync=True)
    _entries = traitlets.Tuple().tag(sync=True)
    # Private, so that no observers of users are called under the locks of players and feeds.
    _children = traitlets.Tuple().tag(sync=True, to_json=lambda _children, screen: screen.rooms)
    _notes = traitlets.List(traitlets.Unicode()).tag(sync=True)
    _kind = traitlets.Unicode().tag(sync=True)

    def __init__(
        self, kind: str = "", places: Mapping[str, Sequence[Any]] | None = None, arrangement: Any = None, **kwargs: Any
    ) -> None:
        self._places = places or {}
        self._asked_cards = checked_cards(arrangement)
        super().__init__(_kind=kind, _cards=self._asked_cards, _children=self._all, **kwargs)

    def __repr__(self) -> str:
        return self._in_words() if self.comm is not None else CLOSED

    def _in_words(self) -> str:
        """Return one line on what the screen shows, for its repr."""
        return f"<{type(self).__name__}: {', '.join(room['card'] for room in self.rooms) or 'no widgets'}>"

    def place(self, places: Mapping[str, Sequence[Any]]) -> None:
        """Show these widgets in these places, and no others. The others are not closed."""
        self._places = places
        if self._children == self._all:
            self.send_state("_children")  # only the places may have changed
        else:
            self._children = self._all

    @property
    def kind(self) -> str:
        """The kind that the screen was made with."""
        return self._kind

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
    def arrangement(self) -> Any:
        """The arrangement of the cards by hand, as ``{"cards": ...}``; an empty list if their places decide.

        It can be stored as JSON, and set again or passed to `screen`.
        """
        return as_arrangement(self._cards, [])

    @arrangement.setter
    def arrangement(self, value: Any) -> None:
        self._cards = checked_cards(value)

    @property
    def rooms(self) -> list[dict[str, Any]]:
        """The children for the page."""
        return self.rooms_of(self._places)

    def rooms_of(self, places: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
        """Return widgets for the page, from top to bottom: place, model, name, and the classes and style set in Python.

        The names are for an arrangement by hand, and no two widgets have the same.
        """
        rooms: list[dict[str, Any]] = []
        taken: set[str] = set()
        for place, widgets in places.items():
            for widget in widgets:
                kind = kind_of(widget)
                name = plain = self.card_name(widget, kind)
                number = 1
                while name in taken:
                    number += 1
                    name = f"{plain} {number}"
                taken.add(name)
                rooms.append(
                    {
                        "place": place,
                        "widget": f"anywidget:{widget.model_id}",
                        "card": name,
                        "kind": kind,
                        "classes": list(widget._dom_classes),
                        "style": _style(widget.layout),
                    }
                )
        return rooms

    def card_name(self, widget: Any, kind: str) -> str:
        """Return the name of a widget in an arrangement by hand: its title, or the name of its kind."""
        return getattr(widget, "title", "") or kind

    @property
    def _all(self) -> tuple[Any, ...]:
        return tuple(widget for widgets in self._places.values() for widget in widgets)

    def keep_cards(self, earlier: ScreenWidget) -> None:
        """Take over the user's arrangement from an earlier screen of the cell, if both were made with the same one."""
        if self._asked_cards == earlier._asked_cards:
            self._cards = earlier._cards

    def close(self) -> None:
        """Remove the screen from the page, without closing the widgets on it."""
        if self.comm is not None:
            self.layout.close()
        super().close()

"""The places of several widgets on a screen."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ..kinds.choice import ROW_COLUMNS

UNDER_MAIN = 3
"""The number of small widgets in one row below the main ones: usually speeds, touches and the path."""

COLUMNS = ("wide", "narrow", "map")
"""The names of columns, from left to right."""

ScreenPlaces = dict[str, list[Any]]
"""The widgets of each place of a screen."""


def in_columns(widgets: Iterable[Any]) -> ScreenPlaces:
    """Return the places of widgets in columns.

    On a narrow page, the map moves below the others, with the whole width, or next to the narrow column.
    """
    places: ScreenPlaces = {name: [] for name in COLUMNS}
    for widget in widgets:
        places[getattr(widget, "column", "wide")].append(widget)
    return places


def on_one_screen(
    main: Sequence[Any], wide: Sequence[Any], small: Sequence[Any], added: Sequence[Any] = ()
) -> ScreenPlaces:
    """Return the places of widgets that share the height of the window. The stylesheet `screen.css` sets the heights.

    The left column has the main widgets side by side, with up to three small ones in a low row below them. The right
    column has the wide ones. Other small ones share the width below. Without main widgets the wide ones are on the
    left, and all small ones on the right. On a narrow page the columns are stacked, the wide ones first.

    Widgets that are added later fill free room: next to wide ones without a second column, below the only wide one, in
    the rest of the low row, or in a row below. Plots, maps and other wide ones get a row of their own.
    """
    rows = [widget for widget in added if widget.column in ROW_COLUMNS]
    more = [widget for widget in added if widget not in rows]
    if not main:
        # A single laser leaves room for the picture of a camera on its right.
        beside = rows[:1] if wide and not (small or more) else []
        return {"wides": [*wide], "smalls": [*small, *more, *beside], "below": rows[len(beside) :]}
    under = len(wide) == 1 and bool(more)
    low = [*small[:UNDER_MAIN], *more[under : under + max(0, UNDER_MAIN - len(small))]]
    rest = [widget for widget in more[under:] if widget not in low]
    return {
        "mains": [*main],
        "smalls": low,
        "wides": [*wide, *more[:under]],
        "below": [*small[UNDER_MAIN:], *rest, *rows],
    }

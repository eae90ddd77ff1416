"""The widgets of a recording on one screen; the stylesheet of the player gives the boxes their places and heights."""

from __future__ import annotations

from collections.abc import Sequence

import ipywidgets

UNDER_SCANOGRAM = 3
"""Small widgets that fit under a scanogram, one beside the other: usually speeds, touches and the path."""


def on_one_screen(scanogram: ipywidgets.Widget | None, widgets: Sequence[ipywidgets.Widget]) -> ipywidgets.Box:
    """The widgets in two columns that share the height of the window.

    Left the scanogram with up to three small widgets below it, right those of the wide column; the other small ones
    share the width below. Without a scanogram the wide widgets stand left, and all small ones right. On a narrow page
    the columns stand one above the other, the wide widgets first.
    """
    wide = [widget for widget in widgets if widget.column == "wide"]
    small = [widget for widget in widgets if widget.column != "wide"]
    if scanogram is None:
        return _box("rw-screen", *_box("rw-wides", *wide), *_box("rw-smalls", *small))[0]
    left = _box("rw-whole", scanogram, *_box("rw-smalls", *small[:UNDER_SCANOGRAM]))
    return _box("rw-screen", *left, *_box("rw-wides", *wide), *_box("rw-below", *small[UNDER_SCANOGRAM:]))[0]


def _box(name: str, *children: ipywidgets.Widget) -> list[ipywidgets.Box]:
    """A box with a class; none without children."""
    if not children:
        return []
    box = ipywidgets.Box(children)
    box.add_class(name)
    return [box]

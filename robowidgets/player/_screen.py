"""The widgets of a recording on one screen; the stylesheet of the player gives the boxes their places and heights."""

from __future__ import annotations

from collections.abc import Sequence

import ipywidgets


def on_one_screen(scanogram: ipywidgets.Widget | None, widgets: Sequence[ipywidgets.Widget]) -> ipywidgets.Box:
    """The widgets in two columns that share the height of the window.

    Left the scanogram with the small widgets below it, right the ``wide`` widgets. Without a scanogram the wide widgets
    stand left. On a narrow page the columns stand one above the other, the wide widgets first.
    """
    wide = [widget for widget in widgets if widget.wide]
    small = _box("rw-smalls", *(widget for widget in widgets if not widget.wide))
    if scanogram is None:
        return _box("rw-screen", *_box("rw-wides", *wide), *small)[0]
    return _box("rw-screen", *_box("rw-whole", scanogram, *small), *_box("rw-wides", *wide))[0]


def _box(name: str, *children: ipywidgets.Widget) -> list[ipywidgets.Box]:
    """A box with a class; none without children."""
    if not children:
        return []
    box = ipywidgets.Box(children)
    box.add_class(name)
    return [box]

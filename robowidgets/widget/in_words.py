"""The text of an output of a cell, for readers without a page: what its widgets show, and how to get a picture."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

HOW_TO_DRAW = "No page has drawn it yet: run the cell in JupyterLab and save the notebook to have a picture here."
"""The last line of the text. A page that draws the widget replaces the text."""

CLOSED = "this widget is closed: make a new one"
"""The text of a closed widget, which no page can draw."""


class InWords:
    """A widget or a view of several whose output has a text with one line for each widget.

    It stands before a class of ipywidgets in the bases of a class.
    """

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        made = super()._repr_mimebundle_(**kwargs)  # type: ignore[misc]
        data = made[0] if isinstance(made, tuple) else made
        if data is not None:
            data["text/plain"] = "\n".join([*_lines(self), HOW_TO_DRAW])
        return made


def _lines(widget: Any) -> Iterator[str]:
    """Yield the text of a widget, and the texts of the widgets in it."""
    if isinstance(widget, InWords):
        yield repr(widget)
    for child in getattr(widget, "children", ()):
        yield from _lines(child)

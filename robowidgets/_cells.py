"""What a cell of a notebook made goes when the cell is run again: its output is replaced then.

ipywidgets keeps every widget until it is closed, and IPython what a cell gave: none of it would go by itself.
"""

from __future__ import annotations

import sys
from typing import Any, Protocol
from weakref import WeakSet


class Closable(Protocol):
    """What can be closed, again too."""

    def close(self) -> None:
        """Let go of all that it holds."""


_made: dict[str, tuple[str, WeakSet[Any]]] = {}
"""By cell: its last run that made something, and what that made."""


def take_the_place(made: Closable) -> None:
    """Close what earlier runs of the running cell made, in the place of which something stands now.

    Nothing where no cell runs, or where the notebook does not say which one it is.
    """
    cell, run = _running()
    if not cell:
        return
    last, there = _made.get(cell, (run, WeakSet()))
    if last != run:
        for earlier in list(there):
            earlier.close()
        there = WeakSet()
    there.add(made)
    _made[cell] = run, there


def close_all(widget: Any) -> None:
    """Close a widget with all that is in it; again does nothing."""
    for inner in getattr(widget, "children", ()):
        close_all(inner)
    for own in (widget.layout, getattr(widget, "style", None)):
        if own is not None:
            own.close()
    widget.close()


def _running() -> tuple[str, str]:
    """Names of the cell that runs and of this run of it; empty where nobody tells."""
    ipython = sys.modules.get("IPython")
    shell = ipython and ipython.get_ipython()
    request: dict[str, Any] = getattr(shell, "get_parent", dict)()
    return request.get("metadata", {}).get("cellId", ""), request.get("header", {}).get("msg_id", "")

"""What a cell of a notebook made goes when the cell is run again: its output is replaced then.

ipywidgets keeps every widget until it is closed, and IPython what a cell gave: none of it would go by itself.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, Protocol
from weakref import WeakSet

from .platform_fixes import call_on_interrupt


class Closable(Protocol):
    """What can be closed, again too."""

    def close(self) -> None:
        """Let go of all that it holds."""


_made: dict[str, tuple[str, WeakSet[Any]]] = {}
"""By cell: its last run that made something, and what that made."""


def take_the_place(made: Closable) -> list[Any]:
    """Close what earlier runs of the running cell made, and return it; something else stands in its place now.

    Nothing where no cell runs, or where the notebook does not say which one it is.
    """
    cell, run = running_cell()
    if not cell:
        return []
    last, there = _made.get(cell, (run, WeakSet()))
    closed = list(there) if last != run else []
    for earlier in closed:
        earlier.close()
    if closed:
        there = WeakSet()
    there.add(made)
    _made[cell] = run, there
    return closed


_on_failed: list[Callable[[], None]] = []


def on_failed_cell(call: Callable[[], None]) -> None:
    """Call a function when this cell or a later one is interrupted or raises; nothing outside cells.

    It is called in the main thread, perhaps in the handler of a signal, so it must wait for nothing. To be called from
    every cell of the main thread that wants it.
    """
    shell = _shell()
    if shell is None:
        return
    if call not in _on_failed:
        if not _on_failed:
            shell.events.register("post_run_cell", _after_cell)
        _on_failed.append(call)
    if hasattr(shell, "kernel"):
        call_on_interrupt(_call_all)


def _after_cell(result: Any) -> None:
    if not result.success:
        _call_all()


def _call_all() -> None:
    for call in _on_failed:
        call()


def close_all(widget: Any) -> None:
    """Close a widget with all that is in it; again does nothing."""
    for inner in getattr(widget, "children", ()):
        close_all(inner)
    for own in (widget.layout, getattr(widget, "style", None)):
        if own is not None:
            own.close()
    widget.close()


def running_cell() -> tuple[str, str]:
    """Names of the cell that runs and of this run of it; empty where nobody tells."""
    request: dict[str, Any] = getattr(_shell(), "get_parent", dict)()
    return request.get("metadata", {}).get("cellId", ""), request.get("header", {}).get("msg_id", "")


def _shell() -> Any:
    ipython = sys.modules.get("IPython")
    return ipython and ipython.get_ipython()

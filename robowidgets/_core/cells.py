"""Cleaning up after notebook cells: closes the widgets that an earlier run of the same cell created.

ipywidgets keeps every widget until it is closed, and IPython keeps the results of cells, so neither is freed by itself.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, Protocol
from weakref import WeakSet

from .error_routing import ipython_shell
from .platform_fixes import call_before_traceback, call_on_idle_interrupt, call_on_interrupt

log = logging.getLogger("robowidgets")


class Closable(Protocol):
    """An object with an idempotent `close`."""

    def close(self) -> None:
        """Release all resources."""


_made: dict[str, tuple[str, WeakSet[Any]]] = {}
"""By the id of a cell: the last run that created something, and the objects that it created."""


def take_the_place(made: Closable) -> list[Any]:
    """Register an object of the running cell, and close those of the cell's earlier runs; returns the closed ones.

    Does nothing when no cell runs, or when the notebook does not identify its cells.
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
    """Call a function when this cell or a later one is interrupted or raises; does nothing outside cells.

    The main thread calls it, perhaps in a signal handler, so it must not wait. Each cell that wants this must register
    it again, from the main thread.
    """
    shell = ipython_shell()
    if shell is None:
        return
    if call not in _on_failed:
        if not _on_failed:
            shell.events.register("post_run_cell", _after_cell)
            call_before_traceback(shell, _call_on_failed)
        _on_failed.append(call)
    if hasattr(shell, "kernel"):
        call_on_interrupt(_interrupted)


_on_interrupt: list[Callable[[], None]] = []


def on_interrupt(call: Callable[[], None]) -> None:
    """Call a function whenever the kernel is interrupted: in this cell, in a later one, and between cells.

    The main thread calls it in a signal handler, so it must not wait. Does nothing outside a kernel; there an interrupt
    ends the program, and the robot gets zero.
    """
    shell = ipython_shell()
    if shell is None or not hasattr(shell, "kernel"):
        return
    if not _on_interrupt:
        shell.events.register("pre_run_cell", lambda _info: call_on_interrupt(_interrupted))
    if call not in _on_interrupt:
        _on_interrupt.append(call)
    call_on_interrupt(_interrupted)
    call_on_idle_interrupt(shell.kernel, _interrupted)


def _interrupted() -> None:
    for call in (*_on_failed, *_on_interrupt):
        _attempt(call)


def _after_cell(result: Any) -> None:
    if not result.success:
        _call_on_failed()


def _call_on_failed() -> None:
    for call in _on_failed:
        _attempt(call)


def _attempt(call: Callable[[], None]) -> None:
    """Call it, and log its error: the other calls must follow, and then the user's own error or interrupt."""
    try:
        call()
    except Exception as error:
        log.exception("a robot may drive on, as it could not be stopped: %s", error)


def close_all(widget: Any) -> None:
    """Close a widget with everything in it; doing it again does nothing."""
    for inner in getattr(widget, "children", ()):
        close_all(inner)
    for own in (widget.layout, getattr(widget, "style", None)):
        if own is not None:
            own.close()
    widget.close()


def running_cell() -> tuple[str, str]:
    """The ids of the running cell and of this run; empty where the notebook sends none."""
    request: dict[str, Any] = getattr(ipython_shell(), "get_parent", dict)()
    return request.get("metadata", {}).get("cellId", ""), request.get("header", {}).get("msg_id", "")

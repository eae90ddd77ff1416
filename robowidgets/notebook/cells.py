"""Cleaning up after notebook cells: closes the widgets that an earlier run of the same cell created.

ipywidgets keeps every widget until it is closed, and IPython keeps the results of cells, so neither is freed by itself.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterable
from typing import Any, Protocol
from weakref import WeakKeyDictionary

from ..runtime.error_routing import called_from_cell, ipython_shell
from ..runtime.platform_fixes import call_before_traceback, call_on_idle_interrupt, call_on_interrupt

log = logging.getLogger("robowidgets")


class Closable(Protocol):
    """An object with an idempotent `close`."""

    def close(self) -> None:
        """Release all resources."""


Objects = WeakKeyDictionary[Any, None]
"""Objects in the order of their creation."""

_made: dict[str, tuple[str, Objects, Objects]] = {}
"""By the id of a cell: the last run that created something, the objects that it created, and the closed objects of the
run before, without those that `predecessor` has returned."""


def take_the_place(made: Closable) -> Objects:
    """Register an object of the running cell, and close the objects of the cell's earlier run.

    Does nothing if no cell runs, or if the notebook does not identify its cells.

    Returns:
        The closed objects, without those that `predecessor` has returned.
    """
    cell, run = running_cell()
    if not cell:
        return WeakKeyDictionary()
    last, there, closed = _made.get(cell, (run, WeakKeyDictionary(), WeakKeyDictionary()))
    if last != run:
        closed, there = there, WeakKeyDictionary()
        for earlier in list(closed):
            earlier.close()
    there[made] = None
    _made[cell] = run, there, closed
    return closed


def predecessor(made: Closable, kind: type) -> Any:
    """Do what `take_the_place` does, and return the closed object that this one replaces.

    Returns:
        The first one of the class that no other object of this run has replaced, or None.
    """
    closed = take_the_place(made)
    found = next((one for one in list(closed) if isinstance(one, kind)), None)
    if found is not None:
        del closed[found]
    return found


_on_failed: list[Callable[[], None]] = []


def on_failed_cell(call: Callable[[], None]) -> None:
    """Call a function when this cell or a later one is interrupted or raises; does nothing outside cells.

    The main thread calls it, perhaps in a signal handler, so it must not wait. Each cell that wants this must register
    it again, from the main thread.
    """
    shell = ipython_shell()
    if shell is None:
        return
    _listen(shell)
    if call not in _on_failed:
        _on_failed.append(call)
    if hasattr(shell, "kernel"):
        call_on_interrupt(_interrupted)


CellRun = tuple[str, str]
"""The ids of a cell and of one of its runs; empty if the notebook sends no ids."""

_on_cell_error: list[Callable[[CellRun], Iterable[str]]] = []


def on_cell_error(call: Callable[[CellRun], Iterable[str]]) -> None:
    """Call a function whenever a cell ends with an error, a syntax error too, but not when it is interrupted.

    It is called before IPython shows the traceback, in the main thread, so it must not wait; and once more after that:
    the lines that it returns then are printed below the traceback. Does nothing outside cells.
    """
    shell = ipython_shell()
    if shell is None:
        return
    _listen(shell)
    if call not in _on_cell_error:
        _on_cell_error.append(call)


_on_interrupt: list[Callable[[], None]] = []


def on_interrupt(call: Callable[[], None]) -> None:
    """Call a function whenever the kernel is interrupted: in this cell, in a later one, and between cells.

    The main thread calls it in a signal handler, so it must not wait. Does nothing outside a kernel: an interrupt ends
    the program then, and the robot gets zero.
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


_listened: list[Any] = []
"""The shell whose cells are watched."""
_shown: set[CellRun] = set()
"""The run whose error is already shown. The error of a script counts too, although it does not end the cell."""


def _listen(shell: Any) -> None:
    if shell not in _listened:
        _listened[:] = [shell]
        shell.events.register("post_run_cell", _after_cell)
        call_before_traceback(shell, _before_traceback)


def _before_traceback() -> None:
    for call in _on_failed:
        _attempt(call)
    if called_from_cell() and not _is_interrupt(sys.exc_info()[1]):
        _shown.add(running_cell())
        _call_on_cell_error()


def _after_cell(result: Any) -> None:
    if not result.success:
        for call in _on_failed:
            _attempt(call)
    error = result.error_before_exec or result.error_in_exec
    if running_cell() in _shown or (error is not None and not _is_interrupt(error)):
        for line in _call_on_cell_error():
            print(line)  # noqa: T201  # below the traceback, even if the program sends its log elsewhere
    _shown.clear()


def _is_interrupt(error: BaseException | None) -> bool:
    import asyncio  # Imported lazily: a guard may not need it, and must start soon.

    # CancelledError: an interrupt of a cell with ``await``.
    return isinstance(error, (KeyboardInterrupt, asyncio.CancelledError))


def _call_on_cell_error() -> list[str]:
    lines: list[str] = []
    for call in _on_cell_error:
        _attempt(lambda call=call: lines.extend(call(running_cell())))  # type: ignore[misc]
    return lines


def _attempt(call: Callable[[], None]) -> None:
    """Call a function, and log its error: the other functions must follow, and then the user's error or interrupt."""
    try:
        call()
    except Exception as error:
        log.exception("a robot may drive on, as it could not be stopped: %s", error)


def close_all(widget: Any) -> None:
    """Close a widget with everything in it. Calling it again does nothing."""
    for inner in getattr(widget, "children", ()):
        close_all(inner)
    for own in (widget.layout, getattr(widget, "style", None)):
        if own is not None:
            own.close()
    widget.close()


def running_cell() -> CellRun:
    """The running cell."""
    request: dict[str, Any] = getattr(ipython_shell(), "get_parent", dict)()
    return request.get("metadata", {}).get("cellId", ""), request.get("header", {}).get("msg_id", "")


class CellNote:
    """A line below a cell, once in each of its runs.

    Nothing is printed if the call does not come from a cell, or if the notebook does not identify its cells: in
    scripts, and in notebooks that run without a user.
    """

    def __init__(self) -> None:
        self._last: CellRun = ("", "")

    def print(self, line: Callable[[], str]) -> None:
        """Call a function and print the line that it returns, at the first call in this run."""
        run = running_cell()
        if not run[0] or run == self._last or not called_from_cell():
            return
        self._last = run
        print(line())  # noqa: T201


def name_in_cells(value: Any, otherwise: str) -> str:
    """Return the name of a value in the cells of the notebook, or another text if it has no name."""
    names: dict[str, Any] = getattr(ipython_shell(), "user_ns", {})
    return next((name for name, known in list(names.items()) if known is value and name[0] != "_"), otherwise)


def is_same_cell(one: CellRun, other: CellRun) -> bool:
    """Return True if two runs are known to be of the same cell."""
    return any(a == b != "" for a, b in zip(one, other, strict=True))

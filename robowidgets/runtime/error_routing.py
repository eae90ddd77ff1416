"""Detection of calls from a cell, whose errors the user sees; the errors of callbacks would get lost."""

from __future__ import annotations

import sys
import threading
from types import FrameType
from typing import Any

_CELLS = "IPython.core.interactiveshell"


def ipython_shell() -> Any:
    """Return the shell of IPython that runs cells, or None elsewhere.

    Hosts without cells, such as Solara, have substitutes for the shell, each with other parts of it. They do not count.
    """
    cells: Any = sys.modules.get(_CELLS)
    shell = cells and sys.modules["IPython"].get_ipython()
    return shell if cells and isinstance(shell, cells.InteractiveShell) else None


def called_from_cell() -> bool:
    """Return True if a call comes from a cell or, outside notebooks, from the main thread.

    In a notebook the main thread also runs the event loop, with tasks, timers and buttons, between cells and while a
    cell awaits.
    """
    if ipython_shell() is None:
        return threading.current_thread() is threading.main_thread()
    return _is_in_a_cell(sys._getframe())


def cell_is_running() -> bool:
    """Return True if the main thread is running a cell, and False while the cell awaits something."""
    return _is_in_a_cell(sys._current_frames().get(threading.main_thread().ident or 0))


def _is_in_a_cell(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_globals.get("__name__") == _CELLS:
            return True
        frame = frame.f_back
    return False

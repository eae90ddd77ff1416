"""Telling calls from a cell, whose errors a person reads, from callbacks, whose errors nobody would see."""

from __future__ import annotations

import sys
import threading
from types import FrameType
from typing import Any

_CELLS = "IPython.core.interactiveshell"


def ipython_shell() -> Any:
    """The shell of IPython that runs cells; None elsewhere.

    What a host without cells has in its place, as Solara does, is none: each has other parts of it.
    """
    cells: Any = sys.modules.get(_CELLS)
    shell = cells and sys.modules["IPython"].get_ipython()
    return shell if cells and isinstance(shell, cells.InteractiveShell) else None


def called_from_cell() -> bool:
    """Whether a call comes from a cell; without cells, whether it comes from the main thread.

    In a notebook the main thread also runs the event loop, with tasks, timers and buttons between and beside the cells.
    """
    if ipython_shell() is None:
        return threading.current_thread() is threading.main_thread()
    return _is_in_a_cell(sys._getframe())


def cell_is_running() -> bool:
    """Whether the main thread is running a cell; False while the cell awaits something."""
    return _is_in_a_cell(sys._current_frames().get(threading.main_thread().ident or 0))


def _is_in_a_cell(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_globals.get("__name__") == _CELLS:
            return True
        frame = frame.f_back
    return False

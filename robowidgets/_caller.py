"""Who calls: a person, who reads the error, or a callback, which an error would end unseen."""

from __future__ import annotations

import sys
import threading

_CELLS = "IPython.core.interactiveshell"


def is_a_person() -> bool:
    """Whether a call comes from a cell; where there are no cells, from the main thread.

    In a notebook the main thread also runs the event loop, with tasks, timers and buttons between and beside the cells.
    """
    ipython = sys.modules.get("IPython")
    if ipython is None or ipython.get_ipython() is None:
        return threading.current_thread() is threading.main_thread()
    frame = sys._getframe()
    while frame.f_back is not None:
        frame = frame.f_back
        if frame.f_globals.get("__name__") == _CELLS:
            return True
    return False

"""Who calls: a person, who reads the error, or a callback, which an error would end unseen."""

from __future__ import annotations

import sys
import threading

_CELLS = "IPython.core.interactiveshell"


def is_a_person() -> bool:
    """Whether a call comes from a cell or a script.

    Not from another thread; and in a notebook not from the event loop, where tasks, timers and buttons run between and
    beside the cells.
    """
    if threading.current_thread() is not threading.main_thread():
        return False
    ipython = sys.modules.get("IPython")
    if ipython is None or ipython.get_ipython() is None:
        return True
    frame = sys._getframe()
    while frame.f_back is not None:
        frame = frame.f_back
        if frame.f_globals.get("__name__") == _CELLS:
            return True
    return False

"""Hints about arguments that are valid but probably not meant."""

from __future__ import annotations

import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_OURS = __name__.partition(".")[0]
_of_thread = threading.local()


def give_hint(text: str, **values: Any) -> None:
    """Pass a hint to the `hearing` function of this thread, or else warn, once for each line of the user.

    Python shows a warning once for each line, but IPython forgets this with every message from a page, while programs
    run. In threads other than the main one, the lines are kept here.

    Args:
        text: English, as a literal, with fields for `str.format`.
        values: values of the fields.
    """
    take: Callable[..., object] | None = getattr(_of_thread, "take", None)
    if take is not None:
        take(text, **values)
        return
    caller, depth = _caller()
    if caller is None:
        return
    if threading.current_thread() is not threading.main_thread():
        lines: set[tuple[str, int]] = _of_thread.__dict__.setdefault("lines", set())
        line = (caller.f_code.co_filename, caller.f_lineno)
        if line in lines:
            return
        lines.add(line)
    warnings.warn(text.format(**values), stacklevel=depth)


@contextmanager
def hearing(take: Callable[..., object]) -> Iterator[None]:
    """Pass the hints of the calling thread to a function with the parameters of `give_hint`."""
    _of_thread.take = take
    try:
        yield
    finally:
        _of_thread.take = None


def _caller() -> tuple[FrameType | None, int]:
    """Return the frame that calls robowidgets, and its stack level as `give_hint` passes it to `warnings.warn`.

    Return None for the frame if robowidgets has called itself in a thread of its own.
    """
    frame: FrameType | None = sys._getframe(1)
    depth = 1
    while frame is not None and str(frame.f_globals.get("__name__")).partition(".")[0] == _OURS:
        frame, depth = frame.f_back, depth + 1
    is_threads = frame is not None and frame.f_globals.get("__name__") == threading.__name__
    return None if is_threads else frame, depth

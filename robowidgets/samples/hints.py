"""Hints: what a call may be given, and what is rarely meant by it."""

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
    """Give a hint to who hears those of this thread; else it is a warning, which Python shows once for a line.

    Args:
        text: English, as a literal, with fields as of `str.format`.
        values: of the fields.
    """
    take: Callable[..., object] | None = getattr(_of_thread, "take", None)
    if take is not None:
        take(text, **values)
    else:
        warnings.warn(text.format(**values), stacklevel=_callers_depth())


@contextmanager
def hearing(take: Callable[..., object]) -> Iterator[None]:
    """Pass the hints of the calling thread to a function, which takes what `give_hint` takes."""
    _of_thread.take = take
    try:
        yield
    finally:
        _of_thread.take = None


def _callers_depth() -> int:
    """How far above `give_hint` the line is that calls robowidgets, as `warnings.warn` counts."""
    frame: FrameType | None = sys._getframe(1)
    depth = 1
    while frame is not None and str(frame.f_globals.get("__name__")).partition(".")[0] == _OURS:
        frame, depth = frame.f_back, depth + 1
    return depth

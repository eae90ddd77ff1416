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
    """Pass a hint to the `hearing` function of this thread, or else warn, which Python shows once for each line.

    Args:
        text: English, as a literal, with fields for `str.format`.
        values: values of the fields.
    """
    take: Callable[..., object] | None = getattr(_of_thread, "take", None)
    if take is not None:
        take(text, **values)
    else:
        warnings.warn(text.format(**values), stacklevel=_callers_depth())


@contextmanager
def hearing(take: Callable[..., object]) -> Iterator[None]:
    """Pass the hints of the calling thread to a function with the parameters of `give_hint`."""
    _of_thread.take = take
    try:
        yield
    finally:
        _of_thread.take = None


def _callers_depth() -> int:
    """Return the stack level of the line that calls robowidgets, as `give_hint` passes it to `warnings.warn`."""
    frame: FrameType | None = sys._getframe(1)
    depth = 1
    while frame is not None and str(frame.f_globals.get("__name__")).partition(".")[0] == _OURS:
        frame, depth = frame.f_back, depth + 1
    return depth

"""Telling a user which of their functions, and which line of it, an error or a delay comes from."""

from __future__ import annotations

import difflib
import linecache
import sys
import traceback
from collections.abc import Callable, Iterable
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any

_PACKAGE = str(Path(__file__).parents[1])
_OURS = __name__.partition(".")[0]


def name_of(call: Callable[..., Any]) -> str:
    """The name of a function, for a person."""
    return str(getattr(call, "__qualname__", "") or getattr(call, "__name__", "") or repr(call)[:60])


def line_of(call: Callable[..., Any], frames: Iterable[tuple[FrameType, int]]) -> str:
    """The line of the function's own file in these frames, outermost first, as ``, line 12``; empty without one."""
    call = getattr(call, "func", call)  # a functools.partial has the function in `func`
    code = getattr(call, "__code__", None) or getattr(type(call).__call__, "__code__", None)
    lines = [line for frame, line in frames if code is not None and frame.f_code.co_filename == code.co_filename]
    return f", line {lines[-1]}" if lines else ""


def calling_text() -> str:
    """The text of the cell or the file that calls robowidgets; empty where Python does not have it."""
    frame: FrameType | None = sys._getframe()
    while frame is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame = frame.f_back
    if frame is None:
        return ""
    linecache.checkcache(frame.f_code.co_filename)
    return "".join(linecache.getlines(frame.f_code.co_filename))


def error_in(error: BaseException) -> str:
    """An error that a function of the user raised, with its line: ``line 12: ZeroDivisionError: division by zero``."""
    frames = [(frame.f_code.co_filename, line) for frame, line in traceback.walk_tb(error.__traceback__)]
    own = next((file for file, _ in frames if not file.startswith(_PACKAGE)), None)
    line = next((f"line {line}: " for file, line in reversed(frames) if file == own), "")
    hint = hint_of(error)
    return f"{line}{type(error).__name__}: {error}" + (f"; {hint}" if hint else "")


def hint_of(error: BaseException) -> str:
    """``did you mean 'distance'?`` for a misspelt attribute of an object or a module of ours; else empty."""
    if not isinstance(error, AttributeError) or not error.name or "did you mean" in str(error):
        return ""
    owner = error.obj
    module = owner.__name__ if isinstance(owner, ModuleType) else type(owner).__module__
    if module.partition(".")[0] != _OURS:
        return ""
    near = difflib.get_close_matches(error.name, [name for name in dir(owner) if not name.startswith("_")], n=1)
    return f"did you mean {near[0]!r}?" if near else ""

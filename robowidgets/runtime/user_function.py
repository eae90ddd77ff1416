"""Names and lines of the user's functions, to report the source of an error or a delay."""

from __future__ import annotations

import linecache
import sys
import traceback
from collections.abc import Callable, Iterable
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any

from .text import nearest_name

_PACKAGE = str(Path(__file__).parents[1])
_OURS = __name__.partition(".")[0]


def name_of(call: Callable[..., Any]) -> str:
    """Return the name of a function, for messages."""
    return str(getattr(call, "__qualname__", "") or getattr(call, "__name__", "") or repr(call)[:60])


def line_of(call: Callable[..., Any], frames: Iterable[tuple[FrameType, int]]) -> str:
    """Return the innermost line of the function's file in frames (outermost first) as ``, line 12``, or empty."""
    call = getattr(call, "func", call)  # a functools.partial has the function in `func`
    code = getattr(call, "__code__", None) or getattr(type(call).__call__, "__code__", None)
    lines = [line for frame, line in frames if code is not None and frame.f_code.co_filename == code.co_filename]
    return f", line {lines[-1]}" if lines else ""


def calling_text() -> str:
    """Return the text of the cell or the file that calls robowidgets; empty if Python does not have it."""
    frame: FrameType | None = sys._getframe()
    while frame is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame = frame.f_back
    if frame is None:
        return ""
    linecache.checkcache(frame.f_code.co_filename)
    return "".join(linecache.getlines(frame.f_code.co_filename))


def error_in(error: BaseException) -> str:
    """Return an error of a function of the user as text: ``line 12: ZeroDivisionError: division by zero``.

    It has no line if no line of the user is in the traceback.
    """
    frames = [(frame.f_code.co_filename, line) for frame, line in traceback.walk_tb(error.__traceback__)]
    own = next((file for file, _ in frames if not file.startswith(_PACKAGE)), None)
    line = next((f"line {line}: " for file, line in reversed(frames) if file == own), "")
    say_what_was_meant(error)
    return f"{line}{type(error).__name__}: {error}"


def say_what_was_meant(error: BaseException) -> None:
    """Add "did you mean" to Python's error about a missing attribute of an object, class or module of this package."""
    if not isinstance(error, AttributeError) or not str(error).endswith(f"has no attribute {error.name!r}"):
        return
    of, name = error.obj, str(error.name)
    kind = of if isinstance(of, type) else type(of)
    modules = [of.__name__] if isinstance(of, ModuleType) else [part.__module__ for part in kind.__mro__]
    if _OURS not in (module.partition(".")[0] for module in modules):
        return
    tables = (vars(part).get(table, {}) for part in reversed(kind.__mro__) for table in ("_meant", "_instead"))
    meant = {known: other for table in tables for known, other in table.items()}
    near = meant.get(name) or nearest_name(name, (known for known in dir(of) if not known.startswith("_")))
    if near:
        error.args = (f"{error}; did you mean {near!r}?",)

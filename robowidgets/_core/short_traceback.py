"""Tracebacks in a notebook that end at the user's own line: the text of the error says what to do there."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import TypeVar

_NOT_THE_USER = {__name__.partition(".")[0], "anywidget", "ipywidgets", "traitlets"}
"""Packages whose frames say nothing about a wrong argument."""

E = TypeVar("E", bound=BaseException)


def shortened(error: E) -> E:
    """The same error, of which a notebook shows only the frames of the user's code.

    IPython asks an error for its traceback by the method `_render_traceback_`. Everywhere else, in a log or in a
    debugger, the traceback stays whole.
    """
    error._render_traceback_ = lambda: _render(error)  # type: ignore[attr-defined]
    return error


def _render(error: BaseException) -> list[str]:
    shell = sys.modules["IPython"].get_ipython()
    traceback = _up_to_the_user(error.__traceback__)
    lines: list[str] = shell.InteractiveTB.structured_traceback(type(error), error, traceback)
    return lines


def _up_to_the_user(traceback: TracebackType | None) -> TracebackType | None:
    """A traceback without the frames after the user's last one; whole when all frames are of packages."""
    entries = []
    while traceback is not None:
        entries.append(traceback)
        traceback = traceback.tb_next
    names = [str(entry.tb_frame.f_globals.get("__name__")).partition(".")[0] for entry in entries]
    last = max((i for i, name in enumerate(names) if name not in _NOT_THE_USER), default=len(entries) - 1)
    kept: TracebackType | None = None
    for entry in reversed(entries[: last + 1]):
        kept = TracebackType(kept, entry.tb_frame, entry.tb_lasti, entry.tb_lineno)
    return kept

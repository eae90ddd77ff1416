"""Errors in a notebook: tracebacks that end at the user's line, and hints for wrong names."""

from __future__ import annotations

import dis
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from types import TracebackType
from typing import Any

from .platform_fixes import change_tracebacks
from .user_function import say_what_was_meant

_OURS = __name__.partition(".")[0]
_CHECKS = {_OURS, "anywidget", "ipywidgets", "traitlets"}
"""Packages that check the arguments of a widget."""
_NOT_THE_USER = _CHECKS | sys.stdlib_module_names
"""Packages whose frames say nothing about a wrong argument."""
_RAISE = dis.opmap["RAISE_VARARGS"]


def shorten_tracebacks() -> None:
    """Make IPython, if it is running, hide the frames of this package for errors that it raised.

    The traceback stays whole in a debugger and outside notebooks. Python itself adds a hint for a wrong name, but
    IPython does not, so this adds it.
    """
    change_tracebacks(_shortened)


@contextmanager
def _shortened(error: BaseException, traceback: TracebackType | None) -> Iterator[TracebackType | None]:
    with _shortened_causes(error):
        say_what_was_meant(error)
        yield _of_the_user(traceback)


@contextmanager
def without_our_frames(error: BaseException | None) -> Iterator[Any]:
    """Yield an error for ``exc_info=`` of a log, without the frames of this package in it and in its causes.

    Yields None for None, and if no frames are left, for example after an error about a function's return value.
    """
    traceback = _of_the_user(error.__traceback__) if error is not None else None
    if error is None or traceback is None:
        yield None
        return
    with _shortened_causes(error):
        yield type(error), error, traceback


@contextmanager
def _shortened_causes(error: BaseException) -> Iterator[None]:
    """Shorten the tracebacks of an error's causes, which IPython reads from them, and restore them afterwards."""
    with ExitStack() as stack:
        while error.__cause__ is not None:
            error = error.__cause__
            stack.callback(error.with_traceback, error.__traceback__)
            error.with_traceback(_of_the_user(error.__traceback__))
            say_what_was_meant(error)
        yield


def _of_the_user(traceback: TracebackType | None) -> TracebackType | None:
    """Return a traceback without frames before the user's first frame, and after the user's last one.

    The frames after it are removed only if they are of this package and end at a ``raise``, or at the handler of an
    interrupt. An error that Python or another package raised in them is a bug in this package, so its traceback stays
    whole.
    """
    entries = []
    while traceback is not None:
        entries.append(traceback)
        traceback = traceback.tb_next
    names = [str(entry.tb_frame.f_globals.get("__name__")).partition(".")[0] for entry in entries]
    of_user = [i for i, name in enumerate(names) if name not in _NOT_THE_USER]
    first, last = (of_user[0], of_user[-1]) if of_user else (0, -1)
    if _OURS in names[last + 1 :] and names[-1] in _CHECKS and _is_raise(entries[-1]):
        del entries[last + 1 :]
    del entries[:first]
    kept: TracebackType | None = None
    for entry in reversed(entries):
        kept = TracebackType(kept, entry.tb_frame, entry.tb_lasti, entry.tb_lineno)
    return kept


def _is_raise(entry: TracebackType) -> bool:
    """Return True if the error came from a ``raise``, and not from another instruction, or from an interrupt."""
    frame = entry.tb_frame
    return frame.f_code.co_code[entry.tb_lasti] == _RAISE or "__tracebackhide__" in frame.f_locals

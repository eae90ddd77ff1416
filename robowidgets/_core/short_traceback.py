"""Errors in a notebook: tracebacks that end at the user's own line, and what was meant by a name that nothing has."""

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
    """Have IPython, if it is running, leave out our frames where we raised an error.

    The traceback stays whole in a debugger and outside notebooks. Where Python alone shows an error, it says what was
    meant by a wrong name, which IPython leaves out.
    """
    change_tracebacks(_shortened)


@contextmanager
def _shortened(error: BaseException, traceback: TracebackType | None) -> Iterator[TracebackType | None]:
    with _shortened_causes(error):
        say_what_was_meant(error)
        yield _of_the_user(traceback)


@contextmanager
def without_our_frames(error: BaseException | None) -> Iterator[Any]:
    """An error as a log takes it, ``exc_info=``, without our frames, and what it was raised from.

    None for None, and where nothing is left: we refused what a function of the user returned, say.
    """
    traceback = _of_the_user(error.__traceback__) if error is not None else None
    if error is None or traceback is None:
        yield None
        return
    with _shortened_causes(error):
        yield type(error), error, traceback


@contextmanager
def _shortened_causes(error: BaseException) -> Iterator[None]:
    """Shorten the tracebacks of what an error was raised from, which IPython takes from there, and put them back."""
    with ExitStack() as stack:
        while error.__cause__ is not None:
            error = error.__cause__
            stack.callback(error.with_traceback, error.__traceback__)
            error.with_traceback(_of_the_user(error.__traceback__))
            say_what_was_meant(error)
        yield


def _of_the_user(traceback: TracebackType | None) -> TracebackType | None:
    """A traceback without our frames that called a function of the user, and without those after the user's last one.

    The latter go only if they are ours and end at a ``raise``: an error that Python or another package raised there is
    a fault of ours, and its traceback stays whole.
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
    """Whether the error came from a ``raise``, and not from another instruction."""
    return entry.tb_frame.f_code.co_code[entry.tb_lasti] == _RAISE

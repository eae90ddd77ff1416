"""Functions of the user that a robot waits for, which must not ask for input."""

from __future__ import annotations

import builtins
import getpass
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_NO_INPUT = "input() cannot ask while a robot waits: write the value into the code"


@contextmanager
def without_input() -> Iterator[None]:
    """Make `input` and `getpass` raise in this thread.

    They would wait for the page, which would not run the next cell meanwhile. IPython replaces both functions at each
    cell, so this replaces them only during a call.
    """
    thread = threading.get_ident()
    with _asking:
        _refusing.add(thread)
        for place, name in _ASKING:
            if not isinstance(ask := getattr(place, name), _Refusing):
                setattr(place, name, _Refusing(ask))
    try:
        yield
    finally:
        with _asking:
            _refusing.discard(thread)
            for place, name in _ASKING if not _refusing else ():
                if isinstance(ask := getattr(place, name), _Refusing):
                    setattr(place, name, ask.inner)


class _Refusing:
    """Replaces a function that asks the user: raises in the threads in `_refusing`, and asks in all others."""

    def __init__(self, inner: Any) -> None:
        self.inner = inner

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        if threading.get_ident() in _refusing:
            raise EOFError(_NO_INPUT)
        return self.inner(*args, **kwargs)


_ASKING = ((builtins, "input"), (getpass, "getpass"))
_refusing: set[int] = set()
"""The identifiers of the threads that must not ask."""
_asking = threading.Lock()

"""A program with another function in it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .machine import Machine

Function = Callable[..., Any]


def exchanged(whole: Function, old: Function, new: Function) -> Function:
    """Return the function of a program with another function in it: itself, or a state machine of a changed class.

    Raises:
        LookupError: a state machine has the function from elsewhere, such as an event that is a name in the notebook.
    """
    if not isinstance(whole, Machine):
        return new
    cls = _with(whole.cls, old, new) if type(whole.cls) is type else None
    if cls is None:
        raise LookupError(
            f"{getattr(old, '__name__', 'it')} is not in class {whole.cls.__name__}: change it in its cell"
        )
    return Machine(cls)


def _with(cls: type, old: Function, new: Function) -> type | None:
    """Return a copy of a class with another function in it, in an inner class or in a base, or None without it."""
    body = {name: value for name, value in vars(cls).items() if name not in ("__dict__", "__weakref__")}
    found = False
    for name, value in body.items():
        if value is old or getattr(value, "__func__", None) is old:
            body[name] = new if value is old else type(value)(new)
            found = True
        elif isinstance(value, type) and (inner := _with(value, old, new)) is not None:
            body[name], found = inner, True
    bases = tuple(_with(base, old, new) or base for base in cls.__bases__ if base is not object)
    if not found and bases == tuple(base for base in cls.__bases__ if base is not object):
        return None
    made: type = type(cls)(cls.__name__, bases, {**body, "__qualname__": cls.__qualname__})
    return made

"""The samples that a program asks for, by the names of its parameters."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable, Mapping
from typing import Any

from ..kinds import KINDS, add_installed
from .robot import GIVEN, ODOMETRY


def program_name(function: Callable[..., Any]) -> str:
    """Return the name of a program: the name of its function, or the class of its callable object."""
    function = getattr(function, "func", function)  # a functools.partial has the function in `func`
    return str(getattr(function, "name", "") or getattr(function, "__name__", type(function).__name__))


def parameters_of(function: Callable[..., Any], name: str, topics: Mapping[str, str]) -> tuple[str, ...]:
    """Return the names of the parameters of a function that a program fills.

    Args:
        function: the function, or an object that lists them as ``asks_for``.
        name: the name of the function, for errors.
        topics: by parameter, the topics that the user named.

    Raises:
        TypeError: not a function, a parameter with an unknown name, or a topic for a parameter that does not exist.
    """
    if not callable(function) or isinstance(function, type):
        raise TypeError(f"program: expected a function that returns a Drive, got {function!r}")
    if inspect.iscoroutinefunction(function) or inspect.isgeneratorfunction(function):
        kind = "await" if inspect.iscoroutinefunction(function) else "yield"
        raise TypeError(
            f"program: expected a plain function that returns a Drive at each step; {name}() may {kind}: "
            "let a step return at once, and keep what it has to remember in state"
        )
    add_installed()
    samples = [kind.parameter for kind in KINDS.values()]
    given = (*samples, *GIVEN, *ODOMETRY)
    asked = asked_by(function, name, (*given, *topics))
    for one in asked:
        if one not in (*given, *topics):
            near = difflib.get_close_matches(one, given, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            who = getattr(function, "asking", {}).get(one, f"{name}()")
            raise TypeError(
                f"{who} asks for {one!r}; there are {', '.join(given)}, and any topic that is named: "
                f"@robot.program({one}='/topic'){hint}"
            )
    for one, topic in topics.items():
        if one in GIVEN or one not in asked:
            raise TypeError(f"program: {one}={topic!r} names a topic, but {name}() has no parameter {one!r} for it")
    return tuple(asked)


def asked_by(function: Callable[..., Any], name: str, known: tuple[str, ...]) -> list[str]:
    """Return the parameters of a function that are known or have no default."""
    if hasattr(function, "asks_for"):
        return list(function.asks_for)
    asked = []
    for one in inspect.signature(function).parameters.values():
        if one.kind in (one.VAR_POSITIONAL, one.VAR_KEYWORD, one.POSITIONAL_ONLY):
            raise TypeError(f"{name}(): expected parameters with names, such as scan, got {one}")
        if one.name == "self":
            raise TypeError(f"{name}() takes no self: remove it, and name what it needs, such as scan")
        if one.name in known or one.default is one.empty:
            asked.append(one.name)
    return asked

"""Calls of a function that may hang, raise, or return what it should not."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

from .._core.user_function import error_in, line_of
from .._core.user_threads import UserThread, frames_of

LIMIT_S = 2.0
"""Seconds that one call may take."""


class WrongError(Exception):
    """What is wrong with an answer, in words for the person who wrote it."""


class BrokenError(WrongError):
    """The function gives no answer, or none of the right kind, so that there is no use in trying other cases."""


def call(function: Callable[..., Any], sample: Any) -> Any:
    """What a function returns for a sample.

    Raises:
        BrokenError: it raised, it returned None, or it took too long.
    """
    returned = bounded(function)(sample)
    if returned is None:
        raise BrokenError("it returned None: does it end with a return, on every way through it?")
    return returned


def bounded(function: Callable[..., Any]) -> Callable[..., Any]:
    """The same function, with `BrokenError` for what it raises, and where it takes too long.

    Each call runs in a thread of its own. One that is given up is ended at its next line of Python; one that waits
    inside of a library stays until it returns.
    """

    @wraps(function)
    def within_limit(*args: Any, **kwargs: Any) -> Any:
        returned: list[Any] = []
        raised: list[BaseException] = []

        def run() -> None:
            try:
                returned.append(function(*args, **kwargs))
            except BaseException as error:
                raised.append(error)

        thread = UserThread(run, "lesson")
        thread.start()
        thread.join(LIMIT_S)
        if thread.is_alive():
            at_work = getattr(function, "current", function)  # of a state machine: the function of the user
            where = line_of(at_work, frames_of(thread))
            thread.end()  # it would take the processor from all others
            thread.join(0.5)
            raise BrokenError(f"it did not return within {LIMIT_S:g} s{where}: does a loop in it never end?")
        if raised:
            raise BrokenError(f"it raised an error, {error_in(raised[0])}") from None
        return returned[0] if returned else None

    return within_limit


def number(answer: Any, what: str) -> float:
    """An answer as a float; BrokenError where it is none."""
    try:
        if isinstance(answer, (str, bytes, bool)):
            raise TypeError
        return float(answer)
    except (TypeError, ValueError):
        raise BrokenError(f"it returned {_short(answer)}: expected a number, the {what}") from None


def yes_or_no(answer: Any) -> bool:
    """An answer as True or False, NumPy's too; BrokenError where it is neither."""
    try:
        if answer in (True, False):
            return bool(answer)
    except (TypeError, ValueError):  # an array has no truth of its own
        pass
    raise BrokenError(f"it returned {_short(answer)}: expected True or False")


def pair(answer: Any, what: str) -> tuple[float, float]:
    """An answer as two floats; BrokenError where it is no pair."""
    try:
        first, second = answer
    except (TypeError, ValueError):
        raise BrokenError(f"it returned {_short(answer)}: expected two numbers, {what}") from None
    return number(first, what), number(second, what)


def _short(answer: Any) -> str:
    text = repr(answer)
    return f"{text[:60]}…" if len(text) > 60 else text

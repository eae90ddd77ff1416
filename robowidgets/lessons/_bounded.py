"""Calls of a function that may hang, raise, or return a wrong type."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import wraps
from math import inf
from typing import Any

from ..behaviors.lines.watch import LineWatch
from ..behaviors.prints import Prints
from ..runtime.no_input import without_input
from ..runtime.platform_fixes import capture_prints, release_prints
from ..runtime.policies import ANSWER
from ..runtime.user_function import error_in, line_of
from ..runtime.user_threads import UserThread, frames_of
from ..samples.hints import hearing
from ._texts import say

CASE_S = 10.0
"""The limit for all calls of a case together, in seconds.

Each call counts with the time that nine of ten calls exceed: the others may have waited for a busy computer.
"""


_ENDS = 20
"""The highest number of attempts to end a call: a ``try`` in it may catch one."""


class WrongError(Exception):
    """A fault of an answer, explained to the student, with advice if the explanation does not contain it.

    Args:
        text: English, with a field in braces for each value, as for `say`.
        advice: advice in the language of the lesson.
        step: the number of the call with the fault, from 1, or None for the last call.

    Attributes:
        fault: `text`, which identifies the fault in all languages.
    """

    def __init__(self, text: str, *, advice: str = "", step: int | None = None, **values: Any) -> None:
        super().__init__(say(text, **values))
        self.fault = text
        self.advice = advice
        self.step = step


class BrokenError(WrongError):
    """The function gives no answer, or an answer of a wrong kind, so that other cases need not be tried."""


class Bounded:
    """A caller of students' functions with limits of time. It keeps their prints and the hints that they get.

    Args:
        clock: returns seconds from any start.

    Attributes:
        prints: the last lines that the functions printed.
        hints: the hints since `begin_case`.
        steps: the last calls since `begin_case`, with the values of their lines.
        is_late: True if the last call has not returned.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.prints = Prints()
        self.hints: list[str] = []
        self._lines = LineWatch()
        self._is_prepared = False
        self.steps = self._lines.add_view()
        self.is_late = False
        self._clock = clock
        self._took: list[float] = []

    def begin_case(self) -> None:
        """Reset the calls, their time and the hints for another case."""
        self._took.clear()
        self.hints.clear()
        self.steps.clear()

    def of(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function wrapped so that it raises `BrokenError` for any exception, or if it or the case is late.

        Each call runs in a new thread. A late call is ended at its next line of Python. A call that waits inside a
        library stays until it returns.
        """
        program = str(getattr(function, "__name__", "")), 0
        if not self._is_prepared:
            self._is_prepared = True
            self._lines.prepare(program, function)

        @wraps(function)
        def within_limit(*args: Any, **kwargs: Any) -> Any:
            returned: list[Any] = []
            raised: list[BaseException] = []

            number = len(self._took) + 1

            def run() -> None:
                capture_prints(self._take_print)
                try:
                    with hearing(self._take_hint), without_input():
                        returned.append(self._lines.step(program, (number, 0.0), function, kwargs, *args))
                except BaseException as error:
                    raised.append(error)
                finally:
                    release_prints()
                    self.prints.end_line(0.0)

            self._run(UserThread(run, "lesson"), function)
            if raised:
                raise BrokenError("it raised an error, {error}", error=error_in(raised[0])) from None
            return returned[0] if returned else None

        return within_limit

    def _run(self, thread: UserThread, function: Callable[..., Any]) -> None:
        """Start the thread of a call and wait for it; end it if it takes too long."""
        passed, looked_at = 0.0, self._clock()
        thread.start()
        is_over = False
        while passed < ANSWER.late and not is_over:
            thread.join(ANSWER.look)
            is_over = not thread.is_alive()
            before, looked_at = looked_at, self._clock()
            passed += min(looked_at - before, ANSWER.max_gap)
        self._took.append(passed)
        if not is_over:
            self.is_late = True
            at_work = getattr(function, "current", function)  # a state machine has its running function in `current`
            line = line_of(at_work, frames_of(thread)).removeprefix(", ")
            self._end(thread)
            where = f"{line}: " if line else ""
            raise BrokenError(
                "{where}a step has not returned for half a second, and was abandoned. A step returns at once: it does "
                "not sleep or wait, and its loops end",
                where=where,
            )
        calls, together = len(self._took), sum(self._took)
        if together > CASE_S and (least := sorted(self._took)[calls // 10]) * calls > CASE_S:
            raise BrokenError(
                "its {calls} steps took {together:.0f} s, {each:.2g} s each. A step returns at once: it does not sleep "
                "or wait, and its loops end",
                calls=calls,
                together=together,
                each=least,
            )

    def _end(self, thread: UserThread) -> None:
        """End a thread, which would slow down all others. Repeat this if a bare ``except:`` caught the end."""
        for _ in range(_ENDS):
            thread.end()
            thread.join(ANSWER.grace / _ENDS)
            if not thread.is_alive():
                return

    def _take_hint(self, text: str, **values: Any) -> None:
        self.hints.append(say(text, **values))

    def _take_print(self, text: str) -> bool:
        self.prints.add(text, 0.0)
        return True


def call(function: Callable[..., Any], sample: Any) -> Any:
    """Return the result of a function for a sample; BrokenError for None."""
    returned = function(sample)
    if returned is None:
        raise BrokenError("it returned None: does every path through it end with a return?")
    return returned


def number(answer: Any, what: str) -> float:
    """Return an answer as a float; BrokenError if it is not a number."""
    try:
        if isinstance(answer, (str, bytes, bool)):
            raise TypeError
        return float(answer)
    except Exception:  # for 10**400, and any exception of an object that the answer defines
        raise BrokenError(
            "it returned {answer}: expected a number, the {what}", answer=shown(answer), what=what
        ) from None


def yes_or_no(answer: Any) -> bool:
    """Return an answer as True or False, also from NumPy; BrokenError if it is neither."""
    try:
        if answer in (True, False):
            return bool(answer)
    except Exception:  # an array is neither true nor false
        pass
    raise BrokenError("it returned {answer}: expected True or False", answer=shown(answer))


def pair(answer: Any, what: str) -> tuple[float, float]:
    """Return an answer as two floats; BrokenError if it is not a pair."""
    try:
        if isinstance(answer, Iterator):  # a generator, which has not run yet
            raise TypeError
        first, second = answer
    except Exception:
        raise BrokenError(
            "it returned {answer}: expected two numbers, {what}", answer=shown(answer), what=what
        ) from None
    return number(first, what), number(second, what)


def beyond(value: float, low: float = -inf, high: float = inf, least: int = 2) -> str:
    """Format a number beyond limits with enough decimals to show it: 0.297 is not "0.30" if the limit is 0.3."""
    texts = (f"{value:.{decimals}f}" for decimals in range(least, 7))
    return next((text for text in texts if not low <= float(text) <= high), f"{value:g}")


def shown(answer: Any) -> str:
    """Return an answer as text of one short line."""
    try:
        text = repr(answer)
    except Exception:  # also for 10**5000
        text = f"an object of {type(answer).__name__}"
    return f"{text[:60]}…" if len(text) > 60 else text

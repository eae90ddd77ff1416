"""A condition that is judged on each sample of a widget."""

from __future__ import annotations

import asyncio
import threading
import time
from collections import deque
from collections.abc import Callable
from contextvars import copy_context
from typing import Any, NamedTuple

from ..runtime.user_function import error_in
from ..runtime.waiters import Waiters
from ..samples.checks import not_negative
from ..samples.ranges import NoSensorError
from ..samples.verdict import UNKNOWN, Verdict

MOST_CHANGES = 1000
"""Changes that a watch keeps."""

MOST_RUNS = 500
"""The most runs of neighbouring rays that are marked on a picture. If there are more, the shorter gaps are closed."""


class Change(NamedTuple):
    """A change of a condition.

    ``value`` is the new value: True, False, or None for unknown. ``text`` shows the compared values. ``time`` is in
    seconds since the epoch, by this computer's clock, and ``stamp_ns`` the stamp of the sample in nanoseconds, or None.
    """

    value: bool | None
    text: str
    time: float
    stamp_ns: int | None


class Watch:
    """A condition that a widget judges on each sample, in a thread of its own; `RobotWidget.watch` returns it.

    Only the newest sample is judged, so a slow function misses some. A condition that raises an error is switched off:
    `error` says why, and a new `watch` of the name starts it again. Its truth value is `value`; unknown is not true.

    Args:
        name: the name of the lamp.
        condition: one of `robowidgets.conditions`, or a function of one sample.
        sample_name: the name of the samples of its widget, such as ``"scan"``.
        why_none: returns why no current sample is known, or empty if one is.
    """

    def __init__(self, name: str, condition: Any, sample_name: str, why_none: Callable[[], str]) -> None:
        self.name = name
        self.sample_name = sample_name
        self.condition = condition
        self._judge_sample: Callable[[Any], Verdict] | None = getattr(condition, "judge", None)
        if self._judge_sample is None:
            from ..reasons.look import Look  # the first widget of a page does without

            look = Look(condition)
            look.prepare()
            self._judge_sample = look.judge
        self._why_none = why_none
        self._context = copy_context()
        """The context of the cell that watches, so that prints of the condition appear below that cell."""
        self._lock = threading.RLock()
        self._waiters = Waiters(self._lock)
        self._wakers: list[Callable[[], None]] = []
        self._verdict = UNKNOWN
        self._sample: Any = None
        self._since: float | None = None
        self._changes: deque[Change] = deque(maxlen=MOST_CHANGES)
        self._count = 0
        self._error = ""
        self._ended = ""
        self.runs = 0
        """The number of samples that it has judged."""

    # -- for the user --------------------------------------------------------------------------------------------------

    @property
    def value(self) -> bool | None:
        """True or False for the newest judged sample; None while unknown, switched off, or the sample is stale."""
        return None if self._why_off or self._why_none() else self._verdict.value

    @property
    def verdict(self) -> Verdict:
        """The verdict on the newest judged sample of any age: the compared values, and the rays that made it true."""
        return self._verdict

    @property
    def sample(self) -> Any:
        """The newest judged sample, or None before the first."""
        return self._sample

    @property
    def error(self) -> str:
        """The error that switched it off, with the line of the function, or empty while it is on."""
        return self._error

    @property
    def changes(self) -> tuple[Change, ...]:
        """The last 1000 changes, oldest first. The first verdict does not count as a change."""
        with self._lock:
            return tuple(self._changes)

    def wait(self, timeout: float = 10.0, value: bool = True) -> Any:
        """Wait for a sample for which the condition is true, and return it.

        Returns at once if the condition is true for the newest sample and that is not stale. Any thread may wait,
        except the one that updates the widget. An interrupt ends the wait.

        Args:
            timeout: seconds to wait, 0 or more.
            value: False to wait until the condition is false.

        Raises:
            TimeoutError: it did not become true. The text gives its state, or why no sample came.
            RuntimeError: it raised an error and was switched off, or is no longer watched.
            TypeError: the timeout is not a number. ValueError: it is not finite, or below 0.
        """
        seconds = not_negative("timeout", timeout, "seconds")
        sample = self._waiters.wait_for(lambda: self._sample_if(value), seconds)
        if sample is None:
            raise self._too_late(seconds, value)
        return sample

    async def wait_async(self, timeout: float = 10.0, value: bool = True) -> Any:
        """Wait as `wait` does, for ``await``: other tasks run meanwhile."""
        seconds = not_negative("timeout", timeout, "seconds")
        deadline = time.monotonic() + seconds
        loop, woken = asyncio.get_running_loop(), asyncio.Event()

        def wake() -> None:
            if not loop.is_closed():
                loop.call_soon_threadsafe(woken.set)

        with self._lock:
            self._wakers.append(wake)
        try:
            while True:
                woken.clear()
                if (sample := self._sample_if(value)) is not None:
                    return sample
                left = deadline - time.monotonic()
                if left <= 0:
                    raise self._too_late(seconds, value)
                try:
                    await asyncio.wait_for(woken.wait(), left)
                except asyncio.TimeoutError:
                    continue
        finally:
            with self._lock:
                self._wakers.remove(wake)

    def __bool__(self) -> bool:
        return self.value is True

    def __repr__(self) -> str:
        count = f"{self._count} change{'' if self._count == 1 else 's'}"
        return f"<{self.name}: {', '.join(filter(None, (self._status(), self._verdict.text, count)))}>"

    # -- for the thread that judges ------------------------------------------------------------------------------------

    def judge(self, sample: Any) -> None:
        """Judge a sample, or None before the first sample of a widget."""
        if self._error:
            return
        try:
            verdict = UNKNOWN if sample is None else self._judge(sample)
        except BaseException as error:  # not even a SystemExit may end the thread that judges
            if not self._why_off:  # else it was ended because it did not return
                self.switch_off(error_in(error))
            return
        with self._lock:
            if self._sample is not None and verdict.value != self._verdict.value:
                stamp_ns = getattr(sample, "stamp_ns", None)
                self._changes.append(Change(verdict.value, verdict.text, time.time(), stamp_ns))
                self._count += 1
            if self._since is None or verdict.value != self._verdict.value:
                self._since = time.monotonic()
            self._verdict, self._sample = verdict, sample
            self.runs += sample is not None
            self._notify()

    def end(self, reason: str) -> None:
        """Stop judging; waiting threads get the reason."""
        with self._lock:
            self._ended = reason
            self._notify()

    def lamp(self) -> dict[str, Any]:
        """Return its lamp for the page, as plain values: see `Lamp` in js/shared/lamps.ts."""
        return self._lamp(self._verdict, self._since, self._count)

    def lamp_on(self, sample: Any) -> dict[str, Any]:
        """Return the lamp for a sample of a recording, or for None before the first, without a history."""
        verdict = UNKNOWN
        if sample is not None and not self._error:
            try:
                verdict = self._judge(sample)
            except BaseException as error:  # not even a SystemExit may end the thread that judges recordings
                if not self._why_off:  # else it was ended because it did not return
                    self.switch_off(error_in(error))
        return self._lamp(verdict, None, 0)

    def switch_off(self, why: str) -> None:
        """Stop judging, for a reason that the lamp shows."""
        with self._lock:
            self._error, self._verdict = why, UNKNOWN
            self._notify()

    def _lamp(self, verdict: Verdict, since: float | None, changes: int) -> dict[str, Any]:
        value, text = verdict.value, verdict.text
        state = "off" if self._error else {True: "true", False: "false", None: "unknown"}[value]
        return {
            "name": self.name,
            "state": state,
            "text": self._error or text,
            "since": since,
            "changes": changes,
            "rays": _runs(verdict.rays.tolist()) if value else [],
        }

    def _judge(self, sample: Any) -> Verdict:
        try:
            return self._context.copy().run(self._judge_sample, sample)  # type: ignore[arg-type]
        except NoSensorError as error:  # it may still come
            return Verdict(None, error.args[0])

    def _sample_if(self, value: bool) -> Any:
        """Return the newest judged sample if its verdict is this one, else None. Called without the lock."""
        if self._why_off:
            raise RuntimeError(f"{self.name}: {self._why_off}")
        with self._lock:
            verdict, sample = self._verdict, self._sample
        return sample if verdict.value is value and not self._why_none() else None

    @property
    def _why_off(self) -> str:
        return f"switched off, {self._error}" if self._error else self._ended

    def _notify(self) -> None:
        self._waiters.wake()
        for wake in self._wakers:
            wake()

    def _status(self) -> str:
        if self._why_off:
            return self._why_off
        if self.value is None:
            return ": ".join(filter(None, ("unknown", self._why_none() or self._verdict.text)))
        return f"{'true' if self.value else 'false'} for {time.monotonic() - (self._since or 0):.1f} s"

    def _too_late(self, seconds: float, value: bool) -> TimeoutError:
        compared = f" ({self._verdict.text})" if self._verdict.text and self.value is not None else ""
        return TimeoutError(
            f"{self.name} was not {'true' if value else 'false'} within {seconds:g} s: it is {self._status()}{compared}"
        )


def _runs(indices: list[int]) -> list[int]:
    """Return the start and stop of each run of neighbouring indices, in sequence: [3, 4, 9] gives [3, 5, 9, 10]."""
    runs: list[int] = []
    reach = 1
    while True:
        runs.clear()
        for index in indices:
            if runs and index - runs[-1] < reach:
                runs[-1] = index + 1
            else:
                runs += [index, index + 1]
        if len(runs) <= 2 * MOST_RUNS:
            return runs
        reach *= 2

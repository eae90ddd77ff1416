"""Judging the samples of a recording, for callers that must not hang in a condition."""

from __future__ import annotations

import threading
from collections import deque
from contextlib import suppress
from typing import Any

from ..runtime import clock
from ..runtime.clock import Signal
from ..runtime.policies import RECORDED
from ..runtime.runner import Call, Runner
from ..runtime.user_function import error_in
from .watch import Watch


class _Question:
    """A sample to judge, and its lamp, which is None until the sample is judged."""

    def __init__(self, watch: Watch, sample: Any, answered: Signal) -> None:
        self.watch, self.sample, self._answered = watch, sample, answered
        self.lamp: dict[str, Any] | None = None

    def answer(self, lamp: dict[str, Any]) -> None:
        self.lamp = lamp
        self._answered.set()

    def wait(self) -> dict[str, Any]:
        while self.lamp is None:
            self._answered.wait_until(None)
        return self.lamp


class FrameJudge:
    """Judges samples of a recording by watches, one at a time, in a thread of its own.

    A condition that has not returned for a second is switched off, and its thread is detached and ended. So the caller,
    a cell or the thread that sends a recording to the page, always gets an answer.
    """

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._questions: deque[_Question] = deque()
        self._is_closed = False
        self._runner = Runner(self._answer_next, self._lock, "robowidgets-judge", RECORDED, on_look=self._look)

    def lamp_on(self, watch: Watch, sample: Any) -> dict[str, Any]:
        """Return what `Watch.lamp_on` returns for a sample."""
        question = _Question(watch, sample, clock.scheduler.clock.signal())
        with self._lock:
            if self._is_closed:
                return watch.lamp()
            self._questions.append(question)
            self._runner.wake()
        return question.wait()

    def close(self) -> None:
        """End the thread. Waiting callers get the lamps as they are."""
        with self._lock:
            self._is_closed = True
            self._runner.detach()
            questions = [*self._questions]
            self._questions.clear()
        for question in questions:
            question.answer(question.watch.lamp())

    def _answer_next(self, call: Call) -> float | None:
        with self._lock:
            if not self._questions:
                return None
            question = self._questions[0]  # it stays queued for the next thread if this one is detached
        lamp, error, _ = call(question.watch.lamp_on, question.sample, of=question.watch)
        if error is not None:
            question.watch.switch_off(error_in(error))
            return 0.0
        with self._lock, suppress(ValueError):  # closed meanwhile
            self._questions.remove(question)
        question.answer(lamp)
        return 0.0

    def _look(self) -> None:
        late = self._runner.current
        if self._runner.is_late and isinstance(late, Watch):
            late.switch_off(f"has not returned for {RECORDED.late:g} s{self._runner.where(late.condition)}")
            self._runner.detach()
            self._runner.wake()

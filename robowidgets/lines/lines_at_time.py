"""The lines of a function at the time that a player shows, and over the whole recording."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from ..behaviors.lines.watch import error_text
from ..notebook.progress import Progress, without_bars
from ..recordings import RecordingData
from ..recordings.search.lines import MadeStep, RecordedLines
from ..runtime import clock
from ..runtime.clock import Scheduler
from ..runtime.policies import RECORDED
from ..runtime.runner import Call, Runner
from ..runtime.user_threads import MayDrive
from .graphs import Graphs

BUDGET = 0.05
"""Seconds of steps in one turn, after which a newer time is looked for."""
TOLD_EVERY = 0.5
"""Seconds between two reports while the whole recording is computed."""


class LinesAtTime:
    """Computes a function at the time that was asked for last, and then over the recording, in a thread of its own.

    Only counts and the points of small graphs are kept. If a step does not return, its thread is abandoned, and
    `error` says so. The function cannot drive a robot meanwhile.

    Args:
        recording: opens the recording for this thread.
        make: makes the function, or the program.
        rate: steps a second of a function that is stepped through time.
        topics: the topics that a function of one moment may read, or None for all that a widget shows.
        preferred: the topics to read if there are several of a kind.
        span: start and end of the steps in seconds, or None for all of the recording.
        on_result: called in that thread after each result.

    Attributes:
        shown: the step at the time that was asked for, or None if none was made up to it.
        shown_at: that time, or None before the first result.
        lines: the lines over the recording, or None before the first turn.
        graphs: the points of the graphs of the lines.
        is_complete: True once the whole recording has been computed.
        error: the error that ended it, empty without one.
    """

    def __init__(
        self,
        recording: Callable[[], RecordingData],
        make: Callable[[], Any],
        on_result: Callable[[], object],
        *,
        rate: float,
        topics: str | Iterable[str] | None = None,
        preferred: Iterable[str] = (),
        span: tuple[float, float] | None = None,
        scheduler: Scheduler | None = None,
    ) -> None:
        self._open, self._make, self._on_result = recording, make, on_result
        self._rate, self._topics, self._preferred, self._span = rate, topics, frozenset(preferred), span
        self.shown: MadeStep | None = None
        self.shown_at: float | None = None
        self.lines: RecordedLines | None = None
        self.graphs: Graphs | None = None
        self.is_complete = False
        self.error = ""
        self._wanted: float | None = None
        self._recording: RecordingData | None = None
        self._function: Any = None
        self._is_read = self._is_closed = False
        self._filling: Iterator[MadeStep] = iter(())
        self._walk: Iterator[MadeStep] | None = None
        """The steps of a program on the way to the time, its last step, and one after the time if it was made."""
        self._last: MadeStep | None = None
        self._next: MadeStep | None = None
        self._may_drive = MayDrive()
        self._may_drive.refused = "it runs over a recording"
        self._lock = threading.RLock()
        self._clock = (scheduler or clock.scheduler).clock
        self._told = self._clock.now()
        self._runner = Runner(
            self._turn, self._lock, "robowidgets-lines", RECORDED, on_look=self._look, scheduler=scheduler
        )

    def ask(self, seconds: float) -> None:
        """Compute the step at a time. The newest time wins."""
        self._wanted = seconds
        if not self.error and not self._is_closed:
            self._runner.wake()

    def close(self) -> None:
        """End the thread, and close the recording."""
        self._is_closed = True
        self._runner.detach()
        if self._recording is not None:
            self._recording.close()

    # -- in its thread -------------------------------------------------------------------------------------------------

    def _turn(self, call: Call) -> float | None:
        """Do the most urgent work for a short time. Return the time of the next turn, or None without work."""
        if self.error or self._is_closed:
            return None
        with without_bars():
            try:
                work = self._work()
            except Exception as error:  # the file cannot be read
                self._fail(error_text(error))
                return None
            if work is None:
                return None
            raised = call(self._may_drive.drive_by, work, of=self).error
        if raised is not None and not self._is_closed:
            self._fail(error_text(raised))
            return None
        return 0.0

    def _work(self) -> Callable[[], None] | None:
        if self._recording is None:
            self._recording = self._open()
            if self._is_closed:  # by another thread meanwhile, which had nothing to close
                self._recording.close()
                return None
            self._recording.preferred = frozenset(self._recording.preferred) | self._preferred
        if self.lines is None:
            return self._begin
        if not self._is_read:
            self.lines.maker.read()
            self._is_read = True
        wanted = self._wanted
        if wanted is not None and wanted != self.shown_at:
            return lambda: self._show(wanted)
        return None if self.is_complete else self._fill

    def _begin(self) -> None:
        assert self._recording is not None
        self._function = self._make()
        lines = RecordedLines(
            self._recording, self._function, self._rate, self._topics, span=self._span, is_filled=False
        )
        start_ns = self._recording.start_ns or 0
        start, end = (start_ns + round(one * 1e9) for one in self._span or (0.0, self._recording.duration))
        self.graphs, self._filling, self.lines = Graphs(start, end), lines.fill(Progress(0, "")), lines

    def _show(self, wanted: float) -> None:
        """Compute the step at a time, or some of the steps on the way to it."""
        assert self.lines is not None
        assert self._recording is not None
        maker = self.lines.maker
        if not maker.is_program:
            self.shown = maker.make_at(wanted)
        else:
            time_ns = (self._recording.start_ns or 0) + round(wanted * 1e9)
            if self._walk is None or (self._last is not None and time_ns < self._last.time_ns):
                self._walk, self._last, self._next = maker.walk(Progress(0, "")), None, None
            until = self._clock.now() + BUDGET
            while True:
                self._next = self._next or next(self._walk, None)
                if self._next is None or self._next.time_ns > time_ns:
                    break
                self._last, self._next = self._next, None
                if self._clock.now() >= until:
                    return
            self.shown = self._last
        self.shown_at = wanted
        self._on_result()

    def _fill(self) -> None:
        """Compute some of the steps of the whole recording."""
        assert self.lines is not None
        assert self.graphs is not None
        until = self._clock.now() + BUDGET
        for made in self._filling:
            self.graphs.add(made, self.seconds_of(made))
            if self._clock.now() >= until:
                break
        else:
            self.is_complete = True
        if self.is_complete or self._clock.now() >= self._told + TOLD_EVERY:
            self._told = self._clock.now()
            self._on_result()

    def seconds_of(self, made: MadeStep) -> float:
        """Return the time of a step in seconds from the start of the recording."""
        start_ns = self._recording.start_ns if self._recording is not None else None
        return (made.time_ns - (start_ns or 0)) / 1e9

    def _fail(self, error: str) -> None:
        self.error = error
        self._on_result()

    def _look(self) -> None:
        """Abandon a step that does not return. The thread of the timers calls this."""
        if self._runner.is_late and self._runner.current is self:
            self._fail(f"a step has not returned for {RECORDED.late:g} s{self._runner.where(self._function)}")
            self._runner.detach()

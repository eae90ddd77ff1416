"""A thread in which other versions of a program are tried. It may hang without harm to the running program."""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable, Iterator

from ..runtime.clock import Scheduler
from ..runtime.clock import scheduler as threads
from ..runtime.no_input import without_input
from ..runtime.platform_fixes import capture_prints, release_prints
from ..runtime.policies import TRIAL
from ..runtime.runner import Call, Runner
from ..runtime.user_function import error_in
from ..runtime.user_threads import MayDrive

log = logging.getLogger("robowidgets")

SLICE_S = 0.004
"""Seconds of work at a time, in which the steps of the running program may have to wait."""
PAUSE_S = 0.012
"""Seconds between two slices, in which everything else has the processor."""
_NO_RETURN = f"a step has not returned for {TRIAL.late:g} s"
MOST_SLICES = 1000
"""Slices of one trial. A slow version is tried on fewer steps."""


class TrialJob:
    """One trial.

    Args:
        work: makes the steps; it yields after each one.
        function: the function that is tried, to find the line at which it hangs.
        then: called with the job when it is over. It calls no code of a user.

    Attributes:
        error: the error that ended it, or the line at which it hung; empty without one.
        is_partial: True if it took too long, so that not all steps were made.
    """

    def __init__(
        self, work: Iterator[object], function: Callable[..., object], then: Callable[[TrialJob], object]
    ) -> None:
        self.work, self.function, self.then = work, function, then
        self.error = ""
        self.is_partial = False
        self.slices = 0


class Trials:
    """Does trials, one at a time, in short slices. Of several with the same name, only the newest is done.

    Trials do not drive, print, or ask the user. A step that does not return is abandoned, and ends its trial.

    Args:
        scheduler: provides the threads and the clock.
    """

    def __init__(self, scheduler: Scheduler = threads) -> None:
        self._now = scheduler.clock.now
        self._lock = threading.RLock()
        self._waiting: dict[str, TrialJob] = {}
        """The trials to do, by name."""
        self._over: deque[TrialJob] = deque()
        self._may_drive = MayDrive()
        self._may_drive.refused = "another version is only tried, and does not drive"
        self._runner = Runner(
            self._turn, self._lock, "robowidgets-trial", TRIAL, on_look=self._look, scheduler=scheduler
        )

    def ask(self, name: str, job: TrialJob) -> None:
        """Do a trial instead of the one of this name."""
        with self._lock:
            self._waiting.pop(name, None)
            self._waiting = {name: job, **self._waiting}  # what was asked last comes first
            self._runner.wake()

    def drop(self, name: str) -> None:
        """Do not do the trial of this name."""
        with self._lock:
            self._waiting.pop(name, None)

    def close(self) -> None:
        """Do no more trials."""
        with self._lock:
            self._waiting.clear()
            self._over.clear()
            self._runner.detach()

    def _turn(self, call: Call) -> float | None:
        with self._lock:
            over = self._over.popleft() if self._over else None
            job = next(iter(self._waiting.values()), None)
        if over is not None:  # in a turn of its own, which is never late
            try:
                over.then(over)
            except Exception:
                log.exception("robowidgets: error after the trial of a version")
            return self._now()
        if job is None:
            return None
        is_over, error, _ = call(self._work, job, of=job)
        job.slices += 1
        if error is not None:
            job.error = error_in(error)
        job.is_partial = error is None and not is_over and job.slices >= MOST_SLICES
        if error is not None or is_over or job.is_partial:
            self._end(job)
            return self._now()
        return self._now() + PAUSE_S

    def _work(self, job: TrialJob) -> bool:
        """Make some steps; return True after the last one."""
        capture_prints(lambda _text: True)
        try:
            with without_input():
                return bool(self._may_drive.drive_by(self._make_steps, job))
        finally:
            release_prints()

    def _make_steps(self, job: TrialJob) -> bool:
        until = self._now() + SLICE_S
        return all(self._now() < until for _ in job.work)

    def _end(self, job: TrialJob) -> None:
        with self._lock:
            for name in [name for name, one in self._waiting.items() if one is job]:
                del self._waiting[name]
                self._over.append(job)  # unless a newer one has replaced it

    def _look(self) -> None:
        """Abandon a step that does not return. Runs in the thread of the timers."""
        with self._lock:
            job = self._runner.current
            if not self._runner.is_late or not isinstance(job, TrialJob):
                return
            where = self._runner.where(getattr(job.function, "current", job.function)).removeprefix(", ")
            job.error = f"{where}: {_NO_RETURN}" if where else _NO_RETURN
            self._runner.detach()
            self._end(job)
            self._runner.wake()

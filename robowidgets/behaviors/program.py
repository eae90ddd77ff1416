"""A program that drives a robot, step by step, and that may be replaced while it runs."""

from __future__ import annotations

import logging
import threading
import time
import traceback
from collections.abc import Callable
from contextvars import copy_context
from dataclasses import replace
from math import isnan
from typing import Any

from .._core.inform import inform
from .._core.log_once import LogOnce
from .._core.observed import Observed
from .._core.platform_fixes import capture_prints, release_prints, run_beside_debugger
from .._core.rate import RateMeter
from .._core.short_traceback import without_our_frames
from .._core.user_function import line_of, say_what_was_meant
from .._core.user_threads import UserThread, frames_of
from ..samples.state_span import spelled
from .drive import STANDSTILL, drive_of
from .prints import Prints
from .robot import DRIVEN, GIVEN, TURNED, DrivenRobot, NotReadyError
from .step_clock import StepClock
from .variables import ProgramState, Variables
from .version import Version

log = logging.getLogger("robowidgets")

TICK = 0.025
"""Seconds between two looks at a step that has not returned."""

LATEST_TICK = 0.1
"""Seconds that a look counts at most: where it comes later, the whole process may have stood still."""

HUNG = 0.45
"""Seconds of looks without the return of a step, after which it counts as hung."""

HELD = 1.0
"""Seconds without any look, in which the process worked, after which a step counts as one that held the GIL."""

WORKS = 0.05
"""Seconds of processor time per second by which a process works whose threads wait for the GIL."""

GRACE = 0.5
"""Seconds after which an abandoned step that has not returned is ended."""

PATIENCE = 1.0
"""Seconds after which the log says why a program does not drive."""

SILENCE = 1.0
"""Seconds without a message of the topic ``on``, after which the program says that it waits for it."""

RUNNING, PAUSED, FAILED, ENDED = "running", "paused", "failed", "ended"


class Program(Observed):
    """A program of a robot: its versions, its state, and the thread that calls it step by step.

    `robowidgets.feeds.Feed.program` makes it. It may be called like its function.

    - An exception stops the robot; the program waits for its next version, or for `run`.
    - A step that does not return for half a second is abandoned: the robot is stopped, and that step cannot drive any
      more. The next version runs in another thread.
    - So is a step that held the GIL for a second or longer: then neither it could be abandoned, nor zero be sent.
    - Its time counts while it can make steps: not while it is paused, waits, or the process stands still.
    - The speed of a version that was replaced while it was at work is not sent.

    Args:
        name: its name.
        robot: the robot that it drives.
        variables: the variables of the robot.

    Attributes:
        state: what it keeps from step to step and from version to version.
        version: the version in force.
        mode: ``running``, ``paused``, ``failed`` or ``ended``.
        error: the last error, with its line; empty when the last step was well.
        waiting: why it does not step or drive now, though it runs; empty if it does.
        note: what happened to it last, other than errors, for a person.
        steps: the number of steps.
        step_time: seconds that the last step took.
        returned: the speed that the last step asked for.
        kept: whether the last step returned None, which keeps the speed.
        prints: the last lines that it printed.
        clock: the seconds that its steps count, from the first one on.
        context: that of the cell which defined it last: so what it prints and logs appears below that cell.
    """

    def __init__(self, name: str, robot: DrivenRobot, variables: Variables) -> None:
        super().__init__()
        self.name, self.state, self.variables = name, ProgramState(), variables
        self.version = Version(lambda: None, number=0)
        self.mode, self.error, self.waiting, self.note = PAUSED, "", "", ""
        self.steps, self.step_time, self.returned, self.kept = 0, 0.0, STANDSTILL, False
        self.prints = Prints()
        self.keeps = False
        """Whether, after its end, another run of its cell goes on with its `state` and its time."""
        self.has_view = False
        """Whether a widget shows what it prints."""
        self._robot = robot
        self._lock = threading.RLock()
        self._changed = threading.Condition(self._lock)
        self._inputs = robot.listen(self._wake)
        self._thread: UserThread | None = None
        self._abandoned: list[UserThread] = []
        """The threads that are to be ended, should they not return."""
        self._monitor: threading.Thread | None = None
        self._in_step = False
        self._fresh = False
        """Whether a message of the topic ``on`` came since the last step."""
        self._is_silent = False
        """Whether none came for so long that the program looks why."""
        self._interrupted = False
        self.clock = StepClock()
        self._looked_at = self._unseen = 0.0
        """The time of the last look at a step, and the seconds of this step for which there was none."""
        self._step_began = 0.0
        self._began: dict[str, float] = {}
        """What odometry said at the first step, for metres and radians since then."""
        self._since = time.monotonic()
        self._due = self._steps_a_second = 0.0
        self._waiting_since = 0.0
        self._rate = RateMeter()
        self._log = LogOnce(log.warning)
        self.context = copy_context()

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Call the function of the newest version, without driving."""
        return self.version.function(*args, **kwargs)

    def __repr__(self) -> str:
        states = getattr(self.version.function, "active_text", "")
        return f"program {self.name}, version {self.version.number}, {self.mode}" + (
            (f" in {states}" if states and self.mode != ENDED else "")
            + (f": {self.error or self.waiting}" if self.error or self.waiting else "")
        )

    @property
    def rate(self) -> float:
        """Steps a second, measured."""
        return 0.0 if isnan(self._steps_a_second) or self._thread is None else self._steps_a_second

    @property
    def since(self) -> float:
        """Seconds since this version is in force."""
        return time.monotonic() - self._since

    # -- what a person asks for ----------------------------------------------------------------------------------------

    def replace(self, version: Version) -> None:
        """Run another version, from the next step on."""
        before, asked = self.version, (version.asks_for, version.topics, version.on)
        if before.number == 0 or asked != (before.asks_for, before.topics, before.on):
            wanted = {name: version.topics.get(name) for name in version.asks_for if name not in GIVEN}
            self._inputs.choose(wanted, version.on)
        with self._lock:
            self.version, self._since = version, time.monotonic()
            self._due = min(self._due, self._since + 1 / version.rate)
            self.error = self.note = self.waiting = ""
            self._log = LogOnce(log.warning)
            self.context = copy_context()
            if self._thread is None or self._in_step or self.mode != RUNNING:
                self._leave()
                self._start()
            self._changed.notify_all()
        self._call_observers()

    def run(self) -> None:
        """Go on, after a pause or an error."""
        with self._lock:
            if self._thread is None and self.mode != ENDED:
                self.error = self.note = ""
                self._start()
        self._call_observers()

    def restart(self) -> None:
        """Start it anew: with an empty `state`, at time 0, and a state machine in its initial state.

        Raises:
            RuntimeError: it has ended.
        """
        with self._lock:
            self._check_not_ended()
            self._leave()
            if hasattr(self.version.function, "fresh"):
                self.version = replace(self.version, function=self.version.function.fresh())
            self.state, self.clock, self._began, self.prints = ProgramState(), StepClock(), {}, Prints()
            self.error = self.note = self.waiting = ""
            self._stand_still()
            self._start()
            self._changed.notify_all()
        self._call_observers()

    def go_to(self, state: str) -> None:
        """Have its state machine go to a state at the next step, named as in `Machine.active`: ``"avoid.turn"``.

        Raises:
            TypeError: it is no state machine. ValueError: it has no such state. RuntimeError: it has ended.
        """
        self._check_not_ended()
        function = self.version.function
        if not hasattr(function, "go_to"):
            raise TypeError(f"{self.name} is no state machine, and has no state {state!r} to go to")
        function.go_to(state)
        if self.mode != RUNNING:
            self.note = f"goes to {spelled(state)} at its next step"
        self._call_observers()

    def pause(self, note: str = "") -> None:
        """Make no more steps, and stop the robot."""
        self._end(PAUSED, note)

    def step(self) -> None:
        """Make one step, while it is paused; its speed holds for the hold of the robot, at most."""
        with self._lock:
            if self._thread is None and self.mode != ENDED:
                self.error = self.note = ""
                self._start(once=True)
        self._call_observers()

    def close(self, note: str = "", *, keeps: bool = False) -> None:
        """End it, stop the robot, and forget its `state`, unless ``keeps`` it for the next run of its cell."""
        self._end(ENDED, note)
        self._inputs.close()
        self.keeps = keeps
        if not keeps:
            self.state = ProgramState()

    def interrupt(self) -> None:
        """Stop the robot now, and pause in a moment. For a signal handler: it takes no lock of the program."""
        thread = self._thread
        if thread is not None:
            self._interrupted = True
            thread.abandon()
            self._robot.halt()

    # -- within --------------------------------------------------------------------------------------------------------

    def _check_not_ended(self) -> None:
        if self.mode == ENDED:
            raise RuntimeError(f"the program {self.name} has ended: run its cell again")

    def _wake(self) -> None:
        with self._lock:
            self._fresh = True
            self._changed.notify_all()

    def _start(self, *, once: bool = False) -> None:
        """Start a thread for the steps. Called with the lock held."""
        self.mode, self._interrupted, self._in_step = PAUSED if once else RUNNING, False, False
        self._due = time.monotonic()
        self._thread = UserThread(lambda: self._run(once), "robowidgets-program")
        self._thread.start()
        if self._monitor is None:
            self._monitor = threading.Thread(target=self._watch_steps, name="robowidgets-monitor", daemon=True)
            run_beside_debugger(self._monitor)
            self._monitor.start()

    def _leave(self) -> None:
        """Let go of the thread: a step that it is in may finish, but not drive. Called with the lock held."""
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.abandon()
            self._abandoned.append(self._thread)
        self._thread, self._in_step = None, False

    def _end(self, mode: str, note: str = "", error: str = "") -> None:
        with self._lock:
            if self.mode == ENDED:
                return
            self._leave()
            self.clock.stop()
            self.mode, self.error, self.waiting = mode, error, ""
            self.note = note or self.note
            self._stand_still()
            self._changed.notify_all()
        self._robot.halt()
        self._call_observers()

    def _run(self, once: bool) -> None:
        """Make steps until another thread takes over. In the thread of the program."""
        me = threading.current_thread()
        try:
            while self._wait(me):
                capture_prints(self._take_print)
                version, values = self._prepare()
                if values is not None and not self._step(me, version, values):
                    return
                if once:
                    with self._lock:
                        if self._thread is me:
                            self.clock.stop(1 / version.rate if values is not None else 0.0)
                            self._leave()
                    self._call_observers()
                    return
        except Exception as failure:  # in a step of the user's they are caught; here no thread may end without a word
            error = f"{type(failure).__name__}: {failure}"
            if self._thread is me:
                self._end(FAILED, error=error)
            self._log_error(error, failure)
        finally:
            release_prints()

    def _wait(self, me: threading.Thread) -> bool:
        """Wait for the time, message or silence of the next step; returns whether the thread is still wanted."""
        with self._lock:
            self._is_silent = False
            while self._thread is me and not self._interrupted:
                if self.version.on is None:
                    now = time.monotonic()
                    if now >= self._due:
                        self._due = max(self._due + 1 / self.version.rate, now)
                        return True
                    self._changed.wait(self._due - now)
                elif self._fresh:
                    self._fresh = False
                    return True
                elif not self._changed.wait(SILENCE):
                    self._is_silent = True
                    return True
            return False

    def _prepare(self) -> tuple[Version, dict[str, Any] | None]:
        """The version to call and its arguments; None while it cannot step."""
        version = self.version
        if self._robot.is_stopped():
            self.clock.stop()
            self._stand_still()
            self._set_waiting("stop is latched")
            return version, None
        try:
            if self._is_silent and version.on is not None:
                raise NotReadyError(self._inputs.why_silent(version.on))
            values = self._inputs.take()
        except NotReadyError as error:
            self.clock.stop()
            self._robot.halt()
            self._stand_still()
            self._set_waiting(str(error))
            return version, None
        for name in (DRIVEN, TURNED):
            if name in values:
                values[name] -= self._began.setdefault(name, values[name])
        values.update(time=self.clock.start(), state=self.state, variables=self.variables)
        try:
            return version, {name: values[name] for name in version.asks_for}
        except KeyError:
            return version, None  # the next version has chosen other samples, and is in force in a moment

    def _step(self, me: threading.Thread, version: Version, values: dict[str, Any]) -> bool:
        """Make one step; returns whether this thread is still wanted."""
        with self._lock:
            if self._thread is not me:
                return False
            if self.version is not version:
                return True
            self._in_step = True
            self.steps += 1
            self._unseen, self._step_began = 0.0, time.monotonic()
        began, worked = time.perf_counter(), time.process_time()
        error, raised = "", None
        try:
            result = self._in_cell(version.function, **values)
            drive = drive_of(result, self.returned)
        except BaseException as failure:  # not even a SystemExit may end the thread without a word
            line = line_of(_code_of(version.function), traceback.walk_tb(failure.__traceback__)).removeprefix(", ")
            say_what_was_meant(failure)
            error, raised = f"{line or self.name}: {type(failure).__name__}: {failure}", failure
        passed, worked = time.perf_counter() - began, time.process_time() - worked
        with self._lock:
            if self._thread is not me:
                return False
            self._look_at_step()
            # Where the process did not work, it was suspended: a step is not to blame, and the next one is due.
            if not error and self._unseen >= HELD and worked >= WORKS * self._unseen:
                error = (
                    f"{self.name}: a step took {passed:.1f} s, in which it, or another thread, held the GIL: "
                    "nothing else could run, and zero came late"
                )
            self._in_step, self.step_time = False, passed
            if not error:
                self.returned, self.kept, self.error = drive, result is None, ""
                self._steps_a_second = self._rate.rate(self.steps, time.monotonic())
        if error:
            self._end(FAILED, error=error)
            self._log_error(error, raised)  # after zero, as every log: it may hang
            return False
        # Without the lock, so that whoever stops the program never waits for the robot. They abandon this thread before
        # they stop the robot, and the robot refuses an abandoned thread.
        refused = self._robot.drive(drive.linear, drive.angular, drive.lateral)
        if self._thread is not me or self._interrupted:
            return False
        if refused:
            self._robot.halt()
        self._set_waiting(refused)
        self._call_observers()
        return True

    def _look_at_step(self) -> float:
        """Note the time, and for how long this step was not looked at before. Called with the lock held."""
        now = time.monotonic()
        if self._in_step:
            self._unseen += max(0.0, now - max(self._looked_at, self._step_began) - LATEST_TICK)
        self._looked_at = now
        return now

    def _stand_still(self) -> None:
        """What a step that returns None keeps is a standstill from now on."""
        self.returned, self.kept = STANDSTILL, False

    def _set_waiting(self, why: str) -> None:
        if why != self.waiting:
            self.waiting, self._waiting_since = why, time.monotonic()
            self._call_observers()

    def _in_cell(self, call: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        """Call a function such that what it prints and logs appears below the cell of the program."""
        return self.context.copy().run(call, *args, **kwargs)

    def _log_error(self, error: str, raised: BaseException | None) -> None:
        with without_our_frames(raised) as shown:
            self._in_cell(log.error, "program %s: %s", self.name, error, exc_info=shown)

    def _take_print(self, text: str) -> bool:
        self.prints.add(text, self.clock.look())
        return self.has_view

    def _watch_steps(self) -> None:
        """Find steps that do not return, interrupts, and a deleted robot. In a thread of its own, while it runs."""
        passed, seen, self._looked_at = 0.0, -1, time.monotonic()
        while True:
            time.sleep(TICK)
            self.clock.look()
            with self._lock:
                before, looked_at = self._looked_at, self._look_at_step()
                thread, steps = self._thread, self.steps
                late = [one for one in self._abandoned if looked_at > (one.abandoned_at or looked_at) + GRACE]
                self._abandoned = [one for one in self._abandoned if one not in late and one.is_alive()]
                for one in late:
                    one.end()
                if thread is None and not self._interrupted and not self._abandoned:
                    self._monitor = None
                    return
                passed = passed + min(looked_at - before, LATEST_TICK) if self._in_step and steps == seen else 0.0
                seen = steps
                is_hung = passed >= HUNG
                waiting = self.waiting if time.monotonic() - self._waiting_since > PATIENCE else ""
                where = (
                    line_of(_code_of(self.version.function), frames_of(thread)).removeprefix(", ") if is_hung else ""
                )
            if self._interrupted:
                self._interrupted = False
                note = "paused, because the kernel was interrupted"
                self.pause(note)
                self._in_cell(inform, f"program {self.name}: {note}")
            elif thread is not None and self._robot.is_gone():
                note = "ended, because its robot was deleted"
                self.close(note)
                self._in_cell(inform, f"program {self.name}: {note}")
            elif is_hung:
                error = f"{where or self.name}: a step has not returned for half a second, and was abandoned"
                self._end(FAILED, error=error)
                self._in_cell(self._log, f"program {self.name}: {error}")
            elif waiting:
                self._in_cell(self._log, f"program {self.name}: {waiting}")


def _code_of(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function of the user that runs: of a state machine, one of many."""
    return getattr(function, "current", function)

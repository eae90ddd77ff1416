"""A program that drives a robot, step by step, and that may be replaced while it runs."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from contextvars import copy_context
from dataclasses import replace
from functools import partial
from math import isnan
from typing import Any

from ..runtime.clock import Scheduler
from ..runtime.clock import scheduler as threads
from ..runtime.inform import inform
from ..runtime.log_once import LogOnce, call_in_thread
from ..runtime.no_input import without_input
from ..runtime.platform_fixes import capture_prints, release_prints
from ..runtime.policies import NO_RETURN, STEP
from ..runtime.runner import Call, Runner
from ..runtime.short_traceback import without_our_frames
from ..runtime.user_function import error_in
from ..samples import Pose
from ..samples.staleness import STEP_SILENCE
from ..samples.state_span import spelled
from ..widget.observed import Observed
from ..widget.rate import RateMeter
from .drive import STANDSTILL, Drive, drive_of
from .lines.watch import LineWatch
from .prints import Prints
from .robot import DRIVEN, GIVEN, TURNED, DrivenRobot, NotReadyError
from .step_clock import StepClock
from .variables import ProgramState, Variables
from .version import Version

log = logging.getLogger("robowidgets")

HELD = 1.0
"""Seconds without a check by the monitor, in a process that worked, after which a step counts as holding the GIL."""

WORKS = 0.05
"""Seconds of processor time per second from which a process counts as working although its threads wait for the GIL."""

PATIENCE = 1.0
"""Seconds after which the log says why a program does not drive."""

RUNNING, PAUSED, FAILED, ENDED = "running", "paused", "failed", "ended"


class Program(Observed):
    """A program of a robot: its versions, its state, and the thread that calls it step by step.

    `robowidgets.feeds.Feed.program` returns it. It may be called like its function.

    - An exception stops the robot; the program waits for its next version, or for `run`.
    - A step that does not return for half a second is abandoned: the robot is stopped, and that step cannot drive any
      more. The next version runs in another thread.
    - A step that held the GIL for a second or longer fails, too. It could not be abandoned in that time, and only a
      guard could send zero.
    - Its time counts while it can make steps, but not while it is paused or waits, or while the process is suspended.
    - If a version is replaced during a step, the speed of that step is not sent.

    A runner calls and monitors the steps; see `robowidgets.runtime.policies`. The robot is always stopped after a step
    has lost its right to drive, never before, so that an abandoned step cannot drive on.

    Args:
        name: its name.
        robot: the robot that it drives.
        variables: the variables of the robot.
        scheduler: provides the threads and the clock.

    Attributes:
        state: the values that it keeps from step to step and from version to version.
        version: the version in force.
        mode: ``running``, ``paused``, ``failed`` or ``ended``.
        error: the last error, with its line; empty if the last step succeeded.
        waiting: why it does not step or drive now, though it runs; empty if it does.
        note: the last event other than an error, as text for the user.
        steps: the number of steps.
        got: the samples of the last step, by parameter, without time, state and variables.
        step_time: the duration of the last step in seconds.
        returned: the speed that the last step asked for.
        kept: True if the last step returned None, which keeps the speed.
        prints: the last lines that it printed.
        clock: the time of its steps in seconds, from the first step on.
        context: the context of the cell that defined it last, so that its prints and logs appear below that cell.
    """

    def __init__(self, name: str, robot: DrivenRobot, variables: Variables, scheduler: Scheduler = threads) -> None:
        super().__init__()
        self.name, self.state, self.variables = name, ProgramState(), variables
        self.version = Version(lambda: None, number=0)
        self.mode, self.error, self.waiting, self.note = PAUSED, "", "", ""
        self.steps, self.step_time, self.returned, self.kept = 0, 0.0, STANDSTILL, False
        self.got: dict[str, Any] = {}
        self.prints = Prints()
        self.keeps = False
        """True if another run of its cell continues with its `state` and its time after its end."""
        self.has_view = False
        """True while a widget shows its prints."""
        self.lines: LineWatch | None = None
        """Notes the values of the lines of each step; None if no widget shows them."""
        self._robot = robot
        self._lock = threading.RLock()
        self._now = scheduler.clock.now
        self._runner = Runner(
            self._turn,
            self._lock,
            "robowidgets-program",
            STEP,
            on_look=self._look,
            looks="robowidgets-monitor",
            scheduler=scheduler,
        )
        self._inputs = robot.listen(self._wake)
        self._once = False
        """True while it is to make a single step."""
        self._fresh = False
        """True if a message of the topic ``on`` came since the last step."""
        self.clock = StepClock(self._now)
        self._began: dict[str, float] = {}
        """The metres and radians of odometry to count from."""
        self._counted: dict[str, float] = {}
        """The metres and radians of the last step, with which another run of its cell goes on."""
        self._since = self._now()
        self._due = 0.0
        """The time of the next step. A program on a topic reports at this time that no message has come."""
        self._steps_a_second = self._waiting_since = 0.0
        self._rate = RateMeter()
        self._log = LogOnce(partial(self._say, log.warning))
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
        """The measured steps per second."""
        return 0.0 if isnan(self._steps_a_second) or not self._runner.is_at_work else self._steps_a_second

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics of its samples, and the topic ``on``."""
        return self._inputs.topics

    @property
    def since(self) -> float:
        """Seconds since this version took effect."""
        return self._now() - self._since

    # -- requests of the user ------------------------------------------------------------------------------------------

    def replace(self, version: Version) -> None:
        """Run another version from the next step on."""
        before, asked = self.version, (version.asks_for, version.topics, version.on)
        if before.number == 0 or asked != (before.asks_for, before.topics, before.on):
            wanted = {name: version.topics.get(name) for name in version.asks_for if name not in GIVEN}
            self._inputs.choose(wanted, version.on)
        with self._lock:
            self.version, self._since = version, self._now()
            self._due = self._since + STEP_SILENCE if version.on else min(self._due, self._since + 1 / version.rate)
            self.error = self.note = self.waiting = ""
            self._log = LogOnce(partial(self._say, log.warning))
            self.context = copy_context()
            if self._runner.current is not None or self.mode != RUNNING:
                self._detach()
            self._start()
        self._call_observers()

    def continue_from(self, before: Program) -> None:
        """Continue with the `state`, the time and the odometry of a program that has ended."""
        self.state, self.clock, self._counted = before.state, before.clock, before._counted

    def change(self, before: Version, version: Version) -> None:
        """Run another version from the next step on, unlike `replace` only if the program is running.

        Args:
            before: the version that it was made from.
            version: the other one, with the same parameters, topics and rate.

        Raises:
            RuntimeError: a third version is in force, or the program has ended.
        """
        with self._lock:
            self._check_not_ended()
            if self.version is not before:
                raise RuntimeError(f"version {self.version.number} of {self.name} is in force now")
            self.version, self._since = version, self._now()
            is_running = self.mode == RUNNING
            if self._runner.current is not None or not is_running:
                self._detach()
            if is_running:
                self._log = LogOnce(partial(self._say, log.warning))
                self._start()
            else:
                self.mode, self.error = PAUSED, ""
                self.note = f"version {version.number} drives after Run"
        self._call_observers()

    def run(self) -> None:
        """Continue after a pause or an error."""
        with self._lock:
            if not self._runner.is_at_work and self.mode != ENDED:
                self.error = self.note = ""
                self._start()
        self._call_observers()

    def restart(self, put_to: Pose | None = None) -> None:
        """Start again with an empty `state`, at time 0, and with a state machine in its initial state.

        Args:
            put_to: the pose to which odometry was set at the same time, or None if it goes on.

        Raises:
            RuntimeError: it has ended.
        """
        if put_to is not None:
            self._inputs.put_to(put_to)
        with self._lock:
            self._check_not_ended()
            self._detach()
            if hasattr(self.version.function, "fresh"):
                self.version = replace(self.version, function=self.version.function.fresh())
            self.state, self.clock, self.prints = ProgramState(), StepClock(self._now), Prints()
            self._began, self._counted = {}, {}
            self.error = self.note = self.waiting = ""
            self._stand_still()
            self._start()
        self._call_observers()

    def go_to(self, state: str) -> None:
        """Move its state machine to a state at the next step, named as in `Machine.active`: ``"avoid.turn"``.

        Raises:
            TypeError: it is not a state machine. ValueError: it has no such state. RuntimeError: it has ended.
        """
        self._check_not_ended()
        function = self.version.function
        if not hasattr(function, "go_to"):
            raise TypeError(f"{self.name} is not a state machine and has no state {state!r} to go to")
        function.go_to(state)
        if self.mode != RUNNING:
            self.note = f"goes to {spelled(state)} at its next step"
        self._call_observers()

    def pause(self, note: str = "") -> None:
        """Stop making steps, and stop the robot."""
        self._end(PAUSED, note)

    def step(self) -> None:
        """Make one step while paused. Its speed lasts at most for the hold time of the robot."""
        with self._lock:
            if not self._runner.is_at_work and self.mode != ENDED:
                self.error = self.note = ""
                self._start(once=True)
        self._call_observers()

    def close(self, note: str = "", *, keeps: bool = False) -> None:
        """End it and stop the robot. ``keeps`` saves its `state` for the next run of its cell, else it is forgotten."""
        self._end(ENDED, note)
        self._inputs.close()
        self.keeps = keeps
        if not keeps:
            self.state = ProgramState()

    def interrupt(self) -> None:
        """Stop the robot now, and pause in a moment. Safe in a signal handler: it takes no lock of the program."""
        if self._runner.interrupt():
            self._robot.halt()

    # -- within --------------------------------------------------------------------------------------------------------

    def _check_not_ended(self) -> None:
        if self.mode == ENDED:
            raise RuntimeError(f"the program {self.name} has ended: run its cell again")

    def _wake(self) -> None:
        with self._lock:
            self._fresh = True
            if self._runner.is_at_work:
                self._runner.wake()

    def _start(self, *, once: bool = False) -> None:
        """Make steps from now on. Called with the lock held."""
        if not self._runner.is_at_work:
            self._due = self._now() + (STEP_SILENCE if self.version.on else 0.0)
        self._once = once
        self._runner.wake()
        self.mode = PAUSED if once else RUNNING

    def _detach(self) -> None:
        """Stop making steps. A step under way may finish, but not drive. Called with the lock held."""
        self._runner.detach(even_if_current=True)

    def _end(self, mode: str, note: str = "", error: str = "", run: object = None) -> bool:
        """Stop making steps, then stop the robot. Return False if the program or this run has already ended."""
        with self._lock:
            if self.mode == ENDED or run not in (None, self._runner.run):
                return False
            self._detach()
            self.clock.stop()
            self.mode, self.error, self.waiting = mode, error, ""
            self.note = note or self.note
            self._stand_still()
        self._robot.halt()
        self._call_observers()
        return True

    def _turn(self, call: Call) -> float:
        """Make a step if it is due. Return the time of the next call. Runs in a thread of the runner."""
        run = self._runner.run
        with self._lock:
            version, now = self.version, self._now()
            is_fresh, self._fresh = version.on is not None and self._fresh, False
            if now < self._due and not is_fresh:
                return self._due
            if version.on is None:
                self._due = max(self._due + 1 / version.rate, now)
        capture_prints(self._take_print)
        is_silent = version.on is not None and not is_fresh
        values, error, _ = call(self._prepare, version, is_silent, of=self)
        if isinstance(error, NotReadyError):
            self._hold_back(str(error), run)
        elif error is not None:  # an error of robowidgets, which must not end the thread silently
            self._fail(f"{type(error).__name__}: {error}", error, run)
        elif values is not None:
            self._step(call, version, values, run)
        with self._lock:
            if self._runner.run is not run:
                return now  # the runner ends this thread
            once = self._once
            if once:
                self.clock.stop(1 / version.rate if values is not None else 0.0)
                self._detach()
            if self.version.on is not None:
                self._due = self._now() + STEP_SILENCE
            due = self._due
        if once:
            self._call_observers()
        return due

    def _prepare(self, version: Version, is_silent: bool) -> dict[str, Any] | None:
        """Start the clock and return the arguments of a step; NotReadyError if no step can be made."""
        if self._robot.is_stopped():
            raise NotReadyError("Stop is pressed")
        if is_silent and version.on is not None:
            raise NotReadyError(self._inputs.why_silent(version.on))
        values = self._inputs.take()
        for name in (DRIVEN, TURNED):
            if name in values:
                values[name] -= self._began.setdefault(name, values[name] - self._counted.get(name, 0.0))
                self._counted[name] = values[name]
        values.update(time=self.clock.start(), state=self.state, variables=self.variables)
        if not values.keys() >= {*version.asks_for}:
            return None  # the next version has already chosen other samples, and takes effect in a moment
        return {name: values[name] for name in version.asks_for}

    def _hold_back(self, why: str, run: object) -> None:
        """Record why no step can be made now, and stop the robot unless Stop has done so."""
        with self._lock:
            if self._runner.run is not run:
                return
            self.clock.stop()
            self._stand_still()
        if not self._robot.is_stopped():
            self._robot.halt()
        self._set_waiting(why, run)

    def _step(self, call: Call, version: Version, values: dict[str, Any], run: object) -> None:
        """Make a step and send its speed."""
        began, worked = time.perf_counter(), time.process_time()
        made, error, unseen = call(self._make, version, values, run, of=self)
        passed, worked = time.perf_counter() - began, time.process_time() - worked
        self.step_time = passed
        if error is not None:
            self._fail(error_in(error), error, run)
            return
        # A process that did not work was suspended: the step is not to blame, and the next step is due.
        if unseen >= HELD and worked >= WORKS * unseen:
            stopped = "the guard stopped the robot meanwhile" if self._robot.is_guarded() else "zero came late"
            held = (
                f"a step took {passed:.1f} s, in which it, or another thread, held the GIL: "
                f"nothing else could run, and {stopped}"
            )
            self._fail(held, None, run)
            return
        if made is None:
            return
        with self._lock:
            if self._runner.run is not run:
                return
            (drive, self.kept), self.error = made, ""
            self.returned = drive
            self._steps_a_second = self._rate.rate(self.steps, self._now())
        # Without the lock, so that stopping the program never waits for the robot. A stop abandons this thread and then
        # stops the robot, and the robot refuses speeds of an abandoned thread.
        refused, error, _ = call(self._robot.drive, drive.linear, drive.angular, drive.lateral, of=self)
        if error is not None:
            self._fail(f"{type(error).__name__}: {error}", error, run)
            return
        if refused:
            self._robot.halt()
        self._set_waiting(refused, run)
        self._call_observers()

    def _make(self, version: Version, values: dict[str, Any], run: object) -> tuple[Drive, bool] | None:
        """Call the function. Return its speed and True if it keeps the previous speed, or None if the run is over."""
        with self._lock:
            if self._runner.run is not run or self.version is not version:
                return None
            self.steps += 1
            self.got = {name: value for name, value in values.items() if name not in GIVEN}
        lines = self.lines
        with without_input():
            if lines is None:
                result = self._in_cell(version.function, **values)
            else:
                of = self.name, version.number
                made_at = self.steps, self.clock.look()
                result = self._in_cell(lines.step, of, made_at, version.function, values)
        return drive_of(result, self.returned), result is None

    def _fail(self, error: str, raised: BaseException | None, run: object) -> None:
        if self._end(FAILED, error=error, run=run):
            self._log_error(error, raised)  # after sending zero, because logging may hang

    def _stand_still(self) -> None:
        """Set the speed that a step keeps by returning None to standstill."""
        self.returned, self.kept = STANDSTILL, False

    def _set_waiting(self, why: str, run: object) -> None:
        with self._lock:
            if why == self.waiting or self._runner.run is not run:
                return
            self.waiting, self._waiting_since = why, self._now()
        self._call_observers()

    def _in_cell(self, call: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        """Call a function so that its prints and logs appear below the cell of the program."""
        return self.context.copy().run(call, *args, **kwargs)

    def _log_error(self, error: str, raised: BaseException | None) -> None:
        with without_our_frames(raised) as shown:
            self._in_cell(log.error, "program %s: %s", self.name, error, exc_info=shown)

    def _take_print(self, text: str) -> bool:
        self.prints.add(text, self.clock.look())
        return self.has_view

    def _say(self, write: Callable[[str], object], text: str) -> None:
        """Write a line below the cell of the program, in another thread, because a log must not delay the monitor."""
        call_in_thread(partial(self.context.copy().run, write, f"program {self.name}: {text}"))

    def _look(self) -> None:
        """Detect a late step, an interrupt, and a deleted robot. Runs in the thread of the monitor."""
        self.clock.look()
        runner = self._runner
        with self._lock:
            run, is_late = runner.run, runner.is_late
            where = runner.where(_code_of(self.version.function)).removeprefix(", ") if is_late else ""
            waiting = self.waiting if self._now() - self._waiting_since > PATIENCE else ""
        if run is None:
            release_prints()
        elif runner.is_interrupted:
            note = "paused, because the kernel was interrupted"
            self.pause(note)
            self._say(inform, note)
        elif self._robot.is_gone():
            note = "ended, because its robot was deleted"
            self.close(note)
            self._say(inform, note)
        elif is_late:
            error = f"{where}: {NO_RETURN}" if where else NO_RETURN
            if self._end(FAILED, error=error, run=run):
                self._log(error)
        elif waiting:
            self._log(waiting)


def _code_of(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the user's function that runs now: the current function of a state machine, or the function itself."""
    return getattr(function, "current", function)

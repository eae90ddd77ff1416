"""Late steps, and steps that are left behind, by a clock that the test moves.

The robot is a sink of the command watchdog, which has the same clock: it notes when each speed reaches it.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from robowidgets.behaviors import Drive
from robowidgets.behaviors.program import Program
from robowidgets.behaviors.robot import DrivenRobot
from robowidgets.behaviors.variables import Variables
from robowidgets.behaviors.version import Version
from robowidgets.driving.command_watchdog import CommandWatchdog, RefusedError, Velocity
from robowidgets.runtime.clock import Threads
from robowidgets.runtime.policies import NO_RETURN, STEP
from robowidgets.runtime.user_threads import UserThread
from robowidgets.samples.staleness import STEP_SILENCE

from ..clocks import ManualClock
from ..waiting import threads_named, wait_for

pytestmark = pytest.mark.usefixtures("user_limits")

WORKER = "robowidgets-program"
HUNG = (WORKER,)
REFUSED = "this function was disconnected, replaced or ended while it was at work"


class Inputs:
    """Samples that never come, of a topic that wakes the program on demand."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self.wake = wake

    def choose(self, wanted: Any, on: str | None) -> None:
        pass

    def take(self) -> dict[str, Any]:
        return {}

    def why_silent(self, on: str) -> str:
        return f"waiting for {on}"

    def close(self) -> None:
        pass


class Bench:
    """A program on a robot that notes each command and its time."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.heard: list[tuple[float, float]] = []
        self.halts: list[list[bool]] = []
        """For each halt, True for each working thread that was abandoned."""
        self.ends: list[float] = []
        self.gate = threading.Event()
        self.gone = False
        self.watchdog = CommandWatchdog(self._hear, clock=self.clock)
        robot = DrivenRobot(
            where="robot",
            is_gone=lambda: self.gone,
            is_stopped=lambda: self.watchdog.stopped,
            listen=Inputs,
            drive=self.drive,
            halt=self._halt,
        )
        self.program = Program("go", robot, Variables(), Threads(self.clock))

    def _hear(self, linear: float, _angular: float, _lateral: float) -> None:
        self.heard.append((round(self.clock.now(), 6), linear))

    def _halt(self) -> None:
        workers = [one for one in threading.enumerate() if isinstance(one, UserThread) and one.name == WORKER]
        self.halts.append([one.is_abandoned for one in workers])
        self.watchdog.stop_program()

    def drive(self, linear: float, angular: float = 0.0, lateral: float = 0.0) -> str:
        """Drive, with a hold too long to hide a missing zero, and return the reason of a refusal."""
        try:
            self.watchdog.drive(Velocity(linear, angular, lateral), hold=1e6)
        except RefusedError as error:
            return str(error)
        return ""

    def define(self, function: Callable[[], Any], **options: Any) -> None:
        number = self.program.version.number + 1
        self.program.replace(Version(function, number=number, **{"rate": 10.0, **options}))

    def hang(self) -> None:
        self.gate.wait(120)

    def drive_then(self, then: Callable[[], Any]) -> None:
        """A program that drives with 0.3 m/s in its first step, at 1000.0 s, and acts otherwise in the second."""
        self.define(lambda: Drive(0.3) if self.program.steps == 1 else then())
        self.clock.settle()
        assert self.heard == [(1000.0, 0.3)]

    def drive_then_hang(self, then: Callable[[], Any] = lambda: None) -> None:
        """The second step, at 1000.1 s, waits until the gate is open; then it acts."""
        entered = threading.Event()
        self.drive_then(lambda: entered.set() or self.hang() or then())
        self.clock.advance(0.1, HUNG)
        assert entered.wait(120)

    def close(self) -> None:
        self.gate.set()
        self.program.close()
        wait_for(lambda: not threads_named(WORKER), "the steps return")
        self.clock.advance(1.0)
        self.watchdog.close()


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    bench = Bench()
    end = UserThread.end

    def noted(thread: UserThread) -> None:
        bench.ends.append(round(bench.clock.now(), 6))
        end(thread)

    monkeypatch.setattr(UserThread, "end", noted)
    yield bench
    bench.close()


def test_a_step_is_late_at_exactly_0_45_s_and_zero_is_sent_in_that_look(bench: Bench) -> None:
    bench.drive_then_hang()
    bench.clock.advance(STEP.late - 0.001, HUNG)
    assert (bench.program.mode, len(bench.heard)) == ("running", 1)
    bench.clock.advance(0.001, HUNG)
    assert bench.program.mode == "failed"
    assert bench.program.error.endswith(NO_RETURN)
    assert bench.program.error.startswith("line ")
    assert bench.heard == [(1000.0, 0.3), (1000.55, 0.0)]


def test_it_is_late_by_the_same_time_wherever_it_begins_between_two_looks(bench: Bench) -> None:
    bench.define(lambda: Drive(0.3) if bench.program.steps == 1 else bench.hang(), rate=1 / 0.117)
    bench.clock.settle()
    bench.clock.advance(0.117, HUNG)
    wait_for(lambda: bench.program.steps == 2, "the second step begins")
    bench.clock.advance(STEP.late, HUNG)
    assert bench.heard == [(1000.0, 0.3), (1000.567, 0.0)]


def test_it_is_abandoned_first_then_the_robot_gets_zero_and_0_5_s_later_it_is_ended(bench: Bench) -> None:
    bench.drive_then_hang()
    bench.clock.advance(STEP.late + STEP.grace + 1.0, HUNG)
    assert bench.halts == [[True]]
    assert bench.heard[-1] == (1000.55, 0.0)
    assert bench.ends[0] == 1001.05


def test_time_in_which_the_process_stood_still_counts_a_tenth_of_a_second(bench: Bench) -> None:
    bench.drive_then_hang()
    bench.clock.advance(0.3, HUNG)
    bench.clock.stand_still(3600.0, HUNG)
    assert bench.program.mode == "running"
    bench.clock.advance(0.049, HUNG)
    assert bench.program.mode == "running"
    bench.clock.advance(0.001, HUNG)
    assert bench.program.mode == "failed"
    assert bench.heard == [(1000.0, 0.3), (4600.4, 0.0)]  # zero for the pause comes first


def test_a_step_in_which_the_computer_slept_does_not_drive_when_it_returns_and_the_program_goes_on(
    bench: Bench,
) -> None:
    bench.drive_then_hang(lambda: Drive(0.2))
    bench.clock.stand_still(3.0, HUNG)
    bench.gate.set()
    bench.clock.settle()
    assert bench.heard == [(1000.0, 0.3), (1003.1, 0.0)]
    assert (bench.program.mode, bench.program.error) == ("running", "")


def test_nor_is_a_step_ended_for_the_time_in_which_the_process_stood_still(bench: Bench) -> None:
    bench.drive_then_hang()
    bench.program.pause()
    bench.clock.advance(0.3, HUNG)
    bench.clock.stand_still(3600.0, HUNG)
    assert not bench.ends
    bench.clock.advance(0.1, HUNG)
    assert bench.ends[0] == 4600.5


def test_an_interrupt_sends_zero_while_another_thread_holds_the_lock_and_it_pauses_at_the_next_look(
    bench: Bench, capsys: pytest.CaptureFixture[str]
) -> None:
    refused: list[str] = []
    bench.drive_then_hang(lambda: refused.append(bench.drive(0.4)))
    is_held, release = threading.Event(), threading.Event()

    def hold() -> None:
        with bench.program._lock:
            is_held.set()
            release.wait(120)

    holder = threading.Thread(target=hold)
    holder.start()
    assert is_held.wait(120)
    bench.program.interrupt()
    wait_for(lambda: bench.heard[1:] == [(1000.1, 0.0)], "zero is sent at that moment")
    bench.gate.set()
    wait_for(lambda: refused == [REFUSED], "the step that was at work drives no more")
    release.set()
    holder.join()
    bench.clock.advance(STEP.look)
    assert bench.program.mode == "paused"
    assert bench.program.note == "paused, because the kernel was interrupted"
    assert bench.heard[1:] == [(1000.1, 0.0)]
    bench.program.run()
    bench.clock.settle()
    assert bench.program.mode == "running"


def test_replaced_while_it_hangs_its_next_version_steps_at_once_and_it_drives_no_more(bench: Bench) -> None:
    refused: list[str] = []
    bench.drive_then_hang(lambda: refused.append(bench.drive(0.4)) or Drive(0.5))
    bench.clock.advance(0.2, HUNG)
    bench.define(lambda: Drive(0.2))
    wait_for(lambda: bench.heard[1:] == [(1000.3, 0.2)], "the next version drives")
    bench.gate.set()
    bench.clock.settle()
    assert refused == [REFUSED]
    bench.clock.advance(1.0)
    assert {speed for _, speed in bench.heard[1:]} == {0.2}
    assert (bench.program.mode, bench.ends) == ("running", [])


def test_paused_while_it_hangs_it_gets_zero_at_once_is_ended_and_may_run_again(bench: Bench) -> None:
    bench.drive_then_hang()
    bench.program.pause()
    wait_for(lambda: bench.heard[1:] == [(1000.1, 0.0)], "zero is sent")
    bench.clock.advance(STEP.grace, HUNG)
    assert (bench.program.mode, bench.ends) == ("paused", [1000.6])
    bench.gate.set()
    bench.define(lambda: Drive(0.2))
    bench.clock.settle()
    assert bench.heard[-1] == (1000.6, 0.2)


def test_a_step_that_pauses_its_program_may_go_on_but_not_drive(bench: Bench) -> None:
    refused: list[str] = []

    def step() -> Drive:
        bench.program.pause()
        refused.append(bench.drive(0.4))
        bench.hang()
        return Drive(0.5)

    bench.drive_then(step)
    bench.clock.advance(0.1, HUNG)
    wait_for(lambda: refused == [REFUSED], "it is refused")
    bench.clock.advance(2.0, HUNG)
    assert bench.ends == [], "it continues on its own"
    bench.gate.set()
    bench.clock.settle()
    assert bench.heard == [(1000.0, 0.3), (1000.1, 0.0)]
    assert bench.program.mode == "paused"


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (SystemExit("out"), "SystemExit: out"),
        (KeyboardInterrupt("mine"), "KeyboardInterrupt: mine"),
        (GeneratorExit(), "GeneratorExit: "),
    ],
)
def test_whatever_a_step_raises_stops_the_robot_at_once_and_is_reported_with_its_line(
    bench: Bench, error: BaseException, words: str
) -> None:
    def fail() -> None:
        raise error

    bench.drive_then(fail)
    bench.clock.advance(0.1)
    assert bench.heard == [(1000.0, 0.3), (1000.1, 0.0)]
    line = fail.__code__.co_firstlineno + 1
    assert (bench.program.mode, bench.program.error) == ("failed", f"line {line}: {words}")


def test_a_step_that_calls_itself_without_end_is_an_error(bench: Bench) -> None:
    def deeper() -> None:
        deeper()

    bench.drive_then(deeper)
    bench.clock.advance(0.1)
    assert "RecursionError" in bench.program.error
    assert bench.heard[-1] == (1000.1, 0.0)


def test_a_step_that_catches_even_its_end_moves_nothing_and_holds_up_no_later_version(bench: Bench) -> None:
    caught: list[str] = []

    def stubborn() -> None:
        while not bench.gate.is_set():
            try:
                while not bench.gate.is_set():
                    if why := bench.drive(0.4):
                        caught.append(why)
                    time.sleep(0.001)
            except BaseException as error:  # noqa: PERF203
                caught.append(type(error).__name__)

    bench.drive_then(stubborn)
    bench.clock.advance(0.1, HUNG)
    wait_for(lambda: bench.program.steps == 2, "it loops")
    bench.clock.advance(STEP.late, HUNG)
    wait_for(lambda: REFUSED in caught, "it is refused")
    since = len(bench.heard)
    bench.clock.advance(STEP.grace, HUNG)
    wait_for(lambda: "SystemExit" in caught, "it catches its end")
    bench.define(lambda: Drive(0.2))
    wait_for(lambda: bench.heard[-1][1] == 0.2, "the next version drives")
    assert {speed for _, speed in bench.heard[since:]} <= {0.0, 0.2}


def test_a_step_that_catches_all_errors_is_ended_too_once_the_robot_has_zero(bench: Bench) -> None:
    def forever() -> None:
        while True:
            try:  # noqa: SIM105
                bench.gate.is_set()
            except:  # noqa: E722, PERF203
                pass

    bench.drive_then(forever)
    bench.clock.advance(0.1, HUNG)
    wait_for(lambda: bench.program.steps == 2, "it loops")
    bench.clock.advance(STEP.late, HUNG)
    assert bench.halts == [[True]]
    bench.clock.advance(STEP.grace - STEP.look, HUNG)
    wait_for(lambda: bench.clock.advance(STEP.look, HUNG) or not threads_named(WORKER), "it is ended")
    assert bench.heard[-1] == (1000.55, 0.0)


def test_a_thread_that_a_step_starts_is_not_a_step_but_the_steps_go_on(bench: Bench) -> None:
    threads: list[threading.Thread] = []

    def spawn() -> Drive:
        threads.append(threading.Thread(target=bench.hang))
        threads[-1].start()
        return Drive(0.1)

    bench.drive_then(spawn)
    bench.clock.advance(0.55)
    assert bench.program.mode == "running"
    assert len(threads) == 5
    bench.gate.set()
    for thread in threads:
        thread.join()


def test_a_deleted_robot_ends_its_program_at_the_next_look_though_a_step_hangs(bench: Bench) -> None:
    bench.drive_then_hang()
    bench.gone = True
    bench.clock.advance(STEP.look, HUNG)
    assert (bench.program.mode, bench.program.note) == ("ended", "ended, because its robot was deleted")
    assert bench.heard[-1] == (1000.125, 0.0)


def test_a_log_that_hangs_holds_up_no_look_at_the_next_step(bench: Bench) -> None:
    handler = logging.Handler()
    handler.emit = lambda record: None if bench.gate.wait(120) else record  # type: ignore[method-assign]
    logging.getLogger("robowidgets").addHandler(handler)
    try:
        bench.drive_then_hang()
        bench.clock.advance(1.0, HUNG)
        bench.program.run()
        bench.clock.settle(HUNG)
        wait_for(lambda: bench.program.steps == 3, "the next step hangs, too")
        bench.clock.advance(STEP.late, HUNG)
        assert bench.program.mode == "failed"
    finally:
        bench.gate.set()
        logging.getLogger("robowidgets").removeHandler(handler)


def test_an_error_in_a_look_ends_no_looks(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    bench.drive_then_hang()
    monkeypatch.setattr(bench.program.clock, "look", lambda: 1 / 0)
    bench.clock.advance(STEP.look, HUNG)
    monkeypatch.undo()
    bench.clock.advance(STEP.late, HUNG)
    assert bench.heard[-1] == (1000.55, 0.0)


def test_a_single_step_is_made_at_once_and_no_other_one(bench: Bench) -> None:
    bench.define(lambda: Drive(0.3))
    bench.program.pause()
    bench.clock.settle()
    steps = bench.program.steps
    bench.clock.advance(5.0)
    bench.program.step()
    bench.clock.advance(5.0)
    assert (bench.program.steps, bench.program.mode) == (steps + 1, "paused")
    assert bench.heard[-1] == (1005.0, 0.3)


def test_on_a_topic_it_steps_with_each_message_and_says_after_exactly_a_second_that_none_comes(bench: Bench) -> None:
    bench.define(lambda: Drive(0.3), on="/scan")
    inputs: Any = bench.program._inputs
    bench.clock.advance(0.4)
    inputs.wake()
    bench.clock.settle()
    assert bench.heard == [(1000.4, 0.3)]
    bench.clock.advance(STEP_SILENCE - 0.001)
    assert bench.program.waiting == ""
    bench.clock.advance(0.001)
    assert bench.program.waiting == "waiting for /scan"
    assert bench.heard[1:] == [(1001.4, 0.0)]
    inputs.wake()
    bench.clock.settle()
    assert (bench.program.waiting, bench.program.steps) == ("", 2)


def test_no_thread_stays_after_a_pause_and_the_looks_end_with_the_last_one(bench: Bench) -> None:
    bench.drive_then_hang()
    bench.program.pause()
    bench.clock.advance(STEP.grace, HUNG)
    bench.clock.advance(20 * STEP.look, HUNG)  # in which it is ended again
    assert threads_named("robowidgets-monitor") == 0
    bench.gate.set()
    wait_for(lambda: not threads_named(WORKER), "the step returns")

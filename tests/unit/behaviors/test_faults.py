"""Faults in a program, in a real kernel: the robot, in another process, logs every command."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from pathlib import Path
from textwrap import indent

import pytest

from ..feeds.kernel import Kernel
from ..waiting import wait_for

pytestmark = pytest.mark.slow

OPEN = """
import threading
over, gate = False, threading.Lock()
gate.acquire()
feed.close()
feed = feeds.simulator(hz=20, wander=False)
from robowidgets.behaviors import Drive
feed.driving = feeds.Driving(hold=3600.0)  # so that no zero of the hold hides a missing one
"""
PROGRAM = """
@feed.program(rate=50)
def avoid(state):
{body}
"""
LOOKS = PROGRAM.replace("state", "scan")
"""Takes samples: if a busy machine delays them, the newest is too old, and the robot gets zero."""
MARK = """    if state.setdefault("begins", True): state.begins = print((time.monotonic(), 9.0, 0.0), file=log)
"""
"""Writes once into the log that a step begins."""
GOOD = "    return Drive(0.3)"
SYNTAX_ERRORS = {"SyntaxError", "_IncompleteInputError"}
"""IPython's error for an unclosed bracket, up to Python 3.12 and since."""


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    made = Kernel(tmp_path_factory.mktemp("robot") / "heard.txt")
    yield made
    made.close()


@pytest.fixture
def kernel(shared: Kernel) -> Kernel:
    """A kernel whose robot a program drives at 0.3 m/s."""
    assert shared.run("open the robot", OPEN)["status"] == "ok"
    run(shared, GOOD)
    since = time.monotonic()
    wait_for(lambda: shared.heard_since(since)[-1:] == [0.3], "it drives")
    return shared


def run(kernel: Kernel, body: str, cell: str = "avoid") -> None:
    reply = kernel.run(cell, PROGRAM.format(body=body))
    assert reply["status"] == "ok", reply


def expect(kernel: Kernel, words: str) -> None:
    reply = kernel.run("look", f"assert {words!r} in repr(feed.programs.current), repr(feed.programs.current)")
    assert reply["status"] == "ok", reply


BESIDE = """
beside = feeds.simulator(hz=20, wander=False)
beside.program(lambda: Drive(0.11), rate=50)
"""


def expect_zero(kernel: Kernel, since: float) -> None:
    """Fail unless the robot gets zero, long before the hold ends, and nothing more while another gets six speeds."""
    wait_for(lambda: 0.0 in kernel.heard_since(since), "the robot gets zero")
    first = next(at for at, linear, _ in kernel.heard if at >= since and linear == 0.0)
    assert kernel.run("beside", BESIDE)["status"] == "ok"
    wait_for(lambda: kernel.heard_since(first).count(0.11) >= 6, "the other robot is driven")
    assert kernel.run("alone", "beside.close()")["status"] == "ok"
    assert set(kernel.heard_since(first)) == {0.0, 0.11}


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("    return feed.drvie(1)", "has no attribute 'drvie'; did you mean 'drive'?"),
        ("    return 1 / 0", "failed: line 4: ZeroDivisionError: division by zero"),
        ("    raise SystemExit('out')", "failed: line 4: SystemExit: out"),
        ("    return 0.3", "failed: TypeError: expected a step to return Drive(linear, angular), or None"),
        ("    return Drive(float('nan'))", "failed: line 4: ValueError: linear: expected a finite number of m/s"),
        ("    while not over: pass", "failed: line 4: a step has not returned for half a second, and was abandoned"),
        ("    while not over: feed.drive(0.3)", "failed: line 4: a step has not returned for half a second"),
        ("    gate.acquire()", "failed: line 4: a step has not returned for half a second"),
        ("    while not over: time.sleep(0.1)", "failed: line 4: a step has not returned for half a second"),
        ("    return feed.programs.current.pause()", "paused"),
        ("    feed.stopped = True", "Stop is pressed"),
        ("    return nowhere", "NameError: name 'nowhere' is not defined"),
    ],
)
def test_the_robot_gets_zero_and_the_next_version_runs(kernel: Kernel, body: str, words: str) -> None:
    since = time.monotonic()
    run(kernel, MARK + body)
    wait_for(lambda: 9.0 in kernel.heard_since(since), "its first step begins")
    began = next(at for at, linear, _ in kernel.heard if at >= since and linear == 9.0)
    expect_zero(kernel, began)
    expect(kernel, words)
    run(kernel, "    return Drive(0.1)")
    kernel.run("allow", "feed.stopped, over = False, True; gate.release()")
    since = time.monotonic()
    wait_for(lambda: kernel.heard_since(since)[-3:] == [0.1] * 3, "the next version drives")


def test_an_interrupt_between_cells_and_in_one_stops_the_robot(kernel: Kernel) -> None:
    since = time.monotonic()
    kernel.manager.interrupt_kernel()
    expect_zero(kernel, since)
    expect(kernel, "paused")
    busy = kernel.start("busy", "avoid.run()\nwhile True: time.sleep(0.01)")
    wait_for(lambda: kernel.heard[-1][1] == 0.3, "it drives during a busy cell")
    since = time.monotonic()
    kernel.manager.interrupt_kernel()
    assert kernel.end_of(busy)["ename"] == "KeyboardInterrupt"
    expect_zero(kernel, since)


SLEEPS = """
@feed.program(rate=20)
def avoid(state):
    if state.setdefault("begins", True):
        state.begins = print((time.monotonic(), 9.0, 0.0), file=log)
        time.sleep(0.2)
    return Drive(0.3)
"""


def test_a_process_that_is_suspended_in_a_step_drives_on_when_it_is_resumed(kernel: Kernel) -> None:
    since = time.monotonic()
    assert kernel.run("avoid", SLEEPS)["status"] == "ok"
    wait_for(lambda: 9.0 in kernel.heard_since(since), "the step begins")
    began = next(at for at, linear, _ in kernel.heard if at >= since and linear == 9.0)
    kernel.manager.signal_kernel(signal.SIGSTOP)
    time.sleep(1.5)  # longer than any step may take, and than a step may hold the GIL
    kernel.manager.signal_kernel(signal.SIGCONT)
    resumed = time.monotonic()
    wait_for(lambda: kernel.heard_since(resumed)[-3:] == [0.3] * 3, "it drives on")
    heard = kernel.heard_since(began)
    assert heard[heard.index(0.0) :].count(9.0) == 0, "no command from before the pause is sent after it"
    expect(kernel, "running")


def test_a_cell_with_a_syntax_error_leaves_the_program_as_it_is(kernel: Kernel) -> None:
    since = time.monotonic()
    assert kernel.printed("avoid", "1 / 0") == "the program avoid goes on, in version 1, the one before\n"
    assert kernel.run("avoid", PROGRAM.format(body="    return Drive(0.1"))["ename"] in SYNTAX_ERRORS
    assert kernel.run("other", "1 / 0")["ename"] == "ZeroDivisionError"
    assert kernel.run("avoid", LOOKS.replace("scan", "scn").format(body=GOOD))["ename"] == "TypeError"
    wait_for(lambda: len(kernel.heard_since(since)) > 5, "the version before goes on")
    assert set(kernel.heard_since(since)) == {0.3}
    expect(kernel, "version 1, running")
    goes_on = "the program avoid goes on, in version 2, which this run made before its error\n"
    assert kernel.printed("avoid", PROGRAM.format(body="    return Drive(0.2)") + "1 / 0").endswith(goes_on)


def test_forty_redefinitions_some_in_the_middle_of_a_step_leave_no_gap(kernel: Kernel) -> None:
    since = time.monotonic()
    many = "for i in range(40):\n" + indent(PROGRAM.format(body="    time.sleep(0.02); return Drive(0.2)"), "    ")
    assert kernel.run("many", many + "    time.sleep(0.013)\n")["status"] == "ok"
    run(kernel, "    return Drive(0.1)")
    wait_for(lambda: kernel.heard_since(since)[-3:] == [0.1] * 3, "the newest drives")
    assert 0.0 not in kernel.heard_since(since)
    count = """
import threading
assert avoid.version.number == 42
assert sum("robowidgets-program" in thread.name for thread in threading.enumerate()) == 1
"""
    wait_for(lambda: kernel.run("count", count)["status"] == "ok", "no thread of an old version is left")


def test_functions_that_it_calls_may_be_redefined_and_what_it_keeps_survives(kernel: Kernel) -> None:
    kernel.run("helper", "def wanted(state): return 0.21")
    run(kernel, "    state.steps = state.get('steps', 0) + 1; return Drive(wanted(state))")
    wait_for(lambda: kernel.heard[-1][1] == 0.21, "it calls the function")
    kernel.run("helper", "def wanted(state): return 0.22 if state.steps > 1 else 0.0")
    wait_for(lambda: kernel.heard[-1][1] == 0.22, "it calls the new one")
    run(kernel, "    return Drive(0.23 if state.steps > 1 else 0.0)")
    wait_for(lambda: kernel.heard[-1][1] == 0.23, "the next version has the state")


def test_points_beyond_the_limits_are_cut_and_noted(kernel: Kernel) -> None:
    run(kernel, "    return Drive(7.0, 90)")
    wait_for(lambda: kernel.heard[-1][1:] == (0.5, 1.0), "it is cut")
    assert kernel.run("look", "assert '7 m/s is cut to 0.5' in feed.drive_status")["status"] == "ok"


def test_another_program_takes_the_place_of_the_first(kernel: Kernel) -> None:
    reply = kernel.run("other", "@feed.program(rate=20)\ndef follow():\n    return Drive(0.1)\n")
    assert reply["status"] == "ok"
    since = time.monotonic()
    wait_for(lambda: len(kernel.heard_since(since)) > 10, "the second one drives")
    assert set(kernel.heard_since(since)) == {0.1}
    assert kernel.run("look", "assert avoid.mode == 'ended' and 'follow' in avoid.note, avoid.note")["status"] == "ok"


def test_two_robots_have_a_program_each_and_one_that_hangs_harms_only_its_own(kernel: Kernel) -> None:
    second = """
robot = feeds.simulator(hz=20, wander=False)
robot.driving = feeds.Driving(hold=3600.0)
@robot.program(rate=20)
def hang(scan):
    while True: robot.drive(0.11)
"""
    assert kernel.run("second", second)["status"] == "ok"
    wait_for(lambda: 0.11 in kernel.heard_since(0.0), "the second robot moves")
    wait_for(lambda: kernel.heard_since(0.0)[-20:].count(0.3) == 20, "only the first drives on")
    assert kernel.run("close", "assert 'abandoned' in hang.error; robot.close()")["status"] == "ok"


@pytest.mark.parametrize(
    "cell",
    [
        "feed.close()",
        "feed.connection.on_lost('no route', 1.0)",
        "feed.driving = feeds.Driving(hold=0.5, needs_page=True)",
    ],
)
def test_a_robot_that_is_closed_lost_or_unseen_gets_zero(kernel: Kernel, cell: str) -> None:
    since = time.monotonic()
    assert kernel.run("fault", cell)["status"] == "ok"
    expect_zero(kernel, since)


def test_a_robot_that_is_blind_gets_zero(kernel: Kernel) -> None:
    assert kernel.run("avoid", LOOKS.format(body="    return Drive(0.2)"))["status"] == "ok"
    wait_for(lambda: kernel.heard[-1][1] == 0.2, "it drives")
    assert kernel.run("fault", "feed.connection.middleware.follow(frozenset())")["status"] == "ok"
    wait_for(lambda: kernel.heard[-1][1] == 0.0, "the robot gets zero")


@pytest.mark.parametrize("body", ["    gate.acquire()", "    while not over: feed.drive(0.3)"])
def test_a_robot_that_is_closed_while_a_step_hangs_gets_zero_and_closing_returns(kernel: Kernel, body: str) -> None:
    since = time.monotonic()
    run(kernel, MARK + body)
    wait_for(lambda: 9.0 in kernel.heard_since(since), "its first step begins")
    began = next(at for at, linear, _ in kernel.heard if at >= since and linear == 9.0)
    assert kernel.run("close", "feed.close()")["status"] == "ok"
    expect_zero(kernel, began)
    expect(kernel, "ended")
    kernel.run("allow", "over = True; gate.release()")


MACHINE = """
@feed.program(rate=20)
class Walker:
    def slow(): return Drive({slow})
    def fast(): return Drive(0.2)
    moves = "slow -> fast on hurry", "fast -> slow on {back}"
"""


def test_a_state_machine_is_rewritten_and_its_events_redefined_while_it_runs(kernel: Kernel) -> None:
    kernel.run("event", "def hurry(): return False\ndef calm(): return False")
    assert kernel.run("walker", MACHINE.format(slow=0.1, back="calm"))["status"] == "ok"
    wait_for(lambda: kernel.heard[-1][1] == 0.1, "its first state drives")
    kernel.run("event", "def hurry(): return True\ndef calm(): return False")
    wait_for(lambda: kernel.heard[-1][1] == 0.2, "the new event is true")
    assert kernel.run("walker", MACHINE.format(slow=0.1, back="clm"))["ename"] == "TypeError"
    assert kernel.run("walker", MACHINE.format(slow=0.15, back="calm"))["status"] == "ok"
    since = time.monotonic()
    wait_for(lambda: len(kernel.heard_since(since)) > 5, "the new version drives")
    assert set(kernel.heard_since(since)) == {0.2}  # its active state is unchanged
    kernel.run("event", "def hurry(): return False\ndef calm(): return True")
    wait_for(lambda: kernel.heard[-1][1] == 0.15, "it goes back into the state of the new version")
    kernel.run("event", "def calm(): return nowhere")
    kernel.run("event", "def hurry(): return nowhere")
    wait_for(lambda: kernel.heard[-1][1] == 0.0, "an event raises")
    expect(kernel, "NameError: name 'nowhere' is not defined")


@pytest.mark.parametrize("cell", ["del feed, avoid", "del feed", "feed = feeds.simulator(wander=False)"])
def test_a_robot_that_is_deleted_or_whose_name_gets_another_one_gets_zero(kernel: Kernel, cell: str) -> None:
    since = time.monotonic()
    assert kernel.run("delete", cell)["status"] == "ok"
    expect_zero(kernel, since)
    assert kernel.run("open", "feed = feeds.simulator()")["status"] == "ok"  # for the tests that follow


def test_a_deleted_robot_drives_on_while_a_view_of_it_is_there_until_the_cell_of_the_view_runs_again(
    kernel: Kernel,
) -> None:
    assert kernel.run("view", "feed.show();")["status"] == "ok"
    assert kernel.run("delete", "import gc; del feed; gc.collect()")["status"] == "ok"
    since = time.monotonic()
    wait_for(lambda: len(kernel.heard_since(since)) > 5, "it drives on")
    since = time.monotonic()
    assert kernel.run("view", "feed = feeds.simulator(wander=False); feed.show();")["status"] == "ok"
    expect_zero(kernel, since)
    expect_program = "assert avoid.mode == 'ended' and 'its robot was deleted' in avoid.note, avoid"
    assert kernel.run("look", expect_program)["status"] == "ok"


@pytest.mark.parametrize("end", ["restart_kernel", "shutdown_kernel"])
def test_the_restart_and_the_end_of_the_kernel_leave_the_robot_at_zero(tmp_path: Path, end: str) -> None:
    kernel = Kernel(tmp_path / "heard.txt")
    try:
        assert kernel.run("open the robot", OPEN)["status"] == "ok"
        run(kernel, GOOD)
        wait_for(lambda: kernel.heard_since(0.0)[-1:] == [0.3], "it drives")
        since = time.monotonic()
        getattr(kernel.manager, end)()
        wait_for(lambda: 0.0 in kernel.heard_since(since), "the robot gets zero")
        assert kernel.heard[-1][1] == 0.0, "the last that it got"
    finally:
        kernel.close()

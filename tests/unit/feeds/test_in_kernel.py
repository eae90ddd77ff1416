"""Driving from the cells of a real kernel: cells that run again, raise, or are interrupted."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from ..waiting import wait_for
from .kernel import OPEN, Kernel, Log

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    made = Kernel(tmp_path_factory.mktemp("robot") / "heard.txt")
    yield made
    made.close()


@pytest.fixture
def kernel(shared: Kernel) -> Kernel:
    """The kernel of all tests, with a robot of this test."""
    shared.open_anew()
    return shared


@pytest.fixture
def own_kernel(tmp_path: Path) -> Iterator[Kernel]:
    """A kernel that the test may end, or leave busy."""
    made = Kernel(tmp_path / "heard.txt")
    yield made
    made.close()


@pytest.fixture
def log(tmp_path: Path) -> Log:
    return Log(tmp_path / "heard.txt")


HOLD = "feed.driving = feeds.Driving(hold=3600.0)\n"
AWAIT_ZERO = "while not open(log.name).read().endswith(' 0.0, 0.0)\\n'): time.sleep(0.01)"
"""Waits as long as necessary until the robot got zero; with `HOLD`, it does not get it on its own."""
LOOP = """
while True:
    feed.drive(0.3)
    time.sleep(0.05)
"""


def test_an_interrupt_sends_zero_at_once(kernel: Kernel) -> None:
    loop = kernel.start("loop", HOLD + LOOP)
    wait_for(lambda: len(kernel.heard) > 5, "it drives")
    kernel.manager.interrupt_kernel()
    assert kernel.end_of(loop)["ename"] == "KeyboardInterrupt"
    wait_for(lambda: kernel.heard[-1][1] == 0.0, "zero is sent long before the hold ends")


def test_an_interrupt_that_the_cell_catches_sends_zero_at_once(kernel: Kernel) -> None:
    indented = LOOP.replace("\n", "\n    ")
    loop = kernel.start("loop", f"{HOLD}try:{indented}\nexcept KeyboardInterrupt:\n    {AWAIT_ZERO}")
    wait_for(lambda: len(kernel.heard) > 5, "it drives")
    kernel.manager.interrupt_kernel()
    assert kernel.end_of(loop)["status"] == "ok", "zero is sent before the cell has ended"


def test_a_cell_that_raises_after_it_drove_sends_zero_at_once_one_that_ends_well_does_not(kernel: Kernel) -> None:
    assert kernel.run("well", "feed.driving = feeds.Driving(hold=1.5); feed.drive(0.2)")["status"] == "ok"
    wait_for(lambda: kernel.heard and kernel.heard[-1][1] == 0.0, "zero follows")
    assert kernel.heard[-1][0] - kernel.heard[-2][0] > 1.0, "at the end of the hold, not of the cell"
    badly = "feed.driving = feeds.Driving(hold=3600.0); feed.drive(0.2); 1 / 0"
    assert kernel.run("badly", badly)["ename"] == "ZeroDivisionError"
    wait_for(lambda: len(kernel.heard) == 4, "zero is sent long before the hold ends")


def test_zero_does_not_wait_for_the_traceback_of_a_cell_or_of_a_script(kernel: Kernel, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text("feed.drive(0.2)\n1 / 0\n")
    slow = f"{HOLD}shell = get_ipython(); usual = shell._showtraceback\ndef slowly(*_):\n    {AWAIT_ZERO}\n"
    slow += "    print((time.monotonic(), 9.0, 0.0), file=log)\nshell._showtraceback = slowly"
    assert kernel.run("slow", slow)["status"] == "ok"
    for cell in (script.read_text(), f"%run -i {script}"):
        kernel.run("badly", cell)
        assert [linear for _, linear, _ in kernel.heard[-3:]] == [0.2, 0.0, 9.0], "zero comes before the traceback ends"
    assert kernel.run("usual", "shell._showtraceback = usual")["status"] == "ok"


def test_an_interrupt_of_a_cell_that_awaits_sends_zero_at_once(kernel: Kernel) -> None:
    cell = kernel.start("await", f"{HOLD}import asyncio\nfeed.drive(0.2)\nawait asyncio.sleep(4.0)")
    wait_for(lambda: kernel.heard, "it drives")
    kernel.manager.interrupt_kernel()
    wait_for(lambda: kernel.heard[-1][1] == 0.0, "zero is sent long before the hold ends")
    kernel.end_of(cell)


def break_at(kernel: Kernel, code: str, line: int) -> None:
    """Make JupyterLab's debugger stop a cell at a line."""
    kernel.debug("initialize", adapterID="", pathFormat="path", linesStartAt1=True)
    kernel.debug("attach")
    source = {"path": kernel.debug("dumpCell", code=code)["sourcePath"]}
    kernel.debug("setBreakpoints", source=source, breakpoints=[{"line": line}])
    kernel.debug("configurationDone")


def test_a_breakpoint_holds_a_cell_but_not_the_zero(own_kernel: Kernel) -> None:
    code = "while True:\n    feed.drive(0.2)\n    time.sleep(0.05)\n"
    break_at(own_kernel, code, 3)
    own_kernel.start("held", code)
    wait_for(lambda: [linear for _, linear, _ in own_kernel.heard] == [0.2, 0.0], "it drives once, and zero follows")


HELD = {
    "function": "def hold(scan):\n    feed.drive(0.2)\n    return 0\nfeed.connect('/scan', hold)",
    "step": "from robowidgets.behaviors import Drive\ndef hold(scan):\n    return Drive(0.2)\nfeed.program(hold)",
    "condition": "from robowidgets import LaserWidget\ndef hold(scan):\n    return True\nlaser = LaserWidget()\n"
    "feed.connect('/scan', laser)\nlaser.watch(hold)",
}


PATIENT = """
from robowidgets.behaviors import program
program.STEP = program.STEP._replace(late=3600.0)
"""
"""The first traced step of a busy machine may be late, and a program that failed calls no further step."""


# CPython 3.11 spins at the entry of a function in a thread that a debugger traces: here in the cell that connects.
SPINS = pytest.mark.skipif(sys.version_info < (3, 12), reason="CPython 3.11 spins where a debugger traces a thread")


@pytest.mark.parametrize("kind", ["function", "step", pytest.param("condition", marks=SPINS)])
def test_a_breakpoint_holds_what_runners_call(own_kernel: Kernel, kind: str) -> None:
    assert own_kernel.run("patient", PATIENT)["status"] == "ok"
    break_at(own_kernel, HELD[kind], 3)
    own_kernel.start("held", HELD[kind])
    wait_for(lambda: own_kernel.debug("debugInfo")["stoppedThreads"], "the debugger holds it", every=0.05)


BEHAVE = """
def behave(scan):
    {body}
feed.connect("/scan", behave)
"""


def test_a_cell_that_is_run_again_leaves_nothing_of_its_old_version_driving(kernel: Kernel) -> None:
    kernel.run("behave", BEHAVE.format(body="feed.drive(0.3)"))
    wait_for(lambda: 0.3 in kernel.heard_since(0.0), "the first version drives")
    kernel.run("behave", BEHAVE.format(body="raise RuntimeError('no')"))
    wait_for(lambda: kernel.heard[-1][1] == 0.0, "zero follows")
    stopped = kernel.heard[-1][0]
    kernel.run("other", "got = []\ndef other(scan): got.append(scan)\nfeed.connect('/scan', other)")
    kernel.run("calls", "n = len(got)\nwhile len(got) < n + 3: time.sleep(0.01)")
    assert not any(kernel.heard_since(stopped)), "nothing drives any more, though scans come"
    reply = kernel.run("look", "shown = repr(feed); assert shown.count('behave') == 2, shown")
    assert reply["status"] == "ok", reply
    kernel.run("elsewhere", BEHAVE.format(body="feed.drive(0.1)"))
    since = time.monotonic()
    wait_for(lambda: len(kernel.heard_since(since)) > 10, "the version of another cell drives")
    assert set(kernel.heard_since(since)) == {0.1}


FAILS = {"before it connects": "1 / 0\n{cell}", "after it connected": "{cell}\n1 / 0", "in its syntax": "(\n{cell}"}
OFF = "is off, and its robot got zero: its cell ended with an error; run the cell again, to its end"


@pytest.mark.parametrize("fails", FAILS)
def test_a_cell_that_ends_with_an_error_stops_its_function_and_names_it_until_it_has_run_whole(
    kernel: Kernel, fails: str
) -> None:
    hold = HOLD.replace("3600", "60")  # a longer one is told, each time
    cell = hold + BEHAVE.format(body="feed.drive(0.3)\n    time.sleep(0.01); feed.drive(0.3)")
    kernel.run("behave", cell)
    kernel.run("other", "got = []\ndef other(scan): got.append(scan)\nfeed.connect('/scan', other)")
    wait_for(lambda: kernel.heard[-1:] and kernel.heard[-1][1] == 0.3, "the function drives")
    assert kernel.printed("elsewhere", "1 / 0") == "", "the error of another cell stops nothing"
    printed = kernel.printed("behave", FAILS[fails].format(cell=cell))
    assert printed.splitlines() == [f"`behave` (/scan) {OFF}"]
    calls = "n = len(got)\nwhile len(got) < n + 3: time.sleep(0.01)"
    kernel.run("calls", calls)  # three scans, and nothing drives
    assert kernel.heard[-1][1] == 0.0
    assert kernel.run("look", f"assert repr(feed).count({OFF[:6]!r}) == 1, repr(feed)")["status"] == "ok"
    assert kernel.printed("behave", cell) == ""
    wait_for(lambda: kernel.heard[-1][1] == 0.3, "it drives again")


def test_a_function_of_a_failed_cell_that_never_drove_is_called_on_but_may_not_drive(kernel: Kernel) -> None:
    body = "got.append(scan)\n    if len(got) > 3 and is_failed: feed.drive(0.3)"
    assert kernel.printed("behave", "got, is_failed = [], False" + BEHAVE.format(body=body) + "1 / 0") == ""
    kernel.run("wait", "is_failed = True\nwhile not feed.functions[0].is_off: time.sleep(0.01)")
    assert kernel.run("look", "assert len(got) >= 4 and 'is off' in repr(feed), repr(feed)")["status"] == "ok"
    assert kernel.heard == []


@pytest.mark.parametrize("between_cells", [False, True], ids=["in its cell", "between cells"])
def test_an_interrupt_switches_off_a_function_that_drives_until_its_cell_runs_again(
    kernel: Kernel, between_cells: bool
) -> None:
    behave = BEHAVE.format(body="feed.drive(0.3)")
    request = kernel.start("behave", HOLD + behave + ("" if between_cells else "time.sleep(60)"))
    wait_for(lambda: kernel.heard, "it drives")
    if between_cells:
        assert kernel.end_of(request)["status"] == "ok"
    kernel.manager.interrupt_kernel()
    if not between_cells:
        assert kernel.end_of(request)["ename"] == "KeyboardInterrupt"
    wait_for(lambda: kernel.heard[-1][1] == 0.0, "zero is sent long before the hold ends")
    more = "seen = []\nfeed.connect('/scan', seen.append)\nwhile len(seen) < 3: time.sleep(0.01)"
    assert kernel.run("more scans", more)["status"] == "ok"
    assert "is off: the kernel was interrupted; run its cell again" in kernel.printed("print", "print(feed)")
    assert kernel.heard[-1][1] == 0.0
    kernel.run("behave", behave)
    wait_for(lambda: kernel.heard[-1][1] == 0.3, "it drives again")


def test_an_unending_function_is_replaced_by_running_its_cell_again(kernel: Kernel) -> None:
    kernel.run("behave", BEHAVE.format(body="feed.drive(0.3)\n    while True: time.sleep(0.01)"))
    wait_for(lambda: [linear for _, linear, _ in kernel.heard] == [0.3, 0.0], "it drives once, and zero follows")
    kernel.run("behave", BEHAVE.format(body="feed.drive(0.1)"))
    wait_for(lambda: kernel.heard[-1][1] == 0.1, "the next version drives")


def test_the_end_of_the_kernel_sends_zero_though_a_function_hangs(own_kernel: Kernel) -> None:
    own_kernel.run("behave", BEHAVE.format(body="feed.drive(0.3)\n    time.sleep(3600)"))
    wait_for(lambda: 0.3 in own_kernel.heard_since(0.0), "the function drives, and hangs")
    own_kernel.run("hold", "feed.driving = feeds.Driving(hold=3600.0); feed.drive(0.2)")
    wait_for(lambda: own_kernel.heard[-1][1] == 0.2, "it drives")
    own_kernel.manager.shutdown_kernel()
    assert own_kernel.heard[-1][1] == 0.0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_that_ends_the_process_sends_zero_first_though_functions_and_threads_drive(
    log: Log, start: Callable[..., subprocess.Popen[bytes]], number: signal.Signals
) -> None:
    threads = """
def on():
    while True: feed.drive(0.3)
feed.connect("/scan", lambda scan: on())
import threading
threading.Thread(target=on, daemon=True).start()
time.sleep(60)
"""
    process = start([sys.executable, "-c", OPEN.format(path=str(log.path)) + HOLD + threads], stderr=subprocess.DEVNULL)
    wait_for(lambda: len(log.heard()) > 5, "it drives")
    process.send_signal(number)
    assert process.wait(120) == -number
    assert log.heard()[-1][1] == 0.0


def test_no_program_drives_a_robot_while_the_feeds_of_others_are_closed(
    log: Log, start: Callable[..., subprocess.Popen[bytes]]
) -> None:
    two = """
from contextlib import suppress
tried = 0
def close(self):
    print((time.monotonic(), 9.0, 0.0), file=log)
    until = tried + 100
    while tried < until: time.sleep(0.001)
Simulated.close = close
other = feeds.simulator(hz=20, wander=False)
def on():
    global tried
    while True:
        tried += 1
        for one, linear in ((feed, 0.3), (other, 0.2)):
            with suppress(Exception): one.drive(linear)
import threading
threading.Thread(target=on, daemon=True).start()
time.sleep(60)
"""
    process = start([sys.executable, "-c", OPEN.format(path=str(log.path)) + two], stderr=subprocess.DEVNULL)
    wait_for(lambda: len(log.heard()) > 5, "both are driven")
    process.send_signal(signal.SIGTERM)
    process.wait(120)
    speeds = [linear for _, linear, _ in log.heard()]
    assert {*speeds[speeds.index(9.0) :]} <= {0.0, 9.0}, "while the first of them is being closed"


def test_a_signal_that_ends_the_process_sends_zero_first_from_a_pad_without_a_feed(
    log: Log, start: Callable[..., subprocess.Popen[bytes]]
) -> None:
    pad = f"""
import time
from robowidgets import DriveWidget
file = open({str(log.path)!r}, "a", buffering=1)
pad = DriveWidget(send=lambda *speeds: print((time.monotonic(), *speeds), file=file))
pad._watchdog.drive((0.3, 0.0, 0.0), hold=60.0)
while True:
    time.sleep(0.1)  # a signal that comes just before it is noticed after it
"""
    process = start([sys.executable, "-c", pad], stderr=subprocess.DEVNULL)
    wait_for(log.heard, "it drives")
    process.send_signal(signal.SIGTERM)
    assert process.wait(120) == -signal.SIGTERM
    assert log.heard()[-1][1] == 0.0


def test_a_kernel_whose_server_is_gone_sends_zero_before_it_ends(
    log: Log, start: Callable[..., subprocess.Popen[bytes]], tmp_path: Path
) -> None:
    pid = tmp_path / "pid"
    kernel = f"""
import inspect, os
from ipykernel.parentpoller import ParentPollerUnix
known = {{"parent_pid": os.getppid()}} if "parent_pid" in inspect.signature(ParentPollerUnix).parameters else {{}}
poller = ParentPollerUnix(**known)  # older ones look for process 1 as their parent
open({str(pid)!r}, "w").write(str(os.getpid()))
{OPEN.format(path=str(log.path))}{HOLD}
poller.start()
{LOOP}
"""
    server = "import subprocess, sys; subprocess.Popen([sys.executable, '-c', sys.argv[1]]); input()"
    process = start([sys.executable, "-c", server, kernel], stdin=subprocess.PIPE, stderr=subprocess.DEVNULL)
    wait_for(lambda: len(log.heard()) > 5, "it drives")
    process.kill()
    process.communicate()
    wait_for(lambda: not Path("/proc", pid.read_text()).exists(), "it ends")
    assert log.heard()[-1][1] == 0.0

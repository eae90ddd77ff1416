"""Signals in a program that uses rclpy as a feed does, with and without a guard.

Its robot logs every command as it leaves the program or the guard.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ...conftest import ROOT
from ..waiting import wait_for

pytestmark = pytest.mark.slow

BESIDE = Path(__file__).with_name("beside")
STAND_IN = f"""
import os, signal, sys, threading, time
sys.path.insert(0, {str(BESIDE)!r})
import rclpy
from robowidgets import feeds
"""
"""A guard finds the stand-in on the path of its kernel, and has its own network with the same robot."""
OPEN = "feed = feeds.ros2(domain_id=7); feed.driving = feeds.Driving(hold=60.0)"
INIT = "rclpy.init(domain_id=7)"
INIT_WITHOUT = "rclpy.init(domain_id=7, signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)"
DRIVE = """
def drive():
    while True: feed.drive(0.3)
threading.Thread(target=drive, daemon=True).start()
"""
CLEAN_UP = """
try:
    while True: feed.drive(0.3)
except feeds.FeedError:
    time.sleep(1.0)
    print("cleaned up")
"""
SLEEP = "\ntime.sleep(60)"


@pytest.fixture(params=["on", "off"], ids=["guard", "kernel"])
def environment(request: pytest.FixtureRequest, tmp_path: Path) -> dict[str, str]:
    """The environment of a program, with a guard or without."""
    return {**os.environ, "ROBOT_LOG": str(tmp_path / "heard.txt"), "ROBOWIDGETS_GUARD": request.param}


Ended = Callable[[str, int], tuple[int, str, float]]


@pytest.fixture
def ended(environment: dict[str, str], start: Callable[..., subprocess.Popen[str]]) -> Ended:
    """End a driving program by a signal; return its exit code, its printed text, and the last speed of the robot."""
    path = Path(environment["ROBOT_LOG"])
    path.touch()

    def heard() -> list[float]:
        lines = path.read_text().split("\n")[:-1]
        return [float(line.split()[1]) for line in lines]

    def end(program: str, number: int) -> tuple[int, str, float]:
        process = start(
            [sys.executable, "-c", STAND_IN + program],
            cwd=ROOT,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        wait_for(lambda: len(heard()) > 5, "it drives")
        process.send_signal(number)
        printed, _ = process.communicate(timeout=120)
        if environment["ROBOWIDGETS_GUARD"] == "on":
            wait_for(lambda: heard()[-1] == 0.0, "the guard has sent zero")
        return process.returncode, printed, heard()[-1]

    return end


@pytest.mark.parametrize("program", [f"{INIT}\n{OPEN}", f"{OPEN}\n{INIT}"], ids=["before", "after"])
def test_sigterm_sends_zero_and_lets_a_program_of_rclpy_end_itself(ended: Ended, program: str) -> None:
    assert ended(program + CLEAN_UP, signal.SIGTERM) == (0, "cleaned up\n", 0.0)


@pytest.mark.parametrize(
    ("program", "number"),
    [
        (f"{INIT}\n{OPEN}", signal.SIGHUP),
        (f"{INIT}\n{OPEN}\nrclpy.shutdown()", signal.SIGTERM),
        (f"{INIT}\nsignal.signal(signal.SIGTERM, signal.SIG_DFL)\n{OPEN}", signal.SIGTERM),
        (f"{INIT_WITHOUT}\n{OPEN}", signal.SIGTERM),
    ],
    ids=[
        "SIGHUP",
        "SIGTERM after rclpy.shutdown",
        "SIGTERM that ends the process again",
        "SIGTERM that is kept from rclpy",
    ],
)
def test_a_signal_that_rclpy_does_not_handle_sends_zero_before_it_ends_the_process(
    ended: Ended, program: str, number: int
) -> None:
    assert ended(program + DRIVE + SLEEP, number) == (-number, "", 0.0)


@pytest.mark.parametrize("since", ["", "signal.signal(signal.SIGINT, signal.default_int_handler)"], ids=["C", "cell"])
def test_an_interrupt_sends_zero_at_once_though_rclpy_handles_signals_or_did_in_an_earlier_cell(
    environment: dict[str, str], since: str
) -> None:
    program = f"""
signal.signal(signal.SIGINT, signal.default_int_handler)
{INIT}
{since}
from robowidgets.runtime.platform_fixes import call_on_interrupt
call_on_interrupt(lambda: print("zero"))
try:
    signal.raise_signal(signal.SIGINT)
except KeyboardInterrupt:
    print(rclpy.ok())
"""
    done = subprocess.run(
        [sys.executable, "-c", STAND_IN + program],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
        timeout=240,
    )
    assert done.stdout.split() == ["zero", str(bool(since))]

"""Signals in a program that uses rclpy beside a feed; its robot logs every command as it leaves the program."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ...conftest import ROOT
from ..waiting import wait_for
from .kernel import Log

pytestmark = pytest.mark.slow

STAND_IN = """
import pytest, signal, threading, time
from tests.unit.feeds.fake_rclpy import get_message, install
graph, log = install(pytest.MonkeyPatch()), open({path!r}, "a", buffering=1)
base = graph.node("base").create_subscription(get_message("geometry_msgs/msg/Twist"), "/cmd_vel", lambda _: None, 10)
base.receive = lambda message: print((time.monotonic(), message.linear.x, message.angular.z), file=log)
import rclpy
from robowidgets import feeds
"""
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


@pytest.fixture
def ended(tmp_path: Path, start: Callable[..., subprocess.Popen[str]]) -> Callable[[str, int], tuple[int, str, float]]:
    """Ends a program that drives by a signal: its exit code, what it printed, and the last speed of the robot."""
    path = tmp_path / "heard.txt"
    log = Log(path)

    def end(program: str, number: int) -> tuple[int, str, float]:
        process = start(
            [sys.executable, "-c", STAND_IN.format(path=str(path)) + program],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        wait_for(lambda: len(log.heard()) > 5, "it drives")
        process.send_signal(number)
        printed, _ = process.communicate(timeout=120)
        return process.returncode, printed, log.heard()[-1][1]

    return end


@pytest.mark.parametrize("program", [f"{INIT}\n{OPEN}", f"{OPEN}\n{INIT}"], ids=["before", "after"])
def test_sigterm_sends_zero_and_lets_a_program_of_rclpy_end_itself(
    ended: Callable[[str, int], tuple[int, str, float]], program: str
) -> None:
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
    ended: Callable[[str, int], tuple[int, str, float]], program: str, number: int
) -> None:
    assert ended(program + DRIVE + SLEEP, number) == (-number, "", 0.0)


@pytest.mark.parametrize("since", ["", "signal.signal(signal.SIGINT, signal.default_int_handler)"], ids=["C", "cell"])
def test_an_interrupt_sends_zero_at_once_though_rclpy_handles_signals_or_did_in_an_earlier_cell(
    tmp_path: Path, since: str
) -> None:
    program = f"""
signal.signal(signal.SIGINT, signal.default_int_handler)
{INIT}
{since}
from robowidgets._core.platform_fixes import call_on_interrupt
call_on_interrupt(lambda: print("zero"))
try:
    signal.raise_signal(signal.SIGINT)
except KeyboardInterrupt:
    print(rclpy.ok())
"""
    done = subprocess.run(
        [sys.executable, "-c", STAND_IN.format(path=str(tmp_path / "heard.txt")) + program],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        timeout=240,
    )
    assert done.stdout.split() == ["zero", str(bool(since))]

"""The time from a cause until zero reaches a robot in another process without a watchdog.

The program runs in a real kernel, with a connected function for the robot's scans that never returns.
"""

from __future__ import annotations

import math
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jupyter_client.blocking.client import BlockingKernelClient
from jupyter_client.manager import KernelManager

from .feed_kernel import start_master
from .middleware import DOMAIN, SYSTEM

TIMES = 10
"""The number of tries of each cause."""
WINDOW = 0.3
"""Seconds after a cause, in addition to the hold of a speed, in which zero must come and nothing else be driven."""
HOLD = 0.5
ENDS = ("end of the kernel", "SIGTERM", "SIGHUP", "a lost server")

OPEN = {
    "dds": f"feeds.dds({DOMAIN}, interface='lo')",
    "foxglove": "feeds.foxglove({where!r})",
    "rosbridge": "feeds.rosbridge({where!r})",
    "ros1": "feeds.ros1()",
    "ros2": "feeds.ros2(domain_id=7)",
    "zenoh": "feeds.zenoh({where!r})",
}
STAND_IN = """
import os, sys
os.environ["ROBOT_LOG"] = {path!r}
sys.path.insert(0, {folder!r})
"""
"""A stand-in for rclpy, which no registry has: it waits and wakes like rclpy, and logs all sent messages."""
BESIDE = str(Path(__file__).parents[1] / "tests" / "unit" / "feeds" / "beside")
SETUP = """
import sys, time
sys.path.append({system!r}) if {ros1} else None
from robowidgets import DriveWidget, feeds
def opened():
    feed = {opened}
    feed.connect("/scan", hang)
    for _ in range(1000):
        if feed.functions[0].entered:
            return feed
        time.sleep(0.01)
    raise RuntimeError("no scan has come to the function that hangs")
def hang(scan):
    time.sleep(3600)
def driving(feed):
    for _ in range(10):
        feed.drive(0.3)
        time.sleep(0.03)
feed = opened()
driving(feed)
"""
TRIES = {
    "hold": "feed.drive(0.3); cause = time.monotonic(); time.sleep(0.9)",
    "stop": "driving(feed); cause = time.monotonic(); feed.stop(); time.sleep(0.4)",
    "release": """
pad = DriveWidget(linear_limit=0.3)
pad.connect(feed)
answers = []
pad.send = answers.append
pad._handle_custom_msg({"act": "press", "press": "p"}, [])
for _ in range(10):
    pad._handle_custom_msg({"act": "hold", "press": "p", "token": answers[-1]["token"], "forward": 1.0}, [])
    time.sleep(0.03)
cause = time.monotonic()
pad._handle_custom_msg({"act": "release", "press": "p"}, [])
time.sleep(0.4)
pad.close()
""",
    "close": "driving(feed); cause = time.monotonic(); feed.close(); time.sleep(0.4); feed = opened(); driving(feed)",
    "interrupt": "while True: driving(feed)",
    "a program raises": "fault = 'raises'; time.sleep(0.4)",
    "a program loops": "fault = 'loops'; time.sleep(0.9)",
    "a program and Stop": "cause = time.monotonic(); feed.stopped = True; time.sleep(0.4); feed.stopped = False",
    "a program and interrupt": "",
}
PROGRAM = """
from robowidgets.behaviors import Drive
feed.driving = feeds.Driving(hold=60.0)
fault = ""
@feed.program(rate=30)
def go():
    global cause
    if fault:
        cause = time.monotonic()
    if fault == "raises":
        raise ValueError(fault)
    while fault == "loops":
        pass
    return Drive(0.3)
time.sleep(0.4)
"""
"""A program with a long hold of its speeds, so that the zero after a hold does not hide a missing zero."""
END_PROGRAM = "go.close(); feed.driving = feeds.Driving()"
SLOW = {"hold": HOLD, "a program loops": HOLD, "a lost server": 1.0}
"""Seconds until zero is due: the hold of a speed, the limit of a step, and the interval of checking the server."""
SERVER = """
from jupyter_client.manager import start_new_kernel
manager, client = start_new_kernel()
print(manager.connection_file, flush=True)
input()
"""


@dataclass
class Stopped:
    """Seconds from a cause to zero for each try, or infinite if zero did not come."""

    feed: str
    cause: str
    seconds: list[float]


class Kernel:
    """A kernel that runs the cells."""

    def __init__(self) -> None:
        self.manager = KernelManager()
        self.manager.start_kernel()
        self._connect(self.manager.client())

    def _connect(self, client: BlockingKernelClient) -> None:
        self._client = client
        self._client.start_channels()
        self._client.wait_for_ready(timeout=60)

    def start(self, code: str) -> str:
        request: str = self._client.execute(code, user_expressions={"cause": "cause"})
        return request

    def end_of(self, request: str) -> dict[str, Any]:
        while True:
            reply = self._client.get_shell_msg(timeout=120)
            if reply["parent_header"].get("msg_id") == request:
                content: dict[str, Any] = reply["content"]
                return content

    def run(self, code: str) -> float:
        """Run a cell. Return the time of its cause, by the monotonic clock of the machine."""
        reply = self.end_of(self.start(code))
        if reply["status"] != "ok":
            raise RuntimeError("\n".join(reply["traceback"]))
        told = reply["user_expressions"]["cause"]
        return float(told["data"]["text/plain"]) if told["status"] == "ok" else float("nan")

    def close(self) -> None:
        self._client.stop_channels()
        if self.manager.is_alive():
            self.manager.shutdown_kernel(now=True)


class ServedKernel(Kernel):
    """A kernel of a server process that can be killed."""

    def __init__(self) -> None:
        self.server = subprocess.Popen(
            [sys.executable, "-c", SERVER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert self.server.stdout is not None
        client = BlockingKernelClient(connection_file=self.server.stdout.readline().strip())
        client.load_connection_file()
        self._connect(client)

    def close(self) -> None:
        self._client.stop_channels()
        self.server.kill()
        self.server.communicate()


@contextmanager
def robot(name: str, path: Path) -> Iterator[str]:
    """Start a robot in a separate process. Yield its address."""
    with ExitStack() as ends:
        if name == "ros1":
            ends.callback(start_master().kill)
        if name == "ros2":
            yield ""
            return
        command = [sys.executable, "-m", "benchmarks.middleware", "obey", name, str(path)]
        process = ends.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
        ends.callback(process.kill)
        assert process.stdout is not None
        yield process.stdout.readline().strip()


def measured(name: str, times: int = TIMES) -> list[Stopped]:
    """Measure every cause on one feed."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # kernels would inherit that nohup ignores it
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "heard.txt")
        path.touch()
        with robot(name, path) as where:
            setup = SETUP.format(system=SYSTEM, ros1=name == "ros1", opened=OPEN[name].format(where=where))
            if name == "ros2":
                setup = STAND_IN.format(path=str(path), folder=BESIDE) + setup
            kernel = Kernel()
            try:
                kernel.run(setup)
                tries = {cause: [_try(kernel, cause, path) for _ in range(times)] for cause in TRIES}
            finally:
                kernel.close()
            tries |= {end: [_end(setup, end, path) for _ in range(max(1, times // 3))] for end in ENDS}
    return [Stopped(name, cause, seconds) for cause, seconds in tries.items()]


def available() -> list[str]:
    """Return the feeds that can be measured on this machine."""
    return [name for name in OPEN if name != "ros1" or Path(SYSTEM, "rospy").is_dir()]


def _try(kernel: Kernel, cause: str, path: Path) -> float:
    is_program = cause.startswith("a program")
    if is_program:
        kernel.run(PROGRAM)
    if cause.endswith("interrupt"):
        request = kernel.start(TRIES[cause])
        time.sleep(0.5)
        at = time.monotonic()
        kernel.manager.interrupt_kernel()
        kernel.end_of(request)
    else:
        at = kernel.run(TRIES[cause])
    seconds = _until_zero(path, at, SLOW.get(cause, 0.0))
    if is_program:
        kernel.run(END_PROGRAM)
    return seconds


def _end(setup: str, end: str, path: Path) -> float:
    kernel = ServedKernel() if end == "a lost server" else Kernel()
    try:
        kernel.run(setup + "feed.driving = feeds.Driving(hold=60.0)\ndriving(feed)")
        at = time.monotonic()
        if isinstance(kernel, ServedKernel):
            kernel.server.kill()
        elif end == "end of the kernel":
            kernel.manager.shutdown_kernel()
        else:
            kernel.manager.signal_kernel(signal.Signals[end])
        return _until_zero(path, at, SLOW.get(end, 0.0))
    finally:
        kernel.close()


def _until_zero(path: Path, cause: float, hold: float = 0.0) -> float:
    """Return seconds from a cause to zero; infinite if zero did not come in time, or something moved after it."""
    end = cause + hold + WINDOW
    time.sleep(max(0.0, end - time.monotonic()) + 0.1)
    lines = [line.split() for line in path.read_text().split("\n")[:-1]]
    heard = [(float(at), (float(linear), float(angular)) == (0.0, 0.0)) for at, linear, angular in lines]
    since = [(at, is_zero) for at, is_zero in heard if cause <= at < end]
    zero = next((at for at, is_zero in since if is_zero), math.inf)
    return zero - cause if all(is_zero for at, is_zero in since if at > zero) else math.inf

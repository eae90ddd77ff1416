"""The commands that reach a robot in another process if the driving process is killed, is suspended, or holds the GIL.

`python -m benchmarks.guard` prints, for each fault and each middleware, the time until zero came, with and without a
guard, and the time until a command reaches the robot.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from statistics import median, quantiles

from robowidgets.feeds._guard.process import LAST_ZERO

from .stopping import BESIDE, OPEN, STAND_IN, SYSTEM, ServedKernel, available, robot

WITHIN = 0.6
"""Seconds within which zero is due."""
WATCHED = 2.0
"""Seconds after a fault in which zero must come and nothing else may be driven."""
PATIENCE = 240.0
"""The longest time in seconds until a process drives its robot."""
HELD = 2.0
"""The default seconds for which code holds the GIL."""

FORKING = """
import ctypes, json, os, signal, sys
sys.path.append({system!r}) if {ros1} else None
from robowidgets import DriveWidget, feeds
signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # what has ended is gone at once
for line in sys.stdin:
    if not os.fork():
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        exec(json.loads(line))
"""
"""A process that has done the imports, and forks for each line, because imports would take most of the time."""

DRIVER = """
import ctypes, os, signal, sys, threading, time
from contextlib import suppress
sys.path.append({system!r}) if {ros1} else None
from robowidgets import DriveWidget, feeds
from robowidgets.behaviors import Drive
feed = {opened}
feed.driving = feeds.Driving(hold=60.0)
def at():
    with open({log!r}, "a") as log:
        print(os.getpid(), looked, file=log)
def drive(seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        with suppress(feeds.FeedError):  # the guard stops the robot on a busy machine
            feed.drive(0.3)
        time.sleep(0.05)
while feed.status:
    time.sleep(0.05)
for _ in range(60):  # middlewares differ in when they report subscribers
    if not any(topic.name == "/cmd_vel" and topic.wanted for topic in feed.topics):
        time.sleep(0.05)
began = time.monotonic()
def moves():
    global looked
    looked = time.monotonic()
    with open({heard!r}) as heard:
        lines = [line.split() for line in heard.read().split("\\n")[:-1]]
    return bool(lines) and float(lines[-1][0]) > began and float(lines[-1][1]) != 0.0
drive(0.5)
while not moves():  # a fault while the robot stands, as after a standstill of this process, shows nothing
    drive(0.25)
{fault}
"""
"""A program with speeds that hold for a minute, so that the zero after a hold does not hide a missing zero."""

PAUSE = "pause of both"
PAUSED = 1.5
"""Seconds for which the driving process and its guard are paused."""

FAULTS = {
    "kill -9": "at(); drive(60)",
    "SIGSTOP": "at(); drive(60)",
    "SIGINT": "at(); drive(60)",
    "SIGTERM": "at(); drive(60)",
    "SIGHUP": "at(); drive(60)",
    PAUSE: """
at()
while True:
    try:
        feed.drive(0.3)
    except feeds.FeedError as error:
        with open({log!r}, "a") as log:
            print("refused:", error, file=log)
    time.sleep(0.05)
""",
    "os._exit": "at(); os._exit(3)",
    "segfault": "at(); ctypes.string_at(0)",
    "out of memory": """
import resource
resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
at()
ctypes.CDLL(None).memset(ctypes.CDLL(None).malloc(1 << 33), 1, 1)
""",
    "GIL held in a cell": "at(); ctypes.PyDLL(None).usleep({held}); drive(60)",
    "GIL held in a step": """
fault = time.monotonic() + 0.5
@feed.program(rate=20)
def go():
    if time.monotonic() > fault and moves():
        at()
        ctypes.PyDLL(None).usleep({held})
    return Drive(0.3)
time.sleep(60)
""",
    "page gone": """
pad = DriveWidget(linear_limit=0.3)
pad.connect(feed)
answers = []
pad.send = answers.append
def hold():
    pad._handle_custom_msg({{"act": "press", "press": "p"}}, [])
    for _ in range(10):
        time.sleep(0.05)
        if "token" not in answers[-1]:  # a slow machine: the press is over
            return
        pad._handle_custom_msg({{"act": "hold", "press": "p", "token": answers[-1]["token"], "forward": 1.0}}, [])
hold()
while not moves():
    hold()
at()
time.sleep(60)
""",
    "server killed": "at(); drive(60)",
}
"""The code for each fault. For a kernel, a closed page is a page that no longer reports the pressed pad."""

OF_ONE = {"ros2": {"SIGTERM with rclpy": "import rclpy; rclpy.init(domain_id=7); at(); drive(60)"}}
"""The faults of a single middleware. rclpy handles SIGTERM, and the process goes on."""

OURS = "ROBOWIDGETS_BENCHMARK"
"""The environment variable with the id of this process, for all processes that it starts."""
os.environ[OURS] = str(os.getpid())

SIGNALS = {
    "kill -9": signal.SIGKILL,
    "SIGSTOP": signal.SIGSTOP,
    "SIGINT": signal.SIGINT,
    "SIGTERM": signal.SIGTERM,
    "SIGHUP": signal.SIGHUP,
    "SIGTERM with rclpy": signal.SIGTERM,
}
"""The signals that come from outside during driving."""


LATENCY = """
import json, sys, time
sys.path.append({system!r}) if {ros1} else None
from robowidgets import feeds
feed = {opened}
sent = {{}}
def go(scan):
    speed = round(0.05 + 0.0001 * len(sent), 4)
    sent[speed] = time.monotonic()
    feed.drive(speed)
while feed.status:
    time.sleep(0.05)
feed.drive(0.01)
feed.connect("/scan", go)
while len(sent) < {count}:
    time.sleep(0.1)
feed.close()
print(json.dumps(list(sent.items())))
"""
"""Each scan is answered by a different speed."""


@dataclass
class Fault:
    """Seconds of each try from a fault until zero stays, or infinite if it did not."""

    feed: str
    fault: str
    guarded: bool
    seconds: list[float]


class Driven:
    """A process that drives a robot, given by its id."""

    def __init__(self, pid: int) -> None:
        self.pid = pid

    @property
    def is_there(self) -> bool:
        return Path(f"/proc/{self.pid}").exists()

    def signal(self, number: int) -> None:
        with suppress(ProcessLookupError):
            os.kill(self.pid, number)


class Drivers:
    """The factory of processes that drive one robot.

    Args:
        name: the middleware.
        where: the robot.
        path: the log of the robot.
        guarded: True to use guards.
        held: the seconds for which code holds the GIL.
    """

    def __init__(self, name: str, where: str, path: Path, *, guarded: bool = True, held: float = HELD) -> None:
        self._faults = {**FAULTS, **OF_ONE.get(name, {})}
        self._given = {"system": SYSTEM, "ros1": name == "ros1", "opened": OPEN[name].format(where=where)}
        self._beside = STAND_IN.format(path=str(path), folder=BESIDE) if name == "ros2" else ""
        self._held, self._heard, self._log = round(held * 1e6), path, path.with_name("said.txt")
        self._environment = {**os.environ, "ROBOWIDGETS_GUARD": "on" if guarded else "off"}
        command = [sys.executable, "-c", self._beside + FORKING.format(**self._given)]
        self._forking = subprocess.Popen(command, stdin=subprocess.PIPE, text=True, env=self._environment)

    @contextmanager
    def driving(self, fault: str) -> Iterator[tuple[Driven, float]]:
        """Start a process that drives and has a fault. Yield it with the monotonic time of the fault."""
        self._log.unlink(missing_ok=True)
        what = self._faults[fault].format(held=self._held, log=str(self._log))
        code = self._beside + DRIVER.format(**self._given, log=str(self._log), heard=str(self._heard), fault=what)
        with ExitStack() as ends:
            server = None
            if fault == "server killed":
                kernel = ServedKernel()
                ends.callback(kernel.close)
                kernel.start(code)
                server = kernel.server
            else:
                assert self._forking.stdin is not None
                print(json.dumps(code), file=self._forking.stdin, flush=True)
            _await(lambda: self._log.exists() and self._log.read_text().endswith("\n"), "the process drives", 0.005)
            pid, told = self._log.read_text().split()[:2]
            process, at = Driven(int(pid)), float(told)
            ends.callback(process.signal, signal.SIGKILL)
            if fault == PAUSE:
                self._await_motion()
                both = [process, *(Driven(guard) for guard in guards() if _parent(guard) == process.pid)]
                for number, pause in ((signal.SIGSTOP, PAUSED), (signal.SIGCONT, 0.0)):
                    at = time.monotonic()
                    for one in both:
                        one.signal(number)
                    time.sleep(pause)
            elif server is not None or fault in SIGNALS:
                at = self._await_motion()
                server.kill() if server is not None else process.signal(SIGNALS[fault])
            yield process, at

    def _await_motion(self) -> float:
        """Wait a moment, and then until the robot moves. Return the time at which it did.

        After a standstill of a busy machine the robot has its zero already, and gets none after a fault.
        """
        time.sleep(0.3)
        looked = 0.0

        def moves() -> bool:
            nonlocal looked
            looked = time.monotonic()
            return heard(self._heard, 0.0)[-1][1] != 0.0

        _await(moves, "the robot moves", 0.02)
        return looked

    @property
    def refused(self) -> str:
        """The errors of the refused speeds, a line for each."""
        lines = self._log.read_text().splitlines() if self._log.exists() else []
        return "\n".join(line for line in lines if line.startswith("refused:"))

    def close(self) -> None:
        assert self._forking.stdin is not None
        self._forking.stdin.close()
        self._forking.wait()


def _await(condition: Callable[[], bool], what: str, every: float) -> None:
    """Wait until a condition holds. Raise TimeoutError with its text if it does not."""
    until = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > until:
            raise TimeoutError(f"waited {PATIENCE:g} s in vain until {what}")
        time.sleep(every)


def heard(path: Path, since: float) -> list[tuple[float, float]]:
    """Return the times and forward speeds that a robot has logged since a time."""
    lines = [line.split() for line in path.read_text().split("\n")[:-1]]
    return [(float(at), float(linear)) for at, linear, _ in lines if float(at) >= since]


def until_zero(path: Path, fault: float, watched: float = WATCHED) -> float:
    """Return seconds from a fault until zero stays; infinite if the last command in time was not zero or missing."""
    time.sleep(max(0.0, fault + watched - time.monotonic()))
    since = [(at, speed) for at, speed in heard(path, fault) if at < fault + watched]  # more time may have passed
    moved = max((at for at, speed in since if speed), default=fault)
    return min((at for at, speed in since if not speed and at > moved), default=math.inf) - fault


def measured(name: str, times: int, *, guarded: bool, faults: Sequence[str], held: float) -> None:
    """Measure and print all faults on one middleware."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "heard.txt")
        path.touch()
        with robot(name, path) as where, closing(Drivers(name, where, path, guarded=guarded, held=held)) as drivers:
            for fault in faults:
                seconds = []
                for _ in range(times):
                    with drivers.driving(fault) as (_process, at):
                        seconds.append(until_zero(path, at, held - 0.2 if fault.startswith("GIL") else WATCHED))
                print(told(Fault(name, fault, guarded, seconds)), flush=True)


def told(one: Fault) -> str:
    """Return a line about a fault."""
    came = sorted(one.seconds)
    late = sum(seconds > WITHIN for seconds in came)
    way = "guard" if one.guarded else "kernel"
    return (
        f"{one.feed:10} {one.fault:20} {way:7} median {median(came):6.3f} s, worst {came[-1]:6.3f} s, "
        f"in time {len(came) - late} of {len(came)}"
    )


def latency(name: str, count: int, *, guarded: bool) -> list[float]:
    """Return seconds from the call of a function with a scan until its speed reaches the robot."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "heard.txt")
        path.touch()
        with robot(name, path) as where:
            environment = {
                **os.environ,
                "ROBOWIDGETS_GUARD": "on" if guarded else "off",
            }  # the robot extends it
            code = LATENCY.format(
                system=SYSTEM, ros1=name == "ros1", opened=OPEN[name].format(where=where), count=count
            )
            if name == "ros2":
                code = STAND_IN.format(path=str(path), folder=BESIDE) + code
            run = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, env=environment, check=True)
            came = {speed: at for at, speed in reversed(heard(path, 0.0))}
    return [came[speed] - at for speed, at in json.loads(run.stdout) if speed in came]


def left_behind(name: str, kernels: int) -> int:
    """Return the increase in the number of guards after some processes ended, in every way in turn."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "heard.txt")
        path.touch()
        with robot(name, path) as where, closing(Drivers(name, where, path)) as drivers:
            before = guards()
            ends = [fault for fault in FAULTS if not fault.startswith("GIL")]
            for number in range(kernels):
                with drivers.driving(ends[number % len(ends)]):
                    pass
            until = time.monotonic() + LAST_ZERO
            while guards() - before and time.monotonic() < until:
                time.sleep(0.1)
            return len(guards() - before)


def guards() -> set[int]:
    """Return the ids of the guards among the children of this process."""
    found = subprocess.run(["pgrep", "-f", "robowidgets.feeds._guard.process"], stdout=subprocess.PIPE, text=True)
    return {int(pid) for pid in found.stdout.split() if _is_ours(Path(f"/proc/{pid}/environ"))}


def _parent(pid: int) -> int:
    """Return the parent of a process, or 0 if it has ended."""
    with suppress(OSError):
        return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    return 0


def _is_ours(environment: Path) -> bool:
    with suppress(OSError):  # it has ended
        return f"{OURS}={os.getpid()}\0".encode() in environment.read_bytes()
    return False


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.guard", description=__doc__)
    parser.add_argument("--times", type=int, default=50, help="how often each fault is tried")
    parser.add_argument("--feeds", nargs="+", default=available())
    parser.add_argument("--faults", nargs="+", default=list(FAULTS), choices=FAULTS, metavar="FAULT")
    parser.add_argument("--held", type=float, default=HELD, help="seconds for which code holds the GIL")
    parser.add_argument("--without", action="store_true", help="without the guard, too")
    parser.add_argument("--latency", type=int, default=0, metavar="SCANS", help="of so many scans only")
    parser.add_argument("--left", type=int, default=0, metavar="KERNELS", help="what so many leave behind only")
    options = parser.parse_args()
    for name in options.feeds:
        if options.left:
            print(f"{name:10} {options.left} ended, guards left: {left_behind(name, options.left)}", flush=True)
            continue
        for guarded in (True, False) if options.without else (True,):
            if not options.latency:
                measured(name, options.times, guarded=guarded, faults=options.faults, held=options.held)
                continue
            took = [1000 * seconds for seconds in latency(name, options.latency, guarded=guarded)]
            way = "guard" if guarded else "kernel"
            print(f"{name:10} {way:7} median {median(took):.2f} ms, p95 {quantiles(took, n=20)[-1]:.2f} ms", flush=True)


if __name__ == "__main__":
    main()

"""What reaches a robot in another process when the process that drives it is killed, stands still, or holds the GIL.

`python -m benchmarks.guard` tells, of each fault and each middleware, after how long zero came, with a guard beside the
process and without, and how soon a command reaches the robot.
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
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median, quantiles

from robowidgets.feeds._guard.process import LAST_ZERO

from .stopping import BESIDE, OPEN, STAND_IN, SYSTEM, available, robot

WITHIN = 0.6
"""Seconds within which zero is due."""
WATCHED = 2.0
"""Seconds after a fault in which a zero is waited for, and nothing may move."""
STEP = 0.5
"""Seconds until a step of a program holds it."""
HELD = 2.0
"""Seconds for which code holds the GIL."""

DRIVER = """
import ctypes, os, signal, sys, threading, time
sys.path.append({system!r}) if {ros1} else None
from robowidgets import feeds
from robowidgets.behaviors import Drive
feed = {opened}
feed.driving = feeds.Driving(hold=60.0)
held = lambda: ctypes.PyDLL(None).usleep(int({held} * 1e6))
def drive(seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        feed.drive(0.3)
        time.sleep(0.05)
while feed.status:
    time.sleep(0.05)
for _ in range(60):  # which of them tell who listens, and when, differs
    if not any(topic.name == "/cmd_vel" and topic.wanted for topic in feed.topics):
        time.sleep(0.05)
drive(1.0)
print(time.monotonic(), flush=True)
{fault}
"""
"""A program with speeds that hold for a minute: no zero of the hold hides a missing one."""

FAULTS = {
    "kill -9": "drive(60)",
    "SIGSTOP": "drive(60)",
    "os._exit": "os._exit(3)",
    "segfault": "ctypes.string_at(0)",
    "out of memory": """
import resource
resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
ctypes.CDLL(None).memset(ctypes.CDLL(None).malloc(1 << 33), 1, 1)
""",
    "GIL held in a cell": "held(); drive(60)",
    "GIL held in a step": """
fault = time.monotonic() + {step}
@feed.program(rate=20)
def go():
    if time.monotonic() > fault:
        held()
    return Drive(0.3)
time.sleep(60)
""",
}


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
"""Each scan is answered by a speed of its own."""


@dataclass
class Fault:
    """Seconds from a fault to zero, each time; infinite where none came, or something moved after it."""

    feed: str
    fault: str
    guarded: bool
    seconds: list[float]


@contextmanager
def driving(
    name: str, where: str, path: Path, fault: str, *, guarded: bool = True
) -> Iterator[tuple[subprocess.Popen[str], float]]:
    """A process that drives a robot and has a fault; with the monotonic time of that."""
    code = DRIVER.format(
        system=SYSTEM,
        ros1=name == "ros1",
        opened=OPEN[name].format(where=where),
        held=HELD,
        fault=FAULTS[fault].format(step=STEP),
    )
    if name == "ros2":
        code = STAND_IN.format(path=str(path), folder=BESIDE) + code
    environment = {**os.environ, "ROBOWIDGETS_GUARD": "on" if guarded else "off"}
    command = [sys.executable, "-c", code]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        try:
            assert process.stdout is not None
            at = float(process.stdout.readline())
            if fault in ("kill -9", "SIGSTOP"):
                time.sleep(0.3)
                at = time.monotonic()
                process.send_signal(signal.SIGKILL if fault == "kill -9" else signal.SIGSTOP)
            yield process, at + STEP * fault.endswith("step")
        finally:
            process.kill()


def heard(path: Path, since: float) -> list[tuple[float, float]]:
    """The times and forward speeds that a robot has logged since a time."""
    lines = [line.split() for line in path.read_text().split("\n")[:-1]]
    return [(float(at), float(linear)) for at, linear, _ in lines if float(at) >= since]


def until_zero(path: Path, fault: float, watched: float = WATCHED) -> float:
    """Seconds from a fault to zero; infinite where none came in time, or something moved after it meanwhile."""
    time.sleep(max(0.0, fault + watched - time.monotonic()))
    since = heard(path, fault)
    zero = next((at for at, speed in since if speed == 0.0), math.inf)
    return zero - fault if all(speed == 0.0 for at, speed in since if at > zero) else math.inf


def measured(name: str, times: int, *, guarded: bool) -> list[Fault]:
    """Every fault, on one middleware."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "heard.txt")
        path.touch()
        with robot(name, path) as where:
            for fault in FAULTS:
                seconds = []
                for _ in range(times):
                    with driving(name, where, path, fault, guarded=guarded) as (_process, at):
                        watched = HELD - 0.2 if fault.startswith("GIL") else WATCHED
                        seconds.append(until_zero(path, at, watched))
                found.append(Fault(name, fault, guarded, seconds))
                print(told(found[-1]), flush=True)
    return found


def told(one: Fault) -> str:
    """A line on it."""
    came = sorted(one.seconds)
    late = sum(seconds > WITHIN for seconds in came)
    way = "guard" if one.guarded else "kernel"
    return (
        f"{one.feed:10} {one.fault:20} {way:7} median {median(came):6.3f} s, worst {came[-1]:6.3f} s, "
        f"in time {len(came) - late} of {len(came)}"
    )


def latency(name: str, count: int, *, guarded: bool) -> list[float]:
    """Seconds from the call of a function with a scan until its speed is at the robot."""
    environment = {**os.environ, "ROBOWIDGETS_GUARD": "on" if guarded else "off"}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "heard.txt")
        path.touch()
        with robot(name, path) as where:
            code = LATENCY.format(
                system=SYSTEM, ros1=name == "ros1", opened=OPEN[name].format(where=where), count=count
            )
            if name == "ros2":
                code = STAND_IN.format(path=str(path), folder=BESIDE) + code
            run = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, env=environment, check=True)
            came = {speed: at for at, speed in reversed(heard(path, 0.0))}
    return [came[speed] - at for speed, at in json.loads(run.stdout) if speed in came]


def left_behind(name: str, kernels: int) -> int:
    """How many guards are there more after so many processes ended, in every way in turn, than before."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "heard.txt")
        path.touch()
        with robot(name, path) as where:
            before = guards()
            ends = [fault for fault in FAULTS if not fault.startswith("GIL")]
            for number in range(kernels):
                with driving(name, where, path, ends[number % len(ends)]):
                    pass
            until = time.monotonic() + LAST_ZERO
            while guards() - before and time.monotonic() < until:
                time.sleep(0.1)
            return len(guards() - before)


def guards() -> set[str]:
    """The processes on this machine that are guards."""
    found = subprocess.run(["pgrep", "-f", "robowidgets.feeds._guard.process"], stdout=subprocess.PIPE, text=True)
    return set(found.stdout.split())


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.guard", description=__doc__)
    parser.add_argument("--times", type=int, default=50, help="how often each fault is tried")
    parser.add_argument("--feeds", nargs="+", default=available())
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
                measured(name, options.times, guarded=guarded)
                continue
            took = [1000 * seconds for seconds in latency(name, options.latency, guarded=guarded)]
            way = "guard" if guarded else "kernel"
            print(f"{name:10} {way:7} median {median(took):.2f} ms, p95 {quantiles(took, n=20)[-1]:.2f} ms", flush=True)


if __name__ == "__main__":
    main()

"""What runs in the notebook's kernel to measure a feed: widgets connected to a robot in another process."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from IPython.display import display

from robowidgets import LaserWidget, feeds

from .middleware import DOMAIN, SYSTEM, now_us
from .scan import encode
from .stage import ROOT

GEOMETRY_KEYS = ("angle_min", "angle_increment", "range_min", "range_max")


def start(role: str, name: str, where: str = "") -> subprocess.Popen[str]:
    """A process of benchmarks.middleware."""
    command = [sys.executable, "-m", "benchmarks.middleware", role, name, where]
    return subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def ask(process: subprocess.Popen[str], line: str) -> None:
    """Say a line to a process."""
    assert process.stdin is not None
    process.stdin.write(f"{line}\n")
    process.stdin.flush()


def answer(process: subprocess.Popen[str]) -> str:
    """The next line that a process says."""
    assert process.stdout is not None
    return process.stdout.readline().strip()


def start_master() -> subprocess.Popen[str]:
    """The master of a ROS 1 that is found by the environment of this process."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    os.environ |= {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1"}
    code = "import rosmaster; rosmaster.rosmaster_main()"
    master = subprocess.Popen(["/usr/bin/python3", "-c", code, "--core", "-p", str(port)], text=True)
    while True:
        with socket.socket() as trial:
            if trial.connect_ex(("127.0.0.1", port)) == 0:
                return master
        time.sleep(0.05)


class Source:
    """A robot, a bare subscriber, and a feed with its widgets: see `kernel.Source`, whose methods it has."""

    def __init__(self, name: str, count: int = 1) -> None:
        self._master = start_master() if name == "ros1" else None
        self._robot = start("publish", name)
        where = answer(self._robot)
        self._bare = start("hear", name, where)
        assert answer(self._bare) == "ready"
        if name == "dds":
            self._feed = feeds.dds(DOMAIN, interface="lo")
        elif name == "foxglove":
            self._feed = feeds.foxglove(where)
        else:
            sys.path.append(SYSTEM)
            self._feed = feeds.ros1()
        self._lasers = [LaserWidget() for _ in range(count)]
        self._heard: list[tuple[int, int]] = []
        self._number = 0
        self._feed.connect("/scan", self._note, *self._lasers)
        self._first()

    def _note(self, message: Any) -> None:
        # Each feed hands on messages of its own kind.
        stamp = message["header"]["stamp"] if isinstance(message, dict) else message.header.stamp
        self._heard.append((getattr(stamp, "sec", getattr(stamp, "secs", 0)), now_us()))

    def _first(self) -> None:
        """Publish until everybody hears it."""
        while not self._heard:
            ask(self._robot, "put 0")
            time.sleep(0.05)

    def show(self) -> None:
        """Display the widgets."""
        for laser in self._lasers:
            display(laser)  # type: ignore[no-untyped-call]

    def put(self, number: int) -> None:
        """Show one number, outside any run."""
        ask(self._robot, f"put {number}")

    def pace(self, hz: float, seconds: float) -> None:
        """Have the robot publish at a rate, while this cell waits as a program does."""
        first = self._number + 1
        self._heard.clear()
        cpu, began = time.process_time(), time.perf_counter()
        ask(self._robot, f"pace {first} {hz} {seconds} {Path('published.npy').absolute()}")
        end = began + seconds
        while time.perf_counter() < end:
            time.sleep(0.1)
        assert answer(self._robot) == "done"
        spent = time.process_time() - cpu
        ask(self._bare, f"take {Path('bare.npy').absolute()}")
        assert answer(self._bare) == "done"
        self._number = first + round(hz * seconds) - 1
        np.save("heard.npy", np.array(self._heard).reshape(-1, 2))
        self._tell(first, time.perf_counter() - began, spent)

    def direct(self, hz: float, seconds: float) -> None:
        """Hand scans to the first widget without any feed, at a rate: the widget's own latency."""
        laser, first = self._lasers[0], self._number + 1
        settings = dict(zip(GEOMETRY_KEYS, (-2.356194, 0.004535504, 0.1, 6.0), strict=True))
        stamps, due = [], time.perf_counter()
        cpu, began = time.process_time(), due
        for number in range(first, first + round(hz * seconds)):
            ranges = encode(number)
            stamps.append(now_us())
            laser.update(ranges=ranges, **settings)
            due += 1 / hz
            time.sleep(max(0.0, due - time.perf_counter()))
        self._number = first + len(stamps) - 1
        np.save("published.npy", np.array(stamps))
        self._tell(first, time.perf_counter() - began, time.process_time() - cpu)

    def close(self) -> None:
        """End the feed and the processes."""
        self._feed.close()
        for process in (self._robot, self._bare, self._master):
            if process is not None:
                process.kill()
                process.wait()

    def _tell(self, first: int, seconds: float, cpu: float) -> None:
        stamps = np.load("published.npy")
        epoch = int(stamps[0])
        np.save("stamps.npy", (stamps - epoch).astype(np.int64))
        facts = {"epoch": epoch, "first": first, "last": self._number, "seconds": seconds, "cpu": cpu}
        Path("facts.json").write_text(json.dumps(facts))
        os.replace("facts.json", f"facts-{first}.json")

"""The code in the notebook's kernel that measures a feed: widgets connected to a robot in another process."""

from __future__ import annotations

import json
import os
import random
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from IPython.display import display

from robowidgets import LaserWidget, Scan, feeds

from .inside import MADE
from .middleware import DOMAIN, SYSTEM, now_us
from .scan import ANGLE_INCREMENT, ANGLE_MIN, RANGE_MAX, RANGE_MIN, encode
from .stage import ROOT

SETTINGS = {
    "angle_min": ANGLE_MIN,
    "angle_increment": ANGLE_INCREMENT,
    "range_min": RANGE_MIN,
    "range_max": RANGE_MAX,
}


def start(role: str, name: str, where: str = "") -> subprocess.Popen[str]:
    """Start a process of benchmarks.middleware."""
    command = [sys.executable, "-m", "benchmarks.middleware", role, name, where]
    return subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def ask(process: subprocess.Popen[str], line: str) -> None:
    """Send a line to a process."""
    assert process.stdin is not None
    process.stdin.write(f"{line}\n")
    process.stdin.flush()


def answer(process: subprocess.Popen[str]) -> str:
    """Return the next line from a process."""
    assert process.stdout is not None
    return process.stdout.readline().strip()


def start_master() -> subprocess.Popen[str]:
    """Start a ROS 1 master, and set the environment of this process to find it."""
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


class Outside:
    """A robot and a bare subscriber in separate processes, and a feed of that robot."""

    def __init__(self, name: str, note: Callable[[Any], None], lasers: list[LaserWidget]) -> None:
        self._master = start_master() if name == "ros1" else None
        self._robot = start("publish", name)
        where = answer(self._robot)
        self._bare = start("hear", name, where)
        assert answer(self._bare) == "ready"
        self.feed = feed_of(name, where)
        first = threading.Event()
        self.feed.connect("/scan", note, lambda _: first.set(), *lasers)
        while not first.wait(0.05):
            ask(self._robot, "put 0")

    def pace(self, first: int, hz: float, seconds: float, _heard: list[tuple[int, int]]) -> None:
        """Publish numbers from the first on, and save the times of publishing and of the bare callbacks."""
        ask(self._robot, f"pace {first} {hz} {seconds} {Path('published.npy').absolute()}")
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            time.sleep(0.1)
        assert answer(self._robot) == "done"
        ask(self._bare, f"take {Path('bare.npy').absolute()}")
        assert answer(self._bare) == "done"

    def beside(self, do: str) -> None:
        """Add the other topics of the robot (`beside`), or publish them once ("once") or from now on ("go")."""
        ask(self._robot, do)

    def rate(self) -> float:
        """Return the messages per second on these topics."""
        ask(self._robot, "rate")
        return float(answer(self._robot))

    def close(self) -> None:
        """End the feed and the processes."""
        self.feed.close()
        for process in (self._robot, self._bare, self._master):
            if process is not None:
                process.kill()
                process.wait()


class Inside:
    """A robot in the process of the kernel. A scan counts as published when it is due, and a bare callback takes no
    time. The most punctual scan sets the clock of the feed."""

    def __init__(self, name: str, note: Callable[[Any], None], lasers: list[LaserWidget]) -> None:
        self._make, self._targets = MADE[name], (note, *lasers)
        for laser in lasers:
            laser.title = "/scan"  # the later title, so that the picture stays as the page has learned it

    def pace(self, first: int, hz: float, seconds: float, heard: list[tuple[int, int]]) -> None:
        """See `Outside`."""
        feed, due = self._make(first, hz, seconds)
        feed.connect("/scan", *self._targets)
        last = first + len(due) - 1
        while not heard or heard[-1][0] < last:
            time.sleep(0.1)
        feed.disconnect("/scan")
        feed.close()
        del heard[next(i for i, (number, _) in enumerate(heard) if number == last) + 1 :]
        noted = np.array([pair for pair in heard if first <= pair[0]])
        begun = int((noted[:, 1] - 1e6 * due[noted[:, 0] - first]).min())
        published = begun + (1e6 * due).astype(np.int64)
        np.save("published.npy", published)
        np.save("bare.npy", np.stack([np.arange(first, last + 1), published], axis=1))

    def close(self) -> None:
        """Do nothing: no process has to end."""


def feed_of(name: str, where: str) -> feeds.Feed:
    """Return the feed of a robot of `benchmarks.middleware`."""
    if name == "dds":
        return feeds.dds(DOMAIN, interface="lo")
    if name == "ros2":
        return feeds.ros2(domain_id=DOMAIN)
    if name == "ros1":
        sys.path.append(SYSTEM)
        return feeds.ros1()
    return {"foxglove": feeds.foxglove, "rosbridge": feeds.rosbridge, "zenoh": feeds.zenoh}[name](where)


def number_of(scan: Scan) -> int:
    """Return the number of a scan, in the seconds of its stamp, or 0 without a stamp."""
    return (scan.stamp_ns or 0) // 1_000_000_000


class Source:
    """Widgets on a feed, and its robot, with the methods of `kernel.Source`."""

    def __init__(self, name: str, count: int = 1) -> None:
        self._lasers = [LaserWidget() for _ in range(count)]
        self._heard: list[tuple[int, int]] = []
        self._number = 0
        self._robot = (
            Outside(name, self._note, self._lasers) if name not in MADE else Inside(name, self._note, self._lasers)
        )
        self.put(0)

    def _note(self, scan: Scan) -> None:
        self._heard.append((number_of(scan), now_us()))

    def show(self) -> None:
        """Display the widgets."""
        for laser in self._lasers:
            display(laser)  # type: ignore[no-untyped-call]

    def put(self, number: int) -> None:
        """Show one number, outside of a run."""
        for laser in self._lasers:
            laser.update(ranges=encode(number), **SETTINGS)

    def pace(self, hz: float, seconds: float) -> None:
        """Publish scans of the robot at a rate, while this cell waits like a program."""
        first = self._number + 1
        self._heard.clear()
        cpu, began = time.process_time(), time.perf_counter()
        self._robot.pace(first, hz, seconds, self._heard)
        spent = time.process_time() - cpu
        self._number = first + len(np.load("published.npy")) - 1
        np.save("heard.npy", np.array(self._heard).reshape(-1, 2))
        self._tell(first, time.perf_counter() - began, spent)

    def direct(self, hz: float, seconds: float) -> None:
        """Pass scans to the first widget at a rate without a feed, to measure the latency of the widget."""
        wander = random.Random(2)
        laser, first = self._lasers[0], self._number + 1
        stamps, due = [], time.perf_counter()
        cpu, began = time.process_time(), due
        for number in range(first, first + round(hz * seconds)):
            ranges = encode(number)
            stamps.append(now_us())
            laser.update(ranges=ranges, **SETTINGS)
            due += wander.uniform(0.9, 1.1) / hz
            time.sleep(max(0.0, due - time.perf_counter()))
        self._number = first + len(stamps) - 1
        np.save("published.npy", np.array(stamps))
        self._tell(first, time.perf_counter() - began, time.process_time() - cpu)

    def close(self) -> None:
        """End the feed and the processes."""
        self._robot.close()

    def _tell(self, first: int, seconds: float, cpu: float) -> None:
        stamps = np.load("published.npy")
        epoch = int(stamps[0])
        np.save("stamps.npy", (stamps - epoch).astype(np.int64))
        facts = {"epoch": epoch, "first": first, "last": self._number, "seconds": seconds, "cpu": cpu}
        Path("facts.json").write_text(json.dumps(facts))
        os.replace("facts.json", f"facts-{first}.json")

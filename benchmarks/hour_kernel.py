"""The code in the notebook's kernel for an hour: a robot with laser, speed and touch sensor at 40 Hz."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import numpy as np
from IPython.display import display

from robowidgets import LaserWidget, SpeedWidget, TouchWidget, screen

from .rivals.laser import GEOMETRY
from .scan import encode

HZ = 40.0
CAPACITY = 1 << 22


class Source:
    """Samples numbered from 1 on, and the time of each `update`. The speed widget shows the number."""

    def __init__(self, _name: str, _count: int) -> None:
        self._laser, self._speed, self._touch = (
            LaserWidget(title="/scan"),
            SpeedWidget(linear_limits=None),
            TouchWidget(),
        )
        self._ended = threading.Event()
        # Milliseconds since the epoch; written once, so that the run allocates no memory.
        self._stamps = np.ones(CAPACITY)
        self._number = 0
        self._thread = threading.Thread(target=self._run, daemon=True)

    def show(self) -> None:
        """Display the widgets, and start the robot."""
        display(screen(self._laser, self._speed, self._touch))  # type: ignore[no-untyped-call]
        self._thread.start()

    def stop(self) -> None:
        """End the robot, and save the time of each `update`."""
        self._ended.set()
        self._thread.join()
        np.save("stamps.npy", self._stamps[: self._number + 1])

    def resident(self) -> int:
        """Return the bytes of memory of the kernel's process."""
        line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmRSS:"))
        return int(line.split()[1]) * 1000

    def _run(self) -> None:
        due = time.perf_counter()
        while not self._ended.is_set() and self._number + 1 < CAPACITY:
            number = self._number + 1
            self._stamps[number] = time.time() * 1000
            self._laser.update(ranges=encode(number), **GEOMETRY)
            self._speed.update(linear=(number, 0, 0), angular=(0, 0, 0))
            self._touch.update(left=number % 80 < 5)
            self._number = number
            due += 1 / HZ
            time.sleep(max(0.0, due - time.perf_counter()))

"""The code in the notebook's kernel, which passes scans to a widget in the main thread of a busy cell."""

from __future__ import annotations

import importlib
import json
import os
import random
import time
from pathlib import Path
from typing import Any

import numpy as np
from IPython.display import display

from .scan import encode

CAPACITY = 1 << 23


class Source:
    """Scans numbered from 1 on, and the time of each `update`."""

    def __init__(self, rival: str, count: int = 1) -> None:
        self._module = importlib.import_module(f"benchmarks.rivals.{rival}")
        self._count = count
        self._updates: list[Any] = []
        # Microseconds since now; written once, so that a run allocates no memory.
        self._epoch = time.time_ns() // 1000
        self._stamps = np.ones(CAPACITY, np.uint32)
        self._number = 0

    def show(self) -> None:
        """Display the widgets, each with the scan of number 0."""
        for _ in range(self._count):
            shown, update = self._module.make(encode(0))
            self._updates.append(update)
            display(shown)  # type: ignore[no-untyped-call]

    def put(self, number: int) -> None:
        """Show one number, outside of a run."""
        for update in self._updates:
            update(encode(number))

    def pace(self, hz: float, seconds: float) -> None:
        """Pass on scans at a rate. The steps vary by a tenth, to meet every phase of the display."""
        wander = random.Random(1)
        due = time.perf_counter()

        def wait() -> None:
            nonlocal due
            due += wander.uniform(0.9, 1.1) / hz
            time.sleep(max(0.0, due - time.perf_counter()))

        self._run(round(hz * seconds), float("inf"), wait)

    def flood(self, seconds: float) -> None:
        """Pass on scans as fast as the widget takes them."""
        self._run(CAPACITY, seconds, lambda: None)

    def _run(self, count: int, seconds: float, wait: Any) -> None:
        updates, stamps, epoch = self._updates, self._stamps, self._epoch
        number = first = self._number + 1
        cpu, start = time.process_time(), time.perf_counter()
        while number < first + count and time.perf_counter() - start < seconds:
            ranges = encode(number)
            stamps[number] = time.time_ns() // 1000 - epoch
            for update in updates:
                update(ranges)
            number += 1
            wait()
        self._number = number - 1
        facts = {
            "epoch": epoch,
            "first": first,
            "last": self._number,
            "seconds": time.perf_counter() - start,
            "cpu": time.process_time() - cpu,
        }
        # In a file, because prints would queue behind the scans that the page has not shown yet.
        np.save("stamps.npy", stamps[first:number])
        Path("facts.json").write_text(json.dumps(facts))
        os.replace("facts.json", f"facts-{first}.json")

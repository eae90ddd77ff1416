"""The time until a new version of a program steps, and the cost of a step, in a real kernel with the simulator."""

from __future__ import annotations

import time
from dataclasses import dataclass
from statistics import median, quantiles

from .stopping import Kernel

VERSIONS = 100
RATE = 20.0
"""The steps per second of the program that is replaced repeatedly."""
FASTEST = 200
"""The steps per second of the programs with measured steps."""
STEPS = 1000

SETUP = """
import time
from statistics import median
from robowidgets import MachineWidget, feeds
from robowidgets.behaviors import Drive
robot = feeds.simulator(wander=False)
first, at = [], []
"""
AGAIN = """
@robot.program(rate={rate})
def again(scan, number={number}):
    if len(first) == number:
        first.append(time.monotonic())
    return Drive(0.1)
"""
PLAIN = """
def measured(scan, variables):
    at.append(time.thread_time())
    return Drive(0.0)
"""
MACHINE = """
class measured:
    never = lambda variables: variables.go
    def running():
        at.append(time.thread_time())
        return Drive(0.0)
    class outer:
        class middle:
            class inner:
                near = lambda scan: scan.distance("front") < 0.0
                still = moved = None
                moves = "still -> moved on near"
            other = None
            moves = "inner -> other after 1e9"
        other = None
        moves = "middle -> other on never"
    other = None
    moves = "outer -> other on never"
robot.variables.go = False
"""
SECTORS = """
def measured(scan, variables):
    at.append(time.thread_time())
    front = scan.distance("front")
    left, right = scan.distance("left"), scan.distance("right")
    if front < 0.6 or left < 0.2:
        return Drive(0.0, 0.0 if left > right else -0.0)
    return Drive(0.0)
"""
NOTED = "assert lines.step.calls[0].notes.seen\n"
EVENT = """
scans = [next(robot.scans("/scan"))]
def cpu():
    start = time.thread_time()
    scans[0].distance("front") < 0.0
    return time.thread_time() - start
cause = 1000 * median(cpu() for _ in range(1000))
"""
MEASURE = """
at.clear()
robot.program(measured, rate={rate})
while len(at) < {steps}:
    time.sleep(0.1)
cause = 1000 * median(later - earlier for earlier, later in zip(at, at[1:]))
robot.programs.current.close()
"""


@dataclass
class Found:
    """Milliseconds from cells to first steps, and of CPU in the program's thread per step."""

    first_step: list[float]
    plain: float
    machine: float
    watched: float
    """With a `MachineWidget`."""
    sectors: float
    """Of a step that asks for three distances."""
    lines: float
    """Of that step, with a `LinesWidget`."""
    event: float
    """The cost of the distance that the machine asks for, which is code of the user."""

    @property
    def first_step_p95(self) -> float:
        return quantiles(self.first_step, n=20)[-1]

    @property
    def first_step_median(self) -> float:
        return median(self.first_step)


def measured(versions: int = VERSIONS, steps: int = STEPS) -> Found:
    """Measure all figures in one kernel."""
    kernel = Kernel()
    measure = MEASURE.format(rate=FASTEST, steps=steps)
    try:
        kernel.run(SETUP)
        first = []
        for number in range(versions):
            start = time.monotonic()
            kernel.run(AGAIN.format(rate=RATE, number=number))
            at = kernel.run(f"while len(first) <= {number}: time.sleep(0.002)\ncause = first[{number}]")
            first.append(1000 * (at - start))
        plain = kernel.run(PLAIN + measure)
        machine = kernel.run(MACHINE + measure)
        watched = kernel.run("widget = MachineWidget(robot)" + MACHINE + measure)
        kernel.run("widget.close()")
        sectors = kernel.run(SECTORS + measure)
        lines = kernel.run(
            "from robowidgets import LinesWidget\nlines = LinesWidget(robot)" + SECTORS + measure + NOTED
        )
        return Found(first, plain, machine, watched, sectors, lines, kernel.run(EVENT))
    finally:
        kernel.close()

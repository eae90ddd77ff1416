"""The program of a robot, and the variables that its programs share."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from contextvars import copy_context
from dataclasses import replace
from itertools import count
from typing import Any
from weakref import WeakSet

from ..notebook.cells import CellRun, is_same_cell, on_cell_error, on_interrupt, running_cell
from ..runtime.inform import inform
from ..runtime.user_function import calling_text
from ..widget.observed import Observed
from ._parameters import parameters_of, program_name
from .kept_steps import KeptSteps
from .lines.watch import LineWatch, WatchedStep
from .machine import Machine
from .program import ENDED, RUNNING, Program
from .robot import DrivenRobot
from .variables import Variables
from .version import RATE, Version, to_rate

MAX_REPORTS = 100
"""The number of reports that are kept for observers."""


class Programs(Observed):
    """The programs of one robot. Only one of them drives the robot at a time.

    Args:
        robot: the robot.

    Attributes:
        variables: the values that the user sets while a program runs.
        current: the program that drives, or None before the first program.
        reports: the newest texts of `report`, each with its number.
    """

    def __init__(self, robot: DrivenRobot) -> None:
        super().__init__()
        self._robot = robot
        self.variables = Variables()
        self.current: Program | None = None
        self.lines: LineWatch | None = None
        """Notes the values of the lines of each step, for the widgets that show them; None without any."""
        self.kept: KeptSteps | None = None
        """The inputs of the last steps, or None if no view asks for them."""
        self._keepers: set[int] = set()
        """The ids of the views that ask for them."""
        self._known: dict[str, Program] = {}
        self.reports: deque[tuple[int, str]] = deque(maxlen=MAX_REPORTS)
        self._report_numbers = count()

    def install(
        self, function: Callable[..., Any], rate: float | None, on: str | None, topics: Mapping[str, str]
    ) -> Program:
        """Run a function as the robot's program; see `robowidgets.feeds.Feed.program`."""
        if rate is not None and on is not None:
            raise TypeError("program: expected rate=, steps a second, or on=, a topic; got both")
        steps = to_rate(RATE if rate is None else rate)
        if isinstance(function, type):
            function = Machine(function)
        name = program_name(function)
        asks_for = parameters_of(function, name, topics)
        known, before = self._known.get(name), self.current
        note = ""
        if before is not None and before.name != name and before.mode != ENDED:
            note = f"replaces the program {before.name}"
            before.close(f"replaced by the program {name}", keeps=True)
            inform(f"{self._robot.where}: the program {name} {note}")
        program, number = known, known.version.number + 1 if known else 1
        if program is None or program.mode == ENDED:
            program = self._known[name] = Program(name, self._robot, self.variables)
            if known is not None and known.keeps:
                program.continue_from(known)
            program.observe(self._call_observers)
            program.lines = self.lines
        if isinstance(function, Machine) and isinstance(program.version.function, Machine):
            function.adopt(program.version.function)
        if self.lines is not None:
            self.lines.prepare((name, number), function)
        self.current = program
        self.variables.begin_version()
        program.replace(Version(function, asks_for, dict(topics), steps, on, number, calling_text(), running_cell()))
        program.note = note
        if isinstance(function, Machine) and function.note:
            inform(f"program {name}: {function.note}")
        _all.add(program)
        on_interrupt(_interrupt_all)
        on_cell_error(_name_running)
        self._call_observers()
        return program

    def change(self, before: Version, after: Version) -> Version:
        """Put another version into the current program, and return it with its number.

        Args:
            before: the version that it was made from.
            after: the other one, with the same parameters, topics and rate. The function of a state machine is another
                one, which continues in the same states.

        Raises:
            RuntimeError: a third version is in force, or the program has ended.
        """
        program = self.current
        if program is None or program.version is not before:
            raise RuntimeError("another version is in force now")
        version = replace(after, number=before.number + 1)
        if isinstance(version.function, Machine) and isinstance(before.function, Machine):
            version.function.adopt(before.function)
        if self.lines is not None:
            self.lines.prepare((program.name, version.number), version.function)
        program.change(before, version)
        self.variables.begin_version()
        self._call_observers()
        return version

    def keep_inputs(self, view: object, *, is_on: bool) -> None:
        """Keep the inputs of the last steps as long as a view asks for them, so that other versions can be tried."""
        self._keepers = {*self._keepers, id(view)} if is_on else self._keepers - {id(view)}
        self.kept = (self.kept or KeptSteps()) if self._keepers else None
        if self.lines is not None:
            self.lines.keep = None if self.kept is None else self.kept.add

    def watch_lines(self) -> deque[WatchedStep]:
        """Note the values of the lines, and return a queue that gets each step from now on."""
        if self.lines is None:
            self.lines = LineWatch()
        queue, current = self.lines.add_view(), self.current
        if current is not None and current.lines is None:
            self.lines.prepare((current.name, current.version.number), current.version.function)
        for program in list(self._known.values()):
            program.lines = self.lines
        return queue

    def unwatch_lines(self, queue: deque[WatchedStep]) -> None:
        """Put no more steps into a queue; without any queue, nothing is noted."""
        if self.lines is None:
            return
        self.lines.remove_view(queue)
        if not self.lines.is_on:
            self.lines = None
            for program in list(self._known.values()):
                program.lines = None

    def report(self, text: str) -> None:
        """Report a command of an assistant, or its end, to lists of events and to recorders."""
        self.reports.append((next(self._report_numbers), text))
        self._call_observers()

    def close(self) -> None:
        """End the program."""
        if self.current is not None:
            self.current.close("the robot is closed")


_all: WeakSet[Program] = WeakSet()


def _interrupt_all() -> None:
    for program in list(_all):
        program.interrupt()


def _name_running(cell: CellRun) -> list[str]:
    """Return a line for each program that goes on although its cell ended with an error."""
    lines = []
    for program in list(_all):
        version = program.version
        if program.mode == RUNNING and is_same_cell(version.cell, cell):
            program.context = copy_context()  # for its output below this run, which has cleared the previous output
            whose = "which this run made before its error" if version.cell == cell else "the one before"
            lines.append(f"the program {program.name} goes on, in version {version.number}, {whose}")
    return lines

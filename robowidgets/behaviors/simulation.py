"""Programs on the simulated robot, faster than real time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

from ..kinds import KINDS, kind_of_parameter, sensor_of
from ..simulator import Robot
from ._parameters import parameters_of, program_name
from .drive import STANDSTILL, Drive, drive_of
from .lines.watch import LineWatch
from .machine import ROUNDING, Machine
from .odometer import Odometer
from .program import Program
from .robot import DRIVEN, ODOMETRY, POSE, TURNED
from .variables import ProgramState, Variables
from .version import RATE, to_rate


class Step(NamedTuple):
    """One step of a simulated program: seconds, the speed in force, and the active states of a machine."""

    time: float
    drive: Drive
    active: tuple[str, ...]


def function_of(program: Any) -> Any:
    """Return the function that a program calls at each step: for a state machine, a new one in its initial state."""
    function = program.version.function if isinstance(program, Program) else program
    described = function.cls if isinstance(function, Machine) else function
    return Machine(described) if isinstance(described, type) else described


class ProgramRun:
    """One run of a program, from its beginning.

    Args:
        program: as for `simulate`.
        variables: the variables of the program, or None for new variables.

    Attributes:
        name: the name of the program.
        topics: the topics that it names, by parameter.
        asks_for: its parameters.
        odometer: sums up the poses of the robot.
        lines: notes the values of the lines of each step; None if they are not asked for.
        returned: the value that the function returned in the last step.
    """

    def __init__(self, program: Any, variables: Variables | None = None) -> None:
        self.lines: LineWatch | None = None
        self.returned: Any = None
        self._steps = 0
        self._function = function_of(program)
        self.name = program_name(self._function)
        self.topics: Mapping[str, str] = program.version.topics if isinstance(program, Program) else {}
        self.asks_for = parameters_of(self._function, self.name, self.topics)
        self.odometer = Odometer()
        variables = Variables() if variables is None else variables
        self._own: dict[str, Any] = {"state": ProgramState(), "variables": variables}
        self._drive = STANDSTILL

    @property
    def active(self) -> tuple[str, ...]:
        """The active states of a machine; empty for a function."""
        return self._function.active if isinstance(self._function, Machine) else ()

    def call(self, values: Mapping[str, Any]) -> Any:
        """Return the result of the function for some values, and for the state and the variables of this run."""
        return self._function(**values, **{name: own for name, own in self._own.items() if name in self.asks_for})

    def step(self, time: float, samples: Mapping[str, Callable[[], Any]]) -> Drive:
        """Make a step, and return the speed in force after it.

        Args:
            time: seconds since the program began.
            samples: by parameter, a function that returns the newest sample.
        """
        odometer = self.odometer
        given = {**self._own, "time": time, POSE: odometer.pose, DRIVEN: odometer.driven, TURNED: odometer.turned}
        values = {name: samples[name]() if name in samples else given[name] for name in self.asks_for}
        self._steps += 1
        if self.lines is None:
            self.returned = self._function(**values)
        else:
            self.returned = self.lines.step((self.name, 0), (self._steps, time), self._function, values)
        self._drive = drive_of(self.returned, self._drive)
        return self._drive


def simulate(
    program: Callable[..., Any],
    robot: Robot,
    seconds: float,
    *,
    until: Callable[[], object] | None = None,
    rate: float = RATE,
    variables: Variables | None = None,
) -> Iterator[Step]:
    """Drive a simulated robot by a program in simulated time, to test programs.

    Errors of the program are raised. Between two steps the caller may set variables and look at the robot.

    Args:
        program: a function or a class, as `robowidgets.feeds.Feed.program` takes it, or the program that it returned,
            with the topics that it names.
        robot: the robot.
        seconds: the duration in simulated time.
        until: a function that ends the run sooner by returning true.
        rate: steps per second.
        variables: the variables of the program.

    Returns:
        An iterator over the steps.

    Raises:
        TypeError, ValueError: as `program` of a feed. ValueError: the robot lacks a sensor that the program asks for.

    Examples:
        >>> from robowidgets.simulator import Robot, World
        >>> robot = Robot(World.rooms(), seed=1)
        >>> steps = list(simulate(lambda: Drive(0.2), robot, 2.0))
        >>> round(robot.speed().linear[0], 1)
        0.2
    """
    run = ProgramRun(program, variables)
    period = 1 / to_rate(rate)
    samples = _samples(robot, run.asks_for, run.topics)
    start, due = robot.time, 0.0
    while (now := round(robot.time - start, 9)) < seconds and not (until and until()):
        run.odometer.add(robot.odometry)
        drive = run.step(now, samples)
        robot.drive(drive.linear, drive.angular, drive.lateral)
        due = max(due, now - ROUNDING) + period  # not from `now`, whose rounding to nanoseconds would add up
        robot.step(due - now)
        yield Step(now, drive, run.active)


def _samples(robot: Robot, asks_for: Iterable[str], topics: Mapping[str, str]) -> dict[str, Callable[[], Any]]:
    """Map each parameter to a function that returns its newest sample; ValueError if the robot lacks its sensor."""
    found: dict[str, Callable[[], Any]] = {}
    sent = {offer.topic: offer.read for kind in KINDS.values() if kind.simulated for offer in kind.simulated(robot)}
    for name in asks_for:
        kind = kind_of_parameter(name)
        if name in topics and name not in ODOMETRY and (kind is None or kind.roles[0].combine is None):
            if topics[name] not in sent:
                raise ValueError(
                    f"a program asks for {name} on {topics[name]}, but the simulated robot sends only {', '.join(sent)}"
                )
            found[name] = sent[topics[name]]
            continue
        if kind is None:
            continue
        offers = kind.simulated(robot) if kind.simulated else []
        measured = {sensor_of(offer.topic): offer.read for offer in offers if not offer.obeyed}
        if not measured:
            raise ValueError(
                f"a program asks for {name}, but the simulated robot has no {kind.noun}: "
                "remove the parameter, or give the robot some"
            )
        combine = kind.roles[0].combine
        found[name] = next(iter(measured.values())) if combine is None else partial(_read_all, robot, measured, combine)
    return found


def _read_all(robot: Robot, measured: Mapping[str, Callable[[], Any]], combine: Callable[..., Any]) -> Any:
    samples = {sensor: read() for sensor, read in measured.items()}
    stamps = {sensor: sample.stamp_ns for sensor, sample in samples.items()}
    return combine(samples, {name: robot.time if stamp is None else stamp / 1e9 for name, stamp in stamps.items()})

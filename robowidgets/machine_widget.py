"""The state machine of a robot on the page: its states, its events and its transitions."""

from __future__ import annotations

import json
import time
from math import inf
from typing import Any

import traitlets

from .behaviors.machine import Fired, Machine, MachineStep
from .behaviors.program import FAILED, Program
from .behaviors.program_view import ProgramView
from .behaviors.step_clock import StepClock
from .behaviors.version import Version
from .samples.state_span import StateSpan, rows_of
from .widget.front_end import bundle

MOST_FIRED = 30
"""The number of transitions that are listed on the page."""

LATEST_BEATS = 3
"""The most beats since the beat that the page sends with a request. An older request is refused."""

BAND = 30.0
"""Seconds of states that the page shows as a band."""


class MachineWidget(ProgramView[MachineStep]):
    """The state machine that drives a robot: its states, with the active ones lit, and its transitions.

    A band below shows the states of the last 30 s.

    It shows each machine that drives the robot from now on, and follows its new versions. A click on a transition
    freezes this widget and all widgets of the robot at that moment.

    Args:
        robot: a feed.
        title: title in the header; by default the name of the machine.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps steps to go back through, 0 (none) to 600.
        header, footer: False to hide them.

    Raises:
        TypeError: not a feed, or an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Examples:
        >>> from robowidgets import feeds
        >>> class Walker:
        ...     forward = turn = None
        ...     moves = "forward -> turn after 2", "turn -> forward after 1"
        >>> with feeds.simulator(wander=False) as robot:
        ...     widget = MachineWidget(robot)
        ...     program = robot.program(Walker)
        >>> widget.title
        'Walker'
    """

    _esm, _css = bundle("machine_widget")

    sample_name = "machine"
    send_interval = 0.05

    _outline = traitlets.Dict(help="Name of the machine, key of the version, and its machines.").tag(
        sync=True, echo_update=False
    )

    def __init__(self, robot: Any, **kwargs: Any) -> None:
        self._program: Program | None = None
        self._in_force: Version | None = None
        self._clock = StepClock()
        """The clock of the steps on show."""
        self._packed: MachineStep | None = None
        """The step of the newest frame."""
        self._packed_at = self._made_after = time.monotonic()
        """The time of that step, and of the step in the frame before it."""
        super().__init__(robot, **kwargs)
        self._source = {"robot": self._robot, "status": "waiting for a state machine"}
        self.on_msg(self._on_page)
        self._follow_programs()

    def _describe(self) -> str:
        program = self._program
        machine = program.version.function if program else None
        return machine.active_text if isinstance(machine, Machine) else ""

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Go to a state, unless a busy kernel delayed the message. Called in the main thread or in a subshell's."""
        if not isinstance(content, dict) or "go" not in content:
            return
        state, beat, program = content["go"], content.get("beat"), self._program
        if type(beat) is not int or not self._beat - LATEST_BEATS <= beat <= self._beat:
            self.send({"refused": "the kernel was busy: press it again"})
        elif program is not None and isinstance(state, str):
            try:
                program.go_to(state)
            except (RuntimeError, TypeError, ValueError) as error:
                self.send({"refused": str(error)})

    def _on_step(self) -> None:
        """Store the result of the last step for the pacer. The thread of the program usually calls this."""
        program = self._programs.current
        if program is None:
            return
        if program.version is not self._in_force:
            self._follow(program)
        machine = program.version.function
        if isinstance(machine, Machine):
            self._clock = program.clock
            step = error = None
            # If a program is paused in the middle of a step, two threads call this at once. The last one stores the
            # newest.
            while step is not machine.last_step or error != program.error:
                step, error = machine.last_step, program.error
                self.set_source({**self._source, "error": error})
                self._show(step, counts=step is not self._newest.sample)

    def _follow(self, program: Program) -> None:
        """Show another version."""
        self._program, self._in_force = program, program.version
        machine, key = program.version.function, f"{program.name} {program.version.number}"
        status = ""
        if isinstance(machine, Machine):
            self.name_after(machine.name)
            self._outline = {"key": key, "name": machine.name, "machines": machine.describe()}
        else:
            status = f"{program.name} drives now, which is not a state machine"
            if self._newest.sample is not None:
                self._show(self._newest.sample, counts=False)
        self._source = {"robot": self._robot, "status": status}

    def _about_sample(self, sample: MachineStep) -> dict[str, Any]:
        program = self._program
        if program is None:
            return {}
        machine = program.version.function
        is_machine = isinstance(machine, Machine)
        return {
            "mode": program.mode if is_machine else "ended",
            "version": program.version.number,
            "fired": [_plain(fired, self._clock) for fired in sample.fired[-MOST_FIRED:]],
            "states": _rows(sample, self._clock),
            "notes": [note for note in (machine.note, machine.turns) if note] if isinstance(machine, Machine) else [],
            "failed": machine.at if isinstance(machine, Machine) and program.mode == FAILED else "",
        }

    def _pack(self, sample: MachineStep) -> bytes:
        if sample is not self._packed:
            self._packed, self._made_after, self._packed_at = sample, self._packed_at, self._clock.at(sample.time)
        judged = {key: (one.value, one.text) for key, one in sample.judged.items()}
        # Not every step has a frame: the event of a transition is shown as true in the first frame after it.
        for fired in sample.fired:
            if fired.event and self._clock.at(fired.time) > self._made_after:
                judged[fired.machine, fired.event] = True, fired.text
        told = {
            "key": self._outline.get("key", ""),
            "time": sample.time,
            "states": sample.states,
            "judged": [(*key, *one) for key, one in judged.items()],
            "seconds": [(*key, seconds) for key, seconds in sample.seconds.items()],
        }
        return json.dumps(told).encode()


def _rows(step: MachineStep, clock: StepClock) -> list[list[tuple[float, float | None, str]]]:
    """Return the states of the last seconds as rows, in monotonic time. An active state has no end."""
    left = [span for span in step.left if span.end > step.time - BAND]
    active = [StateSpan(entered, inf, f"{machine}.{name}") for machine, (name, entered) in step.states.items()]
    return [
        [(clock.at(start), None if end == inf else clock.at(end), path) for start, end, path in row]
        for row in rows_of([*left, *active])
    ]


def _plain(fired: Fired, clock: StepClock) -> dict[str, Any]:
    nearest = fired.nearest
    return {
        "at": clock.at(fired.time),
        "time": fired.time,
        "machine": fired.machine,
        "source": fired.source,
        "target": fired.target,
        "why": fired.why,
        "reading": fired.text or (f"{nearest.range:.2f} m" if nearest else ""),
        "index": nearest.index if nearest else None,
    }

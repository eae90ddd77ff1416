"""The program of a robot line by line: what each line computed in a step, which were reached, and how often."""

from __future__ import annotations

import json
from collections import deque
from typing import Any

from .behaviors.lines.numbers import numbers_in
from .behaviors.lines.packed import Totals, calls_by_function, packed_function, packed_step, spread
from .behaviors.lines.watch import WatchedCall, WatchedStep
from .behaviors.program import Program
from .behaviors.program_view import ProgramView
from .behaviors.trials import Trials
from .behaviors.version import Version
from .lines.number import ChangedNumber
from .lines.traits import LinesTraits
from .lines.versions import ComparedVersions
from .widget.pacer import pacer

MOST_BETWEEN = 6
"""Steps that a frame has at most: the newest one, and some of those since the frame before."""


class LinesWidget(LinesTraits, ProgramView[WatchedStep]):
    """The source of the program that drives a robot, and next to each line the values of its newest step.

    A line shows its value with its unit, the deciding ray, the compared values, how often it was reached, and a small
    graph of the last seconds. A loop has a row for each pass. If a step fails, its line and the values before it are
    shown. For a state machine, the functions that the step called are shown.

    While a widget exists, the functions of the program are rewritten so that they note their values. While frozen, it
    goes back through single steps.

    Args:
        robot: a feed.
        title: for the header, or empty for the name of the program.
        folded: True to show only one line.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps steps to go back through, 0 (none) to 600.
        header, footer: False to hide them.

    Raises:
        TypeError: not a feed, or an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Examples:
        >>> from robowidgets import feeds
        >>> with feeds.simulator(wander=False) as robot:
        ...     widget = LinesWidget(robot)
        >>> widget.step is None
        True
    """

    sample_name = "step"
    send_interval = 0.1
    """The shortest time in seconds between two messages. Users cannot read faster."""

    def __init__(self, robot: Any, **kwargs: Any) -> None:
        self._queue: deque[WatchedStep] = deque()
        self._totals = Totals()
        self._version: tuple[str, int] | None = None
        self._functions: dict[str, dict[str, Any]] = {}
        self._packed: tuple[WatchedStep | None, bytes] = (None, b"")
        self._between: list[WatchedStep] = []
        """The steps of the next frame."""
        self._named = ""
        """The name of the program in its title."""
        self._mode: tuple[Any, ...] = ()
        self._in_force: tuple[str, Version] | None = None
        """The name of the program, and the version, of the last step that was taken."""
        self._changed_number: ChangedNumber | None = None
        self._compared_versions: ComparedVersions | None = None
        super().__init__(robot, **kwargs)
        self._trials = Trials()
        self._changed_number = ChangedNumber(self._programs, self._trials, self._mark_trial)
        self._compared_versions = ComparedVersions(self._trials, self._mark_trial)
        self.on_msg(self._on_page)
        self._queue = self._programs.watch_lines()
        self.observe(self._on_folded, "folded")
        self._on_folded()
        self._source = {"robot": self._robot, "status": "waiting for a step of a program"}
        self._follow_programs()

    @property
    def step(self) -> WatchedStep | None:
        """The newest step, or None before the first one."""
        lines = self._programs.lines
        return lines.newest if lines is not None else None

    def close(self) -> None:
        """Remove the widget from the page; the program goes on."""
        if "_programs" in vars(self):  # else the constructor raised before it set them
            self._programs.keep_inputs(self, is_on=False)
            self._programs.unwatch_lines(self._queue)
        if "_trials" in vars(self):
            self._trials.close()
        super().close()

    def _describe(self) -> str:
        step = self.step
        return f"step {step.number} of {step.program[0]}" if step else ""

    def _on_step(self) -> None:
        """Mark this widget for the pacer. The thread of the program calls this, and does no other work for it."""
        program = self._programs.current
        if program is not None and program.name != self._named:
            self._named = program.name
            self.name_after(program.name)
        pacer.mark(self)

    def _on_folded(self, _change: Any = None) -> None:
        self._programs.keep_inputs(self, is_on=not self.folded)

    def _mark_trial(self) -> None:
        """Mark this widget for the pacer, which sends the state of a trial. The thread of the trials calls this."""
        pacer.mark(self)

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Handle a message about a number, in the main thread or in a subshell's. It does not wait."""
        if self._changed_number is None or not isinstance(content, dict) or "number" not in content:
            return
        try:
            self._changed_number.on_page({**content, "act": content["number"]})
        except ValueError as error:
            self._log_once(str(error))

    def _send_trials(self) -> None:
        for name, trial in (("_number", self._changed_number), ("_compared", self._compared_versions)):
            if trial is not None and trial.state != self._trait_values.get(name):
                self._trait_values[name] = trial.state
                self.send_state(name)

    def _bring_up_to_date(self) -> None:
        """See `FreezableWidget`: take the steps that came, first."""
        with self._send_lock:
            self._take_steps()
            self._send_trials()
            super()._bring_up_to_date()

    def _take_steps(self) -> None:
        steps = []
        while self._queue:
            steps.append(self._queue.popleft())
        program = self._programs.current
        if program is not None:
            self._tell_mode(program)
        if not steps:
            if program is not None:
                self._show_prepared(program)
            return
        newest = steps[-1]
        if newest.program != self._version:
            self._version, self._totals, self._functions = newest.program, Totals(), {}
            self._compare(program)
        steps = [step for step in steps if step.program == self._version]
        self._totals.add(steps)
        self._between = [*self._between, *steps]
        self._note_functions(steps)
        with self._newest.lock:
            self._newest.put(newest, {}, counts=True)
            self._newest.arrived = newest.at

    def _compare(self, program: Program | None) -> None:
        """Compare a version that has made its first step with the one before."""
        if program is None:
            return
        before, self._in_force = self._in_force, (program.name, program.version)
        name, version = self._in_force
        kept = self._programs.kept
        if self._compared_versions is None or kept is None or self.folded or (name, version.number) != self._version:
            return
        if before is not None and before[0] == name and before[1].number < version.number:
            self._compared_versions.compare(name, before[1], version, kept, program.step_time)

    def _tell_mode(self, program: Program) -> None:
        """Show that a program waits, has failed or has ended, though no step came."""
        source = {"robot": self._robot, "status": "" if self._newest.sample else "waiting for a step of a program"}
        if source != self._source:
            self.set_source(source)
        mode = program.mode, program.error, program.version.number
        if mode != self._mode:
            self._mode = mode
            with self._newest.lock:
                self._newest.changed = True

    def _show_prepared(self, program: Program) -> None:
        """Show the source of a version that makes no step yet, such as while Stop is active."""
        lines, version = self._programs.lines, program.version
        name, number = shown = program.name, version.number
        if lines is None or shown == self._version or self._code.get("key") == f"{name} {number}":
            return
        if (call := lines.prepared(shown)) is not None:
            self._send_code(name, number, [self._describe_function(call, version)])

    def _note_functions(self, steps: list[WatchedStep]) -> None:
        found, version = len(self._functions), self._in_force[1] if self._in_force is not None else None
        for step in steps:
            for call in step.calls:
                if call.source.key not in self._functions:
                    self._functions[call.source.key] = self._describe_function(call, version)
        name, number = self._version or ("", 0)
        if len(self._functions) != found or self._code.get("key") != f"{name} {number}":
            self._send_code(name, number, sorted(self._functions.values(), key=lambda one: int(one["first"])))

    def _send_code(self, name: str, number: int, functions: list[dict[str, Any]]) -> None:
        key = f"{name} {number}"
        self._trait_values["_code"] = {"key": key, "name": name, "version": number, "functions": functions}
        self.send_state("_code")

    def _describe_function(self, call: WatchedCall, version: Version | None) -> dict[str, Any]:
        """Return the source of a function with its numbers, and its lines as they stand in the cell if they differ."""
        described, source, lines = packed_function(call), call.source, self._programs.lines
        function = lines.function_of(source.key) if lines is not None else None
        described["numbers"] = [] if function is None else [[*number] for number in numbers_in(function)]
        if version is not None and version.written:
            part = slice(source.first - 1, source.first - 1 + len(source.texts))
            cell, now = (text.split("\n")[part] for text in (version.written, version.text))
            if cell != now:
                described["cell"] = cell
                described["changed"] = now
        return described

    def _about_sample(self, sample: WatchedStep) -> dict[str, Any]:
        program = self._programs.current
        if program is None:
            return {}
        is_current = (program.name, program.version.number) == sample.program
        # An error of no line of the program, such as a step that does not return.
        said = program.error if is_current and not any(call.error for call in calls_by_function(sample)) else ""
        return {
            "mode": program.mode if is_current else "replaced",
            "version": sample.program[1],
            "failure": said,
        }

    def _pack(self, sample: WatchedStep) -> bytes:
        if self._packed[0] is not sample:
            steps = spread(self._between or [sample], MOST_BETWEEN) if not self.folded else [sample]
            self._between = []
            name, number = sample.program
            packed = {
                "key": f"{name} {number}",
                "steps": [packed_step(step) for step in steps],
                "total": self._totals.steps,
                "totals": self._totals.packed(),
            }
            self._packed = sample, json.dumps(packed).encode()
        return self._packed[1]

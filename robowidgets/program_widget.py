"""The program of a robot on the page: its state, its variables, and Stop."""

from __future__ import annotations

import reprlib
from math import isfinite
from typing import Any

import numpy as np

from .behaviors.machine import Machine
from .behaviors.program import ENDED, Program
from .behaviors.programs import Programs
from .driving.command_watchdog import MAX_ANGULAR, MAX_LINEAR
from .driving.driving_widget import DrivingWidget
from .widget.front_end import bundle
from .widget.pacer import pacer


class ProgramWidget(DrivingWidget):
    """The program that drives a robot: its version, rate and speed, its variables, its last prints and error, and Stop.

    It shows each program that drives the robot from now on. Run, Pause and Step act on it; Stop is latched, and Run
    releases it. The page sets the robot's variables by sliders, switches and numbers. While the widget is on the page,
    the prints of the program are shown only there.

    Args:
        robot: a feed.

    Raises:
        TypeError: something else.

    Examples:
        >>> from robowidgets import feeds
        >>> with feeds.simulator(wander=False) as robot:
        ...     widget = ProgramWidget(robot)
        >>> widget.program is None
        True
    """

    _esm, _css = bundle("program_widget")
    _unnamed = 1
    send_interval = 0.1
    """The shortest time in seconds between two messages. Users cannot read faster."""
    column = "narrow"

    def __init__(self, robot: Any, **kwargs: Any) -> None:
        programs = getattr(robot, "programs", None)
        if not isinstance(programs, Programs):
            got = repr(robot).splitlines()[0]
            raise TypeError(f"ProgramWidget(): expected a feed, such as feeds.simulator(), got {got}")
        self._programs = programs
        self._shown: Program | None = None
        super().__init__(**kwargs)
        self._attach(robot.watchdog, robot)
        programs.observe(self._on_step)
        programs.variables.observe(self._on_step)
        self._on_step()

    @property
    def program(self) -> Program | None:
        """The program on show, or None before the first one."""
        return self._programs.current

    def close(self) -> None:
        """Remove the widget from the page; the program goes on."""
        if "_programs" in vars(self):
            self._programs.unobserve(self._on_step)
            self._programs.variables.unobserve(self._on_step)
            self._show(None)
        super().close()

    def _show(self, program: Program | None) -> None:
        """Show the prints of a program instead of the prints of the one before."""
        before, self._shown = self._shown, program
        if before is not None and before is not program:
            before.has_view = False
        if program is not None:
            program.has_view = True

    def _on_step(self) -> None:
        """Mark the state for the pacer. The thread of the program usually calls this."""
        if self._shown is not self._programs.current:
            self._show(self._programs.current)
        pacer.mark(self)

    def _compose(self) -> dict[str, Any]:
        return {
            **super()._compose(),
            "program": self._program_state(),
            "variables": self._variables(),
            "kept": self._kept(),
        }

    def _program_state(self) -> dict[str, Any] | None:
        program = self._shown
        if program is None:
            return None
        function, feed = program.version.function, self._feed
        limits = (MAX_LINEAR, MAX_ANGULAR, 0.0)
        if feed is not None:
            limits = (feed.driving.max_linear, feed.driving.max_angular, feed.driving.max_lateral)
        return {
            "name": program.name,
            "version": program.version.number,
            "mode": program.mode,
            "waiting": program.waiting,
            "error": program.error,
            "note": program.note,
            "rate": 0.0 if program.waiting else round(program.rate, 1),
            "step_ms": round(1000 * program.step_time, 2),
            "since": round(program.since),
            "speed": (program.returned.linear, program.returned.angular, program.returned.lateral),
            "kept": program.kept,
            "limits": limits,
            "active": function.active_text if isinstance(function, Machine) else "",
            "prints": [(round(seconds, 2), text) for seconds, text in program.prints.lines],
        }

    def _kept(self) -> list[tuple[str, str]]:
        """Return the state of the program, as texts."""
        program = self._shown
        return [] if program is None else [(str(key), _shortened(value)) for key, value in program.state.copy().items()]

    def _variables(self) -> list[dict[str, Any]]:
        table = self._programs.variables.table
        return [
            {"name": name, **{key: _plain(one) for key, one in vars(known).items()}} for name, known in table.items()
        ]

    def _on_page(self, widget: Any, content: Any, buffers: Any) -> None:
        """Handle a message of the page, in the main thread or a subshell's. It does not wait."""
        if not isinstance(content, dict) or "program" not in content:
            super()._on_page(widget, content, buffers)
            return
        act, program = content["program"], self._shown
        if act == "pause" and program is not None:
            program.pause()
        elif type(content.get("token")) is not int or not self._tokens.is_fresh(content["token"]):
            self.send({"refused": content.get("press")})  # a busy kernel delayed it, and the user may be gone
        elif act == "set":
            self._set(content.get("name"), content.get("value"))
        elif act in ("run", "step", "restart") and program is not None and program.mode != ENDED:
            {"run": program.run, "step": program.step, "restart": program.restart}[act]()
        pacer.mark(self)

    def _set(self, name: Any, value: Any) -> None:
        try:
            self._programs.variables.set(name, value)
        except (KeyError, TypeError, ValueError) as error:
            self._log_once(f"the page could not set a variable: {type(error).__name__}: {error}")


class _Short(reprlib.Repr):
    """Short texts of plain values, and the class names of others, because their repr may take any time."""

    def repr_instance(self, x: Any, level: int) -> str:  # noqa: ARG002
        """Return the name of a class."""
        return f"<{type(x).__name__}>"

    def repr_float(self, x: float, level: int) -> str:  # noqa: ARG002
        """Return a short, readable number."""
        return f"{x:.6g}"


_SHORT = _Short()
_SHORT.maxstring = _SHORT.maxother = 40


def _shortened(value: Any) -> str:
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, np.ndarray):
        return f"<array of {' x '.join(map(str, value.shape))}>"
    try:
        return _SHORT.repr(value)
    except RuntimeError:  # the program changed it meanwhile
        return f"<{type(value).__name__}>"


def _plain(value: Any) -> Any:
    """Return a value for JSON: inf and NaN as texts."""
    return str(value) if isinstance(value, float) and not isfinite(value) else value

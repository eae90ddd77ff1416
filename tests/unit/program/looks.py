"""The states of a program whose looks are kept."""

from __future__ import annotations

from typing import Any

from robowidgets import ProgramWidget
from robowidgets.feeds import Feed

from ...looks import Look
from ..driving.looks import told
from ..feeds.scripted import CMD_VEL, SCAN, Scripted


def _widget() -> ProgramWidget:
    with Feed(Scripted(SCAN, CMD_VEL)) as robot:
        return ProgramWidget(robot)


_PROGRAM = {
    "name": "avoid", "version": 2, "mode": "running", "waiting": "", "error": "", "note": "", "rate": 20.0,
    "step_ms": 0.4, "since": 0, "speed": (0.2, -0.3, 0.0), "kept": False, "limits": (0.5, 1.0, 0.0), "active": "",
    "prints": [(1, "near 0.52 m"), (2, "<b>turns</b>")],
}  # fmt: skip
_VARIABLES = [
    {"name": "near", "value": 0.55, "before": 0.5, "low": 0.2, "high": 2.0, "unit": "m", "whole": False},
    {"name": "go", "value": True, "before": True, "low": None, "high": None, "unit": "", "whole": False},
]


def _runs(**changed: Any) -> dict[str, Any]:
    return told(program=_PROGRAM | changed, variables=_VARIABLES, kept=[("n", "3")], driver="program")


_ERROR = "Traceback (most recent call last):\n  line 2, in avoid\nZeroDivisionError: division by zero"

LOOKS = {
    "program/empty": Look(make=_widget, traits=told(program=None, variables=[], kept=[])),
    "program/running": Look(make=_widget, traits=_runs()),
    "program/waiting": Look(make=_widget, traits=_runs(waiting="no scan comes on /scan any more")),
    "program/failed": Look(make=_widget, traits=_runs(mode="failed", error=_ERROR)),
}

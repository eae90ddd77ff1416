"""The states of the lines of a program whose looks are kept."""

from __future__ import annotations

import json
from typing import Any

from robowidgets import LinesWidget
from robowidgets.feeds import Feed
from robowidgets.widget.timed_frame import FRAME_HEADER

from ...looks import NOW, Look
from ..feeds.scripted import CMD_VEL, SCAN, Scripted

_TEXTS = [
    "def avoid(scan, variables):",
    '    front = scan.distance("front")',
    "    if front < variables.near:  # too near",
    "        return Drive(0, 0.8)",
    "    return Drive(0.2)",
]


def _widget() -> LinesWidget:
    with Feed(Scripted(SCAN, CMD_VEL)) as robot:
        return LinesWidget(robot)


def _step(error: tuple[int, str] | None = None) -> dict[str, Any]:
    """The traits after a step."""
    lines = [
        (1, "0.72 m", [], 1, "number", 0.72, []),
        (2, "False", ["0.72 < 0.55"], 1, "flag", 0.0, []),
        (4, "Drive(0.2, 0)", [], 1, "reached", 1.0, []),
    ]
    call = {"key": "avoid 1", "lines": lines[:2] if error else lines, "loops": [], "error": error}
    step = {"number": 7, "time": 0.35, "at": NOW, "given": [("near", "0.55")], "calls": [call], "none": False}
    totals = {"avoid 1": [(1, 7, 0), (2, 7, 2), (3, 2, 0), (4, 5, 0)]}
    packed = {"key": "avoid 1", "steps": [step], "total": 7, "totals": totals}
    function = {"key": "avoid 1", "name": "avoid", "first": 1, "texts": _TEXTS, "code": [1, 2, 3, 4], "why": ""}
    return {
        "title": "avoid",
        "_source": {"robot": "robot", "status": ""},
        "_code": {"key": "avoid 1", "name": "avoid", "version": 1, "functions": [function]},
        "_about": {"mode": "failed" if error else "running", "version": 1, "failure": ""},
        "_frame": FRAME_HEADER.pack(1, 20.0, 0, NOW) + json.dumps(packed).encode(),
    }


LOOKS = {
    "lines/empty": Look(make=_widget),
    "lines/step": Look(make=_widget, traits=_step()),
    "lines/failed": Look(make=_widget, traits=_step((3, "ZeroDivisionError: division by zero"))),
}

"""The states of a state machine whose looks are kept."""

from __future__ import annotations

import json
from typing import Any

from robowidgets import MachineWidget
from robowidgets.feeds import Feed
from robowidgets.widget.timed_frame import FRAME_HEADER

from ...looks import NOW, Look
from ..feeds.scripted import CMD_VEL, SCAN, Scripted


def _widget() -> MachineWidget:
    with Feed(Scripted(SCAN, CMD_VEL)) as robot:
        return MachineWidget(robot)


def _state(path: str, machines: tuple[dict[str, Any], ...] = ()) -> dict[str, Any]:
    return {"name": path.rpartition(".")[2], "path": path, "machines": machines}


def _move(source: str, target: str, event: str | None = None, after: str | None = None) -> dict[str, Any]:
    why = f"on {event}" if event else f"after {after}"
    return {
        "source": source, "target": target, "event": event, "after": after, "why": why, "compares": event == "near"
    }  # fmt: skip


_AVOID = {
    "path": "Walker.avoid",
    "states": [_state("Walker.avoid.stop"), _state("Walker.avoid.turn")],
    "moves": [_move("stop", "turn", after="0.5")],
}
_WALKER = {
    "path": "Walker",
    "states": [_state("Walker.forward"), _state("Walker.avoid", (_AVOID,))],
    "moves": [_move("forward", "avoid", "near"), _move("avoid", "forward", "free")],
}


def _runs(**states: tuple[str, float]) -> dict[str, Any]:
    """The traits of a machine that has these active states."""
    step = {
        "key": "Walker 1",
        "time": 3.0,
        "states": {path.replace("_", "."): state for path, state in states.items()},
        "judged": [("Walker", "near", False, "0.80 \u2265 0.50 m"), ("Walker", "free", None, "")],
        "seconds": [("Walker.avoid", "0.5", 0.5)],
    }
    fired = [
        {
            "at": NOW - 1, "time": 2.0, "machine": "Walker", "source": "avoid", "target": "forward", "why": "on free",
            "reading": "", "index": None,
        }
    ]  # fmt: skip
    return {
        "title": "Walker",
        "_source": {"robot": "robot", "status": "", "error": ""},
        "_outline": {"key": "Walker 1", "name": "Walker", "machines": [_WALKER]},
        "_about": {"mode": "running", "version": 1, "fired": fired, "states": [], "notes": [], "failed": ""},
        "_frame": FRAME_HEADER.pack(1, 20.0, 0, NOW) + json.dumps(step).encode(),
    }


LOOKS = {
    "machine/empty": Look(make=_widget),
    "machine/forward": Look(make=_widget, traits=_runs(Walker=("forward", 2.0))),
    "machine/turns": Look(make=_widget, traits=_runs(Walker=("avoid", 2.5), Walker_avoid=("stop", 2.75))),
}

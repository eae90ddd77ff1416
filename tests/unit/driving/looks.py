"""The states of Stop and of a drive pad whose looks are kept."""

from __future__ import annotations

from typing import Any

from robowidgets import DriveWidget
from robowidgets.driving.command_watchdog import CommandWatchdog
from robowidgets.stop_widget import StopWidget

from ...looks import Look


def _pad() -> DriveWidget:
    return DriveWidget(send=lambda *_: None, title="/cmd_vel", linear_limit=0.4)


def _bar() -> StopWidget:
    return StopWidget(CommandWatchdog(lambda *_: None))


def told(**changed: Any) -> dict[str, Any]:
    """The state of a driver."""
    at_rest = {
        "ready": True,
        "driver": "",
        "speed": (0, 0, 0),
        "stopped": False,
        "error": "",
        "cause": "",
        "status": "",
    }
    return {"_state": {**at_rest, "idle": "", "topic": "/cmd_vel", "sender": "", "number": 1, **changed}}


_DRIVEN = told(driver="program", speed=(0.2, 0.5, 0))
_STOPPED = told(stopped=True, cause="you")

LOOKS = {
    "stop/at_rest": Look(make=_bar, traits=told()),
    "stop/driven": Look(make=_bar, traits=_DRIVEN),
    "stop/stopped": Look(make=_bar, traits=_STOPPED),
    "stop/warned": Look(make=_bar, traits=told(status="/base/cmd_vel has no subscriber, unlike /cmd_vel")),
    "drive/at_rest": Look(make=_pad, traits=told()),
    "drive/driven": Look(make=_pad, traits=_DRIVEN),
    "drive/stopped": Look(make=_pad, traits=_STOPPED),
}

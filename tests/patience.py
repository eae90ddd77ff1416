"""Programs of robots on a machine that is busy with other tests."""

from __future__ import annotations

import inspect


def be_patient() -> None:
    """Accept late steps and standstills of this process, for which a program fails and speeds are refused."""
    from robowidgets.behaviors import program
    from robowidgets.driving import command_watchdog

    program.STEP, program.HELD = program.STEP._replace(late=3600.0), 3600.0
    command_watchdog.STANDSTILL = 3600.0


PATIENT = f"{inspect.getsource(be_patient)}\n\nbe_patient()\ndel be_patient\n"
"""The same as code for another process."""

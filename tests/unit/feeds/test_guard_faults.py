"""Faults of the driving process, against robots in other processes that log each command."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from ..waiting import wait_for

pytest.importorskip("playwright", reason="the benchmarks, whose robots these are, need Playwright")

from benchmarks.guard import FAULTS, OF_ONE, PAUSE, SIGNALS, Drivers, guards, heard, robot
from benchmarks.stopping import available

EVERY = "foxglove"
"""The middleware on which every fault is tried; the others get signals and pauses only."""
UNGUARDED = ("SIGINT", "SIGTERM", "SIGHUP")
"""The signals after which a kernel without a guard sends zero, too."""


def _faults(name: str) -> list[str]:
    return [*(FAULTS if name == EVERY else (*SIGNALS.keys() & FAULTS.keys(), PAUSE)), *OF_ONE.get(name, ())]


TRIED = [
    ((name, guarded), fault)
    for name in available()
    for guarded in (True, False)
    for fault in sorted(_faults(name))
    if guarded or fault.startswith(UNGUARDED)
]


@pytest.fixture(scope="module")
def there(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Drivers, Path]]:
    """Start a program that drives the robot of a middleware, with or without a guard; yield it and the robot's log."""
    (name, guarded), path = request.param, tmp_path_factory.mktemp("robot") / "heard.txt"
    path.touch()
    with robot(name, path) as where, closing(Drivers(name, where, path, guarded=guarded)) as drivers:
        yield drivers, path


@pytest.mark.slow
@pytest.mark.parametrize(
    ("there", "fault"),
    TRIED,
    indirect=["there"],
    ids=[f"{name}-{'guard' if guarded else 'kernel'}-{fault}" for (name, guarded), fault in TRIED],
)
def test_the_robot_gets_zero_and_nothing_moves_after_it(there: tuple[Drivers, Path], fault: str) -> None:
    drivers, path = there
    before = guards()
    with drivers.driving(fault) as (process, at):
        wait_for(lambda: heard(path, 0.0)[-1][1] == 0.0, "zero comes")
        zero = next((time for time, speed in heard(path, at) if speed == 0.0), at)
        if fault == PAUSE:
            wait_for(lambda: "stood still" in drivers.refused, "the next speed is refused")
        if not fault.startswith("GIL"):  # a cell or a step continues, and may drive again
            process.signal(signal.SIGKILL)
            wait_for(lambda: guards() <= before, "no guard is left behind")
            assert not [speed for time, speed in heard(path, zero) if speed]

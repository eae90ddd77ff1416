"""Faults of the process that drives, against robots in other processes that log each command."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from ..waiting import wait_for

pytest.importorskip("playwright", reason="the benchmarks, whose robots these are, need Playwright")

from benchmarks.guard import FAULTS, Drivers, guards, heard, robot
from benchmarks.stopping import available

EVERY = "foxglove"
"""The middleware on which every fault is tried; on the others, one that ends the process, and one that freezes it."""
TRIED = [(name, fault) for name in available() for fault in (FAULTS if name == EVERY else ("kill -9", "SIGSTOP"))]


@pytest.fixture(scope="module")
def there(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Drivers, Path]]:
    """What drives the robot of a middleware, and the log of the robot."""
    path = tmp_path_factory.mktemp("robot") / "heard.txt"
    path.touch()
    with robot(request.param, path) as where, closing(Drivers(request.param, where, path)) as drivers:
        yield drivers, path


@pytest.mark.slow
@pytest.mark.parametrize(("there", "fault"), TRIED, indirect=["there"])
def test_the_robot_gets_zero_and_nothing_moves_after_it(there: tuple[Drivers, Path], fault: str) -> None:
    drivers, path = there
    before = guards()
    with drivers.driving(fault) as (process, at):
        wait_for(lambda: heard(path, at) and heard(path, at)[-1][1] == 0.0, "zero comes")
        zero = next(time for time, speed in heard(path, at) if speed == 0.0)
        if not fault.startswith("GIL"):  # a cell or a step goes on, and may drive again
            process.signal(signal.SIGKILL)
            wait_for(lambda: guards() <= before, "no guard is left behind")
            assert not [speed for time, speed in heard(path, zero) if speed]

"""A sink gets every speed that holds, and zero when nobody renews it."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Callable

import pytest

from robowidgets import _dead_man
from robowidgets._dead_man import HOLD, ZERO, DeadMan

from .waiting import wait_for


class Robot:
    """A sink that remembers, and when."""

    def __init__(self) -> None:
        self.heard: list[tuple[float, float]] = []
        self.at: list[float] = []
        self.errors: list[tuple[str, tuple[float, float]]] = []
        self.told: list[tuple[float, float]] = []
        self.before: Callable[[], object] = lambda: None
        self.dead_man = DeadMan(self.drive, lambda: self.drive(0.0, 0.0), self.told.append, self.on_error)

    def drive(self, linear: float, angular: float) -> None:
        self.before()
        self.heard.append((linear, angular))
        self.at.append(time.monotonic())

    def on_error(self, error: BaseException, speed: tuple[float, float]) -> None:
        self.errors.append((str(error), speed))

    def heard_all(self, *speeds: tuple[float, float]) -> None:
        wait_for(lambda: len(self.heard) >= len(speeds), f"{speeds} were heard")
        assert self.heard == list(speeds)

    def rests(self) -> None:
        wait_for(lambda: self.dead_man._thread is None, "the thread ended")
        assert self.dead_man not in _dead_man._moving


@pytest.fixture
def robot() -> Robot:
    return Robot()


def test_a_speed_that_nobody_renews_is_followed_by_zero(robot: Robot) -> None:
    robot.dead_man.drive((0.3, 0.1))
    robot.heard_all((0.3, 0.1), ZERO)
    assert HOLD - 0.05 <= robot.at[1] - robot.at[0] < HOLD + 1
    robot.rests()
    assert robot.told == [(0.3, 0.1), ZERO]


def test_a_speed_that_is_renewed_goes_on(robot: Robot) -> None:
    start = time.monotonic()
    while time.monotonic() - start < 2 * HOLD:
        count = len(robot.heard)
        robot.dead_man.drive((0.3, 0.0))
        wait_for(lambda count=count: len(robot.heard) > count, "the speed was handed on")
        assert ZERO not in robot.heard
    robot.dead_man.stop()
    wait_for(lambda: robot.heard[-1] == ZERO, "it stopped")
    robot.rests()


def test_stop_is_zero_at_once_and_the_thread_ends(robot: Robot) -> None:
    robot.dead_man.drive((0.3, 0.0))
    robot.heard_all((0.3, 0.0))
    robot.dead_man.stop()
    robot.heard_all((0.3, 0.0), ZERO)
    assert robot.at[1] - robot.at[0] < HOLD / 2
    robot.rests()


def test_a_sink_that_comes_back_late_gets_zero_and_not_what_waited(robot: Robot) -> None:
    back = threading.Event()
    robot.before = back.wait
    robot.dead_man.drive((0.3, 0.0))
    wait_for(lambda: robot.dead_man.hangs_for, "it hangs")
    robot.before = lambda: None
    robot.dead_man.drive((0.4, 0.0))
    lapsed = time.monotonic() + HOLD
    wait_for(lambda: time.monotonic() > lapsed, "the second lapsed, too")
    back.set()
    robot.heard_all((0.3, 0.0), ZERO)
    robot.rests()
    assert robot.dead_man.hangs_for == 0


def test_what_a_sink_raises_is_told_and_it_is_asked_to_stop(robot: Robot) -> None:
    def fail() -> None:
        robot.before = lambda: None
        raise OSError("the wire is cut")

    robot.before = fail
    robot.dead_man.drive((0.3, 0.0))
    robot.heard_all(ZERO)
    robot.rests()
    assert robot.errors == [("the wire is cut", (0.3, 0.0))]
    robot.dead_man.drive((0.2, 0.0))
    robot.heard_all(ZERO, (0.2, 0.0), ZERO)


def test_a_sink_that_cannot_even_stop_says_both(robot: Robot) -> None:
    def fail() -> None:
        raise OSError("the wire is cut")

    robot.before = fail
    robot.dead_man.drive((0.3, 0.0))
    robot.rests()
    assert [speed for _, speed in robot.errors] == [(0.3, 0.0), ZERO]


@pytest.mark.parametrize("error", [OSError("the wire is cut"), SystemExit("enough")])
@pytest.mark.parametrize("where", ["sink", "told", "failed"])
def test_whatever_is_raised_wherever_it_ends_in_zero_and_the_next_speed_goes_out(
    robot: Robot, error: BaseException, where: str, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(*_: object) -> None:
        robot.before = lambda: None
        raise error

    if where == "told":
        robot.dead_man._told = fail
    else:
        robot.before = fail
    if where == "failed":
        robot.dead_man._failed = fail
    robot.dead_man.drive((0.3, 0.0))
    wait_for(lambda: robot.heard[-1:] == [ZERO], "zero was handed on")
    robot.rests()
    robot.heard.clear()
    robot.dead_man.drive((0.2, 0.0))
    robot.heard_all((0.2, 0.0), ZERO)
    robot.rests()
    assert bool(caplog.records) is (where != "sink")
    assert robot.errors == ([(str(error), (0.3, 0.0))] if where == "sink" else [])


def test_close_waits_until_zero_was_handed_on(robot: Robot) -> None:
    robot.dead_man.drive((0.3, 0.0))
    robot.heard_all((0.3, 0.0))
    robot.dead_man.close()
    assert robot.heard == [(0.3, 0.0), ZERO]
    robot.dead_man.close()
    assert robot.heard == [(0.3, 0.0), ZERO]


def test_a_process_that_ends_stops_the_robot() -> None:
    code = (
        "import time\n"
        "from robowidgets._dead_man import DeadMan\n"
        "heard = []\n"
        "def drive(linear, angular): heard.append(linear); print(linear, flush=True)\n"
        "dead_man = DeadMan(drive, lambda: drive(0.0, 0.0), lambda s: None, print)\n"
        "dead_man.drive((0.3, 0.0))\n"
        "while not heard: time.sleep(0.001)\n"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert ended.stdout.split() == ["0.3", "0.0"]
    assert ended.stderr == ""

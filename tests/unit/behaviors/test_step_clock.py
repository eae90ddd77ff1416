"""The time of a program counts only while it can make steps."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Iterator
from typing import Any

import pytest

from robowidgets.behaviors import Drive
from robowidgets.behaviors.step_clock import StepClock
from robowidgets.feeds import Advert, Feed

from ..feeds.scripted import CMD_VEL, Scripted
from ..waiting import wait_for


class Hand:
    """A clock that a test moves."""

    def __init__(self) -> None:
        self.time = 100.0

    def __call__(self) -> float:
        return self.time


@pytest.fixture
def hand() -> Hand:
    return Hand()


@pytest.fixture
def script() -> Scripted:
    return Scripted(Advert("/bumper", "kobuki_msgs/msg/BumperEvent"), CMD_VEL)


@pytest.fixture
def robot(script: Scripted, hand: Hand, monkeypatch: pytest.MonkeyPatch) -> Iterator[Feed]:
    """A robot whose programs use a clock that the test moves."""
    monkeypatch.setattr("robowidgets.behaviors.program.StepClock", lambda _now: StepClock(hand))
    with Feed(script) as feed:
        yield feed


def test_it_counts_from_look_to_look_but_not_before_it_starts_while_it_is_stopped_or_the_process_stands_still(
    hand: Hand,
) -> None:
    clock = StepClock(hand)
    hand.time += 0.3
    assert clock.start() == 0.0
    for _ in range(5):
        hand.time += 0.4
        clock.look()
    assert clock.look() == pytest.approx(2.0)
    hand.time += 10.0  # suspended
    assert clock.look() == pytest.approx(2.0)
    clock.stop()
    hand.time += 0.4
    assert clock.start() == pytest.approx(2.0)
    hand.time += 0.4
    clock.stop(0.1)
    assert clock.look() == pytest.approx(2.5)


def test_it_knows_when_something_was_before_and_after_an_interruption(hand: Hand) -> None:
    clock = StepClock(hand)
    clock.start()
    hand.time = 100.4
    clock.look()
    hand.time = 200.0
    clock.start()
    hand.time = 200.2
    assert clock.start() == pytest.approx(0.6)
    assert [clock.at(seconds) for seconds in (0.1, 0.3, 0.5, 0.6)] == pytest.approx([100.1, 100.3, 200.1, 200.2])


def pass_time(program: Any, hand: Hand, seconds: float) -> None:
    """Advance the time, and wait for the program's next steps."""
    hand.time += seconds
    steps = program.steps
    wait_for(lambda: program.steps > steps + 1, "it makes a step that began since")


def test_the_time_out_of_a_state_counts_no_time_in_which_no_step_was_possible(
    robot: Feed, script: Scripted, hand: Hand
) -> None:
    class Walker:
        def turn(touch):  # type: ignore[no-untyped-def]  # noqa: N805
            return Drive(0.0, 0.5)

        def go() -> Drive:  # type: ignore[misc]
            return Drive(0.2)

        moves = "turn -> go after 2.0"

    program = robot.program(Walker, rate=200)
    wait_for(lambda: program.waiting, "it waits for a touch")
    hand.time += 0.4
    script.listener.on_message("/bumper", {"bumper": 0, "state": 1})

    wait_for(lambda: program.steps, "it steps")
    for _ in range(4):
        pass_time(program, hand, 0.4)
    pass_time(program, hand, 10.0)  # the laptop sleeps
    program.pause()
    hand.time += 0.4
    program.run()
    pass_time(program, hand, 0.0)
    robot.stopped = True
    wait_for(lambda: program.waiting == "Stop is pressed", "it waits")
    hand.time += 0.4
    robot.stopped = False
    pass_time(program, hand, 0.0)
    assert program.version.function.active == ("turn",)
    assert program.clock.look() == pytest.approx(1.6)
    hand.time += 0.41
    wait_for(lambda: program.version.function.active == ("go",), "the time is over")


def test_a_step_by_hand_counts_the_time_between_two_steps(robot: Feed, hand: Hand) -> None:
    times: list[float] = []
    program = robot.program(lambda time: times.append(time), rate=4)
    wait_for(lambda: times, "it steps")
    program.pause()
    times.clear()
    for count in (1, 2, 3):
        hand.time += 0.3
        program.step()
        wait_for(lambda count=count: len(times) == count and not program._runner.is_at_work, "it steps")  # type: ignore[misc]
    assert times == pytest.approx([0.0, 0.25, 0.5])


def hold_the_gil(seconds: float) -> None:
    ctypes.PyDLL(None).usleep(int(1e6 * seconds))


@pytest.mark.slow
def test_a_step_that_held_the_gil_is_an_error_that_says_how_long_and_that_zero_came_late(
    user_limits: None, robot: Feed, script: Scripted, caplog: pytest.LogCaptureFixture
) -> None:
    def go(state):  # type: ignore[no-untyped-def]
        state.steps = state.get("steps", 0) + 1
        if state.steps == 3:
            hold_the_gil(1.5)
        return Drive(0.3)

    program = robot.program(go, rate=50)
    wait_for(lambda: program.mode == "failed", "it failed")
    words = " s, in which it, or another thread, held the GIL: nothing else could run, and zero came late"
    assert program.error.startswith("a step took ")
    assert program.error.endswith(words)
    wait_for(lambda: script.speeds[-1] == (0.0, 0.0), "the robot stands")
    wait_for(lambda: program.error in caplog.text, "the log says so, too")
    assert program.state.steps == 3


@pytest.mark.slow
def test_a_step_in_which_the_process_was_suspended_does_not_count(
    user_limits: None, robot: Feed, script: Scripted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(time, "process_time", lambda: 1.0)  # it did nothing
    held: list[int] = []

    def go(state):  # type: ignore[no-untyped-def]
        if not held:
            held.append(1)
            hold_the_gil(1.5)
        return Drive(0.3)

    program = robot.program(go, rate=50)
    wait_for(lambda: program.steps > 5, "it goes on")
    assert (program.mode, program.error) == ("running", "")

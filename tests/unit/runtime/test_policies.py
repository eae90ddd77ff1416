"""Late, left-behind, failed and replaced functions: the same texts for conditions, connected functions and programs."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from robowidgets import LaserWidget
from robowidgets.feeds import Feed, FeedError
from robowidgets.runtime.policies import ANSWER, CONDITION, FUNCTION, STEP

from ..feeds.scripted import CMD_VEL, SCAN, Scripted, scan
from ..waiting import threads_named, wait_for

REFUSED = "cannot drive: this function was disconnected, replaced or ended while it was at work"


class User:
    """A robot with a laser, on which one function of a user is called, in one of the three ways."""

    def __init__(self, kind: str) -> None:
        self.kind, self.script = kind, Scripted(SCAN, CMD_VEL)
        self.feed, self.laser = Feed(self.script), LaserWidget()
        self.gate, self.entered = threading.Event(), threading.Event()
        self.refused: list[str] = []

    def define(self, function: Callable[[Any], Any]) -> None:
        """Make the robot call a function; it replaces an earlier one with the same name."""

        def behave(sample: Any) -> Any:
            return function(sample)

        behave.__qualname__ = "behave"
        if self.kind == "condition":
            self.laser.watch(behave)
            self.laser.update(scan())
        elif self.kind == "function":
            self.feed.connect("/scan", behave)
            self.script.listener.on_message("/scan", scan())
        else:
            self.feed.program(lambda: behave(None), rate=100)

    def hang(self, _sample: Any) -> None:
        self.entered.set()
        try:
            self.gate.wait(120)
            self.feed.drive(0.4)
        except FeedError as error:
            self.refused.append(str(error))
        except SystemExit:  # it was left behind for so long that it was ended
            self.refused.append("ended")
            raise

    @property
    def words(self) -> str:
        """The text for the user."""
        if self.kind == "condition":
            return " ".join(lamp["text"] for lamp in self.laser.get_state()["_about"].get("lamps", ()))
        return repr(self.feed if self.kind == "function" else self.feed.programs.current)


@pytest.fixture(params=["condition", "function", "step"])
def user(user_limits: None, request: pytest.FixtureRequest) -> Iterator[User]:
    user = User(request.param)
    yield user
    user.gate.set()
    user.feed.close()
    user.laser.close()


def test_what_is_late_has_not_returned_and_is_reported_with_its_line(user: User) -> None:
    user.define(user.hang)
    wait_for(lambda: "has not returned for" in user.words, "it is late")
    assert re.search(r"line \d+", user.words)


def test_what_raises_is_reported_with_its_line_and_its_error(user: User) -> None:
    def fail(_sample: Any) -> None:
        raise SystemExit("out")

    user.define(fail)
    line = fail.__code__.co_firstlineno + 1
    wait_for(lambda: f"line {line}: SystemExit: out" in user.words, "it is reported")


def test_what_is_replaced_is_left_drives_no_more_and_what_takes_its_place_is_called(user: User) -> None:
    user.define(user.hang)
    assert user.entered.wait(120)
    called = threading.Event()
    user.define(lambda _sample: called.set())
    assert called.wait(120)
    user.gate.set()
    wait_for(lambda: user.refused, "it has left")
    assert user.refused in ([REFUSED], ["ended"])
    assert (0.4, 0.0) not in user.script.speeds


def test_what_hangs_in_python_is_ended_when_it_is_replaced_unless_it_is_a_function(user: User) -> None:
    ended = threading.Event()

    def loop(_sample: Any) -> None:
        user.entered.set()
        try:
            while not user.gate.is_set():
                time.sleep(0.001)
        finally:
            ended.set()

    user.define(loop)
    assert user.entered.wait(120)
    user.define(lambda _sample: None)
    if user.kind == "function":
        user.gate.set()
    assert ended.wait(120)


def test_the_policies_differ_in_figures_alone() -> None:
    assert (CONDITION.late, FUNCTION.late, STEP.late) == (0.1, 1.0, 0.45)
    assert ANSWER == STEP, "an answer has the time of its sample on a robot"


def loop(_scan: Any) -> bool:
    while True:
        time.sleep(0.001)


@pytest.mark.parametrize("condition", [lambda _scan: True, loop])
def test_no_thread_of_a_judge_stays_after_its_feed_is_closed(condition: Callable[[Any], bool]) -> None:
    script, judged = Scripted(SCAN), threading.Event()
    before = threads_named("robowidgets-judge")
    with Feed(script) as feed:
        laser = LaserWidget()
        feed.connect("/scan", laser)
        wall = laser.watch(lambda scan: judged.set() or condition(scan), name="wall")
        near = laser.watch(lambda scan: scan.distance() < 1.5, name="near")
        script.listener.on_message("/scan", scan(1.0))
        assert judged.wait(120)
        if condition is not loop:  # else closing would end a call that a busy machine holds up
            wait_for(lambda: wall.verdict.value, "it has returned")
    wait_for(lambda: threads_named("robowidgets-judge") == before, "it has ended")
    assert near.verdict.value is True, "the other one is still judged"
    words = r"has not returned for \d+\.\d s, line \d+, and was ended with its feed" if condition is loop else ""
    assert re.fullmatch(words, wall.error)
    laser.close()

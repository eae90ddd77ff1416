"""`LinesWidget`: the page gets each step, versions and machines, and a program without it notes nothing."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from typing import Any

import pytest

import robowidgets
from robowidgets import LinesWidget, ProgramWidget
from robowidgets.behaviors import Drive
from robowidgets.feeds import Feed
from robowidgets.widget.timed_frame import FRAME_HEADER

from ..feeds.scripted import Scripted, scan
from ..pages import Page
from ..waiting import wait_for


@pytest.fixture
def page(robot: Feed) -> Iterator[Page]:
    widget = LinesWidget(robot)
    yield Page(widget)
    widget.close()


def frame(page: Page) -> dict[str, Any]:
    """The last frame that the page got."""
    sent = page.state["_frame"]
    got: dict[str, Any] = json.loads(sent[FRAME_HEADER.size :]) if sent else {}
    return got


def lines(page: Page, function: int = 0) -> dict[str, str]:
    """The value of each line of the newest step, by the text of the line."""
    got = frame(page)
    if not got or not got["steps"][-1]["calls"]:
        return {}
    call = got["steps"][-1]["calls"][function]
    (texts,) = (one["texts"] for one in page.state["_code"]["functions"] if one["key"] == call["key"])
    return {texts[line[0]].strip(): line[1] for line in call["lines"]}


def test_each_line_of_the_newest_step_has_its_value(page: Page, robot: Feed) -> None:
    @robot.program(rate=50)
    def square(time, state):  # type: ignore[no-untyped-def]
        side = state.setdefault("side", 3)
        if side > 5:
            return Drive(1.0)
        return Drive(0, 0.5)

    wait_for(lambda: "return Drive(0, 0.5)" in lines(page), "a step is there")
    found = lines(page)
    assert found['side = state.setdefault("side", 3)'] == "3"
    assert found["if side > 5:"] == "False"
    assert found["return Drive(0, 0.5)"] == "Drive(0, 0.5)"
    assert "return Drive(1.0)" not in found
    assert page.state["title"] == "square"
    assert page.state["_about"]["mode"] == "running"


def test_another_version_has_its_own_lines_and_counts(page: Page, robot: Feed) -> None:
    for number in (1, 2):

        @robot.program(rate=50)
        def turn(number=number):  # type: ignore[no-untyped-def]
            return Drive(0, 0.1 * number)

        wait_for(lambda number=number: frame(page).get("key") == f"turn {number}", "the version is there")
        wait_for(lambda number=number: page.state["_code"]["key"] == f"turn {number}", "so is its source")
        got = frame(page)
        (rows,) = got["totals"].values()
        assert [row[1] for row in rows] == [got["total"]]


def test_a_failed_step_names_its_line(page: Page, robot: Feed) -> None:
    @robot.program(rate=50)
    def fails(time):  # type: ignore[no-untyped-def]
        nothing = 0
        return Drive(1 / nothing)

    wait_for(lambda: page.state["_about"].get("mode") == "failed", "it fails")
    wait_for(lambda: bool(frame(page)), "its step is there")
    error = frame(page)["steps"][-1]["calls"][0]["error"]
    assert error[1] == "ZeroDivisionError: division by zero"
    assert lines(page)["nothing = 0"] == "0"


def test_a_machine_shows_the_functions_that_a_step_called(page: Page, robot: Feed, script: Scripted) -> None:
    class Walker:
        near = lambda scan: scan.distance() < 100  # noqa: E731

        def forward():  # type: ignore[no-untyped-def]
            return Drive(0.1)

        def turn():  # type: ignore[no-untyped-def]
            speed = 0.3
            return Drive(0, speed)

        moves = "forward -> turn on near"

    script.listener.on_message("/scan", scan(0.9, 0.8))
    robot.program(Walker, rate=50)

    def turns() -> bool:
        script.listener.on_message("/scan", scan(0.9, 0.8))  # again: a busy machine may step when one is too old
        return "speed = 0.3" in lines(page, -1)

    wait_for(turns, "it turns")
    assert lines(page, -1)["return Drive(0, speed)"] == "Drive(0, 0.3)"
    assert {function["name"] for function in page.state["_code"]["functions"]} >= {"<lambda>", "turn"}


def test_without_a_widget_nothing_is_noted_and_with_two_both_get_each_step(robot: Feed) -> None:
    stepped = threading.Event()

    @robot.program(rate=50)
    def turn():  # type: ignore[no-untyped-def]
        stepped.set()
        return Drive(0, 0.1)

    assert turn.lines is None
    one, other = LinesWidget(robot), LinesWidget(robot)
    wait_for(lambda: one.step is not None and other.step is not None, "steps come")
    one.close()
    assert turn.lines is not None
    other.close()
    assert turn.lines is None
    assert robot.programs.lines is None
    stepped.clear()
    wait_for(stepped.is_set, "it goes on")


def test_something_else_than_a_feed_is_refused() -> None:
    with pytest.raises(TypeError, match=r"LinesWidget\(\): expected a feed, such as .*, got 3"):
        LinesWidget(3)
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        for widget in (LinesWidget, ProgramWidget):
            with pytest.raises(TypeError, match=rf"{widget.__name__}\(\): expected a feed, .*, got [^\n]* messages$"):
                widget(recording)

"""`ProgramWidget`: the messages to the page about a program, and the requests of the page."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from robowidgets import ProgramWidget
from robowidgets.behaviors import Drive
from robowidgets.driving import driving_widget
from robowidgets.feeds import Driving, Feed

from ..pages import Page, from_page
from ..waiting import wait_for


@pytest.fixture
def widget(robot: Feed) -> Iterator[ProgramWidget]:
    made = ProgramWidget(robot)
    yield made
    made.close()


def hear(widget: ProgramWidget, **content: Any) -> None:
    """Send a message of the page, with a new token unless it has one."""
    from_page(widget, {"press": "view", "token": widget._tokens.issue(), **content})


def test_its_state_is_sent_repeatedly_while_no_program_drives(
    widget: ProgramWidget, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(driving_widget, "BEAT", 0.01)
    page = Page(widget)
    wait_for(lambda: len({state["number"] for state in page.sent("_state")}) > 3, "it comes again and again")
    assert page.state["_state"]["driver"] == ""


def test_it_tells_what_the_program_does_and_follows_the_next_one(robot: Feed, widget: ProgramWidget) -> None:
    page = Page(widget)
    assert page.state["_state"]["program"] is None

    @robot.program(rate=50)
    def go():  # type: ignore[no-untyped-def]
        sys.stdout.write("on its way\n")
        return Drive(0.2, 0.1)

    wait_for(lambda: (page.state["_state"]["program"] or {}).get("speed") == (0.2, 0.1, 0.0), "its speed is reported")
    told = page.state["_state"]["program"]
    assert (told["name"], told["version"], told["mode"], told["limits"]) == ("go", 1, "running", (0.5, 1.0, 0.0))
    wait_for(lambda: page.state["_state"]["program"]["prints"][-1][1] == "on its way", "its prints are reported")
    assert not told["kept"]

    @robot.program(rate=50)
    def forget():  # type: ignore[no-untyped-def]
        Drive(0.3)

    wait_for(lambda: page.state["_state"]["program"]["kept"], "a step without a return is reported")
    assert page.state["_state"]["program"]["speed"] == (0.0, 0.0, 0.0)

    @robot.program(rate=50)
    def fail():  # type: ignore[no-untyped-def]
        raise RuntimeError("no")

    wait_for(
        lambda: "RuntimeError: no" in page.state["_state"]["program"]["error"], "the error of the next is reported"
    )
    assert page.state["_state"]["program"]["name"] == "fail"
    assert not go.has_view


def test_prints_go_to_the_cell_if_no_widget_shows_them(robot: Feed, capsys: pytest.CaptureFixture[str]) -> None:
    widget = ProgramWidget(robot)
    robot.variables.word = "first"

    @robot.program(rate=50)
    def talk(variables):  # type: ignore[no-untyped-def]
        sys.stdout.write(f"{variables.word}\n")

    wait_for(lambda: talk.prints.lines, "it prints")
    robot.variables.word = "between"
    steps = talk.steps
    wait_for(lambda: talk.steps > steps + 2, "it goes on")
    widget.close()
    robot.variables.word = "last"
    wait_for(lambda: talk.prints.lines[-1][1] == "last", "it prints again")
    talk.pause()
    printed = capsys.readouterr().out
    assert "last" in printed
    assert "first" not in printed


def test_the_page_pauses_steps_runs_and_sets_variables(robot: Feed, widget: ProgramWidget) -> None:
    robot.variables.slider("near", 0.6, 0.2, 2.0)

    @robot.program(rate=50)
    def go():  # type: ignore[no-untyped-def]
        return Drive(0.2)

    hear(widget, program="set", name="near", value=9)
    assert robot.variables.near == 2.0
    hear(widget, program="pause", token=None)
    assert go.mode == "paused"
    steps = go.steps
    hear(widget, program="step")
    wait_for(lambda: go.steps == steps + 1, "one step is made")
    hear(widget, act="stop")
    assert robot.stopped
    hear(widget, act="allow")
    wait_for(lambda: not go._runner.is_at_work, "the single step is over")
    hear(widget, program="run")
    wait_for(lambda: go.mode == "running" and go.steps > steps + 2, "it runs")


@pytest.mark.parametrize("token", [0, None, "1", 10**9])
def test_what_a_busy_kernel_delayed_starts_and_sets_nothing(robot: Feed, widget: ProgramWidget, token: Any) -> None:
    robot.variables.go = False

    @robot.program(rate=50)
    def go():  # type: ignore[no-untyped-def]
        return Drive(0.2)

    go.pause()
    steps = go.steps
    for content in ({"program": "run"}, {"program": "step"}, {"program": "set", "name": "go", "value": True}):
        hear(widget, token=token, **content)
    assert (go.mode, go.steps, robot.variables.go) == ("paused", steps, False)


@pytest.mark.parametrize(
    "content",
    [
        {"program": "set", "name": "none", "value": 1},
        {"program": "set", "name": "near", "value": "1"},
        {"program": "set", "name": ["near"], "value": 1},
        {"program": "set", "name": "near", "value": None},
        {"program": "fly"},
        {"program": {}},
    ],
)
def test_what_makes_no_sense_changes_nothing(robot: Feed, widget: ProgramWidget, content: dict[str, Any]) -> None:
    robot.variables.near = 0.6
    hear(widget, **content)
    assert robot.variables.near == 0.6


def test_it_takes_a_feed_alone() -> None:
    with pytest.raises(TypeError, match=r"ProgramWidget\(\): expected a feed, such as feeds\.simulator\(\), got 3"):
        ProgramWidget(3)


def test_a_program_that_drives_sideways_shows_it_and_one_of_a_robot_that_cannot_says_why(
    robot: Feed, widget: ProgramWidget
) -> None:
    page = Page(widget)

    @robot.program(rate=50)
    def slide():  # type: ignore[no-untyped-def]
        return Drive(lateral=-0.07)

    refused = "cannot drive: lateral is -0.07 m/s, but this robot is not known to move sideways"
    wait_for(lambda: refused in (page.state["_state"]["program"] or {}).get("waiting", ""), "it says why it stands")
    robot.driving = Driving(max_lateral=0.05)
    wait_for(lambda: page.state["_state"]["program"]["limits"] == (0.5, 1.0, 0.05), "the new limit is reported")
    wait_for(lambda: page.state["_state"]["speed"] == (0.0, 0.0, -0.05), "it drives to the right")
    assert page.state["_state"]["program"]["speed"] == (0.0, 0.0, -0.07)
    assert robot.drive_status == "-0.07 m/s sideways is cut to -0.05"


def test_the_variables_of_a_program_are_shown_as_short_plain_texts(robot: Feed, widget: ProgramWidget) -> None:
    page = Page(widget)

    class Own:
        def __repr__(self) -> str:
            raise AssertionError("it may take any time")

    @robot.program(rate=50)
    def keep(state):  # type: ignore[no-untyped-def]
        state.update(n=3, way=0.1 + 0.2, side="left", own=Own(), many=[*range(100)])
        state.scan, state.mean = np.zeros((2, 3)), np.float32(0.25)

    # A report may come in the middle of the first step.
    wait_for(lambda: "mean" in dict(page.state["_state"]["kept"]), "all are reported")
    assert dict(page.state["_state"]["kept"]) == {
        "n": "3",
        "way": "0.3",
        "side": "'left'",
        "own": "<Own>",
        "many": "[0, 1, 2, 3, 4, 5, ...]",
        "scan": "<array of 2 x 3>",
        "mean": "0.25",
    }
    keep.pause()
    hear(widget, program="restart")
    wait_for(lambda: keep.mode == "running", "it runs from the beginning")
    keep.close()
    hear(widget, program="restart")
    assert keep.mode == "ended"
    wait_for(lambda: page.state["_state"]["kept"] == [], "a program that is closed keeps nothing")

"""A number that the page changes is tried, drives when it is let go, and is taken back. New versions are compared."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from robowidgets import EventsWidget, LinesWidget
from robowidgets.behaviors import Drive
from robowidgets.behaviors.program import FAILED, PAUSED, RUNNING, Program
from robowidgets.feeds import Feed
from robowidgets.lines import number as number_module

from ..pages import Page, from_page
from ..waiting import wait_for


class Dragging:
    """A page on which a number of a program is dragged."""

    def __init__(self, robot: Feed) -> None:
        self.robot, self.widget = robot, LinesWidget(robot)
        self.page = Page(self.widget)
        self.press = 0

    @property
    def number(self) -> dict[str, Any]:
        found: dict[str, Any] = self.page.state["_number"]
        return found

    @property
    def compared(self) -> dict[str, Any]:
        found: dict[str, Any] = self.page.state["_compared"]
        return found

    @property
    def code(self) -> dict[str, Any]:
        found: dict[str, Any] = self.page.state["_code"]
        return found

    def start(self, function: Callable[..., Any], steps: int = 10) -> Program:
        program: Program = self.robot.program(function, rate=50)
        wait_for(lambda: program.steps >= steps, "some steps are made")
        wait_for(lambda: self.code.get("key") == f"{program.name} {program.version.number}", "the page has its source")
        return program

    def send(self, act: str, number: str = "0.2", text: str = "", **more: Any) -> None:
        """Send a message as the page does, about a number of the first function that has it."""
        place: dict[str, Any] = {}
        for function in self.code["functions"]:
            for line, column, known, _ in function["numbers"]:
                if known == number and not place:
                    place = {"function": function["key"], "line": line, "column": column}
        message = {"number": act, "press": f"p{self.press}", "key": self.code["key"], "text": text, **place}
        from_page(self.widget, {**message, "token": self.number.get("token", 0), **more})

    def try_(self, text: str, number: str = "0.2") -> dict[str, Any]:
        self.press += 1
        self.send("try", number, text)
        wait_for(
            lambda: self.number.get("press") == f"p{self.press}" and self.number["state"] != "trying", "it is tried"
        )
        return self.number

    def until(self, state: str) -> dict[str, Any]:
        wait_for(lambda: self.number["state"] == state, f"it is {state}, not {self.number}")
        return self.number


@pytest.fixture
def drag(robot: Feed) -> Iterator[Dragging]:
    made = Dragging(robot)
    yield made
    made.widget.close()


def go(time, state):  # type: ignore[no-untyped-def]
    state.count = state.get("count", 0) + 1
    if state.count % 2 > 0.5:
        return Drive(0.2)
    return Drive(0.1, 0.0)


def test_a_number_is_tried_without_driving_and_drives_when_it_is_let_go(drag: Dragging) -> None:
    program = drag.start(go)
    before = program.version
    tried = drag.try_("0.45")
    assert (tried["state"], tried.get("failed"), program.version) == ("tried", 0, before), str(tried)
    assert tried["steps"] >= 10
    assert tried["otherwise"] in (tried["steps"] // 2, tried["steps"] - tried["steps"] // 2)
    (forward,) = tried["axes"]
    assert {*forward["old"]} == {0.2, 0.1}
    assert {*forward["new"]} == {0.45, 0.1}
    drag.send("put", text="0.45")
    put = drag.until("driving")
    assert (put["version"], put["back"]) == (2, "0.2")
    assert program.version.number == 2
    wait_for(lambda: program.returned.linear == 0.45, "it drives")
    assert "Drive(0.45)" in inspect.getsource(program.version.function)
    assert "Drive(0.45)" in program.version.text
    assert "Drive(0.2)" in program.version.written
    line = inspect.getsourcelines(go)[1] + 3
    assert program.version.change == f"line {line}, 0.45 instead of 0.2"
    assert (program.version.cell, program.mode) == (before.cell, RUNNING)
    wait_for(lambda: drag.code["key"] == "go 2", "the page has the new source")
    (function,) = drag.code["functions"]
    assert [line.strip() for line in function["changed"] if "0.45" in line] == ["return Drive(0.45)"]
    assert [line.strip() for line in function["cell"] if "0.2" in line] == ["return Drive(0.2)"]
    drag.send("undo")
    assert drag.until("back")["text"] == "0.2"
    assert (program.version.number, program.version.function, program.version.written) == (3, go, "")
    assert program.version.change == "0.2 is back"
    drag.send("undo")
    drag.send("undo", press="another")
    assert program.version.number == 3


def test_escape_before_it_is_let_go_changes_nothing(drag: Dragging) -> None:
    program = drag.start(go)
    drag.try_("0.45")
    drag.send("end")
    steps = program.steps
    wait_for(lambda: program.steps > steps + 3, "it goes on")
    assert program.version.number == 1


def fails(time):  # type: ignore[no-untyped-def]
    return Drive(0.1 / 0.2)


def test_a_number_with_which_the_program_would_fail_is_refused_and_the_old_one_drives_on(drag: Dragging) -> None:
    program = drag.start(fails)
    tried = drag.try_("0.0")
    assert tried["failed"] == tried["steps"]
    assert "ZeroDivisionError" in tried["error"]
    drag.send("put", text="0.0")
    refused = drag.until("refused")
    assert refused["why"].startswith("the program would fail with it: ZeroDivisionError")
    assert (program.version.number, program.mode) == (1, RUNNING)


def hangs(state):  # type: ignore[no-untyped-def]
    while 0.2 > 0.5:
        time.sleep(0.01)
    return Drive(0.1)


def test_a_number_with_which_a_step_hangs_is_refused_and_the_old_one_drives_on(drag: Dragging) -> None:
    program = drag.start(hangs)
    refused = drag.try_("0.9")
    assert refused["state"] == "refused"
    assert "a step has not returned for 1.5 s" in refused["why"]
    drag.send("put", text="0.9")
    steps = program.steps
    wait_for(lambda: program.steps > steps + 3, "it goes on")
    assert (program.version.number, program.mode) == (1, RUNNING)
    assert drag.try_("0.3")["state"] == "tried"


def test_a_message_that_came_late_or_of_another_version_changes_nothing(drag: Dragging) -> None:
    program = drag.start(go)
    drag.try_("0.45")
    drag.send("put", text="0.45", token=12345)
    assert "too late" in drag.until("refused")["why"]
    key = drag.code["key"]
    program = drag.start(fails)
    drag.press += 1
    drag.send("try", text="0.45", key=key)
    wait_for(lambda: drag.number["why"] == "another version is in force now", "it is refused")
    assert program.version.number == 1


@pytest.mark.parametrize("mode", [PAUSED, FAILED])
def test_a_program_that_does_not_run_does_not_begin_to_drive(drag: Dragging, mode: str) -> None:
    program = drag.start(go)
    program._end(mode, error="line 1: an error" if mode == FAILED else "")
    drag.try_("0.45")
    drag.send("put", text="0.45")
    drag.until("driving")
    assert (program.mode, program.note, program.error) == (PAUSED, "version 2 drives after Run", "")
    program.run()
    wait_for(lambda: program.returned.linear == 0.45, "it drives after Run")


def test_messages_that_no_page_sends_are_refused(drag: Dragging) -> None:
    drag.start(go)
    logged: list[str] = []
    drag.widget._log_once = logged.append  # type: ignore[method-assign]
    for wrong in (
        {"number": "run"},
        {"number": "try"},
        {"number": "try", "press": "a", "text": 3},
        {"number": "try", "press": "a" * 65, "text": "1"},
        {"number": "try", "press": "a", "text": "1", "line": "<b>"},
    ):
        from_page(drag.widget, wrong)
    assert len(logged) == 5
    assert drag.try_("__import__('os')")["why"].startswith("expected a number such as 0.6, got")


class Wall:
    moves = "go -> turn on near", "turn -> go after 0.05"

    def near(time):  # type: ignore[no-untyped-def]  # noqa: N805
        return time > 0.01

    def go():  # type: ignore[no-untyped-def]
        return Drive(0.2)

    def turn():  # type: ignore[no-untyped-def]
        return Drive(0.0, 0.5)


def test_a_number_of_a_state_machine_changes_while_it_stays_in_its_state(drag: Dragging) -> None:
    program = drag.start(Wall)  # type: ignore[arg-type]
    wait_for(lambda: len(drag.code["functions"]) == 3, "all functions were called")
    drag.try_("0.75", "0.5")
    drag.send("put", "0.5", "0.75")
    drag.until("driving")
    wait_for(lambda: program.returned.angular == 0.75, "it drives")
    assert vars(Wall)["turn"]().angular == 0.5
    assert len(program.version.function.fired) > 0  # type: ignore[attr-defined]


def test_a_new_version_is_compared_with_the_one_before_on_the_last_minute(drag: Dragging) -> None:
    drag.start(go)
    assert drag.compared == {}

    def careful(time, state):  # type: ignore[no-untyped-def]
        state.count = state.get("count", 0) + 1
        if state.count % 4 > 0.5:
            return Drive(0.2)
        return Drive(0.1, 0.0)

    careful.__name__ = "go"
    drag.start(careful)
    wait_for(lambda: drag.compared.get("key") == "go 2" and "steps" in drag.compared, "they are compared")
    found = drag.compared
    assert found["why"] == ""
    assert found["steps"] >= 10
    assert abs(found["otherwise"] - found["steps"] / 4) <= 1
    start, end, line, old_value, new_value, old, new = found["rows"][0]
    assert (start, old, new) == (end, "Drive(0.1)", "Drive(0.2)")
    assert old_value.startswith("False"), str(found)
    assert new_value.startswith("True")
    assert line == inspect.getsourcelines(careful)[1] + 2


def test_a_version_that_changes_something_outside_is_not_called_to_compare_it(drag: Dragging) -> None:
    called: list[float] = []

    def outside(time):  # type: ignore[no-untyped-def]
        called.append(time)
        return Drive(0.2)

    outside.__name__ = "go"
    drag.start(go)
    program = drag.start(outside)
    wait_for(lambda: drag.compared.get("key") == "go 2", "the reason is there")
    assert drag.compared["why"] == (
        "in version 2, go may not be tried, because it uses called.append, which may change something outside of it"
    )
    program.pause()
    assert len(called) <= program.steps


def test_a_number_that_is_let_go_but_whose_trial_takes_too_long_does_not_drive(
    drag: Dragging, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = drag.start(go)
    drag.try_("0.45")
    monkeypatch.setattr(number_module, "FRESH_S", -1.0)
    drag.send("put", text="0.45")
    assert drag.until("refused")["why"] == "trying it took too long, so the number is as it was"
    assert program.version.number == 1


def test_a_number_drives_while_stop_is_latched_only_after_its_release(drag: Dragging) -> None:
    program = drag.start(go)
    drag.robot.stopped = True
    wait_for(lambda: program.waiting == "Stop is pressed", "it is stopped")
    steps = program.steps
    drag.try_("0.45")
    drag.send("put", text="0.45")
    assert drag.until("driving")["note"] == "Stop is pressed"
    wait_for(lambda: drag.code["key"] == "go 2", "the page has the source of a version that made no step")
    drag.try_("0.4", "0.45")
    drag.send("put", "0.45", "0.4")
    wait_for(lambda: program.version.number == 3, "it is changed once more")
    assert (program.steps, program.returned.linear, drag.robot.stopped) == (steps, 0.0, True)
    drag.robot.stopped = False
    wait_for(lambda: program.returned.linear == 0.4, "it drives")


def test_a_change_is_in_the_list_of_events(drag: Dragging) -> None:
    program = drag.start(go)
    events = EventsWidget()
    events.follow(drag.robot)
    drag.try_("0.45")
    drag.send("put", text="0.45")
    drag.until("driving")
    texts = [row.text for row in events.rows]
    assert f"version 2: {program.version.change}" in texts
    events.close()


def test_inputs_are_kept_only_for_a_widget_that_shows_the_lines(drag: Dragging) -> None:
    drag.start(go)
    programs = drag.robot.programs
    assert programs.kept is not None
    drag.widget.folded = True
    assert programs.kept is None
    drag.widget.folded = False
    assert programs.kept is not None
    drag.widget.close()
    assert programs.kept is None

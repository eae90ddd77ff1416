"""`MachineWidget`: the messages to the page about a state machine, their rate, and the cost of a step."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from typing import Any

import pytest

from robowidgets import LaserWidget, MachineWidget, PathWidget, TouchWidget, conditions
from robowidgets.behaviors import Drive
from robowidgets.feeds import Feed
from robowidgets.widget import heartbeat
from robowidgets.widget.pacer import INTERVAL
from robowidgets.widget.timed_frame import FRAME_HEADER

from ..feeds.scripted import SCAN, Scripted, scan
from ..pages import Page, from_page, get_newest, synced
from ..waiting import wait_for

# ruff: noqa: N801, N805


@pytest.fixture
def page(robot: Feed) -> Iterator[Page]:
    widget = MachineWidget(robot)
    yield Page(widget)
    widget.close()


def step(page: Page) -> dict[str, Any]:
    """The last step that was sent to the page."""
    frame = page.state["_frame"]
    told: dict[str, Any] = json.loads(frame[FRAME_HEADER.size :]) if frame else {}
    return told


def test_while_nothing_steps_a_beat_tells_that_python_lives_and_other_widgets_send_none(
    page: Page, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(heartbeat, "BEAT", 0.01)
    laser = LaserWidget()
    other = Page(laser)
    wait_for(lambda: len(page.sent("_beat")) > 3, "beats come without a machine")
    laser.title = "/scan"
    wait_for(lambda: other.sent("title") == ["/scan"], "its title is sent")
    assert other.sent("_beat") == []
    laser.close()


def test_what_comes_when_it_comes_beats_and_in_a_player_nothing_does(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(heartbeat, "BEAT", 0.01)
    for widget in (TouchWidget(), PathWidget()):
        page = Page(widget)
        widget.title = "/events"
        wait_for(lambda page=page: len(page.sent("_beat")) > 3, "beats come")
        widget.follow_player()
        assert synced(widget, "_beat") == 0
        del page.messages[:]
        widget.title = "/recorded"
        wait_for(lambda page=page: page.sent("title") == ["/recorded"], "its title is sent")
        assert [beat for beat in page.sent("_beat") if beat] == []
        widget.close()


class Walker:
    near = conditions.nearest_below(0.5)

    def free(scan):
        return scan.distance() > 0.6

    def forward():
        return Drive(0.2)

    class avoid:
        stop = turn = None
        moves = "stop -> turn after pause"

    moves = "forward -> avoid on near", "avoid -> forward on free"


def test_it_tells_states_events_times_and_what_fired(script: Scripted, robot: Feed, page: Page) -> None:
    assert page.state["_source"]["status"] == "waiting for a state machine"
    robot.variables.pause = 0.2
    script.listener.on_message("/scan", scan(0.9, 0.8))
    program = robot.program(Walker, on="/scan")

    def is_told() -> Any:
        script.listener.on_message("/scan", scan(0.9, 0.8))  # again: a busy machine may step when one is too old
        return step(page).get("judged")

    wait_for(is_told, "it is reported")
    assert step(page)["states"] == {"Walker": ["forward", 0.0]}
    assert step(page)["judged"] == [["Walker", "near", False, "0.80 \u2265 0.50 m"]]
    outline = page.state["_outline"]
    assert (page.state["title"], outline["key"], step(page)["key"]) == ("Walker", "Walker 1", "Walker 1")
    forward, avoid = outline["machines"][0]["states"]
    assert (forward["machines"], avoid["machines"][0]["path"]) == ([], "Walker.avoid")
    assert [(move["event"], move["compares"]) for move in outline["machines"][0]["moves"]] == [
        ("near", True),
        ("free", True),
    ]

    began = time.monotonic()
    script.listener.on_message("/scan", scan(0.9, 0.4))
    wait_for(lambda: step(page)["states"]["Walker"][0] == "avoid", "it avoids")
    (fired,) = page.state["_about"]["fired"]
    assert (fired["source"], fired["target"], fired["why"]) == ("forward", "avoid", "on near")
    assert (fired["reading"], fired["index"]) == ("0.40 < 0.50 m", 1)
    assert began <= fired["at"] <= FRAME_HEADER.unpack_from(page.state["_frame"])[3]
    script.listener.on_message("/scan", scan(0.9, 0.45))
    judged = [["Walker", "free", False, "0.45 \u2264 0.60 m"]]
    wait_for(lambda: step(page)["judged"] == judged, "another event is judged")
    assert step(page)["seconds"] == [["Walker.avoid", "pause", 0.2]]
    assert {*page.threads} == {"robowidgets-pacer"}
    outer, inner = page.state["_about"]["states"]
    assert [(end is None, path) for _, end, path in outer] == [(False, "Walker.forward"), (True, "Walker.avoid")]
    assert outer[0][1] == outer[1][0] == inner[0][0] == fired["at"]
    program.pause()
    wait_for(lambda: page.state["_about"]["mode"] == "paused", "the pause is reported")


def test_a_new_version_is_reported_once_and_a_function_in_its_place_is_named(robot: Feed, page: Page) -> None:
    class Blink:
        on = off = None
        moves = "on -> off after 0.01", "off -> on after 0.01"

    robot.program(Blink, rate=200)
    wait_for(lambda: step(page).get("time", 0) > 0.1, "it runs")
    assert len(page.sent("_outline")) == 1
    Blink.off = None
    robot.program(Blink, rate=200)
    wait_for(lambda: step(page)["key"] == "Blink 2", "the second version is reported")
    assert len(page.sent("_outline")) == 2

    @robot.program
    def stay():  # type: ignore[no-untyped-def]
        return Drive()

    wait_for(lambda: "which is not a state machine" in page.state["_source"]["status"], "the function is named")
    wait_for(lambda: page.state["_about"]["mode"] == "ended", "the machine is over")


def test_an_error_is_reported_and_the_last_good_step_stays(robot: Feed, page: Page) -> None:
    class Fails:
        def first(variables):
            return Drive(0.1 / variables.x)

        rest = None
        moves = "first -> rest after 99"

    robot.variables.x = 1
    robot.program(Fails, rate=100)
    wait_for(lambda: step(page).get("states"), "it runs")
    robot.variables.x = 0
    wait_for(lambda: "ZeroDivisionError" in page.state["_source"]["error"], "the error is reported")
    assert step(page)["states"]["Fails"][0] == "first"
    assert page.state["_about"]["mode"] == "failed"


def test_steps_are_reported_twenty_times_a_second_and_the_newest_wins(robot: Feed, page: Page) -> None:
    class Count:
        def one(state):
            state.n = state.get("n", 0) + 1

        two = None
        moves = "one -> two after 1.0"

    began = time.monotonic()
    program = robot.program(Count, rate=200)
    wait_for(lambda: step(page).get("states", {}).get("Count", [""])[0] == "two", "a second passes")
    # By the elapsed real time: the times of a late program do not give the number of messages.
    assert len(page.sent("_frame")) <= 2 + (time.monotonic() - began) / INTERVAL
    program.pause()  # a step that the pause ends is not reported
    steps = program.steps
    wait_for(lambda: program.step() or program.steps > steps, "a step is made")
    wait_for(lambda: step(page)["time"] == program.version.function.last_step.time, "the last step is reported")


def test_of_two_threads_that_tell_a_step_at_once_the_last_one_tells_the_newest(
    robot: Feed, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Waits:
        one = two = None
        moves = "one -> two after 99"

    widget = MachineWidget(robot)
    program = robot.program(Waits, rate=100)
    machine = program.version.function
    wait_for(lambda: machine.last_step.states, "it runs")
    program.pause()
    show = widget._show

    def is_overtaken(step: Any, **given: Any) -> None:
        monkeypatch.setattr(widget, "_show", show)
        machine.last_step = step._replace(time=step.time + 1)
        widget._on_step()
        show(step, **given)

    monkeypatch.setattr(widget, "_show", is_overtaken)
    widget._on_step()
    wait_for(lambda: get_newest(widget).sample is machine.last_step, "the newest is reported")
    widget.close()


def test_an_event_that_made_a_move_is_true_in_the_first_frame_after_it(robot: Feed, page: Page) -> None:
    class Ticks:
        def ten(state):
            return state.get("n", 0) % 10 == 9

        def running(state):
            state.n = state.get("n", 0) + 1

        one = two = None
        moves = "one -> two on ten", "two -> one after 0.001"

    program = robot.program(Ticks, rate=200)
    wait_for(lambda: len(program.version.function.fired) > 20, "ten moves are made on the event")
    program.pause()
    frames = [json.loads(frame[FRAME_HEADER.size :]) for frame in page.sent("_frame")]
    last = frames[-1]["time"]  # a step that the pause ends is not reported
    times = [fired.time for fired in program.version.function.fired if fired.why == "on ten" and fired.time <= last]
    shown = {next(frame["time"] for frame in frames if frame["time"] >= time) for time in times}
    assert shown == {frame["time"] for frame in frames if ["Ticks", "ten", True, "n % 10 9 = 9"] in frame["judged"]}


def test_the_page_knows_which_widgets_are_of_the_robot(script: Scripted, robot: Feed, page: Page) -> None:
    laser = LaserWidget()
    robot.connect("/scan", laser)
    assert page.state["_together"] == page.state["_source"]["robot"] == synced(laser, "_source")["robot"]
    with Feed(Scripted(SCAN)) as other:
        other.connect("/scan", stranger := LaserWidget())
        assert synced(stranger, "_source")["robot"] != synced(laser, "_source")["robot"]


def test_it_takes_a_feed_alone() -> None:
    with pytest.raises(TypeError, match=r"MachineWidget\(\): expected a feed, such as feeds\.simulator\(\), got 3"):
        MachineWidget(3)


def test_the_state_in_which_a_step_failed_is_reported_until_it_goes_on(robot: Feed, page: Page) -> None:
    robot.variables.bad = False

    class Failing:
        first = None

        def second(variables):
            return Drive(0.1 / (not variables.bad))

        moves = "first -> second after 0.02"

    program = robot.program(Failing, rate=100)
    wait_for(lambda: step(page).get("states", {}).get("Failing", [""])[0] == "second", "it runs")
    assert page.state["_about"]["failed"] == ""
    robot.variables.bad = True
    wait_for(lambda: page.state["_about"]["failed"] == "Failing.second", "the state is reported")
    robot.variables.bad = False
    program.run()
    wait_for(lambda: page.state["_about"]["failed"] == "", "it goes on")


def test_the_page_sends_a_machine_to_a_state_unless_a_busy_kernel_delayed_that(robot: Feed) -> None:
    class Walker:
        first = second = None
        moves = "first -> second after 600", "second -> first after 600"

    widget = MachineWidget(robot)
    sent: list[Any] = []
    widget.send = sent.append
    program = robot.program(Walker, rate=100)
    machine: Any = program.version.function
    wait_for(lambda: machine.active == ("first",), "it runs")
    widget._trait_values["_beat"] = 9
    for content in ({"go": "Walker.second", "beat": 5}, {"go": "Walker.second"}, {"go": "Walker.second", "beat": 10}):
        from_page(widget, content)
    assert sent == [{"refused": "the kernel was busy: press it again"}] * 3
    from_page(widget, {"go": "Walker.third", "beat": 8})
    assert sent[-1] == {"refused": "Walker has no state 'third'; there are first, second"}
    steps = program.steps
    wait_for(lambda: program.steps > steps + 2, "it steps on")
    assert machine.active == ("first",)
    from_page(widget, {"go": "Walker.second", "beat": 8})
    wait_for(lambda: machine.active == ("second",), "it has gone there")
    widget.close()

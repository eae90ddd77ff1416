"""The lines of functions and recorded programs at the time of a player, and their spans as its marks."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import robowidgets
from robowidgets import SAMPLE
from robowidgets.behaviors import Drive
from robowidgets.feeds import simulator
from robowidgets.lines.lines_at_time import LinesAtTime
from robowidgets.lines.recorded_lines import OFFER, RecordedLinesWidget
from robowidgets.recording import Recording
from robowidgets.recordings.program_log import PROGRAM, TEXT, program_text
from robowidgets.runtime.clock import Threads
from robowidgets.runtime.policies import RECORDED
from robowidgets.screens.player import Player

from ..clocks import ManualClock
from ..pages import from_page, get_newest, synced
from ..recordings import recorded
from ..recordings.sweeps import START_NS, TYPE, scan
from ..waiting import wait_for


def near(scan):  # type: ignore[no-untyped-def]
    front = scan.distance("front")
    if front < 0.6:  # noqa: SIM103
        return True
    return False


FIRST = near.__code__.co_firstlineno


def counting(scan, state):  # type: ignore[no-untyped-def]
    state.n = state.setdefault("n", 0) + 1
    return Drive(0.1) if scan.distance() > 0.5 else None


@pytest.fixture(scope="module")
def recording() -> Iterator[Recording]:
    with robowidgets.open(SAMPLE) as opened:
        yield opened


@pytest.fixture
def show(recording: Recording) -> Iterator[Callable[..., Player]]:
    players: list[Player] = []

    def show(lines: Any, opened: Recording = recording) -> Player:
        players.append(opened.show(scanogram=False, lines=lines))
        return players[-1]

    yield show
    for player in players:
        player.close()


def frame(widget: RecordedLinesWidget) -> dict[str, Any]:
    """The newest frame, without its header."""
    packed = widget.get_state()["_frame"]
    return dict(json.loads(bytes(packed)[32:])) if packed else {}


def step_at(widget: RecordedLinesWidget, seconds: float) -> dict[str, Any]:
    """The step that is shown once the values of a time have been computed."""
    wait_for(
        lambda: (new := get_newest(widget).sample) and new.made and new.seconds == seconds, f"it shows {seconds} s"
    )
    (step,) = frame(widget)["steps"]
    return dict(step)


def lines_of(step: dict[str, Any]) -> dict[int, str]:
    return {line[0]: line[1] for call in step["calls"] for line in call["lines"]}


def complete(player: Player) -> RecordedLinesWidget:
    widget = player.lines
    assert widget is not None
    wait_for(lambda: "times" in synced(widget, "_drive"), "the recording is computed")
    return widget


def test_the_values_are_those_of_the_time_of_the_player(show: Callable[..., Player], recording: Recording) -> None:
    player = show(near)
    assert player.lines is not None
    for seconds in (40.0, 12.34, 3.4):
        player.time = seconds
        step = step_at(player.lines, seconds)
        moment = recording.at("/scan", seconds)
        assert lines_of(step)[1] == f"{moment.sample.distance('front'):.2f} m"
        assert step["time"] == moment.seconds


def test_a_program_with_a_state_is_stepped_from_the_start_to_any_time(show: Callable[..., Player]) -> None:
    player = show(counting)
    assert player.lines is not None
    numbers = []
    for seconds in (30.0, 31.0, 10.0):
        player.time = seconds
        numbers.append(int(lines_of(step_at(player.lines, seconds))[1]))
    assert numbers == [numbers[0], numbers[0] + 10, numbers[0] - 200]
    assert "stepped 10 times a second from 0.00 s on" in synced(complete(player), "_about")["assumes"]


def test_each_line_has_a_graph_of_bounded_size_and_counts_over_the_whole_recording(
    show: Callable[..., Player], recording: Recording
) -> None:
    player = show(near)
    widget = complete(player)
    table = recording.lines(near)
    told = synced(widget, "_drive")
    assert (told["from"], told["to"]) == (0.0, recording.duration)
    assert 200 < len(told["times"]) <= 240
    ((_, lines),) = told["lines"].items()
    kinds = {line: kind for line, kind, _ in lines}
    assert kinds == {1: "number", 2: "flag", 3: "flag", 4: "flag"}
    assert all(len(levels) == len(told["times"]) for _, _, levels in lines)
    newest = frame(widget)
    assert newest["total"] == len(table)
    ((_, counts),) = newest["totals"].items()
    found = {line: true for line, _, true in counts}
    assert found[2] == sum(moment.sample.distance("front") < 0.6 for moment in recording.samples("/scan"))
    assert len(json.dumps(told)) < 20_000


def test_the_spans_of_a_chosen_line_are_the_marks_until_none_is_chosen(show: Callable[..., Player]) -> None:
    player = show(near)
    widget = complete(player)
    player.marks = before = ((1.0, 2.0, "mine"),)
    from_page(widget, {"when": FIRST + 2})
    found = widget.when(FIRST + 2)
    assert [mark[:2] for mark in player.marks] == [(span.start, span.end) for span in found]
    assert {mark[2] for mark in player.marks} == {f"line {FIRST + 2} was true"}
    assert synced(widget, "_chosen") == {"line": FIRST + 2, "spans": len(found), "what": f"line {FIRST + 2} was true"}
    from_page(widget, {"when": FIRST + 3})
    assert {mark[2] for mark in player.marks} == {f"line {FIRST + 3} was true"}
    from_page(widget, {"when": None})
    assert player.marks == before
    from_page(widget, {"when": FIRST + 2})
    player.marks = ((3.0, 4.0, "newer"),)
    from_page(widget, {"when": None})
    assert player.marks == ((3.0, 4.0, "newer"),)


def test_what_find_has_found_is_shown_on_the_lines_of_its_function(recording: Recording) -> None:
    found = recording.find(near)
    player = found.show(scanogram=False)
    try:
        assert player.time == found[0].start
        assert [mark[:2] for mark in player.marks] == [(span.start, span.end) for span in found]
        assert player.lines is not None
        assert lines_of(step_at(player.lines, player.time))[2] == "True"
    finally:
        player.close()
    ready_made = recording.find(robowidgets.conditions.nearest_below(0.3)).show(scanogram=False)
    assert ready_made.lines is None
    ready_made.close()
    with pytest.raises(RuntimeError, match=r"what Recording\.find has returned"):
        found[:1].show()


def run_of(folder: Path, *texts: tuple[float, str]) -> Path:
    """A recording with ten scans a second, and the texts of versions of a program."""
    messages = [(i / 10, "/scan", scan(START_NS, [1.0 + i / 100] * 11)) for i in range(101)]
    for number, (at, text) in enumerate(texts, 1):
        messages.append((at, PROGRAM, {"data": program_text("avoid", number, text)}))
    return recorded.write(folder, {"/scan": TYPE, PROGRAM: TEXT}, sorted(messages, key=lambda message: message[0]))


CELL = """@robot.program(rate=5)
def avoid(scan, state):
    state.n = state.setdefault("n", 0) + 1
    return Drive(0, scan.distance())
"""


def test_a_recorded_program_shows_its_code_and_runs_it_only_on_request(
    tmp_path: Path, show: Callable[..., Player]
) -> None:
    path = run_of(
        tmp_path / "run", (0.0, "import robowidgets\nfrom robowidgets.behaviors import Drive\n" + CELL), (5.0, CELL)
    )
    with robowidgets.open(path) as opened:
        player = show(None, opened)
    widget = player.lines
    assert widget is not None
    assert (widget.folded, synced(widget, "_offer"), widget._job) == (True, OFFER, None)
    (function,) = synced(widget, "_code")["functions"]
    assert (function["first"], function["texts"][0]) == (4, "def avoid(scan, state):")
    widget.folded = False
    assert widget._job is None
    from_page(widget, {"compute": True})
    player.time = 4.1
    step = step_at(widget, 4.1)
    assert (lines_of(step)[1], lines_of(step)[2]) == ("21", "Drive(0, 1.4)")
    player.time = 7.0
    assert (synced(widget, "_code")["version"], synced(widget, "_code")["functions"][0]["first"]) == (2, 2)
    step = step_at(widget, 7.0)
    assert (lines_of(step)[1], step["time"]) == ("1", 5.0)  # with its own state, from its own start on
    assert step["calls"][0]["error"][1].startswith("NameError")


def test_a_recorded_program_without_its_text_says_why(tmp_path: Path, show: Callable[..., Player]) -> None:
    with robowidgets.open(run_of(tmp_path / "run", (0.0, "robot.program(avoid)\n"))) as opened:
        player = show(None, opened)
    assert player.lines is not None
    assert synced(player.lines, "_code")["functions"][0]["why"] == "its cell does not define it"
    assert synced(player.lines, "_offer") == ""


def test_a_step_that_does_not_return_is_abandoned_and_the_error_says_so(recording: Recording) -> None:
    clock = ManualClock()
    gate, entered = threading.Event(), threading.Event()

    def hangs(scan: Any) -> bool:
        entered.set()
        return gate.wait(120)

    results: list[str] = []
    lines = LinesAtTime(
        recording.reopened, lambda: hangs, lambda: results.append(lines.error), rate=10, scheduler=Threads(clock)
    )
    lines.ask(3.0)
    wait_for(entered.is_set, "the function hangs")
    for _ in range(12):
        clock.advance(RECORDED.look, hangs=("robowidgets-lines",))
    assert f"has not returned for {RECORDED.late:g} s, line {hangs.__code__.co_firstlineno + 2}" in lines.error
    assert results == [lines.error]
    gate.set()
    lines.close()


def test_a_function_over_a_recording_cannot_drive_a_robot(recording: Recording) -> None:
    with simulator(wander=False) as robot:

        def drives(scan: Any) -> None:
            robot.drive(0.3)

        lines = LinesAtTime(recording.reopened, lambda: drives, lambda: None, rate=10)
        lines.ask(3.0)
        wait_for(lambda: lines.shown is not None, "a step is made")
        assert lines.shown is not None
        assert "it runs over a recording" in lines.shown.error
        lines.close()


def test_a_file_that_cannot_be_read_any_more_says_so() -> None:
    def gone() -> Any:
        raise FileNotFoundError("it was deleted")

    lines = LinesAtTime(gone, lambda: near, lambda: None, rate=10)
    lines.ask(1.0)
    wait_for(lambda: lines.error, "it says so")
    assert lines.error == "FileNotFoundError: it was deleted"
    lines.close()

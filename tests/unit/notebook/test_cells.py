"""The widgets and feeds of a cell are closed when it runs again."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from contextlib import closing
from types import SimpleNamespace

import pytest

from robowidgets import ProgramWidget, feeds
from robowidgets.feeds import feed as _feed
from robowidgets.notebook import cells as _cells

from ..shells import put_in_place
from ..waiting import wait_for

Run = Callable[[str, str], "Made"]


class Made:
    """Notes its closing."""

    closed = False

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def begin(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], None]:
    """Begin a run of a cell, with the names that the kernel gives to both."""
    request: dict[str, dict[str, str]] = {}
    put_in_place(monkeypatch, get_parent=lambda: request)
    monkeypatch.setattr(_cells, "_made", {})

    def named(cell: str, number: str) -> None:
        request.update(metadata={"cellId": cell} if cell else {}, header={"msg_id": number})

    return named


@pytest.fixture
def run(begin: Callable[[str, str], None]) -> Run:
    """Make something in a run of a cell."""

    def made_in(cell: str, number: str) -> Made:
        begin(cell, number)
        made = Made()
        _cells.take_the_place(made)
        return made

    return made_in


def test_what_earlier_runs_of_a_cell_made_is_closed(run: Run) -> None:
    earlier = [run("a", "1"), run("a", "1")]
    assert not any(made.closed for made in earlier)
    now = run("a", "2")
    assert all(made.closed for made in earlier)
    assert not now.closed


def test_what_other_cells_made_stays(run: Run) -> None:
    first, second = run("a", "1"), run("b", "2")
    run("b", "3")
    assert (first.closed, second.closed) == (False, True)


def test_if_the_running_cell_is_unknown_nothing_is_closed(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    first = run("", "1")
    run("", "2")
    monkeypatch.setattr("IPython.get_ipython", lambda: None)
    run("a", "3")
    assert not first.closed
    assert not _cells._made


def test_an_unreferenced_object_is_not_kept_for_the_next_run(run: Run) -> None:
    run("a", "1")
    assert not _cells._made["a"][1]


def test_an_object_replaces_the_one_of_its_kind_and_place_in_the_earlier_run(
    begin: Callable[[str, str], None], run: Run
) -> None:
    class Other(Made):
        """An object of another kind."""

    begin("a", "1")
    firsts = [Other(), Other()]
    assert [_cells.predecessor(other, Other) for other in firsts] == [None, None]
    made = run("a", "2")
    assert all(other.closed for other in firsts)
    assert [_cells.predecessor(Other(), Other) for _ in range(3)] == [*firsts, None]
    assert not made.closed


def test_a_cell_that_connects_and_shows_a_robot_keeps_the_arrangement_of_its_earlier_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(_cells, "_made", {})
    monkeypatch.setattr(_cells, "running_cell", lambda: ("a", "1"))
    cards = {"row": ["/scan", "/odom"]}
    view = feeds.simulator().show("/scan", "/odom")
    view.set_state({"_cards": {"all": cards}})  # as the page sends it
    monkeypatch.setattr(_cells, "running_cell", lambda: ("a", "2"))
    with feeds.simulator() as feed:
        assert feed.show("/scan", "/odom").arrangement["cards"] == cards


def test_a_feed_is_closed_when_its_cell_opens_another(begin: Callable[[str, str], None]) -> None:
    begin("a", "1")
    earlier = feeds.simulator()
    begin("b", "2")
    with feeds.simulator():
        assert not earlier.connection.is_closed
    begin("a", "3")
    with feeds.simulator() as now:
        assert (earlier.connection.is_closed, now.connection.is_closed) == (True, False)


def test_the_traceback_of_a_cell_is_shown_and_each_robot_stopped_though_one_cannot_be(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    done: list[str] = []

    def cannot() -> None:
        raise RuntimeError("can't start new thread")

    shell = put_in_place(
        monkeypatch,
        events=SimpleNamespace(register=lambda *_: None),
        showtraceback=lambda: done.append("the traceback is shown"),
    )
    monkeypatch.setattr(_cells, "_on_failed", [])
    _cells.on_failed_cell(cannot)
    _cells.on_failed_cell(lambda: done.append("the other is stopped"))
    shell.showtraceback()
    assert done == ["the other is stopped", "the traceback is shown"]
    assert "a robot may drive on, as it could not be stopped: can't start new thread" in caplog.text


IN_CELLS = """
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
request = {}
shell.get_parent = lambda: request
def run(number, code, cell="a"):
    request.update(metadata={"cellId": cell} if cell else {}, header={"msg_id": str(number)})
    print("cell", number)
    shell.run_cell(code).raise_error()
run(1, "from robowidgets import feeds; from robowidgets.behaviors import Drive", "open")
run(1, "bot = feeds.simulator(wander=False)", "open")
run(2, "for _ in range(3): bot.drive(0.01)")
run(3, "bot.drive(0.01); bot.stop()")
program = "@bot.program\\ndef stand():\\n    return Drive()"
run(4, program)
run(5, program, cell="")
run(6, "import threading; t = threading.Thread(target=bot.stop); t.start(); t.join()")
run(7, "bot.stopped = True\\n" + program)
run(8, "bot.close()")
"""


@pytest.mark.slow  # a process with IPython
def test_a_driving_cell_prints_once_what_happens_and_which_widget_shows_it() -> None:
    done = subprocess.run([sys.executable, "-c", IN_CELLS], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    drives = "the simulated robot: each speed on /cmd_vel holds for 0.5 s; bot.show() shows the robot"
    stands = "the simulated robot: stand drives from now on, also after this cell; bot.show() shows it, with Stop"
    stopped = "the simulated robot: stand drives when you press Allow driving in bot.show(), because Stop is pressed"
    cells = ["cell 1", "cell 1", "cell 2", drives, "cell 3", drives, "cell 4", stands, "cell 5", "cell 6"]
    assert done.stdout.splitlines() == [*cells, "cell 7", stopped, "cell 8"]


def test_a_cell_whose_program_failed_at_once_does_not_say_that_it_drives(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(_cells, "running_cell", lambda: ("a", "1"))
    monkeypatch.setattr(_cells, "called_from_cell", lambda: True)
    with feeds.simulator(wander=False) as robot, closing(ProgramWidget(robot)) as widget:

        def has_failed(*_: object) -> str:
            wait_for(lambda: widget.program and widget.program.error, "the first step has failed")
            return "robot"

        monkeypatch.setattr(_feed, "name_in_cells", has_failed)
        robot.program(lambda: 1 / 0, rate=50)
        words = "the simulated robot: <lambda> has an error and does not drive: correct it and run the cell again\n"
        assert capsys.readouterr().out == words

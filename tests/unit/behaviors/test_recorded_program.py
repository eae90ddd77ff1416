"""Functions made of the text of recorded programs: what runs of a cell, and what does not."""

from __future__ import annotations

import linecache
from typing import Any

import pytest

from robowidgets.behaviors.lines import rewritten
from robowidgets.behaviors.recorded_program import RecordedProgramError, recorded_program

CELL = """from robowidgets.behaviors import Drive
import math
robot = feeds.ros2()
NEAR, SIDE = 0.5 + LIMIT, math.radians(30)
robot.drive(0.2); FAR = 2.0
open("/nowhere/hostile", "w")

@robot.program(
    rate=20, scan="/front")
def avoid(scan):
    if scan.distance() < NEAR:
        return Drive(0)
    return Drive(0.2)
"""


def test_definitions_imports_and_constants_run_and_nothing_else() -> None:
    program = recorded_program("avoid", CELL, "<avoid, version 1>")
    assert (program.rate, program.topics, program.first) == (20.0, {"scan": "/front"}, 10)
    avoid = program.make({"LIMIT": 0.1, "robot": object(), "FAR": 3.0})
    assert avoid.__globals__["NEAR"] == 0.6
    assert "robot" not in avoid.__globals__
    assert avoid.__globals__["FAR"] == 3.0  # its line drives, too
    assert avoid.__code__.co_firstlineno == 10
    assert [text.strip() for text in rewritten(avoid).source.texts][1] == "if scan.distance() < NEAR:"
    linecache.checkcache()
    assert linecache.getline("<avoid, version 1>", 11) == "    if scan.distance() < NEAR:\n"


def test_a_program_that_was_given_by_a_call_has_its_rate_and_a_wrong_one_is_left_out() -> None:
    cell = "def avoid(scan):\n    return None\nrobot.program(avoid, rate=5)\n"
    assert recorded_program("avoid", cell, "<a>").rate == 5
    assert recorded_program("avoid", cell.replace("5", "-5"), "<a>").rate == 10


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "is not in the recording"),
        ("x = 1", "does not define it"),
        ("def avoid(:", "not Python: invalid syntax"),
        ("\0", "not Python"),
    ],
)
def test_a_text_without_the_program_says_why(text: str, why: str) -> None:
    with pytest.raises(RecordedProgramError, match=why):
        recorded_program("avoid", text, "<a>")


def test_an_expression_that_could_do_anything_does_not_run() -> None:
    ran: list[Any] = []

    def hostile() -> None:
        ran.append(1)

    cell = "a = hostile()\nb = [hostile() for _ in '1']\nc = d.e\nf = np.load(*g)\nhostile()\ndef avoid(scan): pass\n"
    program = recorded_program("avoid", cell, "<a>")
    program.make({"hostile": hostile})
    assert ran == []
    assert program.text.strip() == "def avoid(scan): pass"

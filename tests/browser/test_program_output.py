"""The page shows what a program prints, logs and raises below its own cell."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from ..unit.waiting import wait_for
from .notebook import CellError, Notebook

OPEN = """
from robowidgets import feeds
from robowidgets.behaviors import Drive
one, two = feeds.simulator(wander=False, hz=20), feeds.simulator(wander=False, hz=20)
one.variables.looks = one.variables.fails = one.variables.prints = two.variables.fails = False
"""
FIRST = """
@one.program(rate=20)
def first(scan, variables):
    if variables.prints:
        variables.prints = False
        print("the first one prints")
    return Drive(0.1 / (not variables.fails))
"""
SECOND = """
@two.program(rate=20)
class second:
    def stand(variables):
        return Drive(0.1 / (not variables.fails))
    moves = "* -> stand after 99"
"""
REPLACES = """
@two.program(rate=20)
def third():
    return Drive()
"""
CONNECTS = """
def look(scan):
    if one.variables.looks:
        raise RuntimeError("it looked")
one.connect("/scan", look)
"""


def printed(nb: Notebook, index: int, name: str) -> str:
    """The text of one of the two streams below a cell."""
    streams = [output for output in nb.outputs(index) if output.get("name") == name]
    return "".join("".join(output["text"]) for output in streams)


def test_what_a_program_says_stands_below_its_own_cell_without_our_frames(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([OPEN, FIRST, SECOND, CONNECTS, "print('last')"])
    nb.python("setattr(one.variables, 'looks', True)")
    wait_for(lambda: "RuntimeError: it looked" in printed(nb, 3, "stderr"), "so is the error of a function")
    assert "robowidgets" not in printed(nb, 3, "stderr")
    nb.python("setattr(one.variables, 'prints', True)")
    wait_for(lambda: "the first one prints" in printed(nb, 1, "stdout"), "the print is below the cell of the first one")
    nb.python("setattr(one.variables, 'fails', True)")
    wait_for(lambda: "ZeroDivisionError: " in printed(nb, 1, "stderr"), "the error is below its cell")
    nb.python("setattr(two.variables, 'fails', True)")
    wait_for(lambda: "ZeroDivisionError: " in printed(nb, 2, "stderr"), "that of the machine is below its cell")
    for cell, name, line in ((1, "first", 6), (2, "second", 4)):
        error = printed(nb, cell, "stderr")
        assert error.count("Traceback") == error.count('File "') == 1, error
        assert f"program {name}: line {line}: " in error
        assert "robowidgets" not in error
    assert nb.text(4) == "last\n"


def test_of_a_version_that_goes_on_it_stands_below_the_run_that_failed(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([OPEN, FIRST, "print('last')"])
    nb.edit(1, "1 / 0\n" + FIRST)
    with pytest.raises(CellError, match="ZeroDivisionError"):
        nb.run(1)
    nb.python("setattr(one.variables, 'prints', True)")
    wait_for(lambda: "the first one prints" in printed(nb, 1, "stdout"), "it goes on below its cell")
    assert nb.text(2) == "last\n"


def test_output_without_an_error_is_printed_as_plain_text(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([OPEN, SECOND, REPLACES])
    assert "the program third replaces the program second\n" in printed(nb, 2, "stdout")
    nb.run(1)
    renamed = SECOND.replace("stand", "rest")
    nb.edit(1, renamed)
    nb.run(1)
    wait_for(lambda: "the state stand is gone: rest takes over\n" in printed(nb, 1, "stdout"), "the machine says so")
    assert printed(nb, 1, "stderr") == printed(nb, 2, "stderr") == ""

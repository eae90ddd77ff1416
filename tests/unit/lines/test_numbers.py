"""The numbers in the source of a step: which can be changed, and the function with another one."""

from __future__ import annotations

import inspect
import linecache
from typing import Any

import pytest

from robowidgets.behaviors.lines.numbers import NotChangedError, numbers_in, with_number
from robowidgets.reasons.rewriting import rewritten

from .test_rewriting import made

STEP = '''
import math

def decorate(near):
    return lambda function: function

@decorate(0.5)
def step(scan, limit=0.6, *, speed=0.2, other=2 * 0.1):
    """Stay 0.5 m away."""
    text = "0.7" f"{scan:.3f}"
    turn = 0.8 if scan < limit else -0.8
    squared = scan - 1.5 ** 2
    mask = 0x1f
    far = 12345678901
    for _ in range(3):
        inner = [one * 4 for one in (scan,)]
    return speed, turn, squared, inner[0], mask, far, 1j, True
'''


def by_text(function: Any) -> dict[str, Any]:
    return {number.text: number for number in numbers_in(function)}


def change(function: Any, text: str, to: str, file: str = "") -> Any:
    number = by_text(function)[text]
    return with_number(function, number.line, number.column, to, file).function


def test_the_numbers_of_a_function_are_its_literals_with_their_place() -> None:
    function = made(STEP)
    texts = rewritten(function).source.texts
    found = numbers_in(function)
    free = [number.text for number in found if not number.why]
    assert free == ["0.6", "0.2", "0.8", "-0.8", "1.5", "2", "3", "4", "0"]
    for number in found:
        assert texts[number.line][number.column :].startswith(number.text)


def test_a_number_that_cannot_be_changed_says_why() -> None:
    why = {number.text: number.why for number in numbers_in(made(STEP)) if number.why}
    assert "when its cell ran" in why["0.5"]
    assert "computed" in why["0.1"]
    assert "plain decimal" in why["0x1f"]
    assert "too large" in why["12345678901"]
    assert "plain decimal" in why["1j"]
    function = made(STEP)
    number = by_text(function)["0x1f"]
    with pytest.raises(NotChangedError, match="plain decimal"):
        with_number(function, number.line, number.column, "3")


@pytest.mark.parametrize(
    ("text", "to", "result"),
    [
        ("0.6", "2.5", (0.2, 0.8, 2 - 2.25, 8)),
        ("0.2", "0.7", (0.7, -0.8, 2 - 2.25, 8)),
        ("-0.8", "0.4", (0.2, 0.4, 2 - 2.25, 8)),
        ("1.5", "-3.0", (0.2, -0.8, 2 - 9.0, 8)),  # not -(3.0 ** 2)
        ("4", "5", (0.2, -0.8, 2 - 2.25, 10)),
    ],
)
def test_the_function_computes_with_the_new_number_alone(text: str, to: str, result: tuple[float, ...]) -> None:
    function = made(STEP)
    assert change(function, text, to)(2)[:4] == result
    assert function(2)[:4] == (0.2, -0.8, 2 - 2.25, 8)


def test_a_whole_number_stays_whole_and_nothing_but_a_number_is_taken() -> None:
    function = made(STEP)
    with pytest.raises(NotChangedError, match="whole number"):
        change(function, "3", "3.5")
    for text in ("__import__('os')", "1e9", "", "1 + 1", "0.5\n"):
        with pytest.raises(NotChangedError, match="expected a number"):
            change(function, "0.6", text)
    with pytest.raises(NotChangedError, match=r"expected a number in line .*; run the cell again"):
        with_number(function, 1, 3, "0.5")


def test_a_closure_and_a_method_keep_what_they_belong_to() -> None:
    inner = "    def step(do):\n        seen.append(do)\n        return len(seen) * 0.5\n"
    function = made(f"def outer():\n    seen = []\n{inner}    return step\nstep = outer()\n")
    function(1)
    assert change(function, "0.5", "2.0")(2) == 4.0
    method = made("class A:\n    x = 3\n    def step(self, do):\n        return self.x * 0.5\nstep = A().step\n")
    assert change(method, "0.5", "2.0")(2) == 6.0


def test_tabs_and_indentation_do_not_move_a_number() -> None:
    function = made("if True:\n\tdef step(do):\n\t\tx = 'é', 0.5\n\t\treturn x[1]\n")
    texts = rewritten(function).source.texts
    number = by_text(function)["0.5"]
    assert texts[number.line][number.column :] == "0.5"
    assert change(function, "0.5", "0.25")(1) == 0.25


def test_the_changed_source_is_the_source_of_the_changed_function() -> None:
    function = made(STEP)
    changed = change(function, "1.5", "1.75", "<robowidgets test>")
    assert "scan - 1.75 ** 2" in inspect.getsource(changed)
    assert "scan - 1.5 ** 2" in inspect.getsource(function)
    again = change(changed, "1.75", "-2.0", "<robowidgets test 2>")
    assert "scan - (-2.0) ** 2" in "\n".join(rewritten(again).source.texts)
    assert change(again, "-2.0", "3.0")(0)[2] == -9.0
    for number in range(60):
        change(function, "1.5", "1.75", f"<robowidgets test {number}>")
    assert len([name for name in linecache.cache if name.startswith("<robowidgets test")]) <= 50

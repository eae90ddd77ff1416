"""The lines of a step as a view shows them."""

from __future__ import annotations

import itertools
import linecache
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robowidgets.behaviors import Drive
from robowidgets.behaviors.lines.packed import Totals, packed_step, spread
from robowidgets.behaviors.lines.shown import FLAG, NUMBER, REACHED, LineValues, levels_of, lines_of, passes_of
from robowidgets.behaviors.lines.watch import LineWatch, WatchedStep
from robowidgets.samples import Image, Scan

NUMBERS = itertools.count()
SCAN = Scan(
    np.array([3.0, 2.0, 1.0, 2.0, 0.6], np.float32),
    angle_min=-1.0,
    angle_increment=0.5,
    range_min=0.1,
    range_max=4.0,
    frame_id="laser",
)


def steps_of(body: str, *given: dict[str, Any]) -> list[WatchedStep]:
    """The steps of a function with this body, which gets one of these values after the other."""
    text = f"def step({', '.join(given[0])}):\n" + "".join(f"    {line}\n" for line in body.splitlines())
    file = f"<shown {next(NUMBERS)}>"
    linecache.cache[file] = len(text), None, text.splitlines(keepends=True), file
    namespace: dict[str, Any] = {"Drive": Drive}
    exec(compile(text, file, "exec", dont_inherit=True), namespace)
    watch = LineWatch()
    steps = watch.add_view()
    for values in given:
        with suppress(ZeroDivisionError):
            watch.step(("step", 1), (1, 0.5), namespace["step"], values)
    return [*steps]


def step_of(body: str, **values: Any) -> WatchedStep:
    """The step of a function with this body."""
    (step,) = steps_of(body, values)
    return step


def lines(body: str, **values: Any) -> dict[int, LineValues]:
    """The lines of a function with this body, its first line being 1."""
    (call,) = step_of(body, **values).calls
    return {line.number: line for line in lines_of(call)}


def test_a_distance_has_its_unit_and_its_ray() -> None:
    found = lines("front = scan.distance(('-40deg', '40deg'))\nwhole = scan.distance()\nray = scan.at(0.0)", scan=SCAN)
    assert found[1] == LineValues(1, "1.00 m", kind=NUMBER, level=1.0, rays=(((1, 4), 2, "laser"),))
    assert found[2].value == "0.60 m"
    assert found[2].rays == (((0, 5), 4, "laser"),)
    assert (found[3].value, found[3].rays) == ("ray [2]", (((2, 3), 2, "laser"),))


def test_a_percentile_is_the_distance_of_no_ray_and_a_sector_may_be_in_two_parts() -> None:
    all_round = Scan(np.ones(8, np.float32), angle_min=-3.1, angle_increment=0.8, range_min=0.1, range_max=4.0)
    found = lines("a = scan.distance('back')\nb = scan.distance('left', percentile=50)", scan=all_round)
    assert len(found[1].rays[0].runs) == 4
    found = lines("b = scan.distance(percentile=50)", scan=SCAN)
    assert found[1].rays == (((0, 5), -1, "laser"),)


def test_a_distance_of_something_else_than_a_scan_has_no_unit() -> None:
    class Place:
        def distance(self, _: int) -> float:
            return 2.5

    found = lines("d = place.distance(1)\nif place.distance(1) > 2:\n    pass", place=Place())
    assert found[1].value == "2.5"
    depth = Image(np.full((2, 2), 1.5, np.float32), "32FC1", depth_scale=1.0)
    assert lines("d = image.distance(0, 1)", image=depth)[1].value == "1.50 m"


def test_none_is_shown_unless_it_is_the_value_of_a_call_for_its_effect() -> None:
    found = lines("x.clear()\ny = x.get(1)\nif x:\n    return 1\nreturn x.get(1)", x={})
    assert [found[number].value for number in (1, 2, 5)] == ["", "None", "None"]
    assert lines("return None")[1].value == "None"


def test_a_scan_of_a_moment_is_known_too_and_the_sector_may_be_computed() -> None:
    body = "sides = 'left', 'right'\nd = [scan][0].distance(sides[1])\nside = 'right'\ne = scan.distance(side)"
    found = lines(body, scan=SCAN)
    assert found[2].rays == found[4].rays != ()


def test_a_test_shows_what_was_compared_and_the_other_branch_is_not_there() -> None:
    found = lines("if a < b:\n    return 1\nelse:\n    c = 2\nreturn Drive(0, -0.8)", a=0.42171, b=0.42169)
    assert found[1] == LineValues(1, "False", ("0.42171 < 0.42169",), kind=FLAG, level=0.0)
    assert 2 not in found
    assert found[3].kind == REACHED
    assert found[5].value == "Drive(0, −0.8)"


def test_parts_of_a_condition_are_shown() -> None:
    found = lines("if a < 1 and go and not (b == 'x'):\n    pass\nx = 1 if a > b_ else 2", a=0.5, go=True, b="y", b_=1)
    assert found[1].details == ("0.50 < 1.00 is True", "go is True", "'y' == 'x' is False")
    assert found[3] == LineValues(3, "2", ("0.50 > 1.00 is False",), kind=NUMBER, level=2.0)


def test_a_comparison_has_the_sign_of_the_code() -> None:
    found = lines("if a == None:\n    pass\nif a is True:\n    pass\nb = a == 0.5\nc = a != 0.5", a=2.758)
    assert [found[number].details for number in (1, 3, 5, 6)] == [
        ("2.758 == None",),
        ("2.758 is True",),
        ("2.76 == 0.50",),
        ("2.76 \N{NOT EQUAL TO} 0.50",),
    ]


def test_a_speed_that_is_the_whole_of_a_statement_is_not_returned() -> None:
    found = lines("Drive(0.2)\nfor i in 'a':\n    Drive(0, 1.0)\nreturn Drive(0.3)")
    assert [found[number].value for number in (1, 3, 4)] == [
        "Drive(0.2), not returned",
        "Drive(0, 1), not returned",
        "Drive(0.3)",
    ]
    (call,) = step_of("for i in 'a':\n    Drive(0, 1.0)").calls
    assert passes_of(call)[0].rows == ("1: i 'a' \N{MIDDLE DOT} Drive(0, 1), not returned",)


@pytest.mark.parametrize(("body", "returns_none"), [("Drive(0.2)", True), ("return a", False), ("1 / 0", False)])
def test_a_step_knows_that_it_returned_none(body: str, returns_none: bool) -> None:
    step = step_of(body, a=1)
    assert (step.returned_none, packed_step(step)["none"]) == (returns_none, returns_none)


def test_a_range_is_shown_with_its_numbers() -> None:
    found = lines("for i in range(len(scan.ranges)):\n    pass\na = [range(9, 0, -2)]\nb = range(10**9999)", scan=SCAN)
    assert [found[number].value for number in (1, 3, 4)] == ["range(0, 5)", "[range(9, 0, -2)]", "<range>"]


def test_several_names_have_their_values() -> None:
    found = lines("left, right = scan.distance((0.9, 1.1)), scan.distance((-1.1, -0.9))\na, b = 1, 'x'", scan=SCAN)
    assert found[1].value == "left 0.60 m, right 3.00 m"
    assert found[1].details == ()
    assert [rays.nearest for rays in found[1].rays] == [4, 0]
    assert found[2].value == "a 1, b 'x'"


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("left = right = (0.5, 1.0)", "(0.5, 1.0)"),
        ("pair = a, b = (1, 2)", "(1, 2)"),
        ("(a, b), *rest = (1, 2), 3, 4", "((1, 2), 3, 4)"),
        ("a, *rest = (1, 2)", "a 1, *rest 2"),
        ("(a, b), c = f()", "(a, b) (1, 2), c 3"),
        ("a, b = {1: 5, 2: 6}", "{1: 5, 2: 6}"),
    ],
)
def test_a_name_has_no_value_that_it_did_not_get(line: str, text: str) -> None:
    assert lines(line, f=lambda: ((1, 2), 3))[1].value == text


def test_what_is_added_to_a_variable_is_not_shown_as_its_value() -> None:
    body = (
        "global known\nknown = own = 5\nknown += 1\nown += 2\ninner = lambda: own\n"
        "for _ in (1, 2):\n    state['n'] -= 1\n    box.near &= state['n'] < 5"
    )
    (call,) = step_of(body, state={"n": 5}, box=SimpleNamespace(near=False)).calls
    found = {line.number: (line.value, line.kind) for line in lines_of(call)}
    assert (found[3], found[4]) == (("6", NUMBER), ("7", NUMBER))
    assert (found[7], found[8]) == (("-= 1", REACHED), ("&= True", REACHED))
    assert passes_of(call)[0].rows[0] == "1: _ 1 · state['n'] -= 1 · box.near &= True"


def test_the_passes_of_a_loop_with_nested_names_have_their_values() -> None:
    (passes,) = passes_of(step_of("for i, (a, b) in enumerate(((1, 2), (3, 4))): pass").calls[0])
    assert passes.rows == ("1: i 0, (a, b) (1, 2)", "2: i 1, (a, b) (3, 4)")


@pytest.mark.parametrize("true_in", [0, 1, 24, 25])
def test_a_test_in_a_loop_is_true_if_it_was_true_in_any_pass(true_in: int) -> None:
    body = "for i in range(25):\n    if i == k:\n        pass\nwhile k < 25:\n    k = 25"
    for step in steps_of(body, {"k": true_in}, {"k": 25}):  # the first one leaves nothing for the second
        (call,) = step.calls
        found = levels_of(call)
        expected = FLAG, float(true_in < 25)
        assert (found[2], found[4]) == (expected, expected)
        assert {(line.kind, line.level) for line in lines_of(call) if line.number in (2, 4)} == {expected}
        true_in = 25


def test_a_test_on_the_line_of_its_branch_is_true_or_false() -> None:
    body = "if near: return 0.8\nelse: return 0.2"
    for near in (True, False):
        (call,) = step_of(body, near=near).calls
        (line, *_) = lines_of(call)
        assert (line.kind, line.level) == levels_of(call)[1] == (FLAG, float(near))
        assert line.value == ("True, 0.8" if near else "False")


def test_a_line_of_several_statements_has_the_value_of_each() -> None:
    found = lines("a = 1; print(a); b = 2\nif b < 3: c = a; d = 4\nfor i in (1, 2):\n    if i < 2: e = i")
    assert found[1].value == "a 1, b 2"
    assert (found[2].value, found[2].details) == ("True, c 1, d 4", ("2 < 3",))
    assert (found[4].value, found[4].kind, found[4].level) == ("False", FLAG, 1.0)  # the pass before it was true


def test_a_line_in_a_loop_has_its_last_value_and_how_often() -> None:
    step = step_of(
        "for i in range(30):\n    for j in 'ab':\n        x = 2 * i\n        x += 1\nwhile x > 0:\n    x -= 30"
    )
    (call,) = step.calls
    found = {line.number: line for line in lines_of(call)}
    assert (found[4].value, found[4].times) == ("59", 60)
    outer, inner, last = passes_of(call)
    assert (outer.number, outer.times, len(outer.rows), outer.rows[1]) == (1, 30, 20, "2: i 1")
    assert (inner.times, inner.rows[:3]) == (
        60,
        ("1.1: j 'a' \u00b7 x 0 \u00b7 x 1", "1.2: j 'b' \u00b7 x 0 \u00b7 x 1", "2.1: j 'a' \u00b7 x 2 \u00b7 x 3"),
    )
    assert (last.number, last.rows, last.times) == (5, ("1: x 29", "2: x −1"), 2)


def test_a_failed_line_has_its_error_and_the_values_before_it() -> None:
    step = step_of("x = a - a\ny = 1 / x\nreturn y", a=2)
    (call,) = step.calls
    assert (call.error, call.error_line) == ("ZeroDivisionError: division by zero", 3)
    assert [line.number for line in lines_of(call)] == [1, 2]
    assert packed_step(step)["calls"][0]["error"] == [2, "ZeroDivisionError: division by zero"]


def test_an_error_that_is_caught_leaves_its_line_reached_without_a_value() -> None:
    found = lines("try:\n    x = 1 / a\nexcept ZeroDivisionError:\n    x = 5\nreturn x", a=0)
    assert found[2].value == ""
    assert found[4].value == "5"


@pytest.mark.parametrize("source", ["lambda: 1", "print"])
def test_what_was_not_rewritten_says_why(source: str) -> None:
    watch = LineWatch()
    watch.add_view()
    watch.step(("p", 1), (1, 0.0), eval(source), {})
    assert watch.newest
    (call,) = watch.newest.calls
    assert (call.notes, bool(call.why), lines_of(call), passes_of(call)) == (None, True, [], [])


def test_totals_count_steps_and_some_are_sent() -> None:
    steps = steps_of("if a:\n    return 1\nreturn 2", *({"a": a} for a in (True, False, True)))
    totals = Totals()
    totals.add(steps)
    (rows,) = totals.packed().values()
    assert (totals.steps, rows) == (3, [[1, 3, 2], [2, 2, 0], [3, 1, 0]])
    assert spread(steps, 2) == [steps[0], steps[2]]
    assert spread(steps, 5) == steps


def test_what_is_computed_in_later_passes_is_not_in_the_row_of_an_earlier_one() -> None:
    (call,) = step_of("for i in range(100):\n    if i % 10 == 5:\n        x = i", given=0).calls
    (passes,) = passes_of(call)
    assert [row for row in passes.rows if "x" in row] == ["6: i 5 · line 3 True · x 5", "16: i 15 · line 3 True · x 15"]
    assert lines_of(call)[-1].times == 10


@pytest.mark.parametrize("first", [20, 25, 29])
def test_a_line_that_only_late_passes_reach_has_its_last_value_and_how_often(first: int) -> None:
    (call,) = step_of(f"for i in range(30):\n    if i >= {first}:\n        x = i").calls
    assert lines_of(call)[-1] == LineValues(3, "29", times=30 - first, kind=NUMBER, level=29.0)
    (passes,) = passes_of(call)
    assert (passes.times, len(passes.rows), any("x" in row for row in passes.rows)) == (30, 20, False)


def test_a_loop_that_only_late_passes_reach_has_its_values_and_no_rows() -> None:
    body = "for i in range(30):\n    if i > 25:\n        for j in 'ab':\n            x = 2 * i\n    y = i"
    (call,) = step_of(body).calls
    found = {line.number: line for line in lines_of(call)}
    assert [(found[number].value, found[number].times) for number in (3, 4, 5)] == [("'ab'", 4), ("58", 8), ("29", 30)]
    assert [passes.number for passes in passes_of(call)] == [1]


def test_the_rows_of_an_inner_loop_end_with_those_of_the_loop_around_it() -> None:
    (call,) = step_of("for i in range(30):\n    while i % 15 == 10:\n        i += 5\n        if i > 20: x = i").calls
    found = {line.number: line for line in lines_of(call)}
    assert (found[3].value, found[4].value, found[4].times) == ("30", "True, x 30", 2)
    _, inner = passes_of(call)
    assert (inner.rows, inner.times) == (("11.1: i 15 \N{MIDDLE DOT} line 5 False",), 2)

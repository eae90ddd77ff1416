"""The lines of a program on the page: values, what was not reached, single steps of a frozen picture, keys, looks."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Literal

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import Picture, eventually
from .plain_page import PlainPage

OPEN = """
from robowidgets import LaserWidget, LinesWidget, feeds
from robowidgets.behaviors import Drive
robot = feeds.simulator(wander=False, hz=20)
laser = LaserWidget()
robot.connect("/scan", laser)
robot.variables.slider("near", 100.0, 0.2, 100.0, "m")
lines = LinesWidget(robot)
display(laser)
lines
"""
AVOID = """@robot.program(rate=20)
def avoid(scan, variables):
    front = scan.distance("front")
    left, right = scan.distance("left"), scan.distance("right")
    for side in ("front", "left", "right"):
        away = scan.distance(side)
    if front < variables.near:  # too near
        turn = 0.8 if left > right else -0.8
        return Drive(0, turn)
    return Drive(0.2)
"""
FAILS = """@robot.program(rate=20)
def avoid(scan):
    front = scan.distance("front")
    rest = int(front * 0)
    return Drive(front / rest)
"""


LONG = """@robot.program(rate=20)
def avoid(scan):
    front = scan.distance("front")
    if front > 0.1:
        if (front < 0.5 and scan.distance("left") < 0.5) or scan.distance("right") < 0.3 or scan.distance("back") < 0.2:
            turn = 0.8
        near = min(scan.distance("left"), scan.distance("right"), scan.distance("back"), scan.distance("front"), front)
    return Drive(0.2)
"""
COLUMNS = """code => {
  const text = document.createRange();
  text.selectNodeContents(code);
  const rects = [...text.getClientRects()].filter(({ width }) => width);
  const top = Math.min(...rects.map(rect => rect.bottom));
  const probe = code.appendChild(document.createElement("span"));
  probe.textContent = "0".repeat(10);
  const letter = probe.getBoundingClientRect().width / 10;
  probe.remove();
  const rest = rects.filter(rect => rect.top >= top - 1).map(rect => rect.left);
  return [rects[0].left, ...(rest.length ? [Math.min(...rest)] : [])]
    .map(left => Math.round((left - code.getBoundingClientRect().left) / letter));
}"""

FORGETS = """@robot.program(rate=20)
def avoid(scan):
    if scan.distance() > 0:
        Drive(0.2)
    else:
        Drive(0, 1.0)
"""


def line(widget: Locator, number: int) -> Locator:
    return widget.locator(".rw-line").nth(number - 1)


def values(widget: Locator, number: int) -> Locator:
    return line(widget, number).locator(".rw-line-values")


def test_each_line_has_its_values_and_the_other_branch_is_not_reached(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN, AVOID], width=1000, scale=2)
    widget = nb.widget(0, 1)
    expect(widget.locator(".rw-title")).to_have_text("avoid")
    expect(values(widget, 3)).to_have_text(re.compile(r"^\d\.\d\d m\[\d+\]$"))
    expect(values(widget, 4)).to_have_text(re.compile(r"^left \d\.\d\d m, right \d\.\d\d m\[\d+\] \[\d+\]$"))
    expect(values(widget, 7)).to_have_text(re.compile(r"^True\d\.\d\d < 100\.00$"))
    expect(values(widget, 9)).to_have_text(re.compile(r"^Drive\("))
    expect(values(widget, 10)).to_have_text("not reached")
    expect(widget.locator(".rw-line-passes > span")).to_have_count(3)
    expect(widget.locator(".rw-line-passes > span").nth(1)).to_have_text(
        re.compile(r"^2: side 'left' \u00b7 away \d\.\d\d m$")
    )
    line(widget, 7).hover()
    expect(widget.locator(".rw-footer")).to_have_text(re.compile(r"^line 7 was true in .* steps?, reached in "))
    for theme in ("light", "dark"):
        nb.theme(theme)
        for width in (1000, 400):
            nb.resize(width)
            shoot(widget, f"gallery-lines-{theme}" if width == 1000 else f"lines-{width}-{theme}")
    nb.resize(1000)
    nb.python("robot.variables.near = 0.2")
    expect(values(widget, 9)).to_have_text("not reached")
    expect(values(widget, 10)).to_have_text("Drive(0.2)")


@pytest.mark.parametrize(("width", "rest"), [(400, 10), (848, 12)])
def test_the_rest_of_a_wrapped_line_is_indented_more_than_its_line(
    plain_page: Callable[..., PlainPage], width: int, rest: int
) -> None:
    nb = plain_page([OPEN, LONG], width=width, scale=2)
    widget = nb.widget(0, 1)
    expect(values(widget, 8)).to_have_text("Drive(0.2)")
    for theme in ("light", "dark"):
        nb.theme(theme)
        shoot(widget, f"lines-wrapped-{width}-{theme}")
    columns = [line(widget, number).locator(".rw-line-code").evaluate(COLUMNS) for number in (5, 7)]
    assert columns == [[0, rest], [0, rest]]


def test_details_become_shorter_before_indices_and_these_before_the_value(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN, LONG], width=848)
    widget = nb.widget(0, 1)
    expect(values(widget, 8)).to_have_text("Drive(0.2)")
    for number, text in ((5, ".rw-line-value"), (5, ".rw-line-index"), (7, ".rw-line-value")):
        value = line(widget, number).locator(text)
        assert value.evaluate("({ scrollWidth, clientWidth }) => scrollWidth - clientWidth") == 0


def test_a_frozen_picture_steps_through_single_steps_with_the_laser(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN, AVOID], width=760)
    laser, widget = nb.widget(0), nb.widget(0, 1)
    expect(values(widget, 7)).to_contain_text("True")
    facts = widget.locator(".rw-facts")
    expect(facts).to_contain_text(re.compile(r"step \d\d"))
    with nb.busy():
        widget.locator(".rw-freeze").click()
        expect(laser.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")

        def number() -> int:
            found = re.search(r"step (\d+)", facts.inner_text())
            assert found
            return int(found[1])

        first = number()
        widget.get_by_role("button", name="One step back (,)").click()
        expect(facts).to_contain_text(f"step {first - 1}")
        widget.locator(".rw-picture").press(",")
        expect(facts).to_contain_text(f"step {first - 2}")
        widget.locator(".rw-picture").press(".")
        expect(facts).to_contain_text(f"step {first - 1}")
    shoot(widget, "lines-frozen")


def test_a_pointed_line_lights_its_rays_in_the_laser(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN, AVOID], width=760, scale=2)
    laser, widget = nb.widget(0), nb.widget(0, 1)
    expect(values(widget, 7)).to_contain_text("True")
    widget.locator(".rw-freeze").click()
    nb.page.mouse.move(0, 0)  # the page scrolls to a line that gets the focus, and the pointer would be on another one

    def blue() -> int:
        nb.drawn()
        return Picture(laser).count((37, 99, 235))

    before = blue()
    line(widget, 3).focus()
    eventually(lambda: blue() > before + 20, True)
    shoot(laser, "lines-rays")
    line(widget, 10).focus()
    eventually(blue, before)
    line(widget, 4).hover()
    eventually(lambda: blue() > before + 20, True)
    widget.locator(".rw-title").hover()
    eventually(blue, before)


def test_arrows_walk_the_lines_and_one_line_is_left_of_a_folded_card(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN, AVOID], width=760)
    widget = nb.widget(0, 1)
    expect(values(widget, 7)).to_contain_text("True")
    line(widget, 1).focus()
    for _ in range(2):
        widget.page.keyboard.press("ArrowDown")
    expect(line(widget, 3)).to_be_focused()
    expect(widget.locator(".rw-footer")).to_have_text(re.compile(r"^line 3 was reached in "))
    widget.get_by_role("button", name="Show one line only").click()
    expect(widget.locator(".rw-picture")).to_be_hidden()
    expect(widget.locator(".rw-facts")).to_contain_text("line 9: Drive(")
    shoot(widget, "lines-folded")
    assert nb.python("lines.folded").strip() == "True"
    widget.get_by_role("button", name="Show the lines").press("Enter")
    expect(widget.locator(".rw-picture")).to_be_visible()


def test_a_step_without_return_says_that_its_speed_is_not_returned(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN, FORGETS], width=848, scale=2)
    widget = nb.widget(0, 1)
    expect(values(widget, 4)).to_have_text("Drive(0.2), not returned")
    shoot(widget, "lines-not-returned")
    widget.get_by_role("button", name="Show one line only").click()
    expect(widget.locator(".rw-facts")).to_contain_text("returned None, keeps its speed")
    shoot(widget, "lines-not-returned-folded")


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_failed_line_is_marked_with_its_error_and_the_values_before_it(
    plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]
) -> None:
    nb = plain_page([OPEN, FAILS], width=760, theme=theme, scale=2)
    widget = nb.widget(0, 1)
    expect(line(widget, 5)).to_have_attribute("data-state", "failed")
    expect(values(widget, 5)).to_contain_text("ZeroDivisionError: float division by zero")
    expect(values(widget, 4)).to_have_text("0")
    expect(widget.locator(".rw-facts")).to_contain_text("failed")
    shoot(widget, f"lines-failed-{theme}")


def test_text_stays_text_and_a_program_without_a_source_says_why(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN], width=760)
    widget = nb.widget(0, 1)
    nb.run(nb.append("@robot.program(rate=20)\ndef avoid(scan):\n    x = '<img src=x onerror=alert(1)>'\n"))
    expect(values(widget, 3)).to_have_text("'<img src=x onerror=alert(1)>'")
    expect(widget.locator("img")).to_have_count(0)
    nb.python("exec('def hidden(scan):\\n    return None\\n'); robot.program(hidden, rate=20)")
    expect(widget.locator(".rw-lines-why")).to_have_text(
        "hidden runs as it is, and shows no values: its source is not known."
    )

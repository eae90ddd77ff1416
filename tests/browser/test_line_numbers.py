"""A number in a line is dragged, its effect is shown, it drives, is taken back, and goes into a cell of JupyterLab."""

from __future__ import annotations

import re
from collections.abc import Callable

from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import shoot
from .notebook import Notebook

OPEN = """
from robowidgets import LinesWidget, feeds
from robowidgets.behaviors import Drive
from robowidgets.simulator import World
# So small that the last ten seconds of a drive always contain both branches, and distances from 0.6 to 1.2 m.
small = World.from_text("######\\n#....#\\n#.>..#\\n#....#\\n######")
robot = feeds.simulator(room=small, wander=False, hz=20)
lines = LinesWidget(robot)
lines
"""
AVOID = """@robot.program(rate=20)
def avoid(scan):
    front = scan.distance("front")
    if front < 0.6:  # too near
        return Drive(0, 0.8)  # always to one side, so that it leaves every corner
    return Drive(0.2)
"""


def literal(widget: Locator, text: str) -> Locator:
    return widget.locator(".rw-line-literal").get_by_text(text, exact=True)


def source(nb: Notebook, index: int) -> str:
    return str(nb.page.evaluate("(i) => document.querySelectorAll('.cm-content')[i].innerText", index))


def test_a_number_is_dragged_drives_is_taken_back_and_goes_into_its_cell(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([OPEN, AVOID], scale=2)
    nb.resize(1000, 1200)
    nb.run_all()
    widget = nb.widget(0)
    speed, mouse, keys = literal(widget, "0.2"), nb.page.mouse, nb.page.keyboard
    change, words = widget.locator(".rw-line-change"), widget.locator(".rw-line-change-words")
    version = widget.locator(".rw-facts")
    expect(speed).to_have_attribute("role", "spinbutton")
    wait_for(lambda: int(nb.python("robot.programs.current.steps")) > 60, "some steps are made")

    # Held, the number is only tried.
    box = speed.bounding_box()
    assert box is not None
    mouse.move(box["x"] + 4, box["y"] + 8)
    mouse.down()
    for x in range(10, 80, 10):
        mouse.move(box["x"] + x, box["y"] + 8)
    expect(words).to_have_text(re.compile(r"^another speed in \d+ of \d+ steps of the last \d+\.\d s$"))
    expect(change.locator("figcaption").first).to_have_text(
        re.compile(r"^forward, m/s: thin with 0\.\d+, wide with 0\.2$")
    )
    expect(version).to_contain_text("v1")
    shoot(widget, "lines-number-held")

    # Escape takes it back, and letting go then changes nothing.
    keys.press("Escape")
    mouse.up()
    expect(change).to_be_hidden()
    expect(literal(widget, "0.2")).to_be_focused()

    # Let go, it drives.
    mouse.move(box["x"] + 4, box["y"] + 8)
    mouse.down()
    mouse.move(box["x"] + 64, box["y"] + 8)
    mouse.up()
    expect(version).to_contain_text("v2")
    expect(words).to_have_text("0.3 drives, as version 2")
    expect(literal(widget, "0.3")).to_be_focused()
    assert nb.python("robot.programs.current.version.text").count("Drive(0.3)") == 1
    expect(widget.locator(".rw-lines-cell")).to_contain_text("line 6: not as in the cell")
    expect(widget.locator(".rw-lines-compared > summary")).to_have_text(
        re.compile(r"^version 2 and version 1 differ \d+ times|once, in \d+ of \d+ steps of the last ")
    )
    for theme in ("light", "dark"):
        nb.theme(theme)
        for width in (1000, 400):
            nb.resize(width, 1200)
            shoot(widget, f"lines-number-{width}-{theme}")
    nb.resize(1000, 1200)

    # The cell gets the line, and no other cell changes.
    widget.get_by_role("button", name="Put into the cell").click()
    assert source(nb, 1).rstrip() == AVOID.replace("Drive(0.2)", "Drive(0.3)").rstrip()
    assert source(nb, 0).strip() == OPEN.strip()
    expect(widget.locator(".rw-lines-cell")).to_contain_text("in the cell now")
    expect(widget.get_by_role("button", name="Put into the cell")).to_be_disabled()

    # Part of the steps would have been others.
    literal(widget, "0.6").focus()
    for _ in range(6):
        keys.press("PageUp")
    expect(change.locator("figcaption")).to_have_count(2)
    widget.locator(".rw-lines-compared > summary").click()
    for theme, width in (("light", 1200), ("dark", 700), ("light", 400)):
        nb.theme(theme)
        nb.resize(width, 1200)
        shoot(widget, f"lines-number-tried-{width}-{theme}")
    nb.resize(1000, 1200)
    literal(widget, "1.2").focus()
    keys.press("Escape")
    expect(change).to_be_hidden()
    expect(literal(widget, "0.6")).to_be_focused()

    # By keys: arrows try, Enter lets it drive, Escape takes it back.
    literal(widget, "0.3").focus()
    for _ in range(3):
        keys.press("ArrowUp")
    expect(literal(widget, "0.33")).to_be_focused()
    expect(literal(widget, "0.33")).to_have_attribute("aria-valuetext", "0.33")
    expect(words).to_contain_text("another speed in")
    keys.press("Enter")
    expect(words).to_have_text("0.33 drives, as version 3")
    keys.press("Escape")
    expect(words).to_have_text("0.3 is back, as version 4")
    expect(literal(widget, "0.3")).to_be_focused()
    expect(widget.locator(".rw-lines-cell")).to_contain_text("in the cell now")
    keys.press("Escape")
    expect(change).to_be_hidden()

    # Stopped, it moves nothing.
    nb.python("robot.stopped = True")
    literal(widget, "0.3").click()
    widget.get_by_role("slider", name="number in avoid").focus()
    keys.press("ArrowLeft")
    keys.press("Enter")
    expect(words).to_have_text("0.29 is in version 5; Stop is pressed")
    expect(version).to_have_text("v5 · no step yet")
    expect(literal(widget, "0.29")).to_be_visible()
    keys.press("ArrowLeft")
    keys.press("Enter")
    expect(words).to_have_text("0.28 is in version 6; Stop is pressed")
    assert nb.python("robot.stopped").strip() == "True"
    shoot(widget, "lines-number-stopped")

"""A program on the page: its actions, variables, prints and error, and the buttons Run, Step and Stop."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from typing import Literal

import pytest
from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import LOOKS, PICTURES, SCREENSHOTS, shoot
from .notebook import CellError, Notebook
from .plain_page import PlainPage

OPEN = """
from robowidgets import ProgramWidget, feeds
from robowidgets.behaviors import Drive
robot = feeds.simulator(wander=False, hz=20)
robot.variables.slider("f_vel", 0.25, 0.0, 0.5, "m/s")
robot.variables.slider("near", 0.55, 0.2, 2.0, "m")
robot.variables.go = True
robot.variables.turns = 3
widget = ProgramWidget(robot)
widget
"""
LISTEN = """
import time
heard, log = [], ""
publish = robot.connection.middleware.publish
def record(topic, kind, message):
    publish(topic, kind, message)
    heard.append((time.time(), message["linear"]["x"]))
    if log:
        print(*heard[-1], file=open(log, "a"))
robot.connection.middleware.publish = record
"""
AVOID = """
@robot.program(rate=20)
def avoid(scan, state, variables):
    state.n = state.get("n", 0) + 1
    if state.n % 5 == 0 and state.n < 40:
        print(f"near {scan.distance('front'):.2f} m [{state.n}] <b>&amp;</b>")
    return Drive(variables.f_vel if variables.go else 0, -0.3)
"""
FAILS = """
@robot.program(rate=20)
def avoid(scan):
    return Drive(0.1 / 0)
"""
MACHINE = """
@robot.program(rate=20)
class walker:
    def forward(): return Drive(0.2)
    class avoid:
        def stop(): return Drive()
        def turn(): return Drive(0, 0.5)
        moves = "stop -> turn after 0.4", "turn -> stop after 0.4"
    moves = "forward -> avoid after 0.1"
"""


def button(widget: Locator, name: str) -> Locator:
    return widget.get_by_role("button", name=name, exact=True)


@pytest.mark.core
def test_a_program_is_seen_set_stopped_run_and_replaced(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN, AVOID, FAILS, MACHINE])
    widget = nb.widget(0)

    def told(expression: str) -> str:
        return nb.python(f"print({expression})").strip()

    expect(widget.locator(".rw-title")).to_have_text("walker")
    expect(widget.locator(".rw-program-active")).to_contain_text("avoid › ")
    nb.run(1)
    expect(widget.locator(".rw-title")).to_have_text("avoid")
    expect(widget.locator(".rw-program-code")).to_have_text("Drive(0.25, -0.3)")
    # A turn to the right: its bar goes right.
    expect(widget.locator(".rw-readout-bar").nth(1)).to_have_attribute("style", re.compile("^left: 50%; width: [1-9]"))
    expect(widget.locator(".rw-print-text").first).to_contain_text("<b>&amp;</b>")
    shoot(widget.locator(".rw-program"), "program-running")

    slider = widget.get_by_role("slider", name="f_vel")
    slider.focus()
    slider.press("End")
    expect(widget.locator(".rw-program-code")).to_have_text("Drive(0.5, -0.3)")
    widget.get_by_role("switch", name="go").uncheck()
    expect(widget.locator(".rw-program-code")).to_have_text("Drive(0.0, -0.3)")
    turns = widget.get_by_role("spinbutton", name="turns")
    turns.press("ControlOrMeta+a")
    turns.press_sequentially("7")
    turns.press("Enter")
    wait_for(lambda: told("robot.variables.turns, robot.variables.go") == "7 False", "they are set")
    expect(turns).to_have_value("7")
    turns.press("ControlOrMeta+a")
    turns.press("Delete")
    turns.press("Enter")
    expect(turns).to_have_value("7")
    nb.python("robot.variables.turns = float('inf')")
    expect(widget.locator(".rw-variable-value").last).to_have_text("inf")
    nb.python("robot.variables.turns = 3")

    slider.press("Escape")
    expect(widget.locator(".rw-program-mode")).to_have_text("stopped")
    expect(widget.locator(".rw-stop-word")).to_have_text("Stopped")
    expect(widget.locator(".rw-program-code")).to_have_text("Drive(0.0, 0.0)")
    shoot(widget.locator(".rw-program"), "program-stopped")
    assert told("robot.stopped") == "True"
    button(widget, "Run, and let programs drive").click()
    expect(widget.locator(".rw-program-mode")).to_have_text("running")
    button(widget, "Pause, and stop the robot").click()
    expect(widget.locator(".rw-program-mode")).to_have_text("paused")
    steps = int(told("avoid.steps"))
    button(widget, "Make one step").click()
    wait_for(lambda: int(told("avoid.steps")) == steps + 1, "one step is made")

    expect(widget.locator(".rw-program-kept dt")).to_have_text(["n"])
    wait_for(lambda: int(widget.locator(".rw-program-kept dd").inner_text()) > 5, "its number is shown")
    nb.python("avoid.state.n = 1000")
    button(widget, "Restart from the beginning, with an empty state, and let programs drive").click()
    expect(widget.locator(".rw-program-mode")).to_have_text("running")
    expect(widget.locator(".rw-program-kept dd")).to_have_text(re.compile(r"^\d{1,3}$"))

    nb.run(2)
    expect(widget.locator(".rw-prints")).to_have_text("line 4: ZeroDivisionError: float division by zero")
    expect(widget.locator(".rw-program-mode")).to_have_text("failed")
    assert told("robot.watchdog.sent == (0, 0, 0)") == "True"
    shoot(widget.locator(".rw-program"), "program-failed")
    stop = widget.locator(".rw-stop").bounding_box()
    card = widget.locator(".rw-program").bounding_box()
    assert stop
    assert card
    assert stop["height"] >= 42
    assert stop["width"] >= card["width"] - 28
    nb.python("robot.close()")


def test_during_a_busy_cell_it_steps_and_stops(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([OPEN, f"{LISTEN}{AVOID}"])
    widget = nb.widget(0)
    stopped = nb.lab.files / f"{nb.path}-stopped"
    nb.python(f"log = {str(stopped)!r}")
    busy = nb.append("steps, n = avoid.steps, 0\nwhile True: n += 1")
    nb.start(busy)
    slider = widget.get_by_role("slider", name="f_vel")
    slider.focus()
    slider.press("End")
    expect(widget.locator(".rw-program-code")).to_have_text("Drive(0.5, -0.3)")  # set, and stepped, while the cell runs
    slider.press("Escape")
    expect(widget.locator(".rw-stop-word")).to_have_text("Stopped")
    wait_for(lambda: stopped.read_text().endswith(" 0.0\n"), "zero is sent while the cell is busy")
    nb.lab.interrupt(nb.path)
    # Stop itself interrupts a kernel that answers late; the second interrupt may cut the traceback of the first.
    with suppress(CellError):
        nb.wait(busy)
    assert "KeyboardInterrupt" in str(nb.outputs(busy))
    assert eval(nb.python("avoid.steps - steps")) > 1


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_program_looks_well_on_a_narrow_page(
    plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"], scale: int
) -> None:
    nb = plain_page([OPEN, AVOID], width=400, scale=scale, theme=theme)
    widget = nb.widget(0)
    expect(widget.locator(".rw-program-code")).to_have_text("Drive(0.25, -0.3)")
    expect(widget.locator(".rw-print-text")).to_have_count(3)
    assert widget.locator(".rw-program").evaluate("card => card.scrollWidth <= card.clientWidth")
    shoot(widget.locator(".rw-program"), f"program-narrow-{theme}")
    near = widget.get_by_role("slider", name="near")
    near.focus()
    near.press("End")
    wait_for(lambda: nb.python("print(robot.variables.near)").strip() == "2.0", "it is set")
    nb.run(1)
    expect(widget.locator(".rw-version")).to_have_text("v2")
    tick = widget.locator(".rw-variable-tick:not([hidden])").nth(1)
    share = "tick => tick.offsetLeft / tick.parentElement.offsetWidth"
    wait_for(lambda: tick.evaluate(share) > 0.9, "the tick stands where the version before ended")
    near.press("Home")
    nb.page.set_viewport_size({"width": 400, "height": 320})
    widget.locator(".rw-prints").scroll_into_view_if_needed()
    expect(widget.locator(".rw-stop")).to_be_in_viewport(ratio=1)
    if PICTURES:
        nb.page.screenshot(path=SCREENSHOTS / f"program-scrolled-{theme}@{scale}x.png")
    nb.python("robot.close()")

"""A robot, its program and its room in JupyterLab, while a cell runs."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .laser import eventually
from .notebook import CellError, Notebook

SHOW = """
import time
from robowidgets import feeds
from robowidgets.behaviors import Drive
from robowidgets.simulator import World
room = World([(-3, -2, 3, -2), (3, -2, 3, 2), (3, 2, -3, 2), (-3, 2, -3, -2)], [(1.5, 1.0, 0.3)])
robot = feeds.simulator(room=room, hz=20, wander=False)
view = robot.show()
display(view)

@robot.program(rate=20)
class Walker:
    def stand():
        return Drive()
    def look(scan):
        return Drive()
    def turn(scan):
        return Drive(0, 0.1)
    moves = "stand -> look after 0.3", "look -> turn after 0.3"
"""
BUSY = """
while not (robot.robot.pose.x < -1.0 and robot.robot.world.obstacles[0][0] > 1.9):
    time.sleep(0.01)
print("both are moved")
while True:
    time.sleep(0.01)
"""
ARRIVED = """
from robowidgets.widget.timed_frame import FRAME_HEADER
frozen = [view.widgets[topic].get_state("_frozen_frame")["_frozen_frame"] for topic in ("/scan", "/odom")]
print(*(FRAME_HEADER.unpack_from(frame)[3] for frame in frozen))
"""


@pytest.mark.core
def test_a_robot_is_moved_and_its_widgets_freeze_and_step_to_one_moment_while_a_cell_runs(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([SHOW])
    shown, room = nb.output(0), nb.output(0).locator(".rw-simulator")
    machine = shown.locator(".rw-machine")
    expect(machine.locator(".rw-machine-state", has_text="turn")).to_have_attribute("data-active", "leaf")
    expect(shown.locator(".rw-program .rw-title")).to_have_text("Walker")
    busy = nb.append(BUSY)
    nb.start(busy)

    machine.locator(".rw-fired-row").last.click()
    for card in (machine, shown.locator(".rw-laser"), shown.locator(".rw-speed")):
        expect(card.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
    expect(shown.locator(".rw-program .rw-program-mode")).to_have_text("running")
    expect(machine.locator(".rw-machine-state", has_text="look")).to_have_attribute("data-active", "leaf")
    freeze = shown.locator(".rw-freeze-all")
    expect(freeze).to_have_attribute("aria-pressed", "true")
    freeze.click()
    expect(shown.locator(".rw-laser .rw-freeze")).to_have_attribute("aria-pressed", "false")

    room.scroll_into_view_if_needed()
    box = room.locator(".rw-picture").bounding_box()
    assert box
    scale = min((box["width"] - 24) / 6, (box["height"] - 40) / 4)
    middle = (box["x"] + box["width"] / 2, box["y"] + 12 + (box["height"] - 40) / 2)
    for start, end in (((0.0, 0.0), (-1.5, 0.5)), ((1.5, 1.0), (2.2, -1.0))):
        nb.page.mouse.move(middle[0] + start[0] * scale, middle[1] - start[1] * scale)
        nb.page.mouse.down()
        nb.page.mouse.move(middle[0] + end[0] * scale, middle[1] - end[1] * scale, steps=4)
        nb.page.mouse.up()
    expect(room.locator(".rw-footer")).to_contain_text("x \u22121.50 y 0.50 m")
    eventually(lambda: nb.output(busy).inner_text().strip(), "both are moved")

    buttons, laser = shown.locator(".rw-freeze"), shown.locator(".rw-laser")
    expect(buttons.nth(3)).to_be_attached()
    freeze.click()
    for button in buttons.all():
        expect(button).to_have_attribute("aria-pressed", "true")
    for _ in range(5):
        laser.locator("> .rw-picture").press(",")
    expect(laser.locator(".rw-time b")).to_contain_text("\u2212")

    nb.interrupt()
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(busy)
    expect(shown.locator(".rw-program .rw-program-mode")).to_have_text("paused")

    def is_one_moment() -> bool:
        scan, speed = (float(one) for one in nb.python(ARRIVED).split())
        return scan - 0.3 < speed <= scan

    # The page sends what each widget holds to Python at its own pace.
    eventually(is_one_moment, True)
    freeze.click()
    for button in buttons.all():
        expect(button).to_have_attribute("aria-pressed", "false")

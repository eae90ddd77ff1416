"""Numbers that a program plots, below the laser and on its time axis."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import LOOKS, shoot
from .laser import eventually
from .plain_page import PlainPage

PLOT = """
import time
from math import sin
from robowidgets import LaserWidget
from robowidgets.simulator import Robot, World, wander
robot = Robot(World.rooms(), seed=1)
laser = LaserWidget(title="/scan")
steps = wander(robot)
def drive(seconds):
    began = time.monotonic()
    while time.monotonic() - began < seconds:
        next(steps)
        robot.step(0.1)
        laser.update(robot.scan())
        laser.watch("ahead", robot.scan().distance("front"))
        laser.watch("turn", sin(robot.time))
        time.sleep(0.05)
laser
"""
# Pixels in the colour of drawn numbers.
OWN = """(root) => {
  const canvas = root.querySelector("canvas");
  const hex = getComputedStyle(root).getPropertyValue("--rw-own").trim();
  const rgb = [1, 3, 5].map((i) => Number.parseInt(hex.slice(i, i + 2), 16));
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (rgb.every((c, k) => Math.abs(c - data[i + k]) < 24)) count++;
  return count;
}"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_numbers_are_plotted_below_the_laser_and_freeze_with_it(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([PLOT], theme=theme, scale=scale)
    card = nb.widget(0).locator(".rw-card")
    lines = card.locator(".rw-over-time")
    nb.python("robot.step(0.1); laser.update(robot.scan())")
    expect(card.locator(".rw-footer")).to_contain_text("readings")
    expect(lines).to_have_count(0)
    nb.python("drive(4)")
    expect(lines).to_have_attribute("aria-label", "the last 10 s of ahead, turn")
    for width in (700, 400):
        nb.resize(width)
        shoot(card, f"numbers-{theme}-{width}")
    nb.resize(700)
    eventually(lambda: lines.evaluate(OWN) > 100, True)
    card.locator(".rw-freeze").click()
    # A picture that is stepped back has the numbers up to its scan.
    before = lines.evaluate(OWN)
    card.locator(".rw-picture").focus()
    for _ in range(40):
        nb.page.keyboard.press(",")
    expect(card.locator(".rw-time")).to_contain_text("from newest")
    eventually(lambda: lines.evaluate(OWN) < before, True)
    box = lines.bounding_box()
    assert box
    nb.page.mouse.move(box["x"] + box["width"] * 0.8, box["y"] + 30)
    shoot(card, f"numbers-{theme}-pointed")
    nb.python("laser.paused = False; laser.unwatch('ahead'); laser.unwatch('turn')")
    expect(lines).to_be_hidden()

"""The last seconds of each axis below the bars of a speed widget."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import LOOKS, shoot
from .plain_page import PlainPage

SPEED = """
import time
from math import sin
import robowidgets
speed = robowidgets.SpeedWidget(
    title="/odom", command_title="/cmd_vel", planar=True, linear_limits=(-0.5, 0.5), angular_limits=(-1, 1)
)
def drive(seconds, start=0.0):
    began = time.monotonic()
    while (now := time.monotonic() - began) < seconds:
        t = start + now
        speed.command(linear=(0.6 if int(t) % 2 else 0.2, 0, 0), angular=(0, 0, 0.5 * sin(t)))
        speed.update(linear=(0.4 + 0.2 * sin(2 * t), 0, 0), angular=(0, 0, 0.9 * sin(t)))
        time.sleep(0.05)
speed
"""

# Pixels in the colours of the measured line, of the part past a limit, and of the command.
COLOURS = """(root) => {
  const canvas = root.querySelector("canvas");
  const style = getComputedStyle(root);
  const counts = { pointer: 0, reading: 0, ink: 0 };
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  for (const name of Object.keys(counts)) {
    const hex = style.getPropertyValue(`--rw-${name}`).trim();
    const rgb = [1, 3, 5].map((i) => Number.parseInt(hex.slice(i, i + 2), 16));
    for (let i = 0; i < data.length; i += 4) if (rgb.every((c, k) => Math.abs(c - data[i + k]) < 8)) counts[name]++;
  }
  return counts;
}"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_the_last_seconds_of_each_axis_are_drawn_below_the_bars_when_asked_for(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([SPEED], theme=theme, scale=scale)
    card = nb.widget(0).locator(".rw-card")
    nb.resize(700)
    lines = card.locator(".rw-over-time")
    expect(lines).to_have_count(0)
    card.get_by_role("button", name="Over time").click()
    expect(lines).to_have_attribute("aria-label", "the last 10 s of linear.x, linear.y, angular.z")
    assert nb.python("print(speed.over_time)").strip() == "10.0"
    nb.python("drive(6)")
    card.locator(".rw-freeze").click()
    for width in (700, 400, 320):
        nb.resize(width)
        shoot(card, f"speed-over-time-{theme}-{width}")
    nb.resize(700)
    box = lines.bounding_box()
    assert box
    card.page.mouse.move(box["x"] + box["width"] * 0.7, box["y"] + 30)
    shoot(card, f"speed-over-time-{theme}-pointed")
    colours = lines.evaluate(COLOURS)
    assert min(colours.values()) > 20, colours
    nb.python("speed.over_time = 0")
    expect(lines).to_be_hidden()

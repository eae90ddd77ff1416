"""The ghost: a scan in the background to compare with the live one."""

from __future__ import annotations

from collections.abc import Callable
from math import hypot

import pytest
from playwright.sync_api import expect

from .chromium import LOOKS, shoot
from .laser import LIGHT, SETUP, Picture, listen, locate, words
from .plain_page import PlainPage

GRAY = (127, 139, 153)

ROBOT = """
import time
from robowidgets import LaserWidget, conditions
from robowidgets.simulator import Robot, World, wander
robot = Robot(World.rooms(), seed=1)
laser = LaserWidget(title="/scan")
def drive(until):
    for _ in wander(robot):
        robot.step(0.1)
        laser.update(robot.scan())
        time.sleep(0.03)
        if robot.time > until:
            break
drive(5)
laser
"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_look(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([ROBOT, "laser.ghost = laser.scan\ndrive(6.5)"], scale=scale, theme=theme)
    card = nb.widget(0).locator(".rw-card")
    for width in (320, 400, 700):
        nb.resize(width)
        shoot(card, f"ghost-{theme}-{width}")


def test_stays_and_is_compared(plain_page: Callable[..., PlainPage]) -> None:
    setup = SETUP + "other = LaserWidget(title='/filtered')\nlaser.update(**fan())\nlaser"
    nb = plain_page([setup], width=900)
    nb.resize(700)
    card, pin = nb.widget(0).locator(".rw-card"), nb.widget(0).locator(".rw-pin")
    listen(nb.page)
    expect(card.locator(".rw-strip")).to_have_count(0)
    place = locate(card)
    expect(pin).to_be_hidden()
    card.locator(".rw-picture").press("g")
    expect(pin).to_have_attribute("aria-pressed", "true")
    expect(card.locator(".rw-strip")).to_be_visible()
    nb.python("laser.update(**fan({9: 0.9}))")
    was, now = place.at(1.68, 0), place.at(0.9, 0)

    def shown() -> tuple[bool, bool]:
        picture = Picture(card)
        is_gray = any(hypot(x - was[0], y - was[1]) < 1 for x, y in picture.dots(GRAY))
        return is_gray, picture.colour(*now) == LIGHT["reading"]

    nb.page.wait_for_function("() => document.querySelector('.rw-nearest').textContent.includes('0.90')")
    assert shown() == (True, True), "the pinned reading is gray, under the live one"
    assert "\u22120.78 m at [9]" in words(card), "and the largest difference is named"
    assert nb.python("print((laser.scan - laser.ghost)[9].round(2), laser.ghost.nearest().range)").split() == [
        "-0.78",
        "1.52",
    ]

    # Three scans ago, from the history of the page.
    nb.python("from robowidgets.widget.pacer import pacer")
    for metres in (1.0, 1.1, 1.2, 1.3):
        nb.python(f"laser.update(**fan({{9: {metres}}})); pacer.flush()")
    nb.python("laser.ghost = 3; pacer.flush()")
    expect_words(nb, "+0.30 m at [9]")
    # Another widget and its next scans.
    nb.python("other.update(**fan({9: 0.8})); laser.ghost = other; pacer.flush()")
    expect_words(nb, "+0.50 m at [9]")
    assert "/filtered" in words(card)
    nb.python("other.update(**fan({9: 1.2})); pacer.flush()")
    expect_words(nb, "+0.10 m at [9]")
    card.locator(".rw-picture").press("g")
    expect(pin).to_have_attribute("aria-pressed", "false")
    expect(card.locator(".rw-strip")).to_have_count(0)
    assert nb.python("print(laser.ghost)").strip() == "None"


def expect_words(nb: PlainPage, text: str) -> None:
    """Wait until a text stands in the index view."""
    nb.page.wait_for_function(
        "(text) => [...document.querySelectorAll('.rw-layer')].some((layer) => layer.words?.includes(text))", arg=text
    )

"""Shapes that programs draw on a scan, on a page."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import SETUP, Picture, eventually, listen, locate, words
from .plain_page import PlainPage

OWN = {"light": (124, 58, 237), "dark": (183, 156, 255)}
FIRST = f"{SETUP}\nfrom robowidgets import *\nlaser.update(**fan())\nlaser.draw('wall', Line((1, -1), (1, 1)))\nlaser"


def drawn(card: Locator, theme: str = "light") -> int:
    """Pixels in the colour of drawn shapes."""
    return Picture(card).count(OWN[theme])


def test_a_shape_stands_where_it_was_drawn_with_its_name_and_numbers(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST], run=False)
    listen(nb.page)
    nb.run_all()
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    place = locate(card)
    eventually(lambda: {"wall", "1.00 m · 90.0°"} <= words(card), True)
    for y in (-0.9, 0.1, 0.9):
        assert OWN["light"] in Picture(card).around(*place.at(np.hypot(1, y), np.degrees(np.arctan2(y, 1))))
    nb.python("laser.draw('wall', Line((2.5, -1), (2.5, 1)), color='#12854a')")
    eventually(lambda: (drawn(card), Picture(card).count((18, 133, 74)) > 100), (0, True))
    nb.python("laser.draw('wall', None)")
    eventually(lambda: Picture(card).count((18, 133, 74)), 0)
    assert not {"wall", "1.00 m · 90.0°"} & words(card)
    nb.python("laser.draw('ray', Line((0, 0), 9))")
    eventually(lambda: OWN["light"] in Picture(card).around(*place.at(1.2, 0)), True)
    nb.python("laser.update(**fan({9: nan}))")
    eventually(lambda: drawn(card), 0)


def test_a_shape_goes_at_its_time_in_the_page_and_stays_on_a_frozen_picture(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([FIRST])
    card = nb.widget(0).locator(".rw-card")
    eventually(lambda: drawn(card) > 100, True)
    nb.python("laser.draw('wall', None); laser.draw('brief', Line((1, -1), (1, 1)), lifetime=0.4)")
    eventually(lambda: drawn(card) > 100, True)
    # The kernel is silent from here on.
    nb.python("from robowidgets.widget.pacer import pacer; pacer.forget(laser._expiry)")
    eventually(lambda: drawn(card), 0)
    nb.python("laser.update(**fan()); laser.draw('frozen', Line((1, -1), (1, 1)), lifetime=5)")
    eventually(lambda: drawn(card) > 100, True)
    card.locator(".rw-freeze").click()
    nb.python("laser.update(**fan()); laser.draw('frozen', None)")  # of the next scan, not of the frozen one
    expect(card.locator(".rw-number")).to_have_text("1")
    assert drawn(card) > 100, "it was drawn on the scan that is on show"
    card.locator(".rw-freeze").click()
    eventually(lambda: drawn(card), 0)


ALL = """
import robowidgets
from robowidgets import *
laser = LaserWidget(title="/scan", view_range=3.5)
robot = robowidgets.simulator.Robot(
    robowidgets.simulator.World.rooms(), (0.2, -0.85, 0.5), scanner=robowidgets.simulator.Scanner(ray_count=1040)
)
laser.update(robot.scan())
scan = laser.scan
laser.draw("left wall", Line(scan.at("90deg"), scan.at("112deg")))
laser.draw("target", Arrow((1.5, 0.8), "35deg"))
laser.draw("stop zone", Arc(0.5, "-60deg", "60deg"))
laser.draw("box", Polygon([(0.8, -0.3), (1.4, -0.3), (1.4, 0.3), (0.8, 0.3)]))
laser.draw("corners", Points([scan.at("20deg"), scan.at("30deg")]))
laser.draw("door", Text((2.2, -1.2), "door?"))
laser
"""


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_all_shapes(plain_page: Callable[..., PlainPage], theme: str) -> None:
    nb = plain_page([ALL], scale=2, theme=theme, run=False)
    listen(nb.page)
    nb.run_all()
    card = nb.widget(0).locator(".rw-card")
    for width in (400, 700):
        nb.resize(width)
        eventually(lambda: {"left wall", "target", "stop zone", "door?"} <= words(card), True)
        assert drawn(card, theme) > 500
        shoot(card, f"shapes-{theme}-{width}")

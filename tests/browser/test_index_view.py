"""The index view: distance over index below the picture, linked to it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import SETUP
from .plain_page import PlainPage

ROBOT = """
import robowidgets
from robowidgets import LaserWidget, conditions
from robowidgets.simulator import Robot, World, wander
robot = Robot(World.rooms(), seed=1)
laser = LaserWidget(title="/scan", index_view=True)
for _ in wander(robot):
    robot.step(0.1)
    if robot.time > 9:
        break
laser.watch(lambda scan: scan.distance("front") < 0.9, name="wall")
laser.update(robot.scan())
laser
"""


def test_it_stands_whole_below_the_picture_of_any_scan(plain_page: Callable[..., PlainPage], data: Path) -> None:
    nb = plain_page([ROBOT], scale=2)
    nb.python("laser.pinned = 300")
    card = nb.widget(0).locator(".rw-card")
    for theme, width in (("light", 320), ("light", 700), ("dark", 400)):
        nb.theme(theme)
        nb.resize(width)
        is_whole(card)
        shoot(card, f"index-{theme}-{width}")
    for file in ("hokuyo_people.bag", "turtlebot3_gazebo.bag"):
        nb.python(f"laser.update(next(robowidgets.open({str(data / 'good' / file)!r}).samples('/scan')).sample)")
        is_whole(card)
        shoot(card, f"index-{file.split('.')[0]}")


def is_whole(card: Locator) -> None:
    """The index view has the width of the picture, and stands below it."""
    picture, strip = (card.locator(f".rw-{part}").bounding_box() for part in ("picture", "strip"))
    assert picture
    assert strip
    assert (strip["x"], strip["width"]) == (picture["x"], picture["width"])
    assert strip["y"] >= picture["y"] + picture["height"]


def test_points_at_the_ray_that_the_picture_names(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP + "laser.index_view = True\nlaser.update(**fan({4: inf, 5: nan}))\nlaser"])
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    strip, popup = card.locator(".rw-strip"), card.locator(".rw-popup:visible")
    expect(strip).to_have_attribute("aria-label", "distance over index, [0] to [18]")
    box = strip.bounding_box()
    assert box is not None
    assert box["height"] == 150

    def at(index: int, part: float = 0.5) -> dict[str, float]:
        """A place over a ray, at a part of the height."""
        return {"x": 46 + (index + 0.5) / 19 * (700 - 2 - 46 - 22), "y": 24 + part * 90}

    for index, said in ((12, "ranges[12]"), (0, "ranges[0]"), (18, "ranges[18]"), (4, "ranges[4]"), (5, "ranges[5]")):
        strip.hover(position=at(index))
        expect(popup).to_contain_text(said)
    assert nb.python("print(laser.hovered)").strip() == "5"
    strip.click(position=at(7, 0.97))
    strip.hover(position=at(3, 0.02))
    expect(popup).to_have_count(2)
    assert nb.python("print(laser.pinned, laser.hovered)").split() == ["7", "3"]
    card.locator(".rw-header").hover()
    expect(popup).to_have_count(1)

    nb.python("laser.index_view = False")
    expect(strip).to_have_count(0)
    nb.python("laser.index_view = True")
    expect(strip).to_be_visible()
    card.locator(".rw-picture").press("Escape")
    expect(popup).to_have_count(0)

"""The robot to scale on the laser, with its bumpers and its speed."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import PICTURES, shoot
from .laser import LIGHT, SETUP, Picture, eventually, listen, locate, words
from .plain_page import PlainPage

GREEN = (18, 133, 74)
VIEW = f"""
{SETUP}
from robowidgets import Footprint, SpeedWidget, TouchWidget, screen
laser.update(**fan(angle_min=-3.0, angle_increment=1 / 3))  # all round: its picture has room behind the robot
speed, touch = SpeedWidget(title="/odom"), TouchWidget(title="/bumper")
screen(laser, speed, touch)
display(laser, speed, touch)
"""
BODY = 'Footprint(radius=0.5, bumpers={"left": ("15deg", "80deg"), "right": ("-80deg", "-15deg")})'


def test_the_robot_stands_to_scale_with_its_bumpers_and_its_speed(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([VIEW])
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    expect(card).to_contain_text("19")
    nb.python("laser.update(**fan())")
    place = locate(card)
    listen(nb.page)
    behind = place.at(0.5, 180)
    plain = Picture(card).colour(*behind)
    nb.python(f"laser.footprint = {BODY}; speed.update(linear=(0.4, 0, 0), angular=(0, 0, 0)); touch.update(left=1)")
    left, ahead = place.at(0.5 + 4 / place.scale, 47), place.at(0.5 + 0.4, 0)
    eventually(lambda: Picture(card).colour(*left), GREEN)
    assert GREEN not in Picture(card).around(*place.at(0.5 + 4 / place.scale, -47)), "the right one is free"
    eventually(lambda: LIGHT["ink"] in Picture(card).around(*ahead), True)
    assert LIGHT["ink"] not in Picture(card).around(*place.at(0.5 + 0.95, 0)), "0.8 m in two seconds"
    assert "0.40 m/s" in words(card)
    assert min(Picture(card).around(*behind)) < (100, 100, 100) < plain, "its outline, on no whole pixel"
    shoot(card, "footprint")
    # Frozen together, it keeps the moment.
    nb.python("laser.paused = True; touch.update(left=0); speed.update(linear=(0, 0, 0), angular=(0, 0, 0))")
    expect(card.locator(".rw-freeze").first).to_have_attribute("aria-pressed", "true")
    eventually(lambda: Picture(card).colour(*left), GREEN)
    nb.python("laser.paused = False")
    eventually(lambda: GREEN in Picture(card).around(*left), False)
    nb.python("laser.footprint = None")
    eventually(lambda: Picture(card).around(*behind), {plain})


ROBOT = """
import time
from robowidgets import Footprint, LaserWidget, SpeedWidget, TouchWidget
from robowidgets.simulator import Robot, World, wander
robot = Robot(World.rooms(), seed=1)
laser, speed, touch = LaserWidget(title="/scan", free_space=True), SpeedWidget(), TouchWidget()
bumpers = {"left": ("15deg", "80deg"), "center": ("-30deg", "30deg"), "right": ("-80deg", "-15deg")}
def drive(until):
    for _ in wander(robot):
        robot.step(0.1)
        if robot.time > until:
            break
    laser.update(robot.scan())
    speed.update(robot.speed())
    touch.update(robot.touch())
drive(UNTIL)
laser.footprint = FOOT
display(laser)
"""
ROUND = "Footprint(radius=0.18, bumpers=bumpers, speed=speed, touch=touch)"
SQUARE = (
    "Footprint(polygon=[(0.6, 0.4), (0.6, -0.4), (-0.9, -0.4), (-0.9, 0.4)], scanner=(0.5, 0), "
    "bumpers={'left': ('1deg', '33deg'), 'right': ('-33deg', '-1deg')}, speed=speed, touch=touch)"
)


FEET = [(SQUARE, "light", 8), (ROUND, "light", 5), (ROUND, "dark", 22.4)]


@pytest.mark.parametrize(("foot", "theme", "until"), FEET if PICTURES else FEET[:1])
def test_look(plain_page: Callable[..., PlainPage], foot: str, theme: str, until: float) -> None:
    nb = plain_page([ROBOT.replace("FOOT", foot).replace("UNTIL", str(until))], scale=2, theme=theme)
    card = nb.widget(0).locator(".rw-card")
    for width in (400, 700):
        nb.resize(width)
        shoot(card, f"footprint-{theme}-{width}-{until:g}")

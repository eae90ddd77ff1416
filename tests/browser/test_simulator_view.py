"""A simulated robot in its room: moved and turned, obstacles added, moved and removed, by pointer, touch and keys."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import hypot
from typing import Any, Literal

import pytest
from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .laser import eventually
from .plain_page import PlainPage

OPEN = """
from robowidgets.simulator import Robot, Scanner, View, World, room, wander
world = World([(-3, -2, 3, -2), (3, -2, 3, 2), (3, 2, -3, 2), (-3, 2, -3, -2)], [(1.5, 1.0, 0.3)])
robot = Robot(world)
robot.step(0.1)
view = View(robot)
view
"""
HOUSE = """
from robowidgets.simulator import Robot, Scanner, View, World, room, wander
robot = Robot(room("house"), scanner=Scanner(ray_count=1040))
for _ in wander(robot):
    robot.step(0.1)
    if robot.time > 26:
        break
view = View(robot)
for _ in wander(robot):
    robot.step(0.1)
    if robot.time > 50:
        break
view
"""


class House:
    """The picture of a room of 6 m by 4 m round (0, 0)."""

    def __init__(self, nb: PlainPage) -> None:
        self.nb = nb
        self.picture = nb.widget(0).locator(".rw-picture")
        expect(nb.widget(0).locator(".rw-footer")).to_contain_text("x 0.00 y 0.00 m")
        box = self.picture.bounding_box()
        assert box
        self.left, self.top = box["x"], box["y"]
        self.scale = min((box["width"] - 24) / 6, (box["height"] - 40) / 4)
        self.middle = (box["x"] + box["width"] / 2, box["y"] + 12 + (box["height"] - 40) / 2)

    def at(self, x: float, y: float) -> tuple[float, float]:
        return self.middle[0] + x * self.scale, self.middle[1] - y * self.scale

    def drag(self, start: tuple[float, float], end: tuple[float, float], *, up: bool = True) -> None:
        mouse = self.nb.page.mouse
        mouse.move(*self.at(*start))
        mouse.down()
        mouse.move(*self.at(*end), steps=4)
        if up:
            mouse.up()

    def told(self, expression: str) -> Any:
        return eval(self.nb.python(f"print({expression})"))

    def is_at(self, expression: str, *place: float) -> bool:
        return hypot(*(a - b for a, b in zip(self.told(expression), place, strict=True))) < 0.03


def button(widget: Locator, name: str) -> Locator:
    return widget.get_by_role("button", name=name)


@pytest.mark.core
def test_robot_and_obstacles_are_moved_by_pointer_and_keys(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN], width=760)
    house, widget = House(nb), nb.widget(0)
    house.drag((0.0, 0.0), (-1.0, -1.0))
    wait_for(lambda: house.is_at("robot.pose[:2]", -1.0, -1.0), "the robot is moved")
    button(widget, "Restart the simulation").click()
    wait_for(lambda: house.is_at("robot.pose[:2]", 0.0, 0.0), "it is back")
    expect(widget.locator(".rw-footer")).to_contain_text("x 0.00 y 0.00 m")
    nb.page.mouse.move(*house.at(-2.0, 1.5))
    expect(widget.locator(".rw-footer")).to_contain_text("x \u22122.00 y 1.50 m")

    house.drag((0.1, 0), (-1.4, 0.5))
    wait_for(lambda: house.is_at("robot.pose[:2]", -1.5, 0.5), "the robot has been dragged")
    expect(widget.locator(".rw-footer")).to_contain_text("x \u22121.50 y 0.50 m")
    reach = 0.18 + 11 / house.scale
    house.drag((-1.5 + reach, 0.5), (-1.5, 1.7))
    wait_for(lambda: house.is_at("robot.pose[2:]", 1.5708), "the robot has been turned")
    house.drag((1.5, 1.0), (2.0, -1.0))
    wait_for(lambda: house.is_at("robot.world.obstacles[0].tolist()", 2.0, -1.0, 0.3), "the obstacle has been moved")
    house.drag((2.0, -1.0), (0.0, 0.0), up=False)
    house.picture.press("Escape")
    nb.page.mouse.up()
    wait_for(lambda: house.is_at("robot.world.obstacles[0].tolist()", 2.0, -1.0, 0.3), "Escape puts it back")

    house.drag((-1.5, 0.5), (-2.95, 0.5))
    expect(widget.locator(".rw-live")).to_contain_text("expected a place with 0.18 m of room")
    assert house.told("robot.world.clearance(*robot.pose[:2]) >= 0.18")

    button(widget, "Put an obstacle").click()
    nb.page.mouse.click(*house.at(1.0, -0.5))
    wait_for(lambda: house.is_at("robot.world.obstacles[1].tolist()", 1.0, -0.5, 0.2), "an obstacle has been put")
    expect(button(widget, "Remove the selected obstacle")).to_be_disabled()
    nb.page.mouse.click(*house.at(1.0, -0.5))
    button(widget, "Remove the selected obstacle").click()
    wait_for(lambda: house.told("len(robot.world.obstacles)") == 1, "it has been removed")

    nb.python("robot.move_to(0, 0, 0)")
    wait_for(lambda: house.is_at("robot.pose[:2]", 0, 0), "it is there")
    x, y = house.at(0, 0)
    nb.page.mouse.move(x, y)
    nb.page.mouse.down()
    nb.page.mouse.move(x + 2, y)
    nb.page.mouse.up()
    assert house.told("robot.pose[:3]") == (0, 0, 0), "an unsteady click moves nothing"
    house.picture.focus()
    for key in ("n", "Shift+ArrowUp", "ArrowLeft"):
        house.picture.press(key)
    wait_for(lambda: house.is_at("robot.world.obstacles[0].tolist()", 1.9, -0.5, 0.3), "keys have moved it")
    expect(widget.locator(".rw-live")).to_have_text("obstacle 1 at x 1.90 y \u22120.50 m")
    house.picture.press("Delete")
    wait_for(lambda: house.told("len(robot.world.obstacles)") == 0, "it has been removed")
    for key in ("ArrowRight", "[", "o"):
        house.picture.press(key)
    wait_for(lambda: house.is_at("robot.pose[::2]", 0.1, 0.2618), "keys have moved and turned the robot")
    wait_for(lambda: house.told("len(robot.world.obstacles)") == 1, "an obstacle has been put ahead")
    expect(house.picture).to_have_attribute("aria-label", re.compile(r"x 0\.10 y 0\.00 m"))


def test_a_robot_over_the_edge_of_a_drop_says_so_until_it_is_dragged_back(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([OPEN.replace("0.3)])", "0.3)], drops=[(0.6, -2, 2, 0.4)])")], width=760)
    house, notice = House(nb), nb.widget(0).locator(".rw-notice-text")
    expect(notice).to_be_hidden()
    expect(house.picture).to_have_attribute("aria-label", re.compile("1 obstacle, 1 drop$"))
    nb.python("robot.drive(0.5, 0)\nrobot.run(until=lambda: robot.has_fallen)")
    expect(notice).to_have_text("the robot is over an edge: drag it back")
    shoot(nb.widget(0), "simulator-fallen")
    house.drag(house.told("robot.pose[:2]"), (-1.0, 1.0))
    expect(notice).to_be_hidden()


def test_a_finger_drags_the_robot_and_scrolls_elsewhere(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN], width=500, height=300, touch=True)
    house = House(nb)
    session = nb.page.context.new_cdp_session(nb.page)

    def swipe(start: tuple[float, float], end: tuple[float, float]) -> None:
        for kind, share in (("Start", 0.0), ("Move", 0.3), ("Move", 0.7), ("Move", 1.0)):
            x, y = (a + share * (b - a) for a, b in zip(house.at(*start), house.at(*end), strict=True))
            session.send("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": [{"x": x, "y": y}]})
        session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

    swipe((0.05, 0.05), (-1.4, -0.9))
    wait_for(lambda: house.is_at("robot.pose[:2]", -1.45, -0.95), "the finger has dragged it")
    assert nb.page.evaluate("scrollY") == 0
    swipe((1.0, -0.5), (1.0, 1.0))
    wait_for(lambda: nb.page.evaluate("scrollY") > 0, "elsewhere it scrolls")


def test_moved_things_stay_until_a_busy_kernel_answers(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN], width=760)
    house, footer = House(nb), nb.widget(0).locator(".rw-footer")
    with nb.busy():
        house.drag((0, 0), (-1.0, -1.0))
        expect(footer).to_contain_text("x \u22121.00 y \u22121.00 m")
        nb.namespace["robot"].step(0.3)
        expect(nb.widget(0).locator(".rw-facts")).to_contain_text("0.4 s")
        expect(footer).to_contain_text("x \u22121.00 y \u22121.00 m")
        assert nb.namespace["robot"].pose[:2] == (0, 0)
    wait_for(lambda: house.is_at("robot.pose[:2]", -1.0, -1.0), "it is moved once the kernel is free")
    with nb.busy():
        house.drag((-1.0, -1.0), (-2.99, 0.5))
        expect(footer).to_contain_text("x \u22122.99 y 0.50 m")
        nb.page.mouse.move(*house.at(1.0, -0.5))
        expect(footer).to_contain_text("x 1.00 y \u22120.50 m")


def test_a_view_says_when_its_robot_moves_no_more(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page(
        [
            "from robowidgets import feeds\nfrom robowidgets.simulator import View",
            "feed = feeds.simulator()\nView(feed)",
        ]
    )
    notice = nb.widget(1).locator(".rw-notice-text")
    expect(notice).to_be_hidden()
    nb.python("feed.close()")
    expect(notice).to_have_text("the feed is closed")
    shoot(nb.widget(1), "simulator-closed")


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_the_house_is_drawn_to_scale(
    plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"], scale: int
) -> None:
    nb = plain_page([HOUSE], width=760, scale=scale, theme=theme)
    card = nb.widget(0).locator(".rw-simulator")
    expect(card.locator(".rw-facts")).to_contain_text("14.0 \u00d7 9.0 m")
    for width in (760, 400):
        nb.resize(width)
        eventually(lambda: round((card.bounding_box() or {"width": 0})["width"]), min(width, 760))
        shoot(card, f"simulator-{width}-{theme}")
        assert card.evaluate("card => card.scrollWidth <= card.clientWidth")
    if theme == "dark":
        nb.page.emulate_media(forced_colors="active", color_scheme="dark")
        eventually(lambda: card.evaluate("card => getComputedStyle(card).backgroundColor"), "rgb(0, 0, 0)")
        nb.widget(0).locator(".rw-picture").hover()
        shoot(card, "simulator-forced")

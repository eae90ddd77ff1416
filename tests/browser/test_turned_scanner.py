"""A scanner that is mounted turned: the card shows the robot's angles and a note; a click shows the scanner's own."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import LOOKS, shoot
from .plain_page import PlainPage

LASER = """
import numpy as np, robowidgets
from robowidgets.simulator import Robot, Scanner, World
scanner = Scanner(360, "360deg", range_max=5.0, frame_id="rplidar_link")
laser = robowidgets.LaserWidget(title="/scan", sectors={"ahead": ("-15deg", "15deg")})
room = World.rooms()
straight = Robot(room, scanner=scanner, seed=1).scan()
MOUNT = robowidgets.Mount(np.pi / 2)
own = robowidgets.Scan(np.roll(straight.ranges, -90), -np.pi, np.pi / 180, 0.1, 5.0, frame_id="rplidar_link")
laser.update(own.mounted(MOUNT))
laser.pinned = laser.scan.at(0).index
laser
"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_the_card_says_how_the_scanner_stands_and_a_click_shows_its_own_angles(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([LASER], theme=theme, scale=scale)
    card = nb.widget(0).locator(".rw-card")
    popup = card.locator(".rw-popup", has=card.page.locator(".rw-popup-foot"))
    mount = card.get_by_role("button", name="turned 90.0° by tf")
    expect(mount).to_have_attribute("aria-pressed", "false")
    expect(popup.locator(".rw-popup-angle")).to_have_text("0.0°")
    nearest = nb.python("print(laser.scan.nearest().index)").strip()
    angle = float(nb.python("print(np.degrees(laser.scan.nearest().angle))"))
    expect(card.locator(".rw-nearest")).to_contain_text(f"{angle:.1f}°".replace("-", "−") + f" [{nearest}]")
    for width in (700, 480, 320):
        nb.resize(width)
        picture, corner = card.locator(".rw-picture").bounding_box(), mount.bounding_box()
        assert picture
        assert corner
        assert corner["x"] + corner["width"] <= picture["x"] + picture["width"]
        assert mount.evaluate("e => e.scrollWidth <= e.clientWidth"), "it is there in full"
        shoot(card, f"laser-turned-{theme}-{scale}-{width}")
    nb.resize(700)

    mount.click()
    own = card.get_by_role("button", name="scanner’s own angles")
    expect(own).to_have_attribute("aria-pressed", "true")
    assert nb.python("print(laser.own_angles, laser.pinned == laser.scan.at(0).index)").strip() == "True True"
    expect(popup.locator(".rw-popup-angle")).to_have_text("−90.0°")
    popup.get_by_role("button", name="Formula").click()
    expect(popup.locator(".rw-formula-names")).to_have_text("angle_min + 90 × increment")
    expect(popup.locator(".rw-formula-result")).to_contain_text("−90.00°")
    nb.python("laser.selection = 'ahead'")
    expect(card.locator(".rw-chip")).to_contain_text("−105.0° to −75.0°")
    shoot(card, f"laser-turned-own-{theme}-{scale}")

    card.locator(".rw-picture").press("a")
    expect(mount).to_have_attribute("aria-pressed", "false")
    expect(popup.locator(".rw-formula-names")).to_have_text("angle_min + 90 × increment + yaw")
    expect(popup.locator(".rw-formula-result")).to_contain_text("0.00°")
    expect(card.locator(".rw-chip")).to_contain_text("−15.0° to 15.0°")
    shoot(card, f"laser-turned-formula-{theme}-{scale}")

    nb.python("laser.update(own)")
    expect(mount).to_be_hidden()
    expect(popup.locator(".rw-popup-angle")).to_have_text("−90.0°")


def test_the_nose_of_the_robot_and_the_code_are_the_robots(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([LASER])
    card = nb.widget(0).locator(".rw-card")
    nb.python("laser.update(own.mounted(robowidgets.Mount(np.pi / 2, upside_down=True)))")
    expect(card.get_by_role("button", name="upside down and turned 90.0° by tf")).to_be_visible()
    nb.python("laser.selection = 'ahead'")
    chip = card.locator(".rw-chip")
    expect(chip).to_contain_text("−15.0° to 15.0°")
    card.locator(".rw-mount").click()
    expect(chip).to_contain_text("75.0° to 105.0°")
    shoot(card, "laser-turned-upside-down")

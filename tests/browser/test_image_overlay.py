"""A laser scan over the picture of a camera, on a page."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from .. import camera_drive
from .chromium import LOOKS, shoot
from .plain_page import PlainPage

SEEN = """
from dataclasses import replace
from robowidgets import ImageWidget, LaserWidget, Line, screen
from robowidgets.simulator import Robot, World
robot = Robot(World.rooms(), (0.3, -1.6, 0.15), camera=True, seed=1)
info = robot.camera.info
scan = replace(robot.scan(), stamp_ns=10**9)
seen = replace(robot.image(), stamp_ns=10**9 + 20_000_000)
laser = LaserWidget(title="/scan", view_range=4)
image = ImageWidget(title="/camera/image", camera_pose=(0, 0, 0.1, 0, 0, 0))
laser.sectors["front"] = ("-10deg", "10deg")
laser.draw("goal", Line((1.0, -0.2), (1.0, 0.2)))
view = screen(laser, image)
image.calibrate(info)
image.take_scan(scan)
laser.update(scan)
image.update(seen)
view
"""

MISSING = """
from robowidgets import ImageWidget
lost = ImageWidget(title="/camera/image")
lost.calibrate(info)
lost.take_scan(scan)
lost.update(seen)
lost
"""


def on_picture(image: Locator, dot: list[float]) -> tuple[float, float]:
    """The position of a reading on the screen, from its column and row in Python."""
    image.locator(".rw-picture").scroll_into_view_if_needed()
    picture = image.locator(".rw-picture").bounding_box()
    assert picture
    factor = min(picture["width"] / 320, picture["height"] / 240)
    x = picture["x"] + (picture["width"] - 320 * factor) / 2 + (dot[1] / 4 + 0.5) * factor
    y = picture["y"] + (picture["height"] - 240 * factor) / 2 + (dot[2] / 4 + 0.5) * factor
    return x, y


def assert_lit_in_both(view: Locator, dot: list[float]) -> None:
    """Fail unless a hovered reading shows its numbers, and the laser highlights its ray with the same numbers."""
    image, laser = view.locator(".rw-image").first, view.locator(".rw-laser").first
    view.page.mouse.move(*on_picture(image, dot))
    named = image.locator(".rw-popup:visible .rw-popup-expression")
    near = "|".join(str(round(dot[0]) + i) for i in range(-3, 4))
    expect(named).to_have_text(re.compile(rf"ranges\[({near})\]$"))
    lit = laser.locator(".rw-popup:visible")
    expect(lit.locator(".rw-popup-expression")).to_have_text(named.inner_text())
    expect(image.locator(".rw-popup:visible .rw-popup-distance")).to_have_text(
        lit.locator(".rw-popup-distance").inner_text()
    )


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_reading_on_the_picture_says_its_index_and_lights_its_ray_in_the_laser_also_while_a_cell_runs(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([SEEN, MISSING], run=False, scale=scale, theme=theme)
    nb.run_all()
    image = nb.page.locator(".rw-image").first
    footer, laser = image.locator(".rw-footer"), image.locator(".rw-image-laser")
    expect(footer).to_contain_text("readings in the picture, scan 0.02 s older")
    dots = json.loads(nb.python("import json; print(json.dumps(image.get_state()['_about']['over']['dots']))"))
    assert_lit_in_both(nb.output(0), dots[4 * 40 : 4 * 41])
    shoot(nb.output(0), f"image-overlay-{theme}-{scale}")
    nb.resize(360)
    shoot(nb.output(0), f"image-overlay-narrow-{theme}-{scale}")
    with nb.busy():
        laser.click()
        expect(footer).not_to_contain_text("readings")
        image.locator(".rw-picture").press("l")
        expect(footer).to_contain_text("readings in the picture")
    expect(laser).to_have_attribute("aria-pressed", "true")
    lost = nb.page.locator(".rw-image").nth(1)
    expect(lost.locator(".rw-footer")).to_contain_text("no tf from laser to camera_optical_frame")


PLAYED = """
import json, robowidgets
recording = robowidgets.open({path!r})
player = recording.show("/camera/image_raw", "/scan", "/sonar/front_3")
player.seek(1.2)
image = next(view for view in player.views if view.choice.topic == "/camera/image_raw")
player
"""
AT = "*_, last = image.track.frames(1.2, 1.2); print(json.dumps(last.about['over']['dots'][4 * 60 : 4 * 61]))"


def test_a_player_and_its_page_have_the_laser_on_the_camera_with_the_same_ray_lit_in_both(
    plain_page: Callable[..., PlainPage], static_page: Callable[[Path], Page], tmp_path: Path
) -> None:
    nb = plain_page([PLAYED.format(path=str(camera_drive.write(tmp_path / "drive")))])
    nb.resize(1280, 900)
    file = tmp_path / "page.html"
    nb.python(f"player.to_html({str(file)!r})")
    page = static_page(file)
    for name, view in (("player", nb.output(0)), ("page", page.locator("body"))):
        image = view.locator(".rw-image")
        expect(image.locator(".rw-footer")).to_contain_text("readings in the picture")
        assert_lit_in_both(view, json.loads(nb.python(AT)))
        shoot(view, f"image-overlay-{name}")
        image.locator(".rw-picture").press("l")
        expect(image.locator(".rw-footer")).not_to_contain_text("readings")
        expect(image.locator(".rw-image-laser")).to_have_attribute("aria-pressed", "false")


LISTED = """
import robowidgets
recording = robowidgets.open({path!r})
player = recording.show("/scan")
player
"""


def test_a_depth_image_is_a_laser_by_a_click_in_the_list_of_topics(
    plain_page: Callable[..., PlainPage], tmp_path: Path
) -> None:
    nb = plain_page([LISTED.format(path=str(camera_drive.write(tmp_path / "drive")))])
    nb.resize(1280, 900)
    view = nb.output(0)
    rail = view.locator(".rw-topics-rail")
    if rail.is_visible():
        rail.click()
    as_laser = view.get_by_role("button", name="Show it in a laser widget")
    view.locator('.rw-topic[data-key="/camera/camera_info"]').click()
    expect(view.locator(".rw-topics-foot b")).to_have_text("/camera/camera_info")
    expect(as_laser).to_be_hidden()
    view.locator('.rw-topic[data-key="/camera/depth/image_rect_raw"]').click()
    as_laser.click()
    made = view.locator(".rw-laser").nth(1)
    expect(made.locator(".rw-facts")).to_contain_text("320 rays")
    expect(made.locator(".rw-header")).to_contain_text("/camera/depth/image_rect_raw")
    assert "/camera/depth/image_rect_raw as scan" in nb.python("print(player.arrangement)")
    shoot(view, "depth-as-laser")


def test_a_camera_that_is_named_first_stands_above_the_laser(
    plain_page: Callable[..., PlainPage], tmp_path: Path
) -> None:
    folder = camera_drive.write(tmp_path / "drive")
    opens = f"import robowidgets\nrecording = robowidgets.open({str(folder)!r})"
    image = next(name for name, type_ in camera_drive.types(camera_drive.robot()).items() if "Image" in type_)
    scan = next(name for name, type_ in camera_drive.types(camera_drive.robot()).items() if "LaserScan" in type_)
    nb = plain_page([opens, f"recording.show({image!r}, {scan!r})", f"recording.show({scan!r}, {image!r})"])
    nb.resize(1280, 900)
    places = []
    for cell in (1, 2):
        shown = nb.output(cell)
        expect(shown.locator(".rw-image")).to_be_visible()
        camera, laser = (shown.locator(one).bounding_box() for one in (".rw-image", ".rw-laser"))
        assert camera
        assert laser
        places.append((camera["y"] - laser["y"], camera["x"] - laser["x"]))
    assert places[0][0] < 0, "named first, it stands first"
    assert places[1][0] >= 0

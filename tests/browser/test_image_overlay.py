"""What a person sees of a laser on the picture of a camera."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import LOOKS, shoot
from .plain_page import PlainPage

SEEN = """
from dataclasses import replace
from robowidgets import CameraInfo, ImageWidget, LaserWidget, Line, together
from robowidgets.samples import Image
from robowidgets.simulator import Pose, Robot, picture, room
house = room("house")
robot = Robot(house, seed=1)
info = CameraInfo(640, 480, [420, 0, 319.5, 0, 420, 239.5, 0, 0, 1], frame_id="camera_optical_frame")
scan = replace(robot.scan(), stamp_ns=10**9)
seen = Image(picture(house, robot.scan_pose, info, height=0.5), "rgb8", stamp_ns=10**9 + 20_000_000)
laser = LaserWidget(title="/scan", view_range=4)
image = ImageWidget(title="/camera/image", camera_pose=(0, 0, 0.3, 0, 0, 0))
laser.sectors["front"] = ("-10deg", "10deg")
laser.draw("goal", Line((1.0, -0.2), (1.0, 0.2)))
view = together(laser, image)
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


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_reading_on_the_picture_says_its_index_and_lights_its_ray_in_the_laser(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([SEEN, MISSING], run=False, scale=scale, theme=theme)
    nb.run_all()
    image = nb.page.locator(".rw-image").first
    expect(image.locator(".rw-footer")).to_contain_text("readings in the picture, scan 0.02 s older")
    over = "image.get_state()['_about']['over']"
    index, column, row = eval(nb.python(f"print({over}['dots'][4 * 40 : 4 * 40 + 3])"))  # our own numbers
    image.locator(".rw-picture").scroll_into_view_if_needed()
    picture = image.locator(".rw-picture").bounding_box()
    assert picture
    factor = min(picture["width"] / 640, picture["height"] / 480)
    x = picture["x"] + (picture["width"] - 640 * factor) / 2 + (column / 4 + 0.5) * factor
    y = picture["y"] + (picture["height"] - 480 * factor) / 2 + (row / 4 + 0.5) * factor
    nb.page.mouse.move(x, y)
    named = image.locator(".rw-popup:visible .rw-popup-expression")
    expect(named).to_contain_text("ranges[")
    pointed = int(named.inner_text().split("[")[1].rstrip("]"))
    assert abs(pointed - index) <= 3
    # The same ray is lit in the laser, by its own pop-up.
    laser = nb.page.locator(".rw-laser").first
    expect(laser.locator(".rw-popup:visible .rw-popup-expression")).to_have_text(f"ranges[{pointed}]")
    expect(image.locator(".rw-popup:visible .rw-popup-distance")).to_have_text(
        laser.locator(".rw-popup:visible .rw-popup-distance").inner_text()
    )
    shoot(nb.output(0), f"image-overlay-{theme}-{scale}")
    shoot(image, f"gallery-camera-{theme}")
    lost = nb.page.locator(".rw-image").nth(1)
    expect(lost.locator(".rw-footer")).to_contain_text("no tf from laser to camera_optical_frame")

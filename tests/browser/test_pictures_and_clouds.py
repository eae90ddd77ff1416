"""A depth image and a cloud of one recording: in a player, and in a page without a kernel."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Locator, Page, expect

from ..unit.cloud.test_cloud import cloud_message
from ..unit.recordings.recorded import START_NS, stamped, write
from .chromium import shoot
from .plain_page import PlainPage
from .test_image_widget import place_of

HZ, COUNT = 2, 8
SHOW = """
import robowidgets
recording = robowidgets.open({path!r})
player = recording.show("/camera/depth", "/points")
player
"""


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Each picture and each cloud encodes its number: 1 mm and 10 cm farther away than the one before."""
    kinds = {"/camera/depth": "sensor_msgs/msg/Image", "/points": "sensor_msgs/msg/PointCloud2"}
    messages = []
    for number in range(COUNT):
        pixels = np.full((48, 64), 1000 + number, np.uint16)
        pixels[:24] = 0
        points = np.zeros(100, [(name, "f4") for name in ("x", "y", "z", "intensity")])
        points["x"], points["y"], points["z"] = 1 + number / 10, np.linspace(0, 1, 100), np.linspace(0, 2, 100)
        header = stamped(START_NS + number * 10**9 // HZ, "camera")
        image = {"header": header, "height": 48, "width": 64, "encoding": "16UC1", "step": 128}
        image["data"] = pixels.view(np.uint8).reshape(-1)
        messages += [(number / HZ, "/camera/depth", image), (number / HZ, "/points", cloud_message(points))]
    return write(tmp_path_factory.mktemp("large") / "drive", kinds, messages)


def cards(view: Page | Locator) -> tuple[Locator, Locator]:
    return view.locator(".rw-image"), view.locator(".rw-cloud")


def words(card: Locator, part: str) -> Locator:
    """Return a part of the pop-up of the region, or of the pixel or point under the pointer, whichever comes first."""
    return card.locator(f".rw-popup:visible .rw-popup-{part}").first


def test_a_player_steps_through_both_and_freezes_them(plain_page: Callable[..., PlainPage], drive: Path) -> None:
    nb = plain_page([SHOW.format(path=str(drive))], width=1280)
    image, cloud = cards(nb.output(0))
    nb.python("player.seek(1.0)")
    expect(cloud.locator(".rw-cloud-nearest")).to_contain_text("nearest 1.20 m")
    picture = image.locator(".rw-picture")
    picture.scroll_into_view_if_needed()
    nb.page.mouse.move(*place_of(picture, 300, 320))
    expect(words(image, "expression")).to_have_text("image.depth[30, 32]")
    expect(words(image, "distance")).to_have_text("1.002 m")
    picture.focus()
    nb.page.keyboard.press(".")
    expect(words(image, "distance")).to_have_text("1.003 m")
    expect(cloud.locator(".rw-cloud-nearest")).to_contain_text("nearest 1.30 m")
    nb.page.keyboard.press(",")
    expect(words(image, "distance")).to_have_text("1.002 m")
    for card in (image, cloud):
        expect(card.locator(".rw-freeze")).to_have_attribute("aria-pressed", "false")
    image.locator(".rw-freeze").click()
    expect(image.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
    nb.python("player.seek(3.0)")
    expect(nb.output(0).locator(".rw-play-now")).to_have_text("3.00")
    nb.page.mouse.move(*place_of(picture, 300, 320))
    expect(words(image, "distance")).to_have_text("1.002 m")
    image.locator(".rw-freeze").click()
    nb.page.mouse.move(*place_of(picture, 300, 320))
    expect(words(image, "distance")).to_have_text("1.006 m")
    expect(cloud.locator(".rw-cloud-nearest")).to_contain_text("nearest 1.60 m")
    shoot(nb.output(0), "pictures-and-clouds-player")


def test_a_page_without_a_kernel_tells_pixels_regions_points_and_bands(
    plain_page: Callable[..., PlainPage], static_page: Callable[[Path], Page], drive: Path, tmp_path: Path
) -> None:
    nb = plain_page([SHOW.format(path=str(drive))])
    file = tmp_path / "drive.html"
    nb.python(f"recording.to_html({str(file)!r}, topics=['/camera/depth', '/points'])")
    page = static_page(file)
    image, cloud = cards(page)
    picture = image.locator(".rw-picture")
    picture.scroll_into_view_if_needed()
    page.mouse.move(*place_of(picture, 300, 320))
    expect(words(image, "distance")).to_have_text("1.000 m")
    page.mouse.move(*place_of(picture, 105, 105))
    expect(words(image, "distance")).to_have_text("nothing")
    page.mouse.down()
    page.mouse.move(*place_of(picture, 355, 255), steps=4)
    page.mouse.up()
    page.mouse.move(*place_of(picture, 465, 625))
    expect(words(image, "expression")).to_have_text("image.depth[10:36, 10:26]")
    expect(words(image, "details")).to_contain_text("1.000 to 1.000 m, mean 1.000, median 1.000")
    expect(words(image, "details")).to_contain_text("224 pixels of 416 nothing")
    cloud.locator(".rw-picture").focus()
    page.keyboard.press("m")
    expect(words(cloud, "expression")).to_have_text("points[0]")
    expect(words(cloud, "details")).to_contain_text("intensity 0")
    page.keyboard.press("Escape")
    box = cloud.locator(".rw-picture").bounding_box()
    assert box
    right = box["x"] + box["width"] - 51
    page.mouse.move(right, box["y"] + 60)
    page.mouse.down()
    page.mouse.move(right, box["y"] + 120, steps=4)
    page.mouse.up()
    expect(cloud.locator(".rw-cloud-count")).to_have_text(re.compile(r"^\d+ of 100 points$"))
    expect(cloud.locator(".rw-cloud-bands")).to_have_text(re.compile(r"^z [\d.]+ to [\d.]+ m$"))
    shoot(page.locator("body"), "pictures-and-clouds-page")

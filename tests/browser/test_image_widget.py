"""The image widget on a page: pixels, regions, depth, and its controls."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .notebook import Notebook
from .plain_page import PlainPage

MAKE = """
import numpy as np
from robowidgets import ImageWidget
rows, columns = np.mgrid[:480, :640]
room = np.dstack([40 + columns // 4, 60 + rows // 4, 90 + (columns // 40 + rows // 40) % 2 * 60]).astype(np.uint8)
room[200:280, 280:360] = (200, 60, 40)
depth = (1 + rows / 200 + columns / 400).astype(np.float32)
depth[200:280, 280:360] = 0.75
depth[:, :30] = np.nan
camera = ImageWidget(title="/camera/image_raw")
camera
"""
COLOR = MAKE + "camera.update(room)"
DEPTH = MAKE + "camera.camera = (500, 500, 320, 240)\ncamera.update(depth)"


def point_at(nb: PlainPage, picture: Locator, row: float, column: float) -> None:
    """Move the pointer to a pixel of a picture of 640 x 480."""
    nb.page.mouse.move(*place_of(picture, row, column))


def place_of(picture: Locator, row: float, column: float) -> tuple[float, float]:
    box = picture.bounding_box()
    assert box
    scale = min(box["width"] / 640, box["height"] / 480)
    left = box["x"] + (box["width"] - 640 * scale) / 2
    top = box["y"] + (box["height"] - 480 * scale) / 2
    return left + (column + 0.5) * scale, top + (row + 0.5) * scale


@pytest.mark.core
@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_the_pixel_under_the_pointer_and_a_region_say_their_numbers(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page(
        [COLOR.replace("camera\ncamera.update(room)", "camera.update(room)\ncamera")], theme=theme, scale=scale
    )
    nb.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    card = nb.output(0).locator(".rw-card.rw-image")
    picture = card.locator(".rw-picture")
    expect(card.locator(".rw-facts")).to_contain_text("640 \u00d7 480 rgb8")
    point_at(nb, picture, 240, 320)
    hovered = card.locator(".rw-popup:not([hidden])")
    expect(hovered).to_contain_text("image[240, 320]")
    expect(hovered).to_contain_text("r 200  g 60  b 40")
    shoot(card, f"image-color-{theme}-{scale}")
    nb.page.mouse.move(*place_of(picture, 180, 300))
    nb.page.mouse.down()
    nb.page.mouse.move(*place_of(picture, 240, 330), steps=4)
    nb.page.mouse.up()
    nb.page.mouse.move(*place_of(picture, 20, 20))
    marked = card.locator(".rw-popup:not([hidden])").first
    expect(marked).to_contain_text("image[180:241, 300:331]")
    expect(marked).to_contain_text("r 115 to 200")
    assert nb.python("camera.region") == "(180, 241, 300, 331)"
    marked.get_by_role("button", name="Copy code").click()
    expect(marked.locator(".rw-copy")).to_have_text("Copied")
    assert nb.page.evaluate("navigator.clipboard.readText()") == "image[180:241, 300:331]"
    nb.page.mouse.move(*place_of(picture, 20, 20))
    shoot(card, f"image-region-{theme}-{scale}")
    for width in (1200, 480, 320):
        nb.resize(width, 720)
        shoot(card, f"image-region-{theme}-{width}")
    below = card.locator(".rw-popup.rw-below")  # in a narrow card
    expect(below).to_contain_text("image[180:241, 300:331]")
    card.get_by_role("button", name="Mark nothing").click()
    expect(below).to_be_hidden()
    assert nb.python("print(camera.region)") == "None\n"


def test_depth_says_metres_and_places_and_its_colors_can_be_kept(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([DEPTH.replace("camera\ncamera.cam", "camera.cam") + "\ncamera"], theme="dark")
    card = nb.output(0).locator(".rw-card.rw-image")
    picture = card.locator(".rw-picture")
    expect(card.locator(".rw-image-legend")).to_contain_text("5 % nothing")
    point_at(nb, picture, 240, 320)
    hovered = card.locator(".rw-popup:not([hidden])")
    expect(hovered).to_contain_text("image.depth[240, 320]")
    expect(hovered).to_contain_text("0.750 m")
    expect(hovered).to_contain_text("x 0.000  y 0.000  z 0.750 m")
    shoot(card, "image-depth-dark")
    point_at(nb, picture, 240, 10)
    expect(hovered).to_contain_text("nothing")
    picture.press("s")
    wait_for(lambda: nb.python("camera.color_range") == "(0.5, 5.0)", "the scale was kept")
    picture.press("ArrowRight")
    picture.press("Shift+ArrowRight")
    expect(card.locator(".rw-live")).to_contain_text("image.depth[240, 330]")
    for _ in range(12):
        picture.press("+")
    expect(card.locator(".rw-image-facts")).to_contain_text("\u00d7")
    shoot(card, "image-zoomed-dark")
    picture.press("0")
    expect(card.locator(".rw-image-facts")).to_have_text("drag to mark a region")
    nb.python("camera.update(np.full((480, 640, 3), (10, 20, 200), np.uint8), 'bgr8')")
    distance = card.locator(".rw-popup:visible .rw-popup-distance")
    expect(distance.first).to_have_text(re.compile(r"^b 10 {2}g 20 {2}r 200$"))


def test_a_page_gets_the_next_when_it_has_drawn_the_last_and_asks_for_what_was_thinned(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([DEPTH.replace("camera\ncamera.cam", "camera.cam") + "\ncamera"])
    card = nb.output(0).locator(".rw-card.rw-image")
    expect(card.locator(".rw-facts")).to_contain_text("32FC1")
    wait_for(lambda: nb.python("camera._credit._is_free") == "True", "the page has reported its drawing")
    nb.python("camera.update(np.arange(4_000_000, dtype=np.float32).reshape(1000, 4000) + 1)")
    expect(card.locator(".rw-image-facts")).to_contain_text("every 4th row and column shown")
    picture = card.locator(".rw-picture")
    picture.press("ArrowRight")
    picture.press("ArrowRight")
    expect(card.locator(".rw-popup:not([hidden])")).to_contain_text("2002002.000 m")


FILE = """
import io
import PIL.Image
file = io.BytesIO()
PIL.Image.fromarray(room).save(file, "JPEG", quality=95)
jpeg = file.getvalue()
"""


def test_a_jpeg_is_shown_as_it_came_a_damaged_one_leaves_the_last_and_earlier_ones_are_kept(
    plain_page: Callable[..., PlainPage],
) -> None:
    pytest.importorskip("PIL", reason="Pillow is not installed")
    nb = plain_page([MAKE, FILE])
    card = nb.output(0).locator(".rw-card.rw-image")
    picture = card.locator(".rw-picture")
    nb.python("camera.update({'format': 'jpeg', 'data': jpeg})")
    expect(card.locator(".rw-facts")).to_contain_text("640 \u00d7 480 jpeg")
    point_at(nb, picture, 240, 320)
    red = re.compile(r"^r (19|20)\d  g [56]\d  b [34]\d$")
    distance = card.locator(".rw-popup:visible .rw-popup-distance")
    expect(distance).to_have_text(red)
    nb.python("camera.update({'format': 'jpeg', 'data': jpeg[:jpeg.index(b'\\xff\\xda')]})")
    expect(card.locator(".rw-empty")).to_have_text("This picture is damaged. Showing the last good one.")
    nb.python("camera.update(np.full((480, 640), 7, np.uint8))")
    expect(card.locator(".rw-empty")).to_be_hidden()
    expect(distance).to_have_text(re.compile("^7$"))
    picture.press(" ")
    picture.press(",")
    picture.press(",")
    expect(distance).to_have_text(red)
    nb.python("camera.update(np.full((480, 640), 9, np.uint8))")
    expect(card.locator(".rw-freeze")).to_have_text("Frozen \u00b7 3 since")
    assert nb.python("camera.frozen.encoding, camera.image is camera.frozen") == "('jpeg', True)"
    picture.press(" ")
    expect(distance).to_have_text(re.compile("^9$"))
    nb.python("file = io.BytesIO(); PIL.Image.new('L', (640, 480), 42).save(file, 'PNG')")
    nb.python("camera.update({'format': 'mono8; png compressed', 'data': file.getvalue()})")
    expect(distance).to_have_text(re.compile("^42$"))


STREAM = """
import threading, time
ends = threading.Event()
def stream():
    for number in range(1, 100_000):
        if ends.wait(0.02):
            return
        camera.update(np.full((1000, 2000), number, np.float32))
threading.Thread(target=stream, daemon=True).start()
"""


def test_during_a_busy_cell_pictures_come_and_exact_values_of_what_is_thinned(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([MAKE, STREAM, "while not ends.is_set(): pass"], run=False)
    nb.run(0)
    card = nb.output(0).locator(".rw-card.rw-image")
    picture = card.locator(".rw-picture")
    nb.run(1)
    expect(card.locator(".rw-image-facts")).to_contain_text("every 3rd row and column shown")
    nb.start(2)
    picture.scroll_into_view_if_needed()
    box = picture.bounding_box()
    assert box
    nb.page.mouse.move(box["x"] + box["width"] / 2 + 1, box["y"] + box["height"] / 2 + 1)
    hovered = card.locator(".rw-popup:not([hidden])")
    said = []
    for _ in range(3):
        expect(hovered).not_to_contain_text("nearest of")
        expect(hovered.locator(".rw-popup-distance")).not_to_have_text(said[-1] if said else "")
        said.append(hovered.locator(".rw-popup-distance").inner_text())
    assert all(re.fullmatch(r"\d+\.000 m", one) for one in said)
    assert [float(one.split()[0]) for one in said] == sorted(float(one.split()[0]) for one in said)
    nb.interrupt()
    nb.python("ends.set()")

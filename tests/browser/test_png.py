"""The PNG of a widget: from the download button, and from `save_png`."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from .laser import DARK, FAN, LIGHT, SETUP, Picture, Place, eventually, layers, locate
from .notebook import Notebook
from .plain_page import PlainPage

Pixels = NDArray[np.int_]
STILL = """
.rw-controls, .rw-steps, .rw-button { display: none !important }
[data-seen] { position: fixed !important; z-index: 9; top: 8px; left: 8px; border-radius: 0 !important }
"""
"""A PNG leaves out buttons, and the round corners, through which the page would show."""

WIDGETS = f"""{SETUP}
import numpy as np
from robowidgets import ScanogramWidget, SpeedWidget, TouchWidget

laser.update(**fan({{3: 0.1, 5: inf, 7: nan, 9: -inf}}))
laser.pinned = 12
speed = SpeedWidget(title="/odom", linear_limits=(-0.5, 0.5))
speed.update(linear=(0.62, 0, 0), angular=(0, 0, -0.24))
speed.command(linear=(0.4, 0, 0), angular=(0, 0, 0))
touch = TouchWidget(title="/bumper & <b>", angles={{"left": 0.9, "right": -0.9}},
                    labels={{"front": "front \\x07 & <i>"}})
touch.update(left=True, right=False, front=False)
ranges = np.tile(2 + np.sin(np.arange(200)[:, None] / 20 + np.arange(61) / 30), 1)
ranges[50:60] = inf
scanogram = ScanogramWidget(title="/scan")
scanogram.update(times_ns=np.arange(200) * 100_000_000, ranges=ranges, angle_min=-1.5, angle_increment=0.05,
                 range_min=0.1, range_max=10.0)
scanogram.set_touches([(10.0, 10.5, "left")], title="/bumper")
scanogram.selection = (2.0, 7.0)
"""


def pixels(png: bytes) -> Pixels:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def download(page: Page, card: Locator) -> tuple[str, Pixels]:
    """Name and pixels of the PNG that the button saves."""
    with page.expect_download() as begun:
        card.get_by_role("button", name="Save as PNG").press("Enter")
    return begun.value.suggested_filename, pixels(Path(begun.value.path()).read_bytes())


def seen(card: Locator) -> Pixels:
    """A screenshot of a card, on whole pixels."""
    size = """(card) => {
        const { width, height } = card.getBoundingClientRect();
        return (card.dataset.seen = `width: ${width}px; height: ${height}px`);
    }"""
    # Without its buttons a pop-up is smaller, and would move during the screenshot.
    places = card.locator(".rw-floating").evaluate_all(
        """(popups) => popups.map((popup, i) => {
            popup.dataset.stays = i;
            return `[data-stays="${i}"] { transform: ${popup.style.transform || "none"} !important }`;
        }).join("\\n")"""
    )
    shot = card.screenshot(animations="disabled", style=f"{STILL} {places} [data-seen] {{ {card.evaluate(size)} }}")
    card.evaluate("(card) => delete card.dataset.seen")
    return pixels(shot)


def differences(saved: Pixels, screen: Pixels) -> float:
    """The share of pixels that differ visibly."""
    assert saved.shape == screen.shape
    return float((np.abs(saved - screen).max(axis=-1) > 48).mean())


def red_at(saved: Pixels, card: Locator, place: Place, ray: tuple[float, float], red: tuple[int, ...]) -> bool:
    """Return True if a reading is at its position on the screen, with twice as many pixels."""
    left, top = card.evaluate(
        """(card) => {
            const [outer, inner] = [card, card.querySelector(".rw-picture")].map((e) => e.getBoundingClientRect());
            return [inner.left - outer.left, inner.top - outer.top];
        }"""
    )
    x, y = place.at(*ray)
    return bool(np.abs(saved[round(2 * (top + y)), round(2 * (left + x))] - red).max() <= 12)


def test_the_button_saves_the_visible_card(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([WIDGETS, "laser", "speed", "touch", "scanogram"], scale=2)
    nb.page.mouse.move(0, 0)
    for cell, name in ((2, "odom"), (3, "bumper-&-_b_"), (4, "scan"), (1, "scan")):
        card = nb.widget(cell).locator(".rw-card")
        file, saved = download(nb.page, card)
        assert re.fullmatch(rf"{name}-20\d\d(-\d\d){{5}}\.png", file)
        assert differences(saved, seen(card)) < 0.008, file  # the edges of letters
    nb.theme("dark")
    _, saved = download(nb.page, card)
    assert differences(saved, seen(card)) < 0.008


def test_the_button_needs_no_kernel_and_draws_finer_than_the_screen(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP + "laser.update(**fan())", "laser"], theme="dark")
    card = nb.widget(1).locator(".rw-card")
    with nb.busy("laser.update(**fan())"):
        locate(card, colour=DARK["reading"])
        before = layers(card)
        _, live = download(nb.page, card)
        card.locator(".rw-freeze").click()
        _, frozen = download(nb.page, card)
        place = locate(card, colour=DARK["reading"])
    for saved in (live, frozen):
        box = card.bounding_box()
        assert box
        assert saved.shape[:2] == (round(2 * box["height"]), round(2 * box["width"]))
        assert all(red_at(saved, card, place, ray, DARK["reading"]) for ray in FAN)
        assert saved[-4, 4].tolist() == list(Picture(card).paper)
    assert layers(card) == before, "the view itself was left as fine as the screen"


SAVE = """
laser.update(**fan())
saving = laser.save_png("called.png")
laser.update(**fan({9: 0.9}))
done = time.monotonic() + 1
while time.monotonic() < done:
    pass
"""
TWO_VIEWS = """
heard = []
laser.on_msg(lambda widget, content, buffers: heard.append(os.stat("called.png").st_ino))
saving = laser.save_png("called.png")
"""
GONE = """
os.mkdir("gone")
laser.save_png("gone/x.png")
os.rmdir("gone")
"""
UNSEEN = """
_png.PATIENCE = 0.2
try:
    await LaserWidget(title="/other").save_png("unseen.png")
except TimeoutError as error:
    print(error)
"""


def test_the_method_writes_the_file_when_the_page_answers(notebook: Callable[..., Notebook]) -> None:
    setup = SETUP + "import os, time\nfrom robowidgets.widget import png as _png\nlaser.has_rate = False"
    setup += "  # else it would turn gray where the pictures take long\nlaser.update(**fan())"
    nb = notebook([setup, "display(laser, laser)", SAVE, "print(await laser.save_png('awaited.png'))"])
    card = nb.widget(1).locator(".rw-card")
    place = locate(card, [*FAN[:9], (0.9, 0.0), *FAN[10:]])
    files = nb.lab.files
    assert nb.text(3).strip() == str(files / "awaited.png")
    called, awaited = (pixels((files / name).read_bytes()) for name in ("called.png", "awaited.png"))
    assert [red_at(called, card, place, ray, LIGHT["reading"]) for ray in (FAN[9], (0.9, 0.0))] == [True, False]
    assert [red_at(awaited, card, place, ray, LIGHT["reading"]) for ray in (FAN[9], (0.9, 0.0))] == [False, True]

    nb.run(nb.append(TWO_VIEWS))
    eventually(lambda: nb.python("len(heard)"), "2")
    assert nb.python("len(set(heard)) == 1 and repr(saving).endswith(': written>')") == "True"

    nb.run(nb.append(GONE))
    expect(card.locator(".rw-notice").first).to_contain_text("gone/x.png was not written: [Errno 2] No such file")
    nb.run(nb.append("await laser.save_png('awaited.png')"))
    expect(card.locator(".rw-notice").first).to_be_hidden()
    assert "unseen.png was not written: no page that shows this widget has answered" in nb.run(nb.append(UNSEEN))


def test_python_hears_why_a_page_cannot_draw(plain_page: Callable[..., PlainPage], tmp_path: Path) -> None:
    nb = plain_page([SETUP + "laser.update(**fan())", "laser"])
    expect(nb.widget(1).locator("canvas").first).to_be_visible()
    nb.page.evaluate("() => { HTMLCanvasElement.prototype.toDataURL = () => { throw new Error('no memory') } }")
    nb.python(f"saving = laser.save_png({str(tmp_path / 'a.png')!r})")
    said = "repr(saving).endswith('could not draw the picture: Error: no memory>')"
    eventually(lambda: nb.python(said), "True")

"""The scanogram: pointing, settings and zoom, and their values in Python."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from .chromium import shoot
from .laser import eventually
from .notebook import Notebook
from .plain_page import PlainPage

SETUP = """
import numpy as np
from robowidgets import ScanogramWidget

# 4000 scans in 400 s, 181 rays from -90 to 90 degrees, all at 3 m but one ray of one scan.
ranges = np.full((4000, 181), 3.0)
ranges[2000, 90] = 0.5
ranges[:, :20] = np.inf
scanogram = ScanogramWidget(title="/scan")
scanogram.update(times_ns=np.arange(4000) * 100_000_000, ranges=ranges, angle_min=-np.pi / 2,
                 angle_increment=np.pi / 180, range_min=0.1, range_max=10.0)
scanogram.set_touches([(100.0, 100.5, "left")], title="/bumper")
scanogram
"""
FOLLOWER = """
from ipywidgets import FloatText, jslink
follower = FloatText()
jslink((scanogram, "time"), (follower, "value"))
follower
"""
LEFT, RIGHT, TOP = 64, 16, 16


def card_of(nb: Notebook | PlainPage) -> Locator:
    return nb.widget(0).locator(".rw-card")


def picture_of(card: Locator) -> Locator:
    return card.locator(".rw-picture")


def at(card: Locator, seconds: float, view: tuple[float, float] = (0, 400), y: float = 100) -> dict[str, float]:
    """The position of a time in the picture."""
    width = picture_of(card).evaluate("(picture) => picture.clientWidth") - LEFT - RIGHT
    return {"x": LEFT + (seconds - view[0]) / (view[1] - view[0]) * width, "y": y}


def height_of(card: Locator, index: int) -> float:
    """The position of a ray in the picture: 18 pixels below it are the touches, 24 the axis."""
    height = picture_of(card).evaluate("(picture) => picture.clientHeight") - TOP - 24 - 18
    return float(TOP + (1 - (index + 0.5) / 181) * height)


def drag(card: Locator, start: dict[str, float], end: dict[str, float], key: str = "") -> None:
    box = picture_of(card).bounding_box()
    assert box
    mouse, keyboard = card.page.mouse, card.page.keyboard
    mouse.move(box["x"] + start["x"], box["y"] + start["y"])
    if key:
        keyboard.down(key)
    mouse.down()
    mouse.move(box["x"] + end["x"], box["y"] + end["y"], steps=3)
    mouse.up()
    if key:
        keyboard.up(key)


def says(card: Locator, *words: str) -> None:
    popup = card.locator(".rw-popup:visible")
    for word in words:
        expect(popup).to_contain_text(word)


@pytest.mark.core
def test_pointing_clicks_and_drags_reach_python(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP])
    nb.resize(900)
    card = card_of(nb)
    expect(card.locator(".rw-facts")).to_have_text("4 000 scans · 181 rays · 400.0 s".replace(" 0", "\u202f0"))

    picture_of(card).hover(position=at(card, 200.1, y=height_of(card, 90)))
    says(card, "ranges[90]", "0.50 m", "0.0°", "nearest of")
    picture_of(card).hover(position=at(card, 50, y=height_of(card, 5)))
    says(card, "ranges[5]", "+inf", "−85.0°", "nothing within 10 m", "right")
    strip = picture_of(card).evaluate("(picture) => picture.clientHeight") - 30
    picture_of(card).hover(position=at(card, 100.2, y=strip))
    says(card, "/bumper", "touched", "left", "100.00 – 100.50 s")

    picture_of(card).click(position=at(card, 300))
    eventually(lambda: nb.python("print(round(scanogram.time))").strip(), "300")

    drag(card, at(card, 100), at(card, 150))
    eventually(lambda: nb.python("print(*(round(t) for t in scanogram.selection or ()))").strip(), "100 150")
    expect(card.locator(".rw-scanogram-selected")).to_contain_text("500 scans")
    drag(card, at(card, 100, y=height_of(card, 120)), at(card, 150, y=height_of(card, 60)), "Shift")
    eventually(lambda: nb.python("print(len(scanogram.selection or ()))").strip(), "4")
    first, stop = nb.python("print(*scanogram.selection[2:])").split()
    assert (int(first), int(stop)) == (pytest.approx(60, abs=1), pytest.approx(121, abs=1))
    card.get_by_role("button", name="Clear the selection").click()
    eventually(lambda: nb.python("print(scanogram.selection)").strip(), "None")
    nb.python("scanogram.selection = (1, 2)\nscanogram.time = 12.5")
    expect(card.locator(".rw-scanogram-selected")).to_contain_text("1.00 – 2.00 s")
    expect(card.locator(".rw-scanogram-cursor")).to_have_text("t 12.50 s")

    nb.python("scanogram.view, scanogram.time = (199.8, 204.0), 200.0")
    picture_of(card).hover(position=at(card, 200.05, (199.8, 204.0)))
    expect(card.locator(".rw-popup:visible")).not_to_contain_text("nearest of")
    picture_of(card).focus()
    for key, now in (("ArrowRight", "200.1"), ("Shift+ArrowRight", "201.1"), ("ArrowLeft", "201.0"), ("Home", "0")):
        nb.page.keyboard.press(key)
        eventually(lambda: nb.python("print(f'{scanogram.time:.4g}')").strip(), now.removesuffix(".0"))
    nb.page.keyboard.press("0")
    eventually(lambda: nb.python("print(scanogram.view)").strip(), "None")
    nb.page.keyboard.press("End")
    nb.page.keyboard.press("+")
    eventually(lambda: nb.python("print(*(round(t) for t in scanogram.view or ()))").strip(), "200 400")
    nb.page.keyboard.press("Escape")
    eventually(lambda: nb.python("print(scanogram.selection)").strip(), "None")
    nb.python("scanogram.marks = [(20, 30, 'too near'), (240.5, 240.5, 'bump')]\nscanogram.view = (0, 100)")
    picture_of(card).hover(position=at(card, 25, (0, 100), y=9))
    says(card, "too near", "20.00 – 30.00 s")
    for key, now in (("Home", "0"), ("n", "20"), ("n", "240.5"), ("n", "240.5"), ("p", "20")):
        nb.page.keyboard.press(key)
        eventually(lambda: nb.python("print(f'{scanogram.time:.4g}')").strip(), now)
        # It follows the time, in a message of its own.
        eventually(lambda: nb.python("print(scanogram.view[0] <= scanogram.time <= scanogram.view[1])").strip(), "True")


def test_a_drag_that_is_cancelled_selects_nothing(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP], touch=True)
    nb.resize(900)
    card = card_of(nb)
    selected = card.locator(".rw-scanogram-selected")
    box = picture_of(card).bounding_box()
    assert box
    session = nb.page.context.new_cdp_session(nb.page)

    def touch(kind: str, *times: float) -> None:
        places = [at(card, seconds) for seconds in times]
        points = [{"x": box["x"] + place["x"], "y": box["y"] + place["y"], "id": i} for i, place in enumerate(places)]
        session.send("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": points})

    touch("Start", 100)
    touch("Move", 120)
    touch("Move", 150)
    expect(selected).to_contain_text("100.00 \u2013 150.00 s")
    touch("Start", 150, 300)
    touch("Move", 150, 350)
    touch("Move", 150)  # the second finger is lifted
    expect(selected, "a second finger drags nothing").to_contain_text("100.00 \u2013 150.00 s")
    touch("Cancel")
    expect(selected, "the finger scrolls the page").to_have_text("")
    assert nb.python("print(scanogram.selection)").strip() == "None"

    nb.python("scanogram.selection = (1, 2)")
    mouse, keys = nb.page.mouse, nb.page.keyboard
    mouse.move(box["x"] + at(card, 100)["x"], box["y"] + 100)
    mouse.down()
    mouse.move(box["x"] + at(card, 150)["x"], box["y"] + 100, steps=3)
    expect(selected).to_contain_text("500 scans")
    keys.press("Escape")
    mouse.move(box["x"] + at(card, 200)["x"], box["y"] + 100, steps=3)
    expect(selected, "Escape puts back what was").to_contain_text("1.00 \u2013 2.00 s")
    mouse.up()
    assert nb.python("print(scanogram.selection)").strip() == "(1.0, 2.0)"
    keys.press("Escape")
    eventually(lambda: nb.python("print(scanogram.selection)").strip(), "None")


def test_the_wheel_zooms_down_to_single_scans_while_a_cell_runs(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP])
    nb.resize(900)
    card = card_of(nb)
    everything = card.get_by_role("button", name="Show all of it")
    expect(everything).to_be_disabled()
    spot = at(card, 200.05, y=height_of(card, 90))
    with nb.busy():
        picture_of(card).hover(position=at(card, 100))
        box = picture_of(card).bounding_box()
        assert box
        nb.page.mouse.move(box["x"] + spot["x"], box["y"] + spot["y"], steps=3)  # a moving mouse, as the wheel requires
        for _ in range(10):
            nb.page.mouse.wheel(0, -200)
        expect(everything, "it zooms in the page").to_be_enabled()
        says(card, "ranges[90]")
    eventually(lambda: len(nb.python("print(scanogram.view)").split()), 2)
    start, end = (float(t) for t in nb.python("print(*scanogram.view)").split())
    assert start < 200.05 < end < start + 4
    spot = at(card, 200.05, (start, end), height_of(card, 90))
    picture_of(card).hover(position=spot)
    says(card, "0.50 m", "200.00 s  scan 2", "000")
    expect(card.locator(".rw-popup:visible"), "the very scan is known").not_to_contain_text("nearest of")
    for _ in range(10):
        nb.page.mouse.wheel(0, -200)
    eventually(lambda: nb.python("print(round(scanogram.view[1] - scanogram.view[0], 3))").strip(), "0.1")
    picture_of(card).dblclick(position=spot)
    eventually(lambda: nb.python("print(scanogram.view)").strip(), "None")


def shows_the_state(page: Page, card: Locator) -> None:
    expect(card.locator(".rw-scanogram-cursor")).to_have_text("t 201.00 s")
    expect(card.locator(".rw-scanogram-selected")).to_contain_text("199.00 – 202.00 s · 30 scans")
    expect(card.locator(".rw-scanogram-key")).to_contain_text("11 %nothing")
    picture_of(card).hover(position=at(card, 200.05, (190, 210), height_of(card, 90)))
    says(card, "ranges[90]", "0.50 m", "200.00 s")


def test_a_link_in_the_page_a_reload_and_an_export_have_the_present_view(
    notebook: Callable[..., Notebook], static_page: Callable[[Path], Page]
) -> None:
    nb = notebook([SETUP, FOLLOWER])
    nb.resize(900)
    card = card_of(nb)
    picture_of(card).click(position=at(card, 300))
    eventually(lambda: nb.python("print(round(scanogram.time))").strip(), "300")
    slider = nb.widget(1).locator("input")
    eventually(lambda: float(slider.input_value()) == pytest.approx(300, abs=1), True)
    nb.python("scanogram.view, scanogram.selection, scanogram.time = (190, 210), (199, 202), 201.0")
    shows_the_state(nb.page, card)
    eventually(lambda: nb.python("print(len(scanogram.get_state('_detail')['_detail']) > 0)").strip(), "True")
    picture_of(card).hover(position=at(card, 200.05, (190, 210), height_of(card, 90)))
    expect(card.locator(".rw-popup:visible")).not_to_contain_text("nearest of")
    nb.reload()
    shows_the_state(nb.page, card_of(nb))
    saved = nb.save()
    subprocess.run([sys.executable, "-m", "nbconvert", "--to", "html", saved], check=True)
    page = static_page(saved.with_suffix(".html"))
    shows_the_state(page, page.locator(".rw-scanogram"))


RECORDINGS = ("neato_fsm", "tilt_laser.bag")


@pytest.mark.parametrize(("theme", "scale", "widths"), [("light", 1, (320, 1200)), ("dark", 2, (700,))])
def test_real_recordings_fit_wide_and_narrow_pages(
    plain_page: Callable[..., PlainPage], data: Path, theme: str, scale: int, widths: tuple[int, ...]
) -> None:
    cells = ["import robowidgets"]
    for file in RECORDINGS:
        path = str(data / "good" / file)
        cells.append(f"r = robowidgets.open({path!r})\ns = r.scanogram()\ns.time = r.duration / 3\ns")
    nb = plain_page(cells, theme=theme, scale=scale)
    for width in widths:
        nb.resize(width)
        for i, file in enumerate(RECORDINGS, start=1):
            card = nb.widget(i).locator(".rw-card")
            expect(card.locator(".rw-scanogram-key b").first).to_contain_text(" m")
            inside = card.evaluate("(card) => card.scrollWidth <= card.clientWidth")
            assert inside, f"{file} is wider than its place at {width} px"
            shoot(card, f"scanogram-{file.split('.')[0]}-{theme}-{width}")

"""Widgets in narrow columns and side by side."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import LIGHT, Picture, eventually, listen, words
from .plain_page import PlainPage

SCANS = """
import numpy as np
from ipywidgets import HBox
from robowidgets import LaserWidget, SpeedWidget, TouchWidget

def sweep(degrees, rays):
    laser = LaserWidget(title="/scan")
    ranges = 3 + 0.4 * np.sin(np.linspace(0, 20, rays))
    step = np.radians(degrees / (rays if degrees == 360 else rays - 1))
    laser.update(ranges=ranges, angle_min=-np.radians(degrees / 2), angle_increment=step, range_min=0.1, range_max=4.0)
    return laser
"""
OVERLAP = """(popup) => {
    const names = ["expression", "side", "distance", "angle", "foot .rw-unfold", "foot .rw-angle-unit"];
    const words = names.map((name) => popup.querySelector(`.rw-popup-${name}`));
    const boxes = words.map((word) => word.getBoundingClientRect());
    const outer = popup.getBoundingClientRect();
    const cut = boxes.filter(({ left, right, top, bottom }) =>
        left < outer.left || right > outer.right || top < outer.top || bottom > outer.bottom);
    const isSpilt = words.some(({ scrollWidth, clientWidth }) => clientWidth && scrollWidth > clientWidth);
    return cut.length || isSpilt || boxes.some((a, i) => boxes.slice(i + 1).some((b) =>
        a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom));
}"""
"""Return True if texts of a pop-up overlap, or lie outside of it."""

ENDS = """(title) => {
    const [first, last] = [title.firstChild.firstChild, title.lastChild.firstChild ?? title.firstChild.firstChild];
    const { left, right } = title.getBoundingClientRect();
    const range = document.createRange();
    range.setStart(first, 0);
    range.setEnd(first, 1);
    const isStart = range.getBoundingClientRect().left >= left - 0.5;
    range.setStart(last, last.length - 1);
    range.setEnd(last, last.length);
    return [isStart, range.getBoundingClientRect().right <= right + 0.5];
}"""
"""Return two booleans, true if the first and the last letter of a title are in view."""


def width_of_area(card: Locator) -> float:
    """CSS pixels from the leftmost to the rightmost pixel of the area."""
    picture = Picture(card)
    columns = np.nonzero((picture._seen == LIGHT["area"]).all(axis=-1).any(axis=0))[0]
    return float(np.ptp(columns) + 1) / picture.ratio if columns.size else 0.0


def test_the_area_fills_a_narrow_card(plain_page: Callable[..., PlainPage]) -> None:
    cells = ["sweep(180, 181)", "sweep(270, 1081)", "sweep(360, 360)", "sweep(240, 682)"]
    nb = plain_page([SCANS, *cells])
    nb.resize(270)
    for index, cell in enumerate(cells, 1):
        card = nb.widget(index).locator(".rw-card")
        eventually(lambda card=card: width_of_area(card) >= 0.6 * 270, True)
        shoot(card, f"narrow-{cell[6:9]}")


def test_the_height_of_a_picture_follows_the_sweep_and_the_first_scan_moves_nothing(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([SCANS, "half = sweep(180, 181)\nhalf", "sweep(360, 360)", "late = LaserWidget()\nlate"])
    half, whole, late = (nb.widget(index).locator(".rw-card") for index in (1, 2, 3))
    for width in (760, 560, 420):
        nb.resize(width)
        eventually(lambda: width_of_area(half) >= 0.6 * nb.page.viewport_size["width"], True)  # type: ignore[index]
        picture = Picture(half)
        radius = width_of_area(half) / 2
        assert picture.height < radius + 80, f"{width}: a label and the scanner have room, and nothing else"
        assert Picture(whole).height > 1.3 * picture.height
        shoot(half, f"half-{width}")
    before = late.bounding_box()
    expect(late.locator(".rw-empty")).to_have_text("waiting for a scan")
    nb.python("late.update(half.scan)")
    expect(late.locator(".rw-empty")).to_be_hidden()
    assert late.bounding_box() == before
    nb.python("half.forward = 'right'")
    eventually(lambda: Picture(half).height > 1.3 * picture.height, True)


def test_a_pop_up_is_never_over_itself(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCANS, "laser = sweep(270, 1081)\nlaser.pinned = 1000\nlaser"])
    card = nb.widget(1).locator(".rw-card")
    for width in (226, 260, 280, 320, 400, 700):
        nb.resize(width)
        expect(card.locator(".rw-popup:visible .rw-popup-side")).to_have_text("left")
        eventually(lambda: card.locator(".rw-popup:visible").evaluate(OVERLAP), False)
        if width == 226:
            shoot(card, "narrow-popup")


def test_before_the_first_scan_there_are_no_numbers(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCANS + "laser = LaserWidget()\nlaser"], run=False)
    listen(nb.page)
    nb.run_all()
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-empty")).to_have_text("waiting for a scan")
    eventually(lambda: Picture(card).count(LIGHT["area"]) > 10_000, True)
    assert words(card) == set()
    assert not any(letter.isdigit() for letter in card.inner_text())
    nb.python("laser.update(ranges=[1.0] * 91, angle_min=-0.8, angle_increment=0.0178, range_min=0.1, range_max=4.0)")
    eventually(lambda: {"0.1°", "2 m"} <= words(card), True)


def test_cards_side_by_side_have_room_between_them(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCANS, "HBox([sweep(270, 541), SpeedWidget(), TouchWidget()])"])
    nb.resize(1220)
    boxes = [card.bounding_box() for card in nb.output(1).locator(".rw-card").all()]
    edges = [(box["x"], box["x"] + box["width"]) for box in boxes if box]
    assert len(edges) == 3
    for (_, right), (left, _) in pairwise(edges):
        assert 4 <= left - right <= 12
    shoot(nb.output(1), "side-by-side")


def test_controls_stand_on_the_right_also_without_a_title(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCANS, "laser = sweep(270, 541)\nlaser.title = ''\nlaser"])
    header = nb.widget(1).locator(".rw-header")
    for width in (270, 390, 700):
        nb.resize(width)
        around, controls = header.bounding_box(), header.locator(".rw-controls").bounding_box()
        assert around
        assert controls
        assert around["x"] + around["width"] - controls["x"] - controls["width"] <= 12, width


def test_a_long_title_of_a_scanogram_pushes_no_control_out_of_a_narrow_card(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page(["import robowidgets\nwide = robowidgets.open(robowidgets.SAMPLE).scanogram()\nwide"])
    nb.python("wide.title = 'a wall comes closer'")
    header = nb.widget(0).locator(".rw-header")
    expect(header).to_contain_text("a wall comes closer")
    nb.resize(345)
    around, controls = header.bounding_box(), header.locator(".rw-controls").bounding_box()
    assert around
    assert controls
    assert controls["x"] + controls["width"] <= around["x"] + around["width"]


def test_the_footer_of_a_laser_ends_where_it_should(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCANS, "sweep(270, 541)"])
    nb.resize(700)
    footer = nb.widget(1).locator(".rw-footer")
    expect(footer.locator(".rw-nearest")).to_contain_text("nearest")
    blank = footer.evaluate(
        """(footer) => {
            const range = document.createRange();
            range.selectNodeContents(footer.querySelector(".rw-nearest"));
            return footer.getBoundingClientRect().right - range.getBoundingClientRect().right;
        }"""
    )
    assert blank <= 14


def test_a_name_without_room_loses_its_middle(plain_page: Callable[..., PlainPage]) -> None:
    titles = ("/stable_scan", "/front/scan")
    nb = plain_page([SCANS, *(f"laser = sweep(270, 541)\nlaser.title = {title!r}\nlaser" for title in titles)])
    for index, title in enumerate(titles, 1):
        card = nb.widget(index).locator(".rw-card")
        expect(card.locator(".rw-title")).to_have_text(title)
        for room in (120, 60, 44, 30):
            card.locator(".rw-title").evaluate("(title, room) => { title.style.flex = `0 0 ${room}px`; }", room)
            assert card.locator(".rw-title").evaluate(ENDS) == [True, True], f"{title} in {room} px"
    nb.python("laser.title = '/odom'")
    expect(card.locator(".rw-title")).to_have_text("/odom", use_inner_text=True)  # as it is copied

"""Legends have texts at every width, and nothing in them is cut off or moves while samples come."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import SETUP, eventually
from .plain_page import PlainPage

SCAN = """
def scan(nothing=51, none=1, close=0):
    ranges = np.linspace(0.8, 3, 541)
    ranges[:nothing], ranges[100 : 100 + none], ranges[200 : 200 + close] = inf, nan, -inf
    return dict(ranges=ranges, angle_min=-2.356, angle_increment=0.00873, range_min=0.6, range_max=4.0)
laser.update(**scan())
laser
"""
CUT = """(footer) => {
    const outer = footer.getBoundingClientRect();
    const all = [...footer.querySelectorAll("*:not(.rw-drag-hint > *)")];
    const leaves = all.filter((e) => !e.children.length && e.checkVisibility());
    return leaves.filter((leaf) => {
        const { left, right, top, bottom } = leaf.getBoundingClientRect();
        return left < outer.left || right > outer.right || top < outer.top || bottom > outer.bottom
            || leaf.scrollWidth > Math.ceil(leaf.getBoundingClientRect().width);
    }).map((leaf) => leaf.textContent);
}"""
"""The parts of a footer that are cut off, without the hint, which appears only if it has room."""


def shown(card: Locator) -> list[str]:
    """The counts on show, as text."""
    return [" ".join(text.split()[1:]) for text in card.locator(".rw-class:visible").all_inner_texts()]


def test_a_laser_legend_says_in_words_what_the_scanner_sends(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP + SCAN])
    card = nb.widget(0).locator(".rw-card")
    for width in (290, 320, 400, 459, 460, 520, 690, 1000):
        nb.resize(width)
        eventually(lambda: shown(card), ["489 readings", "51 nothing in range", "1 no measurement"])
        assert card.locator(".rw-footer").evaluate(CUT) == [], width
        if width in (290, 400, 690):
            shoot(card, f"legend-laser-{width}")
    nb.python("laser.update(**scan(none=40, close=7) | {'range_min': 1.1})")
    eventually(lambda: len(shown(card)), 5)
    for width in (290, 400, 520, 690, 760):
        nb.resize(width)
        expect(card.locator(".rw-footer")).to_contain_text("too close")
        assert card.locator(".rw-footer").evaluate(CUT) == [], width
        shoot(card, f"legend-laser-all-{width}")


@pytest.mark.parametrize("width", [300, 480, 560, 640])
def test_a_laser_keeps_its_height_while_counts_change(plain_page: Callable[..., PlainPage], width: int) -> None:
    nb = plain_page([SETUP + SCAN])
    nb.resize(width)
    card = nb.widget(0).locator(".rw-card")
    nb.python("laser.update(**scan(nothing=100, none=100, close=100))")
    eventually(lambda: shown(card), ["241 readings", "100 nothing in range", "100 no measurement", "100 too close"])
    height = card.evaluate("(card) => card.offsetHeight")
    nb.python("laser.update(**scan(nothing=0, none=1))")
    eventually(lambda: shown(card), ["540 readings", "0 nothing in range", "1 no measurement", "0 too close"])
    assert card.evaluate("(card) => card.offsetHeight") == height
    card.locator(".rw-freeze").click()
    nb.python("laser.update(**scan(nothing=9))")
    expect(card.locator(".rw-steps")).to_be_visible()
    assert card.evaluate("(card) => card.offsetHeight") == height, "freezing moves nothing below"


def test_three_bumpers_stand_side_by_side_in_260_pixels(plain_page: Callable[..., PlainPage]) -> None:
    source = "from robowidgets import TouchWidget\ntouch = TouchWidget(title='/bumper')\n"
    nb = plain_page([f"{source}touch.update(left=True, center=None, right=False)\ntouch"])
    nb.resize(260)
    card = nb.widget(0).locator(".rw-card")
    tiles = card.locator(".rw-tile")
    expect(tiles.locator(".rw-tile-label")).to_have_text(["left", "center", "right"])
    boxes = [tile.bounding_box() for tile in tiles.all()]
    assert len({box["y"] for box in boxes if box}) == 1
    assert sorted(box["x"] for box in boxes if box) == [box["x"] for box in boxes if box]
    assert tiles.evaluate_all("(tiles) => tiles.filter((tile) => tile.scrollWidth > tile.clientWidth).length") == 0
    shoot(card, "touch-three-260")

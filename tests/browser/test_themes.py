"""The themes for a projector and for paper, and the print of a feed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import expect

from .chromium import LOOKS, shoot
from .laser import SETUP, Picture, eventually
from .plain_page import PlainPage

SCREEN = f"""{SETUP}
from robowidgets import SpeedWidget, screen
speed = SpeedWidget(title="/odom", theme="light")
speed.update(linear=(0.4, 0, 0), angular=(0, 0, 0.2))
laser.update(**fan())
both = screen(laser, speed)
both
"""
FEED = """
from robowidgets import feeds
robot = feeds.simulator("turtlebot3", wander=False)
robot.show("/scan", "/odom", "/bumper")
"""
ALONE = "laser"
SEEN = """(card) => {
    const { left, right, width } = card.getBoundingClientRect();
    const [title, canvas] = [card.querySelector(".rw-title"), card.querySelector(".rw-layer")];
    return {
        left, right, width, title: title.getBoundingClientRect().height, zoom: card.currentCSSZoom,
        sharp: canvas ? canvas.width / (canvas.getBoundingClientRect().width * devicePixelRatio) : 1,
        look: card.dataset.rwLook, theme: card.dataset.rwTheme,
    };
}"""
WHITE, BLACK = (255, 255, 255), (0, 0, 0)


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_screen_passes_its_theme_on_to_its_widgets_and_one_for_a_projector_is_larger_and_sharp_at_its_pointer(
    plain_page: Callable[..., PlainPage], theme: Any, scale: int
) -> None:
    nb = plain_page([SCREEN, ALONE], theme=theme, scale=scale)
    laser, speed = (nb.output(0).locator(f".rw-{name}") for name in ("laser", "speed"))
    alone = nb.output(1).locator(".rw-laser")
    before = laser.evaluate(SEEN)
    assert (before["zoom"], before["theme"], speed.evaluate(SEEN)["theme"]) == (1, theme, "light")

    nb.python("both.theme = 'projector'")
    for card in (laser, speed):
        expect(card).to_have_attribute("data-rw-theme", theme)
        eventually(lambda card=card: card.evaluate(SEEN)["sharp"], pytest.approx(1, abs=0.01))
        seen = card.evaluate(SEEN)
        assert (seen["zoom"], seen["look"]) == (1.5, "projector")
        assert seen["right"] <= 1200 - before["left"] + 1
    assert laser.evaluate(SEEN)["title"] == pytest.approx(1.5 * before["title"], abs=1)
    assert alone.evaluate(SEEN)["zoom"] == 1
    shoot(nb.output(0), f"projector-{theme}")
    box = laser.locator(".rw-picture").bounding_box()
    assert box
    nb.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 0.3 * box["height"])
    eventually(lambda: nb.python("print(laser.hovered)").strip(), "9")

    # A widget alone on the page has its own theme.
    nb.python("both.theme = 'auto'; laser.theme = 'paper'")
    expect(laser).to_have_attribute("data-rw-look", "paper")
    expect(speed).to_have_attribute("data-rw-look", "light")
    for card in (laser, alone):
        eventually(lambda card=card: Picture(card).count(BLACK) > 100, True)
        assert Picture(card).paper == WHITE
        colours = Picture(card)
        assert colours.colour(colours.width / 2, 0.75 * colours.height) == WHITE, "the area is an outline"
    shoot(alone, f"paper-{theme}")


def test_a_feed_on_wide_paper_is_printed_whole_and_without_stop(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FEED], width=1100)
    cards = nb.output(0).locator(".rw-screen .rw-card")
    expect(cards).to_have_count(4)
    nb.page.emulate_media(media="print")
    expect(nb.output(0).locator(".rw-stop-bar")).to_be_hidden()
    tops = cards.evaluate_all("(cards) => cards.map((card) => card.getBoundingClientRect().top)")
    assert min(tops) >= nb.output(0).locator(".rw-feed").evaluate("(feed) => feed.getBoundingClientRect().top")
    nb.python("robot.close()")

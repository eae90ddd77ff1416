"""The lines of a function in the player of a recording: its time, graphs, marks of a line, and the pointed ray."""

from __future__ import annotations

import re
from collections.abc import Callable

from playwright.sync_api import Locator, expect

from .chromium import shoot
from .plain_page import PlainPage

OPEN = """
import robowidgets

def near(scan):
    front = scan.distance("front")
    if front < 0.6:
        return True
    return scan.distance() < 0.4

player = robowidgets.open(robowidgets.SAMPLE).show("/scan", scanogram=False, lines=near)
player
"""


def values(widget: Locator, number: int) -> Locator:
    return widget.locator(".rw-line").nth(number - 1).locator(".rw-line-values")


def test_lines_follow_the_player_mark_their_spans_and_know_the_pointed_ray(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([OPEN], width=1000, height=1400, scale=2)
    card = nb.page.locator(".rw-lines")
    expect(card.locator(".rw-title")).to_have_text("near")
    expect(card.locator(".rw-footer")).to_contain_text("called at each recorded sample; what is outside")
    expect(card.locator(".rw-footer")).not_to_contain_text("is being computed")
    expect(card.locator(".rw-freeze")).to_be_hidden()
    slider = nb.page.locator(".rw-player input[type=range]")
    slider.evaluate("(slider) => { slider.value = 8.5; slider.dispatchEvent(new Event('input')); }")
    expect(card.locator(".rw-facts")).to_contain_text("8.50 s")
    expect(values(card, 3)).to_have_text(re.compile(r"^True0\.\d\d < 0\.60$"))
    expect(values(card, 5)).to_have_text("not reached")
    slider.evaluate("(slider) => { slider.value = 20; slider.dispatchEvent(new Event('input')); }")
    expect(values(card, 4)).to_have_text("not reached")

    # A line marks its spans, to which n leads.
    line = card.locator(".rw-line").nth(2)
    line.focus()
    expect(card.locator(".rw-footer")).to_contain_text("click or Enter marks when")
    nb.page.keyboard.press("Enter")
    expect(line).to_have_attribute("aria-selected", "true")
    expect(card.locator(".rw-footer")).to_contain_text("line 6 was true: 10 times; n and p go there")
    expect(nb.page.locator(".rw-play-mark-words")).to_contain_text("of 10: line 6 was true")
    nb.page.keyboard.press("n")
    expect(values(card, 3)).to_contain_text("True")
    shoot(nb.page.locator(".rw-recording"), "lines-in-player")

    # A ray that is pinned in the laser marks the lines that read it.
    nb.python("player.views[0].widget.pinned = 225")
    expect(card.locator(".rw-line").nth(1)).to_have_attribute("data-ray", "true")
    expect(card.locator(".rw-line").nth(2)).to_have_attribute("data-ray", "false")
    for theme in ("light", "dark"):
        nb.theme(theme)
        for width in (1000, 400):
            nb.resize(width)
            shoot(card, f"lines-recorded-{width}-{theme}")
    nb.resize(1000)

    line.focus()
    nb.page.keyboard.press("Escape")
    expect(line).not_to_have_attribute("aria-selected", "true")
    nb.python("player.close()")

"""The laser explains its controls: by a hint, the cursor, labels of buttons, and a list of its keys."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import shoot
from .laser import SETUP, locate
from .plain_page import PlainPage
from .test_sectors import arc, chip, drag

FIRST = f"{SETUP}\nlaser.update(**fan())\nlaser"
HINT = "drag along an arc to select rays"


def test_the_footer_says_that_an_arc_can_be_dragged_until_the_first_drag(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST])
    nb.resize(760)
    card = nb.widget(0).locator(".rw-card")
    picture, hint = card.locator(".rw-picture"), card.locator(".rw-drag-hint")
    expect(hint).to_have_text(HINT)
    place = locate(card)
    inside = hint.evaluate(
        """(hint) => {
            const [outer, inner] = [hint, hint.firstElementChild].map((one) => one.getBoundingClientRect());
            return inner.bottom <= outer.bottom && inner.left >= outer.left && inner.right <= outer.right;
        }"""
    )
    assert inside, "it has room"
    shoot(card, "laser-hint")
    expect(picture).to_have_attribute("aria-description", re.compile("^Drag along an arc to select rays"))
    x, y = place.at(2.5, 20)
    picture.hover(position={"x": x, "y": y})
    expect(picture).to_have_css("cursor", "crosshair")
    picture.hover(position={"x": 4, "y": 4})
    expect(picture).not_to_have_css("cursor", "crosshair")
    nb.python("laser.sectors['ahead'] = ('-10deg', '10deg')")  # set by a program: the user has not dragged yet
    expect(hint).to_have_text(HINT)
    height = card.evaluate("(card) => card.querySelector('.rw-footer').offsetHeight")
    drag(nb, card, *arc(place, 3.0, 22, 48))
    expect(chip(card)).to_be_visible()
    expect(hint).to_have_count(0)
    assert card.evaluate("(card) => card.querySelector('.rw-footer').offsetHeight") == height, "nothing moves"


@pytest.mark.parametrize("width", [760, 480, 360])
def test_the_picture_lists_its_keys(plain_page: Callable[..., PlainPage], width: int) -> None:
    nb = plain_page([FIRST])
    nb.resize(width)
    card, keys = nb.widget(0).locator(".rw-card"), nb.page.keyboard
    listed, button = card.locator(".rw-key-list"), card.get_by_role("button", name="What to press (?)")
    expect(listed).to_be_hidden()
    with nb.busy():
        button.click()
        expect(listed).to_be_visible()
        expect(button).to_have_attribute("aria-expanded", "true")
        for key, words in (("t", "type rays"), ("c", "copy code"), ("g", "ghost to compare with")):
            row = listed.locator("dt", has_text=re.compile(f"^{key}$"))
            expect(row.locator("xpath=following-sibling::dd[1]")).to_have_text(words)
        box, around = listed.bounding_box(), card.locator(".rw-picture").bounding_box()
        assert box
        assert around
        assert box["x"] >= around["x"]
        assert box["y"] + box["height"] <= around["y"] + around["height"]
        shoot(card, f"laser-keys-{width}")
        card.locator(".rw-picture").focus()
        keys.press("Escape")
        expect(listed).to_be_hidden()
        keys.press("?")
        expect(listed).to_be_visible()
        listed.click()
        expect(listed).to_be_hidden()
    assert nb.python("laser.pinned") == "", "the picture gets no click"


def test_counts_are_read_without_their_glyphs_and_the_button_for_rays_has_a_word(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([f"{SETUP}\nlaser.update(**fan({{3: inf, 7: -inf, 11: nan, 15: 0.3}}))\nlaser"])
    nb.resize(760)
    card = nb.widget(0).locator(".rw-card")
    for name in ("15 readings", "1 outside limits", "1 nothing in range", "1 no measurement", "1 too close"):
        kind = "button" if "readings" not in name else None
        if kind:
            expect(card.get_by_role("button", name=name, exact=True)).to_be_visible()
    expect(card.locator(".rw-counts")).to_contain_text("15 readings")
    expect(card.locator(".rw-type")).to_have_text("[:]Rays")
    expect(card.locator(".rw-type .rw-word")).to_be_visible()

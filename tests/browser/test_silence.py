"""A picture of old data is dimmed and shows their age, so that no user takes it for the present."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Literal

import pytest
from playwright.sync_api import Locator, expect

from .chromium import LOOKS, shoot
from .laser import SETUP, eventually
from .notebook import Notebook
from .plain_page import PlainPage
from .test_laser_live import freeze_of
from .test_png import differences, download, seen

WIDGETS = f"""{SETUP}
import time
from robowidgets import SpeedWidget, TouchWidget
from robowidgets.widget.pacer import pacer
speed = SpeedWidget(title="/odom", linear_limits=(-0.5, 0.5), planar=True)
touch = TouchWidget(title="/bumper", angles={{"left": 0.9, "center": 0.0, "right": -0.9}})

def update():
    laser.update(**fan({{3: inf, 5: 0.1}}))
    speed.update(linear=(0.62, 0, 0), angular=(0, 0, -0.24))
    speed.command(linear=(0.4, 0, 0), angular=(0, 0, 0))
    touch.update(left=True, center=False, right=False)
    pacer.flush()

def go_live():
    '''Half a second of data, so that there is a rate.'''
    for _ in range(8):
        update()
        time.sleep(0.07)

laser
"""
KINDS = ("laser", "speed", "touch")
SAID = re.compile(r"^no data for \d+\.\d s$")
DIMMED = """(card) => [...card.querySelectorAll(".rw-layer, .rw-board, .rw-field, .rw-footer > *")].map((part) => {
    const { opacity, filter, transitionDuration, animationName } = getComputedStyle(part);
    return [opacity < 0.5, filter === "grayscale(1)", transitionDuration === "0s", animationName === "none"];
})"""


def cards(nb: Notebook | PlainPage) -> list[Locator]:
    return [nb.widget(index).locator(".rw-card") for index in range(3)]


def is_dimmed(card: Locator) -> bool:
    """Return True if everything that shows data is dimmed, without motion; if not, nothing may be dimmed."""
    parts = card.evaluate(DIMMED)
    dimmed = [part[:2] == [True, True] for part in parts]
    assert len(parts) >= 2
    assert all(part[2:] == [True, True] for part in parts), "something moves"
    assert len(set(dimmed)) == 1, "some of it is dimmed, some is not"
    return dimmed[0]


def is_old(card: Locator) -> None:
    expect(card.locator(".rw-silence")).to_have_text(SAID)
    eventually(lambda: is_dimmed(card), True)


def is_new(card: Locator) -> None:
    expect(card.locator(".rw-silence")).to_be_hidden()
    eventually(lambda: is_dimmed(card), False)


def stands_free(card: Locator) -> bool:
    """Return True if the texts are whole and within the picture, above everything else, and larger than small print."""
    free: bool = card.evaluate("""(card) => {
        const said = card.querySelector(".rw-silence");
        const [box, picture] = [said, card.querySelector(".rw-picture")].map((part) => part.getBoundingClientRect());
        said.style.pointerEvents = "auto";
        const inside = box.left >= picture.left && box.right <= picture.right && box.bottom <= picture.bottom;
        const whole = said.scrollWidth <= said.clientWidth;
        const onTop = [0.1, 0.5, 0.9].every((share) => document.elementFromPoint(
            box.left + share * box.width, box.top + box.height / 2) === said);
        said.style.pointerEvents = "";
        return inside && onTop && whole && parseFloat(getComputedStyle(said).fontSize) >= 13;
    }""")
    return free


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_silent_picture_is_dimmed_also_in_a_png_and_says_for_how_long_and_a_frozen_one_is_not(
    plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"], scale: int
) -> None:
    nb = plain_page([WIDGETS, "speed", "touch"], scale=scale, theme=theme)
    nb.python("update()")
    for card in cards(nb):
        is_new(card)
    nb.python("go_live()")
    for card in cards(nb):
        is_old(card)
    for card in cards(nb):
        _, saved = download(nb.page, card)
        assert differences(saved, seen(card)) < 0.008
        assert (saved.max(axis=-1) - saved.min(axis=-1) > 60).sum() == 0, "there is colour in it"
    for width in (1200, 700, 320, 220):
        nb.resize(width)
        for card, kind in zip(cards(nb), KINDS, strict=True):
            is_old(card)
            card.scroll_into_view_if_needed()
            eventually(lambda card=card: stands_free(card), True)
            shoot(card, f"silence-{kind}-{theme}-{width}")
    nb.resize(700)
    for card, kind in zip(cards(nb), KINDS, strict=True):
        freeze_of(card).click()
        is_new(card)
        shoot(card, f"silence-{kind}-{theme}-frozen")
        freeze_of(card).click()
        is_old(card)
    nb.python("update()")
    for card in cards(nb):
        is_new(card)


def test_a_lost_connection_dims_what_speaks_in_events_too(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([WIDGETS, "speed", "touch"])
    nb.python(
        "for state in (1, 0, 1):\n    touch.update({'bumper': 1, 'state': state}); pacer.flush(); time.sleep(0.2)\n"
        "source = {'topic': '/bumper', 'type': 'kobuki_msgs/BumperEvent', 'status': ''}\n"
        "touch._source = source"
    )
    card = cards(nb)[2]
    expect(card.locator(".rw-facts")).to_contain_text("events")
    is_new(card)
    nb.python("touch._source = {**source, 'status': 'connection lost, trying again in 2 s', 'lost': True}")
    expect(card.locator(".rw-notice-text")).to_have_text("connection lost, trying again in 2 s")
    eventually(lambda: is_dimmed(card), True)
    expect(card.locator(".rw-silence")).to_be_hidden()
    shoot(card, "silence-touch-events-lost")
    nb.python("touch._source = source")
    is_new(card)

"""The touch widget on a page."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import eventually
from .plain_page import PlainPage

BUMPERS = """
from robowidgets import TouchWidget
touch = TouchWidget(title="/bumper")
touch
"""
KOBUKI = """
from robowidgets import TouchWidget
kobuki = TouchWidget(title="/mobile_base/sensors/core")
kobuki.update({"bumper": 6, "cliff": 1, "wheel_drop": 0})
kobuki
"""
AROUND = """
from robowidgets import TouchWidget
around = TouchWidget(title="/hazards", angles={
    "left": 1.15, "front left": 0.6, "front center": 0.0, "front right": -0.6, "right": -1.15,
    "cliff side left": 1.9, "cliff side right": -1.9, "rear": 3.14,
})
around.update({
    "left": False, "front left": True, "front center": True, "front right": False, "right": None,
    "cliff side left": True, "cliff side right": False, "rear": False, "wheel left": False, "wheel right": None,
})
around
"""
ODD = """
from robowidgets import TouchWidget
odd = TouchWidget(title="/contacts <b>", labels={"plain": "<img src=x onerror=alert(1)> & a label that has no end"})
odd.update({"plain": True, "robot::base_link::front_bumper_collision": False, "robot::arm::collision": None})
odd
"""


def tile(widget: Locator, label: str) -> Locator:
    """The rectangle of a sensor, by its label."""
    exactly = re.compile(f"^{re.escape(label)}$")
    return widget.locator(".rw-tile", has=widget.page.locator(".rw-tile-label", has_text=exactly))


def shows(widget: Locator, label: str, state: str, detail: str = "") -> None:
    """Wait until a sensor's rectangle says its state, in colour and in words."""
    expect(tile(widget, label)).to_have_attribute("data-state", state)
    expect(tile(widget, label).locator(".rw-tile-words")).to_have_text(re.compile(f"^{state}{detail}"))


def overlaps(widget: Locator) -> list[str]:
    """Labels of rectangles that leave the picture or lie over one another."""
    found: list[str] = widget.evaluate(
        """(card) => {
            const box = (element) => element.getBoundingClientRect();
            const picture = box(card.querySelector(".rw-picture"));
            const tiles = [...card.querySelectorAll(".rw-tile")].map((t) => ({ name: t.innerText, box: box(t) }));
            const outside = (a) => a.left < picture.left || a.right > picture.right
                || a.top < picture.top || a.bottom > picture.bottom;
            const over = (a, b) => a !== b && a.left < b.right && b.left < a.right
                && a.top < b.bottom && b.top < a.bottom;
            return tiles.filter((t) => outside(t.box) || tiles.some((other) => over(t.box, other.box)))
                .map((t) => t.name);
        }"""
    )
    return found


@pytest.mark.parametrize(("theme", "scale"), [("light", 1), ("dark", 2)])
def test_every_layout_fits_at_every_width(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([BUMPERS, KOBUKI, AROUND, ODD], scale=scale, theme=theme)
    for width in (320, 700, 1200):
        nb.resize(width)
        for index, (name, count) in enumerate({"waiting": 0, "kobuki": 8, "around": 10, "odd": 3}.items()):
            card = nb.widget(index).locator(".rw-card")
            expect(card.locator(".rw-tile")).to_have_count(count)
            assert overlaps(card) == []
            shoot(card, f"touch-{name}-{theme}-{width}")
    nb.resize(700)
    widget = nb.widget(0)
    nb.python(
        "for s in (1, 0, 1, 0, 1, 0): touch.update({'bumper': 0, 'state': s})\ntouch.update({'bumper': 1, 'state': 1})"
    )
    shows(widget, "center", "touched")
    widget.locator(".rw-freeze").click()
    nb.python(
        "touch.update({'bumper': 2, 'state': 1})\n"
        "try:\n    touch.update({'bumper': 9, 'state': 1})\n"
        "except ValueError: pass"
    )
    expect(widget.locator(".rw-notice")).to_contain_text("bumper: expected 0 (left), 1 (center) or 2 (right), got 9.")
    expect(widget.locator(".rw-freeze")).to_contain_text("1 since")
    shoot(widget.locator(".rw-card"), f"touch-frozen-{theme}-700")


@pytest.mark.core
def test_a_touch_is_seen_timed_counted_and_frozen(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([BUMPERS, "touch"])
    widget, second = nb.widget(0), nb.widget(1)
    expect(widget.locator(".rw-empty")).to_have_text("waiting for a touch message")
    widget.locator(".rw-freeze").click()
    nb.python("touch.update({'bumper': 0, 'state': 1})")
    expect(widget.locator(".rw-empty")).to_have_text("frozen before the first touch message")
    widget.locator(".rw-freeze").click()
    for view in (widget, second):
        shows(view, "left", "touched", r"\d\.\d s$")
        shows(view, "center", "unknown", "—")
    detail = tile(widget, "left").locator(".rw-tile-detail")
    expect(detail).to_have_text(re.compile(r"^[1-9]\d*\.\d s$"))

    widget.locator(".rw-picture").focus()
    nb.page.keyboard.press("Space")
    expect(widget.locator(".rw-freeze")).to_contain_text("Frozen")
    held = detail.inner_text()
    nb.python("touch.update({'bumper': 0, 'state': 0}); touch.update({'bumper': 2, 'state': 1})")
    expect(widget.locator(".rw-freeze")).to_contain_text("2 since")
    shows(widget, "left", "touched")
    shows(second, "right", "unknown")
    assert detail.inner_text() == held
    states = "print(touch.paused, touch.states['left'].name, touch.states['right'].name)"
    eventually(lambda: nb.python(states), "True TOUCHED UNKNOWN\n")

    nb.page.keyboard.press("Space")
    shows(widget, "left", "free", "1 touch$")
    shows(second, "right", "touched")
    # Python receives it a moment after the page has shown it.
    told = "FREE {'left': 1, 'center': 0, 'right': 1}\n"
    eventually(lambda: nb.python("print(touch.states['left'].name, touch.touches)"), told)

    nb.run(1)
    shows(nb.widget(1), "left", "free", "1 touch$")
    shows(nb.widget(1), "right", "touched", r"\d+\.\d s$")
    nb.python("touch.reset()")
    shows(nb.widget(0), "right", "unknown", "—")


def test_a_presence_is_released_without_another_message_also_while_a_cell_runs(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([BUMPERS])
    nb.python('touch.update({"contacts": [{"collision1": {"name": "bumper"}, "collision2": {"name": "wall"}}]})')
    with nb.busy():
        shows(nb.widget(0), "bumper", "free", "1 touch$")


def test_settings_change_while_it_runs_and_text_stays_text(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([ODD])
    widget = nb.widget(0)
    shows(widget, "<img src=x onerror=alert(1)> & a label that has no end", "touched")
    shows(widget, "front_bumper_collision", "free")
    expect(widget.locator("img, .rw-tile b")).to_have_count(0)
    expect(widget.locator(".rw-title")).to_have_text("/contacts <b>")

    nb.python("odd.labels = {'plain': 'Nose'}; odd.sensors = ['not heard of', 'plain']")
    shows(widget, "Nose", "touched")
    shows(widget, "not heard of", "unknown", "—")
    expect(widget.locator(".rw-tile-label")).to_have_text(["not heard of", "Nose"])
    expect(widget.locator(".rw-body")).to_have_count(0)
    nb.python("odd.update({'<b>tail</b>': True})")
    expect(widget.locator(".rw-beside")).to_have_text("also touched: <b>tail</b>")
    nb.python("odd.update({'<b>tail</b>': False})")
    expect(widget.locator(".rw-beside")).to_be_empty()

    nb.python("odd.angles = {'plain': 0.5}")
    mark = widget.locator(".rw-body-mark")
    expect(mark).to_have_attribute("data-state", "touched")
    assert overlaps(widget.locator(".rw-card")) == []
    nb.python("odd.update(plain=False)")
    expect(mark).to_have_attribute("data-state", "free")
    nb.python("odd.angles = {}")
    expect(widget.locator(".rw-body")).to_have_count(0)

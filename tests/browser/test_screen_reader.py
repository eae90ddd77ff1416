"""The output of the widgets for screen readers, and the faults that axe-core finds."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import expect

from .laser import SETUP, eventually
from .plain_page import PlainPage
from .test_styles import KINDS, WIDGETS

MARK = re.compile(r"^\+inf: nothing in range.*\n\+inf \(REP 117\): the beam met")
DESCRIPTION = re.compile(r"^Drag along an arc.* such as \[225\], is an index: it counts the rays")
AXE = Path(__file__).parent / "node_modules" / "axe-core" / "axe.min.js"
FINDINGS = """async (card) => {
    const { violations } = await axe.run(card, { resultTypes: ["violations"] });
    return violations.flatMap(({ id, nodes }) =>
        nodes.map(({ html, any }) => `${id}: ${html} ${any[0]?.message ?? ""}`));
}"""


def test_keys_tell_the_ray_that_they_reach(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([f"{SETUP}\nlaser.update(**fan({{7: inf}}))\nlaser"])
    card = nb.page.get_by_role("group", name="laser /scan", exact=True)
    picture, live, keys = card.get_by_role("application"), card.locator("[aria-live=polite]"), nb.page.keyboard
    expect(live).to_have_text("")
    picture.focus()
    for key, words in (
        ("Home", "ranges[0], 2.00 m, −90.0°, right, x 0.00, y −2.00"),
        ("PageUp", "ranges[10], 1.70 m, 10.0°, left, x 1.67, y 0.30"),
        ("PageUp", "ranges[18], 3.00 m, 90.0°, left, x 0.00, y 3.00"),
        ("PageDown", "ranges[8], 1.66 m, −10.0°, right, x 1.63, y −0.29"),
        ("ArrowLeft", "ranges[7], +inf, −20.0°, right, +inf: nothing within 4 m"),
        ("m", "ranges[1], 1.52 m, −80.0°, right, x 0.26, y −1.50"),
        ("Escape", ""),
    ):
        keys.press(key)
        expect(live).to_have_text(words)
    box = live.bounding_box()
    assert box is not None
    assert max(box["width"], box["height"]) <= 1, "for the ear alone"
    nb.python("laser.title = ''")
    expect(nb.page.get_by_role("group", name="laser", exact=True)).to_be_visible()
    nb.python("laser.update(**fan() | {'ranges': np.full(19, inf)})")
    expect(card).to_have_count(0)
    keys.press("m")
    expect(nb.page.locator(".rw-live")).to_have_text("no reading")


def test_a_speed_is_read_aloud_with_spaces(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page(
        [
            "from robowidgets import SpeedWidget\nspeed = SpeedWidget(title='/odom')\n"
            "speed.update(linear=(0.5, 0, 0), angular=(0, 0, -3))\n"
            "speed.command(linear=(0.4, 0, 0), angular=(0, 0, 0))\nspeed"
        ]
    )
    card = nb.page.get_by_role("group", name="speed /odom", exact=True)
    expect(card.locator(".rw-heading")).to_have_text(["linear m/s", "angular rad/s"])
    last = card.locator('[data-axis="5"]')
    expect(last.locator(".rw-axis-name")).to_have_text("yaw")
    expect(last.locator(".rw-axis-state")).to_have_text("▼ over limit")
    card.get_by_role("application").focus()
    nb.page.keyboard.press("End")
    expect(card.locator("[aria-live=polite]")).to_have_text(
        "yaw (angular.z), −3.0000 rad/s, right, over the limit of 1, off the scale, limits −1 to 1, commanded 0.0000"
    )
    nb.page.keyboard.press("Escape")
    expect(card.locator("[aria-live=polite]")).to_have_text("")


def test_the_bar_of_a_frozen_picture_tells_seconds(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([f"{SETUP}\nlaser.update(**fan())\nlaser", "laser.update(**fan())"])
    slider = nb.widget(0).get_by_role("slider", name="Sample on show")
    nb.run(1)
    nb.widget(0).locator(".rw-freeze").click()
    nb.page.keyboard.press(",")
    eventually(lambda: " seconds before the newest, " in (slider.get_attribute("aria-valuetext") or ""), True)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing(plain_page: Callable[..., PlainPage], theme: str) -> None:
    nb = plain_page([WIDGETS], theme=theme)
    nb.page.add_script_tag(path=AXE)
    found = []
    for width in (700, 300):
        nb.resize(width)
        for nth, kind in enumerate(KINDS):
            card = nb.widget(0, nth).locator(f".rw-{kind}")
            expect(card).to_be_visible()
            if kind == "laser":
                card.locator(".rw-type").click()
            found += [f"{kind} at {width} px: {finding}" for finding in card.evaluate(FINDINGS)]
    assert not found, "\n".join(found)


def test_a_word_of_ros_is_explained_under_the_pointer_and_at_the_picture_that_has_the_focus(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([f"{SETUP}\nlaser.update(**fan({{7: inf}}))\nlaser"])
    card = nb.page.get_by_role("group", name="laser /scan", exact=True)
    index = card.locator(".rw-index")

    # The page asks Python for the glossary a moment after the first view.
    def tip() -> str:
        card.locator(".rw-title").hover()
        index.hover()
        return str(index.get_attribute("title")).partition(" is ")[0]

    eventually(tip, "A number in brackets, such as [225],")
    # A sentence follows the tooltip of the part around it.
    count = card.locator(".rw-class-nothing_in_range > span:last-child")
    for _ in range(2):
        index.hover()
        count.hover()
    expect(count).to_have_attribute("title", MARK)
    assert str(count.get_attribute("title")).count("REP 117") == 1
    picture = card.get_by_role("application")
    # The index under the angle, at the rim.
    at = picture.bounding_box()
    assert at is not None
    ways = [(at["x"] + at["width"] / 2, at["y"] + y) for y in range(4, int(at["height"] / 4), 6)]
    tips = []
    for x, y in ways:
        nb.page.mouse.move(x, y)
        tips.append(str(picture.get_attribute("title") or "").partition(" is ")[0])
    assert re.fullmatch(r"\[\d+\]", max(tips)), tips
    assert tips[-1] == ""
    picture.focus()
    expect(picture).to_have_attribute("aria-description", DESCRIPTION)

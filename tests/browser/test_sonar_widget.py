"""The sonar widget on a page."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import cos, radians, sin

import pytest
from playwright.sync_api import Locator, expect

from .chromium import LOOKS, shoot
from .laser import eventually, listen, placed_words
from .laser import words as words_on
from .plain_page import PlainPage
from .sonar import ALARMS, EMPTY, MANY, PIONEER, STUDENT
from .test_png import differences, download, seen

UNHURRIED = """
import robowidgets.sonar_widget as widget_of_a_test
widget_of_a_test.LIVE = widget_of_a_test.LIVE._replace(shortest=10.0)
"""
"""Makes a sensor with a rate silent as late as one without: a busy machine may draw a reading after a second."""


def at(card: Locator, degrees: float, part: float = 0.5) -> tuple[float, float]:
    """A point in the picture of a round ring, in this direction from forward, at a share of the half height."""
    picture = card.locator(".rw-picture").bounding_box()
    assert picture
    x, y = picture["x"] + picture["width"] / 2, picture["y"] + picture["height"] / 2
    away = part * picture["height"] / 2
    return x - away * sin(radians(degrees)), y - away * cos(radians(degrees))


def texts(widget: Locator) -> list[str]:
    """The texts in the picture now, since `listen`."""
    return [text for text, *_ in placed_words(widget)]


def words(card: Locator, place: str) -> Locator:
    """Return the part with this name of the pop-up of the picked or hovered sensor."""
    return card.locator(".rw-popup:visible .rw-popup-" + place)


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_every_sensor_is_readable_at_every_width(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([PIONEER, MANY, STUDENT, EMPTY], run=False, scale=scale, theme=theme)
    listen(nb.page)
    nb.run_all()
    for width in (300, 480, 1200):
        nb.resize(width)
        for i, name in enumerate(("pioneer", "many", "student", "empty")):
            card = nb.widget(i).locator(".rw-card")
            card.scroll_into_view_if_needed()
            shoot(card, f"sonar-{name}-{theme}-{width}")
        shown = texts(nb.widget(1))
        assert len([text for text in shown if re.fullmatch(r"[▲ ]*\d\.\d\d[!? m]*|outside", text)]) == 24
    card = nb.widget(0).locator(".rw-card")
    shown = texts(nb.widget(0))
    assert {"[4] sonar_4", "−10.0°", "▲ 0.34 m", "nothing", "unknown", "▲ too close", "outside"} <= set(shown)
    expect(card.locator(".rw-footer")).to_contain_text("12 readings")
    expect(card.locator(".rw-sonar-near")).to_have_text("▲ sonar_4, sonar_11 below 0.4 m")
    expect(card.locator(".rw-sonar-places")).to_be_empty()
    many = nb.widget(1).locator(".rw-card")
    expect(many.locator(".rw-sonar-places")).to_have_text("places not known: spread evenly by name")
    expect(many.locator(".rw-nearest")).to_contain_text("nearest 0.25 m ir_0 [0]")
    expect(nb.widget(3).locator(".rw-empty")).to_have_text("waiting for a range")


@pytest.mark.core
def test_a_sensor_is_named_where_the_pointer_is_kept_by_a_click_and_copied_also_while_a_cell_runs(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([PIONEER])
    card = nb.widget(0).locator(".rw-card")
    nb.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    expect(card.locator(".rw-footer")).to_contain_text("12 readings")
    with nb.busy():
        nb.page.mouse.move(*at(card, 30))
        expect(words(card, "expression")).to_have_text("[2] sonar_2")
        expect(words(card, "distance")).to_have_text("1.62 m")
        expect(words(card, "angle")).to_have_text("30.0°")
        expect(words(card, "details")).to_contain_text("beam 30.0°, 0.1 m to 5 m")
        expect(words(card, "details")).to_contain_text("ultrasound, x 0.15  y 0.08")
        expect(words(card, "details")).to_have_text(re.compile(r"\d+\.\d\d s old$"))
        shoot(card, "sonar-popup")
        nb.page.mouse.click(*at(card, -50))
        nb.page.mouse.move(0, 0)
        expect(words(card, "expression")).to_have_text("[6] sonar_6")
        expect(words(card, "distance")).to_have_text("+inf")
        expect(words(card, "details")).to_contain_text("nothing within 5 m")
        card.get_by_role("button", name="Copy code").click()
        expect(card.locator(".rw-copy")).to_have_text("Copied")
        assert nb.page.evaluate("navigator.clipboard.readText()") == 'sonars["sonar_6"].distance'
        card.locator(".rw-picture").focus()
        nb.page.keyboard.press("ArrowRight")
        expect(words(card, "expression")).to_have_text("[7] sonar_7")
        expect(card.locator(".rw-live")).to_contain_text("[7] sonar_7, 4.40 m, −90.0°, right")
        nb.page.keyboard.press("Escape")
        expect(words(card, "expression")).to_have_count(0)


def test_it_freezes_while_a_cell_runs_and_steps_through_its_history(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([STUDENT])
    listen(nb.page)
    card = nb.widget(0).locator(".rw-card")
    nb.python(UNHURRIED)
    feed = (
        "from robowidgets.widget.pacer import pacer\nfor i in range(5): sonars.update(front=1 + i / 10); pacer.flush()"
    )
    nb.python(feed)
    eventually(lambda: "1.40 m" in texts(nb.widget(0)), True)
    with nb.busy():
        card.locator(".rw-freeze").click()
        expect(card.locator(".rw-freeze")).to_contain_text("Frozen")
    nb.python("sonars.update(front=2.0)")
    expect(card.locator(".rw-freeze")).to_contain_text("1 since")
    card.locator(".rw-picture").focus()
    nb.page.keyboard.press(",")
    eventually(lambda: "1.30 m" in texts(nb.widget(0)), True)
    eventually(lambda: nb.python("print(sonars['front'].distance, sonars.paused)"), "1.3 True\n")
    nb.page.keyboard.press("Space")
    eventually(lambda: "2.00 m" in texts(nb.widget(0)), True)


def test_one_silent_sensor_turns_pale_and_is_named_while_the_others_go_on(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([ALARMS])
    listen(nb.page)
    widget = nb.widget(0)
    expect(widget.locator(".rw-sonar-silent")).to_have_text(re.compile(r"^◌ left silent for \d+ s$"))
    eventually(lambda: any(text.startswith("silent ") for text in texts(widget)), True)
    assert "0.21 m" not in " ".join(texts(widget))
    expect(widget.locator(".rw-nearest")).to_contain_text("front")
    shoot(widget.locator(".rw-card"), "sonar-silent")
    nb.python("alive.clear()")
    expect(widget.locator(".rw-silence")).to_have_text(re.compile(r"^no data for"))


def test_what_cannot_be_shown_is_reported_above_what_could_and_texts_stay_texts(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([STUDENT])
    card = nb.widget(0).locator(".rw-card")
    nb.python("try: sonars.update({'front': 0.5, '<b>x</b>': 'near'})\nexcept TypeError: pass")
    expect(card.locator(".rw-notice")).to_contain_text("<b>x</b>: expected metres")
    expect(card.locator(".rw-notice")).to_contain_text("Showing the last good range.")
    nb.python("sonars.title = '<i>t</i>'; sonars.update({'<b>x</b>': 0.1})")
    expect(card.locator(".rw-notice")).to_be_hidden()
    expect(card.locator(".rw-sonar-near")).to_contain_text("<b>x</b>")
    expect(card.locator("b b, i")).to_have_count(0)
    expect(card.locator(".rw-sonar-places")).to_have_text("place of <b>x</b> not known: spread evenly by name")
    nb.python("sonars.reset()")
    expect(card.locator(".rw-empty")).to_have_text("waiting for a range")


def test_the_view_zooms_by_wheel_keys_and_buttons_and_fits_readings(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([PIONEER])
    card = nb.widget(0).locator(".rw-card")
    reach = card.locator(".rw-range")
    expect(reach).to_have_text("5.3 m")
    card.get_by_role("button", name="Zoom in").click()
    expect(reach).to_have_text("5 m")
    eventually(lambda: nb.python("print(pioneer.view_range)"), "5.0\n")
    nb.page.mouse.move(*at(card, 30))
    nb.page.mouse.move(*at(card, 35))
    nb.page.mouse.wheel(0, -60)
    expect(reach).to_have_text("4 m")
    card.locator(".rw-picture").focus()
    nb.page.keyboard.press("-")
    nb.page.keyboard.press("-")
    expect(reach).to_have_text("5.3 m")
    eventually(lambda: nb.python("print(pioneer.view_range)"), "None\n")
    nb.python("pioneer.update({name: 1.0 for name in pioneer.poses})")
    nb.page.keyboard.press("0")
    expect(reach).to_have_text("1.5 m")
    expect(card.locator(".rw-fit")).to_have_attribute("aria-pressed", "true")


def test_a_png_is_saved_of_the_present_view(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([PIONEER], scale=2)
    card = nb.widget(0).locator(".rw-card")
    name, saved = download(nb.page, card)
    assert name.startswith("pioneer-sonar")
    nb.page.mouse.move(0, 0)
    assert differences(saved, seen(card)) < 0.01


ON_LASER = """
from math import inf
from robowidgets import LaserWidget, Range, SonarWidget
from robowidgets.simulator import Robot, room
ring = SonarWidget(title="ring", poses={"front": 0, "left": (0.05, 0.1, 1.0), "right": (0.05, -0.1, -1.0)})
ring.update(front=Range(2.3, 0.1, 4.0, 0.4), left=Range(1.5, 0.1, 4.0, 0.4), right=Range(inf, 0.1, 3.0, 0.4))
ring.update("lost", 1.0)
laser = LaserWidget(title="/scan", view_range=4)
laser.update(Robot(room("house"), seed=1).scan())
laser.sonars = ring
laser
"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_the_cones_of_a_ring_stand_on_the_laser(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([ON_LASER], scale=scale, theme=theme)
    laser = nb.page.locator(".rw-laser").first
    expect(laser.locator(".rw-footer")).to_contain_text("cones: ring, 1 of 4 without a reading or a place")
    listen(nb.page)
    nb.python("ring.update('front', Range(2.1, 0.1, 4.0, 0.4)); ring.send_newest()")
    eventually(lambda: {"front", "2.10 m", "nothing"} <= words_on(laser), True)
    shoot(nb.output(0), f"sonar-on-laser-{theme}-{scale}")

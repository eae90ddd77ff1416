"""Pointing at a laser scan with mouse, keys and finger."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import cos, radians, sin
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from .laser import FAN, SETUP, Picture, eventually, locate
from .notebook import Notebook
from .plain_page import PlainPage
from .test_laser_zoom import reaches

FIRST = f"{SETUP}\nlaser.update(**fan())\nlaser"
ANCHOR = """laser.update(ranges=np.full(1040, 2.0), angle_min=np.radians(-130), angle_increment=np.radians(0.25),
                          range_min=0.6, range_max=4.0)"""
BOXES = """(picture) => {
    const outer = picture.getBoundingClientRect();
    return [...picture.querySelectorAll(".rw-popup:not([hidden])")].map((popup) => {
        const { left, top, right, bottom } = popup.getBoundingClientRect();
        return [left - outer.left, top - outer.top, right - outer.left, bottom - outer.top];
    });
}"""
SCROLLED = "() => document.querySelector('.jp-Notebook .jp-WindowedPanel-outer').scrollTop"
CELLS = (
    "() => [...document.querySelectorAll('.jp-Notebook .jp-Cell')].map((c) => c.classList.contains('jp-mod-active'))"
)


def at(point: tuple[float, float]) -> Any:
    return {"x": point[0], "y": point[1]}


def popups(card: Locator) -> Locator:
    return card.locator(".rw-popup:visible")


def says(popup: Locator, *parts: str) -> None:
    """Wait until a pop-up says exactly these parts, in this order."""
    expect(popup.locator("div > span, .rw-index").filter(visible=True, has_text=re.compile(r"\S"))).to_have_text(
        [*parts]
    )


def of(index: int) -> tuple[str, str, str, str, str]:
    """The text of the pop-up for a ray of the fan."""
    metres, degrees = FAN[index]
    x, y = metres * cos(radians(degrees)), metres * sin(radians(degrees))
    side = "ahead" if degrees == 0 else "left" if degrees > 0 else "right"
    parts = f"ranges[{index}]", f"{metres:.2f} m", f"{degrees:.1f}°", f"x {abs(x):.2f}  y {y:.2f}", side
    return tuple(part.replace("-", "−") for part in parts)  # type: ignore[return-value]


@pytest.mark.core
def test_pointing_names_the_ray_live_and_python_knows_it(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST])
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    picture, popup = card.locator(".rw-picture"), popups(card)
    place = locate(card)
    expect(popup).to_have_count(0)
    for index in (0, 6, 9, 18):
        picture.hover(position=at(place.at(*FAN[index])))
        says(popup, *of(index))
    eventually(lambda: nb.python("laser.hovered"), "18")
    picture.hover(position=at(place.at(3.0, 22)))
    says(popup, *of(11))

    nb.python("laser.update(**fan({11: 1.0}, intensities=np.arange(19) / 2))")
    says(popup, "ranges[11]", "1.00 m", "20.0°", "x 0.94  y 0.34\nintensity 5.50", "left")
    rows = [
        ("inf", "+inf", "+inf: nothing within 4 m"),
        ("-inf", "−inf", "−inf: closer than 0.6 m"),
        ("nan", "NaN", "NaN: no measurement"),
        ("0.25", "0.250 m", "outside the limits 0.6 m to 4 m"),
    ]
    for value, distance, meaning in rows:
        nb.python(f"laser.update(**fan({{11: {value}}}))")
        says(popup, "ranges[11]", distance, "20.0°", meaning, "left")
    nb.python("laser.update(**fan() | dict(ranges=[2.0] * 5))")
    says(popup, "ranges[11]", "—", "this scan has 5 rays")
    nb.python(ANCHOR)
    nb.python("laser.pinned = 635")
    says(popups(card).first, "ranges[635]", "2.00 m", "28.8°", "x 1.75  y 0.96", "left")

    nb.page.mouse.move(5, 5)
    expect(popup).to_have_count(1)
    eventually(lambda: nb.python("print(laser.hovered, laser.pinned)"), "None 635\n")


def test_the_pop_up_keeps_in_the_box_and_off_the_ray_it_names(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST])
    card = nb.widget(0).locator(".rw-card")
    picture, popup = card.locator(".rw-picture"), popups(card)
    for width in (320, 700):
        nb.resize(width)
        place = locate(card)
        seen = Picture(card)
        picture.focus()
        nb.page.keyboard.press("Home")
        for index, (metres, degrees) in enumerate(FAN):
            expect(popup.locator(".rw-popup-expression")).to_have_text(f"ranges[{index}]")
            [[left, top, right, bottom]] = picture.evaluate(BOXES)
            assert min(left, top, seen.width - right, seen.height - bottom) >= 0, (width, index)
            ray = [place.at(metres * i / 50, degrees) for i in range(51)]
            assert not any(left <= x <= right and top <= y <= bottom for x, y in ray), (width, index)
            nb.page.keyboard.press("ArrowRight")
        nb.page.keyboard.press("Escape")
        expect(popup).to_have_count(0)


def test_clicks_and_keys_pin_and_walk(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST])
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    picture, popup, keys = card.locator(".rw-picture"), popups(card), nb.page.keyboard
    place = locate(card)
    picture.click(position=at(place.at(*FAN[4])))
    nb.page.mouse.move(5, 5)
    says(popup, *of(4))
    eventually(lambda: nb.python("laser.pinned"), "4")
    for key, index in (
        ("ArrowRight", 5),
        ("ArrowUp", 6),
        ("ArrowLeft", 5),
        ("ArrowDown", 4),
        ("ArrowLeft", 3),
        ("End", 18),
        ("ArrowRight", 18),
        ("Home", 0),
        ("ArrowLeft", 0),
    ):
        keys.press(key)
        says(popup, *of(index))
    keys.press("Escape")
    expect(popup).to_have_count(0)
    eventually(lambda: nb.python("laser.pinned is None"), "True")

    nb.python("laser.pinned = 18")
    says(popup, *of(18))
    picture.hover(position=at(place.at(*FAN[2])))
    expect(popup).to_have_count(2)
    says(popup.last, *of(2))
    picture.click(position=at(place.at(*FAN[18])))
    expect(popup).to_have_count(1)
    nb.page.mouse.move(5, 5)
    expect(popup).to_have_count(0)


def test_the_notebook_scrolls_under_the_wheel_and_keeps_still_while_keys_walk(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([FIRST, "laser", "laser"])
    nb.resize(700)
    card, mouse, keys = nb.widget(0).locator(".rw-card"), nb.page.mouse, nb.page.keyboard
    picture, popup = card.locator(".rw-picture"), popups(card)

    # A wheel that cannot zoom further scrolls.
    picture.hover()
    mouse.move(400, 300, steps=3)
    reaches(card, "4")
    mouse.wheel(0, 60)
    eventually(lambda: nb.page.evaluate(SCROLLED) > 0, True)
    reaches(card, "4")

    # A wheel that scrolls does not zoom.
    nb.python("laser.view_range = 2.0")
    second = nb.widget(1).locator(".rw-card")
    below = second.locator(".rw-picture")
    for clicked in (False, True):
        reaches(second, "2")
        if clicked:
            below.click()
        nb.page.evaluate("() => { document.querySelector('.jp-Notebook .jp-WindowedPanel-outer').scrollTop = 0; }")
        mouse.move(400, 200, steps=3)
        turns = 0
        while turns < 5:
            before = nb.page.evaluate(SCROLLED)
            mouse.wheel(0, 60)
            eventually(lambda before=before: nb.page.evaluate(SCROLLED) > before, True)
            turns += below.evaluate("(picture) => picture.matches(':hover')")
        reaches(second, "2")
    below.click()
    mouse.wheel(0, -100)
    reaches(second, "1.5")
    nb.python("laser.view_range = 'sensor'")

    # Keys walk the rays, and none reaches the notebook.
    picture.click()
    mouse.move(5, 5)
    keys.press("Home")
    says(popup, *of(0))
    nb.python("laser.update(**fan({7: -inf}))")
    cells = nb.page.evaluate(CELLS)
    for button in (None, card.locator(".rw-fit"), card.locator(".rw-class-too_close")):
        if button:
            button.focus()
        for key in ("d", "d", "x", "a", "b", "m", "y", "c", "v", "z", "Shift+m", "0", "0", "j", "k", "Shift+k"):
            keys.press(key)
    keys.press("Home")
    keys.press("ArrowRight")
    says(popup, *of(1))
    picture.focus()
    keys.press("Escape")
    expect(popup).to_have_count(0)
    assert nb.page.evaluate(CELLS) == cells, "no key reached the notebook"
    expect(nb.page.locator(".jp-Dialog")).to_have_count(0)

    # The keys that run a cell reach the notebook, and outside the widget all keys do.
    picture.focus()
    keys.press("Shift+Enter")
    eventually(lambda: nb.page.evaluate(CELLS), [False, True, False])
    nb.page.locator(".jp-Notebook .jp-InputPrompt").last.click()
    keys.press("b")
    eventually(lambda: nb.page.evaluate(CELLS), [False, False, False, True])


def test_a_finger_does_all_of_it(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST], touch=True)
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    picture, popup = card.locator(".rw-picture"), popups(card)
    place = locate(card)
    picture.tap(position=at(place.at(*FAN[4])))
    says(popup, *of(4))
    picture.tap(position=at(place.at(*FAN[12])))
    says(popup, *of(12))
    eventually(lambda: nb.python("laser.pinned"), "12")
    picture.tap(position=at(place.at(*FAN[12])))
    expect(popup).to_have_count(0)
    card.locator(".rw-freeze").tap()
    expect(card.locator(".rw-freeze")).to_contain_text("Frozen")
    card.get_by_role("button", name="Zoom in (+)").tap()
    expect(card.locator(".rw-range")).to_have_text("3 m")
    card.locator(".rw-fit").tap()
    eventually(lambda: nb.python("laser.view_range"), "'data'")

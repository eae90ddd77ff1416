"""The range of a laser's picture, set by wheel, buttons, keys and from Python."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import Locator, expect

from .laser import FAN, LIGHT, SETUP, Picture, eventually, listen, locate, words
from .plain_page import PlainPage

FIRST = f"{SETUP}\nlaser.update(**fan())\nlaser"


def reaches(card: Locator, metres: str) -> None:
    expect(card.locator(".rw-range")).to_have_text(f"{metres} m")


def test_wheel_buttons_keys_fit_and_python_zoom(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST], run=False)
    listen(nb.page)
    nb.run_all()
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    picture, mouse, keys = card.locator(".rw-picture"), nb.page.mouse, nb.page.keyboard
    closer, farther = (card.get_by_role("button", name=name) for name in ("Zoom in (+)", "Zoom out (−)"))
    far = locate(card).scale
    reaches(card, "4")
    for turn, metres, scale in ((-100, "3", 1.33), (100, "4", 1.0), (100, "4", 1.0)):
        picture.hover()
        mouse.move(400, 300, steps=3)  # a moving mouse, as the test of the wheel requires
        mouse.wheel(0, turn)
        reaches(card, metres)
        mouse.move(5, 5)
        assert abs(locate(card).scale / far - scale) < 0.1
    closer.click()
    reaches(card, "3")
    farther.click()
    reaches(card, "4")
    eventually(lambda: nb.python("laser.view_range"), "'sensor'")
    picture.focus()
    for key, metres in (("-", "4"), ("+", "3"), ("=", "2.5"), ("-", "3")):
        keys.press(key)
        reaches(card, metres)
    eventually(lambda: nb.python("laser.view_range"), "3.0")

    fit = card.locator(".rw-fit")
    nb.python("laser.update(**fan(range_max=60.0)); laser.view_range = 'sensor'")
    reaches(card, "60")
    fit.click()
    reaches(card, "4")
    expect(fit).to_have_attribute("aria-pressed", "true")
    eventually(lambda: nb.python("laser.view_range"), "'data'")
    locate(card)
    nb.python("laser.update(**fan({18: 3.2}, range_max=60.0))")
    expect(card.locator(".rw-nearest")).to_be_visible()
    locate(card, [*FAN[:18], (3.2, 90)])
    reaches(card, "4")
    fit.click()
    reaches(card, "60")
    expect(fit).to_have_attribute("aria-pressed", "false")

    nb.python("laser.view_range = 1.55; laser.update(**fan())")
    reaches(card, "1.55")
    eventually(lambda: "17 beyond 1.55 m" in words(card), True)
    seen = Picture(card)
    assert len(seen.dots()) == 2 + 17 + 1, "dots, arrow heads at the edge, and one that explains them"
    assert seen.count(LIGHT["reading"]) > 17 * 4
    closer.click()
    reaches(card, "1.5")
    eventually(lambda: "19 beyond 1.5 m" in words(card), True)


def test_auto_is_decided_by_the_first_reading_unless_the_user_has_zoomed(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([f"{SETUP}\nlaser.view_range = 'auto'\nlaser", "zoomed = LaserWidget(view_range='auto')\nzoomed"])
    update = "update(ranges=np.full(9, {metres}), angle_min=-1, angle_increment=0.25, range_min=0.1, range_max=30.0)"
    card = nb.widget(0).locator(".rw-card")
    nb.widget(1).get_by_role("button", name="Zoom in (+)").click()
    eventually(lambda: nb.python("zoomed.view_range"), "8.0")
    nb.python(f"laser.{update.format(metres='np.nan')}")
    reaches(card, "30")
    nb.python(f"laser.{update.format(metres=2)}; zoomed.{update.format(metres=2)}")
    reaches(card, "2.5")
    eventually(lambda: nb.python("laser.view_range, zoomed.view_range"), "('data', 8.0)")
    nb.python(f"laser.{update.format(metres=15)}")
    reaches(card, "20")
    nb.python("laser.view_range = 'auto'")
    reaches(card, "30")
    eventually(lambda: nb.python("laser.view_range"), "'sensor'")

"""The pop-up of the pinned ray works out its angle, and shows all angles in radians on request."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import LOOKS, shoot
from .plain_page import PlainPage

LASER = """
import numpy as np, robowidgets
from robowidgets.simulator import Robot, World
laser = robowidgets.LaserWidget(title="/scan")
laser.update(Robot(World.rooms(), seed=1).scan())
laser.pinned = 489
laser
"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_pinned_ray_unfolds_its_formula_and_its_unit_holds_for_all_angles(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([LASER], theme=theme, scale=scale)
    card = nb.widget(0).locator(".rw-card")
    popup = card.locator(".rw-popup", has=card.page.locator(".rw-popup-foot"))
    formula, unfold = popup.locator(".rw-formula"), popup.get_by_role("button", name="Formula")
    expect(formula).to_be_hidden()

    def python(expression: str) -> str:
        return nb.python(f"print({expression})").strip()

    unfold.click()
    expect(unfold).to_have_attribute("aria-expanded", "true")
    expect(formula.locator(".rw-formula-names")).to_have_text("angle_min + 489 × increment")
    expect(formula.locator(".rw-formula-numbers")).to_have_text("−2.35619 + 489 × 0.00872665")
    expect(formula.locator(".rw-formula-result")).to_have_text("= 1.91114 rad = 109.50°")
    assert python("laser.pinned, laser.formula") == "489 True", "the picture gets no click"
    for width in (700, 400, 320):
        nb.resize(width)
        shoot(card, f"laser-formula-{theme}-{width}")
        box, inside = popup.bounding_box(), card.locator(".rw-picture").bounding_box()
        assert box
        assert inside
        assert inside["x"] <= box["x"]
        assert box["x"] + box["width"] <= inside["x"] + inside["width"]
        assert formula.evaluate("e => e.scrollWidth <= e.clientWidth"), "it wraps at its operators"

    nb.resize(700)
    popup.get_by_role("button", name="in radians").click()
    expect(popup.locator(".rw-popup-angle")).to_have_text("1.911 rad")
    expect(card.locator(".rw-nearest")).to_have_text("nearest 1.26 m at 1.911 rad [489]")
    expect(formula.locator("b")).to_have_text("1.91114 rad")
    assert python("laser.angle_unit") == "rad"
    nb.python("laser.selection = ('-10deg', '10deg')")
    expect(card.locator(".rw-chip")).to_contain_text("−0.175 rad to 0.175 rad")
    nb.python("laser.selection = None; laser.angle_offset = '-20deg'")
    expect(formula.locator(".rw-formula-names")).to_have_text("angle_min + 489 × increment + angle_offset")
    for width in (700, 400):
        nb.resize(width)
        shoot(card, f"laser-radians-{theme}-{width}")

    picture = card.locator(".rw-picture")
    picture.press("r")
    expect(popup.locator(".rw-popup-angle")).to_have_text("89.5°")
    picture.press("f")
    expect(formula).to_be_hidden()
    assert python("laser.pinned, laser.angle_unit, laser.formula") == "489 deg False"
    nb.python("laser.formula = True; laser.pinned = 5000")
    expect(formula).to_be_hidden()

"""The badge of the laser: the problems of a scan in plain words, and their remedies."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import LOOKS, shoot
from .plain_page import PlainPage

SCAN = """
import numpy as np, robowidgets
laser = robowidgets.LaserWidget(title="/scan")
angles = np.linspace(-np.pi, np.pi, 719)
room = 2.0 + 0.4 * np.cos(3 * angles)
fields = dict(angle_min=-3.14159, angle_max=3.14159, angle_increment=0.00869044, range_min=0.1, range_max=3.5)
header = {"frame_id": "", "stamp": {"sec": 1, "nanosec": 0}}
laser.update({"ranges": room, "intensities": [1.0], "header": header, **fields})
laser
"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_problems_are_named_and_unfold_to_their_remedies_without_moving_the_picture(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([SCAN], theme=theme, scale=scale)
    card = nb.widget(0).locator(".rw-card")
    said, more = card.locator(".rw-notice-text"), card.get_by_role("button", name="What to do")
    expect(said).to_contain_text("719 rays, but the header implies 724 (angle_max 180.0°)")
    expect(said).to_contain_text("frame_id is empty")
    remedies = card.locator(".rw-remedies")
    expect(remedies).to_be_hidden()
    for width in (700, 400, 320):
        nb.resize(width)
        shoot(card, f"laser-doctor-{theme}-{width}")
    nb.resize(700)
    notice = card.locator(".rw-notice")
    height = (notice.bounding_box() or {})["height"]
    more.click()
    expect(more).to_have_attribute("aria-expanded", "true")
    expect(remedies.locator("b")).to_have_count(3)
    expect(remedies).to_contain_text("Set it in the driver, or tf cannot tell where the scanner is.")
    assert (notice.bounding_box() or {})["height"] == height
    assert nb.python("print(laser.pinned)").strip() == "None", "a click on the badge picks no ray"
    for width in (700, 400, 320):
        nb.resize(width)
        shoot(card, f"laser-doctor-open-{theme}-{width}")
    nb.python("laser.pinned = 30")
    more.press("Escape")
    expect(remedies).to_be_hidden()
    assert nb.python("print(laser.pinned)").strip() == "30", "Escape folds, and leaves the pin alone"

    nb.python("laser.update(ranges=[9.0] * 719, **fields)")
    expect(said).to_have_text("719 rays, but the header implies 724 (angle_max 180.0°)")
    expect(card.locator(".rw-empty")).to_have_text(
        "no readings: all 719 rays say 9 m, outside 0.1 m to 3.5 m\ncheck range_min and range_max"
    )
    shoot(card, f"laser-doctor-empty-{theme}")
    nb.python("laser.update(ranges=[1.0, 1.0], angle_min=0, angle_increment=0.5, range_min=0.1, range_max=3.5)")
    expect(notice).to_be_hidden()
    expect(card.locator(".rw-empty")).to_be_hidden()

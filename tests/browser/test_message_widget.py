"""What a person sees and does with a message widget."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from .chromium import LOOKS, shoot
from .message import BATTERY, DIAGNOSTICS, HOSTILE, IMU, JOINTS, LARGE_NUMBERS
from .plain_page import PlainPage


def row(card: Locator, path: str) -> Locator:
    """The row of a field in the tree."""
    return card.locator(f'.rw-message-row[data-rw-row="{path}"]')


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_every_field_is_readable_at_every_width(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([IMU, BATTERY, JOINTS, DIAGNOSTICS, LARGE_NUMBERS, HOSTILE], run=False, scale=scale, theme=theme)
    nb.run_all()
    for width in (300, 480, 1200):
        nb.resize(width)
        for i, name in enumerate(("imu", "battery", "joints", "diagnostics", "large", "hostile")):
            card = nb.widget(i).locator(".rw-card")
            card.scroll_into_view_if_needed()
            shoot(card, f"message-{name}-{theme}-{width}")
    card = nb.widget(0).locator(".rw-card")
    expect(row(card, "angular_velocity.z")).to_contain_text("−0.4702")

"""What a person sees and does with a cloud widget."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from .chromium import LOOKS, shoot
from .cloud import EMPTY, FEW, MANY, NOTHING, ROOM
from .plain_page import PlainPage


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_clouds_are_readable_at_every_width(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([ROOM, MANY, FEW, EMPTY, NOTHING], scale=scale, theme=theme)
    for width in (320, 480, 1000):
        nb.resize(width)
        for i, name in enumerate(("room", "many", "few", "empty", "nothing")):
            card = nb.widget(i).locator(".rw-card")
            card.scroll_into_view_if_needed()
            shoot(card, f"cloud-{name}-{theme}-{width}")
    card = nb.widget(0).locator(".rw-card")
    for view in ("side", "behind", "rows"):
        card.locator("select").first.select_option(view)
        shoot(card, f"cloud-room-{view}-{theme}")

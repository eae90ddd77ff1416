"""The path widget as a map: what its layers look like, how it is moved and read, and what measures on it."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import LOOKS, shoot
from .plain_page import PlainPage
from .test_path_widget import await_drawing

MAP = """
from robowidgets import Line, PathWidget
from tests import map_scene
path = PathWidget(title="Map")
map_scene.drive(path)
path.put("/sonar/left", {"header": {"frame_id": "sonar_link"}, "pose": {"position": {"x": 0, "y": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}}, time=33.2)
path.draw("door 2", Line((4.9, -0.6), (6.0, -0.6)), frame="odom")
path.has_rate = False
path
"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_map_has_its_layers_in_one_frame_and_says_which_one_nothing_joins(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([MAP], theme=theme, scale=scale)
    nb.resize(1030)
    card = nb.widget(0).locator(".rw-card")
    await_drawing(card)
    for width in (1030, 760, 480, 320):
        nb.resize(width)
        await_drawing(card)
        nb.page.wait_for_timeout(300)
        shoot(card, f"map-{theme}-{width}")
    nb.resize(760)
    expect(card.locator(".rw-layers-row")).to_have_count(7)

"""A screen of several widgets: they move without being rendered again, and leave."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import expect

from .plain_page import PlainPage

SCREEN = """
from robowidgets import LaserWidget, SpeedWidget
from robowidgets.screen_widget import ScreenWidget
laser, speed = LaserWidget(title="/scan"), SpeedWidget(title="/odom")
view = ScreenWidget(places={"wides": [laser], "smalls": [speed]})
view
"""


def test_a_widget_moves_without_being_rendered_again_and_leaves_if_it_is_closed(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([SCREEN], width=1000)
    shown = nb.output(0)
    expect(shown.locator(".rw-screen > .rw-wides .rw-laser")).to_be_visible()
    first = shown.locator(".rw-laser").element_handle()
    nb.python("view.place({'mains': [laser], 'smalls': [speed]})")
    laser = shown.locator(".rw-whole > .rw-mains > [data-rw-holds~='laser'] > .rw-laser")
    expect(laser).to_be_visible()
    assert laser.evaluate("(now, before) => now === before", first)
    expect(shown.locator(".rw-whole[data-rw-holds~='laser'] > .rw-smalls[data-rw-holds~='speed']")).to_be_visible()
    expect(shown.locator(".rw-wides")).to_have_count(0)
    nb.python("view.note(['<b>not</b> markup', 'second'])")
    expect(shown.locator(".rw-notes")).to_have_text("<b>not</b> markup\nsecond")
    nb.python("speed.close()")
    expect(shown.locator(".rw-card")).to_have_count(1)
    nb.python("view.place({'wides': [laser]}); view.note([])")
    expect(shown.locator(".rw-notes")).to_be_hidden()
    expect(shown.locator(".rw-item")).to_have_count(1)
    nb.python("view.place({})")
    expect(shown.locator(".rw-one-screen")).to_be_empty()


def test_the_grip_of_a_card_is_in_its_header_in_columns_too(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCREEN.replace('{"wides": [laser], "smalls": [speed]}', '{"wide": [laser], "narrow": [speed]}')])
    header = nb.output(0).locator(".rw-speed > .rw-header")
    header.hover()
    expect(header.locator(".rw-grip")).to_have_css("opacity", "1")
    grip, around = header.locator(".rw-grip").bounding_box(), header.bounding_box()
    assert grip is not None
    assert around is not None
    assert (grip["x"], grip["y"]) == (around["x"], around["y"])

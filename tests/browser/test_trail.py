"""The scans before the one on show: the trail behind it, and the spread of each ray."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import LIGHT, SETUP, Picture, eventually, layers, locate
from .plain_page import PlainPage

VIEW = f"""
{SETUP}
from robowidgets import PathWidget, spread, screen
from robowidgets.widget.pacer import pacer
path = PathWidget(title="/odom")
laser.arc_count = laser.ray_count = 0
laser.update(**fan())
scans = []
def show(*metres, x=0.0):
    for range in metres:
        path.update(x=x, y=0.0, yaw=0.0)
        laser.update(**fan({{9: range}}))
        scans.append(laser.scan)
        pacer.flush()
laser
"""


def redness(card: Locator, x: float, y: float) -> float:
    """The colour at a position, from 0 (the area) to 1 (a reading)."""
    green = Picture(card).colour(x, y)[1]
    return (LIGHT["area"][1] - green) / (LIGHT["area"][1] - LIGHT["reading"][1])


def test_earlier_scans_fade_behind_the_one_on_show(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([VIEW], width=900)
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    spots = [locate(card).at(metres, 0) for metres in (0.8, 1.0, 1.2, 1.4)]

    def shown() -> list[str]:
        found = [redness(card, *spot) for spot in spots]
        return ["reading" if r > 0.9 else "newer" if r > 0.3 else "older" if r > 0.05 else "" for r in found]

    nb.python("show(0.8, 1.0, 1.2, 1.4)")
    eventually(shown, ["", "", "", "reading"])
    nb.python("laser.trail = 2; pacer.flush()")
    eventually(shown, ["", "older", "newer", "reading"])
    footer = card.locator(".rw-footer")
    expect(footer).to_contain_text("trail of 2, scanner\u2019s frame")
    # Frozen and stepped back, it is behind the scan on show, all in the page.
    with nb.busy():
        card.locator(".rw-freeze").click()
        card.locator(".rw-picture").press(",")
        eventually(shown, ["older", "newer", "reading", ""])
        card.locator(".rw-picture").press(" ")
        eventually(shown, ["", "older", "newer", "reading"])
    # What was 1.4 m ahead, 0.2 m before, is 1.2 m ahead now. The scan before that had no path in its view.
    nb.python("screen(laser, path); show(1.0); laser.trail = 1; show(1.4); show(1.0, x=0.2)")
    eventually(shown, ["", "reading", "newer", ""])
    expect(footer).to_contain_text("trail of 1, by odometry")
    # It counts its scans: one, until more are placed; none if the page keeps none.
    nb.python("laser.trail = 60")
    expect(footer).to_contain_text("trail of 2, by odometry")
    nb.python("laser.history = 0; laser.trail = 1; show(1.1)")
    expect(footer).not_to_contain_text("trail")


def test_the_spread_of_a_ray_is_drawn_and_named_as_python_has_it(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([VIEW], width=900)
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    place = locate(card)
    nb.python("laser.spread = 3; show(1.0, 1.2, 1.5)")
    between, before = place.at(1.35, 0), place.at(0.8, 0)
    eventually(lambda: Picture(card).colour(*between) != LIGHT["area"], True)
    assert Picture(card).colour(*before) == LIGHT["area"]
    nb.python("laser.pinned = 9")
    metres = nb.python("print(f'{spread(scans)[9]:.3f}')").strip()
    assert metres == "0.225"
    expect(card.locator(".rw-popup:visible")).to_contain_text(f"spread \u00b1{metres} m in 3 scans")
    nb.python("laser.spread = 0")
    expect(card.locator(".rw-popup:visible")).not_to_contain_text("spread")
    nb.python("laser.pinned = None")
    eventually(lambda: Picture(card).colour(*between), LIGHT["area"])


def test_a_player_has_the_scans_before_its_moment(plain_page: Callable[..., PlainPage]) -> None:
    show = "recording = robowidgets.open(robowidgets.SAMPLE)\nplayer = recording.show('/scan', scanogram=False)"
    nb = plain_page([f"import robowidgets\n{show}\nplayer.seek(12.05)\nplayer"])
    card = nb.widget(0).locator(".rw-laser")
    expect(card.locator(".rw-footer")).to_contain_text("readings")
    _, without = layers(card)
    nb.python("player.views[0].widget.trail = 20")
    expect(card.locator(".rw-footer")).to_contain_text("trail of 20, by odometry")
    eventually(lambda: layers(card)[1] != without, True)
    shoot(card, "trail-player")

"""The widgets under forced colours (a contrast theme in Windows), where the system sets the colours of every page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import FAN, SETUP, Picture, eventually, locate
from .plain_page import PlainPage

READINGS = [ray for index, ray in enumerate(FAN) if index not in (3, 4)]
CARDS = f"""{SETUP}
from robowidgets import DriveWidget, ScanogramWidget, SpeedWidget, TouchWidget
laser.update(**fan({{3: inf, 4: nan}}))
speed = SpeedWidget(title="/odom", hold_peaks=True)
speed.update(linear=(0.7, -0.5, 0.0), angular=(0.0, 0.0, -9.0))
speed.command(linear=(0.4, 0.0, 0.0), angular=(0.0, 0.0, 0.0))
touch = TouchWidget(title="/bumper", angles={{"left": 0.9, "right": -0.9}})
touch.update(left=True, right=None, front=False)
scanogram = ScanogramWidget(title="/scan")
scanogram.update(times_ns=np.arange(200) * 10**8, ranges=np.tile(np.linspace(1, 9, 61), (200, 1)),
                 angle_min=-1.5, angle_increment=0.05, range_min=0.1, range_max=10.0)
scanogram.selection = (3, 7)
display(laser, speed, touch, scanogram, DriveWidget(title="/cmd_vel"))
"""
SYSTEM = """() => Object.fromEntries(["Canvas", "CanvasText", "Highlight", "HighlightText", "GrayText"].map((name) => {
    const probe = document.createElement("i");
    probe.style.cssText = `color: ${name}; forced-color-adjust: none`;
    document.body.append(probe);
    const { color } = getComputedStyle(probe);
    probe.remove();
    return [name, color];
}))"""
"""The colours that the system forces, by their CSS names."""


def used(part: Locator, name: str = "backgroundColor") -> str:
    value: str = part.evaluate("(part, name) => getComputedStyle(part)[name]", name)
    return value


def triple(colour: str) -> tuple[int, ...]:
    return tuple(int(part) for part in colour[4:-1].split(","))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_marks_stand_out_where_the_system_forces_its_colours(plain_page: Callable[..., PlainPage], scheme: Any) -> None:
    nb = plain_page([CARDS], scale=2)
    nb.resize(500)
    laser, speed, touch, scanogram, drive = (nb.widget(0, nth).locator(".rw-card") for nth in range(5))
    expect(speed.locator(".rw-bar:visible")).not_to_have_count(0)
    place = locate(laser, READINGS)
    nb.page.emulate_media(forced_colors="active", color_scheme=scheme)
    system = nb.page.evaluate(SYSTEM)
    assert len(set(system.values())) >= 4, system

    eventually(lambda: Picture(laser).paper, triple(system["Canvas"]))
    picture = Picture(laser)
    assert {picture.colour(*place.at(*ray)) for ray in READINGS} == {triple(system["CanvasText"])}
    assert picture.around(*place.at(4.0, -80)) >= {triple(system["GrayText"])}, "the rim of the area"
    assert picture.colour(*place.at(2.5, -35)) == triple(system["Canvas"])

    axis = [speed.locator(f'[data-axis="{index}"]') for index in range(6)]
    assert used(axis[0].locator(".rw-bar")) == system["Highlight"]
    assert used(axis[5].locator(".rw-bar")) == system["CanvasText"], "past its limit"
    assert used(axis[0].locator(".rw-tick")) == used(axis[0].locator(".rw-zero")) == system["CanvasText"]
    assert used(axis[0].locator(".rw-limit").first, "borderTopColor") == system["CanvasText"]
    assert system["GrayText"] in used(axis[0].locator(".rw-track"), "boxShadow")
    assert used(speed.locator(".rw-key-measured")) == system["Highlight"]

    tiles = {state: touch.locator(f'.rw-tile[data-state="{state}"]') for state in ("touched", "free", "unknown")}
    assert used(tiles["touched"]) == system["Highlight"]
    assert used(tiles["touched"].locator(".rw-tile-state"), "color") == system["HighlightText"]
    assert used(tiles["free"]) == system["Canvas"]
    assert used(tiles["unknown"], "borderTopStyle") == "dashed"

    assert used(drive.locator(".rw-knob").first) == system["Canvas"]
    laser.locator(".rw-freeze").click()
    expect(laser.locator(".rw-freeze")).to_have_css("background-color", system["Highlight"])
    assert used(laser.locator(".rw-freeze .rw-icon")) == system["HighlightText"]
    for name, card in {"laser": laser, "speed": speed, "touch": touch, "scanogram": scanogram, "drive": drive}.items():
        shoot(card, f"forced-{name}-{scheme}")

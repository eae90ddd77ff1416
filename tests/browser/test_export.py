"""Saved and exported notebooks show the widgets' last state without a kernel, and still answer a pointer."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Locator, Page, expect

import robowidgets

from .laser import FAN, SETUP, locate
from .notebook import Notebook

SAMPLE = Path(robowidgets.__file__).with_name("data") / "sample.mcap"
WIDGETS = f"""{SETUP}
from robowidgets import SpeedWidget, TouchWidget
from ipywidgets.embed import embed_minimal_html

laser.update(**fan())
speed = SpeedWidget(title="/odom", planar=True)
speed.update(linear=(0.62, 0, 0), angular=(0, 0, -1.24))
touch = TouchWidget(title="/bumper")
for bumper, state in ((0, 1), (0, 0), (1, 1)):
    touch.update({{"bumper": bumper, "state": state}})
"""
FROZEN = """
frozen = LaserWidget(title="/frozen")
frozen.update(**fan())
frozen.paused = True
frozen.pinned = 4
frozen.update(**fan({9: 0.9}))
display(laser, frozen, speed, touch)
"""
# A whole recording, with one second on the page, and widgets that wait for data that can never come.
ALONE = f"""
import robowidgets
player = robowidgets.open({str(SAMPLE)!r}).show()
empty, unscanned = LaserWidget(), robowidgets.ScanogramWidget()
display(player, empty, unscanned)
"""


def shows(page: Page) -> None:
    """Check what users see and do on the exported widgets."""
    laser, frozen = page.locator(".rw-laser").first, page.locator(".rw-laser").nth(1)
    expect(laser.locator(".rw-nearest")).to_have_text("nearest 1.52 m at −80.0° [1]")
    place, popup = locate(laser), laser.locator(".rw-popup:visible")
    expect(popup).to_have_count(0)
    hover(laser, *place.at(*FAN[6]))
    expect(popup.locator(".rw-popup-expression")).to_have_text("ranges[6]")
    hover(laser, *place.at(*FAN[12]))
    expect(popup.locator(".rw-popup-expression")).to_have_text("ranges[12]")
    laser.get_by_role("button", name="Zoom in (+)").click()
    expect(laser.locator(".rw-range")).to_have_text("3 m")
    with page.expect_download() as saved:
        laser.get_by_role("button", name="Save as PNG").click()
    assert saved.value.suggested_filename.startswith("scan-20")
    expect(frozen.locator(".rw-freeze")).to_have_text("Frozen · 1 since")
    expect(frozen.locator(".rw-popup:visible .rw-popup-expression")).to_have_text("ranges[4]")
    frozen.locator(".rw-freeze").click()
    expect(frozen.locator(".rw-nearest")).to_have_text("nearest 0.90 m at 0.0° [9]")

    shows_speed_and_touch(page)
    page.locator(".rw-speed").first.get_by_role("button", name="Planar").click()
    expect(page.locator(".rw-speed").first.locator("[data-axis]")).to_have_count(6)


def shows_speed_and_touch(page: Page) -> None:
    speed, touch = page.locator(".rw-speed").first, page.locator(".rw-touch").first
    expect(speed.locator(".rw-value")).to_contain_text(["0.62", "0.00", "−1.24"])
    expect(touch.locator(".rw-tile")).to_contain_text(["free", "touched", "unknown"])


def lacks_a_kernel(page: Page) -> None:
    """Check that the page does not wait for data that can never come."""
    for empty in page.locator(".rw-empty:visible").all():
        expect(empty).to_have_text("no kernel in this page")
    player, chip = page.locator(".rw-player"), page.locator(".rw-scanogram-chip:visible")
    player.locator("input").press("End")
    expect(player.locator(".rw-play-words")).to_have_text(re.compile(r"no kernel in this page: it has 0 to \d+ s"))
    player.locator(".rw-play-speed").select_option("10")
    player.locator(".rw-play").click()
    expect(player.locator(".rw-play-now")).not_to_have_text("58.00")
    expect(player.locator(".rw-play")).to_have_attribute("title", "Play (space)")
    expect(player.locator(".rw-play-words")).to_have_text("")
    for _ in range(9):
        page.locator(".rw-scanogram").first.get_by_role("button", name="Zoom in (+)").click()
    expect(chip).to_have_text("no finer detail: no kernel in this page")
    assert "waiting" not in page.locator("body").inner_text()


def hover(card: Locator, x: float, y: float) -> None:
    card.locator(".rw-picture").hover(position={"x": x, "y": y})


def test_exported_pages_without_a_kernel_show_the_last_state(
    notebook: Callable[..., Notebook], static_page: Callable[[Path], Page]
) -> None:
    nb = notebook([WIDGETS, FROZEN, ALONE])
    nb.widget(1).locator(".rw-picture").hover()
    nb.python(
        "embed_minimal_html('embedded.html', views=[laser, frozen, speed, touch, player, empty, "
        "unscanned], drop_defaults=False)"
    )
    saved = nb.save()
    subprocess.run([sys.executable, "-m", "nbconvert", "--to", "html", saved], check=True)
    for file in (nb.lab.files / "embedded.html", saved.with_suffix(".html")):
        page = static_page(file)
        shows(page)
        lacks_a_kernel(page)

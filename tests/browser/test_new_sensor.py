"""The gas sensor of the page on a new sensor is shown and played in the page by its own front end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

import robowidgets

from .. import gas_package
from .chromium import shoot
from .plain_page import PlainPage


@pytest.fixture(autouse=True)
def _gas(tmp_path: Path) -> Iterator[None]:
    site = tmp_path / "site"
    site.mkdir()
    with gas_package.installed(site):
        yield


def test_a_gas_is_shown_and_played_with_its_status(plain_page: Callable[..., PlainPage], tmp_path: Path) -> None:
    path = gas_package.drive(tmp_path / "drive")
    player = f"import robowidgets\nplayer = robowidgets.open({str(path)!r}).show('/gas', '/gas/status')"
    nb = plain_page([f"{player}\ndisplay(player.bar, player.views[0].widget)"])
    output = nb.output(0)
    value = output.locator(".rw-gas-ppm")
    expect(value).to_have_text("0 ppm")
    expect(output.get_by_role("button", name="Save as PNG")).to_be_visible()
    expect(output.locator(".rw-header")).to_contain_text("warming up")
    nb.python("player.time = 3.0")
    expect(value).to_have_text("300 ppm")
    expect(output.locator(".rw-header")).to_contain_text("ok")
    shoot(output, "new-sensor")
    nb.python("player.playing = True")
    expect(value).to_have_text("490 ppm")
    nb.python("player.close()")


def test_a_page_in_a_file_plays_it_by_its_own_front_end(browser: Browser, tmp_path: Path) -> None:
    with robowidgets.open(gas_package.drive(tmp_path / "drive")) as recording:
        file = recording.to_html(tmp_path / "page.html", topics=["/gas", "/gas/status"])
    page = browser.new_page()
    page.goto(file.as_uri())
    value = page.locator(".rw-gas-ppm")
    expect(value).to_have_text("0 ppm")
    page.locator(".rw-play").click()
    # It lasts five seconds.
    expect(value).to_have_text("490 ppm")
    expect(page.locator(".rw-gas .rw-header")).to_contain_text("ok")
    page.close()

"""A kind of sensor that a row adds is shown and played in the page by its own front end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

import robowidgets

from ..fourth_kind import drive, number_widget
from ..fourth_kind.number import added
from .chromium import shoot
from .plain_page import PlainPage


@pytest.fixture(autouse=True)
def _number(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    script, style = number_widget.build(tmp_path / "static")
    monkeypatch.setattr(number_widget.NumberWidget, "_esm", script)
    monkeypatch.setattr(number_widget.NumberWidget, "_css", style)
    with added():
        yield


def test_a_number_is_shown_and_played(plain_page: Callable[..., PlainPage], tmp_path: Path) -> None:
    path = drive.write(tmp_path / "drive")
    player = f"import robowidgets\nplayer = robowidgets.open({str(path)!r}).show('/level')"
    nb = plain_page([f"{player}\ndisplay(player.bar, player.views[0].widget)"])
    value = nb.output(0).locator(".rw-number-value")
    expect(value).to_have_text("2 m")
    expect(nb.output(0).get_by_role("button", name="Save as PNG")).to_be_visible()
    nb.python("player.time = 3.0")
    expect(value).to_have_text("1.7 m")
    shoot(nb.output(0), "fourth-kind")
    nb.python("player.playing = True")
    expect(value).to_have_text("1.51 m")
    nb.python("player.close()")


def test_a_page_in_a_file_plays_it_by_its_own_front_end(browser: Browser, tmp_path: Path) -> None:
    with robowidgets.open(drive.write(tmp_path / "drive")) as recording:
        file = recording.to_html(tmp_path / "page.html", topics=["/level"])
    page = browser.new_page()
    page.goto(file.as_uri())
    value = page.locator(".rw-number-value")
    expect(value).to_have_text("2 m")
    page.locator(".rw-play").click()
    # It lasts five seconds.
    expect(value).to_have_text("1.51 m")
    page.close()

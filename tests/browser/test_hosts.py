"""Hosts other than JupyterLab show the widgets, answer a pointer, and are dark with them: marimo and Voila."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

import pytest
from playwright.sync_api import Browser, Page, expect

from ..reserved import free_port
from ..unit.waiting import wait_for
from .chromium import PICTURES, SCREENSHOTS, shoot
from .notebook import notebook_of

CELLS = (
    "import robowidgets\nrecording = robowidgets.open(robowidgets.SAMPLE)",
    'laser = robowidgets.LaserWidget(title="/scan")\nlaser.update(recording.at("/scan", 24.1))\nlaser',
    "scanogram = recording.scanogram()\nscanogram",
)
SHOW = "player = recording.show()\nplayer"
MARIMO = """import marimo
app = marimo.App(width="full")


@app.cell
def _():
    import robowidgets
    recording = robowidgets.open(robowidgets.SAMPLE)
    laser = robowidgets.LaserWidget(title="/scan")
    laser.update(recording.at("/scan", 24.1))
    laser
    return (recording, robowidgets)


@app.cell
def _(recording):
    scanogram = recording.scanogram()
    scanogram
    return (scanogram,)


@app.cell
def _(recording, robowidgets):
    near, speed = robowidgets.LaserWidget(title="/near"), robowidgets.SpeedWidget(title="/speed")
    near.update(recording.at("/scan", 24.1))
    speed.update(linear=(0.1, 0, 0), angular=(0, 0, 0))
    robowidgets.screen(near, speed)
    return


@app.cell
def _(robowidgets):
    feed = robowidgets.feeds.simulator(wander=False)
    feed.show()
    return


@app.cell
def _(robowidgets):
    player = robowidgets.open(robowidgets.SAMPLE).show()
    player
    return


@app.cell
def _(recording):
    import marimo as mo
    mo.iframe(recording.to_html("drive.html", end=5).read_text(), height="620px")
    return
"""


@contextmanager
def serving(folder: Path, command: Callable[[int], list[str]]) -> Iterator[str]:
    """Start a host on a free port, and yield its address."""
    port = free_port()
    environment = {**os.environ, "HOME": str(folder), "XDG_CONFIG_HOME": str(folder)}
    with (folder / "log").open("w") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", *command(port)], cwd=folder, env=environment, stdout=log, stderr=subprocess.STDOUT
        )
    url = f"http://127.0.0.1:{port}"

    def answers() -> bool:
        try:
            urlopen(url, timeout=240).close()
        except URLError:
            return False
        return True

    try:
        wait_for(answers, f"{command(port)[0]} answered")
        yield url
    finally:
        process.terminate()
        process.wait(240)


def shows(page: Page) -> None:
    """Check a laser and a scanogram with pointer and keys."""
    laser = page.locator(".rw-laser").first
    expect(laser.locator(".rw-nearest")).to_contain_text("0.16 m", timeout=60_000)
    laser.get_by_role("button", name="Zoom in (+)").click()
    expect(laser.locator(".rw-range")).to_have_text("5 m")
    laser.locator(".rw-freeze").click()
    expect(laser.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
    scanogram = page.locator(".rw-scanogram").first
    scanogram.locator(".rw-picture").hover(position={"x": 300, "y": 100})
    expect(scanogram.locator(".rw-popup:visible")).to_contain_text("ranges[")
    assert "waiting" not in page.locator("body").inner_text()


def shows_views(page: Page) -> None:
    """Check screens with pointer and keys: of two widgets, of a robot, and of a recording, which plays."""
    cards = {name: page.locator(".rw-columns .rw-card", has_text=name) for name in ("/near", "/speed")}
    cards["/near"].locator(".rw-freeze").click()
    for card in cards.values():
        expect(card.locator(".rw-freeze")).to_contain_text("Frozen")
    feed = page.locator(".rw-feed")
    expect(feed.locator(".rw-laser", has_text="Hz")).to_be_visible()
    expect(feed.locator(".rw-freeze-all")).to_have_text("Freeze")
    page.locator(".rw-stop").dispatch_event("pointerdown", {"button": 0})
    expect(page.locator(".rw-stop")).to_have_text("Stopped")
    player = page.locator(".rw-recording").last
    now, nearest = player.locator(".rw-play-now"), player.locator(".rw-laser .rw-nearest")
    player.locator(".rw-player input").press("Home")
    expect(now).to_have_text("0.00")
    first = nearest.inner_text()
    player.locator(".rw-play").click()
    expect(nearest).not_to_have_text(first)
    expect(player.locator(".rw-play")).to_have_attribute("aria-label", re.compile("Stop|Pause"))
    player.locator(".rw-player input").press("End")
    expect(now).to_have_text("58.00")


def test_marimo_shows_widgets_and_screens_and_a_recording_as_a_page_and_is_dark_with_them(
    browser: Browser, tmp_path: Path
) -> None:
    pytest.importorskip("marimo")
    (tmp_path / "robot.py").write_text(MARIMO)
    run = ["marimo", "run", "robot.py", "--headless", "--no-token", "--host=127.0.0.1"]
    settings = tmp_path / "pyproject.toml"
    settings.touch()  # marimo looks for this file at its start, and reads it for each page
    with serving(tmp_path, lambda port: [*run, f"--port={port}"]) as url:
        for theme in ("light", "dark"):
            settings.write_text(f'[tool.marimo.display]\ntheme = "{theme}"\n')
            # The system has the other theme: the theme of the page counts.
            page = browser.new_page(color_scheme="light" if theme == "dark" else "dark")
            page.goto(url)
            expect(page.locator(".rw-laser").first).to_have_attribute("data-rw-theme", theme, timeout=60_000)
            if PICTURES:
                page.screenshot(path=SCREENSHOTS / f"marimo-{theme}.png", full_page=True)
                for kind in ("feed", "recording"):
                    expect(page.locator(f".rw-{kind} .rw-tile").first).to_be_visible()
                    shoot(page.locator(f".rw-{kind}").last, f"marimo-{kind}-{theme}")
            if theme == "light":
                shows(page)
                player = page.frame_locator("iframe").locator(".rw-player")
                player.locator("input").press("End")
                expect(player.locator(".rw-play-now")).to_have_text("5.00")
                shows_views(page)
            page.close()


def test_voila_shows_widgets_and_recordings_and_is_dark_with_them(browser: Browser, tmp_path: Path) -> None:
    pytest.importorskip("voila")
    (tmp_path / "robot.ipynb").write_text(notebook_of((*CELLS, SHOW)))
    run = ["voila", "robot.ipynb", "--no-browser", "--Voila.ip=127.0.0.1"]
    with serving(tmp_path, lambda port: [*run, f"--port={port}"]) as url:
        page = browser.new_page(viewport={"width": 1280, "height": 720})
        player = page.locator(".rw-player")
        for theme in ("light", "dark"):

            def is_shown(address: str = f"{url}?theme={theme}") -> bool:
                """Voila's page shows no widget if a busy kernel does not answer it within four seconds."""
                page.goto(address)
                page.locator(".rw-laser").first.or_(page.get_by_text("model not found").first).first.wait_for()
                return page.get_by_text("model not found").count() == 0

            wait_for(is_shown, "the page shows the widgets")
            for card in (page.locator(".rw-laser").first, player):
                expect(card).to_have_attribute("data-rw-theme", theme, timeout=60_000)
            if PICTURES:
                page.screenshot(path=SCREENSHOTS / f"voila-{theme}.png", full_page=True)
        shows(page)
        player.locator("input").press("End")
        expect(player.locator(".rw-play-now")).to_have_text("58.00")
        page.close()

"""A ring of sonars among the widgets of a robot and of a recording."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

import robowidgets
from robowidgets import feeds

from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .plain_page import PlainPage
from .test_feed_view import CUT

ROBOT = "from robowidgets import feeds\nrobot = feeds.simulator('pioneer', room='office')"
SHOW = "view = robot.show()\nview"


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Some seconds of a Pioneer."""
    path = tmp_path_factory.mktemp("pioneer") / "drive.mcap"
    with feeds.simulator("pioneer", room="office") as robot, robot.record(path) as recorder:
        wait_for(lambda: recorder.written["/sonar/rear_7"] > 8, "it was recorded")
    return path


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_robot_shows_its_ring_next_to_its_other_sensors(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([ROBOT, SHOW], theme=theme, scale=scale, height=720)
    ring = nb.output(1).locator(".rw-card.rw-sonar")
    expect(ring).to_have_count(1)
    expect(ring.locator(".rw-header")).to_contain_text("/sonar")
    expect(ring.locator(".rw-nearest")).to_contain_text("nearest")
    for width in (1200, 800, 480):
        nb.resize(width, 720)
        shoot(nb.output(1), f"ring-robot-{theme}-{width}")
        assert nb.output(1).locator(".rw-card").evaluate_all(CUT) == []


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_player_moves_the_ring_through_its_time(
    plain_page: Callable[..., PlainPage], drive: Path, theme: str, scale: int
) -> None:
    show = f"import robowidgets\nplayer = robowidgets.open({str(drive)!r}).show()\nplayer"
    nb = plain_page([show], theme=theme, scale=scale, height=720)
    ring = nb.output(0).locator(".rw-card.rw-sonar")
    nearest = ring.locator(".rw-nearest")
    expect(nearest).to_contain_text("nearest")
    for width in (1200, 480):
        nb.resize(width, 720)
        shoot(nb.output(0), f"ring-player-{theme}-{width}")
    before = nearest.inner_text()
    nb.python("player.time = player.duration")
    expect(nearest).not_to_have_text(before)
    nb.python("player.close()")


def test_a_page_in_a_file_plays_the_ring(browser: Browser, drive: Path, tmp_path: Path) -> None:
    with robowidgets.open(drive) as recording:
        file = recording.to_html(tmp_path / "page.html", scanogram=False)
    page = browser.new_page()
    page.goto(file.as_uri())
    nearest = page.locator(".rw-card.rw-sonar .rw-nearest")
    expect(nearest).to_contain_text("nearest")
    before = nearest.inner_text()
    page.locator(".rw-play").click()
    expect(nearest).not_to_have_text(before)
    page.close()

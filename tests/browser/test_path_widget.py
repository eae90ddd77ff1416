"""The path of a robot as a map: its drawing, its labels, its frozen state, and the moment of a player."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .notebook import wait_for_drawing
from .plain_page import PlainPage

PATH = """
from robowidgets import PathWidget
path = PathWidget(title="/odom")
def drive(start, stop):
    for i in range(start, stop):
        path.update(x=0.1 * i, y=0.0, yaw=0.0, time=0.5 * i)
        path.send_newest()
path
"""
PLAYER = """
import robowidgets
player = robowidgets.open(robowidgets.SAMPLE).show("/odom")
player.seek(20)
player
"""

# Pixels of the floor in the ink of the path so far, and in the gray of the rest.
COUNT = """(card) => {
  const canvas = card.querySelector("canvas");
  const style = getComputedStyle(card);
  const floor = canvas.height - 30 * devicePixelRatio;
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, floor);
  return ["ink", "guide"].map((name) => {
    const hex = style.getPropertyValue(`--rw-${name}`).trim();
    const rgb = [1, 3, 5].map((i) => Number.parseInt(hex.slice(i, i + 2), 16));
    let count = 0;
    for (let i = 0; i < data.length; i += 4) if (rgb.every((c, k) => Math.abs(c - data[i + k]) < 36)) count++;
    return count;
  });
}"""


def await_drawing(card: Locator) -> None:
    wait_for_drawing(card.page)


def counts(card: Locator) -> list[int]:
    await_drawing(card)
    found: list[int] = card.evaluate(COUNT)
    return found


@pytest.mark.core
@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_path_is_drawn_and_names_time_pose_and_way_under_the_pointer_and_by_keys(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([PATH], theme=theme, scale=scale)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-empty")).to_have_text("waiting for a pose")
    nb.python("drive(0, 21)")
    expect(card.locator(".rw-footer")).to_contain_text("x 2.00 m, y 0.00 m, 0.0°")
    expect(card.locator(".rw-footer")).to_contain_text("2.00 m driven · 10.0 s")
    picture, popup = card.locator(".rw-picture"), card.locator(".rw-popup")
    for width in (700, 400, 300):
        nb.resize(width)
        shoot(card, f"path-{theme}-{width}")
    nb.resize(700)
    box = picture.bounding_box()
    assert box
    # The path lies in the middle of the floor.
    nb.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + (12 + box["height"] - 28) / 2 + 10)
    expect(popup).to_contain_text("x 1.0")
    expect(popup).to_contain_text("5.0")
    expect(popup).to_contain_text("before")
    shoot(card, f"path-{theme}-pointed")
    nb.page.mouse.move(box["x"] + 5, box["y"] + 5)
    expect(popup).to_be_hidden()
    picture.focus()
    nb.page.keyboard.press("Home")
    expect(popup).to_have_text(re.compile(r"^0\.00 s"))
    nb.page.keyboard.press("ArrowRight")
    expect(popup).to_contain_text("x 0.10 m, y 0.00 m")
    expect(card.locator(".rw-live")).to_contain_text("driven 0.10 m")
    nb.page.keyboard.press("Escape")
    expect(popup).to_be_hidden()
    ink, _ = counts(card)
    card.locator(".rw-freeze").click()
    nb.python("drive(21, 41)")
    expect(card.locator(".rw-freeze")).to_contain_text("20")
    expect(card.locator(".rw-footer")).to_contain_text("2.00 m driven")
    picture.focus()

    def reaches_the_end() -> bool:
        nb.page.keyboard.press("End")
        return (popup.text_content() or "").startswith("20.00 s")

    wait_for(reaches_the_end, "the whole path has come, up to 0.25 s after the pose")
    expect(popup).to_contain_text("later")
    shoot(card, f"path-{theme}-frozen")
    # The map is now twice as wide.
    assert counts(card)[0] < 0.85 * ink, "what came since is not in ink"
    nb.page.keyboard.press("Escape")
    nb.page.keyboard.press(" ")
    expect(card.locator(".rw-footer")).to_contain_text("4.00 m driven")


def test_a_player_draws_the_way_up_to_its_moment_dark_and_goes_to_a_place_that_is_picked(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([PLAYER])
    card = nb.output(0).locator(".rw-path")
    expect(card.locator(".rw-footer")).to_contain_text("driven · 20.0 s")
    early = counts(card)
    nb.python("player.seek(50)")
    expect(card.locator(".rw-footer")).to_contain_text("driven · 50.0 s")
    late = counts(card)
    assert early[0] < late[0], "the dark part grows"
    assert early[1] > late[1], "the faint part shrinks"
    shoot(nb.output(0), "path-player")
    picture, popup, now = card.locator(".rw-picture"), card.locator(".rw-popup"), nb.output(0).locator(".rw-play-now")
    picture.focus()
    for key in ("Home", "PageUp"):
        nb.page.keyboard.press(key)
    await_drawing(card)
    named = popup.locator(".rw-popup-expression").text_content() or ""
    nb.page.keyboard.press("Enter")
    expect(now).to_have_text(named.removesuffix(" s"))
    expect(popup).to_be_hidden()
    box = picture.bounding_box()
    assert box
    for y in (0.8, 0.6, 0.4, 0.2):
        nb.page.mouse.move(round(box["x"] + 0.4 * box["width"]), round(box["y"] + y * box["height"]))
        await_drawing(card)
        if popup.is_visible():
            break
    named = popup.locator(".rw-popup-expression").text_content() or ""
    nb.page.mouse.down()
    nb.page.mouse.up()
    expect(now).to_have_text(named.removesuffix(" s"))
    shoot(nb.output(0), "path-player-picked")


JUMP = """
from robowidgets import PathWidget
path = PathWidget(title="/odom")
for x in (0, 8):
    for i in range(21):
        path.update(x=x + 0.1 * i, y=0.1 * i, yaw=0.8, time=x / 2 + 0.2 * i)
path
"""
INKED = """(card) => {
  const canvas = card.querySelector("canvas");
  const hex = getComputedStyle(card).getPropertyValue("--rw-ink").trim();
  const rgb = [1, 3, 5].map((i) => Number.parseInt(hex.slice(i, i + 2), 16));
  const floor = canvas.height - 30 * devicePixelRatio;
  const { data, width } = canvas.getContext("2d").getImageData(0, 0, canvas.width, floor);
  const columns = new Set();
  for (let i = 0; i < data.length; i += 4)
    if (rgb.every((c, k) => Math.abs(c - data[i + k]) < 36)) columns.add((i / 4) % width);
  const inked = [...columns].sort((a, b) => a - b);
  return Math.max(...inked.map((x, i) => x - (inked[i - 1] ?? x))) / (inked.at(-1) - inked[0]);
}"""
"""The widest gap between columns with ink, as a part of the whole width."""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_no_line_is_drawn_where_the_robot_jumped(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([JUMP], theme=theme, scale=scale)
    card = nb.widget(0).locator(".rw-card")
    await_drawing(card)
    assert card.evaluate(INKED) > 0.5
    shoot(card, f"path-jump-{theme}@{scale}x")
    assert nb.python("len(path.points)") == "42"

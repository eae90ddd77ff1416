"""Rerun next to the widgets of a recording: the 3D world on one side, exact data on the other, one time for both."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import shoot
from .notebook import Notebook

pytest.importorskip("rerun_notebook", reason="Rerun is not installed: pip install 'robowidgets[rerun]'")

SHOW = """
import robowidgets
player = robowidgets.open(robowidgets.SAMPLE).show("/scan", "/odom", "/bumper", scanogram=False, rerun=True)
player.time, told, tell = 12.5, [], player.rerun._viewer.set_time_ctrl
player.rerun._viewer.set_time_ctrl = lambda *names, **more: (told.append(more["duration_nanos"]), tell(*names, **more))
player
"""


def now(nb: Notebook) -> Locator:
    return nb.output(0).locator(".rw-play-now")


def viewer_follows(nb: Notebook) -> None:
    """Wait until the viewer has answered everything it received."""
    wait_for(lambda: nb.python("print(player.rerun._agrees and not player.rerun._sent)").strip() == "True", "it did")


def click_the_time_line(canvas: Locator) -> None:
    """Move the mouse in steps, like a hand: the viewer reads the mouse once for each picture that it draws."""
    canvas.scroll_into_view_if_needed()
    place = canvas.bounding_box()
    assert place
    mouse = canvas.page.mouse
    for act in (lambda: mouse.move(place["x"] + 0.6 * place["width"], place["y"] + place["height"] - 14), mouse.down):
        act()
        canvas.evaluate("() => new Promise(resolve => requestAnimationFrame(() => requestAnimationFrame(resolve)))")
    mouse.up()


def test_viewer_and_widgets_stand_side_by_side_and_follow_each_other(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([SHOW], width=1300, height=1200)
    canvas = nb.output(0).locator(".rerun_notebook canvas").last
    canvas.wait_for()
    wait_for(lambda: nb.python("print(player.rerun._agrees)").strip() == "True", "it was loaded")
    assert nb.python("print(player.time)").strip() == "12.5", "what is loaded does not move the time"
    world, screen = canvas.bounding_box(), nb.output(0).locator(".rw-recording").bounding_box()
    assert world
    assert screen
    assert world["x"] + world["width"] <= screen["x"], "the world is on the left"
    assert abs(world["y"] - screen["y"]) < 50, "next to each other"
    assert min(world["width"], screen["width"]) > 350

    nb.python("told.clear(); player.time = 40.75")
    viewer_follows(nb)
    expect(now(nb)).to_have_text("40.75")
    slider = nb.output(0).locator(".rw-player input[type=range]")
    slider.evaluate("slider => { slider.value = 21.5; slider.dispatchEvent(new Event('input')); }")
    wait_for(lambda: nb.python("print(told)").strip() == "[40750000000, 21500000000]", "Rerun got it")
    viewer_follows(nb)
    shoot(nb.output(0), "rerun-beside")

    footer = nb.output(0).locator(".rw-laser .rw-footer").text_content()
    nb.python("told.clear()")
    click_the_time_line(canvas)
    expect(now(nb)).not_to_have_text("21.50")
    expect(nb.output(0).locator(".rw-laser .rw-footer")).not_to_have_text(footer or "")
    there = float(nb.python("print(player.time)"))
    nb.page.keyboard.press("ArrowLeft")
    expect(now(nb)).to_have_text(f"{there - 0.1:.2f}")
    nb.python("player.time = 30")
    viewer_follows(nb)
    assert nb.python("print(told)").strip() == "[30000000000]", "what came from Rerun does not go back to it"

"""Widgets in cells that JupyterLab stops rendering while they are far out of view, and renders again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import pytest
from playwright.sync_api import expect

import robowidgets

from ..unit.waiting import wait_for
from . import cloud, events, message, plot, sonar, test_feed_view, test_image_widget, test_layout_reads, test_map
from .laser import DARK, FAN, SETUP, eventually, layers, locate
from .notebook import Notebook
from .test_laser_live import is_frozen, is_live
from .test_player import bar, now, to_time

LONG = "\n".join(f"# {line}" for line in range(80))
"""A cell higher than the window. Chromium renders elements less than one and a half windows out of view."""

WINDOWINGS = ["contentVisibility", "full"]
"""JupyterLab's default since 4.5, where the browser skips cells, and the older one, where cells are not displayed."""

FIRST = f"{SETUP}\nfrom robowidgets.widget.pacer import pacer\nlaser.update(**fan())\nlaser"

Open = Callable[..., Notebook]


def opened(notebook: Open, windowing: str, cells: Sequence[str], **more: object) -> Notebook:
    """Open a notebook whose cells are run, with long cells after them."""
    nb = notebook([*cells, *[LONG] * 3, "0"], run=False, **more)
    nb.windowing(windowing)
    nb.run_all()
    return nb


@pytest.mark.parametrize("windowing", WINDOWINGS)
def test_a_laser_is_live_or_frozen_as_it_was_and_has_the_size_and_the_theme_of_now(
    notebook: Open, windowing: str
) -> None:
    nb = opened(notebook, windowing, [FIRST])
    nb.scroll_to(0)
    card = nb.widget(0).locator(".rw-card")
    picture, nearest = card.locator(".rw-picture"), card.locator(".rw-nearest")
    picture.hover(position=dict(zip("xy", locate(card).at(*FAN[4]), strict=True)))  # type: ignore[arg-type]
    eventually(lambda: nb.python("laser.hovered"), "4")

    nb.scroll_away(0)
    eventually(lambda: nb.python("laser.hovered is None"), "True")
    nb.python("laser.update(**fan({9: 0.8}))")
    nb.theme("dark")
    nb.page.set_viewport_size({"width": 700, "height": 900})
    nb.scroll_to(0)
    expect(nearest).to_contain_text("0.80 m")
    changed = [*FAN[:9], (0.8, 0.0), *FAN[10:]]
    locate(card, changed, colour=DARK["reading"])
    sizes = "card => [...card.querySelectorAll('.rw-layer')].map((layer) => layer.width - layer.parentNode.clientWidth)"
    assert card.evaluate(sizes) == [0, 0]
    is_live(card)

    nb.page.mouse.move(5, 5)
    nb.python("laser.paused = True")
    is_frozen(card, 0)
    nb.drawn()
    held = layers(card)
    nb.scroll_away(0)
    for distance in (0.7, 0.9):
        nb.python(f"laser.update(**fan({{9: {distance}}}))\npacer.flush()")
    nb.scroll_to(0)
    is_frozen(card, 2)
    nb.drawn()
    assert layers(card) == held
    for key, distance in ((".", "0.70 m"), (".", "0.90 m"), (",", "0.70 m")):
        picture.press(key)
        expect(nearest).to_contain_text(distance)
    picture.press("Space")
    is_live(card)
    expect(nearest).to_contain_text("0.90 m")


@pytest.mark.parametrize("windowing", WINDOWINGS)
def test_a_laser_whose_cell_has_never_been_in_view_is_drawn_when_it_comes(notebook: Open, windowing: str) -> None:
    nb = notebook([LONG, LONG, LONG, FIRST, LONG, LONG, LONG, "0"], run=False)
    nb.windowing(windowing)
    nb.run_all_at_once()
    nb.python("laser.update(**fan({9: 0.8}))")
    nb.scroll_to(3)
    card = nb.widget(3).locator(".rw-card")
    locate(card, [*FAN[:9], (0.8, 0.0), *FAN[10:]])
    expect(card.locator(".rw-nearest")).to_contain_text("0.80 m")


@pytest.mark.parametrize("windowing", WINDOWINGS)
def test_a_player_plays_on_and_shows_its_moment(notebook: Open, windowing: str) -> None:
    table = f"import robowidgets\nrecording = robowidgets.open({str(robowidgets.SAMPLE)!r})"
    nb = opened(notebook, windowing, [table, "player = recording.show()\nplayer"])
    nb.scroll_to(1)
    to_time(nb, 20.0)
    nb.python("player.playing = True")
    nb.scroll_away(1)
    wait_for(lambda: float(nb.python("print(player.time)")) > 22, "it plays on")
    nb.python("player.playing = False")
    for seconds in (None, 30.0):
        if seconds is not None:
            nb.scroll_away(1)
            nb.python(f"player.time = {seconds}")
        nb.scroll_to(1)
        wait_for(
            lambda: abs(float(nb.python("print(player.time)")) - now(nb)) < 0.006, "page and Python are at one time"
        )
        time = now(nb)
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            # By the exact time: the page shows hundredths.
            exact = float(nb.python("print(player.time)"))
            scans = [m for m in recording.samples("/scan") if m.seconds <= exact + 1e-6]
        nearest = nb.output(1).locator(".rw-laser .rw-nearest")
        expect(nearest).to_contain_text(f"[{scans[-1].sample.nearest().index}]")
        expect(nb.output(1).locator(".rw-scanogram-cursor")).to_contain_text(f"{time:.2f} s")
    bar(nb).locator("input[type=range]").press(".")
    expect(nb.output(1).locator(".rw-play-now")).to_have_text("30.10")


@pytest.mark.parametrize("windowing", WINDOWINGS)
def test_the_view_of_a_robot_goes_on_or_stays_frozen_and_its_list_of_topics_has_values_again(
    notebook: Open, windowing: str
) -> None:
    robot = test_feed_view.ROBOT.format(robot="turtlebot3")
    nb = opened(notebook, windowing, [robot, test_feed_view.RUN, test_feed_view.SHOW], width=1280, height=720)
    nb.scroll_to(2)
    feed = nb.output(2).locator(".rw-feed")
    time, laser = feed.locator(".rw-simulator .rw-facts"), feed.locator(".rw-laser")
    expect(feed.locator(".rw-machine-state[data-active='leaf']")).to_be_visible()
    nb.python("view.topic_list.folded = False")
    value = feed.locator(".rw-topic[data-key='/odom'] .rw-topic-value")
    expect(value).to_contain_text("m/s")
    looks = "print(sum(len(names) for _, names in view.topic_list._looks.values()))"
    seconds = "robot.robot.time"
    for _ in range(2):
        nb.scroll_away(2)
        wait_for(lambda: nb.python(looks).strip() == "0", "no value is sent for rows that are not seen")
        began = float(nb.python(seconds))
        wait_for(lambda began=began: float(nb.python(seconds)) > began + 1, "the robot goes on")
        nb.scroll_to(2)
        wait_for(lambda: int(nb.python(looks)) > 0, "values come again")
        expect(value).to_contain_text("m/s")
        before = time.inner_text()
        expect(time).not_to_have_text(before, use_inner_text=True)

    nb.python("view.widgets['/scan'].paused = True")
    expect(laser.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
    nb.drawn()
    held = layers(laser)
    nb.scroll_away(2)
    nb.scroll_to(2)
    nb.drawn()
    assert layers(laser) == held
    feed.locator(".rw-freeze-all").click()
    expect(feed.locator(".rw-frozen")).to_have_count(0)
    eventually(lambda: layers(laser) == held, False)
    feed.locator(".rw-stop-bar .rw-stop").click()
    wait_for(lambda: nb.python("robot.stopped") == "True", "Stop has been heard")


WIDGETS = {
    "speed": (test_layout_reads.SPEED, "speed.update(linear=(0.25, 0, 0), angular=(0, 0, 0.4))"),
    "touch": (test_layout_reads.TOUCH, "touch.update(left=False, right=True)"),
    "sonars": (sonar.STUDENT, "sonars.update(front=0.2, left=0.3, right=0.1)"),
    "camera": (test_image_widget.COLOR + "\ncamera", "camera.update(room[::-1])"),
    "few": ("import numpy as np\nfrom robowidgets import CloudWidget\n" + cloud.FEW, "few.update(_few[:2])"),
    "path": (test_map.SMALL, "drive(30, 40)"),
    "plot": (plot.LIVE, "for i in range(600, 700): plot.update({'v': 0.3, 'heading': 1.0}, time=i / 10)"),
    "imu_widget": (message.IMU, "imu_widget.update(imu(z=0.5))"),
    "many": (events.MANY.replace("3000", "300"), "for i in range(20): many.add(f'new {i}', time=31.0 + i)"),
}
"""By the name of each widget in the kernel: the cell that shows it, and code that changes it."""

SEEN = """card => [
    card.querySelector('.rw-picture').innerText.replaceAll(/\\d+\\.\\d s|no data.*/g, ""),
    [...card.querySelectorAll('canvas')].map((canvas) => canvas.toDataURL()),
]"""
"""Texts, without counted seconds, and pixels."""


@pytest.mark.parametrize("windowing", WINDOWINGS)
def test_what_came_meanwhile_is_drawn_and_a_list_stays_scrolled(notebook: Open, windowing: str) -> None:
    nb = opened(notebook, windowing, [cell for cell, _ in WIDGETS.values()])

    def seen(cell: int) -> Any:
        nb.scroll_to(cell)
        nb.drawn()
        return nb.widget(cell).locator(".rw-card").evaluate(SEEN)

    before = {}
    for cell, name in enumerate(WIDGETS):
        eventually(lambda cell=cell: seen(cell) == seen(cell), True)
        before[name] = seen(cell)
        nb.scroll_away(cell)
    for _, change in WIDGETS.values():
        nb.python(change)
    for cell, name in enumerate(WIDGETS):
        eventually(lambda cell=cell, name=name: seen(cell) != before[name], True)

    # A list keeps its scroll position.
    cell = list(WIDGETS).index("many")
    rows = nb.widget(cell).locator(".rw-events-list")
    nb.scroll_to(cell)
    rows.evaluate("list => { list.scrollTop = 1000; }")
    nb.drawn()
    line = rows.locator(".rw-event-text:visible").nth(3)
    there, text = rows.evaluate("list => list.scrollTop"), line.inner_text()
    nb.scroll_away(cell)
    nb.python("many.add('and one', source='node', time=60.0)")
    nb.scroll_to(cell)
    expect(nb.widget(cell).locator(".rw-footer")).to_contain_text("321")
    eventually(lambda: (rows.evaluate("list => list.scrollTop"), line.inner_text()), (there, text))

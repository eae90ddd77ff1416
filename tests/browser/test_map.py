"""The path widget as a map: the looks of its layers, its controls, and measuring on it."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, expect

import robowidgets

from .. import map_scene
from ..unit.recordings import recorded
from .chromium import LOOKS, shoot
from .plain_page import PlainPage
from .test_path_widget import await_drawing

MAP = """
from robowidgets import Line, PathWidget
from tests import map_scene
path = PathWidget(title="Map")
path.has_rate = False
map_scene.drive(path)
path.put("/sonar/left", map_scene.plan([(0, 0), (1, 0)], 33.0, "sonar_link"), time=33.2)
path.put("map->arm")
path.draw("door 2", Line((4.9, -0.6), (6.0, -0.6)), frame="odom")
path
"""
SMALL = """
import numpy as np
from robowidgets import MapGrid, PathWidget
from robowidgets.samples import Pose
path = PathWidget(title="Map")
path.has_rate = False
cells = np.zeros((40, 80), np.uint8)
cells[20:, 40:] = 100
path.put("/map", MapGrid(cells, 0.1, Pose(-4.0, -2.0, 0.0), frame_id="map"))
def drive(start, stop):
    for i in range(start, stop):
        pose = {"position": {"x": 0.1 * i - 3.5, "y": -1.0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}
        path.put("/pose", {"header": {"frame_id": "map"}, "pose": pose}, time=0.5 * i)
drive(0, 30)
path
"""
"""The floor is exactly the grid, 8 m wide: half of it is occupied, on the upper right."""

GROWING = """
import numpy as np
from robowidgets import MapGrid, PathWidget
from robowidgets.samples import Pose
path = PathWidget(title="Map")
path.has_rate = False
def show(side, cell):
    corner = Pose(-side / 40, -side / 40, 0.0)
    path.put("/map", MapGrid(np.full((side, side), cell, np.uint8), 0.05, corner, frame_id="map"))
show(200, 0)
path
"""
"""A map that grows to all sides, too large to come with each frame: free at first."""


def fact(card: Locator, name: str) -> Locator:
    """The text of the list for a layer."""
    row = card.locator(".rw-layers-row", has=card.page.get_by_text(name, exact=True))
    return row.locator(".rw-layers-fact")


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_layers_are_drawn_in_one_frame_and_the_list_says_what_each_is_and_which_one_nothing_joins(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([MAP], theme=theme, scale=scale)
    card = nb.widget(0).locator(".rw-card")
    for width in (320, 480, 760, 1030):
        nb.resize(width)
        await_drawing(card)
        shoot(card, f"map-{theme}-{width}")
        is_listed = card.locator(".rw-layers").is_visible()
        expect(card.get_by_title("List of the layers")).to_have_text(
            "Layers" if is_listed else "Layers, 1 not drawn, and 1 other frame"
        )
    expect(fact(card, "/sonar/left")).to_have_text("nothing joins it to this frame")
    expect(fact(card, "map->arm")).to_have_text("not drawn: nothing came yet")
    expect(fact(card, "/map")).to_contain_text("302 × 205 cells of 0.05 m")
    expect(fact(card, "/scan")).to_contain_text("readings")
    expect(fact(card, "/nav/plan")).to_contain_text("/amcl_pose 0.05 m off")
    expect(fact(card, "/odom")).to_contain_text("off /amcl_pose")
    expect(fact(card, "door 2")).to_have_text("drawn by the program")
    expect(card.locator(".rw-layers-foot")).to_contain_text("all in the frame map")
    expect(card.locator(".rw-footer")).to_contain_text("± 0.47 m")
    nb.resize(480)
    expect(card.locator(".rw-layers")).to_be_hidden()
    card.get_by_role("button", name="Layers").click()
    expect(card.locator(".rw-layers")).to_be_visible()
    shoot(card, f"map-{theme}-480-layers")


def middle_of(picture: Locator) -> tuple[float, float]:
    """The middle of the drawing next to the list of layers."""
    box = picture.bounding_box()
    assert box
    return box["x"] + (box["width"] - 270) / 2, box["y"] + 12 + (box["height"] - 40) / 2


def test_hovering_names_the_cell_as_a_program_finds_it_and_a_click_takes_a_layer_off(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([SMALL])
    nb.resize(1030)
    card = nb.widget(0).locator(".rw-card")
    expect(fact(card, "/map")).to_contain_text("80 × 40 cells of 0.10 m")
    picture, popup = card.locator(".rw-picture"), card.locator(".rw-popup")
    middle = middle_of(picture)
    nb.page.mouse.move(middle[0] + 100, middle[1] - 60)
    expect(popup.locator(".rw-popup-expression")).to_have_text(re.compile(r"grid\[2\d, 5\d\]"))
    expect(popup).to_contain_text("occupied")
    expect(popup).to_contain_text("from the robot, at")
    nb.page.mouse.move(middle[0] - 100, middle[1] - 60)
    expect(popup).to_contain_text("free")
    card.get_by_role("checkbox", name="/map").click()
    expect(fact(card, "/map")).to_have_text("not shown")
    assert nb.python("path.hidden") == "['/map']"
    nb.page.mouse.move(middle[0] + 100, middle[1] - 60)
    expect(popup).to_be_hidden()
    nb.python("path.hidden = []")
    expect(fact(card, "/map")).to_contain_text("80 × 40 cells")


def test_a_large_grid_is_drawn_as_it_was_while_frozen_and_when_stepping_back(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([GROWING])
    nb.resize(1030)
    card = nb.widget(0).locator(".rw-card")
    expect(fact(card, "/map")).to_contain_text("200 × 200 cells")
    picture, popup = card.locator(".rw-picture"), card.locator(".rw-popup")
    nb.page.mouse.move(*middle_of(picture))
    expect(popup).to_contain_text("free")
    picture.focus()
    nb.page.keyboard.press(" ")
    expect(card).to_have_class(re.compile("rw-frozen"))
    nb.python("show(240, 100)")
    expect(card).to_contain_text("1 since")
    expect(fact(card, "/map")).to_contain_text("200 × 200 cells")
    expect(popup).to_contain_text("free")
    nb.page.keyboard.press(".")
    expect(fact(card, "/map")).to_contain_text("240 × 240 cells")
    expect(popup).to_contain_text("occupied")
    nb.page.keyboard.press(",")
    expect(fact(card, "/map")).to_contain_text("200 × 200 cells")
    expect(popup).to_contain_text("free")


@pytest.mark.core
def test_it_is_moved_zoomed_measured_and_read_while_a_cell_runs(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SMALL])
    nb.resize(760)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-footer")).to_contain_text("x −0.60 m")
    picture, popup = card.locator(".rw-picture"), card.locator(".rw-popup")
    box = picture.bounding_box()
    assert box
    x, y = box["x"] + 245, box["y"] + 12 + (box["height"] - 40) / 2
    fit = card.get_by_role("button", name="Show all of it (0)")
    with nb.busy():
        expect(fit).to_be_disabled()
        card.get_by_role("button", name="Zoom in (+)").click()
        expect(fit).to_be_enabled()
        nb.page.mouse.move(x, y - 30)
        expression = popup.locator(".rw-popup-expression")
        expect(expression).to_have_text(re.compile(r"grid\["))
        before = expression.text_content()
        nb.page.mouse.down()
        nb.page.mouse.move(x + 60, y - 30, steps=3)
        nb.page.mouse.up()
        expect(expression).to_have_text(before or "")
        picture.focus()
        nb.page.keyboard.press("0")
        expect(fit).to_be_disabled()
        nb.page.keyboard.press("m")
        expect(card.get_by_role("button", name="Measure by two clicks")).to_have_attribute("aria-pressed", "true")
        nb.page.mouse.click(x, y)
        nb.page.mouse.click(x + 100, y)
        expect(card.locator(".rw-live")).to_contain_text(re.compile(r"\d\.\d\d m · 0\.0°"))
        shoot(card, "map-measured")
        nb.page.mouse.move(x - 50, y + 40)
        nb.page.mouse.down()
        nb.page.mouse.move(x - 50, y - 40, steps=3)
        nb.page.mouse.up()
        expect(card.locator(".rw-live")).to_contain_text(re.compile(r"\d\.\d\d m · 90\.0°"))
        nb.page.keyboard.press("Escape")
        nb.page.keyboard.press("Home")
        expect(expression).to_have_text("0.00 s")
        nb.page.keyboard.press("Escape")
        nb.page.keyboard.press("f")
        expect(card.get_by_role("button", name="Keep the robot in the middle")).to_have_attribute(
            "aria-pressed", "true"
        )
        shoot(card, "map-followed")
        card.locator(".rw-freeze").click()
        expect(card).to_have_class(re.compile("rw-frozen"))
    nb.python("drive(30, 60)")
    expect(card.locator(".rw-footer")).to_contain_text("x −0.60 m")
    nb.python("path.paused = False")
    expect(card.locator(".rw-footer")).to_contain_text("x 2.40 m")


def test_what_nothing_joins_is_on_a_map_of_its_own_which_a_click_shows_while_a_cell_runs(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([MAP])
    nb.resize(1030)
    card = nb.widget(0).locator(".rw-card")
    chooser = card.locator("select.rw-map-frame")
    expect(fact(card, "/map")).to_contain_text("302 × 205 cells")
    expect(fact(card, "door 2")).to_have_text("drawn by the program")
    with nb.busy():
        card.get_by_role("button", name="Frame sonar_link").click()
        expect(fact(card, "/sonar/left")).to_contain_text("1.00 m long")
        expect(fact(card, "/scan")).to_have_text("nothing joins it to this frame")
        expect(fact(card, "/map")).to_have_text("in the frame map, too")
        expect(card.locator(".rw-layers-foot")).to_contain_text("all in the frame sonar_link")
        expect(chooser).to_have_value("sonar_link")
        expect(card.locator(".rw-facts")).to_contain_text("sonar_link")
        expect(card.get_by_text("door 2")).to_have_count(0)
        shoot(card, "map-other-frame")
        nb.resize(320)
        expect(card.get_by_title("List of the layers")).to_have_text("Layers, 1 not drawn, and 1 other frame")
        card.get_by_title("List of the layers").click()
        shoot(card, "map-other-frame-320")
        card.get_by_role("button", name="Frame map").click()
        expect(fact(card, "/map")).to_contain_text("302 × 205 cells")
        nb.resize(1030)
        chooser.select_option("sonar_link")
    expect(fact(card, "door 2")).to_have_text("not drawn: no transform to sonar_link")
    assert nb.python("path.frame") == "'sonar_link'"
    nb.python('path.join("map", "sonar_link", (1, 0, 0))')
    expect(fact(card, "/map")).to_contain_text("302 × 205 cells")
    expect(fact(card, "door 2")).to_have_text("drawn by the program")


def test_names_from_outside_reach_the_page_as_text(plain_page: Callable[..., PlainPage]) -> None:
    name = "<img src=x onerror=alert(1)>"
    nb = plain_page(
        [SMALL, f'path.put({name!r}, {{"header": {{"frame_id": {name!r}}}, "x": 1.0, "y": 2.0, "theta": 0.0}})']
    )
    nb.resize(1030)
    card = nb.widget(0).locator(".rw-card")
    expect(fact(card, name)).to_have_text("nothing joins it to this frame")
    expect(card.get_by_role("button", name=f"Frame {name}")).to_be_visible()
    expect(card.locator("img")).to_have_count(0)


DRIVE = """
import tempfile, robowidgets
from pathlib import Path
from tests import map_scene
from tests.unit.recordings import recorded
folder = Path(tempfile.mkdtemp())
drive = recorded.write(folder / "drive", map_scene.TYPES, map_scene.messages(34.0))
names = ("/map", "/odom", "/amcl_pose", "/plan", "/particles", "/local_costmap")
player = robowidgets.open(drive).show(*names, scanogram=False)
player.seek(25)
player
"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_player_has_the_map_at_its_time_and_goes_to_a_place_of_the_way(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([DRIVE], theme=theme, scale=scale)
    nb.resize(1200, 720)
    card = nb.output(0).locator(".rw-path")
    expect(card.locator(".rw-footer")).to_contain_text("25.0 s")
    if not card.locator(".rw-layers").is_visible():
        card.get_by_role("button", name="Layers").click()
    expect(fact(card, "/particles")).to_contain_text("40 poses")
    expect(fact(card, "/local_costmap")).to_contain_text("60 × 60 cells of 0.05 m")
    shoot(nb.output(0), f"map-player-{theme}")
    picture = card.locator(".rw-picture")
    picture.focus()
    nb.page.keyboard.press("Home")
    nb.page.keyboard.press("Enter")
    expect(nb.output(0).locator(".rw-play-now")).not_to_have_text("25.00")
    expect(fact(card, "/amcl_pose")).to_contain_text("x 0.")


def test_a_page_in_a_file_has_the_map_with_its_cells_and_its_ways_and_what_nothing_joins_on_its_own(
    browser: Browser, tmp_path: Path
) -> None:
    types = {**map_scene.TYPES, "/fix": "geometry_msgs/msg/PoseStamped"}
    alone = map_scene.plain(map_scene.header("gps", 2.0)), map_scene.plain(map_scene.pose(0.5, 1.0, 0.0))
    messages = [*map_scene.messages(8.0), (2.0, "/fix", dict(zip(("header", "pose"), alone, strict=True)))]
    drive = recorded.write(tmp_path / "drive", types, sorted(messages, key=lambda one: one[0]))
    with robowidgets.open(drive) as recording:
        names = ["/map", "/odom", "/amcl_pose", "/fix"]
        file = recording.to_html(tmp_path / "map.html", start=3, end=7, topics=names)
    context = browser.new_context(offline=True, viewport={"width": 1200, "height": 760})
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(error.message))
    page.goto(file.as_uri())
    card = page.locator(".rw-path")
    expect(card.locator(".rw-footer")).to_contain_text("driven")
    if not card.locator(".rw-layers").is_visible():
        card.get_by_role("button", name="Layers").click()
    expect(fact(card, "/map")).to_contain_text("302 × 205 cells")
    picture, popup = card.locator(".rw-picture"), card.locator(".rw-popup")
    box = picture.bounding_box()
    assert box
    for share in (0.3, 0.4, 0.5, 0.6):
        page.mouse.move(box["x"] + share * box["width"] * 0.8, box["y"] + 0.4 * box["height"])
        await_drawing(card)
        if popup.is_visible() and "grid[" in (popup.text_content() or ""):
            break
    expect(popup).to_contain_text("grid[")
    shoot(page.locator("body"), "map-page")
    expect(fact(card, "/fix")).to_have_text("nothing joins it to this frame")
    card.get_by_role("button", name="Frame gps").click()
    expect(fact(card, "/fix")).to_contain_text("x 0.")
    expect(fact(card, "/map")).to_have_text("in the frame map, too")
    expect(card.locator(".rw-layers-foot")).to_contain_text("all in the frame gps")
    shoot(page.locator("body"), "map-page-other-frame")
    assert complaints == []
    context.close()

"""Widgets in the room that a program gives them: rows, grids, heights and narrow places."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .notebook import Notebook
from .plain_page import PlainPage
from .test_png import differences, download, seen
from .test_speed_widget import NAMES, OVERLAPS, STATES, of_each

SETUP = """
import numpy as np
from ipywidgets import GridBox, HBox, Layout, VBox
from robowidgets import DriveWidget, LaserWidget, ScanogramWidget, SpeedWidget, TouchWidget

def laser(**layout):
    laser = LaserWidget(title="/scan", layout=layout)
    laser.update(ranges=np.linspace(1, 3, 181), angle_min=-np.pi / 2, angle_increment=np.pi / 180, range_min=0.1,
                 range_max=3.5)
    return laser
def speed(**layout):
    speed = SpeedWidget(title="/odom", hold_peaks=True, layout=layout)
    speed.update(linear=(0.3, 0, -0.99), angular=(0, -0.02, -0.22))
    speed.command(linear=(0.6, 0, 0), angular=(0, 0, -1.1))
    return speed
def touch(**layout):
    touch = TouchWidget(title="/bumper", layout=layout, angles={"left": 1.2, "center": 0, "right": -1.2})
    touch.update(left=True, center=False, right=None, wheel=False)
    return touch
def scanogram(**layout):
    scanogram = ScanogramWidget(title="/scan", layout=layout)
    scanogram.update(times_ns=np.arange(200) * 100_000_000, ranges=np.tile(np.linspace(1, 9, 61), (200, 1)),
                     angle_min=-1.5, angle_increment=0.05, range_min=0.1, range_max=10.0)
    return scanogram
"""
KINDS = ["laser", "speed", "touch", "scanogram"]

CUT = """(card) => {
    const box = (element) => element.getBoundingClientRect();
    const outer = box(card);
    const names = ".rw-controls button, .rw-title, .rw-slider, .rw-time, .rw-picture, .rw-tile, .rw-tile-words, "
        + ".rw-readout-row, .rw-scanogram-scale";
    return [...card.querySelectorAll(names)]
        .filter((element) => element.offsetWidth)
        .filter((element) => box(element).right > outer.right || box(element).left < outer.left
            || element.scrollWidth > element.clientWidth + 1 && !element.matches(".rw-title, .rw-slider"))
        .map((element) => `${card.className}: ${element.className}`);
}"""
"""The parts of a card that are cut off."""

IN_PLACE = """(width) => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(
    [...document.querySelectorAll(".rw-card")].every((card) => card.offsetWidth === width)))))"""
"""Return True if every card has a width, and has drawn its content for it."""

ROOM = """(card) => {
    const box = (element) => element.getBoundingClientRect();
    const [header, picture, footer] = ["header", "picture", "footer"].map((n) => card.querySelector(`.rw-${n}`));
    return {
        card: box(card).height,
        host: box(card.parentElement).height,
        below: box(card).bottom - box(footer.hidden ? picture : footer).bottom,
        hidden: card.scrollHeight - card.clientHeight,
        picture: box(picture).height,
        rest: box(header).height + box(footer).height,
        canvas: [...card.querySelectorAll("canvas.rw-layer")].map((canvas) => box(canvas).height),
    };
}"""


def room(card: Locator) -> Any:
    return card.evaluate(ROOM)


def scrolls(box: Locator) -> int:
    """The number of pixels of a box outside its container."""
    beside: int = box.evaluate("(box) => box.scrollWidth - box.clientWidth")
    return beside


def test_rows_and_grids_shrink_to_the_room_that_there_is(notebook: Callable[..., Notebook]) -> None:
    row = "HBox([laser(), speed(), touch()])"
    grid = "GridBox([laser() for _ in range(4)], layout=Layout(grid_template_columns='repeat(2, 1fr)'))"
    many = "HBox([laser(), speed(), touch(), scanogram(), DriveWidget()])"
    column = "HBox([laser(), speed(), VBox([touch(), DriveWidget()])])"
    nb = notebook([SETUP, row, grid, "HBox([laser()])", many, column])
    for width in (320, 700, 900):
        nb.resize(width)
        for index, least in ((1, 600), (2, 400), (3, 200), (4, 1000)):
            box = nb.output(index).locator(".widget-box, .widget-gridbox")
            if width >= least:
                assert scrolls(box) == 0, f"cell {index} at {width} px"
            assert of_each(box.locator(".rw-card"), CUT) == [], f"cell {index} at {width} px"
        shoot(nb.output(1), f"row-{width}")
        shoot(nb.output(2), f"grid-{width}")
    widths = [card.bounding_box() for card in nb.output(4).locator(".rw-card").all()]
    assert [box["width"] for box in widths if box] == pytest.approx([200] * 5), "no narrower than can be read"
    nb.resize(1500)
    widths = [card.bounding_box() for card in nb.output(5).locator(".rw-card").all()]
    assert [box["width"] for box in widths if box] == pytest.approx([380] * 4, abs=3), "no wider than they need"
    shoot(nb.output(5), "row-1500")


@pytest.mark.parametrize(("theme", "scale"), [("light", 1), ("dark", 2)])
def test_a_card_fills_the_height_that_it_is_given(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    heights = (300, 600)
    cells = [f"{kind}(height='{height}px')" for kind in KINDS for height in heights]
    nb = plain_page([SETUP, *cells], theme=theme, scale=scale)
    nb.resize(700)
    for index, cell in enumerate(cells, 1):
        card = nb.widget(index).locator(".rw-card")
        got = room(card)
        assert got["host"] == heights[(index - 1) % 2]
        assert got["card"] == got["host"] - 4, cell
        assert got["hidden"] == 0, cell
        assert got["below"] == pytest.approx(1, abs=0.1), cell
        assert got["picture"] == pytest.approx(got["card"] - got["rest"] - 2, abs=0.1), cell
        assert got["canvas"] == pytest.approx([got["picture"]] * len(got["canvas"]), abs=1), cell
        shoot(nb.widget(index), f"{cell.split('(')[0]}-{heights[(index - 1) % 2]}px-high-{theme}")


def test_a_height_can_be_given_and_taken_back(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP, "shown = laser()\nshown"])
    nb.resize(700)
    card = nb.widget(1).locator(".rw-card")
    usual = room(card)
    for given in ("height = '250px'", "max_height = '250px'"):
        nb.python(f"shown.layout.{given}")
        nb.page.wait_for_function("(card) => card.offsetHeight === 246", arg=card.element_handle())
        nb.python(f"shown.layout.{given.split()[0]} = None")
        nb.page.wait_for_function(
            "([card, height]) => card.getBoundingClientRect().height === height",
            arg=[card.element_handle(), usual["card"]],
        )
    for given in ("'100%'", "'auto'"):
        nb.python(f"shown.layout.height = {given}")
        style = nb.widget(1).evaluate_handle("(host) => host")
        nb.page.wait_for_function("([host, given]) => host.style.height === given", arg=[style, given.strip("'")])
        assert room(card)["picture"] == usual["picture"], f"{given} of a height that was not given"


def test_too_little_height_leaves_a_picture_to_look_at(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP, *[f"{kind}(height='90px')" for kind in KINDS]])
    nb.resize(700)
    for index, least in enumerate((120, 150, 120, 200), 1):
        got = room(nb.widget(index).locator(".rw-card"))
        assert got["card"] == 86
        assert got["picture"] == least
        assert got["hidden"] > 0, "scrolls in its card"


def test_a_png_is_as_high_as_the_card(plain_page: Callable[..., PlainPage]) -> None:
    cells = [f"{kind}(height='{height}px')" for kind in KINDS for height in (300, 600)]
    nb = plain_page([SETUP, *cells], scale=2)
    nb.resize(600)
    for index, cell in enumerate(cells, 1):
        card = nb.widget(index).locator(".rw-card")
        if "laser" in cell:
            card.locator(".rw-freeze").click()
        _, saved = download(nb.page, card)
        assert differences(saved, seen(card)) < 0.01, cell


@pytest.mark.parametrize(("theme", "scale"), [("light", 1), ("dark", 2)])
def test_nothing_is_cut_down_to_200_pixels(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    names = [*NAMES, *[f"{kind}()" for kind in KINDS], "DriveWidget()"]
    cells = [f"on_show.append({name})\non_show[-1]" for name in names]
    nb = plain_page([f"{STATES}\n{SETUP}\non_show = []", *cells], theme=theme, scale=scale)
    cards = nb.page.locator(".rw-card")
    expect(cards).to_have_count(len(names))
    for width in (200, 240, 281, 300):
        nb.python(f"for shown in on_show:\n    shown.layout.width = '{width}px'")
        nb.page.wait_for_function(IN_PLACE, arg=width)
        assert of_each(cards, CUT) == [], f"at {width} px"
        assert of_each(nb.page.locator(".rw-speed"), OVERLAPS) == [], f"at {width} px"
        for index in range(len(names)):
            shoot(cards.nth(index), f"narrow-{index + 1}-{theme}-{width}")


def test_freezing_moves_nothing_in_a_narrow_header(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP, "l = laser(width='200px')\nl", "s = speed(width='200px')\ns"])
    for index, update in ((1, "l.update(l.scan)"), (2, "s.update(linear=(0, 0, 0))")):
        header = nb.widget(index).locator(".rw-header")
        before = header.evaluate("(header) => header.offsetHeight")
        header.locator(".rw-freeze").click()
        nb.python(f"for _ in range(140):\n    {update}")
        expect(header.locator(".rw-number")).to_have_text("140")
        assert header.evaluate("(header) => header.offsetHeight") == before


def test_the_boxes_of_cards_that_are_put_into_a_shadow_root_know_of_them(plain_page: Callable[..., PlainPage]) -> None:
    """As the documentation pages do: made first, and then put into the root of an element in the page."""
    nb = plain_page([SETUP, "HBox([laser(), speed()])"])
    nb.page.evaluate(
        """(cell) => {
        const output = document.querySelector(`[data-cell="${cell}"]`);
        const root = output.attachShadow({ mode: "open" });
        output.append = (...elements) => root.append(...elements);
    }""",
        1,
    )
    nb.run(1)
    row = nb.output(1).locator(".widget-hbox")
    expect(row.locator(".rw-room")).to_have_count(2)
    expect(row).to_have_attribute("data-rw-holds", "card laser speed")
    expect(row.locator(".rw-laser").locator("..")).to_have_css("margin-right", "6px")


def test_a_recording_in_a_cell_of_848_pixels_has_its_scanogram_next_to_the_laser_on_the_first_screen(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page(["import robowidgets\nrecording = robowidgets.open(robowidgets.SAMPLE)", "recording.show()"])
    for width in (800, 848):
        nb.resize(width, 720)
        whole, laser, scanogram = (
            nb.output(1).locator(one).bounding_box() for one in (".rw-recording", ".rw-laser", ".rw-scanogram")
        )
        assert whole
        assert laser
        assert scanogram
        assert whole["height"] <= 570
        assert scanogram["x"] + scanogram["width"] < laser["x"]
        assert scanogram["y"] == laser["y"]
        assert of_each(nb.output(1).locator(".rw-card"), CUT) == []


def test_small_cards_of_a_recording_keep_their_names_and_numbers_apart(
    plain_page: Callable[..., PlainPage], data: Path
) -> None:
    file = str(data / "good" / "neato_fsm_zstd.mcap")
    nb = plain_page([f"import robowidgets\nrecording = robowidgets.open({file!r})", "recording.show()"])
    small = nb.output(1).locator(".rw-smalls")
    for width in (808, 848, 890):
        nb.resize(width)
        expect(small.locator(".rw-speed .rw-value")).to_have_count(5)
        assert of_each(small.locator(".rw-speed"), OVERLAPS) == []
        titles = small.locator(".rw-title")
        assert titles.evaluate_all("(titles) => titles.every((one) => one.scrollWidth <= one.clientWidth)")


def test_headers_of_two_lines_keep_their_controls_in_a_cell_of_256_pixels(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page(["import robowidgets\nrecording = robowidgets.open(robowidgets.SAMPLE)", "recording.show()"])
    nb.resize(256)
    assert (
        nb.output(1)
        .locator(".rw-screen .rw-header")
        .evaluate_all(
            """(headers) => headers.filter((header) => header.offsetWidth && [...header.querySelectorAll("button")]
            .some(
            (button) => button.getBoundingClientRect().bottom > header.getBoundingClientRect().bottom)).length"""
        )
        == 0
    )

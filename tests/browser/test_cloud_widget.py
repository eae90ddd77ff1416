"""What a person sees and does with a cloud widget."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from .chromium import LOOKS, shoot
from .cloud import EMPTY, FEW, MANY, NOTHING, ROOM
from .laser import eventually
from .plain_page import PlainPage

LEFT, LEGEND, TOP, BELOW = 38, 68, 4, 20
"""Pixels around the picture of points, for its scales and its legend."""


def box_of(card: Locator) -> tuple[float, float, float, float]:
    """The middle of the picture of points, and its width and height, in pixels of the page."""
    picture = card.locator(".rw-picture").bounding_box()
    assert picture
    width, height = picture["width"] - LEFT - LEGEND, picture["height"] - TOP - BELOW
    return picture["x"] + LEFT + width / 2, picture["y"] + TOP + height / 2, width, height


def from_above(card: Locator, x: float, y: float, view_range: float) -> tuple[float, float]:
    """Where a place of the ground is, with the sensor in the middle."""
    middle_x, middle_y, width, height = box_of(card)
    scale = min(width, height) / 2 / view_range
    return middle_x - y * scale, middle_y - x * scale


def words(card: Locator, place: str) -> Locator:
    """The pop-up of the point that is kept, or under the pointer: its part of this name."""
    return card.locator(".rw-popup:visible .rw-popup-" + place)


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_clouds_are_readable_at_every_width(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([ROOM, MANY, FEW, EMPTY, NOTHING], scale=scale, theme=theme)
    for width in (320, 480, 1000):
        nb.resize(width)
        for i, name in enumerate(("room", "many", "few", "empty", "nothing")):
            card = nb.widget(i).locator(".rw-card")
            card.scroll_into_view_if_needed()
            shoot(card, f"cloud-{name}-{theme}-{width}")
            assert card.evaluate("card => card.scrollWidth <= card.clientWidth")
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-footer")).to_contain_text("960 not measured")
    for view in ("side", "behind", "rows"):
        card.locator("select").first.select_option(view)
        shoot(card, f"cloud-room-{view}-{theme}")
    footer = nb.widget(1).locator(".rw-footer")
    expect(footer).to_contain_text(re.compile(r"every 5th of 450.000 points drawn"))
    expect(nb.widget(3).locator(".rw-empty")).to_have_text("waiting for a cloud")
    expect(nb.widget(4).locator(".rw-empty")).to_have_text("none of its 100 points was measured")


@pytest.mark.core
def test_a_point_is_named_and_points_are_selected_by_a_box_and_a_band_also_while_a_cell_runs(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([ROOM, "clouds.view_range = 5.0", FEW, "few.view_range = 10.0"])
    nb.resize(760)
    nb.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    few = nb.widget(2).locator(".rw-card")
    few.scroll_into_view_if_needed()
    with nb.busy():
        nb.page.mouse.move(*from_above(few, 6.5, -2.0, 10.0))
        expect(words(few, "expression")).to_have_text("points[1]")
        expect(words(few, "distance")).to_have_text("6.81 m")
        expect(words(few, "details")).to_have_text("x 6.500  y −2.000  z 0.300\nspeed 0.25")
        nb.page.mouse.click(*from_above(few, 9.0, 0.5, 10.0))
        nb.page.mouse.move(0, 0)
        expect(words(few, "expression")).to_have_text("points[2]")
        few.locator(".rw-picture").focus()
        nb.page.keyboard.press("m")
        expect(few.locator(".rw-live")).to_contain_text("points[0], 4.12 m")

        few.get_by_role("button", name="Select points by a box").click()
        nb.page.mouse.move(*from_above(few, 10.0, 2.0, 10.0))
        nb.page.mouse.down()
        nb.page.mouse.move(*from_above(few, 6.0, -3.0, 10.0), steps=4)
        nb.page.mouse.up()
        expect(few.locator(".rw-cloud-count")).to_have_text("2 of 3 points")
        nb.page.keyboard.press("Escape")  # lets go of the point first
        nb.page.keyboard.press("c")
        code = "navigator.clipboard.readText()"
        unbounded = r"np\.isfinite\(z\)"
        x, y = r"\(x >= (6|5\.9\d*)\) & \(x <= (10|9\.9\d*)\)", r"\(y >= -3(\.0\d*)?\) & \(y <= (2|1\.9\d*)\)"
        eventually(lambda: bool(re.fullmatch(rf"points\[{x} & {y} & {unbounded}\]", nb.page.evaluate(code))), True)
        shoot(few, "cloud-box")
    # The code is that of Python, and gives these points.
    eventually(lambda: nb.python("print(few.code())").strip(), nb.page.evaluate(code))
    names = "x, y, z, points = few.cloud.x, few.cloud.y, few.cloud.z, few.cloud.points"
    assert nb.python(f"{names}\nprint(len({nb.page.evaluate(code)}), len(few.selected))") == "2 2\n"

    card = nb.widget(0).locator(".rw-card")
    card.scroll_into_view_if_needed()
    picture = card.locator(".rw-picture").bounding_box()
    assert picture
    right, top = picture["x"] + picture["width"] - LEGEND + 17, picture["y"] + TOP + 26
    nb.page.mouse.move(right, top + 60)
    nb.page.mouse.down()
    nb.page.mouse.move(right, top + 120, steps=4)
    nb.page.mouse.up()
    expect(card.locator(".rw-cloud-bands")).to_have_text(re.compile(r"^z 0\.4\d* to 1\.0\d* m$"))
    exact = nb.python("print(f'{len(clouds.selected):,}')").strip().replace(",", "\u202f")
    expect(card.locator(".rw-cloud-count")).to_have_text(f"{exact} of 28\u202f800 points")
    shoot(card, "cloud-band")
    card.locator("select").nth(1).select_option("ring")
    card.locator("select").first.select_option("rows")
    shoot(card, "cloud-rows-band")
    eventually(lambda: nb.python("print(clouds.view, clouds.color_by)"), "rows ring\n")
    card.get_by_role("button", name="Select nothing").click()
    expect(card.locator(".rw-cloud-chip")).to_be_hidden()
    eventually(lambda: nb.python("print(clouds.selection)"), "{}\n")


def test_a_thinned_cloud_counts_what_is_drawn_until_python_has_counted_all(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page(["import numpy as np\nfrom robowidgets import CloudWidget", MANY])
    card = nb.widget(1).locator(".rw-card")
    with nb.busy():
        card.locator(".rw-picture").scroll_into_view_if_needed()
        picture = card.locator(".rw-picture").bounding_box()
        assert picture
        right, top = picture["x"] + picture["width"] - LEGEND + 17, picture["y"] + TOP + 26
        nb.page.mouse.move(right, top + 80)
        nb.page.mouse.down()
        nb.page.mouse.move(right, top + 110, steps=2)
        nb.page.mouse.up()
        expect(card.locator(".rw-cloud-count")).to_have_text(re.compile(r"^\d+.\d{3} of 90.000 drawn points$"))
    expect(card.locator(".rw-cloud-count")).to_have_text(re.compile(r"^\d+.\d{3} of 450.000 points$"))
    shown = card.locator(".rw-cloud-count").inner_text().split(" of ")[0]
    assert int(nb.python("print(len(many.selected))")) == int(re.sub(r"\D", "", shown))


def test_it_freezes_steps_back_and_keeps_the_last_good_cloud_with_one_line(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([ROOM])
    card = nb.widget(0).locator(".rw-card")
    flush = "from robowidgets.widget.pacer import pacer"
    for i in range(3):
        nb.python(f"{flush}\nclouds.update([[{i + 1}.0, 0.0, 0.0]]); pacer.flush()")
        expect(card.locator(".rw-cloud-nearest")).to_contain_text(f"nearest {i + 1}.00 m")
    card.locator(".rw-freeze").click()
    card.locator(".rw-picture").focus()
    nb.page.keyboard.press(",")
    expect(card.locator(".rw-cloud-nearest")).to_contain_text("nearest 2.00 m")
    eventually(lambda: nb.python("print(clouds.frozen.x)"), "[2.]\n")
    nb.page.keyboard.press("Space")
    expect(card.locator(".rw-cloud-nearest")).to_contain_text("nearest 3.00 m")
    nb.python(
        "clouds._credit._is_busy, clouds._credit._is_beside = (lambda: True), False\nclouds.update([[3.0, 0, 0]])"
    )
    expect(card.locator(".rw-footer")).to_contain_text("fewer pictures while a cell runs")
    nb.python("clouds._credit._is_busy = lambda: False")
    nb.python("try: clouds.update([[1.0, 2.0]])\nexcept ValueError: pass")
    expect(card.locator(".rw-notice")).to_contain_text("points: expected numbers of shape (N, 3)")
    expect(card.locator(".rw-notice")).to_contain_text("Showing the last good cloud.")
    expect(card.locator(".rw-cloud-nearest")).to_contain_text("nearest 3.00 m")
    nb.python(
        "points = np.zeros(1, [('x', 'f4'), ('y', 'f4'), ('z', 'f4'), ('<b>a</b>', 'f4')])\n"
        "points['x'] = 2; clouds.update(points)"
    )
    card.locator(".rw-picture").focus()
    nb.page.keyboard.press("m")
    expect(words(card, "details")).to_contain_text("<b>a</b> 0")


ECHOES = """
from robowidgets import LaserWidget
echoes = LaserWidget(title="/glass", echo="last", pinned=1)
_rays = [{"echoes": [1.0, 4.5]}, {"echoes": [2.0, 2.2, 3.0]}, {"echoes": []}]
echoes.update(ranges=_rays, angle_min=-0.1, angle_increment=0.1, range_min=0.1, range_max=5.0)
echoes
"""
BAND = """
band = LaserWidget(title="/points", band=(0.1, 0.5), pinned=360)
band.update(few.cloud)
band
"""


def test_a_ray_names_the_echo_or_the_point_that_it_is(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([ECHOES, "import numpy as np\nfrom robowidgets import CloudWidget", FEW, BAND])
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-facts")).to_contain_text("3 rays ·\u00a0last echo")
    expect(words(card, "distance")).to_have_text("3.00 m")
    expect(words(card, "details")).to_contain_text("ranges[1].echoes[2]")
    shoot(card, "laser-echoes")
    nb.python("echoes.echo = 'first'")
    expect(words(card, "details")).to_contain_text("ranges[1].echoes[0]")
    expect(card.locator(".rw-facts")).to_contain_text("first echo")
    card = nb.widget(3).locator(".rw-card")
    nb.python("band.pinned = next(ray.index for ray in band.scan if ray.source == 1)")
    expect(words(card, "details")).to_contain_text("points[1]")
    expect(card.locator(".rw-facts")).to_contain_text("points from 0.1 m to 0.5 m high")
    shoot(card, "laser-band")


PLAYER = """
import robowidgets
recording = robowidgets.open({path!r})
player = recording.show("/sick_lms_1xx/scan", "/cloud", "/cloud as scan")
player
"""


def test_a_player_and_a_page_show_the_cloud_beside_its_scan(
    plain_page: Callable[..., PlainPage], static_page: Callable[[Path], Page], data: Path, tmp_path: Path
) -> None:
    """A SICK LMS1xx sends each scan as a cloud, too: all three tell the same nearest thing."""
    path = data / "topics" / "sick_laser_and_radar.bag"
    if not path.exists():
        pytest.skip("the recording is not there")
    nb = plain_page([PLAYER.format(path=str(path))])
    nb.resize(1280, 900)
    view = nb.output(0)
    cloud = view.locator(".rw-cloud")
    expect(cloud.locator(".rw-facts")).to_contain_text("541 points")
    expect(cloud.locator(".rw-cloud-nearest")).to_contain_text(re.compile(r"nearest 0\.0\d m"))
    expect(view.locator(".rw-laser")).to_have_count(2)
    shoot(view, "cloud-player")
    page_file = tmp_path / "page.html"
    nb.python(f"recording.to_html({str(page_file)!r}, topics=['/sick_lms_1xx/scan', '/cloud'], start=0.5, end=1.5)")
    card = static_page(page_file).locator(".rw-cloud")
    expect(card.locator(".rw-facts")).to_contain_text("541 points")
    card.locator(".rw-picture").focus()
    card.page.keyboard.press("m")
    expect(words(card, "expression")).to_have_text(re.compile(r"^points\[\d+\]$"))
    expect(words(card, "details")).to_contain_text("intensity")
    shoot(card, "cloud-page")

"""A recording in the notebook: its table, and its widgets with a slider through time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import expect

from .chromium import shoot
from .notebook import Notebook

TABLE = "import robowidgets\nrecording = robowidgets.open({path!r})\nrecording"


def to_time(nb: Notebook, seconds: str) -> None:
    """Type a time into the number beside the slider, as a person does."""
    readout = nb.output(1).locator(".widget-readout")
    readout.click()
    readout.fill(seconds)
    readout.press("Enter")


def test_a_person_moves_the_slider_and_every_widget_follows(notebook: Callable[..., Notebook], data: Path) -> None:
    nb = notebook([TABLE.format(path=str(data / "good" / "neato_fsm")), "player = recording.show()\nplayer"], scale=2)
    expect(nb.output(0).locator("table tbody tr")).to_have_count(10)
    expect(nb.output(1).locator(".rw-card")).to_have_count(4)
    tile = nb.output(1).locator(".rw-tile", has_text="left front")
    expect(tile).to_contain_text("free")
    to_time(nb, "22")
    expect(tile).to_contain_text("touched")
    assert nb.python("print(player.slider.value)").strip() == "22.0"
    to_time(nb, "20")
    expect(tile).to_contain_text("free")
    to_time(nb, "22.5")
    expect(tile).to_contain_text("touched")


def test_the_page_rounds_no_moment_away(notebook: Callable[..., Notebook], data: Path) -> None:
    nb = notebook([TABLE.format(path=str(data / "good" / "tilt_laser.bag")), "recording.show()"])
    expect(nb.output(1).locator(".widget-readout")).to_have_text("0.01")
    expect(nb.output(1).locator(".rw-card").first).to_contain_text("nearest 0.69 m at 4.3°")
    bump = "next(m.seconds for m in recording.samples('/bump') if any(m.sample.touched.values()))"
    nb = notebook(
        [TABLE.format(path=str(data / "good" / "neato_fsm")), f"player = recording.show()\nplayer.seek({bump})\nplayer"]
    )
    expect(nb.output(1).locator(".widget-readout")).to_have_text("21.97")
    expect(nb.output(1).locator(".rw-tile", has_text="left front")).to_contain_text("touched")


def test_it_plays_by_itself(notebook: Callable[..., Notebook], data: Path) -> None:
    nb = notebook(
        [TABLE.format(path=str(data / "good" / "turtlebot3_gazebo.bag")), "player = recording.show()\nplayer"]
    )
    nb.output(1).get_by_title("Play", exact=True).or_(nb.output(1).locator("button.jupyter-button").first).first.click()
    nb.page.wait_for_function("() => parseFloat(document.querySelector('.widget-readout').textContent) > 1.0")
    assert float(nb.python("print(player.slider.value)")) > 1.0


def test_it_fits_wide_and_narrow_pages(notebook: Callable[..., Notebook], data: Path) -> None:
    cells = [TABLE.format(path=str(data / "good" / "neato_fsm")), "recording.show()"]
    for theme in ("light", "dark"):
        nb = notebook(cells, scale=1, theme=theme)
        to_time(nb, "22")
        expect(nb.output(1).locator(".rw-tile", has_text="left front")).to_contain_text("touched")
        shoot(nb.output(0), f"recording-table-{theme}")
        for width in (1400, 700, 480):
            nb.page.set_viewport_size({"width": width, "height": 1400})
            shoot(nb.output(1), f"recording-show-{theme}-{width}")
            inside = nb.output(1).evaluate("element => element.scrollWidth <= element.clientWidth + 1")
            assert inside, f"at {width} px it is wider than its place"

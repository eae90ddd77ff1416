"""The pictures of widgets in a saved notebook, for readers without a kernel."""

from __future__ import annotations

import base64
import io
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Locator, expect

from .laser import eventually
from .notebook import Notebook
from .server import LabServer

MAX_BYTES = 60_000
KNOB = (37, 99, 235)
"""The colour of the knob of the bar."""
CELLS = [
    """
import numpy as np
from robowidgets import ImageWidget, LaserWidget, SpeedWidget
import robowidgets
laser = LaserWidget(title="/scan")
def see(distance):
    laser.update(ranges=distance + np.arange(360) % 40 / 100, angle_min=-3.14, angle_increment=0.0175, range_min=0.1,
                 range_max=5.0)
see(2.0)
laser
""",
    """
speed = SpeedWidget(title="/odom")
speed.update(linear=(0.4, 0, 0), angular=(0, 0, 0.2))
speed
""",
    "player = robowidgets.open(robowidgets.SAMPLE).show(scanogram=False)\nplayer",
    "see(1.0)",
    """
camera = ImageWidget(title="/camera")
camera.update(np.random.default_rng(1).integers(0, 255, (480, 640, 3), dtype=np.uint8))
camera
""",
]
SWITCH_SAVING_OF_STATE = (
    "() => window.jupyterapp.commands.execute('@jupyter-widgets/jupyterlab-manager:saveWidgetState')"
)
MARK = """(cards) => {
    for (const card of cards) card.dataset.marked = "";
    return cards.length;
}"""
PLACE = """(part) => {
    const { left, top } = part.getBoundingClientRect();
    const cards = [...part.closest(".rw-one-screen").querySelectorAll(".rw-card:not(.rw-topics)")];
    const corners = cards.map((card) => card.getBoundingClientRect());
    const from = (side) => Math.min(...corners.map((corner) => corner[side]));
    return [Math.round(left - from("left")), Math.round(top - from("top"))];
}"""
"""Return the place of a part of a screen in its picture."""
IS_BAR_OVER = """(path) => {
    path.scrollIntoView();
    const [bar, laser] = ["player", "laser"].map((name) => path.closest(".rw-one-screen").querySelector(`.rw-${name}`));
    return bar.getBoundingClientRect().top > laser.getBoundingClientRect().top;
}"""
REVERT = "() => window.jupyterapp.shell.currentWidget.context.revert()"
WITH_PICTURE = """([path, cell, before]) => {
    const [output] = window.driver.savedOutputs(path, cell);
    const isDrawn = Object.keys(output?.data ?? {}).some((type) => type.startsWith("image/"));
    return isDrawn && output.data["text/plain"] !== before && output;
}"""


def written(nb: Notebook, cell: int, before: str = "") -> dict[str, Any]:
    """The output of a cell with its picture, once it has other words than before, in the document that is saved."""
    handle = nb.page.wait_for_function(WITH_PICTURE, arg=[nb.path, cell, before], polling=100)
    output: dict[str, Any] = handle.json_value()
    return output


def words(output: dict[str, Any]) -> str:
    return str(output["data"]["text/plain"])


def saved(file: Path, cell: int) -> dict[str, Any]:
    """The data of the output of a cell in a file, or nothing while JupyterLab writes the file."""
    if not (text := file.read_text().rstrip()).endswith("}"):
        return {}
    (output,) = json.loads(text)["cells"][cell]["outputs"]
    return {kind: "".join(data) if isinstance(data, list) else data for kind, data in output["data"].items()}


def assert_shows(output: dict[str, Any], shown: Locator, part: str) -> None:
    """Assert that the picture of a screen shows a part of it as the page does."""
    seen = np.asarray(Image.open(io.BytesIO(shown.locator(part).screenshot())).convert("RGB")).astype(int)
    picture = Image.open(io.BytesIO(base64.b64decode(output["data"]["image/png"]))).convert("RGB")
    x, y = shown.locator(part).evaluate(PLACE)
    saved_part = np.asarray(picture.crop((x, y, x + seen.shape[1], y + seen.shape[0]))).astype(int)
    assert np.mean(abs(seen - saved_part).max(axis=-1) > 60) < 0.02
    blue_at = [np.nonzero(abs(pixels - KNOB).max(axis=-1) < 40)[1].mean() for pixels in (seen, saved_part)]
    assert blue_at[0] == pytest.approx(blue_at[1], abs=3)


def pin(nb: Notebook) -> None:
    """Pin a ray of the first laser: straight ahead."""
    picture = nb.widget(0).locator(".rw-picture")
    picture.focus()
    picture.press("ArrowRight")
    picture.press("Enter")
    expect(nb.widget(0).locator(".rw-popup").first).to_be_visible()


@pytest.mark.core
def test_a_saved_notebook_shows_the_last_pictures_without_scripts_and_the_widgets_stay(
    notebook: Any, tmp_path: Path
) -> None:
    nb: Notebook = notebook(CELLS[:4], run=False)
    for cell in range(3):
        nb.run(cell)
    first = written(nb, 0)
    assert re.search(r"/scan.* 360 rays.* nearest 2.00 m", words(first))
    size = first["metadata"]["image/png"]
    png = base64.b64decode(first["data"]["image/png"])
    assert len(png) <= MAX_BYTES
    assert Image.open(io.BytesIO(png)).width in (size["width"], 2 * size["width"])
    assert re.search(r"/odom.* linear m/s", words(written(nb, 1)))
    assert " / 58.00 s" in words(written(nb, 2))

    # A later cell changes the picture of the first; the views stay.
    count = nb.page.locator(".rw-card").evaluate_all(MARK)
    nb.run(3)
    second = written(nb, 0, before=words(first))
    assert "nearest 1.00 m" in words(second)

    # Saving takes what is on show.
    pin(nb)
    file = nb.save()
    third = written(nb, 0, before=words(second))
    assert "ranges[" in words(third)
    while saved(file, 0) != third["data"]:
        nb.drawn()
    assert "application/vnd.jupyter.widget-view+json" in third["data"]
    nb.page.wait_for_function("(path) => !window.driver.isDirty(path)", arg=nb.path)
    assert nb.page.locator(".rw-card[data-marked]").count() == count
    for part in (".rw-speed .rw-board", ".rw-player .rw-play-line"):
        assert_shows(written(nb, 2), nb.output(2), part)

    # JupyterLab saves no state of widgets unless its user wants it: an export then shows the pictures.
    content = json.loads(file.read_text())
    content["metadata"].pop("widgets", None)
    copy = tmp_path / "homework.ipynb"
    copy.write_text(json.dumps(content))
    subprocess.run([sys.executable, "-m", "nbconvert", "--to", "html", str(copy)], check=True, capture_output=True)
    html = copy.with_suffix(".html").read_text()
    for cell in range(3):
        assert f'src="data:image/png;base64,{saved(file, cell)["image/png"].strip()}' in html


@pytest.fixture
def stateless(notebook: Any) -> Iterator[Notebook]:
    """A laser and a player in a JupyterLab that saves no state of widgets, which is its default."""
    nb: Notebook = notebook([CELLS[0], CELLS[2]])
    nb.page.evaluate(SWITCH_SAVING_OF_STATE)
    yield nb
    nb.page.evaluate(SWITCH_SAVING_OF_STATE)


def test_a_notebook_without_the_state_of_its_widgets_shows_them_while_the_kernel_runs_and_then_their_pictures(
    stateless: Notebook, lab: LabServer
) -> None:
    nb = stateless
    written(nb, 1)
    nb.save()
    for cell in range(2):
        assert "application/vnd.jupyter.widget-view+json" in nb.outputs(cell)[0]["data"]
        kinds = saved(nb.lab.files / nb.path, cell)
        assert "application/vnd.jupyter.widget-view+json" not in kinds
        assert "image/png" in kinds
    # The page is loaded again, and the notebook is read again: the widgets are live.
    for distance, again in ((3.0, nb.reload), (1.0, lambda: nb.page.evaluate(REVERT))):
        again()
        nb.widget(1).locator(".rw-play").wait_for()
        nb.scroll_to(0)
        nb.python(f"see({distance})")
        expect(nb.widget(0).locator(".rw-laser")).to_contain_text(f"{distance:.2f} m")
    # The kernel has ended.
    nb.save()
    lab.end_sessions()
    nb.page.reload()
    nb.open()
    for cell in range(2):
        nb.scroll_to(cell)
        expect(nb.output(cell).locator("img")).to_be_visible()
        expect(nb.output(cell)).not_to_contain_text("Error")


def test_freezing_takes_a_picture_and_a_photograph_becomes_a_small_jpeg(notebook: Any) -> None:
    nb: Notebook = notebook([CELLS[0], CELLS[4]])
    before = words(written(nb, 0))
    photograph = written(nb, 1)["data"]
    assert "image/png" not in photograph
    assert len(base64.b64decode(photograph["image/jpeg"])) <= MAX_BYTES
    pin(nb)
    nb.widget(0).locator(".rw-freeze").click()
    assert "ranges[" in words(written(nb, 0, before=before))


def test_a_scrolled_narrow_player_has_its_bar_above_its_pictures(notebook: Any) -> None:
    nb: Notebook = notebook(["import robowidgets", CELLS[2]], width=700)
    before = words(written(nb, 1))
    path = nb.output(1).locator(".rw-path")
    eventually(lambda: path.evaluate(IS_BAR_OVER), True)
    nb.python("player.time = 30")
    expect(nb.output(1).locator(".rw-play-now")).to_have_text("30.00")
    nb.save()
    output = written(nb, 1, before=before)
    (kind,) = (kind for kind in output["data"] if kind.startswith("image/"))
    picture = Image.open(io.BytesIO(base64.b64decode(output["data"][kind]))).convert("RGB")
    top = np.asarray(picture).astype(int)[: 70 * picture.width // output["metadata"][kind]["width"]]
    assert (abs(top - KNOB).max(axis=-1) < 40).sum() > 20

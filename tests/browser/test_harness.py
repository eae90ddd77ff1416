"""The fixtures themselves, on a widget of a few lines: after each wait, the awaited state is reached."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from PIL import Image
from playwright.sync_api import expect

from .chromium import photograph
from .notebook import CellError, Notebook
from .plain_page import PlainPage

pytestmark = pytest.mark.xdist_group("lab")

COUNTER = '''
import anywidget, traitlets

class Counter(anywidget.AnyWidget):
    n = traitlets.Int(3).tag(sync=True)
    _esm = """
    export default {
      render({ model, el }) {
        const button = el.appendChild(document.createElement("button"));
        const show = () => { button.textContent = `n=${model.get("n")}`; };
        button.onclick = () => { model.set("n", model.get("n") + 1); model.save_changes(); };
        model.on("change:n", show);
        show();
        if (model.get("n") === 13) throw new Error("thirteen");
      },
    };
    """

counter = Counter()
'''


@pytest.fixture(params=["notebook", "plain_page"])
def either(request: pytest.FixtureRequest) -> Any:
    """Opens a notebook in JupyterLab, or its cells on a plain page: both behave alike."""
    return request.getfixturevalue(request.param)


def test_a_click_reaches_the_kernel_and_the_second_view_and_the_theme_switches_while_the_page_is_open(
    either: Callable[..., Notebook | PlainPage],
) -> None:
    nb = either([COUNTER, "display(counter)\ndisplay(counter)"], theme="dark")
    nb.widget(1).get_by_role("button").click()
    expect(nb.widget(1, 1)).to_have_text("n=4")
    assert nb.python("counter.n") == "4"
    colour = "() => getComputedStyle(document.body).getPropertyValue('--jp-layout-color0').trim()"
    dark = nb.page.evaluate(colour)
    nb.theme("light")
    assert (dark, nb.page.evaluate(colour)) == ("#111", "white")


def test_cells_run_again_after_a_kernel_restart(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([COUNTER, "counter.n = 21", "counter"])
    nb.restart_kernel()
    with pytest.raises(CellError, match="NameError: name 'counter' is not defined"):
        nb.run(2)
    nb.edit(1, "counter.n += 1")
    nb.run_all()
    expect(nb.widget(2)).to_have_text("n=4")


def test_a_busy_cell_is_seen_while_it_runs(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([COUNTER, "counter"])
    busy = nb.append("import time\ncounter.n = 30\nwhile True:\n    time.sleep(0.01)")
    nb.start(busy)
    expect(nb.widget(1)).to_have_text("n=30")
    nb.interrupt()
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(busy)


@pytest.mark.parametrize(("opens", "scale"), [("notebook", 1), ("plain_page", 1), ("plain_page", 2)])
def test_a_screenshot_has_the_width_and_the_scale_it_was_asked_for(
    request: pytest.FixtureRequest, opens: str, scale: int
) -> None:
    nb = request.getfixturevalue(opens)([COUNTER, "counter"], scale=scale)
    for width in (320, 1200):
        nb.resize(width)
        with Image.open(photograph(nb.widget(1), f"harness-{width}")) as picture:
            assert picture.width == width * scale


def test_an_error_in_a_widget_is_noticed(either: Callable[..., Notebook | PlainPage]) -> None:
    nb = either([COUNTER])
    with nb.page.expect_event("console", lambda message: "thirteen" in message.text):
        nb.run(nb.append("Counter(n=13)"))
    assert nb.console.errors
    nb.console.errors.clear()

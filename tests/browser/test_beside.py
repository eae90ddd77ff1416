"""The view of a robot next to the notebook, visible while the user writes code."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .chromium import PICTURES, shoot
from .notebook import Notebook
from .plain_page import PlainPage

ROBOT = """
from robowidgets import feeds
from robowidgets.behaviors import Drive
robot = feeds.simulator("turtlebot3", wander=False)
class Walker:
    near = lambda scan: scan.distance("front") < 0.5
    def forward(): return Drive(0.1)
    def turn(): return Drive(0, 0.5)
    moves = "forward -> turn on near", "turn -> forward after 1"
program = robot.program(Walker, rate=20)
"""
BESIDE = "view = robot.show(beside=True)\nview"
SHOW = "view = robot.show()\nview"


AGREES = """() => {
    const pane = document.querySelector(".rw-beside-pane");
    const { paddingLeft, paddingRight } = getComputedStyle(pane);
    const wide = pane.clientWidth - parseFloat(paddingLeft) - parseFloat(paddingRight);
    const view = pane.querySelector(".rw-feed").getBoundingClientRect();
    const notebook = document.querySelector(".jp-NotebookPanel:not(.lm-mod-hidden)").getBoundingClientRect();
    const { left, width, height } = pane.getBoundingClientRect();
    return Math.abs(view.width - wide) < 1 && pane.scrollWidth <= pane.clientWidth && left >= notebook.right
        && width > 300 && Math.abs(height - notebook.height) < 40;
}"""
"""Return True if the pane is right of the notebook, and its view is as wide as the pane."""
SHOWN = "Show this view beside the notebook"


BAR = """(bar) => [
    bar.offsetHeight,
    bar.querySelector(".rw-stop-words").offsetWidth,
    bar.closest(".rw-one-screen").querySelector(".rw-simulator").getBoundingClientRect().top
        - bar.getBoundingClientRect().top,
]"""


@pytest.fixture
def beside(notebook: Callable[..., Notebook]) -> Callable[..., Notebook]:
    """A notebook with a robot and this cell, all run, in JupyterLab's default mode, which is not simple mode."""

    def run(cell: str, **more: object) -> Notebook:
        nb = notebook([ROBOT, cell], run=False, **more)
        nb.page.evaluate("window.driver.showMany()")
        nb.run_all()
        return nb

    return run


def test_in_simple_mode_it_says_how_to_show_two_documents(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([ROBOT, BESIDE], width=1600, height=900)
    words = nb.output(1).locator(".rw-stop-beside")
    expect(words).to_contain_text("JupyterLab shows one document at a time: switch off Simple")
    expect(nb.page.locator(".rw-beside-pane")).to_have_count(0)


@pytest.mark.parametrize(("theme", "scale"), [("light", 1), ("dark", 2)] if PICTURES else [("dark", 1)])
def test_a_view_next_to_the_notebook_is_as_wide_as_its_pane_and_the_cell_has_stop(
    beside: Callable[..., Notebook], theme: str, scale: int
) -> None:
    nb = beside(BESIDE, width=1280, height=720, theme=theme, scale=scale)
    pane, output = nb.page.locator(".rw-beside-pane"), nb.output(1)
    for kind in ("laser", "simulator", "program", "machine"):
        expect(pane.locator(f".rw-{kind}")).to_be_visible()
    expect(output.locator(".rw-card")).to_have_count(1)
    expect(output.locator(".rw-stop-bar")).to_be_visible()
    shoot(nb.page.locator("#main"), f"beside-1280-{theme}")
    for width, height in ((1280, 720), (1000, 720), (2600, 1000)):
        nb.page.set_viewport_size({"width": width, "height": height})
        nb.page.wait_for_function(AGREES)
    # With two columns it has the height of the pane, too.
    nb.page.wait_for_function("""() => {
        const pane = document.querySelector(".rw-beside-pane");
        const { height } = pane.querySelector(".rw-feed").getBoundingClientRect();
        return Math.abs(height - (pane.clientHeight - 16)) < 2;
    }""")
    shoot(nb.page.locator("#main"), f"beside-2600-{theme}")

    pane.locator(".rw-stop-bar .rw-stop").click()
    expect(output.locator(".rw-stop-word")).to_have_text("Stopped")


def test_there_is_one_pane_when_the_cell_is_run_again_closed_reloaded_or_its_kernel_restarted(
    beside: Callable[..., Notebook],
) -> None:
    nb = beside(BESIDE, width=1600, height=900)
    pane, output = nb.page.locator(".rw-beside-pane"), nb.output(1)
    expect(pane.locator(".rw-machine")).to_be_visible()
    before = pane.get_attribute("data-view")
    nb.run(1)
    expect(pane).not_to_have_attribute("data-view", before or "")
    expect(pane.locator(".rw-laser")).to_be_visible()
    expect(pane).to_have_count(1)

    output.get_by_role("button", name="Close the view beside the notebook").click()
    expect(pane).to_have_count(0)
    output.get_by_role("button", name=SHOWN).click()
    expect(pane.locator(".rw-machine")).to_be_visible()
    nb.page.locator(".lm-TabBar-tab", has_text="robot").last.locator(".lm-TabBar-tabCloseIcon").click()
    expect(pane).to_have_count(0)
    output.get_by_role("button", name=SHOWN).click()
    expect(pane.locator(".rw-laser")).to_be_visible()

    nb.restart_kernel()
    expect(output.locator(".rw-beside-button")).to_be_hidden()
    nb.run_all()
    expect(pane).to_have_count(1)
    expect(pane.locator(".rw-machine-state[data-active='leaf']")).to_be_visible()
    nb.page.wait_for_function(AGREES)

    nb.reload()
    expect(pane.locator(".rw-machine-state[data-active='leaf']")).to_be_visible()
    expect(pane).to_have_count(1)
    nb.page.wait_for_function(AGREES)
    nb.python("view.close()")
    expect(pane).to_have_count(0)


def test_a_button_moves_the_view_of_a_cell_next_to_the_notebook_too(beside: Callable[..., Notebook]) -> None:
    nb = beside(SHOW, width=1600, height=900)
    pane, output = nb.page.locator(".rw-beside-pane"), nb.output(1)
    shoot(output, "beside-button")
    output.get_by_role("button", name=SHOWN).click()
    expect(pane.locator(".rw-machine")).to_be_visible()
    expect(pane.locator(".rw-beside-button")).to_be_hidden()
    expect(output.locator(".rw-laser")).to_be_visible()
    nb.page.wait_for_function(AGREES)
    pane.locator(".rw-freeze-all").click()
    expect(output.locator(".rw-freeze-all")).to_have_text("Frozen")
    expect(output.locator(".rw-laser.rw-frozen")).to_be_visible()
    output.locator(".rw-freeze-all").click()
    expect(pane.locator(".rw-freeze-all")).to_have_text("Freeze")
    nb.python("view.close()")
    expect(pane).to_have_count(0)


def test_with_all_its_buttons_the_bar_has_room_for_its_words_and_moves_nothing_when_the_robot_stops(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([ROBOT, SHOW])
    bar = nb.output(1).locator(".rw-stop-bar")
    expect(bar.locator(".rw-beside-button")).to_be_visible()
    for width in (376, 640, 848, 1000, 1280):
        nb.resize(width)
        nb.scroll_to(1)
        measured = []
        for stopped, words in ((False, "drives"), (True, "nobody")):
            nb.python(f"robot.stopped = {stopped}")
            expect(bar.locator(".rw-stop-text")).to_contain_text(words)
            height, words_width, simulator = bar.evaluate(BAR)
            measured.append((height, simulator))
            assert words_width >= 130, width
        assert measured[0] == measured[1], width
        if width > 800:
            assert measured[0][1] == 0, "the room from above stands next to the bar"


def test_on_a_page_without_such_a_place_the_bar_shows_what_to_do(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page(
        ["from robowidgets import feeds\nrobot = feeds.simulator()\nview = robot.show(beside=True)\nview._bar"]
    )
    bar = nb.widget(0)
    expect(bar.locator(".rw-stop-beside")).to_have_text(
        "This page has no place beside the notebook. robot.show() shows the view here."
    )
    expect(bar.locator(".rw-beside-button")).to_be_hidden()
    nb.python("robot.close()")

"""What a page keeps of views that are gone, while the kernel keeps their widgets."""

from __future__ import annotations

import time
from collections.abc import Callable

from .notebook import Notebook
from .page_memory import Kept, PageMemory

WARM_UP = 4
RUNS = 12
# JupyterLab and ipywidgets keep about 4 nodes and 30 kB per run of a cell that shows any widget.
NODES_PER_RUN = 15
BYTES_PER_RUN = 150_000
# The script and the stylesheet of these widgets have 25 kB to 110 kB.
BYTES_PER_CLOSED = 20_000
LISTENERS_PER_RUN = 40
PATIENCE_S = 10.0


def test_a_cell_that_runs_again_leaves_nothing_of_the_view_before_nor_a_closed_widget_its_script(
    notebook: Callable[..., Notebook],
) -> None:
    # `made` keeps every widget alive in Python, as IPython's history does.
    widgets = ("LaserWidget", "SpeedWidget", "TouchWidget", "DriveWidget")
    cells = [f"made.append(robowidgets.{widget}())\nmade[-1]" for widget in widgets]
    nb = notebook(["import robowidgets\nmade = []", *cells])
    memory = PageMemory(nb.page)
    for cell, widget in enumerate(widgets, 1):
        for _ in range(WARM_UP):
            nb.run(cell)
        nb.widget(cell)
        before = memory.kept()
        for _ in range(RUNS):
            nb.run(cell)
        nb.widget(cell)
        deadline = time.monotonic() + PATIENCE_S
        while not _is_little(before, after := memory.kept()) and time.monotonic() < deadline:
            nb.page.wait_for_timeout(200)
        assert _is_little(before, after), f"{RUNS} runs of a {widget} later {before} has become {after}"
        nb.python("for widget in made: widget.close()\nmade.clear()")
        while (closed := memory.kept()).heap - before.heap > RUNS * BYTES_PER_CLOSED and time.monotonic() < deadline:
            nb.page.wait_for_timeout(200)
        kept = (closed.heap - before.heap) / RUNS
        assert kept < BYTES_PER_CLOSED, f"each closed {widget} leaves {kept:.0f} bytes"


def _is_little(before: Kept, after: Kept) -> bool:
    return (
        after.detached_canvases <= 2
        and after.nodes - before.nodes < RUNS * NODES_PER_RUN
        and after.listeners - before.listeners < RUNS * LISTENERS_PER_RUN
        and after.heap - before.heap < RUNS * BYTES_PER_RUN
    )

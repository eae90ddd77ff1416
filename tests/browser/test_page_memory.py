"""Memory that a page keeps of closed views, while the kernel keeps their widgets."""

from __future__ import annotations

import time
from collections.abc import Callable

from .notebook import Notebook
from .page_memory import Kept, PageMemory

WARM_UP = 2
RUNS = 6
# JupyterLab and ipywidgets keep about 10 nodes, 35 listeners and 190 kB per run; scripts and stylesheets have 250 kB.
NODES_PER_RUN = 20
LISTENERS_PER_RUN = 50
BYTES_PER_RUN = 300_000
# Of closed widgets they keep 160 kB at most; all their scripts and stylesheets have 250 kB.
BYTES_PER_CLOSED_RUN = 220_000
PATIENCE_S = 60.0
HAS_PICTURE = """(path) =>
    Object.keys(window.driver.savedOutputs(path, 1)[0]?.data ?? {}).some((type) => type.startsWith("image/"))"""

# `made` keeps every widget alive in Python, as IPython's history does.
SHOW = """
for kind in robowidgets.LaserWidget, robowidgets.SpeedWidget, robowidgets.TouchWidget, robowidgets.DriveWidget:
    made.append(kind())
    display(made[-1])
"""
CLOSE = "for widget in made: widget.close()\nmade.clear()"


def test_a_cell_that_runs_again_leaves_nothing_of_the_views_before_nor_closed_widgets_their_scripts(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook(["import robowidgets\nmade = []", SHOW])
    memory = PageMemory(nb.page)

    def run(times: int) -> None:
        for _ in range(times):
            nb.run(1)
        nb.widget(1, 3)

    run(WARM_UP)
    # The parts of the page that are loaded after the first view have come.
    nb.page.wait_for_function(HAS_PICTURE, arg=nb.path)
    nb.python(CLOSE)
    without = memory.kept()
    run(WARM_UP)
    before = memory.kept()
    run(RUNS)
    deadline = time.monotonic() + PATIENCE_S
    while not _is_little(before, after := memory.kept()) and time.monotonic() < deadline:
        nb.page.wait_for_timeout(200)
    assert _is_little(before, after), f"{RUNS} runs later {before} has become {after}"
    nb.python(CLOSE)
    runs = WARM_UP + RUNS
    while (kept := memory.kept().heap - without.heap) > runs * BYTES_PER_CLOSED_RUN and time.monotonic() < deadline:
        nb.page.wait_for_timeout(200)
    assert kept < runs * BYTES_PER_CLOSED_RUN, f"the widgets of {runs} runs leave {kept} bytes once they are closed"


def _is_little(before: Kept, after: Kept) -> bool:
    return (
        after.detached_canvases <= 2
        and after.nodes - before.nodes < RUNS * NODES_PER_RUN
        and after.listeners - before.listeners < RUNS * LISTENERS_PER_RUN
        and after.heap - before.heap < RUNS * BYTES_PER_RUN
    )

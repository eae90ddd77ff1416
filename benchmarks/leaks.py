"""The memory that the page keeps of a widget after its cell ran again, with the widget open and closed."""

from __future__ import annotations

from dataclasses import dataclass

from tests.browser.page_memory import Kept, PageMemory

from .stage import Stage

LIMIT = "bare"
NAMES = {
    "bare": "bare canvas",
    "laser": "LaserWidget",
    "speed": "SpeedWidget",
    "touch": "TouchWidget",
    "drive": "DriveWidget",
    "player": "`show` of a recording: a player, a scanogram and three widgets",
}
WARM_UP = 4
# anywidget keeps a model during the two seconds that it may take to load.
SETTLE_MS = 2500


@dataclass(frozen=True)
class Leak:
    """The increase by each run of a cell."""

    nodes: float
    listeners: float
    kilobytes: float
    closed_kilobytes: float
    """The rest of it once every widget is closed."""


def compare(stage: Stage, runs: int) -> dict[str, Leak]:
    """Return the increase of the page by each run of a cell, by widget."""
    return {name: _measured(stage, name, runs) for name in NAMES}


def _measured(stage: Stage, name: str, runs: int) -> Leak:
    with stage.show(name, module="leaks_kernel") as shown:
        notebook = shown.notebook
        memory = PageMemory(notebook.page)
        cell = notebook.append("source.show()")

        def kept() -> Kept:
            notebook.page.wait_for_timeout(SETTLE_MS)
            return memory.kept()

        for _ in range(WARM_UP):
            notebook.run(cell)
        before = kept()
        for _ in range(runs):
            notebook.run(cell)
        after = kept()
        notebook.python("source.close()")
        closed = kept()
    return Leak(
        nodes=(after.nodes - before.nodes) / runs,
        listeners=(after.listeners - before.listeners) / runs,
        kilobytes=(after.heap - before.heap) / runs / 1000,
        closed_kilobytes=(closed.heap - before.heap) / runs / 1000,
    )

"""The reader of an error: in a real kernel, where a cell, its tasks, timers, threads and buttons all call."""

from __future__ import annotations

import os
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

SETUP = """
import asyncio, threading
from ipywidgets import Button
from robowidgets import LaserWidget

laser = LaserWidget(title="/scan")

def show(angle_min=0.0):
    laser.update(ranges=[1, 2, 3], angle_min=angle_min, angle_increment=0.1, range_min=0.1, range_max=9)

def refused():
    return laser.get_state()["_about"].get("error", "")
"""
CELLS = {
    "a cell": "show(float('nan'))",
    "a coroutine that a cell awaits": """
async def once():
    show(float('nan'))
await once()
""",
    "a task": """
async def feed():
    show(float('nan'))
    assert "angle_min: expected a finite number" in refused()
    show()
    return "lives on"
task = asyncio.create_task(feed())
assert await task == "lives on" and not refused()
""",
    "a timer": """
asyncio.get_running_loop().call_soon(show, float('nan'))
await asyncio.sleep(0.01)
assert refused()
""",
    "a button": """
button = Button()
button.on_click(lambda _: show(float('nan')))
asyncio.get_running_loop().call_soon(button.click)
await asyncio.sleep(0.01)
assert refused()
""",
    "a thread": """
thread = threading.Thread(target=show, args=(float('nan'),))
thread.start()
thread.join()
assert refused()
""",
    "a thread that asks whether a cell runs": """
from robowidgets.runtime.error_routing import cell_is_running
def ask():
    thread = threading.Thread(target=lambda: told.append(cell_is_running()))
    thread.start()
    thread.join()
told = []
ask()
asyncio.get_running_loop().call_soon(ask)
await asyncio.sleep(0.01)
assert told == [True, False]
""",
}
RAISES = ("a cell", "a coroutine that a cell awaits")
TEXT = "angle_min: expected a finite number of radians, got nan"


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Any]]:
    """The outcome of each cell."""
    home = tmp_path_factory.mktemp("kernel")
    own = {name: str(home) for name in ("JUPYTER_RUNTIME_DIR", "JUPYTER_DATA_DIR", "JUPYTER_CONFIG_DIR", "IPYTHONDIR")}
    cells = [nbformat.v4.new_code_cell(source) for source in (SETUP, *CELLS.values())]
    notebook = nbformat.v4.new_notebook(cells=cells)
    NotebookClient(notebook, timeout=240, kernel_name="python3", allow_errors=True).execute(env={**os.environ, **own})
    return dict(zip(CELLS, [cell.outputs for cell in cells[1:]], strict=True))


@pytest.mark.parametrize("caller", CELLS)
def test_an_error_is_raised_to_the_user_and_kept_from_a_callback(outputs: dict[str, list[Any]], caller: str) -> None:
    errors = [(output.ename, output.evalue) for output in outputs[caller] if output.output_type == "error"]
    assert errors == ([("ValueError", TEXT)] if caller in RAISES else [])


def test_of_all_callbacks_the_log_tells_the_same_error_once(outputs: dict[str, list[Any]]) -> None:
    written = [output.text for cell in outputs.values() for output in cell if output.output_type == "stream"]
    assert written == [f"LaserWidget /scan: a message could not be shown: {TEXT}\n"]

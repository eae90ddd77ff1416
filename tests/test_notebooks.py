"""Every notebook that the project ships: without outputs, readable as a lesson, and running without ROS."""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient
from traitlets.config import Config

from robowidgets import lessons
from robowidgets.driving.command_watchdog import Velocity
from robowidgets.lessons import _progress, _texts
from robowidgets.lessons._progress import read as read_progress

from .conftest import ROOT
from .patience import PATIENT
from .unit.waiting import wait_for

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
WIDGET = "application/vnd.jupyter.widget-view+json"
LONGEST_SECONDS = 600


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder in which the cells run, where lessons save the progress of a student."""
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    _progress.forget()
    _texts.speak("en")


named = pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)


def read(file: Path) -> Any:
    return nbformat.read(file, as_version=4)


def test_there_is_a_tour_and_a_notebook_per_widget() -> None:
    stems = {file.stem for file in NOTEBOOKS}
    assert stems >= {"tour", "laser_widget", "speed_widget", "touch_widget", "drive_widget", "recordings"}


@named
def test_a_notebook_is_kept_without_outputs(file: Path) -> None:
    notebook = read(file)
    nbformat.validate(notebook)
    assert "widgets" not in notebook.metadata
    for cell in notebook.cells:
        if cell.cell_type == "code":
            assert (cell.outputs, cell.execution_count) == ([], None), f"clear the outputs of {file.name}"


@named
def test_a_notebook_reads_as_a_lesson(file: Path) -> None:
    cells = read(file).cells
    assert cells[0].cell_type == "markdown"
    assert cells[0].source.startswith("# ")
    for before, cell in pairwise(cells):
        told = "markdown" in (before.cell_type, cell.cell_type)
        assert told, f"no words between two cells of {file.name}:\n{cell.source}"


@named
def test_a_notebook_whose_cells_were_all_run_at_once_shows_robots_that_still_move(file: Path) -> None:
    closing = [cell.source for cell in read(file).cells if cell.cell_type == "code" and ".close()" in cell.source]
    assert closing == []


@named
def test_a_notebook_runs_from_top_to_bottom(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("JUPYTER_RUNTIME_DIR", "JUPYTER_DATA_DIR", "JUPYTER_CONFIG_DIR", "IPYTHONDIR"):
        monkeypatch.setenv(name, str(tmp_path / name.lower()))
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    startup = tmp_path / "ipythondir" / "profile_default" / "startup" / "patience.py"
    startup.parent.mkdir(parents=True)
    startup.write_text(PATIENT)
    notebook = read(file)
    (tmp_path / "work").mkdir()
    # A port that is free when the client chooses it may be taken when the kernel starts, which would then hang.
    own = {"transport": "ipc", "connection_file": str(tmp_path / "kernel.json")}
    client = NotebookClient(
        notebook,
        config=Config(KernelManager=own),
        timeout=LONGEST_SECONDS,
        startup_timeout=LONGEST_SECONDS,
        iopub_timeout=LONGEST_SECONDS,
        kernel_name="python3",
        resources={"metadata": {"path": tmp_path / "work"}},
    )
    client.execute(env=dict(os.environ))
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert [output.text for output in outputs if output.get("name") == "stderr"] == []
    assert [output for output in outputs if WIDGET in output.get("data", {})], f"{file.name} shows no widget"


LESSON = ROOT / "notebooks" / "from_picture_to_code.ipynb"
TASKS = {cell.id: cell.source for cell in read(LESSON).cells if re.fullmatch(r"(task|solution)-\d", cell.id)}
FOLDED = re.compile(r"<details><summary>Solution</summary>\n\n```python\n(.*)```\n\n</details>", re.DOTALL)


@pytest.mark.parametrize("number", range(1, 6))
def test_a_task_of_the_lesson_is_wrong_as_it_stands_and_right_with_its_solution(number: int) -> None:
    task = TASKS[f"task-{number}"]
    folded = FOLDED.fullmatch(TASKS[f"solution-{number}"])
    assert folded
    function, check, result = re.split(r"\n(?=result)", task)
    assert result == "result"
    for answer, is_right in ((function, False), (folded[1], True)):
        names: dict[str, Any] = {"lessons": lessons}
        exec(f"{answer}\n{check}", names)
        assert bool(names["result"]) is is_right, names["result"]


def test_the_lesson_on_programs_runs_to_its_end_with_each_task_wrong_as_it_stands_and_right_with_its_solution(
    folder: Path,
) -> None:
    cells = read(ROOT / "notebooks" / "from_code_to_behavior.ipynb").cells
    sources = {cell.id: cell.source for cell in cells}
    names: dict[str, Any] = {}
    tasks, robots = 0, []
    try:
        for cell in cells:
            if cell.cell_type == "code":
                exec(cell.source, names)
                robots += [names["robot"]] if "robot" in names else []
            if re.fullmatch(r"task-\d", cell.id):
                tasks += 1
                assert not names["result"], f"{cell.id} is right as it stands"
                folded = FOLDED.fullmatch(sources[cell.id.replace("task", "solution")])
                assert folded
                exec(folded[1] + cell.source[cell.source.index("\nresult = ") :], names)
                assert names["result"], names["result"]
    finally:
        for robot in robots:
            robot.close()
    assert tasks == 7
    # Python has no source text of a cell run by `exec`, so unchanged answers count as attempts, too.
    kept = read_progress(folder / _progress.FILE)
    assert [task for task in kept if kept[task].done] == list(_progress.TASKS[5:])


def test_the_lesson_on_robots_has_a_program_drive_one_and_shows_its_speeds_on_a_recording() -> None:
    names: dict[str, Any] = {}
    for cell in read(ROOT / "notebooks" / "from_behavior_to_robot.ipynb").cells:
        if cell.cell_type != "code":
            continue
        exec(cell.source, names)
        if cell.id == "robot-05":
            for robot in (names["robot"], names["second"]):
                wait_for(lambda robot=robot: robot.robot.speed().linear[0] > 0.1, "the robot drives")
    try:
        replay = names["replay"]
        view = replay.show()
        wait_for(lambda: {"/odom", "/follow"} <= set(view.widgets), "the program's speed has a widget, too")
        measured, driven = view.widgets["/odom"], view.widgets["/follow"]
        wait_for(lambda: measured.speed and driven.speed, "both speeds are shown")
        assert driven.speed.linear[0] in (0.0, pytest.approx(0.2))
    finally:
        for name in ("robot", "second", "replay", "recording"):
            names[name].close()


def test_the_lesson_of_the_pad_stands_when_its_first_cell_is_run_again() -> None:
    cells = read(ROOT / "notebooks" / "drive_widget.ipynb").cells
    first, second, *_ = [cell.source for cell in cells if cell.cell_type == "code"]
    names: dict[str, Any] = {}
    for source in (first, second, first):
        exec(source, names)
    try:
        wait_for(lambda: sum("(live)" in thread.name for thread in threading.enumerate()) == 1, "one thread is left")
        names["pad"]._watchdog.drive(Velocity(0.3))
        wait_for(lambda: names["robot"].pose[:2] != (5.0, 0.4), "the new robot moves")
    finally:
        names["running"] = False
        names["pad"].close()

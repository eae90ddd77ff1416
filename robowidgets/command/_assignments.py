"""The lessons as assignments for nbgrader: without solutions, and with a cell per answer that checks it for a point."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from . import _notebooks

WITH_TASKS = ("from_picture_to_code", "from_code_to_behavior")

_CHECK = re.compile(r"\n\n\nresult = (lessons\.check\(.*\))\nresult$")


def write_assignments(folder: Path, language: str) -> list[str]:
    """Write the lessons with tasks into the folder of a course. Return a line about each, for the user.

    Existing sources stay unchanged.
    """
    lines = []
    for name in WITH_TASKS:
        file = folder / "source" / name / f"{name}.ipynb"
        if file.exists():
            lines.append(f"{file} exists and stays unchanged")
            continue
        lesson = json.loads(_notebooks.shipped_in(f"{name}.ipynb", language).read_text(encoding="utf-8"))
        made = assignment(lesson)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(made, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        points = sum("nbgrader" in cell["metadata"] for cell in made["cells"])
        lines.append(f"{file}: {points} tasks, a point each")
    return lines


def assignment(lesson: Mapping[str, Any]) -> dict[str, Any]:
    """Return a lesson as the source of an assignment."""
    return {**lesson, "cells": [made for cell in lesson["cells"] for made in _cells(cell)]}


def _cells(cell: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    if cell["id"].startswith("solution-"):
        return
    text = "".join(cell["source"])
    check = _CHECK.search(text)
    if check is None:
        yield cell
        return
    # An ordinary cell: nbgrader would clear its own answer cells, with the code that the student has to change.
    yield {**cell, "source": text[: check.start()].splitlines(keepends=True)}
    name = cell["id"].replace("task", "check")
    graded = {"grade": True, "grade_id": name, "locked": True, "points": 1, "schema_version": 3, "solution": False}
    yield {
        **cell,
        "id": name,
        "metadata": {"deletable": False, "editable": False, "nbgrader": {**graded, "task": False}},
        "source": [f"result = {check[1]}\n", "assert result, result"],
    }

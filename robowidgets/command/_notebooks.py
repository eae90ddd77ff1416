"""The notebooks of the package, and a generated notebook for a recording."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from itertools import chain, count
from pathlib import Path
from typing import Any

from ..files.remote import file_name, is_url, named
from ..lessons import ENGLISH

_PACKAGE = Path(__file__).parents[1]
TOUR = "tour.ipynb"
LESSON = "from_picture_to_code.ipynb"
FOLDER = "robowidgets-notebooks"
LESSONS_FOLDER = "robowidgets-lessons"
_SPEAKS = re.compile(r'\blessons\.progress\((?:\\"(\w+)\\")?\)')
"""The line of a lesson that sets its language, in JSON."""


def shipped() -> Path:
    """Return the folder of the notebooks: inside the installed package, or next to the package in a checkout.

    Raises:
        FileNotFoundError: neither folder exists.
    """
    for folder in (_PACKAGE / "notebooks", _PACKAGE.parent / "notebooks"):
        if (folder / TOUR).is_file():
            return folder
    raise FileNotFoundError("robowidgets was installed without its notebooks; install it again")


def shipped_in(name: str, language: str) -> Path:
    """Return the file of a notebook of the package in a language, or in English if it is not translated."""
    there = shipped() / language / name
    return there if there.exists() else shipped() / name


def copy_shipped(folder: Path, first: str = TOUR, language: str = ENGLISH) -> Path:
    """Copy the notebooks of the package to a folder, and return the first one. Existing notebooks stay unchanged.

    Args:
        folder: the folder.
        first: the name of the notebook to return.
        language: the language of the lessons; the other notebooks are in English.
    """
    for notebook in shipped().glob("*.ipynb"):
        if not (folder / notebook.name).exists():
            shutil.copyfile(shipped_in(notebook.name, language), folder / notebook.name)
    return folder / first


def in_others(folder: Path, language: str) -> Iterator[tuple[Path, str]]:
    """Yield the lessons in a folder that are in another language than this, each with its language."""
    for shipped_one in sorted(shipped().glob("*.ipynb")):
        notebook = folder / shipped_one.name
        found = _SPEAKS.search(notebook.read_text(encoding="utf-8", errors="replace")) if notebook.is_file() else None
        if found and (found[1] or ENGLISH) != language:
            yield notebook, found[1] or ENGLISH


def write_for(recording: Path | str, folder: Path) -> Path:
    """Write a notebook that shows a recording to a folder, unless the folder has one, and return its file."""
    shown = named(str(recording)) if is_url(recording) else str(recording)
    stem = Path(file_name(shown) if is_url(shown) else shown).stem
    name = re.sub(r"[^\w-]+", "-", stem, flags=re.ASCII).strip("-") or "recording"
    opened = f"recording = robowidgets.open({shown!r})"
    cells = [
        _cell("markdown", "look", "# A recording\n\nOne widget per topic it knows how to show, and a player:"),
        _cell("code", "show", f"import robowidgets\n\n{opened}\nrecording.show()"),
        _cell("markdown", "topics", "All its topics:"),
        _cell("code", "table", "recording"),
    ]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    names = (f"{name}{number}.ipynb" for number in chain([""], (f"-{n}" for n in count(2))))
    file = next(file for file in map(folder.joinpath, names) if not file.exists() or _opens(file, opened))
    if not file.exists():
        file.write_text(json.dumps(notebook, indent=1), encoding="utf-8")
    return file


def _opens(file: Path, opened: str) -> bool:
    """Return True if a notebook contains this line of code."""
    return json.dumps(opened)[1:-1] in file.read_text(encoding="utf-8", errors="replace")


def _cell(kind: str, cell_id: str, source: str) -> dict[str, Any]:
    of_code: dict[str, Any] = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "id": cell_id, "metadata": {}, "source": source, **of_code}

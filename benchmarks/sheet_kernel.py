"""The code in the kernel: a contact sheet of a number of hits in ten recordings."""

from __future__ import annotations

import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from shutil import copy
from typing import Any

from IPython.display import display

import robowidgets
from robowidgets import conditions
from robowidgets.fleet import Hits

FILES = 10


class Source:
    """A search that is done before, so that only the sheet is measured.

    Args:
        _name: the name of the measurement.
        count: the number of hits.
    """

    def __init__(self, _name: str, count: int) -> None:
        self._folder = tempfile.TemporaryDirectory()
        for number in range(FILES):
            copy(robowidgets.SAMPLE, Path(self._folder.name) / f"drive_{number:04}.mcap")
        near = conditions.nearest_below(0.5)
        with ThreadPoolExecutor(1) as here:
            found = robowidgets.find(near, self._folder.name, executor=here, keep=False)
        often = -(-count // len(found))
        some = [hit for hit in found for _ in range(often)][:count]
        self._hits = Hits(near, some, files=found.files, chosen={}, problems={})
        self.sheet: Any = None

    def show(self) -> None:
        """Show the sheet."""
        self.sheet = self._hits.show()
        display(self.sheet)  # type: ignore[no-untyped-call]

"""A notebook open in JupyterLab, and the actions of its user."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from playwright.sync_api import Locator, Page

from .console import Console
from .server import LabServer

CELL_SECONDS = 120
_COLOURS = re.compile(r"\x1b\[[0-9;]*m")


def notebook_of(cells: Sequence[str]) -> str:
    """The file of a notebook with these code cells, without `nbformat`, which takes two seconds to import."""
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    code: dict[str, Any] = {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": []}
    content = {
        "cells": [{**code, "id": f"cell-{i}", "source": source} for i, source in enumerate(cells)],
        "metadata": {"kernelspec": kernel},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(content)


class CellError(AssertionError):
    """Code in the kernel raised; the text is its traceback."""


class Notebook:
    """A notebook in a page of its own. A cell's index counts from 0; a negative one counts from the end.

    Everything waits until what it says has come about. `page` is Playwright's, for mouse, keys and the rest.
    """

    def __init__(self, page: Page, lab: LabServer, path: str, console: Console) -> None:
        self.page = page
        self.lab = lab
        self.path = path
        self.console = console

    def open(self) -> None:
        """Go to the notebook, and wait until it is on show with a kernel at its service.

        A page that has loaded JupyterLab opens the notebook in it, which takes a third of the time.
        """
        if self.page.evaluate("window.driver?.isLoaded()"):
            self._ask("open", self.path)
        else:
            self.page.goto(f"{self.lab.url}/doc/tree/{self.path}?token={self.lab.token}", wait_until="commit")
        self._until("ready", self.path)

    # Cells

    def run(self, index: int) -> str:
        """Run a cell to its end and return its text output.

        Raises:
            CellError: it raised.
        """
        self.start(index)
        return self.wait(index)

    def start(self, index: int) -> None:
        """Run a cell, and come back once the kernel is at work on it (or is done with it already)."""
        self._ask("start", self.path, index)
        self._until("started", self.path, index)

    def wait(self, index: int) -> str:
        """Wait until a started cell has ended, and return its text output. Raises as `run` does."""
        self._until("ended", self.path, index)
        for output in self.outputs(index):
            if output["output_type"] == "error":
                raise CellError(_plain(output["traceback"]))
        return self.text(index)

    @property
    def kinds(self) -> list[str]:
        """The type of each cell, such as ``code``."""
        kinds: list[str] = self._ask("cells", self.path)
        return kinds

    def run_all(self) -> None:
        """Run the code cells from top to bottom. Raises as `run` does, at the first that raises."""
        for index, kind in enumerate(self.kinds):
            if kind == "code":
                self.run(index)

    def run_all_at_once(self) -> None:
        """Run all cells as the menu does, which brings only the last one into view. Raises no error."""
        self._ask("runAll")

    def append(self, source: str) -> int:
        """Add a code cell at the end, without running it, and return its index."""
        return int(self._ask("append", self.path, source))

    def edit(self, index: int, source: str) -> None:
        """Put another source into a cell, without running it."""
        self._ask("edit", self.path, index, source)

    def outputs(self, index: int) -> list[dict[str, Any]]:
        """A cell's outputs, as the notebook file will hold them."""
        outputs: list[dict[str, Any]] = self._ask("outputs", self.path, index)
        return outputs

    def text(self, index: int) -> str:
        """Return the printed text of a cell, and the plain text of its displayed results."""
        parts = []
        for output in self.outputs(index):
            text = output.get("text", "") or output.get("data", {}).get("text/plain", "")
            parts.append(text if isinstance(text, str) else "".join(text))
        return "".join(parts)

    # Elements on show

    def output(self, index: int) -> Locator:
        """The output area of a cell."""
        return self.page.locator(f'[data-cell="{self._ask("mark", self.path, index)}"] .jp-Cell-outputArea')

    def widget(self, index: int, nth: int = 0) -> Locator:
        """The element of the nth widget that a cell displays, once it is visible."""
        found = self.output(index).locator(".jp-OutputArea-output.lm-Panel > .lm-Widget").nth(nth)
        found.wait_for()
        return found

    def scroll_to(self, index: int) -> None:
        """Bring a cell into view, and wait until its output is rendered."""
        self._until("scrollTo", self.path, index, polling=200)

    def scroll_away(self, index: int) -> None:
        """Go to the last cell, and wait until the output of this one is not rendered any more."""
        self._until("scrollAway", self.path, index, polling=200)

    def windowing(self, mode: str) -> None:
        """Keep cells out of sight as JupyterLab does with this value of its setting "Windowing mode"."""
        self._ask("setWindowing", self.path, mode)

    def drawn(self) -> None:
        """Wait until everything requested is drawn."""
        wait_for_drawing(self.page)

    def theme(self, name: Literal["light", "dark"]) -> None:
        """Switch JupyterLab's theme, as its Settings menu does, and wait until it is on."""
        theme = f"JupyterLab {name.capitalize()}"
        self._ask("theme", theme)
        self.page.wait_for_function("(theme) => window.driver.hasTheme(theme)", arg=theme)

    def resize(self, width: int, height: int = 900) -> None:
        """Size the window such that what a cell displays has `width` CSS pixels."""
        margin = 200.0
        for _ in range(5):  # JupyterLab's margins themselves depend on the window's width
            window = round(width + margin)
            self.page.set_viewport_size({"width": window, "height": height})
            got = self._ask("outputWidth", self.path)
            if got == width:
                return
            margin = window - got
        raise AssertionError(f"no window makes the output {width} px wide: at {window} px it is {got} px")

    # The kernel

    def python(self, code: str) -> str:
        """Run code in the kernel, outside of the cells, and return its printed text, or the text of its result.

        Raises:
            CellError: it raised.
        """
        answer = self._ask("python", self.path, code)
        if answer["traceback"] is not None:
            raise CellError(_plain(answer["traceback"]))
        return str(answer["text"])

    def interrupt(self) -> None:
        """Interrupt the kernel; `wait` then raises the cell's KeyboardInterrupt."""
        self._ask("interrupt", self.path)

    def restart_kernel(self) -> None:
        """Restart the kernel, and wait until the new one is there."""
        self._ask("restart", self.path)
        self._until("ready", self.path)

    def reconnect(self) -> None:
        """Reconnect to the kernel, as after a lost connection, and wait until the widgets match its state."""
        self._ask("reconnect", self.path)

    def reload(self) -> None:
        """Save the notebook and reload the page; the kernel lives on."""
        self.save()
        self.page.reload(wait_until="commit")
        self._until("ready", self.path)

    def save(self) -> Path:
        """Save the notebook and return its file, in which JupyterLab keeps the outputs and the widgets' state."""
        self._ask("save", self.path)
        return self.lab.files / self.path

    def _ask(self, name: str, *arguments: Any) -> Any:
        return self.page.evaluate("([name, ...rest]) => window.driver[name](...rest)", [name, *arguments])

    def _until(self, name: str, *arguments: Any, polling: int = 50) -> None:
        self.page.wait_for_function(
            "([name, ...rest]) => window.driver[name](...rest)",
            arg=[name, *arguments],
            timeout=CELL_SECONDS * 1000,
            polling=polling,  # not at each frame, which would make JupyterLab draw while nothing changes
        )


def wait_for_drawing(page: Page) -> None:
    """Wait until everything requested is drawn; a card may have to wait for others for several frames.

    A page in a file has no driver: there two frames have to do.
    """
    two_frames = "new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))"
    page.evaluate(f"() => window.driver?.drawn() ?? {two_frames}")


def _plain(traceback: list[str]) -> str:
    return _COLOURS.sub("", "\n".join(traceback))

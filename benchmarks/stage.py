"""A JupyterLab, a Chromium, and for each measurement a fresh notebook with a fresh kernel in a fresh page."""

from __future__ import annotations

import importlib.metadata
import json
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import sync_playwright

from tests.browser import chromium
from tests.browser.conftest import DRIVER
from tests.browser.console import Console
from tests.browser.notebook import Notebook
from tests.browser.server import LabServer

from .scan import BITS

ROOT = Path(__file__).resolve().parents[1]
PAGE = Path(__file__).with_name("page.js")
LONGEST_RUN = 120.0
VIEW = ".jp-OutputArea-output.lm-Panel > .lm-Widget"


@dataclass
class Run:
    """The results of one run. Times are milliseconds since the epoch, by the clock of the machine."""

    seconds: float
    cpu: float
    """Seconds of CPU of all threads of the kernel's process."""
    first: int
    """The number of the first scan."""
    stamps: NDArray[np.float64]
    """The time of each `update`."""
    painted: NDArray[np.float64]
    """Rows of time, view and number."""
    messages: NDArray[np.float64]
    """Rows of time and bytes."""
    unread: int
    """The number of frames without a readable number."""
    newest_shown: bool
    complaint: bool
    """True if the server printed something, such as "IOPub message rate exceeded"."""

    @property
    def latencies(self) -> NDArray[np.float64]:
        """Milliseconds from `update` to paint, for each painted scan."""
        sent = self.stamps[self.painted[:, 2].astype(int) - self.first]
        return np.asarray(self.painted[:, 0] - sent)


class Show:
    """Widgets in a notebook. The page reads back their numbers after every frame."""

    def __init__(self, notebook: Notebook, svg: str | None) -> None:
        self.notebook = notebook
        self._page = notebook.page
        self._metrics = self._page.context.new_cdp_session(self._page)
        self._svg = svg
        self._folder = notebook.lab.files

    def first_paint(self, view: str = VIEW) -> float:
        """Display the widgets. Return milliseconds until dots are visible in the elements of a selector."""
        cell = self.notebook.append("source.show()")
        return float(
            self._page.evaluate(
                "([path, cell, view, svg]) => bench.firstPaint(() => driver.start(path, cell), view, svg)",
                [self.notebook.path, cell, view, self._svg],
            )
        )

    def page_cpu(self) -> float:
        """Return the milliseconds of CPU of the page's main thread, without other work on the machine."""
        self._metrics.send("Performance.enable", {"timeDomain": "threadTicks"})
        told = self._metrics.send("Performance.getMetrics")["metrics"]
        return 1000 * float(next(metric["value"] for metric in told if metric["name"] == "TaskDuration"))

    def learn(self) -> None:
        """Learn the places of the dots of every bit, and follow them from now on."""
        self._page.evaluate("bench.learn(null)")
        for bit in range(BITS):
            self.notebook.python(f"source.put({1 << bit})")
            self._page.evaluate("(bit) => bench.learn(bit)", bit)
        self._page.evaluate("bench.follow()")

    def run(self, call: str, patience: float = 0.0) -> Run:
        """Run a method of the source in a cell. Return the records of the kernel and the page.

        Args:
            call: such as "pace(40, 3)".
            patience: seconds to wait after the run until the newest scan is shown.
        """
        self.start(call)
        return self.finish(patience)

    def start(self, call: str) -> None:
        """Start a method of the source in a cell, and return at once."""
        for file in self._folder.glob("facts-*.json"):
            file.unlink()
        self._page.evaluate("bench.take()")
        self._cell = self.notebook.append(f"source.{call}")
        self._page.evaluate("([path, cell]) => driver.start(path, cell)", [self.notebook.path, self._cell])

    def finish(self, patience: float = 0.0) -> Run:
        """Wait until the started run has ended, and until its newest scan is shown or ``patience`` is over."""
        deadline = time.monotonic() + LONGEST_RUN
        while not (files := list(self._folder.glob("facts-*.json"))):
            if time.monotonic() > deadline:
                raise RuntimeError(f"the run never ended; its cell says {self.notebook.outputs(self._cell)}")
            self._page.wait_for_timeout(50)
        facts = json.loads(files[0].read_text())
        stamps = (facts["epoch"] + np.load(self._folder / "stamps.npy").astype(np.int64)) / 1000
        shown = self._page.evaluate("([n, ms]) => bench.comes(n, ms)", [facts["last"], 1000 * patience])
        page = self._page.evaluate("bench.take()")
        if not -1 <= page["clockOff"] <= 2:
            raise RuntimeError(f"the clock was set during the run: the page is off by {page['clockOff']} ms")
        said = [output["name"] for output in self.notebook.outputs(self._cell) if output["output_type"] == "stream"]
        return Run(
            seconds=facts["seconds"],
            cpu=facts["cpu"],
            first=facts["first"],
            stamps=stamps,
            painted=np.array([p for p in page["painted"] if facts["first"] <= p[2] <= facts["last"]]).reshape(-1, 3),
            messages=np.array(page["messages"]).reshape(-1, 2),
            unread=page["unread"],
            newest_shown=shown,
            complaint=bool(said),
        )


class Stage:
    """A browser for all shows. All pages share its profile, so that all but the first page use its cache."""

    def __init__(self, lab: LabServer, browser: Any) -> None:
        self.lab = lab
        self.chromium = browser.version
        self._context = browser.new_context(viewport={"width": 1200, "height": 1000})
        self._context.add_init_script(path=DRIVER)
        self._context.add_init_script(path=PAGE)
        self._opened = 0

    @contextmanager
    def show(self, rival: str, svg: str | None = None, count: int = 1, module: str = "kernel") -> Iterator[Show]:
        """Yield a fresh notebook with a kernel that has imported the library. The kernel ends with the block."""
        self._opened += 1
        path = f"{rival}-{self._opened}.ipynb"
        kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
        code = f"from benchmarks.{module} import Source\nsource = Source({rival!r}, {count})"
        import nbformat  # takes two seconds in each process that collects tests

        cell = nbformat.v4.new_code_cell(code)
        nbformat.write(nbformat.v4.new_notebook(cells=[cell], metadata={"kernelspec": kernel}), self.lab.files / path)
        page = self._context.new_page()
        console = Console(page)
        notebook = Notebook(page, self.lab, path, console)
        try:
            notebook.open()
            notebook.run(0)
            yield Show(notebook, svg)
            for line in console.errors:
                print(f"  {rival} complained: {line}")
        finally:
            page.close()
            self.lab.end_sessions()

    @contextmanager
    def open_file(self, file: Path, script: str) -> Iterator[Any]:
        """Yield a page with a file from disk. A script runs in it before all others."""
        page = self._context.new_page()
        page.add_init_script(script)
        try:
            page.goto(file.as_uri())
            yield page
        finally:
            page.close()


@contextmanager
def open_stage() -> Iterator[Stage]:
    """Start the server and the browser, and end them with the block."""
    os.environ["PYTHONPATH"] = str(ROOT)  # the kernels import `benchmarks`
    with ExitStack() as stack:
        home = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        lab = LabServer(home)
        stack.callback(lab.stop)
        browser = chromium.launch(stack.enter_context(sync_playwright()))
        stack.callback(browser.close)
        yield Stage(lab, browser)


def versions() -> dict[str, str]:
    """Return the versions of the measured software."""
    names = (
        "jupyterlab",
        "ipykernel",
        "ipywidgets",
        "anywidget",
        "ipympl",
        "matplotlib",
        "plotly",
        "bqplot",
        "bqplot-gl",
    )
    return {name: importlib.metadata.version(name) for name in names}

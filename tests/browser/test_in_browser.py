"""robowidgets where Python itself is in the browser: on a page with Pyodide, and in JupyterLite as on the site.

NumPy for the browser is in no registry. What needs it is skipped, unless ROBOWIDGETS_PYODIDE_NUMPY names its file.
"""

from __future__ import annotations

import functools
import hashlib
import http.server
import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from .. import stack_cases
from ..conftest import ROOT
from .console import Console
from .notebook import notebook_of

PYODIDE = Path(__file__).with_name("node_modules") / "pyodide"
pytestmark = pytest.mark.timeout(600)  # JupyterLite is built, and starts Python
NUMPY = os.environ.get("ROBOWIDGETS_PYODIDE_NUMPY", "")
BOOT_MS = 240_000
"""Python, or JupyterLab and a kernel, start within a page; a busy machine takes its time."""

BARE = """
import sys
from types import ModuleType

sys.path.insert(0, "/home/pyodide")
sys.modules["robowidgets"] = ModuleType("robowidgets")  # without what imports NumPy
sys.modules["robowidgets"].__path__ = ["/home/pyodide/robowidgets"]
"""

KINDS = '''
import asyncio, anywidget, traitlets

try:
    import robowidgets
except ModuleNotFoundError as error:
    assert error.name == "numpy", error  # what the browser lacks was put right before

class Kinds(anywidget.AnyWidget):
    nothing = traitlets.Int(None, allow_none=True).tag(sync=True)
    yes = traitlets.Bool(True).tag(sync=True)
    count = traitlets.Int(3).tag(sync=True)
    stamp = traitlets.Int(1_700_000_000_000_000_000).tag(sync=True)
    part = traitlets.Float(0.5).tag(sync=True)
    text = traitlets.Unicode("a").tag(sync=True)
    items = traitlets.List([None, [None, 1]]).tag(sync=True)
    pair = traitlets.Tuple((None, 2)).tag(sync=True)
    table = traitlets.Dict({"hovered": None, "rays": [1, None]}).tag(sync=True)
    frame = traitlets.Bytes(b"\\0\\1\\2\\xff").tag(sync=True)
    hovered = traitlets.Int(5, allow_none=True).tag(sync=True)
    answer = traitlets.Dict().tag(sync=True)
    _esm = """
    export default {
      render({ model, el }) {
        const names = ["nothing", "yes", "count", "stamp", "part", "text", "items", "pair", "table", "hovered"];
        const shown = Object.fromEntries(names.map((name) => [name, model.get(name)]));
        const frame = model.get("frame");
        shown.frame = [...new Uint8Array(frame.buffer, frame.byteOffset, frame.byteLength)];
        shown.later = model.get("stamp") + 0.5 > 0;  // a BigInt throws here
        const text = el.appendChild(document.createElement("pre"));
        text.className = "kinds";
        text.textContent = JSON.stringify(shown, (_, value) => (value === undefined ? "undefined" : value));
        const button = el.appendChild(document.createElement("button"));
        button.textContent = "answer";
        button.onclick = () => {
          model.set("hovered", null);
          model.set("answer", { none: null, list: [null, 1], number: 2.5, text: "b", yes: false });
          model.save_changes();
          model.send({ custom: null });
        };
        model.on("msg:custom", (message) => {
          const said = el.appendChild(document.createElement("p"));
          said.className = "said";
          said.textContent = JSON.stringify(message, (_, value) => (value === undefined ? "undefined" : value));
        });
      },
    };
    """

kinds = Kinds()
custom = []
kinds.on_msg(lambda _, content, buffers: (custom.append(content), kinds.send({"back": [None]})))
kinds
'''
SHOWN = {
    "nothing": None, "yes": True, "count": 3, "stamp": 1_700_000_000_000_000_000, "part": 0.5, "text": "a",
    "items": [None, [None, 1]], "pair": [None, 2], "table": {"hovered": None, "rays": [1, None]}, "hovered": 5,
    "frame": [0, 1, 2, 255], "later": True,
}  # fmt: skip

WAITS = """
import threading, time
from types import ModuleType

ticks = []
def tick():
    while len(ticks) < 40:
        ticks.append(1)
        time.sleep(0.01)
thread = threading.Thread(target=tick, daemon=True)
thread.start()
while not thread.is_alive() or len(ticks) < 5:
    pass  # never waits: gives way all the same
thread.join()
print("ticks", len(ticks))
"""

LESSON = """
from robowidgets import LaserWidget, feeds, lessons
from robowidgets.behaviors import Drive

laser = LaserWidget(title="/scan")
feed = feeds.simulator(wander=False)
feed.connect("/scan", laser)
laser
"""
PROGRAM = """
import time

@feed.program(rate=10)
def avoid(scan):
    return Drive(0.2) if scan.distance("front") > 0.6 else Drive(0, 0.8)

time.sleep(4)
print("steps", avoid.steps >= 32, "rate", laser.rate >= 8)
"""
EDIT = """
@feed.program(rate=10)
def avoid(scan):
    while True:
        pass

while avoid.error == "":
    time.sleep(0.1)
print(avoid.error)
"""
CHECK = """
def nearest_on_the_left(scan):
    while True:
        pass

print(lessons.check(nearest_on_the_left))
"""


class _Files(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: Any) -> None:
        pass


def serve(folder: Path) -> tuple[str, Callable[[], None]]:
    """Serve a folder of files, as any web server does; its address, and what ends that."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(_Files, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()

    def stop() -> None:
        server.shutdown()
        server.server_close()

    return f"http://127.0.0.1:{server.server_port}", stop


CORE = ("__init__", "in_browser", "stack_threads")
LOAD = """
async ([url, texts, code]) => {
  const { loadPyodide } = await import(`${url}/pyodide.mjs`);
  const python = await loadPyodide({ indexURL: `${url}/` });
  for (const [name, text] of Object.entries(texts)) {
    python.FS.mkdirTree(`/home/pyodide/${name.split("/").slice(0, -1).join("/")}`);
    python.FS.writeFile(`/home/pyodide/${name}`, text);
  }
  return await python.runPythonAsync(code);
}
"""
RUN = """
import json, js
from pyodide.ffi import create_proxy
from robowidgets._core import in_browser

threads = in_browser.prepare()
import stack_cases
json.dumps(stack_cases.run(list(stack_cases.CASES), threads, lambda call: js.setTimeout(create_proxy(call), 0)))
"""


def test_threads_do_in_chromium_what_they_do_elsewhere(browser: Browser) -> None:
    url, stop = serve(PYODIDE)
    page = browser.new_page()
    console = Console(page)
    page.goto(f"{url}/package.json")
    core = ROOT / "robowidgets" / "_core"
    texts = {f"robowidgets/_core/{name}.py": (core / f"{name}.py").read_text() for name in CORE}
    texts["stack_cases.py"] = Path(stack_cases.__file__).read_text()
    wrong: dict[str, str] = json.loads(page.evaluate(LOAD, [url, texts, f"{BARE}\n{RUN}"]))
    assert list(wrong) == list(stack_cases.CASES)
    assert {name: text for name, text in wrong.items() if text} == {}
    assert console.errors == []
    page.close()
    stop()


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    """JupyterLite, served by a plain server; and its folder of notebooks."""
    out = tmp_path_factory.mktemp("site") / "lite"
    notebooks = tmp_path_factory.mktemp("notebooks") / "tests"
    notebooks.mkdir()
    (notebooks / "kinds.ipynb").write_text(
        notebook_of([KINDS, "print('came', kinds.hovered, kinds.answer, custom)", WAITS])
    )
    (notebooks / "lesson.ipynb").write_text(notebook_of([LESSON, PROGRAM, EDIT, CHECK]))
    subprocess.run([ROOT / "scripts" / "lite.sh"], cwd=ROOT, check=True)
    subprocess.run([sys.executable, ROOT / "scripts" / "lite_site.py", out, f"tests={notebooks}"], cwd=ROOT, check=True)
    url, stop = serve(out)
    yield url, out
    stop()


class Lite:
    """A notebook in JupyterLite."""

    def __init__(self, browser: Browser, url: str, notebook: str) -> None:
        self.page: Page = browser.new_page(viewport={"width": 1200, "height": 1300})
        self.console = Console(self.page)
        self.page.goto(f"{url}/notebooks/index.html?path=tests/{notebook}")
        self.page.locator(".jp-CodeCell").first.wait_for(timeout=BOOT_MS)

    def run(self, index: int, awaited: str) -> None:
        """Run a cell until it shows a text."""
        cell = self.page.locator(".jp-CodeCell").nth(index)
        cell.locator(".cm-content").click()
        self.page.keyboard.press("Shift+Enter")
        expect(cell.locator(".jp-OutputArea")).to_contain_text(awaited, timeout=BOOT_MS)

    def output(self, index: int) -> Any:
        return self.page.locator(".jp-CodeCell").nth(index).locator(".jp-OutputArea")


def test_python_and_the_page_mean_the_same_by_each_kind_of_value_and_a_cell_that_computes_gives_way(
    browser: Browser, site: tuple[str, Path]
) -> None:
    nb = Lite(browser, site[0], "kinds.ipynb")
    nb.run(0, "answer")
    assert json.loads(nb.output(0).locator(".kinds").inner_text()) == SHOWN
    nb.page.get_by_role("button", name="answer", exact=True).click()
    expect(nb.output(0).locator(".said")).to_have_text('{"back":[null]}', timeout=BOOT_MS)
    nb.run(
        1, "came None {'none': None, 'list': [None, 1], 'number': 2.5, 'text': 'b', 'yes': False} [{'custom': None}]"
    )
    nb.run(2, "ticks 40")
    assert nb.console.errors == []
    nb.page.close()
    # The lock names each file by its hash, and all that each needs.
    folder = site[1] / "static" / "pyodide"
    packages = json.loads((folder / "pyodide-lock.json").read_text())["packages"]
    for entry in packages.values():
        assert hashlib.sha256((folder / entry["file_name"]).read_bytes()).hexdigest() == entry["sha256"]
    assert {need for entry in packages.values() for need in entry["depends"]} <= packages.keys()
    assert {"robowidgets", "anywidget", "ipython", "pyodide-kernel"} <= packages.keys()


def test_another_file_than_that_of_pyodide_is_no_numpy(tmp_path: Path) -> None:
    other = tmp_path / "numpy.whl"
    other.write_bytes(b"other")
    given = os.environ | {"ROBOWIDGETS_PYODIDE_NUMPY": str(other)}
    command = [
        sys.executable,
        "-c",
        "import lite_site, json; lite_site.numpy_of(json.load(open(lite_site.PYODIDE / 'pyodide-lock.json')))",
    ]
    ended = subprocess.run(
        command, cwd=ROOT / "scripts", env=given, capture_output=True, text=True, timeout=60, check=False
    )
    assert ended.returncode == 1
    assert "is not the numpy-" in ended.stderr
    assert "expected 800c98edc0c864dfa49f07005680c699b4b42b84eae1f8cb19d35b3634e7f05c" in ended.stderr


@pytest.mark.skipif(not NUMPY, reason="ROBOWIDGETS_PYODIDE_NUMPY names no NumPy for the browser")
def test_a_lesson_runs_in_jupyterlite(browser: Browser, site: tuple[str, Path]) -> None:
    nb = Lite(browser, site[0], "lesson.ipynb")
    nb.run(0, "laser")
    nb.run(1, "steps True rate True")
    nb.run(2, "line 4: a step has not returned for half a second")
    nb.run(3, "line 3: a step has not returned for half a second")
    assert nb.console.errors == []
    nb.page.close()

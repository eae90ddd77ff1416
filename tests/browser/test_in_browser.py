"""robowidgets with Python itself in the browser: on a page with Pyodide, and in JupyterLite as on the site.

NumPy for the browser is in no registry. What needs it is skipped, unless ROBOWIDGETS_PYODIDE_NUMPY names its file.
"""

from __future__ import annotations

import base64
import functools
import gzip
import hashlib
import http.server
import importlib
import json
import os
import re
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from http import HTTPStatus
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import pytest
from lz4.frame import compress as lz4_compress
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from playwright.sync_api import Browser, Page, expect
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag2.storage_mcap import McapReader

from robowidgets import SAMPLE
from robowidgets.messages.compression import inflate, zstd
from robowidgets.notebook.in_browser import NO_SWITCHING

from .. import stack_cases
from ..conftest import ROOT
from ..unit.recordings import written
from . import firefox
from .conftest import FAILED
from .console import Console
from .notebook import notebook_of

PYODIDE = Path(__file__).with_name("node_modules") / "pyodide"
pytestmark = [pytest.mark.timeout(600), pytest.mark.xdist_group("lite")]  # JupyterLite is built once for all tests
NUMPY = os.environ.get("ROBOWIDGETS_PYODIDE_NUMPY", "")
needs_numpy = pytest.mark.skipif(not NUMPY, reason="ROBOWIDGETS_PYODIDE_NUMPY names no NumPy for the browser")
LESSONS = ("from_picture_to_code", "from_code_to_behavior", "from_behavior_to_robot")
BOOT_MS = 240_000
"""Python, or JupyterLab and a kernel, start within a page, slowly on a busy machine."""

NUMPY_SIZE = 3_700_000
FIRST_VIEW = 30_000_000
"""Bytes of a lesson's first view."""

BARE = """
import sys
from types import ModuleType

sys.path.insert(0, "/home/pyodide")
sys.modules["robowidgets"] = ModuleType("robowidgets")  # without what imports NumPy
sys.modules["robowidgets"].__path__ = ["/home/pyodide/robowidgets"]
"""

NOTE_LOADING = """
window.loading = [];
new MutationObserver(() => {
  const bar = document.querySelector(".rw-loading progress");
  if (bar) window.loading.push([bar.value, bar.max, bar.parentElement.querySelector("p").textContent]);
}).observe(document, { subtree: true, childList: true, attributes: true });
"""
"""Keeps the texts of the bar while a page loads."""

KINDS = '''
import asyncio, anywidget, importlib.util, traitlets
from pathlib import Path

try:
    import robowidgets
except ModuleNotFoundError as error:
    assert "this site does not have" in str(error), error  # what else the browser lacks was put right before

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
    # Run as each of our own is, which hears the kernel on a slow machine, too.
    _esm = (Path(importlib.util.find_spec("robowidgets").origin).parent / "static" / "run_once.js").read_text()
    _style = traitlets.Unicode().tag(sync=True)
    _script = traitlets.Unicode("""
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
    """).tag(sync=True)

kinds = Kinds()
custom = []
kinds.on_msg(lambda _, content, buffers: "custom" in content and (custom.append(content), kinds.send({"back": [None]})))
kinds
'''
SHOWN = {
    "nothing": None, "yes": True, "count": 3, "stamp": 1_700_000_000_000_000_000, "part": 0.5, "text": "a",
    "items": [None, [None, 1]], "pair": [None, 2], "table": {"hovered": None, "rays": [1, None]}, "hovered": 5,
    "frame": [0, 1, 2, 255], "later": True,
}  # fmt: skip

# The notebook no longer shows that its kernel starts. Until then JupyterLite may skip a cell without a message.
IS_READY = "document.querySelector('.jp-NotebookKernelStatus-fade')?.textContent === ''"
RUN_CELL = "[data-jp-item-name=run] jp-button"
PRINTED = ".jp-OutputArea-output[data-mime-type='application/vnd.jupyter.stdout']"
"""Return the printed text of a cell, without messages about the slowness of a busy machine."""

CAME = "came None {'none': None, 'list': [None, 1], 'number': 2.5, 'text': 'b', 'yes': False} [{'custom': None}]"

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

READ = """
import hashlib, importlib.util, sys
from base64 import b64decode
from pathlib import Path

home = Path(importlib.util.find_spec("robowidgets").origin).parent
sys.modules["robowidgets.notebook.in_browser"].prepare_recordings()
# By their files: what else is in the package needs NumPy.
spec = importlib.util.spec_from_file_location("compression", home / "messages" / "compression.py")
compression = importlib.util.module_from_spec(spec)
spec.loader.exec_module(compression)

from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1.reader import decompressors
from rosbags.rosbag2.storage_mcap import DECOMPRESSORS, McapReader

for table in (decompressors, DECOMPRESSORS):
    for name in set(table) & compression.COMPRESSIONS:
        table[name] = lambda data, *_, name=name: compression.inflate(name, data)[0]

def said(name, pieces):
    pieces = list(pieces)
    print(name, len(pieces), hashlib.sha256(b"".join(pieces)).hexdigest())

PACKED = {name: b64decode(text) for name, text in PACKED.items()}
PACKED["sample.mcap"] = (home / "data" / "sample.mcap").read_bytes()
for name, data in PACKED.items():
    if name.endswith((".bag", ".mcap")):
        path = Path("/tmp", name)
        path.write_bytes(data)
        reader = (BagReader if name.endswith(".bag") else McapReader)(path)
        reader.open()
        said(name, (raw for _, _, raw in reader.messages(reader.connections)))
    else:
        raw, whole = compression.inflate(name.split()[0].strip(","), data)
        said(name, [raw if whole else b"", b"%d" % whole])
print("read all", "sqlite3" in sys.modules)
"""
FILES = (".bag", ".mcap")

BESIDE = """
from pathlib import Path
from beside import SAID  # as the study imports study.py

kept = Path("kept.csv")  # as it writes P07.csv
before = kept.read_text() if kept.exists() else "nothing"
kept.write_text("of before")
print(SAID, "kept", before)
"""


def packed(folder: Path) -> dict[str, bytes]:
    """Data to unpack, by name: frames that begin with the name of their compression, and recordings."""
    text = b"".join(b"%d: %.3f m; " % (i, (i * 37 % 1000) / 7) for i in range(30_000))  # in several blocks
    held = [("/scan", 1_700_000_000_000_000_000 + i * 10**8, text[i * 3000 : (i + 1) * 3000]) for i in range(100)]
    with (folder / "lz4.mcap").open("wb") as file:
        writer = McapWriter(file, compression=CompressionType.LZ4, chunk_size=100_000)
        writer.start("ros2", "test")
        channel = writer.register_channel("/scan", "cdr", writer.register_schema("std_msgs/msg/String", "ros2msg", b""))
        for _, time_ns, data in held:
            writer.add_message(channel, time_ns, data, time_ns)
        writer.finish()
    for compression in ("lz4", "bz2"):
        written.write_bag(folder / f"{compression}.bag", held, compression, chunk=100_000)
    options = {zstd.CompressionParameter.compression_level: 9, zstd.CompressionParameter.checksum_flag: 1}
    summed, linked = zstd.compress(text, options=options), lz4_compress(text, block_linked=True, content_checksum=True)
    return {
        "zstd": zstd.compress(text, 1),
        "zstd, two": summed + zstd.compress(b"more"),
        "zstd, a run, and nothing": zstd.compress(bytes(300_000)) + zstd.compress(b""),
        "zstd, skipped first": b"\x50\x2a\x4d\x18\x03\0\0\0abc" + summed,
        "zstd, cut": summed[:-9],
        "zstd, damaged": b"\x28\xb5\x2f\xfd" + bytes(range(250)),
        "lz4": lz4_compress(text, store_size=False),
        "lz4, linked": linked,
        "lz4, two": linked + lz4_compress(bytes(300_000), block_checksum=True),
        "lz4, cut": linked[:-9],
        "lz4, damaged": linked[:7] + b"\x08\0\0\0\x10a\xff\xff\0\0\0\0\0\0\0\0" + bytes(4),
        "lz4, what does not compress": lz4_compress(hashlib.sha256(text).digest() * 2),
        **{path.name: path.read_bytes() for path in sorted(folder.iterdir())},
    }


def said(name: str, data: bytes, folder: Path) -> str:
    """The text that the cell prints for one of them."""
    raw, whole = inflate(name.split()[0].strip(","), data) if not name.endswith(FILES) else (b"", True)
    pieces = [raw if whole else b"", b"%d" % whole]  # damaged data yields less
    if name.endswith(FILES):
        (folder / name).write_bytes(data)
        reader: Any = (BagReader if name.endswith(".bag") else McapReader)(folder / name)
        reader.open()
        pieces = [raw for _, _, raw in reader.messages(reader.connections)]
        reader.close()
    return f"{name} {len(pieces)} {hashlib.sha256(b''.join(pieces)).hexdigest()}"


def reading_cell(data: dict[str, bytes]) -> str:
    texts = {name: base64.b64encode(raw).decode() for name, raw in data.items()}
    return f"PACKED = {texts!r}\n{READ}"


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
STUDY = """
import sys
import time

import js
from pyodide.ffi import create_once_callable

sys.path.append("../studies")
from compare import compare
from study import SUS, TLX, WITH, Study

for number in (1, 2):
    study, boxes = Study(number), []
    boxes.append(study.show())
    study.agree()
    while study.step:
        kind, _, form, _, task = study.step
        if kind == "task":
            assert task.is_code or study.answer("-1") == "Not yet."
            if task.is_code and number == 1:
                name = task.given[4 : task.given.index("(")]
                part = "'left'" if "left" in name else "('-20deg', '20deg')"
                step = study.step
                study._draw(boxes[-1])
                _, _, field, buttons, _ = boxes[-1].children
                field.value = f"def {name}(scan):\\n    return scan.distance({part})"
                # By the page, which calls Python where it cannot wait.
                js.setTimeout(create_once_callable(buttons.children[0].click), 0)
                while study.step is step:
                    time.sleep(0.05)
            else:
                study.give_up()
        else:
            rating = 4 if form == WITH else 2
            study.rate(dict.fromkeys(TLX if kind == "tlx" else map(str, range(1, len(SUS) + 1)), rating))
found = compare(".")
print(found.participants, found.measures[1].values.tolist(), found.problems)
"""


class Server:
    """Serves a folder of files, as any web server does, at a fixed address.

    Attributes:
        sent: the files that were sent, and how often.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.sent, self._port = folder, Counter[Path](), 0
        self.start()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self._port}"

    def start(self) -> None:
        sent, folder = self.sent, self.folder

        class Files(http.server.SimpleHTTPRequestHandler):
            def log_request(self, code: Any = "-", _: Any = "-") -> None:
                if code == HTTPStatus.OK:
                    sent[Path(self.translate_path(self.path))] += 1

            def log_message(self, *_: Any) -> None:
                pass

        handler = functools.partial(Files, directory=str(folder))
        self._server = http.server.ThreadingHTTPServer(("127.0.0.1", self._port), handler)
        self._port = self._server.server_port
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def stop(self) -> None:
        self._server.shutdown()
        self._server.server_close()


THREADS = ("notebook/__init__", "notebook/in_browser", "runtime/__init__", "runtime/stack_threads")
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
from robowidgets.notebook import in_browser

threads = in_browser.prepare()
import stack_cases
json.dumps(stack_cases.run(list(stack_cases.CASES), threads, lambda call: js.setTimeout(create_proxy(call), 0)))
"""


def test_threads_do_in_chromium_what_they_do_elsewhere(browser: Browser) -> None:
    server = Server(PYODIDE)
    page = browser.new_page()
    console = Console(page)
    page.goto(f"{server.url}/package.json")
    texts = {f"robowidgets/{name}.py": (ROOT / f"robowidgets/{name}.py").read_text() for name in THREADS}
    texts["stack_cases.py"] = Path(stack_cases.__file__).read_text()
    wrong: dict[str, str] = json.loads(page.evaluate(LOAD, [server.url, texts, f"{BARE}\n{RUN}"]))
    assert list(wrong) == list(stack_cases.CASES)
    assert {name: text for name, text in wrong.items() if text} == {}
    assert console.errors == []
    page.close()
    server.stop()


class Site(NamedTuple):
    """Serve JupyterLite, and yield the data that one of its notebooks unpacks; see `packed`."""

    server: Server
    packed: dict[str, bytes]

    def said(self) -> list[str]:
        """The text that the unpacking cell prints."""
        with TemporaryDirectory() as folder:
            return [said(name, data, Path(folder)) for name, data in self.packed.items()]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """JupyterLite with notebooks of these tests."""
    out = tmp_path_factory.mktemp("site") / "lite"
    notebooks = tmp_path_factory.mktemp("notebooks") / "tests"
    notebooks.mkdir()
    data = packed(tmp_path_factory.mktemp("packed"))
    (notebooks / "kinds.ipynb").write_text(
        notebook_of([KINDS, "print('came', kinds.hovered, kinds.answer, custom)", WAITS, reading_cell(data), BESIDE])
    )
    (notebooks / "beside.py").write_text("SAID = 'from beside'")
    (notebooks / "lesson.ipynb").write_text(notebook_of([LESSON, PROGRAM, EDIT, CHECK, STUDY]))
    subprocess.run([ROOT / "scripts" / "lite.sh"], cwd=ROOT, check=True)
    subprocess.run([sys.executable, ROOT / "scripts" / "lite_site.py", out, f"tests={notebooks}"], cwd=ROOT, check=True)
    server = Server(out)
    yield Site(server, data | {"sample.mcap": SAMPLE.read_bytes()})
    server.stop()


def address_of(site: Site, notebook: str) -> str:
    return f"{site.server.url}/notebooks/index.html?path={notebook}"


class Lite:
    """A notebook in JupyterLite.

    Attributes:
        loading: states of the bar while it loaded: value, most, and text.
    """

    def __init__(self, page: Page, console: Console, address: str) -> None:
        self.page, self.console, self._address = page, console, address
        self.open()

    def open(self) -> None:
        """Open the notebook. After the first time, restart it with another kernel."""
        self.page.goto(self._address, wait_until="commit")
        self.page.wait_for_function(IS_READY, timeout=BOOT_MS)
        self.loading = self.page.evaluate("loading")

    def run(self, index: int, awaited: str) -> None:
        """Run a cell until it shows a text."""
        cell = self.page.locator(".jp-CodeCell").nth(index)
        cell.locator(".cm-content").click()
        expect(cell).to_have_class(re.compile(r"\bjp-mod-active\b"))
        self.page.locator(RUN_CELL).click()
        expect(cell.locator(".jp-OutputArea")).to_contain_text(awaited, timeout=BOOT_MS)

    def run_all(self) -> None:
        """Run all cells, up to the first error."""
        cells = self.page.locator(".jp-CodeCell .jp-InputPrompt")
        self.page.get_by_role("menuitem", name="Run", exact=True).click()
        self.page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
        expect(cells).to_have_text([re.compile(r"\[\d+\]")] * cells.count(), timeout=BOOT_MS)

    def output(self, index: int) -> Any:
        return self.page.locator(".jp-CodeCell").nth(index).locator(".jp-OutputArea")


@pytest.fixture
def lite(browser: Browser, site: Site, pages: list[tuple[Page, Console]]) -> Callable[[str], Lite]:
    """Return a function that opens a notebook in JupyterLite, as on a first visit."""

    def open_notebook(name: str) -> Lite:
        page = browser.new_page(viewport={"width": 1200, "height": 1300})
        page.add_init_script(NOTE_LOADING)
        pages.append((page, Console(page)))
        return Lite(*pages[-1], address_of(site, name))

    return open_notebook


@pytest.fixture(scope="module")
def spare() -> Iterator[list[Lite]]:
    """The notebook of `kinds`, while no other test uses it."""
    kept: list[Lite] = []
    yield kept
    for nb in kept:
        nb.page.close()


@pytest.fixture
def kinds(
    lite: Callable[[str], Lite], site: Site, spare: list[Lite], pages: list[tuple[Page, Console]], request: Any
) -> Iterator[Lite]:
    """The notebook that needs no NumPy, with its first cell run: opened once, and reopened after a failed test."""
    if spare:
        nb = spare.pop()
        pages.append((nb.page, nb.console))
    else:
        site.server.sent.clear()
        nb = lite("tests/kinds.ipynb")
        nb.run(0, "answer")
    yield nb
    if not request.node.stash.get(FAILED, False):
        pages.remove((nb.page, nb.console))
        spare.append(nb)


def lines_of(printed: str) -> list[str]:
    """Return the printed lines. JupyterLite may begin another, empty output while it draws."""
    return [line for line in printed.splitlines() if line]


def test_python_and_the_page_mean_the_same_by_each_kind_of_value_and_a_cell_that_computes_gives_way(
    kinds: Lite, site: Site
) -> None:
    assert json.loads(kinds.output(0).locator(".kinds").inner_text()) == SHOWN
    kinds.page.get_by_role("button", name="answer", exact=True).click()
    expect(kinds.output(0).locator(".said")).to_have_text('{"back":[null]}', timeout=BOOT_MS)
    kinds.run(1, CAME)
    kinds.run(2, "ticks 40")
    kinds.run(3, "read all False")
    printed = "\n".join(kinds.output(3).locator(PRINTED).all_inner_texts())
    assert lines_of(printed)[:-1] == site.said()
    assert kinds.console.errors == []


def test_the_bar_of_the_first_view_counts_what_the_kernel_loads_then_and_no_more(kinds: Lite, site: Site) -> None:
    values, mosts, texts = zip(*kinds.loading, strict=True)
    assert values == tuple(sorted(values))
    assert (values[0], set(mosts)) == (0, {values[-1]})
    assert re.fullmatch(r"Loading Python: ([\d.]+) of \1 MB", texts[-1])
    sent = [file for file in site.server.sent if file.parent.name == "pyodide"]
    assert sum(file.stat().st_size for file in sent) == values[-1]
    # A private window does not cache a file as large as Python itself; any other window has each file from its cache.
    assert {file.name for file in sent if site.server.sent[file] > 1} <= {"pyodide.asm.wasm"}
    # Compressed if that makes a file smaller, as web servers do.
    first_view = sum(len(gzip.compress(file.read_bytes())) for file in site.server.sent)
    assert first_view + (0 if NUMPY else NUMPY_SIZE) < FIRST_VIEW


def test_a_notebook_has_the_modules_in_its_folder_and_on_the_next_visit_its_written_files(kinds: Lite) -> None:
    kinds.run(4, "from beside kept nothing")
    kinds.open()
    kinds.run(4, "from beside kept of before")
    assert kinds.console.errors == []


@pytest.mark.skipif(firefox.found() is None, reason="Firefox is not installed: apt-get install firefox-esr")
def test_firefox_runs_what_chromium_does_and_one_that_cannot_pause_python_says_so(site: Site, tmp_path: Path) -> None:
    address = address_of(site, "tests/kinds.ipynb")
    said = "return document.querySelector('.rw-cannot p')?.textContent"
    with firefox.running(tmp_path / "old", {"javascript.options.wasm_js_promise_integration": False}) as browser:
        browser.open(address)
        assert browser.wait(said) == f"{NO_SWITCHING}."
        browser.click(".rw-cannot button")
        browser.wait("return !document.querySelector('.rw-cannot')")
    with firefox.running(tmp_path / "new") as browser:
        browser.open(address)
        browser.wait(f"return {IS_READY}")

        def run(index: int, awaited: str, of: str = PRINTED) -> str:
            """Run the next cell until it shows a text in the outputs of a selector, and return all of these."""
            browser.click(RUN_CELL)
            cell = f"document.querySelectorAll('.jp-CodeCell')[{index}]"
            shown = f"[...{cell}.querySelectorAll({json.dumps(of)})].map((one) => one.innerText).join('\\n')"
            return str(browser.wait(f"const shown = {shown}; return shown.includes({json.dumps(awaited)}) && shown"))

        assert json.loads(run(0, "later", of=".kinds")) == SHOWN
        browser.run("[...document.querySelectorAll('button')].find((one) => one.textContent === 'answer').click()")
        browser.wait("return document.querySelector('.said')?.textContent === '{\"back\":[null]}'")
        run(1, CAME)
        run(2, "ticks 40")
        assert lines_of(run(3, "read all False"))[:-1] == site.said()
        run(4, "from beside kept nothing")
        assert browser.run(said) is None


def test_the_lock_names_each_file_by_its_hash_and_all_that_each_needs(site: Site) -> None:
    folder = site.server.folder / "static" / "pyodide"
    packages = json.loads((folder / "pyodide-lock.json").read_text())["packages"]
    for entry in packages.values():
        assert hashlib.sha256((folder / entry["file_name"]).read_bytes()).hexdigest() == entry["sha256"]
    assert {need for entry in packages.values() for need in entry["depends"]} <= packages.keys()
    assert {"robowidgets", "anywidget", "ipython", "pyodide-kernel"} <= packages.keys()


def test_every_link_of_a_notebook_leads_to_one_next_to_it(site: Site) -> None:
    files = site.server.folder / "files"
    notebooks = [file for file in files.rglob("*.ipynb") if file.parent.name != "tests"]
    there = {"tour.ipynb", "de/from_picture_to_code.ipynb", "studies/take_part.ipynb", "studies/compare.ipynb"}
    assert there <= {str(file.relative_to(files)) for file in notebooks}
    assert {"study.py", "compare.py"} <= {file.name for file in (files / "studies").iterdir()}
    links = [(file, link) for file in notebooks for link in re.findall(r"\]\(([^):]+)\)", file.read_text("utf-8"))]
    assert len(links) > 20
    assert [(file, link) for file, link in links if not (file.parent / link).exists()] == []


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("other.whl", "other.whl is not the numpy-.* expected 800c98edc0c864dfa49f07005680c699b4b42b84eae1f8cb19d3"),
        ("none.whl", "No such file or directory: 'none.whl'. Name the file of https://cdn.jsdelivr.net/pyodide/v"),
    ],
)
def test_another_file_than_pyodides_is_not_numpy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: str, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(ROOT / "scripts")
    monkeypatch.setenv("ROBOWIDGETS_PYODIDE_NUMPY", given)
    Path("other.whl").write_bytes(b"other")
    lite_site = importlib.import_module("lite_site")
    with pytest.raises(SystemExit, match=said):
        lite_site.numpy_of(json.loads((PYODIDE / "pyodide-lock.json").read_text()))


@needs_numpy
def test_a_lesson_and_the_study_run_in_jupyterlite(lite: Callable[[str], Lite]) -> None:
    nb = lite("tests/lesson.ipynb")
    nb.run(0, "laser")
    nb.run(1, "steps True rate True")
    nb.run(2, "line 4: a step has not returned for half a second")
    nb.run(3, "line 3: a step has not returned for half a second")
    nb.run(4, "(1, 2) [[1.0, 1.0], [0.0, 0.0]] ()")


@needs_numpy
@pytest.mark.parametrize(
    "name",
    [
        *(f"{folder}{lesson}.ipynb" for folder in ("", "de/", "es/") for lesson in LESSONS),
        "tour.ipynb",
        "find.ipynb",
        "studies/take_part.ipynb",
    ],
)
def test_all_cells_of_a_notebook_run_to_their_end_in_jupyterlite(lite: Callable[[str], Lite], name: str) -> None:
    lite(name).run_all()

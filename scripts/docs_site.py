"""Build the documentation as a static site: `docs_site.py OUT [--lite] [--only PAGE...]`.

It runs each Python block of a page as tests/test_docs.py does. Live widgets of the block replace the picture that
follows the block in the Markdown. Neither this script nor the site fetches anything from the web.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import nbformat

ROOT = Path(__file__).resolve().parents[1]
STATIC = ROOT / "robowidgets" / "static"
SECONDS = 300
"""The time limit for the blocks of a page."""

OTHER_PAGES = {
    ROOT / "README.md": "index.md",
    ROOT / "docs" / "README.md": "how_do_i.md",
    ROOT / "CHANGELOG.md": "changelog.md",
    ROOT / "CONTRIBUTING.md": "contributing.md",
}
"""Pages of the site with another name than in the repository."""

NEEDS_KERNEL = {
    "drive_widget",
    "lines_widget",
    "player_widget",
    "program_widget",
    "sheet_widget",
    "stop_widget",
    "topics_widget",
}
"""Widgets that need answers of Python. They keep their pictures, like widgets without a script."""

NOT_IN_BROWSER = {
    "assistants",
    "connect",
    "feeds",
    "hosts",
    "many_recordings",
    "rerun",
    "share",
    "stopping",
    "teach",
    "wires",
}
"""Pages without "Try it", because their snippets need a robot, processes, or features that a browser lacks."""

API = {
    "Widgets": """LaserWidget SpeedWidget TouchWidget SonarWidget ImageWidget CloudWidget PathWidget PlotWidget
        MessageWidget EventsWidget ScanogramWidget WiresWidget DriveWidget ProgramWidget MachineWidget Footprint Sector
        screen plot load_map""",
    "Samples": "Scan Ray Range Ranges Cloud Speed Touch TouchState TouchMode Event MapGrid Validity spread",
    "Shapes": "Arc Arrow Line Points Polygon Text",
    "Recordings": "open Recording RecordingError find summary",
}
"""The names of the package on each page of the reference. Each module has its own page."""
API_MODULES = {
    "Conditions": "robowidgets.recordings.search.conditions",
    "Feeds": "robowidgets.feeds",
    "Simulator": "robowidgets.simulator",
    "Behaviors": "robowidgets.behaviors",
    "Lessons": "robowidgets.lessons",
}

OPEN = "lite/notebooks/index.html?path="
"""The address that opens a notebook of the site. The name of the notebook follows."""

_BLOCK = re.compile(r"^```python\n(.*?)^```\n", re.MULTILINE | re.DOTALL)
_PICTURE = re.compile(r"\n*(?:<picture>.*?</picture>|!\[[^\]]*\]\([^)]*\)|<img [^>]*>)\n", re.DOTALL)
_ANY_PICTURE = re.compile(
    r"!\[([^\]]*)\]\(([^)]*)\)|(?:<picture>.*?)?<img(?=[^>]*\bsrc=\"([^\"]*)\")(?:[^>]*\balt=\"([^\"]*)\")?[^>]*>(?:\s*</picture>)?",
    re.DOTALL,
)
_FENCE = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)
_NOTEBOOK = re.compile(r"`notebooks/(\w+\.ipynb)`")
_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!https?:|#)([^)#]+)(#[^)]*)?\)")

_RUN = '''
import json, sys
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
from ipywidgets import Widget
from robowidgets.export.models import Models
from robowidgets.screen_widget import ScreenWidget

shell = InteractiveShell.instance()
blocks, live, out = json.load(sys.stdin)
VIEW = "application/vnd.jupyter.widget-view+json"

def all_of(widget):
    """Return all widgets in a box, or all on a screen and the screen itself."""
    inner = [one for child in getattr(widget, "children", ()) for one in all_of(child)]
    return inner if hasattr(widget, "box_style") else [*inner, widget]

def waits(part):
    """Return True while the widget has received no sample."""
    frames = [value for value in part.get_state().values() if isinstance(value, (bytes, memoryview))]
    return bool(frames) and not any(frames)

for number, source in enumerate(blocks):
    with capture_output(stdout=False, stderr=False) as captured:
        cell = shell.run_cell(source)
    if not cell.success:
        raise SystemExit(f"block {number + 1}: {cell.error_before_exec or cell.error_in_exec!r}")
    ids = [output.data[VIEW]["model_id"] for output in captured.outputs if VIEW in output.data]
    known = Widget._active_widgets if hasattr(Widget, "_active_widgets") else Widget.widgets
    shows = [known[i] for i in ids if i in known]
    if isinstance(cell.result, Widget) and cell.result not in shows:
        shows.append(cell.result)
    for widget in shows[-1:]:
        parts = all_of(widget)
        if widget not in parts:  # the site has no boxes
            widget = ScreenWidget(places={"foot": parts})
            parts = [*parts, widget]
        if any(type(part).__module__.rpartition(".")[2] not in live for part in parts) or any(map(waits, parts)):
            continue
        models = Models()
        for part in parts:
            # Without a kernel, a source cannot become silent, and the page cannot request history.
            known_traits = part.keys
            models.add(part, {k: v for k, v in {"_source": {}, "_silence": 0.0}.items() if k in known_traits})
        with open(out % number, "wb") as file:
            file.write(models.part(widget.model_id))
'''


def run_blocks(page: Path, live: Path) -> dict[int, str]:
    """Run the Python blocks of a page. Return, by the number of a block, the file with the widget that it shows.

    Raises:
        SystemExit: a block fails. The text contains the reason.
    """
    blocks = _BLOCK.findall(page.read_text(encoding="utf-8"))
    if not blocks:
        return {}
    pattern = str(live / f"{page.stem}-%d.txt")
    names = sorted({script.stem for script in STATIC.glob("*_widget.js")} - NEEDS_KERNEL)
    with tempfile.TemporaryDirectory() as folder:
        ended = subprocess.run(
            [sys.executable, "-c", _RUN],
            cwd=folder, input=json.dumps([blocks, names, pattern]), text=True, capture_output=True,
            timeout=SECONDS, check=False, env=os.environ | {"PYTHONPATH": str(ROOT)},
        )  # fmt: skip
    if ended.returncode:
        raise SystemExit(f"{page.name}: {ended.stderr[-2000:]}")
    return {n: Path(pattern % n).name for n in range(len(blocks)) if Path(pattern % n).exists()}


def with_widgets(text: str, shows: dict[int, str], up: str, notebook: str) -> str:
    """Return the Markdown of a page with live widgets, and with a link per block that opens it in JupyterLite."""
    parts, at = [], 0
    for number, block in enumerate(_BLOCK.finditer(text)):
        parts.append(text[at : block.end()])
        at = block.end()
        if notebook:
            parts.append(f'\n<p class="rw-try"><a href="{up}{OPEN}{notebook}">Try it in your browser</a></p>\n')
        if number in shows:
            parts.append(f'\n<div class="rw-live" data-rw-live="{up}live/{shows[number]}"></div>\n')
            if picture := _PICTURE.match(text, at):
                at = picture.end()
    return "".join([*parts, text[at:]])


def in_both_schemes(text: str, source: Path, page: Path) -> str:
    """Return the text of a page with light and dark pictures for the scheme of the reader, loaded on scrolling."""
    above = (ROOT / "docs" / page).parent

    def both(match: re.Match[str]) -> str:
        alt, src = match[1] or match[4] or "", os.path.relpath(source.parent / (match[2] or match[3]), above)
        dark = src.replace("-light.", "-dark.")
        there = dark != src and (above / dark).exists()
        shown = [(src, "#only-light"), (dark, "#only-dark")] if there else [(src, "")]
        return "".join(f'<img loading="lazy" alt="{alt}" src="{name}{only}">' for name, only in shown)

    return _ANY_PICTURE.sub(both, text)


def within_site(text: str, source: Path, page: Path) -> str:
    """Return the text of a page with links to pages of the site. Links to other files become the names of the files."""

    def lead(match: re.Match[str]) -> str:
        words, target, section = match[1], match[2], match[3] or ""
        file = (source.parent / target).resolve()
        if file in OTHER_PAGES:
            place = Path(OTHER_PAGES[file])
        elif file.is_relative_to(ROOT / "docs"):
            place = file.relative_to(ROOT / "docs")
        else:
            return f"{words} (`{file.relative_to(ROOT)}`)"
        return f"[{words}]({os.path.relpath(place, page.parent)}{section})"

    # Every second part is a block of code, in which `list[name](value)` is not a link.
    parts = _FENCE.split(text)
    return "".join(part if code % 2 else _LINK.sub(lead, part) for code, part in enumerate(parts))


def notebook_of(page: Path) -> nbformat.NotebookNode:
    """Return a page as a notebook: its text without links to other pages, and its Python blocks, in order."""
    text, cells, at = page.read_text(encoding="utf-8"), [], 0
    for block in _BLOCK.finditer(text):
        if words := _LINK.sub(r"\1", _PICTURE.sub("\n", text[at : block.start()])).strip():
            cells.append(nbformat.v4.new_markdown_cell(words, id=f"text-{len(cells)}"))
        cells.append(nbformat.v4.new_code_cell(block[1].rstrip(), id=f"code-{len(cells)}"))
        at = block.end()
    return nbformat.v4.new_notebook(cells=cells)


def api_pages() -> Iterator[tuple[str, str]]:
    """Yield the name and the Markdown of each page of the reference."""
    for title, names in API.items():
        yield title.lower(), f"# {title}\n\n" + "\n\n".join(f"::: robowidgets.{name}" for name in names.split()) + "\n"
    for title, module in API_MODULES.items():
        yield title.lower(), f"# {title}\n\n::: {module}\n"


def write_sources(to: Path, only: list[str], lite: bool) -> None:
    """Write the input of the site generator: Markdown, pictures, scripts, and the states of widgets."""
    written, docs, live, tries = ROOT / "docs", to / "docs", to / "docs" / "live", to / "try"
    shutil.copytree(written, docs, ignore=lambda folder, _: ["README.md"] if Path(folder) == written else [])
    for folder in (live, tries):
        folder.mkdir()
    pages = {path: path.relative_to(written) for path in sorted(written.glob("**/*.md")) if path not in OTHER_PAGES}
    asked = [source for source in pages if not only or source.stem in only]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        shows = dict(zip(asked, pool.map(lambda source: run_blocks(source, live), asked), strict=True))
    for source, page in [*pages.items(), *((source, Path(name)) for source, name in OTHER_PAGES.items())]:
        text, notebook = source.read_text(encoding="utf-8"), ""
        if lite and len(page.parts) == 1 and page.stem not in NOT_IN_BROWSER and _BLOCK.search(text):
            notebook = f"docs/{page.stem}.ipynb"
            nbformat.write(notebook_of(source), tries / f"{page.stem}.ipynb")
        up = "../" * (len(page.parts) - 1)
        text = within_site(text, source, page)
        if lite:
            text = _NOTEBOOK.sub(rf'<a href="{up}{OPEN}\1"><code>notebooks/\1</code></a>', text)
        text = in_both_schemes(with_widgets(text, shows.get(source, {}), up, notebook), source, page)
        (docs / page).write_text(text, encoding="utf-8")
    (docs / "api").mkdir()
    for name, text in api_pages():
        (docs / "api" / f"{name}.md").write_text(text, encoding="utf-8")
    scripts = docs / "assets"
    shutil.copytree(STATIC, scripts / "widgets", ignore=lambda _, names: [n for n in names if "_widget." not in n])
    subprocess.run(
        ["node_modules/.bin/esbuild", "site/live.ts", "--bundle", "--minify", "--format=esm", "--target=es2022",
         "--log-level=warning", f"--outfile={scripts / 'live.js'}"],
        cwd=ROOT / "robowidgets" / "js", check=True,
    )  # fmt: skip
    shutil.copy(Path(__file__).with_name("site.css"), scripts / "site.css")
    shutil.copy(Path(__file__).with_name("zensical.toml"), to / "zensical.toml")


def main() -> None:
    """Build the documentation into the folder of the command line."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("out", type=Path)
    given.add_argument("--only", nargs="*", default=[], help="run only the blocks of these pages")
    given.add_argument("--lite", action="store_true", help="the site has JupyterLite in lite/, which opens the pages")
    asked = given.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        write_sources(Path(folder), asked.only, asked.lite)
        subprocess.run([Path(sys.executable).with_name("zensical"), "build", "--strict"], cwd=folder, check=True)
        shutil.rmtree(asked.out, ignore_errors=True)
        shutil.copytree(Path(folder) / "site", asked.out)
        shutil.copytree(Path(folder) / "try", asked.out / "try")


if __name__ == "__main__":
    main()

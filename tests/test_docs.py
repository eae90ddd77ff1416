"""The commands and code that the documentation tells a reader to type work unchanged."""

from __future__ import annotations

import os
import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from .conftest import ROOT
from .patience import PATIENT

FILES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])
PROSE = {"text", "json", "sql", "toml"}
SHELL = {"bash", "sh"}
# Commands that no test can run here, each with its replacement.
ELSEWHERE = {
    "git clone": "the checkout that this test runs in",
    "pip install": "tests/test_wheel.py installs what is built from this checkout",
    "cd": "the checkout that this test runs in",
    "robowidgets demo": "tests/browser/test_command.py",
    "robowidgets open": "tests/browser/test_command.py",
}

_FENCE = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"!?\[[^\]]*\]\(([^)#\s]+)|<img[^>]*\bsrc=\"([^\"]+)\"")
_SECTION_LINK = re.compile(r"\]\(([^)#\s]*)#([^)\s]+)\)")
_HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
_PATH = re.compile(r"`((?:robowidgets|tests|docs|scripts|benchmarks|notebooks)/[^`\s]*)`")
MADE_BY_TESTS = {"tests/screenshots/", "tests/screenshots/failed/"}

every_file = pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))


# A cell of a notebook shows its last expression, and what it displays.
_SHOWS = re.compile(r"(?<!OnDemand)Widget\(|\.show\(|\.scanogram\(|wander\(")  # a row of kinds is not a widget
_WIDGET = re.compile(r"\w+Widget\(")
_CELLS = """
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
from ipywidgets import Widget

shell = InteractiveShell.instance()

def widgets_in(shown):
    return sum(map(widgets_in, shown.children)) if hasattr(shown, "children") else isinstance(shown, Widget)

def run(source, where, shows):
    with capture_output(stdout=False, stderr=False) as shown:
        cell = shell.run_cell(source)
    if not cell.success:
        raise SystemExit(f"{where}: {cell.error_before_exec or cell.error_in_exec!r}")
    displayed = sum("application/vnd.jupyter.widget-view+json" in output.data for output in shown.outputs)
    if displayed + widgets_in(cell.result) < shows:
        raise SystemExit(f"{where}: the cell makes widgets that it does not show")
"""


_NAME = re.compile(r"(?<![\w/.])robowidgets(?:\.[A-Za-z_]\w*)+(?![\w:]| import)")
_EACH_NAME = """
import os, sys
import robowidgets

for name in sys.argv[1:]:
    if child := os.fork():
        os.waitpid(child, 0)
        continue
    try:
        eval(name)
    except AttributeError as error:
        print(f"{name}: {error}", flush=True)
    os._exit(0)
"""
"""Look up each name with nothing but robowidgets imported: a lookup may import other modules."""


class Block(NamedTuple):
    """A fenced block: its language, its text and the line of its first line of text, from 1."""

    language: str
    text: str
    line: int


def blocks(file: Path) -> list[Block]:
    source = file.read_text(encoding="utf-8")
    return [
        Block(match[1].strip(), match[2], source.count("\n", 0, match.start(2)) + 1)
        for match in _FENCE.finditer(source)
    ]


def commands(file: Path) -> list[str]:
    lines = [line for block in blocks(file) if block.language in SHELL for line in block.text.splitlines()]
    return [line for line in lines if line.strip() and not line.startswith("#")]


def test_there_is_documentation() -> None:
    assert {"README.md", "CONTRIBUTING.md", "CHANGELOG.md"} <= {file.name for file in FILES}
    assert [block for block in blocks(ROOT / "README.md") if block.language == "python"]


@every_file
def test_every_block_says_what_language_it_is_in(file: Path) -> None:
    strange = [
        (block.line, block.language) for block in blocks(file) if block.language not in {"python", *PROSE, *SHELL}
    ]
    assert strange == []


@every_file
def test_the_python_of_a_page_runs_from_top_to_bottom(file: Path, tmp_path: Path) -> None:
    parts = [block for block in blocks(file) if block.language == "python"]
    if not parts:
        pytest.skip(f"{file.name} has no Python in it")
    if file.name == "rerun.md":
        pytest.importorskip("rerun_notebook", reason="Rerun is not installed: pip install 'robowidgets[rerun]'")
    run = [PATIENT, _CELLS]
    for block in parts:
        shows = int(bool(_SHOWS.search(block.text)))
        if file.name == "README.md":  # to paste its first cells, a reader needs all files that they use
            shows = max(shows, len(_WIDGET.findall(block.text)))
        run.append(f"run({block.text!r}, {f'{file}:{block.line}'!r}, {shows})")
    script = tmp_path / "page.py"
    script.write_text("\n".join(run), encoding="utf-8")
    ended = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr


def test_every_name_of_a_page_is_there_with_robowidgets_alone() -> None:
    pages = [ROOT / "README.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("notebooks/**/*.ipynb")]
    names = sorted({name for page in pages for name in _NAME.findall(page.read_text(encoding="utf-8"))})
    assert "robowidgets.fleet.doctor" in names
    ended = subprocess.run([sys.executable, "-c", _EACH_NAME, *names], capture_output=True, text=True, check=False)
    assert (ended.stdout, ended.stderr) == ("", "")


@every_file
def test_every_command_of_a_page_works(file: Path) -> None:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for command in commands(file):
        words = shlex.split(command, comments=True)
        if any(words[: len(known.split())] == known.split() for known in ELSEWHERE):
            continue
        if words[0] == "make":  # a run within a run would never end: the targets exist, and know how they are made
            words.insert(1, "--dry-run")
        ended = subprocess.run(
            words,
            cwd=ROOT,
            env=os.environ | {"PATH": path},
            capture_output=True,
            text=True,
            check=False,
        )
        assert ended.returncode == 0, f"{command}\n{ended.stdout}{ended.stderr}"


def test_the_demo_installs_nothing_that_only_developers_need() -> None:
    rules = ["make", "--dry-run", "--always-make"]
    demo, tests = (
        subprocess.run([*rules, target], cwd=ROOT, capture_output=True, text=True, check=True).stdout
        for target in ("demo", "test-unit")
    )
    assert ["--group js" in demo, "--group dev" in demo] == [True, False]
    assert "--group dev" in tests


@every_file
def test_every_link_to_a_file_leads_to_one(file: Path) -> None:
    links = [link[1] or link[2] for link in _LINK.finditer(file.read_text(encoding="utf-8"))]
    lost = [link for link in links if "://" not in link and not (file.parent / link).exists()]
    assert lost == []


@every_file
def test_every_link_to_a_section_leads_to_one(file: Path) -> None:
    lost = []
    for target, section in _SECTION_LINK.findall(file.read_text(encoding="utf-8")):
        if "://" not in target and section not in sections(file.parent / target if target else file):
            lost.append(f"{target}#{section}")
    assert lost == []


def sections(file: Path) -> set[str]:
    """The names by which links reach the headings of a page."""
    headings = _HEADING.findall(file.read_text(encoding="utf-8"))
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_every_path_in_the_map_of_the_code_is_there() -> None:
    paths = set(_PATH.findall((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"))) - MADE_BY_TESTS
    assert len(paths) > 20
    assert [path for path in sorted(paths) if not any(ROOT.glob(path))] == []


def test_the_site_leads_to_every_page_of_the_documentation() -> None:
    config = (ROOT / "scripts" / "zensical.toml").read_text("utf-8")
    pages = {str(path.relative_to(ROOT / "docs")) for path in ROOT.glob("docs/**/*.md")} - {"README.md"}
    assert sorted(pages - set(re.findall(r'"([^"]+\.md)"', config))) == []


def test_what_assistants_read_is_made_from_the_index_of_the_docs() -> None:
    made = runpy.run_path(str(ROOT / "scripts" / "for_assistants.py"))["FILES"]
    assert len(made) == 2
    for path, text in made.items():
        assert path.read_text(encoding="utf-8") == text(), f"{path.name}: run python scripts/for_assistants.py"
        local = re.findall(r"\]\((docs/[^)#]+)", text())
        assert [link for link in local if not (ROOT / link).exists()] == []


def test_the_page_on_a_new_sensor_shows_the_code_that_the_tests_build() -> None:
    shown = [block.text for block in blocks(ROOT / "docs" / "developers" / "new_sensor.md")]
    package = ROOT / "tests" / "gas_sensor"
    names = ("pyproject.toml", *(f"gas_sensor/{name}.py" for name in ("samples", "row", "gas_widget")))
    for name in (*names, "js/gas_widget.ts", "js/gas_widget.css"):
        assert (package / name).read_text("utf-8") in shown, name

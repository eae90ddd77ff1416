"""Examples of distances in the documentation and the notebooks, run with all values that scanners send."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

from .conftest import ROOT
from .odd_ranges import MET, ODD, odd_ranges
from .test_docs import FILES, blocks
from .test_notebooks import NOTEBOOKS, read

DRIVES = {"feeds.md", "drive.md", "feeds.ipynb", "drive_widget.ipynb"}
"""Examples that drive a live robot: their loops would never end if they never saw a wall."""

DURATION = 20.0
"""Seconds of the recording in which scans are odd: examples read single moments of it, or all of it."""

RUN = """
import linecache, os, sys, time
import robowidgets.behaviors.simulation as simulation
import robowidgets.screens.player as player
import robowidgets.samples.scan as scan
from pathlib import Path
from IPython.display import display
from tests.odd_ranges import MET, ODD, odd_ranges

sleep, floats = time.sleep, scan.floats
time.sleep = lambda seconds: sleep(min(seconds, 0.001))
# What takes long and asks for no distance: the picture above each player, and the end of the tasks' drives.
player.whole_drive = lambda *arguments, **named: (None, "")
simulate = simulation.simulate
simulation.simulate = lambda program, robot, seconds: simulate(program, robot, min(seconds, 3.0))

def odd_floats(name, values):
    array = floats(name, values)
    return floats(name, odd_ranges(ODD[odd], array)) if name == "ranges" else array

scan.floats = odd_floats

parts = []
for i, text in enumerate(texts):
    name = f"{page}, part {i + 1}"
    linecache.cache[name] = len(text), None, text.splitlines(keepends=True), name  # as a notebook does for its cells
    parts.append(compile(text, name, "exec"))

for i, odd in enumerate(MET):
    robowidgets.SAMPLE = Path(sys.argv[1], f"{i}.mcap")
    names = {"__name__": "__main__", "display": display}
    print("with", odd, file=sys.stderr)
    os.mkdir(str(i))  # for what examples write
    os.chdir(str(i))
    for part in parts:
        exec(part, names)
    os.chdir("..")
"""


def sources() -> dict[str, list[str]]:
    """The Python of each page and notebook that uses distances."""
    pages: dict[str, list[str]] = {}
    for file in FILES:
        pages.setdefault(file.name, []).extend(b.text for b in blocks(file) if b.language == "python")
    for file in NOTEBOOKS:
        pages[file.name] = [cell.source for cell in read(file).cells if cell.cell_type == "code"]
    uses = re.compile(r"distance|nearest|\branges\b")
    return {name: page for name, page in pages.items() if uses.search("".join(page)) and name not in DRIVES}


SOURCES = sources()


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the sample as each kind of scanner would have recorded it, by number."""
    folder = tmp_path_factory.mktemp("odd")
    spec = spec_from_file_location("make_sample", ROOT / "scripts" / "make_sample.py")
    assert spec
    assert spec.loader
    script = module_from_spec(spec)
    spec.loader.exec_module(script)
    script.DURATION = DURATION
    drive = list(script.drive())
    scans = {time_ns: message.ranges for topic, time_ns, message in drive if topic == "/scan"}
    script.drive = lambda: iter(drive)
    for i, values in enumerate(ODD[odd] for odd in MET):
        for topic, time_ns, message in drive:
            if topic == "/scan":
                message.ranges = odd_ranges(values, scans[time_ns])
        script.main(folder / f"{i}.mcap")
    return folder


def test_the_pages_that_use_distances_are_found() -> None:
    assert {"README.md", "laser.md", "columns.md", "find.ipynb", "laser_widget.ipynb", "tour.ipynb"} <= set(SOURCES)


@pytest.mark.parametrize("name", SOURCES)
def test_every_example_runs_on_any_scan(name: str, recordings: Path, tmp_path: Path) -> None:
    script = tmp_path / "page.py"
    script.write_text(f"import robowidgets\npage, texts = {name!r}, {SOURCES[name]!r}\n{RUN}", encoding="utf-8")
    ended = subprocess.run(
        [sys.executable, script, recordings], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr

"""The peak memory for a recording and for a recording ten times larger, each in a separate process."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from .stage import ROOT

LIMIT = 64_000_000
"""`Recording.memory` in bytes, less than the size of either recording."""

WORK = {
    "two walks through all scans": "for chunk in (c for _ in range(2) for c in recording.scans().chunks()): pass",
    "`find` by a condition": "recording.find(robowidgets.conditions.nearest_below(0.2))",
    "`scanogram`": "recording.scanogram()",
    "`show`, and the page's player sent all through it": """
from robowidgets.screens._prefetcher import segment
player = recording.show(scanogram=False)
with player._open_tracks() as tracks:
    for second in range(int(recording.duration)):
        segment(tracks, second)
""",
}

SCRIPT = """
import sys, robowidgets
from benchmarks.player_kernel import peak

# What any first use loads.
import anywidget, tqdm.auto
import robowidgets.files, robowidgets.recordings.search.search, robowidgets.screens.player

recording = robowidgets.open(sys.argv[1])
recording.memory = {limit}
before = peak()
{work}
print(peak() - before)
"""


def compare(made: Path, large: Path) -> dict[str, tuple[float, float]]:
    """Return the peak megabytes of each kind of work, on both files."""
    return {name: (peak(made, work), peak(large, work)) for name, work in WORK.items()}


def peak(path: Path, work: str) -> float:
    """Return the peak megabytes of a kind of work."""
    script = SCRIPT.format(limit=LIMIT, work=work)
    run = subprocess.run([sys.executable, "-c", script, path], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    return float(run.stdout)

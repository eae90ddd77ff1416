"""Imports of a lesson with the simulated robot: in a browser each package is fetched, and starts slowly."""

from __future__ import annotations

import subprocess
import sys

import pytest

LESSON = """
import sys
from robowidgets import LaserWidget, feeds, lessons
from robowidgets.behaviors import Drive

laser = LaserWidget()
with feeds.simulator() as feed:
    feed.connect("/scan", laser)

    @feed.program(rate=10)
    def avoid(scan):
        return Drive(0.2) if scan.distance("front") > 0.6 else Drive(0, 0.8)

    assert laser.wait(timeout=60)
assert lessons.check(lambda scan: scan.distance("left"), "nearest_on_the_left")
heavy = {"rosbags", "ruamel", "mcap", "lz4", "zstandard", "backports", "sqlite3", "apsw", "tornado", "loky", "fsspec"}
print(sorted(name for name in sys.modules if name.split(".")[0] in heavy or name.startswith("robowidgets.recordings")))
feeds.recording
print("robowidgets.recordings" in sys.modules)
"""


@pytest.mark.slow
def test_a_lesson_imports_no_reader_of_recordings_and_no_middleware() -> None:
    done = subprocess.run([sys.executable, "-c", LESSON], capture_output=True, text=True, check=False)
    assert (done.stdout.split("\n"), done.stderr) == (["[]", "True", ""], "")

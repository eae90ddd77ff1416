"""Imports of one widget, of a search, and of a lesson with the simulated robot.

A browser fetches each package that they import.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

FIRST_WIDGET = """
import sys
import ipykernel.ipkernel, ipywidgets, numpy, anywidget
before = set(sys.modules)
import robowidgets
print(sorted({name.split(".")[1] for name in set(sys.modules) - before if name.startswith("robowidgets.")}))
robowidgets.LaserWidget().update(ranges=[1.0] * 21, angle_min=-1.0, angle_increment=0.1, range_min=0.1, range_max=10.0)
new = set(sys.modules) - before
print(sorted({name.split(".")[1] for name in new if name.startswith("robowidgets.")}))
print(sorted(new & {"numpy.ma", "difflib", "decimal", "importlib.metadata"}))
"""


def test_a_first_laser_widget_imports_no_other_room_and_nothing_that_drives_or_records() -> None:
    done = subprocess.run([sys.executable, "-c", FIRST_WIDGET], capture_output=True, text=True, check=False)
    assert done.stderr == ""
    package, laser, others = done.stdout.splitlines()
    assert package == "['runtime']"
    assert laser == "['laser', 'laser_widget', 'messages', 'poses', 'runtime', 'samples', 'shapes', 'widget']"
    assert others == "[]"


SEARCH = """
import sys
import robowidgets
from robowidgets import conditions
recording = robowidgets.open(robowidgets.SAMPLE)
assert recording.find(conditions.nearest_below(0.5) | conditions.touched())
print(sorted({"traitlets", "ipywidgets", "anywidget"} & set(sys.modules)))
"""


def test_opening_a_recording_and_searching_it_imports_no_widget() -> None:
    done = subprocess.run([sys.executable, "-c", SEARCH], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("[]\n", "")


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

"""Features that a browser cannot have raise an error with a remedy."""

from __future__ import annotations

import importlib
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from robowidgets import feeds, recordings
from robowidgets.feeds import FeedError
from robowidgets.notebook import in_browser


@pytest.mark.parametrize(
    "open_feed",
    [
        feeds.dds,
        feeds.ros1,
        feeds.ros2,
        lambda: feeds.rosbridge("ws://localhost:9"),
        lambda: feeds.foxglove("ws://localhost:9"),
    ],
    ids=["dds", "ros1", "ros2", "rosbridge", "foxglove"],
)
def test_a_real_robot_is_not_reached(open_feed: Callable[[], object], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(in_browser, "IN_BROWSER", True)
    with pytest.raises(FeedError, match=r"cannot be used in a browser.*no real robot is driven.*feeds\.simulator\(\)"):
        open_feed()


def test_a_robot_has_no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(in_browser, "IN_BROWSER", True)
    with pytest.raises(ValueError, match=r"process: expected False, because Python in a browser starts no processes"):
        feeds.simulator(process=True)


def test_recordings_name_the_package_missing_to_unpack_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(in_browser, "IN_BROWSER", True)
    monkeypatch.setattr(in_browser, "find_spec", lambda _: None)
    spec = importlib.machinery.SourceFileLoader("robowidgets.recordings", str(recordings.__file__))
    with pytest.raises(ImportError, match=r"no lz4 and no zstd.*recording\.to_html\(\)"):
        exec(spec.get_code("robowidgets.recordings") or "", {"__name__": "x", "__package__": "robowidgets.recordings"})


def test_a_site_without_numpy_says_how_to_build_one_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    in_browser.check_numpy()
    monkeypatch.setattr(in_browser, "find_spec", lambda _: None)
    with pytest.raises(ModuleNotFoundError, match=r"needs NumPy.*make site ROBOWIDGETS_PYODIDE_NUMPY=pyodide") as told:
        in_browser.check_numpy()
    assert told.value.name == "numpy"


RECORDINGS = """
import sys

class Absent:  # as Pyodide reports modules that it leaves out of Python
    def find_spec(self, name, path=None, target=None):
        if name in ("apsw", "sqlite3", "_sqlite3", "zstandard"):
            raise ModuleNotFoundError(name)

sys.meta_path.insert(0, Absent())
import robowidgets
from robowidgets.notebook import in_browser

in_browser.IN_BROWSER = True
from robowidgets import conditions

recording = robowidgets.open(robowidgets.SAMPLE)
print(len(recording.find(conditions.touched())), recording.problems)
from pathlib import Path
from robowidgets.files import open_source
from robowidgets.repair.write import write

write(open_source(robowidgets.SAMPLE), Path("copy.mcap"))
print(len(robowidgets.open("copy.mcap").find(conditions.touched())))
Path("drive.db3").write_bytes(b"SQLite format 3\\0" + bytes(200))
try:
    robowidgets.open("drive.db3")
except robowidgets.RecordingError as error:
    print(error)
"""


@pytest.mark.slow
@pytest.mark.versions
def test_recordings_are_read_found_in_and_written_without_databases(tmp_path: Path) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", RECORDINGS], cwd=tmp_path, capture_output=True, text=True, timeout=280, check=False
    )
    assert ended.returncode == 0, ended.stderr
    found, again, error = ended.stdout.splitlines()
    assert found == "6 ()"
    assert again == "6"
    assert error.startswith("drive.db3: a database cannot be opened in a browser, whose Python has no SQLite: expected")

"""Fixtures for the tests of many recordings."""

from __future__ import annotations

from pathlib import Path
from shutil import copy

import pytest

import robowidgets


@pytest.fixture(autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Keep results in a folder of the test's own."""
    folder = tmp_path_factory.mktemp("cache")
    monkeypatch.setenv("ROBOWIDGETS_CACHE", str(folder))
    return folder


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    """A folder with three copies of the sample, one of them deeper, and a file that is not a recording."""
    folder = tmp_path / "runs"
    (folder / "monday").mkdir(parents=True)
    for name in ("run_2.mcap", "run_10.mcap", "monday/run_1.mcap"):
        copy(robowidgets.SAMPLE, folder / name)
    (folder / "broken.bag").write_bytes(b"#ROSBAG V2.0\n")
    return folder

"""Without Rerun installed, everything else works; using it raises an error that names the package to install."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import robowidgets

_SHOW = """
import sys, robowidgets
robowidgets.open(robowidgets.SAMPLE).show().close()
print([name for name in sys.modules if name.split(".")[0] in ("rerun", "rerun_notebook", "rerun_bindings", "pyarrow")])
"""


@pytest.mark.slow
def test_nothing_of_rerun_is_imported_until_it_is_asked_for() -> None:
    ended = subprocess.run([sys.executable, "-c", _SHOW], capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == "[]"


def test_without_it_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    told = r"Rerun is not installed here \(.*rerun.*\): pip install 'robowidgets\[rerun\]', with Python 3\.11 or later"
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        with pytest.raises(ImportError, match=told):
            recording.to_rerun(tmp_path / "drive.rrd")
        with pytest.raises(ImportError, match=told):
            recording.to_rerun()
        with pytest.raises(ImportError, match=told):
            recording.show(rerun=True)
    assert not list(tmp_path.iterdir())


def test_without_its_part_for_notebooks_files_can_still_be_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("rerun", reason="Rerun is not installed: pip install 'robowidgets[rerun]'")
    from robowidgets.in_rerun.widget import _viewer

    monkeypatch.setitem(sys.modules, "rerun_notebook", None)
    _viewer.cache_clear()
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        with pytest.raises(ImportError, match=r"rerun_notebook.*pip install 'robowidgets\[rerun\]'"):
            recording.to_rerun()
        assert recording.to_rerun(tmp_path / "drive.rrd", "/bumper").is_file()


@pytest.mark.parametrize("version", ["0.20.1", None])
def test_an_old_one_and_another_package_of_that_name_are_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, version: str | None
) -> None:
    old = ModuleType("rerun")
    if version:
        old.__version__ = version  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "rerun", old)
    told = version or "another package of that name"
    with (
        robowidgets.open(robowidgets.SAMPLE) as recording,
        pytest.raises(ImportError, match=rf"rerun-sdk 0\.41 or later is needed, but {told} is installed: pip"),
    ):
        recording.to_rerun(tmp_path / "drive.rrd")

"""Files that are written completely or not at all, and the remains of killed processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from robowidgets.runtime.output_file import checked_output, whole_file

KILLED = """
import os, pathlib, signal, sys
from robowidgets.runtime.output_file import whole_file
with whole_file(pathlib.Path(sys.argv[1])) as file:
    file.write(b"half")
    file.flush()
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.slow
def test_what_a_killed_process_left_is_removed_by_the_next_attempt(tmp_path: Path) -> None:
    path = tmp_path / "drive [1].html"
    killed = subprocess.run([sys.executable, "-c", KILLED, str(path)], check=False)
    assert killed.returncode == -signal.SIGKILL
    (left,) = tmp_path.iterdir()
    assert left.suffix == ".part"
    with whole_file(path) as file:
        file.write(b"whole")
    assert [(entry.name, entry.read_bytes()) for entry in tmp_path.iterdir()] == [(path.name, b"whole")]


def test_what_other_processes_write_stays_and_so_do_other_files(tmp_path: Path) -> None:
    others = [f"drive.html.{os.getppid()}.part", "drive.html.part", "other.html.999999999.part", "drive.html.x.part"]
    for name in others:
        (tmp_path / name).touch()
    (tmp_path / "drive.html.999999999.part").touch()  # Linux has no process of this number
    with whole_file(tmp_path / "drive.html") as file:
        file.write(b"whole")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == sorted([*others, "drive.html"])


def test_on_windows_no_process_gets_a_signal_and_a_part_that_is_open_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def kill(process: int, number: int) -> None:
        raise AssertionError(f"signal {number} for process {process}")

    def unlink(file: Path, missing_ok: bool = False) -> None:
        if file.name == "drive.html.7.part":
            raise PermissionError(13, "The process cannot access the file because it is being used by another process")
        removed(file, missing_ok)

    removed = Path.unlink
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setattr(os, "kill", kill)
    monkeypatch.setattr(Path, "unlink", unlink)
    for process in (7, 8):
        (tmp_path / f"drive.html.{process}.part").touch()
    with whole_file(tmp_path / "drive.html") as file:
        file.write(b"whole")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["drive.html", "drive.html.7.part"]


def test_a_link_to_itself_is_a_name_like_others(tmp_path: Path) -> None:
    path = tmp_path / "loop.html"
    path.symlink_to(path)
    with whole_file(checked_output("to_html", path, (".html",))) as file:
        file.write(b"whole")
    assert path.read_bytes() == b"whole"

"""Marks: forged claims, replaced code, written files and early exits earn nothing; each is named in the report."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from robowidgets import lessons
from robowidgets.command import main
from robowidgets.lessons import _grading
from robowidgets.lessons._progress import FILE, TASKS, Task, write

from ...conftest import ROOT
from ..pages import display_html

pytestmark = pytest.mark.slow

LEFT = 'def nearest_on_the_left(scan):\n    return scan.distance("left")'
LEFT_CHECK = "result = lessons.check(nearest_on_the_left)\nassert result, result"
START = "from robowidgets import feeds, lessons\nfrom robowidgets.behaviors import Drive\n\nlessons.progress()"
AHEAD = 'def wall_ahead(scan):\n    return scan.distance(("-20deg", "20deg"))\n\n\nresult = lessons.check(wall_ahead)'
STOP = (
    "@robot.program\ndef drive(scan):\n    return Drive(0.2) if wall_ahead(scan) > 0.5 else Drive()\n\n\n"
    'result = lessons.check(drive, "stop_before_wall")'
)
STATES = (
    "@robot.program\nclass Walker:\n    near = lambda scan: not wall_ahead(scan) > 0.5\n\n"
    "    def forward():\n        return Drive(0.2)\n\n    def at_wall():\n        return Drive()\n\n"
    '    moves = "forward -> at_wall on near"\n\n\nresult = lessons.check(Walker, "stop_before_wall")'
)
FORGED = (
    "import robowidgets.lessons as lessons, robowidgets.lessons._check as its, builtins\n"
    "lessons.check = lambda *a, **k: True\nits.judged = lessons.check\nits.WrongError = None"
)
CLAIMS = {task: Task(tries=1, done=True, right=5, cases=5) for task in TASKS[:5]}


def hand_in(file: Path, *cells: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    made = [{"cell_type": "code", "id": f"c{i}", "metadata": {}, "source": cell} for i, cell in enumerate(cells)]
    file.write_text(json.dumps({"cells": made, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}), encoding="utf-8")


def function(name: str, body: str) -> str:
    return f"def {name}(scan):\n    {body}\n\n\nresult = lessons.check({name})"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The submissions of a class, with all possible faults, and their grades."""
    root = tmp_path_factory.mktemp("submitted")
    hand_in(root / "ada/lesson/a.ipynb", START, LEFT, LEFT_CHECK, "robot = feeds.simulator()", AHEAD, STOP, STATES)
    hand_in(root / "forger/f.ipynb", FORGED, function("nearest_on_the_left", f"exec({FORGED!r})\n    return 1.0"))
    hand_in(root / "claims/c.ipynb", START, LEFT)  # without the cell that checks it
    write(root / "claims" / FILE, CLAIMS)
    (root / "empty").mkdir()
    (root / "empty/e.ipynb").touch()
    hand_in(root / "torn/t.ipynb", START, LEFT, LEFT_CHECK)
    (root / "torn/t.ipynb").write_text((root / "torn/t.ipynb").read_text("utf-8")[:-30], "utf-8")
    (root / "nothing").mkdir()
    killed = function("nearest_on_the_left", "import os; os.kill(os.getpid(), 9)")
    hand_in(root / "killer/k.ipynb", killed, AHEAD)
    left = function("nearest_on_the_left", "import os; os._exit(0)")
    hand_in(root / "leaver/l.ipynb", left, function("fits_through", "while True: pass"), AHEAD)
    odd = function("nearest_on_the_left", "return type('Odd', (), {'__float__': lambda s: 1 / 0, '__repr__': None})()")
    hand_in(
        root / "odd/o.ipynb", odd, function("fits_through", "raise SystemExit"), function("wall_ahead", "return '1'")
    )
    write(root / "report.json", {**CLAIMS, "nearest_on_the_left": Task(done=True, answer=f"{LEFT}\n\n\n{LEFT_CHECK}")})
    _grading.write_grades(root, _grading.mark(root, seconds=3.0))
    return root


def done(tasks: Mapping[str, Task]) -> list[str]:
    return [task for task, row in tasks.items() if row.done]


def test_each_submission_has_the_marks_of_its_answers_and_each_is_named_with_what_was_wrong(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = lessons.summary(folder)
    assert found.is_graded
    marks = {name: done(tasks) for name, tasks in found.students.items()}
    assert marks == {
        "ada": ["nearest_on_the_left", "wall_ahead", "stop_before_wall", "stop_before_wall as states"],
        "claims": [],
        "empty": [],
        "forger": [],
        "killer": ["wall_ahead"],
        "leaver": ["wall_ahead"],
        "nothing": [],
        "odd": [],
        "report": ["nearest_on_the_left"],
        "torn": [],
    }
    wrong = {name: [row.wrong for row in tasks.values() if not row.done] for name, tasks in found.students.items()}
    assert "you returned 1; it is " in wrong["forger"][0]
    assert "its process ended: an answer ended its process (SIGKILL)" in wrong["killer"][0]
    assert "(code 0)" in wrong["leaver"][0]
    assert "a step has not returned for 3 s, and was ended" in wrong["leaver"][1]
    assert ["expected a number" in wrong["odd"][0], "SystemExit" in wrong["odd"][1]] == [True, True]
    assert "it returned '1': expected a number" in wrong["odd"][2]
    assert {problem.split(": ")[0]: problem.split(": ", 1)[1] for problem in found.problems} == {
        "claims": "c.ipynb: it has no answer to a task",
        "empty": "e.ipynb: it is empty",
        "killer": "k.ipynb: an answer ended its process (SIGKILL)",
        "leaver": "l.ipynb: an answer ended its process (code 0)",
        "nothing": "the folder contains neither a notebook nor a report",
        "torn": next(problem for problem in found.problems if "torn" in problem).split(": ", 1)[1],
    }
    assert any(problem.startswith("torn: t.ipynb: it is damaged: JSONDecodeError") for problem in found.problems)
    assert main(["lessons", "--summary", str(folder)]) == 1
    said = capsys.readouterr().out
    assert "✓  done;  ✗  wrong" in said
    assert "Not graded" not in said
    hand_in(folder / "late/l.ipynb", START, LEFT, LEFT_CHECK)
    try:
        assert "late: not graded yet: robowidgets lessons --grade" in "".join(lessons.summary(folder).problems)
    finally:
        (folder / "late/l.ipynb").unlink()
        (folder / "late").rmdir()


def test_before_the_grading_claims_are_shown_as_claims_and_what_is_empty_or_damaged_is_named(tmp_path: Path) -> None:
    hand_in(tmp_path / "ada/a.ipynb", START, LEFT)
    write(tmp_path / "ada" / FILE, CLAIMS)
    (tmp_path / "bo").mkdir()
    (tmp_path / "bo/b.ipynb").touch()
    found = lessons.summary(tmp_path)
    assert not found.is_graded
    assert "✓?" in repr(found)
    assert "✓ " not in repr(found)
    assert "Not graded: this is what the students' computers wrote" in repr(found)
    assert 'class="rw-yes"' not in display_html(found)
    assert found.problems == (f"{Path('bo/b.ipynb')}: it is empty",)


def test_the_command_marks_a_folder_and_refuses_one_that_is_not_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    hand_in(tmp_path / "ada/a.ipynb", START, LEFT, LEFT_CHECK)
    (tmp_path / "types.py").write_text("raise SystemExit(9)", "utf-8")  # is not a module of the grader
    monkeypatch.chdir(tmp_path)
    assert main(["lessons", "--grade", "."]) == 0
    assert "ada: 1 of 12 right" in capsys.readouterr().out
    assert (tmp_path / "summary.html").exists()
    (tmp_path / _grading.GRADES).write_text("{}", "utf-8")
    assert main(["lessons", "--summary", "."]) == 1
    assert "is damaged" in capsys.readouterr().err
    assert main(["lessons", "--grade", "none"]) == 1
    assert "'none' is not a folder" in capsys.readouterr().err
    assert main(["lessons", "--summary", ".", "--user", "nobody"]) == 1
    assert "use it with --grade" in capsys.readouterr().err


def can_be_nobody() -> str:
    """The reason why answers cannot run here as a user without rights, or an empty text."""
    if not hasattr(os, "geteuid") or os.geteuid() != 0:
        return "only root may run answers as another user"
    import pwd

    return "" if any(one.pw_name == "nobody" for one in pwd.getpwall()) else "this system has no user nobody"


def recipe() -> list[str]:
    """The command of the documentation for Linux, as root runs it."""
    line = next(line for line in (ROOT / "docs" / "teach.md").read_text("utf-8").splitlines() if "unshare" in line)
    return line.removeprefix("sudo ").split()


def test_the_recipe_of_the_documentation_takes_rights_and_network_away(tmp_path: Path) -> None:
    if why := can_be_nobody():
        pytest.skip(why)
    command = recipe()
    own = command.index("robowidgets")
    if shutil.which("unshare") is None or subprocess.run([*command[:own], "true"], check=False).returncode:
        pytest.skip("namespaces cannot be made here")
    body = "import socket; socket.socket().connect((b'127.0.0.1', 9))"
    hand_in(tmp_path / "submitted/ada/a.ipynb", function("nearest_on_the_left", body), AHEAD)
    (tmp_path / "submitted").chmod(0o700)
    command[own : own + 1] = [sys.executable, "-m", "robowidgets"]
    done = subprocess.run(
        command, cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False
    )
    assert "ada: 1 of 12 right" in done.stdout, done.stderr
    ((wrong, right),) = [_grading.read_grades(tmp_path / "submitted")["ada"].tasks.values()]  # type: ignore[index]
    assert "unreachable" in wrong.wrong
    assert right.done


def test_a_user_without_rights_reads_and_writes_nothing_of_the_grader(tmp_path: Path) -> None:
    if why := can_be_nobody():
        pytest.skip(why)
    secret, target = tmp_path / "secret.txt", tmp_path / "written.txt"
    secret.write_text("the marks", "utf-8")
    secret.chmod(0o600)
    tries: dict[str, Any] = {
        "nearest_on_the_left": f"return open({str(secret)!r}).read()",
        "wall_ahead": f"open({str(target)!r}, 'w').write('mine')",
        "fits_through": f"import os; os.kill({os.getpid()}, 0); return True",
    }
    hand_in(tmp_path / "ada/a.ipynb", *(function(name, body) for name, body in tries.items()))
    grades = _grading.mark(tmp_path, user="nobody")
    assert "PermissionError" in grades["ada"].tasks["nearest_on_the_left"].wrong
    assert "PermissionError" in grades["ada"].tasks["wall_ahead"].wrong
    assert "PermissionError" in grades["ada"].tasks["fits_through"].wrong
    assert not target.exists()
    assert secret.read_text("utf-8") == "the marks"

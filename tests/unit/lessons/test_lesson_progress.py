"""The progress of a student: saved next to the notebook, shown in a line, handed in, and summed up for a class."""

from __future__ import annotations

import errno
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from robowidgets import Touch, lessons
from robowidgets.command import main
from robowidgets.lessons import _progress, _texts
from robowidgets.lessons._progress import FILE, TASKS, ReportError, Task, fingerprint, read, write

from ...conftest import ROOT
from ..pages import display, display_html


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder of a notebook without any progress."""
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    _progress.forget()
    _texts.speak("en")


def bumper_reflex(touch: Touch) -> tuple[float, float]:
    touched = touch.touched
    if None in touched.values():
        return 0.0, 0.0
    if any(touched.values()):
        return -0.2, -1.0 if touched["left"] else 1.0
    return 0.3, 0.0


def wrong(turn: int) -> object:
    """A different wrong answer for each number, as a cell of a notebook defines it."""
    import linecache

    source = f"def bumper_reflex(touch):\n    return 0.3, {turn}\n\n\nresult = lessons.check(bumper_reflex)\nresult"
    linecache.cache[f"<cell {turn}>"] = (len(source), None, source.splitlines(keepends=True), f"<cell {turn}>")
    names: dict[str, object] = {"lessons": lessons}
    exec(compile(source, f"<cell {turn}>", "exec"), names)
    return names["result"]


class TestProgress:
    def test_checks_keep_nothing_before_it_is_asked_for_and_then_its_line_follows_them(self, folder: Path) -> None:
        lessons.check(bumper_reflex)
        assert list(folder.iterdir()) == []
        progress = lessons.progress()
        line = progress._line
        assert repr(progress) == "0 of 12 done"
        wrong(1)
        assert repr(progress) == "0 of 12 done"
        lessons.check(bumper_reflex)
        assert repr(progress) == "1 of 12 done"
        assert "<b>1 of 12 done</b>" in line.value
        assert progress.done == ("bumper_reflex",)
        assert "application/vnd.jupyter.widget-view+json" in display(progress)
        assert repr(lessons.progress()) == "1 of 12 done"  # from a kernel that restarts

    def test_tries_are_different_answers_until_one_is_right_which_stays(self) -> None:
        lessons.progress()
        for turn in (1, 1, 2, 3):
            wrong(turn)
        kept = read(Path(FILE))["bumper_reflex"]
        assert (kept.tries, kept.done, kept.right, kept.cases) == (3, False, 0, 11)
        assert kept.fault == "you returned {linear:g} m/s and {turn:g} rad/s; {wrong}"
        assert kept.wrong.startswith("nothing touched: you returned 0.3 m/s and 3 rad/s; nothing is touched:")
        assert kept.answer.startswith("def bumper_reflex(touch):\n    return 0.3, 3\n")
        lessons.check(bumper_reflex)
        right = read(Path(FILE))["bumper_reflex"]
        assert (right.tries, right.done, right.right, right.wrong) == (4, True, 11, "")
        wrong(4)
        assert read(Path(FILE))["bumper_reflex"] == right

    def test_the_answers_that_the_lessons_give_are_not_attempts(self) -> None:
        given = set()
        for name in ("from_picture_to_code", "from_code_to_behavior"):
            for cell in json.loads((ROOT / "notebooks" / f"{name}.ipynb").read_text("utf-8"))["cells"]:
                if re.fullmatch(r"task-\d", cell["id"]):
                    given.add(fingerprint("".join(cell["source"])))
        assert given == _progress.GIVEN, "put these into GIVEN: " + " ".join(sorted(given))
        assert len(given) == len(TASKS)
        assert fingerprint("def f():  # ein\n    return 1\n\nresult = 2") == fingerprint("def f():\n  return 1  # a")
        assert fingerprint("def f():\n    return 2") != fingerprint("def f():\n    return 1")

    def test_a_right_answer_is_kept_though_another_task_gives_it(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(_progress, "fingerprint", lambda _cell: next(iter(_progress.GIVEN)))
        progress = lessons.progress()
        wrong(1)
        assert not Path(FILE).exists()
        lessons.check(bumper_reflex)
        assert progress.done == ("bumper_reflex",)

    def test_a_damaged_file_is_reported_kept_aside_and_replaced(self, folder: Path) -> None:
        (folder / FILE).write_text('{"kind": "robowidgets les', encoding="utf-8")
        progress = lessons.progress()
        assert repr(progress).startswith(f"0 of 12 done. {FILE} is damaged: ")
        lessons.check(bumper_reflex)
        assert progress.done == ("bumper_reflex",)
        (folder / FILE).write_text("[]", encoding="utf-8")
        assert "It was renamed to robowidgets-progress.damaged2.json" in repr(lessons.progress())
        assert (folder / "robowidgets-progress.damaged.json").read_text("utf-8").endswith(" les")
        assert (folder / "robowidgets-progress.damaged2.json").read_text("utf-8") == "[]"

    def test_where_nothing_can_be_written_the_check_works_and_the_line_says_so(self, folder: Path) -> None:
        progress = lessons.progress()
        (folder / f".{FILE}.{os.getpid()}.part").mkdir()
        assert lessons.check(bumper_reflex)
        assert "It cannot be saved: " in repr(progress)

    def test_a_file_that_cannot_be_read_for_a_moment_stays_as_it_is(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def away(_file: Path) -> None:
            raise OSError(errno.ESTALE, "Stale file handle")

        progress = lessons.progress()
        lessons.check(bumper_reflex)
        before = read(folder / FILE)
        with monkeypatch.context() as patched:
            patched.setattr(_progress, "read", away)
            lessons.check(bumper_reflex)
            assert repr(progress).startswith("1 of 12 done. It cannot be saved: ")
            with pytest.raises(OSError, match="Stale file handle"):
                lessons.report("ada.json")
        assert [file.name for file in folder.iterdir()] == [FILE]
        assert read(folder / FILE) == before
        lessons.check(bumper_reflex)
        assert repr(progress) == "1 of 12 done"

    def test_where_nbgrader_grades_what_the_students_file_claims_does_not_count(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setenv("NBGRADER_EXECUTION", "autograde")
        for cell in ("", next(iter(_progress.GIVEN))):
            monkeypatch.setattr(_progress, "fingerprint", lambda _cell, cell=cell: cell)
            write(Path(FILE), {"bumper_reflex": Task(tries=3, done=True)})
            progress = lessons.progress()
            wrong(1)
            assert progress.done == ()
        lessons.check(bumper_reflex)
        assert progress.done == ("bumper_reflex",)

    def test_a_program_and_a_state_machine_are_two_tasks(self) -> None:
        class Stands:
            def still() -> None:  # type: ignore[misc]
                pass

            moves = "still -> still after 1"

        lessons.progress()
        lessons.check(Stands, "stop_before_wall")
        lessons.check(lambda: None, "stop_before_wall")
        assert set(read(Path(FILE))) == {"stop_before_wall", "stop_before_wall as states"}


class TestReport:
    def test_it_is_what_was_kept_under_the_name_of_the_student(self, folder: Path) -> None:
        lessons.progress()
        lessons.check(bumper_reflex)
        assert lessons.report("ada.json") == "ada.json: 1 of 12 done. Hand in this file"
        assert read(folder / "ada.json") == read(folder / FILE)
        assert lessons.report("ada.json")  # again, over the previous report
        for name in ("ada", "ada.txt", FILE):
            with pytest.raises(ValueError, match="expected a file name with your name"):
                lessons.report(name)
        (folder / "mine.json").write_text('{"front": 1}', encoding="utf-8")
        with pytest.raises(FileExistsError, match="another file and was not changed"):
            lessons.report("mine.json")
        assert (folder / "mine.json").read_text("utf-8") == '{"front": 1}'

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("", "is damaged: Expecting value"),
            ("[" * 100_000, "is damaged"),
            ('{"kind": "x"}', "is not a report of the lessons"),
            ('{"kind": "robowidgets lessons", "version": 2}', "has version 2"),
            ('{"kind": "robowidgets lessons", "version": 1}', "it has no tasks"),
            ('{"kind": "robowidgets lessons", "version": 1, "tasks": {"x": {}}}', "an unknown task: 'x'"),
            ('{"kind": "robowidgets lessons", "version": 1, "tasks": {"wall_ahead": 3}}', "is damaged at wall_ahead"),
            (
                '{"kind": "robowidgets lessons", "version": 1, "tasks": {"wall_ahead": {"done": "yes"}}}',
                "is damaged at wall_ahead: done is 'yes'",
            ),
            (
                '{"kind": "robowidgets lessons", "version": 1, "tasks": {"wall_ahead": {"tries": -1}}}',
                "is damaged at wall_ahead: tries is -1",
            ),
            (" " * 1_000_001, "is too large for a report: 1.0 MB"),
        ],
    )
    def test_a_damaged_or_invalid_report_is_refused_with_the_reason(self, folder: Path, text: str, said: str) -> None:
        (folder / "ada.json").write_text(text, encoding="utf-8")
        with pytest.raises(ReportError, match=re.escape(said)):
            read(folder / "ada.json")

    def test_a_report_needs_a_name(self) -> None:
        with pytest.raises(TypeError, match=r"report: expected a file name .* 'ada\.json', got None"):
            lessons.report(None)  # type: ignore[arg-type]

    @pytest.mark.usefixtures("folder")
    def test_a_report_needs_a_folder_that_exists(self) -> None:
        with pytest.raises(FileNotFoundError, match=r"^report: the folder 'mine' does not exist; make it"):
            lessons.report("mine/ada.json")


class TestSummary:
    def hand_in(self, folder: Path) -> None:
        stuck = Task(
            tries=4,
            fault="drive closer by {way:.1f} m",
            wrong="<b>drive closer</b>",
            answer="</pre><script>alert(1)</script>",
        )
        write(folder / "ada.json", {"fits_through": Task(done=True, tries=2), "wall_ahead": Task(done=True)})
        write(folder / "\x1b[2J<i>bo.json", {"fits_through": stuck, "wall_ahead": Task(tries=1)})
        for name in ("cy", "di"):
            (folder / name / "lesson").mkdir(parents=True)
            write(folder / name / "lesson" / FILE, {"fits_through": stuck})
        (folder / "cy" / "second").mkdir()
        write(folder / "cy" / "second" / FILE, {"fits_through": Task(done=True), "wall_ahead": stuck})
        (folder / "torn.json").write_text('{"kind"', encoding="utf-8")

    def test_a_class_is_seen_at_a_glance_as_a_table(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self.hand_in(folder)
        assert main(["lessons", "--summary", str(folder)]) == 1
        said = capsys.readouterr().out
        rows = {line.split()[0]: line.split()[1:] for line in said.splitlines() if line.strip()}
        assert rows["ada"] == ["·", "✓?", *"···", "✓?", *"······", "2"]
        assert rows["cy"] == ["·", "✓?", *"···", "4", *"······", "1"]  # from both of its folders
        assert "2 stuck at fits_through: �[2J<i>bo, di\n  2 ×  drive closer by … m" in said
        assert "not read: torn.json is damaged: " in said
        assert "\x1b" not in said
        with pytest.raises(NotADirectoryError, match="'none' is not a folder"):
            lessons.summary("none")

    def test_its_page_shows_texts_of_students_as_text(self, folder: Path) -> None:
        self.hand_in(folder)
        found = lessons.summary(folder)
        found.to_html(folder / "page.html")
        page = (folder / "page.html").read_text("utf-8")
        assert "<script" not in page
        assert "&lt;/pre&gt;&lt;script&gt;" in page
        assert "&lt;i&gt;bo" in page
        assert "default-src 'none'" in page
        assert display_html(found) in page

    def test_reports_of_the_same_name_are_distinguished_by_their_folders(self, folder: Path) -> None:
        for name in ("ada", "bo"):
            (folder / name).mkdir()
            write(folder / name / "report.json", {})
        assert list(lessons.summary(folder).students) == ["ada/report", "bo/report"]

    def test_reports_of_the_same_name_below_one_folder_are_of_two_students(self, folder: Path) -> None:
        for name in ("Ada", "Bo"):
            (folder / "7a" / name).mkdir(parents=True)
            write(folder / "7a" / name / "your-name.json", {})
        assert list(lessons.summary(folder).students) == ["7a/Ada/your-name", "7a/Bo/your-name"]

    def test_a_file_next_to_the_only_report_belongs_to_the_same_student(self, folder: Path) -> None:
        for name in ("ada", "both"):
            (folder / name).mkdir()
            write(folder / name / FILE, {"fits_through": Task(done=True)})
        for file in ("ada/ada lovelace", "both/bo", "both/cy"):
            write(folder / f"{file}.json", {"fits_through": Task(done=True), "wall_ahead": Task(tries=1)})
        found = lessons.summary(folder)
        assert {name: len(tasks) for name, tasks in found.students.items()} == {
            "ada lovelace": 2,
            "bo": 2,
            "both": 1,
            "cy": 2,
        }

    def test_names_and_answers_that_are_not_unicode_are_shown_with_codes(
        self, folder: Path, capsysbinary: pytest.CaptureFixture[bytes]
    ) -> None:
        write(folder / "bo.json", {"fits_through": Task(tries=3, answer="a\ud800", wrong="\udfff")})
        write(folder / "x.json", {"fits_through": Task(done=True)})
        if sys.platform == "linux":
            os.rename(folder / "x.json", os.fsencode(folder) + b"/J\xfcrgen.json")
            os.mkdir(os.fsencode(folder) + b"/J\xf6rg")
            Path(os.fsdecode(os.fsencode(folder) + b"/J\xf6rg/lesson.ipynb")).write_text('{"cells": []}', "utf-8")
            Path(os.fsdecode(os.fsencode(folder) + b"/J\xf6rg.json")).write_text("torn", "utf-8")
        assert main(["lessons", "--summary", str(folder)]) == (sys.platform == "linux")
        page, said = (folder / "summary.html").read_text("utf-8"), capsysbinary.readouterr().out.decode()
        assert "<pre>a\\ud800</pre>" in page
        if sys.platform == "linux":
            for shown in (page, said):
                assert "J\\udcfcrgen" in shown
                assert "J\\udcf6rg" in shown
                assert "J\\udcf6rg.json is damaged: " in shown

    def test_the_table_goes_into_a_file_whose_encoding_lacks_the_marks_and_the_page_has_them(
        self, folder: Path
    ) -> None:
        self.hand_in(folder)
        done = subprocess.run(
            [sys.executable, "-m", "robowidgets", "lessons", "--summary", str(folder)],
            env={**os.environ, "PYTHONIOENCODING": "cp1252", "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            check=False,
        )
        assert (done.returncode, done.stderr) == (1, b"")
        assert "??  done;" in done.stdout.decode("cp1252")
        assert "✓" in (folder / "summary.html").read_text("utf-8")

    def test_a_folder_with_only_notebooks_counts_as_a_student_without_answers(self, folder: Path) -> None:
        for name in ("ada", "bo", "cy", ".ipynb_checkpoints"):
            (folder / name / "lesson").mkdir(parents=True)
            (folder / name / "lesson" / "lesson.ipynb").write_text('{"cells": []}', encoding="utf-8")
        (folder / "mine.ipynb").write_text('{"cells": []}', encoding="utf-8")
        write(folder / "ada.json", {"fits_through": Task(done=True)})
        (folder / "cy" / "lesson" / FILE).write_text("torn", encoding="utf-8")
        found = lessons.summary(folder)
        assert {name: len(tasks) for name, tasks in found.students.items()} == {"ada": 1, "bo": 0, "cy": 0}
        assert [problem.split(":")[0] for problem in found.problems] == ["cy/lesson"]


def test_the_command_puts_the_lessons_into_a_folder_and_runs_no_cell(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from robowidgets.command import _lab

    opened: list[object] = []
    monkeypatch.setattr(_lab, "run", lambda notebook, *_, runs_cells: opened.append((notebook, runs_cells)))
    assert main(["lessons", "mine"]) == 0
    notebook = folder / "mine" / "from_picture_to_code.ipynb"
    assert opened == [(notebook, False)]
    assert (folder / "mine" / "from_code_to_behavior.ipynb").exists()
    capsys.readouterr()
    assert main(["lessons", "mine", "--language", "en"]) == 0
    assert "stays unchanged" not in capsys.readouterr().out
    assert main(["lessons", "mine", "--language", "de"]) == 0
    said = capsys.readouterr().out
    assert f"{notebook} exists in 'en' and stays unchanged; name another folder for 'de'\n" in said
    assert said.count("exists in 'en'") == 3
    assert main(["lessons", "meine", "--language", "de"]) == 0
    assert main(["lessons", "meine"]) == 0
    assert "stays unchanged" not in capsys.readouterr().out
    assert main(["lessons", "--language", "xx"]) == 1
    assert "the lessons are not available in 'xx'; choose one of de, en" in capsys.readouterr().err


@pytest.mark.slow
def test_assignments_have_a_cell_for_each_answer_and_a_locked_one_that_checks_it_and_no_solution(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["lessons", "--for", "nbgrader", "course", "--language", "de"]) == 0
    assert [line.rpartition(": ")[2] for line in capsys.readouterr().out.splitlines()] == [
        "5 tasks, a point each",
        "7 tasks, a point each",
    ]
    grade_ids = set()
    for name in ("from_picture_to_code", "from_code_to_behavior"):
        file = folder / "course" / "source" / name / f"{name}.ipynb"
        text = file.read_text("utf-8")
        assert "<details>" not in text
        cells = json.loads(text)["cells"]
        assert len({cell["id"] for cell in cells}) == len(cells)
        for before, cell in pairwise(cells):
            graded = cell["metadata"].get("nbgrader")
            if graded is None:
                assert "lessons.check(" not in "".join(cell["source"]) or cell["cell_type"] == "markdown"
                continue
            # As nbgrader's schema of version 3 has an autograded test.
            assert {k: graded[k] for k in ("grade", "locked", "solution", "task", "points", "schema_version")} == {
                "grade": True,
                "locked": True,
                "solution": False,
                "task": False,
                "points": 1,
                "schema_version": 3,
            }
            grade_ids.add((name, graded["grade_id"]))
            answer = "".join(before["source"])
            assert fingerprint(answer) in _progress.GIVEN
            if name == "from_picture_to_code":
                names: dict[str, object] = {"lessons": lessons}
                with pytest.raises(AssertionError, match="right in "):
                    exec(answer + "\n\n" + "".join(cell["source"]), names)
    assert len(grade_ids) == 12
    (folder / "course" / "source" / "from_picture_to_code" / "from_picture_to_code.ipynb").write_text("mine")
    assert main(["lessons", "--for", "nbgrader", "course"]) == 0
    assert "exists and stays unchanged" in capsys.readouterr().out

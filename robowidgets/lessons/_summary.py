"""A class at a glance: the done tasks of each student, and the tasks where students are stuck, from their reports."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from html import escape
from pathlib import Path
from typing import NamedTuple

from ._grading import GRADES, NO_ANSWER, Grade, mark, read_grades, read_submission, submissions, write_grades
from ._progress import FILE, TASKS, ReportError, Task, encodable, read

_CLAIMED = "Not graded: this is what the students' computers wrote. robowidgets lessons --grade runs the answers"

STUCK = 3
"""The number of different wrong answers from which a student counts as stuck."""


_FIELD = re.compile(r"\{[^}]*\}")


class Fault(NamedTuple):
    """The faults in the answers of students who are stuck at a task, the most common first."""

    task: str
    students: tuple[str, ...]
    faults: tuple[tuple[str, int], ...]


class ClassSummary:
    """The progress of the students of a class. A notebook shows it as a picture, and `print` as a table.

    Args:
        students: the tasks of each student, by name.
        problems: a line for each submission or file that is empty, damaged or not a report.
        is_graded: True if the grader ran the answers; False if the students' computers wrote the results.
    """

    def __init__(
        self, students: Mapping[str, Mapping[str, Task]], problems: Iterable[str] = (), *, is_graded: bool = False
    ) -> None:
        self.is_graded = is_graded
        self.students = {name: dict(students[name]) for name in sorted(students, key=str.casefold)}
        self.problems = tuple(problems)

    @property
    def stuck(self) -> tuple[Fault, ...]:
        """The tasks at which students are stuck, beginning with the task with most of them."""
        found = []
        for task in TASKS:
            names = tuple(name for name, tasks in self.students.items() if _is_stuck(tasks.get(task)))
            if names:
                faults = Counter(_FIELD.sub("…", self.students[name][task].fault) for name in names)
                found.append(Fault(task, names, tuple(faults.most_common(3))))
        return tuple(sorted(found, key=lambda fault: -len(fault.students)))

    def __repr__(self) -> str:
        width = max((len(_plain(name)) for name in self.students), default=0)
        numbers = "".join(f"{number:>4}" for number in range(1, len(TASKS) + 1))
        lines = [f"{'':{width}}{numbers}  done"]
        for name, tasks in self.students.items():
            marks = "".join(f"{self._mark(tasks.get(task)):>4}" for task in TASKS)
            lines.append(f"{_plain(name):{width}}{marks}{_done(tasks):>6}")
        lines.append(f"{'done by':{width}}{''.join(f'{self._done_by(task):>4}' for task in TASKS)}")
        lines += ["", *(f"{number:>4}  {task}" for number, task in enumerate(TASKS, 1))]
        numbers = (
            "✗  wrong" if self.is_graded else f"a number: different answers that were wrong; {STUCK} or more: stuck"
        )
        lines.append(f"   {self._mark(Task(done=True))}  done;  {numbers}")
        lines += [] if self.is_graded else ["", _CLAIMED]
        for fault in self.stuck:
            names = ", ".join(map(_plain, fault.students))
            lines += ["", f"{len(fault.students)} stuck at {fault.task}: {names}"]
            lines += [f"  {count} ×  {_plain(text)}" for text, count in fault.faults if text]
        return "\n".join([*lines, *(f"\nnot read: {_plain(problem)}" for problem in self.problems)])

    def _mark(self, task: Task | None) -> str:
        if task is None:
            return "·"
        if task.done:
            return "✓" if self.is_graded else "✓?"
        return "✗" if self.is_graded else str(task.tries)

    def _cell(self, name: str, task: Task | None) -> str:
        if task is None:
            return "<td></td>"
        kind = ("yes" if self.is_graded else "claimed") if task.done else "stuck" if _is_stuck(task) else "try"
        title = f"{name}: {'done' if task.done else task.wrong}"
        return f'<td class="rw-{kind}" title="{escape(title, quote=True)}">{self._mark(task)}</td>'

    def _done_by(self, task: str) -> int:
        return sum(task in tasks and tasks[task].done for tasks in self.students.values())

    def _repr_html_(self) -> str:
        head = "".join(f'<th class="rw-task"><span>{escape(task.replace("_", " "))}</span></th>' for task in TASKS)
        rows = "".join(
            f"<tr><th>{escape(name)}</th>{''.join(self._cell(task, tasks.get(task)) for task in TASKS)}"
            f"<td class='rw-done'>{_done(tasks)}</td></tr>"
            for name, tasks in self.students.items()
        )
        most = max(len(self.students), 1)
        bars = "".join(
            f'<td class="rw-bar"><i style="height:{2.4 * done / most:.2f}em"></i>{done}</td>'
            for done in map(self._done_by, TASKS)
        )
        problems = "".join(f"<li>{escape(problem)}</li>" for problem in self.problems)
        return (
            f'<div class="rw-class"><style>{_STYLE}</style>'
            f"<table><thead><tr><th></th>{head}<th>done</th></tr></thead><tbody>{rows}</tbody>"
            f"<tfoot><tr><th>done by, of {len(self.students)}</th>{bars}<td></td></tr></tfoot></table>"
            f"{self._legend()}"
            f"{''.join(self._stuck_html())}"
            f"{f'<h3>Not read</h3><ul>{problems}</ul>' if problems else ''}</div>"
        )

    def _legend(self) -> str:
        if self.is_graded:
            return '<p><span><b class="rw-yes">✓</b> done</span><span><b class="rw-try">✗</b> wrong</span></p>'
        return (
            '<p><span><b class="rw-claimed">✓?</b> done</span>'
            '<span><b class="rw-try">1</b> wrong answers so far</span>'
            f'<span><b class="rw-stuck">{STUCK}</b> stuck: {STUCK} or more different answers were wrong</span></p>'
            f"<p>{escape(_CLAIMED)}</p>"
        )

    def _stuck_html(self) -> Iterator[str]:
        for fault in self.stuck:
            yield f"<h3>{len(fault.students)} stuck at {escape(fault.task.replace('_', ' '))}</h3><ul>"
            yield from (f"<li>{count} × {escape(text)}</li>" for text, count in fault.faults if text)
            yield "</ul>"
            for name in fault.students:
                task = self.students[name][fault.task]
                yield f"<details><summary>{escape(name)}: {escape(task.wrong)}</summary>"
                yield f"<pre>{escape(task.answer)}</pre></details>"

    def to_html(self, file: str | os.PathLike[str]) -> None:
        """Write the picture as a separate page that loads nothing."""
        Path(file).write_text(
            '<!doctype html><html lang="en"><meta charset="utf-8">'
            "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">"
            '<meta name="viewport" content="width=device-width"><title>The class at a glance</title>'
            "<style>:root { color-scheme: light dark } body { font: 15px system-ui; margin: min(2em, 4vw) }</style>"
            f"<h1>The class at a glance</h1>{self._repr_html_()}</html>",
            encoding="utf-8",
        )


def summary(folder: str | os.PathLike[str]) -> ClassSummary:
    """Return the progress of a class, from a folder with the reports of its students at any depth.

    Reports are files that `report` wrote, each with the name of its student, and ``robowidgets-progress.json`` files.
    A progress file belongs to the student of the only report in its folder, or else to the student whose name the first
    folder has. A folder with notebooks and without a report counts as a student without answers. ``problems`` names
    files that are damaged or not reports, and empty or damaged notebooks. Nothing in the files is run: without grading,
    the results are those that the students' computers wrote. After ``robowidgets lessons --grade``, the summary shows
    only the marks.

    Raises:
        NotADirectoryError: the folder does not exist.
        ReportError: the file with the marks is damaged.
    """
    root = Path(folder)
    if not root.is_dir():
        raise NotADirectoryError(f"summary: {str(folder)!r} is not a folder; expected the folder with the reports")
    grades = read_grades(root)
    if grades is not None:
        return _graded(root, grades)
    found, problems = list[tuple[Path, dict[str, Task]]](), list[str]()
    for within in _files(root, "*.json"):
        file = root / within
        try:
            found.append((within, read(file)))
        except (ReportError, OSError) as error:
            problems.append(str(error) if within.parent == Path() else f"{within.parent}: {error}")
    reports = [file for file, _ in found if file.name != FILE]
    stems, folders = Counter(file.stem for file in reports), Counter(file.parent for file in reports)
    name_of = {file: file.stem if stems[file.stem] == 1 else file.with_suffix("").as_posix() for file in reports}
    owner_of = {file.parent: name for file, name in name_of.items() if folders[file.parent] == 1}
    students: dict[str, dict[str, Task]] = {}
    for file, tasks in found:
        above = file.parts[0] if len(file.parts) > 1 else root.resolve().name
        of = students.setdefault(encodable(name_of.get(file) or owner_of.get(file.parent, above)), {})
        for task, row in tasks.items():
            if task not in of or (row.done, row.last) > (of[task].done, of[task].last):
                of[task] = row
    with_report = {file.parts[0] for file, _ in found}
    for file in _files(root, "*.ipynb"):
        if len(file.parts) > 1 and file.parts[0] not in with_report:
            students.setdefault(encodable(file.parts[0]), {})
        if (problem := read_submission(root / file).problem) and not problem.startswith(NO_ANSWER):
            problems.append(f"{file}: {problem}")
    return ClassSummary(students, map(encodable, problems))


def grade(
    folder: str | os.PathLike[str], *, user: str | int | None = None, tell: Callable[[str], None] = lambda _: None
) -> ClassSummary:
    """Mark the submissions of a class, and return its progress.

    The answers in each notebook and report run in a separate process, and are judged in this process, so that claims,
    prints and changes of an answer do not count. The marks are saved in the folder, for `summary`. The process of the
    answers has the rights of the present user unless another user is named: grade in a container, or as a user without
    rights.

    Args:
        folder: a folder with the submissions, at any depth.
        user: the user that runs the answers; any other than the present user needs root.
        tell: receives a line for each finished submission.

    Raises:
        NotADirectoryError: the folder does not exist.
        KeyError: the user does not exist. PermissionError: answers may not run as this user.
    """
    root = Path(folder)
    if not root.is_dir():
        raise NotADirectoryError(f"grade: {str(folder)!r} is not a folder; expected the folder with the submissions")
    write_grades(root, mark(root, user=user, tell=tell))
    return summary(root)


def _graded(root: Path, grades: Mapping[str, Grade]) -> ClassSummary:
    """Return the marks of a class, and name later submissions as not graded."""
    late = [name for name in dict.fromkeys(name for name, _ in submissions(root)) if name not in grades]
    problems = [f"{name}: {made.problem}" for name, made in grades.items() if made.problem]
    problems += [f"{name}: not graded yet: robowidgets lessons --grade {root}" for name in late]
    return ClassSummary(
        {**{name: made.tasks for name, made in grades.items()}, **{name: {} for name in late}}, problems, is_graded=True
    )


def _files(root: Path, pattern: str) -> list[Path]:
    """Return the files of a pattern at any depth, relative to the root, without hidden files."""
    within = (file.relative_to(root) for file in sorted(root.rglob(pattern)))
    return [
        file
        for file in within
        if not any(part.startswith(".") for part in file.parts) and file.name != GRADES and not (root / file).is_dir()
    ]


def _is_stuck(task: Task | None) -> bool:
    return task is not None and not task.done and task.tries >= STUCK


def _done(tasks: Mapping[str, Task]) -> int:
    return sum(task.done for task in tasks.values())


def _plain(text: str) -> str:
    """Return a text for one line of a terminal, without control characters."""
    return "".join(c if c.isprintable() else "�" for c in text)


_STYLE = """
.rw-class { overflow-x: auto; }
.rw-class table { border-collapse: separate; border-spacing: 3px; font-variant-numeric: tabular-nums; }
.rw-class th { font-weight: 500; text-align: left; padding-right: .6em; background: none; white-space: nowrap; }
.rw-class tr > th:first-child { position: sticky; left: 0; min-width: 9em; max-width: 12em; white-space: normal;
  overflow-wrap: anywhere; background: var(--jp-layout-color0, Canvas); }
.rw-class thead th { vertical-align: bottom; }
.rw-class thead th:last-child { text-align: right; padding-right: 0; }
.rw-class .rw-task { padding: 0; text-align: center; }
.rw-class .rw-task span { writing-mode: vertical-rl; transform: rotate(180deg); }
.rw-class tbody td { width: 2.1em; min-width: 2.1em; height: 1.7em; padding: 0; text-align: center; border-radius: 3px;
  box-shadow: inset 0 0 0 1px #8885; }
.rw-class tbody .rw-done { box-shadow: none; text-align: right; }
.rw-class .rw-bar { vertical-align: bottom; text-align: center; padding: 0; }
.rw-class .rw-bar i { display: block; background: #1f7a46; border-radius: 2px 2px 0 0; margin: 0 .3em; }
.rw-class p { display: flex; flex-wrap: wrap; gap: .2em .8em; }
.rw-class p b { display: inline-block; min-width: 1.6em; text-align: center; border-radius: 3px; }
.rw-class .rw-yes { background: #1f7a46; color: #fff; }
.rw-class .rw-claimed { background: none; box-shadow: inset 0 0 0 2px #1f7a46; }
.rw-class .rw-try { background: #f0d48a; color: #000; }
.rw-class .rw-stuck { background: #c2410c; color: #fff; font-weight: 600; }
.rw-class pre { padding: .6em; border-left: 3px solid #8885; overflow-x: auto; }
"""

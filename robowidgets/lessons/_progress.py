"""The progress of a student: saved in a file next to the notebook, shown in a line, and handed in as a report."""

from __future__ import annotations

import hashlib
import io
import json
import linecache
import os
import tokenize
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields, replace
from datetime import datetime, timezone
from html import escape
from pathlib import Path
from typing import Any

from ..behaviors.machine import Machine
from ..behaviors.program import Program
from ._result import Result
from ._texts import ENGLISH, say, speak

FILE = "robowidgets-progress.json"
KIND = "robowidgets lessons"
AS_STATES = " as states"

TASKS = (
    *("nearest_on_the_left", "fits_through", "stop_at_wall", "bumper_reflex", "slow_in_doorway"),
    *("wall_ahead", "stop_before_wall", "follow_wall", "back_off"),
    *(f"{task}{AS_STATES}" for task in ("stop_before_wall", "follow_wall", "back_off")),
)
"""All tasks of the lessons in order. A task for both a program and a state machine counts as two."""

LONGEST_TEXT, LONGEST_ANSWER, LONGEST_FILE = 500, 4000, 1_000_000
"""The limits for saved texts and answers in characters, and for files to read in bytes."""

GIVEN = frozenset(
    [
        "0c216b8cf5c7",
        "3fbfced9594f",
        "aa5701eb281c",
        "a4d769271174",
        "0a24a8d9e232",
        "25f7113ce953",
        "59feae781a9c",
        "baa7ad10cdf7",
        "0e21331f4bf3",
        "ceb2acfc1339",
        "a627764c45a8",
        "cdaac3c68026",
    ]
)
"""The fingerprints of the answers in the lessons. Checking an unchanged answer does not count as a try."""


class ReportError(ValueError):
    """A file is not a report of a student, or it is damaged. The text explains it in the language of the lesson.

    Args:
        text: English, with a field in braces for each value, as for `say`.
    """

    def __init__(self, text: str, **values: Any) -> None:
        super().__init__(say(text, **values))


@dataclass(frozen=True)
class Task:
    """The progress of a student with one task. For a done task, the saved answer is the right one.

    Attributes:
        tries: the number of different answers that were checked, up to the first right answer.
        done: True if an answer was right.
        first, last: the times when the first answer and the saved answer were checked.
        right, cases: the number of right cases and of all cases for the saved answer.
        fault: the fault of the first wrong case, the same text in all languages.
        wrong: the line about that fault, in the language of the lesson.
        answer: the text of the cell with the saved answer.
    """

    tries: int = 0
    done: bool = False
    first: str = ""
    last: str = ""
    right: int = 0
    cases: int = 0
    fault: str = ""
    wrong: str = ""
    answer: str = ""


class LessonProgress:
    """A line with the number of tasks that are done. Each check updates it.

    Attributes:
        tasks: the names of all tasks, in the order of the lessons.
    """

    tasks = TASKS

    def __init__(self, file: Path, now: Callable[[], datetime] = lambda: datetime.now(timezone.utc)) -> None:
        from ipywidgets import HTML

        self._file = file
        self._now = now
        self._line: Any = HTML()
        self._problem = ""
        self._done: tuple[str, ...] = ()
        self._show()

    @property
    def done(self) -> tuple[str, ...]:
        """The names of the done tasks, in the order of the lessons; the names last read if the file cannot be read."""
        try:
            kept = self._read()
            self._done = tuple(task for task in TASKS if task in kept and kept[task].done)
        except OSError as error:
            self._problem = say("It cannot be saved: {error}", error=error)
        return self._done

    def __repr__(self) -> str:
        line = say("{done} of {all} done", done=len(self.done), all=len(TASKS))
        return f"{line}. {self._problem}" if self._problem else line

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        return self._line._repr_mimebundle_(**kwargs)

    def keep(self, task: str, answer: str, result: Result) -> None:
        """Save the result of a check, and update the line, which also shows an error of saving."""
        self._problem = ""
        try:
            self._keep(task, answer, result)
        except OSError as error:
            self._problem = say("It cannot be saved: {error}", error=error)
        self._show()

    def _keep(self, task: str, answer: str, result: Result) -> None:
        kept = self._read()
        before = kept.get(task, Task())
        # nbgrader copies the student's file to the notebook that it grades, where only the graded answers count.
        stays_done = before.done and os.environ.get("NBGRADER_EXECUTION") != "autograde"
        # A given answer is saved only if it is right: it may be the right answer to the previous task.
        if not result and (stays_done or (not before.done and fingerprint(answer) in GIVEN)):
            return
        now = self._now().isoformat(timespec="seconds")
        answer = answer[:LONGEST_ANSWER]
        kept[task] = Task(
            tries=before.tries + (not before.done and (answer != before.answer or not answer)),
            done=stays_done or bool(result),
            first=before.first or now,
            last=now,
            right=result.right,
            cases=result.cases,
            fault=result.fault[:LONGEST_TEXT],
            wrong=result.wrong[0][:LONGEST_TEXT] if result.wrong else "",
            answer=answer,
        )
        write(self._file, kept)

    def report(self, file: Path) -> int:
        """Write the saved tasks as a report. Return the number of done tasks; `OSError` if either file fails."""
        write(file, self._read())
        return len(self.done)

    def _read(self) -> dict[str, Task]:
        """Return the saved tasks; `OSError` if the file cannot be read now, as on a lost network: then it stays."""
        try:
            return read(self._file)
        except FileNotFoundError:
            return {}
        except ReportError as error:
            names = (f".damaged{number}.json" for number in ("", *range(2, 1000)))
            aside = next(file for name in names if not (file := self._file.with_suffix(name)).exists())
            os.replace(self._file, aside)
            self._problem = say(
                "{error}. It was renamed to {aside}, and a new file begins", error=error, aside=aside.name
            )
            return {}

    def _show(self) -> None:
        done = set(self.done)
        boxes = "".join(
            f'<span title="{escape(task, quote=True)}" style="display:inline-block;width:.8em;height:.8em;'
            f"margin-right:.2em;border-radius:.15em;border:1px solid #2e9e5b;"
            f'background:{"#2e9e5b" if task in done else "transparent"}"></span>'
            for task in TASKS
        )
        line = escape(say("{done} of {all} done", done=len(done), all=len(TASKS)))
        problem = f"<div>{escape(self._problem)}</div>" if self._problem else ""
        self._line.value = f'<span aria-hidden="true">{boxes}</span> <b>{line}</b>{problem}'


_current: LessonProgress | None = None


def progress(language: str = ENGLISH) -> LessonProgress:
    """Show how many tasks of the lessons are done, in a line that each check updates.

    From now on checks save their results in ``robowidgets-progress.json``, in the folder of the notebook, and use the
    language of the lesson.

    Args:
        language: the code of the language, such as ``"de"``.

    Raises:
        ValueError: the lessons are not available in this language.
    """
    global _current
    speak(language)
    _current = LessonProgress(Path(FILE).absolute())
    return _current


def report(file: str | os.PathLike[str]) -> str:
    """Write a file to hand in, with your progress and your answers.

    Args:
        file: the name of the file, such as ``"ada.json"``. The teacher sees this name.

    Returns:
        A line with the number of done tasks.

    Raises:
        TypeError: it is not a name. ValueError: the name does not end with ``.json``.
        FileExistsError: a file with this name exists and is not a report. FileNotFoundError: its folder is missing.
    """
    if not isinstance(file, (str, os.PathLike)):
        raise TypeError(f"report: expected a file name with your name, such as 'ada.json', got {file!r}")
    path = Path(file)
    if path.suffix != ".json" or path.name == FILE:
        raise ValueError(f"report: expected a file name with your name, such as 'ada.json', got {str(file)!r}")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"report: the folder {str(path.parent)!r} does not exist; make it")
    if path.exists():
        try:
            read(path)
        except ReportError as error:
            raise FileExistsError(f"report: {path} is another file and was not changed ({error})") from None
    done = (_current or LessonProgress(Path(FILE).absolute())).report(path)
    return say("{file}: {done} of {all} done. Hand in this file", file=path.name, done=done, all=len(TASKS))


def forget() -> None:
    """Stop saving the results of checks."""
    global _current
    _current = None


def keep(function: Any, name: str, result: Result) -> None:
    """Save the result of a check if `progress` was called."""
    if _current is not None:
        function = function.version.function if isinstance(function, Program) else function
        described = function.cls if isinstance(function, Machine) else function
        is_machine = isinstance(described, type)
        task = f"{name}{AS_STATES}" if is_machine and f"{name}{AS_STATES}" in TASKS else name
        _current.keep(task, _cell_of(described), result)


def _cell_of(answer: Any) -> str:
    """Return the text of the cell or the file with an answer, or an empty text if Python does not have it."""
    parts = [answer, *(vars(answer).values() if isinstance(answer, type) else ())]
    code = next((part.__code__ for part in parts if hasattr(part, "__code__")), None)
    return "".join(linecache.getlines(code.co_filename)) if code is not None else ""


def fingerprint(cell: str) -> str:
    """Return a hash of the answer in a cell, without its check, comments and blanks: the same in all languages."""
    skipped = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
    text = cell.partition("\nresult = ")[0]
    try:
        words = [t.string for t in tokenize.generate_tokens(io.StringIO(text).readline) if t.type not in skipped]
    except (tokenize.TokenError, SyntaxError):  # for example an IPython magic, which no given answer contains
        return ""
    return hashlib.sha256(" ".join(words).encode()).hexdigest()[:12]


# -- the file ----------------------------------------------------------------------------------------------------------


def write(file: Path, tasks: Mapping[str, Task]) -> None:
    """Write a file atomically, so that no reader sees a part of it."""
    text = json.dumps({"kind": KIND, "version": 1, "tasks": {k: asdict(v) for k, v in tasks.items()}}, indent=1)
    part = file.with_name(f".{file.name}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8")
        os.replace(part, file)
    except OSError:
        part.unlink(missing_ok=True)
        raise


def read(file: Path) -> dict[str, Task]:
    """Return the tasks in a file from anywhere. Nothing in the file is run: all of it is text.

    Raises:
        ReportError: the file is not a report, or it is damaged.
        OSError: the file cannot be read.
    """
    if file.stat().st_size > LONGEST_FILE:
        raise ReportError(
            "{file} is too large for a report: {size:.1f} MB", file=file.name, size=file.stat().st_size / 1e6
        )
    try:
        held = json.loads(file.read_bytes())
    except (ValueError, RecursionError) as error:
        raise ReportError("{file} is damaged: {error}", file=file.name, error=error) from None
    if not isinstance(held, dict) or held.get("kind") != KIND:
        raise ReportError("{file} is not a report of the lessons", file=file.name)
    if held.get("version") != 1:
        raise ReportError(
            "{file} has version {version}, but this robowidgets reads version 1",
            file=file.name,
            version=repr(held.get("version"))[:20],
        )
    tasks = held.get("tasks")
    if not isinstance(tasks, dict):
        raise ReportError("{file} is damaged: it has no tasks", file=file.name)
    return {task: task_in(file, task, row) for task, row in tasks.items()}


def task_in(file: Path, name: str, row: Any) -> Task:
    """Return a task from a row of a file; ReportError if the row is damaged."""
    if name not in TASKS:
        raise ReportError("{file} has an unknown task: {name}", file=file.name, name=repr(name)[:60])
    if not isinstance(row, dict):
        raise ReportError("{file} is damaged at {name}", file=file.name, name=name)
    empty = Task()
    values: dict[str, Any] = {}
    for field in fields(Task):
        default = getattr(empty, field.name)
        value = row.get(field.name, default)
        if type(value) is not type(default) or (isinstance(value, int) and not 0 <= value < 1_000_000):
            raise ReportError(
                "{file} is damaged at {name}: {field} is {value}",
                file=file.name,
                name=name,
                field=field.name,
                value=repr(value)[:60],
            )
        values[field.name] = encodable(value[:LONGEST_ANSWER]) if isinstance(value, str) else value
    return replace(empty, **values)


def encodable(text: str) -> str:
    """Return a text with escape codes for characters that UTF-8 cannot encode, as from a file name in Latin-1."""
    return text.encode("utf-8", "backslashreplace").decode()

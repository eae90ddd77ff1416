"""Marks: the answers of each submission run in a separate process, and are judged in this process."""

from __future__ import annotations

import json
import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, NamedTuple

from ..behaviors.drive import Drive
from ..behaviors.lines.watch import WatchedStep
from ..behaviors.prints import Prints
from ..runtime.import_path import import_path
from ._answers import OWN
from ._bounded import BrokenError, WrongError
from ._check import TASKS as CASES
from ._check import judged
from ._progress import AS_STATES, FILE, LONGEST_ANSWER, LONGEST_TEXT, TASKS, ReportError, Task, encodable, read, task_in
from ._result import Result

GRADES = "robowidgets-grades.json"
"""The file with the marks, in the folder with the submissions."""
KIND = "robowidgets grades"
NO_ANSWER = "it has no answer to a task"

_ANSWER_S = 5.0
"""Seconds to wait for an answer: more than the limit of a step, because the grader's computer may be busy."""
_LARGEST = 20_000_000
"""The largest notebook to read, in bytes."""
_PROGRAMS = ("stop_before_wall", "follow_wall", "back_off")
_CHECK = re.compile(r"lessons\.check\(\s*(\w+)\s*(?:,\s*(?:task\s*=\s*)?[\"'](\w+)[\"']\s*)?,?\s*\)")


class Submission(NamedTuple):
    """A submission of a student: cells with code, the answers that each cell checks, or the problem with it."""

    cells: list[str]
    checks: list[list[tuple[str, str]]]
    texts: dict[str, str]
    problem: str = ""


class Grade(NamedTuple):
    """The marks of a student, and the problem with the submission as a whole, or an empty text."""

    tasks: dict[str, Task]
    problem: str = ""


def mark(
    folder: Path,
    *,
    user: str | int | None = None,
    seconds: float = _ANSWER_S,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Grade]:
    """Run all submissions in a folder, and return the marks by student.

    Args:
        folder: a folder with notebooks and reports, at any depth.
        user: the user that runs the answers, preferably without rights, or None for the present user. Any other user
            needs root.
        seconds: the time to wait for an answer.
        tell: receives a line for each submission.
    """
    grades: dict[str, Grade] = {}
    for name, file in submissions(folder):
        found = read_submission(file)
        made = Grade({}, found.problem) if found.problem else _run(found, user, seconds)
        made = made._replace(problem=made.problem and f"{file.name}: {made.problem}")
        before = grades.get(name, Grade({}))
        tasks = {**before.tasks, **{k: v for k, v in made.tasks.items() if not _is_done(before.tasks.get(k))}}
        grades[name] = Grade(tasks, "; ".join(filter(None, (before.problem, made.problem))))
        tell(f"{name}: {sum(task.done for task in grades[name].tasks.values())} of {len(TASKS)} right")
    for place in sorted(folder.iterdir()):
        if place.is_dir() and not place.name.startswith(".") and encodable(place.name) not in grades:
            grades[encodable(place.name)] = Grade({}, "the folder contains neither a notebook nor a report")
    return grades


def _is_done(task: Task | None) -> bool:
    return task is not None and task.done


def submissions(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield the submitted files with the names of their students, sorted by path."""
    files = sorted(file.relative_to(folder) for suffix in ("ipynb", "json") for file in folder.rglob(f"*.{suffix}"))
    for file in files:
        if (
            any(part.startswith(".") for part in file.parts)
            or file.name in (FILE, GRADES)
            or not is_there(folder / file)
        ):
            continue
        yield encodable(file.parts[0] if len(file.parts) > 1 else file.stem), folder / file


def is_there(file: Path) -> bool:
    """Return True if a path is a file and not a link, which may lead anywhere."""
    return file.is_file() and not file.is_symlink()


def read_submission(file: Path) -> Submission:
    """Return the answers in a notebook or a report, without running anything in it."""
    if file.suffix == ".json":
        try:
            tasks = read(file)
        except (ReportError, OSError) as error:
            return Submission([], [], {}, str(error))
        answers = {task: tasks[task].answer for task in TASKS if task in tasks and tasks[task].answer}
        checks = [[(_last_defined(text), task)] for task, text in answers.items()]
        problem = "" if answers else NO_ANSWER
        return Submission(list(answers.values()), checks, answers, problem)
    if file.stat().st_size > _LARGEST:
        return Submission([], [], {}, f"it is too large: {file.stat().st_size / 1e6:.0f} MB")
    try:
        text = file.read_text(encoding="utf-8")
        code: list[str] = [
            source if isinstance(source := cell["source"], str) else "".join(source)
            for cell in json.loads(text)["cells"]
            if cell["cell_type"] == "code"
        ]
    except (OSError, ValueError, RecursionError, KeyError, TypeError) as error:
        what = "it is empty" if not file.stat().st_size else f"it is damaged: {type(error).__name__}: {error}"
        return Submission([], [], {}, what)
    return _submission(code)


def _submission(cells: list[str]) -> Submission:
    checks, texts, last = list[list[tuple[str, str]]](), dict[str, str](), ""
    for cell in cells:
        found = [(name, _task_name(cell, last, name, task or name)) for name, task in _CHECK.findall(cell)]
        found = [(name, task) for name, task in found if task in TASKS]
        checks.append(found)
        for _, task in found:
            texts[task] = (cell if re.search(r"^\s*(def|class) ", cell, re.MULTILINE) else last)[:LONGEST_ANSWER]
        last = cell
    problem = "" if texts else NO_ANSWER
    return Submission(cells, checks, texts, problem)


def _last_defined(cell: str) -> str:
    names: list[str] = re.findall(r"^(?:def|class) +(\w+)", cell, re.MULTILINE)
    return names[-1] if names else ""


def _task_name(cell: str, before: str, name: str, task: str) -> str:
    """Return the name of a task; for a class, the name of the task for state machines."""
    is_class = re.search(rf"^class {re.escape(name)}\b", f"{before}\n{cell}", re.MULTILINE) is not None
    return f"{task}{AS_STATES}" if is_class and f"{task}{AS_STATES}" in TASKS else task


def _run(found: Submission, user: str | int | None, seconds: float) -> Grade:
    with tempfile.TemporaryDirectory(prefix="robowidgets-grade-") as place:
        os.chmod(place, 0o777)  # the only place where the user without rights can write
        tasks: dict[str, Task] = {}
        process = _Process(found, Path(place), user, seconds)
        problem = ""
        try:
            for task in TASKS:
                if task not in found.texts:
                    continue
                if process.ended:  # by the previous answer: the next one gets a new process
                    process.close()
                    process = _Process(found, Path(place), user, seconds)
                result = _judge(process, task)
                problem = problem or process.ended
                tasks[task] = Task(
                    tries=1,
                    done=bool(result),
                    right=result.right,
                    cases=result.cases,
                    fault=result.fault[:LONGEST_TEXT],
                    wrong=encodable(result.wrong[0][:LONGEST_TEXT]) if result.wrong else "",
                    answer=encodable(found.texts[task]),
                )
        finally:
            process.close()
        return Grade(tasks, problem)


def _judge(process: _Process, task: str) -> Result:
    name = task.removesuffix(AS_STATES)
    cases = CASES[name]()
    try:
        answer = _Remote(process, task, is_program=name in _PROGRAMS)
        return judged(answer.function(), name, cases, answer)
    except WrongError as error:  # before the first case
        return Result(name, [str(error)], 0, len(cases), fault=error.fault)


class _Remote:
    """An answer in another process, for `judged`. It replaces `Bounded`, which calls answers in this process."""

    def __init__(self, process: _Process, task: str, *, is_program: bool) -> None:
        self.prints, self.hints = Prints(), list[str]()
        self.steps, self.is_late = list[WatchedStep](), False
        self._process, self._task, self._is_program = process, task, is_program
        self._asks_for = process.ask("begin", task, is_program)

    def begin_case(self) -> None:
        """Start the answer again, with an empty state."""
        self._process.ask("begin", self._task, self._is_program)

    def of(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """See `Bounded.of`."""
        return function

    def function(self) -> Callable[..., Any]:
        """Return the answer as a function."""
        if not self._is_program:
            return lambda sample: _value(self._process.ask("call", sample))

        def program(**values: Any) -> Any:
            return _value(self._process.ask("call", values))

        names = self._asks_for if isinstance(self._asks_for, list) else []
        names = [name for name in map(str, names) if name.isidentifier() and name not in OWN]
        program.asks_for = names  # type: ignore[attr-defined]
        return program


class _Other:
    """An answer that is neither a number nor a speed."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __repr__(self) -> str:
        return self._text


def _value(reply: Any) -> Any:
    """Return the answer in a reply of another process, which may contain anything."""
    if isinstance(reply, dict):
        kind, values = reply.get("kind"), reply.get("values")
        with suppress(TypeError, ValueError, OverflowError):
            if kind == "none":
                return None
            if kind == "bool":
                return bool(reply["value"])
            if kind == "number":
                return float(reply["value"])
            if kind == "pair" and isinstance(values, list) and len(values) == 2:
                return float(values[0]), float(values[1])
            if kind == "drive" and isinstance(values, list):
                linear, angular, lateral = map(float, values)
                return Drive(linear, angular, lateral=lateral)
    text = reply.get("text") if isinstance(reply, dict) else reply
    return _Other(encodable(str(text))[:70])


class _Process:
    """The process of one submission.

    Attributes:
        ended: the reason if it ended unexpectedly; empty otherwise.
    """

    def __init__(self, found: Submission, place: Path, user: str | int | None, seconds: float) -> None:
        self.ended = ""
        self._seconds = seconds
        ids = None if user is None else _ids_of(user)
        self._process = subprocess.Popen(
            [sys.executable, "-I", "-c", _SERVE.format(path=_import_path(), ids=ids)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=place,
            env={"PATH": os.defpath, "HOME": str(place), "ROBOWIDGETS_CACHE": str(place), "LC_ALL": "C.UTF-8"},
            start_new_session=True,
        )
        self._lines: SimpleQueue[bytes] = SimpleQueue()
        threading.Thread(target=self._read, name="robowidgets-answers", daemon=True).start()
        self._loads = (found.cells, found.checks)
        self._is_loaded = False

    def _read(self) -> None:
        assert self._process.stdout
        with suppress(OSError, ValueError):
            while line := self._process.stdout.readline(100_000):
                self._lines.put(line)
        self._lines.put(b"")

    def ask(self, act: str, *rest: Any) -> Any:
        """Return the reply to a message; BrokenError if an answer raised an error or no reply comes."""
        if not self._is_loaded:
            self._is_loaded = True
            loaded = self._ask("load", *self._loads, seconds=max(self._seconds, _START_S))
            self._loaded = loaded if isinstance(loaded, list) else []
        if act == "begin" and rest[0] not in self._loaded:
            raise BrokenError("its cell does not define this function: it raised an error, or is not valid Python")
        reply = self._ask(act, *rest, seconds=self._seconds)
        if isinstance(reply, dict) and "error" in reply:
            error = encodable(str(reply["error"]))
            if act == "begin":
                raise BrokenError("{error}", error=error)
            raise BrokenError("it raised an error, {error}", error=error)
        return reply

    def _ask(self, *message: Any, seconds: float) -> Any:
        assert self._process.stdin
        if self.ended:
            raise BrokenError("its process ended: {why}", why=self.ended)
        try:
            pickle.dump(message, self._process.stdin)
            self._process.stdin.flush()
            line = self._lines.get(timeout=seconds)
        except Empty:
            self.ended = f"an answer has not come for {seconds:g} s"
            self._kill()
            raise BrokenError(
                "a step has not returned for {seconds:g} s, and was ended. A step returns at once: it does not sleep "
                "or wait, and its loops end",
                seconds=seconds,
            ) from None
        except OSError:
            line = b""
        if not line:
            self._kill()
            code = self._process.wait()
            self.ended = f"an answer ended its process ({signal.Signals(-code).name if code < 0 else f'code {code}'})"
            raise BrokenError("its process ended: {why}", why=self.ended)
        try:
            return json.loads(line)
        except (ValueError, RecursionError):
            return _Other(line[:70].decode("utf-8", "replace"))

    def _kill(self) -> None:
        with suppress(OSError):
            if hasattr(os, "killpg"):
                os.killpg(self._process.pid, signal.SIGKILL)
            else:
                self._process.kill()

    def close(self) -> None:
        """End the process and the processes that it started."""
        self._kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):
                if pipe:
                    pipe.close()


_SERVE = "import sys; sys.path[:] = {path!r}; from robowidgets.lessons._answers import serve; serve({ids!r})"
_START_S = 60.0
"""Seconds that a process may take to start."""


def _import_path() -> list[str]:
    """Return the import path without the folder of the submissions, which may contain a file such as `types.py`."""
    kept = [entry for entry in import_path() if entry and Path(entry).absolute() != Path.cwd()]
    return [*kept, str(Path(__file__).parents[2])]


def _ids_of(user: str | int) -> tuple[int, int]:
    """Return the ids of a user and its group.

    Raises:
        KeyError: the user does not exist. PermissionError: this process may not become another user.
    """
    import pwd

    found = pwd.getpwuid(user) if isinstance(user, int) else pwd.getpwnam(user)
    if os.geteuid() not in (0, found.pw_uid):
        raise PermissionError(f"only root may run answers as {user!r}")
    return found.pw_uid, found.pw_gid


# -- the file ----------------------------------------------------------------------------------------------------------


def write_grades(folder: Path, grades: Mapping[str, Grade]) -> Path:
    """Write the marks next to the submissions, and return the file."""
    from dataclasses import asdict

    file = folder / GRADES
    rows = {
        name: {"problem": made.problem, "tasks": {task: asdict(row) for task, row in made.tasks.items()}}
        for name, made in grades.items()
    }
    text = json.dumps({"kind": KIND, "version": 1, "submissions": rows}, indent=1)
    part = file.with_name(f".{file.name}.{os.getpid()}.part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, file)
    return file


def read_grades(folder: Path) -> dict[str, Grade] | None:
    """Return the marks of the submissions in a folder, or None if they were not graded.

    Raises:
        ReportError: the file with the marks is damaged.
    """
    file = folder / GRADES
    if not is_there(file):
        return None
    try:
        held = json.loads(file.read_text(encoding="utf-8"))
        if held["kind"] != KIND or held["version"] != 1:
            raise ValueError(f"it is of another kind or version: {held['kind']!r:.40}, {held['version']!r:.20}")
        return {
            str(name): Grade(
                {task: task_in(file, task, one) for task, one in row["tasks"].items()}, str(row["problem"])
            )
            for name, row in held["submissions"].items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ReportError("{file} is damaged: {error}", file=file.name, error=error) from None

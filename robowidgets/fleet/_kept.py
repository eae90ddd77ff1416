"""Results that are stored between runs, by recording."""

from __future__ import annotations

import json
import os
import stat
import sys
from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any, NamedTuple
from zlib import crc32

from ..files import remote
from ..messages.decoding import one_line
from ..repair import RecordingError, files_beside, find_files
from ..runtime.cache_folder import cache_folder
from ..runtime.urls import redacted

_AT_ONCE = 16
"""The maximum number of servers that are asked at the same time."""


class RecordingState(NamedTuple):
    """A text that changes whenever a recording does, or None if its server has no such text; or a problem."""

    text: str | None
    problem: str = ""


def states_of(paths: Iterable[Path | str]) -> dict[str, RecordingState]:
    """Return the state of each recording: size and time of its files. Several servers are asked at the same time."""
    given = list(paths)
    waiting: SimpleQueue[str] = SimpleQueue()
    answers: SimpleQueue[tuple[str, RecordingState]] = SimpleQueue()
    urls = [path for path in given if isinstance(path, str)]
    for url in urls:
        waiting.put(url)

    def ask() -> None:
        while True:
            try:
                url = waiting.get_nowait()
            except Empty:
                return
            answers.put((url, _state_of(url)))

    if len(urls) <= 1 or sys.platform == "emscripten":
        ask()
    else:
        for _ in range(min(_AT_ONCE, len(urls))):
            Thread(target=ask, name="robowidgets-states", daemon=True).start()
    try:
        told = dict(answers.get() for _ in urls)
    finally:
        while not waiting.empty():  # after an interrupt
            waiting.get()
    return {str(path): told[path] if isinstance(path, str) else _state_of(path) for path in given}


def _state_of(path: Path | str) -> RecordingState:
    try:
        if isinstance(path, str):
            return RecordingState(remote.state_of(path))
        stats = _stats_of(path)
    except OSError as error:
        return RecordingState(None, f"cannot be read: {error.strerror or error}")
    except RecordingError as error:
        return RecordingState(None, str(error))
    except Exception as error:  # from a driver: the caller must get an answer
        return RecordingState(None, f"its state cannot be read: {type(error).__name__}: {redacted(one_line(error))}")
    # The time of change, too: a copy may have the size and time of the file that it replaces.
    told = ((name, one.st_size, one.st_mtime_ns, one.st_ctime_ns) for name, one in stats)
    return RecordingState(json.dumps([str(path), *told]))


def _stats_of(path: Path) -> list[tuple[str, os.stat_result]]:
    """Return the names and states of the files of a recording, by few calls of the system for one file."""
    try:
        whole = os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return []
    if not stat.S_ISDIR(whole.st_mode):
        return [(path.name, whole), *((file.name, file.stat()) for file in files_beside(path))]
    files = [path, path / "metadata.yaml", *find_files(path)]
    files += [beside for file in files for beside in files_beside(file)]
    return [(file.name, file.stat()) for file in files if file.exists()]


class Kept:
    """The stored results of one question, in a file of lines: checksum, state and result. Damaged lines are ignored.

    Args:
        question: the text of the question.

    Attributes:
        problem: the reason why results cannot be stored, or empty while they can.
    """

    def __init__(self, question: str) -> None:
        self._path = cache_folder() / "find" / f"{sha256(question.encode()).hexdigest()[:32]}.jsonl"
        self.problem = ""
        self._results: dict[str, Any] = {}
        try:
            lines = self._path.read_bytes().splitlines()
        except OSError:
            lines = []
        for line in lines:
            checksum, _, text = line.partition(b" ")
            if checksum == _checksum(text):
                state, result = json.loads(text)
                self._results[state] = result

    def get(self, state: str) -> Any:
        """Return the result for a recording in this state, or None without one."""
        return self._results.get(state)

    def add(self, path: str, state: str | None, result: Any) -> Any:  # noqa: ARG002
        """Store a result, and return it. If that fails, `problem` has the reason, and no more results are stored."""
        if self.problem or not state:
            return result
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            # One write at the end of the file: another run may write to it at the same time.
            with self._path.open("ab", buffering=0) as file:
                text = json.dumps([state, result]).encode()
                file.write(b"\n%b %b\n" % (_checksum(text), text))
        except OSError as error:
            self.problem = f"results cannot be stored for the next run: {error}"
        return result


def _checksum(text: bytes) -> bytes:
    return b"%08x" % crc32(text)

"""Results that are kept from one run to the next, by recording."""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

from .._core.cache_folder import cache_folder
from ..recordings import remote
from ..repair import find_files


def state_of(path: Path | str) -> str | None:
    """What changes whenever a recording does: size and time of its files; None where a server does not tell.

    Raises:
        OSError: it cannot be looked at. RecordingError: nor can it behind its URL.
    """
    if isinstance(path, str):
        return remote.state_of(path)
    files = [path, path / "metadata.yaml", *find_files(path)] if path.is_dir() else [path]
    stats = [(file.name, file.stat()) for file in files if file.exists()]
    return json.dumps([str(path), *((name, stat.st_size, stat.st_mtime_ns) for name, stat in stats)])


class Kept:
    """The results of one question, in one file of lines. A line that was cut, or is of no use, is as none.

    Args:
        question: a text for what was asked.

    Attributes:
        problem: why results cannot be kept; empty while they can.
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
            try:
                state, result = json.loads(line)
            except ValueError:
                continue
            self._results[str(state)] = result

    def get(self, state: str) -> Any:
        """The result for a recording in this state; None without one."""
        return self._results.get(state)

    def add(self, state: str, result: Any) -> None:
        """Keep a result. Where that fails, `problem` says why, and no more are kept."""
        if self.problem:
            return
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            # One write at the end of the file: a run beside this one may write to it, too.
            with self._path.open("ab", buffering=0) as file:
                file.write(f"\n{json.dumps([state, result])}\n".encode())
        except OSError as error:
            self.problem = f"results are not kept for the next time: {error}"

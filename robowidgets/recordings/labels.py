"""The names that people gave to spans of recordings, in one file of lines beside them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

FILE = "labels.jsonl"
"""The name of the file, in the folder of the recording."""

MOST_TEXT = 200


class Label(NamedTuple):
    """A span with a name: start and end in seconds from the start of the recording, and by its clock."""

    label: str
    start: float
    end: float
    start_ns: int
    end_ns: int


class LabelFile:
    """The labels of the recordings of a folder. A line that was cut, or is of no use, stays, and is told.

    Args:
        recording: the path of one of them.
    """

    def __init__(self, recording: Path) -> None:
        self.path = recording.parent / FILE
        self._name = recording.name

    def read(self) -> tuple[list[Label], list[str]]:
        """The labels of the recording by time, without those of equal spans and names, and lines on what is wrong."""
        found: dict[Label, None] = {}
        problems = []
        try:
            lines = self.path.read_bytes().splitlines()
        except FileNotFoundError:
            return [], []
        except OSError as error:
            return [], [f"labels: {self.path.name} cannot be read: {error.strerror or error}"]
        for number, line in enumerate(lines, start=1):
            if not line.strip():
                continue
            try:
                one = json.loads(line)
                label = Label(
                    str(one["label"]), float(one["start"]), float(one["end"]), int(one["start_ns"]), int(one["end_ns"])
                )
                if one["file"] == self._name:
                    found[label] = None
            except (ValueError, KeyError, TypeError):
                problems.append(f"labels: line {number} of {self.path.name} is no label")
        return sorted(found, key=lambda one: one.start_ns), problems

    def add(self, label: Label) -> None:
        """Add a label; OSError if the file cannot be written."""
        line = json.dumps({"file": self._name, **label._asdict()}, ensure_ascii=False)
        # One write at the end of the file: another program may write to it, too, or have been cut off in a line.
        with self.path.open("ab", buffering=0) as file:
            file.write(f"\n{line}\n".encode())


def to_name(value: Any) -> str:
    """The name of a label; TypeError or ValueError if it is none."""
    if not isinstance(value, str):
        raise TypeError(f"label: expected a name, got {value!r}")
    name = " ".join(value.split())
    if not 0 < len(name) <= MOST_TEXT:
        raise ValueError(f"label: expected a name of 1 to {MOST_TEXT} characters, got {value!r}")
    return name

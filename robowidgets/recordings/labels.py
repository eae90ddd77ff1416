"""Named spans of recordings, in one file of lines in the same folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

from ..samples.time_span import time_span

FILE = "labels.jsonl"
"""The name of the file, in the folder of the recording."""

MOST_TEXT = 200

SHORTEST = 1e-3
"""The minimum length of a named span in seconds, used if the user names a moment."""

LONGEST = 1e9
"""The latest time of a label in seconds from the start of a recording: a later time has no nanoseconds by its clock."""

_REMOVED = "removed"


class LabelledSpan(NamedTuple):
    """A name, and start and end in seconds from the start of the recording: the contents of a line of the file."""

    label: str
    start: float
    end: float


class Label(NamedTuple):
    """A named span: start and end in seconds from the start of the recording, and by its clock."""

    label: str
    start: float
    end: float
    start_ns: int
    end_ns: int


def labelled_span(name: Any, start: Any, end: Any) -> LabelledSpan:
    """Return a named span; raise TypeError or ValueError if an argument is wrong."""
    named = to_name(name)
    first, last = time_span("label", (start, end))
    if last > LONGEST:
        raise ValueError(f"label: expected an end of at most {LONGEST:g} s, got {end!r}")
    return LabelledSpan(named, first, last)


def with_clock(span: LabelledSpan, start_ns: int) -> Label:
    """Return a label with the times by the clock of its recording."""
    return Label(*span, start_ns + round(span.start * 1e9), start_ns + round(span.end * 1e9))


class LabelFile:
    """The labels of the recordings in a folder. A damaged or useless line stays in the file, and is reported.

    Args:
        folder: the folder.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / FILE

    def read(self) -> tuple[dict[str, list[LabelledSpan]], list[str]]:
        """Return the labels of each recording by time, without duplicates, and lines on problems."""
        found: dict[str, dict[LabelledSpan, None]] = {}
        problems = []
        try:
            lines = self.path.read_bytes().splitlines()
        except FileNotFoundError:
            return {}, []
        except OSError as error:
            return {}, [f"labels: {self.path.name} cannot be read: {error.strerror or error}"]
        for number, line in enumerate(lines, start=1):
            if not line.strip():
                continue
            try:
                one = json.loads(line)
                label = labelled_span(one["label"], one["start"], one["end"])
                there = found.setdefault(str(one["file"]), {})
                there.pop(label, None)
                if not one.get(_REMOVED):
                    there[label] = None
            except (ValueError, KeyError, TypeError, AttributeError, OverflowError):
                problems.append(f"labels: line {number} of {self.path.name} is not a label")
        return {name: sorted(labels, key=lambda one: one.start) for name, labels in found.items()}, problems

    def add(self, file: str, label: LabelledSpan) -> None:
        """Add a label of a recording; raise OSError if the file cannot be written."""
        self._write({"file": file, **label._asdict()})

    def remove(self, file: str, label: LabelledSpan) -> None:
        """Remove a label of a recording; raise OSError if the file cannot be written."""
        self._write({"file": file, **label._asdict(), _REMOVED: True})

    def _write(self, line: dict[str, Any]) -> None:
        # One write at the end of the file: another program may write to it, too, or may have been interrupted within a
        # line.
        with self.path.open("ab", buffering=0) as file:
            # A name that is not UTF-8 is written with JSON escapes.
            file.write(f"\n{json.dumps(line, ensure_ascii=False)}\n".encode("utf-8", "backslashreplace"))


def to_name(value: Any) -> str:
    """Return the name of a label; raise TypeError or ValueError if it is not a name."""
    if not isinstance(value, str):
        raise TypeError(f"label: expected a name, got {value!r}")
    name = " ".join(value.split())
    if not 0 < len(name) <= MOST_TEXT:
        raise ValueError(f"label: expected a name of 1 to {MOST_TEXT} characters, got {value!r}")
    return name

"""Named spans of recordings, in one file of lines in the same folder."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping
from contextlib import closing, nullcontext
from hashlib import sha256
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

from ..files import open_source
from ..repair import RecordingError, Source, find_files
from ..runtime.text import many
from ..samples.time_span import time_span

FILE = "labels.jsonl"
"""The name of the file, in the folder of the recording."""

MOST_TEXT = 200

SHORTEST = 1e-3
"""The minimum length of a named span in seconds, used if the user names a moment."""

LONGEST = 1e9
"""The latest time of a label in seconds from the start of a recording: a later time has no nanoseconds by its clock."""

_REMOVED, _CONTENT, _SIZE = "removed", "content", "size"

_FIRST = 20
"""The messages at the start of a recording by which it is recognized: a recording that grows stays the same."""


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
    first, last = time_span("label", (start, end), optional=False)
    if last > LONGEST:
        raise ValueError(f"label: expected an end of at most {LONGEST:g} s, got {end!r}")
    return LabelledSpan(named, first, last)


def with_clock(span: LabelledSpan, start_ns: int) -> Label:
    """Return a label with the times by the clock of its recording."""
    return Label(*span, start_ns + round(span.start * 1e9), start_ns + round(span.end * 1e9))


class _Line(NamedTuple):
    """A line of the file: a label of a recording, its name, its content and its size, if the line has these."""

    file: str
    label: LabelledSpan
    is_removed: bool
    content: str
    size: int | None


class LabelFile:
    """The labels of the recordings in a folder. A damaged or useless line stays in the file, and is reported.

    A label belongs to a recording by its name. If that name is gone, or has other content now, the label belongs to the
    recording in the folder with the same content.

    Args:
        folder: the folder.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / FILE
        self._folder = folder
        self._lines: list[_Line] = []
        self._damaged: list[str] = []
        self._contents: dict[Path, str] = {}
        self._read()

    @property
    def problems(self) -> list[str]:
        """Lines on damaged lines, and on labels of recordings that are gone; after `of`, of replaced ones, too."""
        return [*self._damaged, *self._gone()]

    def of(self, path: Path, source: Source | None = None) -> list[LabelledSpan]:
        """Return the labels of a recording by time, without duplicates.

        Args:
            path: its file or folder.
            source: its messages, or None to open it if they decide.
        """
        found: dict[LabelledSpan, None] = {}
        size = _size_of(path) if self._lines else None
        for line in self._lines:
            if self._is_of(line, path, size, source):
                found.pop(line.label, None)
                if not line.is_removed:
                    found[line.label] = None
        return sorted(found, key=lambda one: one.start)

    def add(self, path: Path, source: Source, label: LabelledSpan) -> None:
        """Add a label of a recording; raise OSError if the file cannot be written."""
        self._write(path, source, label)

    def remove(self, path: Path, source: Source, label: LabelledSpan) -> None:
        """Remove a label of a recording; raise OSError if the file cannot be written."""
        self._write(path, source, label, {_REMOVED: True})

    def _read(self) -> None:
        try:
            lines = self.path.read_bytes().splitlines()
        except FileNotFoundError:
            return
        except OSError as error:
            self._damaged.append(f"labels: {self.path.name} cannot be read: {error.strerror or error}")
            return
        for number, line in enumerate(lines, start=1):
            if not line.strip():
                continue
            try:
                one = json.loads(line)
                label = labelled_span(one["label"], one["start"], one["end"])
                content, size = str(one.get(_CONTENT, "")), one.get(_SIZE)
                size = size if isinstance(size, int) else None
                self._lines.append(_Line(str(one["file"]), label, bool(one.get(_REMOVED)), content, size))
            except (ValueError, KeyError, TypeError, AttributeError, OverflowError):
                self._damaged.append(f"labels: line {number} of {self.path.name} is not a label")

    def _is_of(self, line: _Line, path: Path, size: int | None, source: Source | None) -> bool:
        if line.file == path.name:
            is_same = not line.content or line.size in (None, size)
            return is_same or line.content == self._content(path, source)
        if not line.content or line.size != size:
            return False
        is_there = line.size == _size_of(self._folder / line.file)
        return not is_there and line.content == self._content(path, source)

    def _content(self, path: Path, source: Source | None) -> str:
        """Return the content of a recording as short text, or an empty text if it cannot be read."""
        if path not in self._contents:
            try:
                with nullcontext(source) if source else closing(open_source(path)) as opened:
                    self._contents[path] = content_of(opened)
            except RecordingError:
                self._contents[path] = ""
        return self._contents[path]

    def _gone(self) -> list[str]:
        """Return a line for each recording with labels that is not in the folder under any name."""
        labels: dict[tuple[str, LabelledSpan], _Line] = {}
        for line in self._lines:
            key = line.content or line.file, line.label
            labels.pop(key, None)
            if not line.is_removed:
                labels[key] = line
        is_there = {file: (self._folder / file).exists() for file in {line.file for line in labels.values()}}
        missing = [
            (f"an earlier {line.file}" if is_there[line.file] else line.file, line)
            for line in labels.values()
            if not is_there[line.file] or self._is_replaced(line)
        ]
        sizes = {_size_of(path) for path in self._folder.iterdir()} if missing else set()
        gone = Counter(name for name, line in missing if not (line.content and line.size in sizes))
        return [
            f"labels: {self.path.name} has {many(count, 'label')} of {name}, which is gone: give it its name back, or "
            "remove the lines"
            for name, count in gone.items()
        ]

    def _is_replaced(self, line: _Line) -> bool:
        """Return True if `of` has found that another recording has the name."""
        content = self._contents.get(self._folder / line.file, "")
        return bool(line.content and content) and content != line.content

    def _write(self, path: Path, source: Source, label: LabelledSpan, more: Mapping[str, Any] | None = None) -> None:
        content = self._content(path, source)
        known = {_SIZE: _size_of(path), _CONTENT: content} if content else {}
        line = {"file": path.name, **label._asdict(), **known, **(more or {})}
        # One write at the end of the file: another program may write to it, too, or may have been interrupted within a
        # line.
        with self.path.open("ab", buffering=0) as file:
            # A name that is not UTF-8 is written with JSON escapes.
            file.write(f"\n{json.dumps(line, ensure_ascii=False)}\n".encode("utf-8", "backslashreplace"))


def content_of(source: Source) -> str:
    """Return a short text that is the same for recordings that begin with the same messages, or empty without any."""
    digest = sha256()
    count = 0
    for channel, time_ns, data in islice(source.messages(source.channels), _FIRST):
        digest.update(f"{channel.topic} {time_ns} {len(data)} ".encode() + bytes(data))
        count += 1
    return digest.hexdigest()[:16] if count else ""


def _size_of(path: Path) -> int | None:
    """Return the bytes of a recording, or None without one."""
    try:
        return sum(file.stat().st_size for file in (find_files(path) if path.is_dir() else [path]))
    except OSError:
        return None


def to_name(value: Any) -> str:
    """Return the name of a label; raise TypeError or ValueError if it is not a name."""
    if not isinstance(value, str):
        raise TypeError(f"label: expected a name, got {value!r}")
    name = " ".join(value.split())
    if not 0 < len(name) <= MOST_TEXT:
        raise ValueError(f"label: expected a name of 1 to {MOST_TEXT} characters, got {value!r}")
    return name

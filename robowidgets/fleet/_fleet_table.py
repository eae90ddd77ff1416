"""A table with a row for each result from many recordings, for display and for other libraries."""

from __future__ import annotations

import json
import os
import re
from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

from ..recordings.columns.tables import RowType, frame_of, library, write_parquet
from ..recordings.times import has_date
from ..runtime.tables import HasTable
from ..runtime.text import listed, many

SHOWN = 20
"""The number of rows that are printed."""

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


class Unread(NamedTuple):
    """A recording that could not be read, and the reason."""

    file: str
    problem: str


def date_of(time_ns: int | None) -> datetime | None:
    """Return date and time in UTC of a time by the clock of a recording, or None if that clock has no date."""
    if time_ns is None or not has_date(time_ns):
        return None
    return _EPOCH + timedelta(microseconds=time_ns // 1000)


class FleetTable(HasTable):
    """A table of many recordings. If it has a column ``problem``, each recording that could not be read has a row.

    Args:
        files: all recordings that were named.
        unread: the recordings that could not be read.
        until: the number of recordings that were read before an interrupt, or None for all.
        note: a line for the user, or empty.
    """

    _types: ClassVar[Mapping[str, RowType]]
    """The columns with their types."""

    def __init__(
        self, files: Sequence[str], unread: Sequence[Unread] = (), until: int | None = None, note: str = ""
    ) -> None:
        self.files = tuple(files)
        self.unread = tuple(unread)
        self.until = until
        self.note = note

    @property
    def is_complete(self) -> bool:
        """True if all recordings were read; `unread` names the ones that could not be read."""
        return self.until is None

    @abstractmethod
    def _rows(self) -> Iterator[Mapping[str, Any]]:
        """Return the values of each row, by column."""

    def to_pandas(self) -> Any:
        """Return a pandas DataFrame.

        Raises:
            ImportError: pandas is not installed.
        """
        return frame_of(self._columns(), self._kinds())

    def to_polars(self) -> Any:
        """Return a polars DataFrame; raise ImportError if polars or pyarrow is not installed."""
        return library("polars", "to_polars").from_arrow(self._arrow("to_polars"))

    def to_arrow(self) -> Any:
        """Return a pyarrow Table; raise ImportError if pyarrow is not installed."""
        return self._arrow("to_arrow")

    def to_parquet(self, path: str | os.PathLike[str]) -> Path:
        """Write a Parquet file, and return its path; an existing one is replaced.

        Raises:
            ImportError: pyarrow is not installed. ValueError: the name does not end in ``.parquet``. OSError: it cannot
                be written.
        """
        return write_parquet(path, lambda: self._arrow("to_parquet"))

    def to_json(self) -> str:
        """Return JSON, a line for each row, without empty values."""
        return "\n".join(json.dumps({name: _plain(value) for name, value in row.items()}) for row in self._all())

    def _all(self) -> Iterator[Mapping[str, Any]]:
        yield from self._rows()
        if "problem" in self._kinds():
            yield from (one._asdict() for one in self.unread)

    def _columns(self) -> dict[str, list[Any]]:
        rows = list(self._all())
        return {name: [row.get(name) for row in rows] for name in self._kinds()}

    def _kinds(self) -> Mapping[str, RowType]:
        """Return the columns of this table with their types."""
        return self._types

    def _arrow(self, method: str) -> Any:
        arrow = library("pyarrow", method)
        kinds = self._kinds()
        return arrow.table({name: arrow.array(values, kinds[name](arrow)) for name, values in self._columns().items()})

    def _complaints(self) -> Iterator[str]:
        """Yield lines on recordings that were not read."""
        if not self.is_complete:
            yield f"stopped after {self.until:,} of {many(len(self.files), 'file')}: the same call continues"
        yield from not_read(self.unread)
        if self.note:
            yield self.note


def not_read(unread: Sequence[Unread]) -> Iterator[str]:
    """Yield lines on recordings that could not be read, one for each reason, the most frequent reason first."""
    reasons: dict[str, list[Unread]] = {}
    for one in unread:
        reasons.setdefault(without_name(one.problem, one.file), []).append(one)
    for reason, alike in sorted(reasons.items(), key=lambda one: -len(one[1])):
        names = listed([Path(one.file).name for one in alike])
        text = reason if len(alike) > 1 else without_name(alike[0].problem, alike[0].file, in_commands=False)
        yield f"not read: {names}: {text}"


def with_problems(problems: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Yield a line on recordings that were read with problems, if there are any."""
    if problems:
        names = listed([Path(file).name for file in problems])
        yield f"{many(len(problems), 'file')} with problems, in .problems: {names}"


def cell_of(value: Any) -> str:
    """Return a value as the text of a cell, empty for None."""
    if value is None:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else f"{value:,}" if isinstance(value, int) else str(value)


def without_name(problem: str, file: str, *, in_commands: bool = True) -> str:
    """Return a problem without the name of its recording, so that it is the same for others: of `scan`, not /scan.

    Args:
        problem: the problem.
        file: the path of the recording.
        in_commands: True to write FILE for the name in commands between backticks, False to leave commands as they are.
    """
    name = re.compile(rf"{re.escape(file)}|(?<![\w/.-]){re.escape(Path(file).name)}(?!\.?[\w/-])")
    parts = problem.split("`")
    parts[::2] = [name.sub("", part) for part in parts[::2]]
    if in_commands:
        parts[1::2] = [name.sub("FILE", part) for part in parts[1::2]]
    return "`".join(parts).strip(": ")


def short(files: Sequence[str]) -> dict[str, str]:
    """Return the names of files without their common folder; a mixture of files and URLs has none."""
    try:
        base = os.path.commonpath([os.path.dirname(file) for file in files])
    except ValueError:
        return {file: file for file in files}
    return {file: os.path.relpath(file, base) for file in files}


def _plain(value: Any) -> Any:
    return value.isoformat() if isinstance(value, datetime) else value

"""The same table of many recordings, written as they are read."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..notebook.progress import without_bars
from ..recording import open as open_recording
from ..recordings.columns.tables import library
from ..recordings.field_table import check_request
from ..repair import RecordingError
from ..runtime.output_file import checked_output, whole_file
from ..runtime.text import many
from ._engine import LONGEST
from ._fleet_table import Unread, not_read, with_problems
from ._gather import gather
from .places import places_in_index


class DriveTable:
    """Fields of many recordings, a row for each time, with the ``file``; see `Drives.table`.

    Nothing is read before it is written or converted. Then a recording without one of the fields is left out, and
    `unread` has it with the reason. Rows of one recording stand together, in the order of time.

    Args:
        files: the recordings.
        names: as for `Recording.table`.
        at: as for `Recording.table`.
        how: as for `Recording.table`.
        executor: as for `find`.
        longest: as for `find`.
    """

    def __init__(
        self,
        files: Sequence[str],
        names: Sequence[str],
        at: str | float | None,
        how: str,
        executor: Any = None,
        longest: float = LONGEST,
    ) -> None:
        check_request(names, at, how)
        self.files, self.names = tuple(files), tuple(names)
        self._job = _Table(self.names, at, how)
        self._executor, self._longest = executor, longest
        self.unread: tuple[Unread, ...] = ()
        """The recordings that were left out last time, with the reasons."""
        self.problems: dict[str, tuple[str, ...]] = {}
        """The problems of recordings that were read last time, as in `Recording.losses`: rows may be missing."""

    def to_parquet(self, path: str | os.PathLike[str]) -> Path:
        """Write a Parquet file while the recordings are read, and return its path.

        Numbers are written as float64 or int64. Only the recordings under way are in memory. The file appears when it
        is complete, and replaces an existing one.

        Raises:
            ImportError: pyarrow is not installed. ValueError: the name does not end in ``.parquet``. RecordingError: no
                recording has these fields. OSError: the file cannot be written.
        """
        parquet = library("pyarrow.parquet", "to_parquet")
        target = checked_output("to_parquet", path, (".parquet",))
        with whole_file(target) as file:
            writers: list[Any] = []

            def write(table: Any) -> None:
                if not writers:
                    writers.append(parquet.ParquetWriter(file, table.schema, compression="zstd"))
                writers[0].write_table(table)

            try:
                self._read(write)
            finally:
                for writer in writers:
                    writer.close()
        return target

    def to_arrow(self) -> Any:
        """Return a pyarrow Table in memory; raise as `to_parquet`."""
        tables: list[Any] = []
        self._read(tables.append)
        return library("pyarrow", "to_arrow").concat_tables(tables)

    def to_pandas(self) -> Any:
        """Return a pandas DataFrame in memory; raise as `to_parquet`."""
        library("pandas", "to_pandas")
        return self.to_arrow().to_pandas()

    def to_polars(self) -> Any:
        """Return a polars DataFrame in memory; raise as `to_parquet`."""
        return library("polars", "to_polars").from_arrow(self.to_arrow())

    def _read(self, put: Callable[[Any], None]) -> None:
        """Pass the rows of each recording on as a pyarrow Table; raise KeyboardInterrupt after an interrupt."""
        sink = _Sink(put)
        gathered = gather(
            self._job,
            places_in_index(self.files),
            sink,
            "Reading the table",
            executor=self._executor,
            longest=self._longest,
        )
        self.unread, self.problems = tuple(gathered.rows["unread"]), sink.problems
        if gathered.rows["until"] is not None:
            raise KeyboardInterrupt
        if sink.schema is None:
            why = next(iter(not_read(self.unread)), "the index is empty")
            raise RecordingError(f"none of {many(len(self.files), 'recording')} has {', '.join(self.names)}: {why}")

    def __repr__(self) -> str:
        lines = [f"{type(self).__name__} of {', '.join(self.names)} in {many(len(self.files), 'recording')}"]
        complaints = (*not_read(self.unread), *with_problems(self.problems))
        return "\n".join([*lines, *(f"! {line}" for line in complaints)])


class _Table:
    """A function that returns the columns of one recording, and its problems."""

    def __init__(self, names: tuple[str, ...], at: str | float | None, how: str) -> None:
        self._names, self._at, self._how = names, at, how

    def __call__(self, path: str) -> dict[str, Any]:
        with open_recording(path) as recording, without_bars():
            try:
                columns = recording.table(*self._names, at=self._at, how=self._how).to_numpy()
            except TypeError as error:  # the field has several values in this recording
                return {"problem": str(error)}
            return {"columns": columns, "problems": recording.losses}


class _Sink:
    """A `ResultStore` that stores nothing, and passes the rows of each recording on.

    Args:
        put: takes a pyarrow Table.
    """

    problem = ""

    def __init__(self, put: Callable[[Any], None]) -> None:
        self._arrow = library("pyarrow", "table")
        self._put = put
        self.schema: Any = None
        """The schema of the first recording, which the others follow."""
        self.problems: dict[str, tuple[str, ...]] = {}
        """The problems of each recording that has some."""

    def get(self, state: str) -> Any:  # noqa: ARG002
        return None

    def add(self, path: str, state: str | None, result: Mapping[str, Any]) -> Any:  # noqa: ARG002
        arrow = self._arrow
        columns = result["columns"]
        file = arrow.array([path] * len(columns["times_ns"]), arrow.string())
        table = arrow.table({"file": file, **{name: self._array(column) for name, column in columns.items()}})
        if self.schema is None:
            self.schema = table.schema
        try:
            rows = table.cast(self.schema)
        except (ValueError, arrow.ArrowInvalid, arrow.ArrowNotImplementedError):
            own = ", ".join(f"{one.name} ({one.type})" for one in table.schema if one not in self.schema)
            return {"problem": f"its columns differ from the columns of the other recordings: {own or 'fewer'}"}
        self._put(rows)
        if result["problems"]:
            self.problems[path] = result["problems"]
        return {}

    def _array(self, column: NDArray[Any]) -> Any:
        """Return a column in a type that does not depend on the messages: float64, int64, uint64, bool or text."""
        kind, arrow = column.dtype.kind, self._arrow
        if kind == "O":
            return arrow.array(column.tolist(), arrow.string())
        wide = column if kind == "b" else column.astype({"f": np.float64, "i": np.int64}.get(kind, column.dtype))
        if kind == "u" and column.dtype.itemsize < 8:
            wide = column.astype(np.int64)
        return arrow.array(np.ma.getdata(wide), mask=np.ma.getmaskarray(wide) if np.ma.isMaskedArray(wide) else None)

"""The Parquet file of an index: its columns, and its drives as arrays, so that a million of them need few objects."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..laser.row import LASER
from ..recordings.columns.tables import RowType, date, library, number, short_number, text, whole
from ..recordings.search.base import Condition
from ..recordings.search.seconds import NEAREST, NUMBERS, SPEEDS, SecondRows, Texts, field_columns
from ..repair import RecordingError
from ..speed.row import SPEED
from ..touch.row import TOUCH

FORM = 1
TEXTS = ("touched", "sensors", *(kind.sample_name for kind in (LASER, SPEED, TOUCH)))
_OF_DRIVE = ("file", "state", "problem")
_COLUMNS: dict[str, RowType] = {
    **dict.fromkeys(_OF_DRIVE, text),
    "start_ns": whole,
    "second": whole,
    "date": date,
    **{name: short_number if name in NEAREST else number for name in NUMBERS},
    **dict.fromkeys(TEXTS, text),
}
"""The columns with their types, without fields."""
_AHEAD: dict[str, Any] = {"batch_readahead": 4, "fragment_readahead": 1}
"""Rows that are read ahead, which take memory."""


class RuledOut(NamedTuple):
    """Answers of an index without its recordings, each of shape (N,).

    ``seconds``: the time in which a condition was false for certain. ``lacks``: True if the recording may lack a topic
    or a field of the condition, which only a search reports.
    """

    seconds: NDArray[np.float64]
    lacks: NDArray[np.bool_]


class IndexFile:
    """An index in a file or a folder.

    Args:
        path: the file, or a folder of such files.

    Raises:
        RecordingError: the path is not an index.
        ImportError: pyarrow is not installed.
    """

    def __init__(self, path: Path) -> None:
        dataset, arrow = library("pyarrow.dataset", "drives"), library("pyarrow", "drives")
        try:
            plain = dataset.dataset(path, format="parquet")
            about = json.loads(plain.schema.metadata[b"robowidgets"])
        except (OSError, arrow.ArrowInvalid, KeyError, TypeError, ValueError) as error:
            why = f" ({error})" if isinstance(error, OSError) else ""
            raise RecordingError(
                f"{path.name} is not an index of drives{why}: robowidgets.index() writes one"
            ) from None
        if about["form"] != FORM:
            raise RecordingError(f"{path.name} was written by another version of robowidgets: index again")
        self.topics: tuple[str, ...] = tuple(about["topics"])
        self.fields: tuple[str, ...] = tuple(about.get("fields", ()))
        self.identity: str | None = about["identity"]
        self._texts = {*_OF_DRIVE, *TEXTS, *self.fields}
        as_dictionary = dataset.ParquetReadOptions(dictionary_columns=self._texts)
        self._dataset = dataset.dataset(path, format=dataset.ParquetFileFormat(read_options=as_dictionary))
        self._name, self._states_of_files = path.name, self._state()

    @property
    def dataset(self) -> Any:
        """The rows as a pyarrow dataset.

        Raises:
            RecordingError: the index was written again since.
        """
        if self._state() != self._states_of_files:
            raise RecordingError(f"{self._name} was written again, or removed: open it again by robowidgets.drives()")
        return self._dataset

    def _state(self) -> list[tuple[int, int, int] | None]:
        """Return the state of each file, or None for a missing one."""
        found = []
        for file in map(Path, self._dataset.files):
            there = file.stat() if file.exists() else None
            found.append(there and (there.st_ino, there.st_mtime_ns, there.st_size))
        return found

    @cached_property
    def files(self) -> Any:
        """The recordings as a pyarrow array of texts, in any order."""
        return self._of_drives("file")

    @cached_property
    def states(self) -> Any:
        """The state of each recording when it was read, null if it was unknown or it could not be read."""
        arrow, compute = library("pyarrow", "drives"), library("pyarrow.compute", "drives")
        nothing = arrow.scalar(None, arrow.large_string())
        return compute.if_else(compute.is_null(self.problems), self._of_drives("state"), nothing)

    @cached_property
    def problems(self) -> Any:
        """The reason why each recording could not be read, or null."""
        return self._of_drives("problem")

    @cached_property
    def missing_fields(self) -> list[str]:
        """The fields without a value, for example because of a wrong name."""
        field = library("pyarrow.dataset", "drives").field
        found = {one: self.dataset.head(1, columns=[one], filter=field(one).is_valid()) for one in self.fields}
        return [one for one, values in found.items() if not len(values)]

    @cached_property
    def has_state(self) -> NDArray[np.bool_]:
        """True for each recording that has a state, found without the texts of the states, which are long."""
        dataset = library("pyarrow.dataset", "drives")
        found = self._of_drives({"state": dataset.field("state").is_valid() & dataset.field("problem").is_null()})
        return np.asarray(found.to_numpy(False), bool)

    def _of_drives(self, column: str | Mapping[str, Any]) -> Any:
        """Return a column of the first row of each recording."""
        return self._first(column) if self._chosen is None else self._first(column).take(self._chosen)

    @cached_property
    def _chosen(self) -> Any:
        """The first rows that count, or None for all: if files of a folder have the same recording, its last one."""
        files = self._first("file")
        if len(library("pyarrow.compute", "drives").unique(files)) == len(files):
            return None
        places = {file: place for place, file in enumerate(files.to_pylist())}
        return library("pyarrow", "drives").array(places.values())

    @property
    def has_repeats(self) -> bool:
        """True if files of a folder have the same recording."""
        return self._chosen is not None

    def _first(self, column: str | Mapping[str, Any]) -> Any:
        second = library("pyarrow.dataset", "drives").field("second")
        columns = [column] if isinstance(column, str) else column
        return _flat(self.dataset.to_table(columns, filter=second.is_null() | (second == 0), **_AHEAD).column(0))

    def possible(self, wanted: Condition) -> NDArray[np.bool_]:
        """Return True for each of `files` in which a condition may have been true, according to its rows."""
        found = []
        for batch in self.batches(dict.fromkeys(["file", LASER.sample_name, *self._asked(wanted)])):
            files = batch.column("file")
            is_possible = wanted.possible(SecondRows(*self._columns(batch))).true
            found.append(_names(files, files.indices.to_numpy(False)[is_possible]))
        return self.among(found)

    def _asked(self, wanted: Condition) -> list[str]:
        """Return the columns that a condition reads."""
        asked = _Asked(_with_fields(self.fields))
        wanted.possible(_NoRows(asked, asked))
        return asked.names

    def _columns(self, batch: Any) -> tuple[dict[str, NDArray[Any]], dict[str, Texts]]:
        """Return the columns of numbers and of texts of some rows."""
        columns = {name: batch.column(name) for name in batch.schema.names if name not in ("file", "second")}
        return (
            {name: column.to_numpy(False) for name, column in columns.items() if name not in self._texts},
            {name: _to_texts(column) for name, column in columns.items() if name in self._texts},
        )

    def among(self, files: Iterable[Any]) -> NDArray[np.bool_]:
        """Return True for each of `files` that is in one of some pyarrow arrays."""
        arrow, compute = library("pyarrow", "drives"), library("pyarrow.compute", "drives")
        there = arrow.chunked_array([one.cast(arrow.large_string()) for one in files], arrow.large_string())
        found: NDArray[np.bool_] = compute.is_in(self.files, value_set=there).to_numpy(False)
        return found

    def ruled_out(self, wanted: Condition) -> RuledOut:
        """Return the seconds in which a condition was false for certain, in each of `files`.

        A row counts until the next one, if the condition is false in it whatever its unknown columns would be.
        """
        asked = self._asked(wanted)
        files, seconds, lacking = [], [], []
        before: tuple[str, int, bool] | None = None
        """The file, the second and the answer of the last row of the batch before."""
        for batch in self.batches(dict.fromkeys(["file", "second", LASER.sample_name, *asked])):
            if not len(batch):
                continue
            numbers, texts = self._columns(batch)
            file, second = batch.column("file"), batch.column("second").fill_null(-1).to_numpy(False)
            codes = file.indices.to_numpy(False)
            topics = {name: texts[name] for name in texts if name in asked and name not in ("touched", "sensors")}
            lacks = np.any([np.zeros(len(codes), bool), *(one.numbers < 0 for one in topics.values())], axis=0)
            lacking.append(_names(file, codes[lacks]))
            texts |= {name: self._if_known(name, topics[name], numbers) for name in topics}
            is_false = ~wanted.possible(SecondRows(numbers, texts)).true & (second >= 0)
            length = np.where(np.append(codes[1:] == codes[:-1], False), np.append(np.diff(second), 1), 1)
            files.append(file.dictionary)
            seconds.append(np.bincount(codes[is_false], length[is_false], len(file.dictionary)))
            first = str(file[0])
            if before and before[0] == first and before[2]:
                files.append(file.dictionary.slice(int(codes[0]), 1))
                seconds.append(np.array([second[0] - before[1] - 1.0]))
            before = str(file[-1]), int(second[-1]), bool(is_false[-1])
        return RuledOut(self._sums(files, seconds), self.among(lacking))

    def _if_known(self, name: str, texts: Texts, numbers: Mapping[str, NDArray[Any]]) -> Texts:
        """Return the topics or types of the rows with one of their values; the others look like rows without them."""
        columns = [numbers[one] for one in self._values_of(name) if one in numbers]
        if not columns:
            return texts
        has_texts = texts.where({one: one.startswith("[") and one != "[]" for one in texts.texts})
        is_unknown = np.isnan(columns).all(axis=0) & ~has_texts
        return Texts(np.where(is_unknown, -1, texts.numbers), texts.texts)

    def _values_of(self, name: str) -> Iterable[str]:
        """Return the columns of numbers that come from a topic or a field."""
        if name in self.fields:
            return field_columns(name)
        of_speed = (column for columns in SPEEDS.values() for column in columns)
        return NEAREST if name == LASER.sample_name else of_speed if name == SPEED.sample_name else ()

    def _sums(self, files: list[Any], values: list[NDArray[Any]]) -> NDArray[np.float64]:
        """Return the sum of the values of each of `files`, from parts in which a file may be again."""
        arrow, compute = library("pyarrow", "drives"), library("pyarrow.compute", "drives")
        names = arrow.chunked_array([one.cast(arrow.large_string()) for one in files], arrow.large_string())
        found = np.zeros(len(self.files))
        if len(names):
            np.add.at(found, compute.index_in(names, value_set=self.files).to_numpy(), np.concatenate(values))
        return found

    def unread(self) -> Iterator[tuple[str, str]]:
        """Yield each recording that could not be read, with the reason."""
        has_one = library("pyarrow.compute", "drives").is_valid(self.problems)
        yield from zip(*(column.filter(has_one).to_pylist() for column in (self.files, self.problems)), strict=True)

    def first_values(self, column: str) -> Any:
        """Return the value of a column in the first row of each of `files`, as a pyarrow array."""
        return self._of_drives(column)

    def batches(self, columns: Iterable[str]) -> Iterator[Any]:
        """Yield some columns of all rows, part by part; only some parts are in memory."""
        yield from self.dataset.to_batches(columns=list(columns), **_AHEAD)


class _NoRows(SecondRows):
    def __len__(self) -> int:
        return 0


class _Asked(Mapping[str, Any]):
    """Columns without rows, which note the columns that a condition reads.

    Args:
        columns: the columns with their types.
    """

    def __init__(self, columns: Mapping[str, RowType]) -> None:
        self.names: list[str] = []
        self._columns = columns

    def __getitem__(self, name: str) -> Any:
        kind = self._columns[name]
        self.names.append(name)
        return Texts(np.empty(0, int), []) if kind is text else np.empty(0)

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)


def schema_of(fields: Iterable[str], about: Mapping[str, Any]) -> Any:
    """Return the schema of an index.

    Args:
        fields: its fields.
        about: plain data about it.
    """
    arrow = library("pyarrow", "index")
    columns = [(name, kind(arrow)) for name, kind in _with_fields(fields).items()]
    return arrow.schema(columns, {"robowidgets": json.dumps(about)})


def _with_fields(fields: Iterable[str]) -> dict[str, RowType]:
    """Return the columns of an index with their types."""
    columns = dict(_COLUMNS)
    for field in fields:
        least, most = field_columns(field)
        columns |= {least: number, most: number, field: text}
    return columns


def _flat(column: Any) -> Any:
    """Return a chunked column of pyarrow as one array; texts as large ones, which have room for any number."""
    arrow = library("pyarrow", "drives")
    if arrow.types.is_dictionary(column.type):
        column = column.cast(arrow.string()).cast(arrow.large_string())
    found = column.combine_chunks()
    if not isinstance(found, arrow.ChunkedArray):
        return found
    return found.chunk(0) if found.num_chunks else arrow.array([], found.type)


def _names(column: Any, codes: NDArray[np.integer[Any]]) -> Any:
    """Return the different texts with some numbers in a dictionary column of pyarrow."""
    return column.dictionary.take(library("pyarrow", "drives").array(np.unique(codes)))


def _to_texts(column: Any) -> Texts:
    """Return the texts of a dictionary column of pyarrow."""
    return Texts(column.indices.fill_null(-1).to_numpy(False), column.dictionary.to_pylist())

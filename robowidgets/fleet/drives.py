"""An index of many recordings: a summary of each second of each, as one Parquet file."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from itertools import starmap
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..files.remote import is_url
from ..notebook.progress import without_bars
from ..recording import open as open_recording
from ..recordings.columns.tables import library
from ..recordings.search import conditions
from ..recordings.search.base import Condition, condition
from ..recordings.search.instant import Instant
from ..recordings.search.seconds import SECOND, seconds_of
from ..recordings.times import has_date
from ..repair import RecordingError, natural
from ..runtime.output_file import checked_output, whole_file
from ..runtime.tables import HasTable, Table
from ..runtime.text import many
from ._engine import LONGEST
from ._fleet_table import Unread, not_read
from ._gather import FromAll, gather, identity_or_none
from ._index_file import FORM, TEXTS, IndexFile, schema_of
from ._kept import states_of
from ._topics import chosen_of
from .drive_table import DriveTable
from .hits import Hits
from .places import PathLike, places_in_index
from .rate_comparison import RateComparison, SearchedSet
from .search import hits_of, search
from .statistics import By, Statistics, statistics

_ROWS = 100_000
"""Rows that are written at once: the size of a row group of the file."""
LATER = "not read before an interrupt: the same call continues"


class Drives(HasTable):
    """An index of recordings, written by `index`: a row for each second of each recording.

    The columns: ``file``, ``start_ns``, ``second`` from its start, and its ``date`` in UTC; ``nearest``, ``front``,
    ``left``, ``back`` and ``right``, the nearest distance in metres in each sector; ``linear_x_min`` to
    ``angular_z_max``, the lowest and the highest speed by axis in m/s and rad/s; ``touched``, the touched sensors, as
    text; ``gap``, the longest silence in seconds that overlaps it; ``x``, ``y`` and ``yaw`` by odometry; ``scan``,
    ``speed`` and ``touch``, the topics. For each field, such as ``/battery.percentage``, three: ``_min`` and ``_max``
    after its name, with the last value before too, however old, and under its name its type, or for texts a list of the
    different ones as JSON. Unknown values are null. Seconds without a message have no row: a row is valid
    until the next one. A recording that could not be read has one row with the reason as ``problem``.

    Args:
        path: the file, or a folder of such files.

    Raises:
        RecordingError: the path is not an index.
        ImportError: pyarrow is not installed.
    """

    def __init__(self, path: PathLike) -> None:
        if not isinstance(path, (str, os.PathLike)):
            raise TypeError(f"drives(): expected the path of an index, got {path!r}")
        self.path = Path(os.fsdecode(path)).expanduser().absolute()
        self.index_file = IndexFile(self.path)
        """Its drives as arrays."""
        self.topics = self.index_file.topics
        """Names and patterns of preferred topics, for recordings with several topics of a kind."""
        self.fields = self.index_file.fields
        """The fields of topics whose values it has."""
        self.identity = self.index_file.identity

    def __len__(self) -> int:
        return len(self.index_file.files)

    @property
    def dataset(self) -> Any:
        """The rows as a pyarrow dataset; raises RecordingError if the index was written again since."""
        return self.index_file.dataset

    @cached_property
    def files(self) -> tuple[str, ...]:
        """The recordings, sorted by name."""
        return tuple(sorted(self.index_file.files.to_pylist(), key=natural))

    @cached_property
    def states(self) -> dict[str, str | None]:
        """The state of each recording when it was read, or None if the state was unknown or it could not be read."""
        return dict(zip(self.index_file.files.to_pylist(), self.index_file.states.to_pylist(), strict=True))

    @property
    def unread(self) -> tuple[Unread, ...]:
        """The recordings that could not be read, with the reasons."""
        return tuple(starmap(Unread, self.index_file.unread()))

    def to_arrow(self) -> Any:
        """Return the whole index as a pyarrow Table."""
        return self.dataset.to_table()

    def candidates(self, given: Condition | Callable[..., Any], *, check: bool = True) -> list[str]:
        """Return the recordings in which a condition may have been true, according to the index.

        The index is enough for `nearest_below`, `speed_above`, `touched` and `gap`, for a `field` that it has, and for
        combinations of them. Recordings that could not be read, or have changed since, are always included.

        Args:
            given: as for `find`.
            check: False to trust the index: the other recordings are not looked up, so that changes are not noticed.

        Raises:
            TypeError: ``given`` is not a condition.
        """
        found = self.index_file.possible(condition(given))
        found |= ~self.index_file.has_state
        if check:
            ruled_out = np.flatnonzero(~found)
            found[ruled_out[self._are_changed(ruled_out)]] = True
        return sorted(self.index_file.files.filter(library("pyarrow", "drives").array(found)).to_pylist(), key=natural)

    def _are_changed(self, which: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return True for each of some recordings, by number, that is not in the same state as when it was read."""
        found = np.zeros(len(which), bool)
        for start in range(0, len(which), _ROWS):
            part = which[start : start + _ROWS]
            files, before = (
                column.take(part).to_pylist() for column in (self.index_file.files, self.index_file.states)
            )
            now = states_of(file if is_url(file) else Path(file) for file in files)
            found[start : start + _ROWS] = [now[file].text != state for file, state in zip(files, before, strict=True)]
        return found

    def find(
        self,
        given: Condition | Callable[[Instant], Any],
        *,
        check: bool = True,
        executor: Any = None,
        longest: float = LONGEST,
        keep: bool = True,
    ) -> Hits:
        """Return the results of `robowidgets.find` in these recordings. Only `candidates` are read.

        Args:
            given: as for `find`.
            check: as for `candidates`.
            executor: as for `find`.
            longest: as for `find`.
            keep: as for `find`.

        Raises:
            TypeError: as for `find`.
        """
        wanted = condition(given)
        return hits_of(wanted, _search(self, wanted, self.candidates(wanted, check=check), executor, longest, keep))

    def table(
        self,
        *names: str,
        at: str | float | None = None,
        how: str = "last",
        executor: Any = None,
        longest: float = LONGEST,
    ) -> DriveTable:
        """Return `Recording.table` of all these recordings, which is read while it is written or converted.

        Args:
            *names: as for `Recording.table`.
            at: as for `Recording.table`.
            how: as for `Recording.table`.
            executor: as for `find`.
            longest: as for `find`.

        Raises:
            TypeError, ValueError: as `Recording.table`.

        Example:
            >>> drives.table("/scan.front", "/odom.twist.twist.linear.x").to_parquet("speeds.parquet")
            ... # doctest: +SKIP
        """
        return DriveTable(self.files, names, at, how, executor, longest)

    def statistics(
        self,
        *fields: str | conditions.Field,
        by: By | None = None,
        quantiles: Iterable[float] = (0.05, 0.5, 0.95),
        executor: Any = None,
        longest: float = LONGEST,
    ) -> Statistics:
        """Return counts, mean, limits and quantiles of numbers in all these recordings, each message counted once.

        The recordings are read message by message. Quantiles are exact up to 100,000 different values in a group;
        beyond, they differ from the exact ones by 0.1 % of the size of the neighbouring values at most, in any order of
        the recordings.

        Args:
            *fields: topics with fields or sectors, such as ``"/odom.twist.twist.linear.x"`` and ``"/scan.front"``;
                sectors of the scan of each recording, such as ``"front"`` or ``"nearest"``; axes of its speed, such as
                ``"linear.x"``; or fields, such as ``abs(conditions.field("/imu.angular_velocity.z"))``.
            by: the groups: ``"file"``, ``"folder"``, ``"day"`` in UTC; a column of texts of the index, such as
                ``"scan"``; a topic with a field whose first value counts, such as ``"/version.data"``; a mapping from
                files, or a function of the file, to the name of the group (None stays null); or None for all together.
            quantiles: numbers from 0 to 1.
            executor: as for `find`.
            longest: as for `find`.

        Raises:
            TypeError, ValueError: an argument is not as described. RecordingError: no recording has one of the fields.

        Example:
            >>> drives.statistics("front", "linear.x", by="folder").to_pandas()  # doctest: +SKIP
        """
        known = None
        if isinstance(by, str) and by not in ("file", "folder") and not by.startswith("/"):
            known = self._group_by(by)
        return statistics(self.files, fields, by, known, quantiles, self.topics, executor, longest)

    def compare(
        self,
        other: Drives,
        given: Condition | Callable[[Instant], Any],
        *,
        check: bool = True,
        executor: Any = None,
        longest: float = LONGEST,
        keep: bool = True,
    ) -> RateComparison:
        """Return how often a condition becomes true per hour in these drives and in others, with the difference.

        Both are searched by `find`. Time counts if the condition is true or false: not while it is unknown, such as
        without a scan. The interval of the difference is computed, not drawn by lot: equal for equal drives.
        `RateComparison.by_file` and `RateComparison.by_place` show the spans. An interrupt ends both searches.

        Args:
            other: the other drives, such as the ones of a new version.
            given: as for `find`.
            check: as for `candidates`.
            executor: as for `find`.
            longest: as for `find`.
            keep: as for `find`.

        Raises:
            TypeError: ``other`` is not an index, or as for `find`. ValueError: it is this index. RecordingError: files
                of a folder have the same recording.

        Example:
            >>> old.compare(new, robowidgets.conditions.touched())  # doctest: +SKIP
        """
        if not isinstance(other, Drives):
            raise TypeError(f"compare(): expected drives of another index, as from robowidgets.drives(), got {other!r}")
        wanted = condition(given)
        if self.path.resolve() == other.path.resolve():
            raise ValueError(f"compare(): expected another index, got {self.path.name} twice")
        for drives in (self, other):
            if drives.index_file.has_repeats:
                raise RecordingError(
                    f"{drives.path.name} has a recording in several of its files, so its hours would count twice: "
                    "index the recordings in one file"
                )
        sets: list[SearchedSet] = []
        for drives in (self, other):
            found, known = FromAll({}, {"files": drives.files, "unread": [], "until": 0, "note": ""}), {}
            if not sets or sets[0].hits.is_complete:
                known = _ruled_out(drives, wanted, check)
                asked = [file for file in drives.files if file not in known]
                found = _search(drives, wanted, asked, executor, longest, keep)
            known |= {file: result["known"] for file, result in found.results.items()}
            name = drives.path.stem if self.path.stem != other.path.stem else str(drives.path)
            sets.append(SearchedSet(name, hits_of(wanted, found), drives.index_file, known))
        return RateComparison(str(wanted), *sets)

    def _group_by(self, by: str) -> dict[str, str | None]:
        """Return the group of each recording by a column of the index, or by day, or None if it is unknown."""
        columns = [name for name in TEXTS if name != "touched"]
        if by not in (*columns, "day"):
            there = ", ".join(map(repr, ("file", "folder", "day", *columns)))
            raise ValueError(f"by: expected one of {there}, a topic with a field, a mapping or a function, got {by!r}")
        values = self.index_file.first_values("date" if by == "day" else by).to_pylist()
        texts = (value if value is None or by != "day" else f"{value:%Y-%m-%d}" for value in values)
        return dict(zip(self.index_file.files.to_pylist(), texts, strict=True))

    def _table(self) -> Table:
        head = f"{self.path.name}: {many(len(self), 'recording')}, {many(self.dataset.count_rows(), 'row')}"
        missing = [
            f"no recording has {field}; robowidgets.open(...).fields(topic) shows the fields of a topic"
            for field in self.index_file.missing_fields
        ]
        return Table(head, (), (), problems=[*not_read(self.unread), *missing])


def drives(path: PathLike) -> Drives:
    """Open an index that `index` wrote; see `Drives`."""
    return Drives(path)


def _search(drives: Drives, wanted: Condition, asked: list[str], executor: Any, longest: float, keep: bool) -> FromAll:
    """Return the results of a search through some of the recordings, with a line on the others."""
    ruled_out = len(drives) - len(asked)
    found = FromAll({}, {"unread": [], "until": None, "note": ""})
    if asked:
        found = search(wanted, places_in_index(asked), drives.topics, executor, longest, keep)
    until = found.rows["until"]
    told = f"by the index {many(ruled_out, 'file')} had no such moment, and were not read" if ruled_out else ""
    files = drives.index_file.files.to_pylist()
    found.rows.update(files=files, until=until and until + ruled_out, told=told)
    return found


def _ruled_out(drives: Drives, wanted: Condition, check: bool) -> dict[str, float]:
    """Return the recordings that need no search, with the seconds in which the condition was false.

    Recordings without a topic of the condition are not among them, because only a search reports them.
    """
    seconds, lacks = drives.index_file.ruled_out(wanted)
    files = drives.index_file.files
    asked = {
        *drives.candidates(wanted, check=check),
        *files.filter(library("pyarrow", "drives").array(lacks)).to_pylist(),
    }
    known = zip(files.to_pylist(), seconds.tolist(), strict=True)
    return {file: one for file, one in known if file not in asked}


def is_index(paths: Sequence[PathLike]) -> bool:
    """Return True if paths name an index, and not recordings."""
    return len(paths) == 1 and Path(paths[0]).suffix == ".parquet"


def index(
    *paths: PathLike,
    output: PathLike,
    topics: str | Iterable[str] = (),
    fields: str | Iterable[str] = (),
    executor: Any = None,
    longest: float = LONGEST,
) -> Drives:
    """Write a summary of each second of many recordings, so that a search can skip most of them: see `Drives`.

    The index contains exactly the given recordings. Recordings that are in an earlier index of this name, and have not
    changed, are not read again. An interrupt (stop the cell, Ctrl-C) keeps the finished part; the same call continues.

    Args:
        *paths: as for `find`.
        output: the file, such as ``"drives.parquet"``; an existing file is replaced when the new one is complete.
        topics: as for `find`.
        fields: fields of topics whose values it has too, such as ``"/battery.percentage"``, so that conditions on them
            need no recordings. A field is one number, flag or text in each message.
        executor: as for `find`.
        longest: as for `find`.

    Raises:
        TypeError: as for `find`. ValueError: as for `find`, a field is not a topic with a field, or the name does not
            end in ``.parquet``. ImportError: pyarrow is not installed. OSError: the file cannot be written.

    Example:
        >>> drives = robowidgets.index("runs/", output="drives.parquet")  # doctest: +SKIP
        >>> drives.find(robowidgets.conditions.nearest_below(0.3))  # doctest: +SKIP
    """
    parquet = library("pyarrow.parquet", "index")
    target = checked_output("index", output, (".parquet",))
    names = (topics,) if isinstance(topics, str) else tuple(topics)
    if not isinstance(fields, (str, Iterable)):
        raise TypeError(f"fields: expected topics with fields, such as '/battery.percentage', got {fields!r}")
    columns = tuple(
        dict.fromkeys(conditions.field(name).name for name in ((fields,) if isinstance(fields, str) else fields))
    )
    identity = identity_or_none(("index", FORM, names, columns) if columns else ("index", FORM, names))
    about = {"form": FORM, "topics": names, "identity": identity, "fields": columns}
    schema = schema_of(columns, about)
    with whole_file(target) as file, parquet.ParquetWriter(file, schema, compression="zstd") as writer:
        rows = _Rows(schema, writer, _earlier(target, identity))
        gathered = gather(_Index(names, columns), paths, rows, "Indexing", executor=executor, longest=longest)
        unread = {one.file: one.problem for one in gathered.rows["unread"]}
        later = {file: LATER for file in gathered.rows["files"] if file not in gathered.results}
        rows.finish({**later, **unread})
    return Drives(target)


class _Index:
    """A function that returns the rows of one recording.

    Args:
        topics: names and patterns of topics.
        fields: names of fields.
    """

    def __init__(self, topics: tuple[str, ...], fields: tuple[str, ...]) -> None:
        self._topics, self._fields = topics, fields

    def __call__(self, path: str) -> dict[str, Any]:
        with open_recording(path) as recording, without_bars():
            recording.preferred = frozenset(chosen_of(recording, self._topics))
            return {**seconds_of(recording, self._fields), "start_ns": recording.start_ns}


class _Rows:
    """The rows of an index that is being written.

    Args:
        schema: the schema of its columns.
        writer: a Parquet writer.
        earlier: an earlier index with some of the recordings.
    """

    problem = ""

    def __init__(self, schema: Any, writer: Any, earlier: Drives | None) -> None:
        self._arrow = library("pyarrow", "index")
        self._schema, self._writer, self._earlier = schema, writer, earlier
        self._states = {state for state in earlier.states.values() if state} if earlier else set()
        self._again: set[str] = set()
        self._tables: list[Any] = []

    def get(self, state: str) -> Any:
        """Return an empty result for a recording that the earlier index has, or None."""
        if state not in self._states:
            return None
        self._again.add(state)
        return {}

    def add(self, path: str, state: str | None, result: Any) -> Any:
        """Write the rows of a recording; return an empty result, because nothing stays in memory."""
        start, second = result["start_ns"], result["second"]
        columns = {"file": path, "state": state, **result}
        if len(second) and has_date(start):
            columns["date"] = (start + second * SECOND) // 1000
        self._put(columns, max(1, len(second)))
        return {}

    def finish(self, unread: Mapping[str, str]) -> None:
        """Write the rows from the earlier index, and rows for recordings that could not be read."""
        for file, problem in unread.items():
            self._put({"file": file, "problem": problem}, 1)
        if self._earlier and self._again:
            among = library("pyarrow.dataset", "index").field("state").isin(sorted(self._again))
            for batch in self._earlier.dataset.to_batches(filter=among):
                self._tables.append(self._arrow.Table.from_batches([batch]).cast(self._schema))
                self._write(_ROWS)
        self._write(1)

    def _put(self, columns: Mapping[str, Any], count: int) -> None:
        arrow = self._arrow
        arrays = []
        for column in self._schema:
            values = columns.get(column.name)
            if values is None or (not isinstance(values, (str, int)) and not len(values)):
                arrays.append(arrow.nulls(count, column.type))
            elif isinstance(values, (str, int)):
                arrays.append(arrow.repeat(arrow.scalar(values, column.type), count))
            else:
                arrays.append(arrow.array(values, column.type, from_pandas=True))
        self._tables.append(arrow.Table.from_arrays(arrays, schema=self._schema))
        self._write(_ROWS)

    def _write(self, least: int) -> None:
        """Write the collected rows, if they are at least so many."""
        if sum(len(table) for table in self._tables) >= least:
            self._writer.write_table(self._arrow.concat_tables(self._tables))
            self._tables.clear()


def _earlier(target: Path, identity: str | None) -> Drives | None:
    """Return the existing index, if its rows were computed like the current ones, or None."""
    try:
        there = Drives(target) if identity and target.exists() else None
    except RecordingError:
        return None
    return there if there and there.identity == identity else None

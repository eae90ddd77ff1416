"""Fields of topics with different rates as one table, at the times of one topic."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from math import floor, inf
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..kinds import topic_and_field
from ..repair import RecordingError
from ..runtime.text import many, megabytes
from ..samples.checks import number
from ..samples.sector import ALL_ROUND, SECTORS, SectorLike
from .columns._fields import Fields
from .columns.scans import Scans
from .columns.tables import Columns, write_parquet
from .topics import Topic

WAYS = ("last", "linear")
_SECTORS: dict[str, SectorLike] = {"nearest": ALL_ROUND, **SECTORS}
"""The distances of a scan that have a name, like its fields."""

_KEPT = ("bool", "string", "wstring", "time", "duration")
"""The types of fields that are never interpolated."""


class Tabled(Protocol):
    """The part of a recording that a table reads; see `RecordingData` for each member."""

    @property
    def path(self) -> Path:
        """The file or the folder."""

    @property
    def topics(self) -> tuple[Topic, ...]:
        """The topics."""

    @property
    def start_ns(self) -> int | None:
        """The time of the first message."""

    @property
    def duration(self) -> float:
        """Seconds from the first message to the last."""

    @property
    def memory(self) -> int:
        """The maximum bytes."""

    def fields(self, topic: str) -> Fields:
        """Return the messages of a topic with each field as a column."""

    def series(self, topic: str) -> Any:
        """Return a topic as columns."""


class FieldTable(Columns):
    """Fields of several topics, a row for each time; see `Recording.table`.

    ``table["/odom.twist.twist.linear.x"]`` is a column. In all tables, a number without a message yet is NaN or null.

    Args:
        times_ns: the times of the rows.
        start_ns: the start of the recording.
        columns: the columns by name.
    """

    def __init__(self, times_ns: NDArray[np.int64], start_ns: int, columns: dict[str, NDArray[Any]]) -> None:
        self._times_ns, self._start_ns, self._values = times_ns, start_ns, columns

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(self._values)

    @property
    def times_ns(self) -> NDArray[np.int64]:
        """The times of the rows by the clock of the recording, shape (N,)."""
        return self._times_ns

    @property
    def seconds(self) -> NDArray[np.float64]:
        """The times of the rows in seconds from the start of the recording, shape (N,)."""
        return (self._times_ns - self._start_ns) / 1e9

    def __len__(self) -> int:
        return len(self._times_ns)

    def __getitem__(self, name: str) -> NDArray[Any]:
        try:
            return self._values[name]
        except KeyError:
            raise KeyError(f"no column {name!r}; there are {', '.join(self.names)}") from None

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Return the columns by name, after ``times_ns`` and ``seconds``."""
        return {"times_ns": self._times_ns, "seconds": self.seconds, **self._values}

    def to_parquet(self, path: str | os.PathLike[str]) -> Path:
        """Write a Parquet file, and return its path; an existing one is replaced when the new one is complete.

        Raises:
            ImportError: pyarrow is not installed. ValueError: the name does not end in ``.parquet``. OSError: it cannot
                be written.
        """
        return write_parquet(path, self.to_arrow)

    def __repr__(self) -> str:
        seconds = self.seconds
        span = f", {seconds[0]:.2f} to {seconds[-1]:.2f} s" if len(self) else ""
        return f"{type(self).__name__} of {', '.join(self.names)}: {many(len(self), 'row')}{span}"


class _Column(NamedTuple):
    """The values of a field at the times of its topic, and False if they must not be interpolated."""

    times_ns: NDArray[np.int64]
    values: NDArray[Any]
    is_number: bool


def field_table(recording: Tabled, names: Sequence[str], at: str | float | None, how: str) -> FieldTable:
    """See `Recording.table`."""
    check_request(names, at, how)
    columns = {name: column for given in names for name, column in _columns(recording, given)}
    if at is None:
        at = topic_and_field(names[0], [topic.name for topic in recording.topics])[0]
    times_ns = recording.fields(at).times_ns if isinstance(at, str) else _regular(recording, float(at), len(columns))
    at_times = _last if how == "last" else _linear
    return FieldTable(
        times_ns, recording.start_ns or 0, {name: at_times(column, times_ns) for name, column in columns.items()}
    )


def check_request(names: Sequence[str], at: Any, how: str) -> None:
    """Check the arguments of `Recording.table`.

    Raises:
        TypeError: a name is not a text, no name is given, or ``at`` is neither a topic nor a number. ValueError:
            ``how`` is unknown, or ``at`` is not above 0.
    """
    if not names:
        raise TypeError('table(): expected topics with fields, such as "/odom.twist.twist.linear.x", got none')
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f"table(): expected a topic with a field, as text, got {name!r}")
    if how not in WAYS:
        raise ValueError(f"how: expected one of {', '.join(map(repr, WAYS))}, got {how!r}")
    if at is not None and not isinstance(at, str) and not 0 < number("at", at) < inf:
        raise ValueError(f"at: expected the name of a topic, or seconds between two rows, above 0; got {at!r}")


def _columns(recording: Tabled, given: str) -> Iterator[tuple[str, _Column]]:
    """Yield the columns of a name: one for a field, and one for each field in a message."""
    topic, inner = topic_and_field(given, [one.name for one in recording.topics])
    fields = recording.fields(topic)
    if inner in _SECTORS and inner not in fields.names and isinstance(series := recording.series(topic), Scans):
        yield given, _Column(series.times_ns, series.distances(_SECTORS[inner]), True)
        return
    part = fields[[inner]] if inner else fields
    types = part.types
    single = [name for name in part.names if _is_single(name, types[name])]
    if not single:
        name = part.names[0] if part.names else inner
        raise TypeError(f"{given!r} has several values in a message: name one, such as '{topic}.{name}[0]'")
    values = part[single].to_numpy()
    for name in single:
        column = values[name if name in values else f"{name}_"]
        yield f"{topic}.{name}", _Column(part.times_ns, column, not types[name].startswith(_KEPT))


def _is_single(name: str, type_name: str) -> bool:
    """Return True if a field has one value in each message."""
    return (name.endswith("]") or not type_name.endswith("]")) and "[]" not in name


def _regular(recording: Tabled, period: float, width: int) -> NDArray[np.int64]:
    """Return times with a distance of some seconds, from the start of a recording to its end."""
    if recording.start_ns is None:
        return np.empty(0, np.int64)
    count = floor(recording.duration / period + 1e-9) + 1
    if 8 * count * (width + 1) > recording.memory:
        raise RecordingError(
            f"{recording.path.name}: a row each {period:g} s takes {megabytes(8 * count * (width + 1))}, more than the "
            f"{megabytes(recording.memory)} of recording.memory: give more seconds to at="
        )
    return recording.start_ns + np.round(np.arange(count) * (period * 1e9)).astype(np.int64)


def _before(column: _Column, times_ns: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the row of the last message at each time, or -1 before the first one."""
    if np.array_equal(column.times_ns, times_ns):  # several messages at one time are a row each
        return np.arange(len(times_ns))
    return np.searchsorted(column.times_ns, times_ns, side="right") - 1


def _last(column: _Column, times_ns: NDArray[np.int64]) -> NDArray[Any]:
    values = column.values
    rows = _before(column, times_ns)
    is_missing = rows < 0
    if not len(values):
        values = np.zeros(1, values.dtype)
    picked = np.ma.getdata(values)[rows]
    if values.dtype.kind in "fO":
        picked[is_missing] = np.nan if values.dtype.kind == "f" else None
        return picked
    return np.ma.masked_array(picked, is_missing | np.ma.getmaskarray(values)[rows])


def _linear(column: _Column, times_ns: NDArray[np.int64]) -> NDArray[Any]:
    if not column.is_number:
        return _last(column, times_ns)
    values = np.ma.filled(np.ma.asarray(column.values, np.float64), np.nan)
    found = np.full(len(times_ns), np.nan)
    if not len(values):
        return found
    own, rows = column.times_ns, _before(column, times_ns)
    after = np.minimum(rows + 1, len(values) - 1)
    is_exact = (rows >= 0) & (own[rows] == times_ns)
    found[is_exact] = values[rows[is_exact]]
    inside = ~is_exact & (rows >= 0) & (after > rows)
    a, b = rows[inside], after[inside]
    share = (times_ns[inside] - own[a]) / (own[b] - own[a])
    with np.errstate(invalid="ignore"):
        between = values[a] + (values[b] - values[a]) * share
    between[~np.isfinite(between)] = np.nan
    found[inside] = np.where(values[a] == values[b], values[a], between)
    return found

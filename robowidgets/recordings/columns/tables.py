"""Columns as tables of other libraries, which are imported lazily."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.output_file import checked_output, whole_file

TIMES = ("times_ns", "seconds", "stamps_ns")


class Lists(NamedTuple):
    """A column of lists of any length: an array or a list of texts for each row, and the type of the items."""

    rows: NDArray[Any]
    dtype: np.dtype[Any]


RowType = Callable[[Any], Any]
"""The type of a table column that is made of Python values: a function that makes the type from pyarrow."""

Column = NDArray[Any] | Lists
"""Numbers, flags or texts; an array of objects holds texts or None. Missing values are masked."""


class Columns(ABC):
    """Named columns, which can become tables of other libraries."""

    @abstractmethod
    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Return the columns by name; times as ``times_ns``, ``seconds`` and ``stamps_ns``."""

    def to_pandas(self) -> Any:
        """Return a pandas DataFrame: a row for each time, by seconds from the start.

        Each number of an array of fixed length has its own column, such as ``covariance[0]``; other arrays are values
        of one column.

        Raises:
            ImportError: pandas is not installed.
        """
        return to_pandas(self._columns_of_table())

    def to_polars(self) -> Any:
        """Return a polars DataFrame: a row for each time, ranges of scans as an array.

        Raises:
            ImportError: polars is not installed.
        """
        return to_polars(self._columns_of_table())

    def to_arrow(self) -> Any:
        """Return an Arrow table: a row for each time, ranges of scans as a list of fixed size.

        Raises:
            ImportError: pyarrow is not installed.
        """
        return to_arrow(self._columns_of_table())

    def _columns_of_table(self) -> Mapping[str, Column]:
        """Return the columns for the tables. Their types must not depend on the values."""
        return self.to_numpy()


def to_pandas(columns: Mapping[str, Column]) -> Any:
    """Return a DataFrame by seconds. A two-dimensional column becomes several columns: ``covariance[0]`` and so on."""
    pandas = library("pandas", "to_pandas")
    values: dict[str, Any] = {}
    for name, column in columns.items():
        if name in TIMES:
            continue
        if isinstance(column, Lists):
            values[name] = np.empty(len(column.rows), object)
            values[name][:] = list(column.rows)
        elif column.ndim == 2:
            values.update({f"{name}[{i}]": one for i, one in enumerate(column.T)})
        elif column.dtype == object:
            values[name] = pandas.Series(column, dtype=str).array
        else:
            values[name] = column if not np.ma.isMaskedArray(column) else _nullable(pandas, column)
    return pandas.DataFrame(values, index=_seconds(pandas, columns))


def rays_to_pandas(columns: Mapping[str, NDArray[Any]]) -> Any:
    """Return a DataFrame by seconds with the ranges of scans: a column for each ray, named by its index."""
    pandas = library("pandas", "to_pandas")
    ranges = columns["ranges"]
    rays = pandas.RangeIndex(ranges.shape[1], name="ray")
    return pandas.DataFrame(ranges, index=_seconds(pandas, columns), columns=rays)


def to_polars(columns: Mapping[str, Column]) -> Any:
    """Return a DataFrame with all columns; each value of a two-dimensional column is an array."""
    polars = library("polars", "to_polars")

    def series(name: str, column: Column) -> Any:
        if isinstance(column, Lists):
            if column.dtype == object:
                return polars.Series(name, list(map(list, column.rows)), dtype=polars.List(polars.String))
            inner = series(name, np.empty(0, column.dtype)).dtype
            return polars.Series(name, list(map(polars.Series, column.rows)), dtype=polars.List(inner))
        if column.dtype == object:
            return polars.Series(name, column.tolist(), dtype=polars.String)
        values = polars.Series(name, np.ma.getdata(column))
        if np.ma.isMaskedArray(column):
            values = values.set(polars.Series(np.ma.getmaskarray(column)), None)
        return values

    return polars.DataFrame([series(name, column) for name, column in _filled(columns).items()])


def write_parquet(path: str | os.PathLike[str], make: Callable[[], Any]) -> Path:
    """Write a pyarrow Table as a Parquet file, and return its path; see ``to_parquet`` of the tables.

    Args:
        path: the file; an existing one is replaced when the new one is complete.
        make: returns the table. It is not called if pyarrow is missing or the path does not fit.
    """
    parquet = library("pyarrow.parquet", "to_parquet")
    target = checked_output("to_parquet", path, (".parquet",))
    table = make()
    with whole_file(target) as file:
        parquet.write_table(table, file)
    return target


def to_arrow(columns: Mapping[str, Column]) -> Any:
    """Return a table with all columns; each value of a two-dimensional column is a list of fixed size."""
    arrow = library("pyarrow", "to_arrow")

    def array(column: Column) -> Any:
        if isinstance(column, Lists):
            ends = np.cumsum([0, *map(len, column.rows)])
            fits = ends[-1] <= np.iinfo(np.int32).max
            lists = arrow.ListArray if fits else arrow.LargeListArray
            return lists.from_arrays(ends.astype(np.int32 if fits else np.int64), array(_flat(column)))
        if column.dtype == object:
            return arrow.array(column.tolist(), arrow.string())
        if np.ma.isMaskedArray(column):
            return arrow.array(np.ma.getdata(column), mask=np.ma.getmaskarray(column))
        flat = arrow.array(np.ascontiguousarray(column).reshape(-1))
        return flat if column.ndim == 1 else arrow.FixedSizeListArray.from_arrays(flat, column.shape[1])

    return arrow.table({name: array(column) for name, column in _filled(columns).items()})


def frame_of(columns: Mapping[str, Sequence[Any]], types: Mapping[str, RowType]) -> Any:
    """Return a DataFrame of columns of Python values, None if missing; the types do not depend on the values."""
    pandas = library("pandas", "to_pandas")
    dtypes: dict[RowType, Any] = {
        text: str,
        number: "float64",
        short_number: "float32",
        whole: "Int64",
        date: "datetime64[us, UTC]",
    }
    return pandas.DataFrame(
        {name: pandas.Series(values, dtype=dtypes.get(types[name], object)) for name, values in columns.items()}
    )


def text(arrow: Any) -> Any:
    """Return the type of texts."""
    return arrow.string()


def texts(arrow: Any) -> Any:
    """Return the type of lists of texts."""
    return arrow.list_(arrow.string())


def number(arrow: Any) -> Any:
    """Return the type of numbers."""
    return arrow.float64()


def short_number(arrow: Any) -> Any:
    """Return the type of numbers that were measured with few digits."""
    return arrow.float32()


def whole(arrow: Any) -> Any:
    """Return the type of whole numbers with missing values."""
    return arrow.int64()


def date(arrow: Any) -> Any:
    """Return the type of dates with time."""
    return arrow.timestamp("us", tz="UTC")


def _seconds(pandas: Any, columns: Mapping[str, Column]) -> Any:
    return pandas.Index(columns["seconds"], name="seconds")


def _nullable(pandas: Any, column: Any) -> Any:
    """Return a nullable column of flags or integers."""
    dtype = "boolean" if column.dtype == bool else column.dtype.name.capitalize().replace("Ui", "UI")
    return pandas.array(column.tolist(), dtype=dtype)


def _flat(column: Lists) -> NDArray[Any]:
    """Return all values of lists, one after the other."""
    if column.dtype == object:
        return np.fromiter(chain.from_iterable(column.rows), object)
    if column.rows.ndim == 2:
        return column.rows.reshape(-1)
    return np.concatenate([np.empty(0, column.dtype), *column.rows])


def _filled(columns: Mapping[str, Column]) -> dict[str, Column]:
    """Return the columns without empty ones, such as the intensities of a scanner that sends none."""
    return {name: one for name, one in columns.items() if isinstance(one, Lists) or one.ndim == 1 or one.shape[1]}


def library(name: str, method: str) -> Any:
    """Import a library that only one method needs; if it is missing, ImportError gives the command to install it."""
    try:
        return import_module(name)
    except ImportError as error:
        install = f"pip install {name.partition('.')[0]}"
        raise ImportError(f"{method}() needs {name}, which cannot be imported ({error}): {install}") from None

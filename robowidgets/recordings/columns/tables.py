"""Columns as tables of other libraries, each imported lazily."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

TIMES = ("times_ns", "seconds", "stamps_ns")


class Columns(ABC):
    """Columns by name, which become tables of other libraries."""

    @abstractmethod
    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """The columns by name; times as ``times_ns``, ``seconds`` and ``stamps_ns``."""

    def to_pandas(self) -> Any:
        """A pandas DataFrame: a row for each time, by seconds from the start.

        Raises:
            ImportError: pandas is not installed.
        """
        return to_pandas(self.to_numpy())

    def to_polars(self) -> Any:
        """A polars DataFrame: a row for each time, ranges of scans as an array.

        Raises:
            ImportError: polars is not installed.
        """
        return to_polars(self.to_numpy())

    def to_arrow(self) -> Any:
        """An Arrow table: a row for each time, ranges of scans as a list of fixed size.

        Raises:
            ImportError: pyarrow is not installed.
        """
        return to_arrow(self.to_numpy())


def to_pandas(columns: Mapping[str, NDArray[Any]]) -> Any:
    """A DataFrame by seconds. A two-dimensional column becomes columns of their own: ``covariance[0]`` and so on."""
    pandas = library("pandas", "to_pandas")
    values: dict[str, Any] = {}
    for name, column in columns.items():
        if name in TIMES:
            continue
        if column.ndim == 2:
            values.update({f"{name}[{i}]": one for i, one in enumerate(column.T)})
        else:
            dtype = _nullable(column)
            values[name] = column if dtype is None else pandas.array(column.tolist(), dtype=dtype)
    return pandas.DataFrame(values, index=_seconds(pandas, columns))


def rays_to_pandas(columns: Mapping[str, NDArray[Any]]) -> Any:
    """A DataFrame by seconds with the ranges of scans: a column for each ray, named by its index."""
    pandas = library("pandas", "to_pandas")
    ranges = columns["ranges"]
    rays = pandas.RangeIndex(ranges.shape[1], name="ray")
    return pandas.DataFrame(ranges, index=_seconds(pandas, columns), columns=rays)


def to_polars(columns: Mapping[str, NDArray[Any]]) -> Any:
    """A DataFrame with all columns; each value of a two-dimensional column is an array."""
    polars = library("polars", "to_polars")

    def series(name: str, column: NDArray[Any]) -> Any:
        if _nullable(column) == "boolean":
            return polars.Series(name, column.tolist(), dtype=polars.Boolean)
        return polars.Series(name, _plain(column))

    return polars.DataFrame([series(name, column) for name, column in _filled(columns).items()])


def to_arrow(columns: Mapping[str, NDArray[Any]]) -> Any:
    """A table with all columns; each value of a two-dimensional column is a list of fixed size."""
    arrow = library("pyarrow", "to_arrow")

    def array(column: NDArray[Any]) -> Any:
        if _nullable(column) == "boolean":
            return arrow.array(column.tolist(), type=arrow.bool_())
        if column.dtype == object or np.ma.isMaskedArray(column):
            return arrow.array(_plain(column))
        flat = arrow.array(np.ascontiguousarray(column).reshape(-1))
        return flat if column.ndim == 1 else arrow.FixedSizeListArray.from_arrays(flat, column.shape[1])

    return arrow.table({name: array(column) for name, column in _filled(columns).items()})


def _seconds(pandas: Any, columns: Mapping[str, NDArray[Any]]) -> Any:
    return pandas.Index(columns["seconds"], name="seconds")


def _nullable(column: NDArray[Any]) -> str | None:
    """The dtype of pandas for a column of flags or masked integers, of which some may be missing; else None."""
    if column.dtype == object:
        return (
            "boolean"
            if column.ndim == 1 and all(value is None or isinstance(value, bool) for value in column)
            else None
        )
    if not np.ma.isMaskedArray(column):
        return None
    return "boolean" if column.dtype == bool else column.dtype.name.capitalize().replace("Ui", "UI")


def _plain(column: NDArray[Any]) -> Any:
    """A column as it is, or as a list where values are texts, arrays or missing."""
    if column.dtype == object:
        return [value.tolist() if isinstance(value, np.ndarray) else value for value in column.tolist()]
    return column.tolist() if np.ma.isMaskedArray(column) else column


def _filled(columns: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """The columns without the empty ones, such as the intensities of a scanner that sends none."""
    return {name: column for name, column in columns.items() if column.ndim == 1 or column.shape[1]}


def library(name: str, method: str) -> Any:
    """A library that only one method needs; ImportError with the command that installs it if it is missing."""
    try:
        return import_module(name)
    except ImportError as error:
        raise ImportError(f"{method}() needs {name}, which cannot be imported ({error}): pip install {name}") from None

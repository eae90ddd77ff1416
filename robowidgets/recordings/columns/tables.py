"""Columns as tables of other libraries, each imported lazily."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

TIMES = ("times_ns", "seconds", "stamps_ns")


def to_pandas(columns: Mapping[str, NDArray[Any]]) -> Any:
    """A DataFrame by seconds. Ranges have one column per ray, named by its index."""
    pandas = library("pandas", "to_pandas")
    index = pandas.Index(columns["seconds"], name="seconds")
    values = {name: column for name, column in columns.items() if name not in TIMES}
    if "ranges" in values:
        rays = pandas.RangeIndex(values["ranges"].shape[1], name="ray")
        return pandas.DataFrame(values["ranges"], index=index, columns=rays)
    frame = pandas.DataFrame(values, index=index)
    return frame.astype({name: "boolean" for name, column in values.items() if column.dtype == object})


def to_polars(columns: Mapping[str, NDArray[Any]]) -> Any:
    """A DataFrame with all columns; each value of a two-dimensional column is an array."""
    polars = library("polars", "to_polars")
    return polars.DataFrame(
        [
            polars.Series(name, column.tolist(), dtype=polars.Boolean)
            if column.dtype == object
            else polars.Series(name, column)
            for name, column in _filled(columns).items()
        ]
    )


def to_arrow(columns: Mapping[str, NDArray[Any]]) -> Any:
    """A table with all columns; each value of a two-dimensional column is a list of fixed size."""
    arrow = library("pyarrow", "to_arrow")

    def array(column: NDArray[Any]) -> Any:
        if column.dtype == object:
            return arrow.array(column.tolist(), type=arrow.bool_())
        flat = arrow.array(np.ascontiguousarray(column).reshape(-1))
        return flat if column.ndim == 1 else arrow.FixedSizeListArray.from_arrays(flat, column.shape[1])

    return arrow.table({name: array(column) for name, column in _filled(columns).items()})


def _filled(columns: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """The columns without the empty ones, such as the intensities of a scanner that sends none."""
    return {name: column for name, column in columns.items() if column.ndim == 1 or column.shape[1]}


def library(name: str, method: str) -> Any:
    """A library that only one method needs; ImportError with the command that installs it if it is missing."""
    try:
        return import_module(name)
    except ImportError as error:
        raise ImportError(f"{method}() needs {name}, which cannot be imported ({error}): pip install {name}") from None

"""Ranges that note which of them a function reads."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray


class TracedRanges(np.ndarray):
    """The ranges of a scan, which note what is read of them at once: an index, a part, or all of them.

    All of them are read by a loop, and by a function of NumPy that makes one number of them. Parts, and what NumPy
    makes of them, are plain.
    """

    _note: Callable[[Any, Any], None] | None = None
    """Takes an index of the array and what it gives. Copies have none: an index of a sorted one is no ray."""

    def __getitem__(self, key: Any) -> Any:
        part = np.asarray(self)[key]
        if self._note:
            self._note(key, part)
        return part

    def __iter__(self) -> Any:
        return iter(self[:])

    def __array_ufunc__(self, ufunc: np.ufunc, method: Any, *inputs: Any, **options: Any) -> Any:
        if "out" in options:
            options["out"] = tuple(map(_plain, options["out"]))
        return self._made(getattr(ufunc, method)(*map(_plain, inputs), **options))

    def __array_function__(self, *call: Any) -> Any:
        return self._made(super().__array_function__(*call))

    def _made(self, result: Any) -> Any:
        if self._note and np.isscalar(result):
            self._note(slice(None), np.asarray(self))
        return _plain(result)


TracedRanges.__name__ = "array"  # for its repr


def traced(ranges: NDArray[np.float32], note: Callable[[Any, Any], None]) -> NDArray[np.float32]:
    """A view of ranges that calls a function with each index that is read, and with what it gives."""
    view = ranges.view(TracedRanges)
    vars(view)["_note"] = note
    return view


def _plain(value: Any) -> Any:
    return np.asarray(value) if isinstance(value, TracedRanges) else value

"""An array of ranges that records which of them a function reads."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray


class TracedRanges(np.ndarray):
    """The ranges of a scan, which record each read: an index, a slice, or all ranges.

    A loop reads all of them, and so does a function of NumPy that returns one number. Slices, and the results of
    NumPy, are plain arrays.
    """

    _note: Callable[[Any, Any], None] | None = None
    """Called with an index and the value read. None for copies: an index into a sorted copy does not name a ray."""

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
    """Return a view of ranges that calls a function with each index that is read and its value."""
    view = ranges.view(TracedRanges)
    vars(view)["_note"] = note
    return view


def _plain(value: Any) -> Any:
    return np.asarray(value) if isinstance(value, TracedRanges) else value

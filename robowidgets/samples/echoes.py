"""Scanners with several echoes for each ray, and the positions of ranges in the data that a scan was made from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .checks import frozen
from .problem import Problem

CHOICES = ("first", "last", "strongest")
"""The echo that becomes the range of a ray."""

_CODE = "ranges[{ray}].echoes[{number}]"
"""Code that reads an echo from a message."""

_NO_STRENGTH = Problem("no intensities: the strongest echo is unknown", "show the first or the last echo instead")


@dataclass(frozen=True, eq=False)
class Sources:
    """The positions of the ranges of a scan in the data that it was made from: echoes, or points of a cloud.

    Args:
        made_of: a short name of that data: ``"first echo"``.
        code: code that reads one value, with ``{ray}`` and ``{number}``: ``"ranges[{ray}].echoes[{number}]"``.
        numbers: for each ray the number of its echo or point, shape (R,), int32, or -1 if it has none.
        problems: problems of the conversion.
    """

    made_of: str
    code: str
    numbers: NDArray[np.int32]
    problems: tuple[Problem, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "numbers", frozen(np.array(self.numbers, np.int32)))

    def __setstate__(self, state: dict[str, object]) -> None:
        vars(self).update(state)
        frozen(self.numbers)  # a copy of a read-only array is not


@dataclass(frozen=True, eq=False)
class Echoes:
    """The echoes of a scan: up to E along each ray.

    Args:
        counts: the number of echoes of each ray, shape (R,).
        ranges: metres, shape (R, E), float32; NaN beyond the echoes of a ray.
        intensities: device units, shape (R, E), float32, or (R, 0) if the scanner sent none.
    """

    counts: NDArray[np.intp]
    ranges: NDArray[np.float32]
    intensities: NDArray[np.float32]

    def __post_init__(self) -> None:
        self._freeze()

    def __setstate__(self, state: dict[str, object]) -> None:
        vars(self).update(state)
        self._freeze()

    @property
    def nbytes(self) -> int:
        """Bytes of its arrays."""
        return self.counts.nbytes + self.ranges.nbytes + self.intensities.nbytes

    def sources(self, which: str) -> Sources:
        """Return the number of one echo of each ray, or -1 if a ray has no echo or the strongest is unknown.

        Args:
            which: ``"first"``, ``"last"`` or ``"strongest"`` (the first of equals).

        Raises:
            ValueError: which is another value.
        """
        check_choice(which)
        found = np.zeros_like(self.counts) if which == "first" else self.counts - 1
        problems: tuple[Problem, ...] = ()
        if which == "strongest" and self.intensities.shape[1]:
            found = np.where(np.isnan(self.intensities), -np.inf, self.intensities).argmax(axis=1)
        elif which == "strongest":
            found, problems = np.full_like(self.counts, -1), (_NO_STRENGTH,) if self.counts.any() else ()
        return Sources(f"{which} echo", _CODE, np.where(self.counts > 0, found, -1), problems)

    def at(self, numbers: NDArray[np.int32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the ranges and intensities of these echoes, shape (R,), NaN for -1; without intensities shape (0,)."""
        ranges = _pick(self.ranges, numbers)
        return ranges, _pick(self.intensities, numbers) if self.intensities.shape[1] else ranges[:0]

    def _freeze(self) -> None:
        for array in (self.counts, self.ranges, self.intensities):
            frozen(array)


def check_choice(which: str) -> None:
    """Raise ValueError unless this is one of `CHOICES`."""
    if which not in CHOICES:
        raise ValueError(f"echo: expected {', '.join(map(repr, CHOICES))}, got {which!r}")


def _pick(columns: NDArray[np.float32], numbers: NDArray[np.int32]) -> NDArray[np.float32]:
    if not columns.shape[1]:
        return np.full(len(columns), np.nan, np.float32)
    picked = columns[np.arange(len(columns)), np.maximum(numbers, 0)]
    return np.where(numbers < 0, np.float32(np.nan), picked)

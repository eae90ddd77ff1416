"""Several echoes of each ray, and where the ranges of a scan stand in the data that it was made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .checks import frozen
from .problem import Problem

CHOICES = ("first", "last", "strongest")
"""Which echo of each ray is its range."""

_CODE = "ranges[{ray}].echoes[{number}]"
"""How a program gets at an echo of a message."""

_NO_STRENGTH = Problem(
    "no intensities: nobody can tell which echo is the strongest", "show the first or the last echo instead"
)


@dataclass(frozen=True, eq=False)
class Sources:
    """Where the ranges of a scan stand in the data that it was made of: an echo of many, a point of a cloud.

    Args:
        made_of: what the scan is made of, in a few words: ``"first echo"``.
        code: how a program gets at one, with ``{ray}`` and ``{number}``: ``"ranges[{ray}].echoes[{number}]"``.
        numbers: for each ray its number in that data, shape (R,), int32; -1 where it has none.
        problems: what is odd about how the scan was made of it.
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
    """What a scanner measured along each ray, up to E echoes.

    Args:
        counts: the number of echoes of each ray, shape (R,).
        ranges: metres, shape (R, E), float32; NaN beyond the echoes of a ray.
        intensities: device units, shape (R, E), float32; (R, 0) without.
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
        """The number of one echo of each ray; -1 for a ray without an echo, or if nobody can tell which it is.

        Args:
            which: ``"first"``, ``"last"`` or ``"strongest"``, of equals the first.

        Raises:
            ValueError: another choice.
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
        """The ranges and the intensities of these echoes, each of shape (R,); NaN for -1, no intensities without."""
        ranges = _pick(self.ranges, numbers)
        return ranges, _pick(self.intensities, numbers) if self.intensities.shape[1] else ranges[:0]

    def _freeze(self) -> None:
        for array in (self.counts, self.ranges, self.intensities):
            frozen(array)


def check_choice(which: str) -> None:
    """ValueError for what is no choice of an echo."""
    if which not in CHOICES:
        raise ValueError(f"echo: expected {', '.join(map(repr, CHOICES))}, got {which!r}")


def _pick(columns: NDArray[np.float32], numbers: NDArray[np.int32]) -> NDArray[np.float32]:
    if not columns.shape[1]:
        return np.full(len(columns), np.nan, np.float32)
    picked = columns[np.arange(len(columns)), np.maximum(numbers, 0)]
    return np.where(numbers < 0, np.float32(np.nan), picked)

"""The numbers that a program plots on a widget, each at the time of a sample."""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple

MOST_NUMBERS = 8


class _Number(NamedTuple):
    """A number, and the number of samples at the time it was given."""

    value: float
    sequence: int


class PlottedNumbers:
    """The newest number of each name, for the picture of a sample. The widget holds its lock during each call."""

    def __init__(self) -> None:
        self._newest: dict[str, _Number] = {}
        self._pictures = (-1, -1)
        """Sequence numbers of the last two samples that were shown, the newer first."""

    def __contains__(self, name: str) -> bool:
        return name in self._newest

    def put(self, name: str, value: float, sequence: int) -> None:
        """Store a number at the time of the newest sample.

        Raises:
            ValueError: there are too many names.
        """
        if name not in self._newest and len(self._newest) >= MOST_NUMBERS:
            raise ValueError(f"watch({name!r}): expected at most {MOST_NUMBERS} names; unwatch(name) removes one")
        self._newest[name] = _Number(value, sequence)

    def remove(self, name: str) -> None:
        """Forget a name."""
        del self._newest[name]

    def on(self, sequence: int) -> dict[str, dict[str, float | None]]:
        """Return the text on a sample: the numbers given since the sample shown before, and None for the others.

        A number may be given after its sample was shown. Without names the text is empty.
        """
        if not self._newest:
            return {}
        if sequence != self._pictures[0]:
            self._pictures = (sequence, self._pictures[0])
        since = self._pictures[1]
        shown = {
            name: number.value if number.sequence > since and isfinite(number.value) else None
            for name, number in self._newest.items()
        }
        return {"numbers": shown}

"""The printed lines of programs."""

from __future__ import annotations

from collections import deque

KEPT = 3
"""The number of lines to keep."""

LONGEST = 200
"""The number of characters of a line to keep."""


class Prints:
    """The last lines that a program printed, with their times.

    Attributes:
        lines: (seconds, text), oldest first.
    """

    def __init__(self) -> None:
        self.lines: deque[tuple[float, str]] = deque(maxlen=KEPT)
        self._rest = ""

    def add(self, text: str, seconds: float) -> None:
        """Add printed text. A line counts once it is complete."""
        *whole, rest = (self._rest + text).split("\n")
        self._rest = rest[:LONGEST]
        self.lines.extend((seconds, line[:LONGEST]) for line in whole)

    def end_line(self, seconds: float) -> None:
        """Add the printed part of a line that has no end yet."""
        if self._rest:
            self.add("\n", seconds)
